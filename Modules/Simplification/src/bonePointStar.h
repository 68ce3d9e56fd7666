/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef bonePointStar_h
#define bonePointStar_h

#include "boneAngleMerit.h"

namespace bone
{
/** \class PointStar
 * \brief The cells and triangles around a point of a complex: what they are worth by its place.
 *
 * Places are tried on a copy of the cells, so that several threads may try those of several points at once. */
class PointStar
{
public:
  PointStar(const TetraComplex & complex, const AngleMerit & merit, IdType p);

  struct Move
  {
    Vector3             x;
    double              gain;          ///< of what cells and triangles are worth
    std::vector<double> volumeChanges; ///< of the regions
  };

  /** To where the star is worth most, volumes counted too; no gain where no place is better.
   *
   * A pattern search whose steps shrink from stage to stage: an inner point's along axes and diagonals, a surface
   * point's along its tangents and a little along its normal, a curve point's along the curve. Corners stay. */
  Move
  FindMove();

private:
  struct Cell
  {
    std::array<Vector3, 4> corners;
    int                    at; ///< of the point
    int                    region;
  };
  struct Triangle
  {
    std::array<Vector3, 3> corners; ///< the first is the point
    int                    surface;
    /** Planes that stand for the finest surface near the triangle's three places: normal . x = offset. */
    std::array<Vector3, 3> normals;
    std::array<double, 3>  offsets;
  };

  /** Of the regions, when the point goes to x; until the next call. */
  const std::vector<double> &
  VolumeChanges(const Vector3 & x);
  void
  TakeTriangles(const TetraComplex & complex, IdType p);
  void
  SetPlanes(Triangle & triangle);
  std::vector<Vector3>
  Directions() const;
  /** What the star is worth with the point at x, volumes too, its surfaces by their planes; less than any place where a
   * cell is not positive or an angle falls too low, or where it is no more than `least`. */
  double
  About(const Vector3 & x, double least);
  /** What the triangles are worth with the point at x, by the surfaces themselves. */
  double
  OfTriangles(const Vector3 & x);
  double
  OfCells(const Vector3 & x, double least);

  const TetraComplex &  m_Complex;
  const AngleMerit &    m_Merit;
  IdType                m_Point;
  int                   m_Dimension;
  Vector3               m_Start;
  double                m_Reach{ 0.0 };              ///< mean distance of the neighbours
  Vector3               m_Normal{ Vector3::Zero() }; ///< of a surface point's triangles
  bool                  m_IsFlat{ false };           ///< on a flat cut
  std::vector<Vector3>  m_VolumeGradients;           ///< of the regions' volumes, which are linear in the point's place
  std::vector<double>   m_Changes;                   ///< of the regions' volumes
  std::vector<Cell>     m_Cells;
  std::vector<Triangle> m_Triangles;
  double                m_TrianglesAtStart{ 0.0 }; ///< what they are worth
  double                m_Worst{ -1.0 };           ///< largest cosine of the cells' dihedral angles
};
} // namespace bone

#endif
