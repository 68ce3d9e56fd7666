/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneSurfaceBound_h
#define boneSurfaceBound_h

#include "boneSurfaceGrid.h"
#include "boneSurfaceTarget.h"

#include <algorithm>

namespace bone
{
/** A triangle of a surface of the mesh. */
struct SurfaceTriangle
{
  TriangleIds ids;
  int         surface;
};

/** \class SurfaceBound
 * \brief Keeps boundary and interfaces within a distance of the surfaces that they were at first, both ways.
 *
 * Four points within each first triangle and its corners are samples, and each belongs to a triangle of the mesh. Where
 * triangles are replaced, their samples go to the nearest of those that come; where they are moved too, but for samples
 * that stay within the least bound so far of their own. None may be farther than the bound, or than it was where that
 * is more. The centroid of a new triangle must lie within the bound of the first surface in the same sense. So neither
 * a ridge is cut off nor a hollow filled by many small steps. */
class SurfaceBound
{
public:
  /** \param first  the first surfaces; must live as long as this. \param bound  mm. */
  SurfaceBound(const TetraComplex & complex, const SurfaceTarget & first, double bound);

  /** Another bound for what comes after, mm. */
  void
  SetBound(double bound)
  {
    m_SquaredBound = bound * bound;
    m_SquaredLeast = std::min(m_SquaredLeast, m_SquaredBound);
  }

  /** Whether triangles may go and others come; where they may, this counts them as replaced. `points` are the places
   * after the change. Without `removed` the triangles that come are those that go, with points moved. */
  bool
  Replace(const std::vector<SurfaceTriangle> & removed,
          const std::vector<SurfaceTriangle> & added,
          const std::vector<Vector3> &         points);

private:
  struct Sample
  {
    Vector3     place;
    TriangleIds owner; ///< ascending
    double      squaredDistance;
    int         surface;
  };
  struct Visit
  {
    int    sample;
    int    triangle;
    double squaredDistance;
  };

  void
  AddSample(const Vector3 & place, const TriangleIds & owner, int surface);
  static double
  SquaredDistance(const Sample & sample, const TriangleIds & t, const std::vector<Vector3> & points);
  /** Whether all samples may go to triangles that come; finds these, and how far triangles may be from the first
   * surface, squared: the bound, or what the samples have. */
  bool
  FindOwners(const std::vector<SurfaceTriangle> & removed,
             const std::vector<SurfaceTriangle> & added,
             const std::vector<Vector3> &         points);

  const SurfaceTarget &         m_First;
  double                        m_SquaredBound;
  double                        m_SquaredLeast; ///< of the least bound so far: within it triangles are not compared
  std::vector<Sample>           m_Samples;
  std::vector<std::vector<int>> m_At; ///< #p, samples whose owner has p as its smallest id
  std::vector<Visit>            m_Visits;
  double                        m_Farthest{ 0.0 };
};
} // namespace bone

#endif
