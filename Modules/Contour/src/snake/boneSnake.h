/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneSnake_h
#define boneSnake_h

#include "bonePlaneField.h"
#include "boneSnakeContourParameters.h"

#include <string>

namespace bone
{
/** How a snake ended. */
struct SnakeResult
{
  Polygon     contour;
  int         iterations{ 0 };
  bool        converged{ false };
  std::string reason;          ///< "motion below tolerance", "iterations used up", "vanished"
  double      support{ 0.0 };  ///< share of the points that found an edge in reach, 0..1
  double      strength{ 0.0 }; ///< median slope of the edges found, HU/mm
  double      energy{ 0.0 };   ///< internal energy, mm
};

/** \class CyclicPentadiagonal
 * \brief Solver of symmetric, positive definite, cyclic systems: a diagonal and two constant off-diagonals. O(n). */
class CyclicPentadiagonal
{
public:
  /** \pre at least five unknowns. */
  CyclicPentadiagonal(const std::vector<double> & diagonal, double first, double second);

  /** Replaces the right-hand side by the solution. */
  void
  Solve(std::vector<Vector2> & values) const;

private:
  void
  SolveOpen(std::vector<Vector2> & values) const;
  void
  SolveOpen(std::vector<double> & values) const;

  std::size_t         m_Open; // unknowns without the last two
  std::vector<double> m_D;
  std::vector<double> m_L1;
  std::vector<double> m_L2;
  std::vector<double> m_Border[2];  // couplings of the last two unknowns
  std::vector<double> m_Reduced[2]; // the same, solved for
  Eigen::Matrix2d     m_Schur;
};

/** Points at equal distances (at least eight) along a closed polygon, about `spacing` apart. */
Polygon
ResampleUniform(const Polygon & polygon, double spacing);

/** \class BoneEdges
 * \brief Where, near a start contour, the image falls off towards the outside: what the snake is drawn to.
 *
 * Only edges that are bright on the start contour's inner side count, so that the cortex's inner side and neighbouring
 * bones do not attract from the wrong side. The force's far reach is gradient vector flow (C. Xu, J. L. Prince,
 * doi:10.1109/83.661186) of that edge map. */
class BoneEdges
{
public:
  /** `image` is the CT around the start contours, `sigma` (mm) smooths it; edges below `minimumSlope` (HU/mm) do not
   * count. */
  BoneEdges(const PlaneField & image, const std::vector<Polygon> & start, double sigma, double minimumSlope);

  /** Direction to the edge, of length 0 (on it) to 1. */
  Vector2
  Flow(const Vector2 & q) const;

  /** Distance (mm) along the unit vector `outward` from q to the steepest fall within `reach`, favouring what is near;
   * false where there is none. */
  bool
  FindEdge(const Vector2 & q, const Vector2 & outward, double reach, double & offset, double & slope) const;

  double
  GetPixel() const
  {
    return m_Image.grid.spacing.minCoeff();
  }

private:
  PlaneField
  EdgeMap(const std::vector<Polygon> & start) const;
  void
  ComputeFlow(const PlaneField & map);

  PlaneField m_Image;
  double     m_MinimumSlope;
  PlaneField m_FlowX;
  PlaneField m_FlowY;
};

/** \brief Moves a closed contour with the flow until it rests, then onto the edges found along its normals.
 *
 * Semi-implicit steps (I + t A) x' = x + t F(x) with A the internal energy's matrix (M. Kass, A. Witkin, D.
 * Terzopoulos, doi:10.1007/BF00133570); points are spread evenly again after each step. The second phase draws each
 * point to its own edge, which gives a fraction of a pixel; points without an edge follow their neighbours. */
SnakeResult
EvolveSnake(const Polygon & start, const BoneEdges & edges, const SnakeContourParameters & parameters);

/** \brief The second phase alone, no point further than `bound` (mm) from where it started. */
SnakeResult
RefineSnake(const Polygon & start, const BoneEdges & edges, double bound, const SnakeContourParameters & parameters);
} // namespace bone

#endif
