/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneSurfaceGrid_h
#define boneSurfaceGrid_h

#include "boneTypes.h"

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

namespace bone
{
using TriangleIds = std::array<IdType, 3>;

/** The same triangle, its ids ascending. */
TriangleIds
Ascending(TriangleIds ids);

/** \brief Whether two triangles, given by point ids, meet elsewhere than in the points and edges they share by id.
 *
 * Exact; touching counts. Two triangles on the same three points meet. */
bool
TrianglesCross(const TriangleIds & s, const TriangleIds & t, const std::vector<Vector3> & points);

/** \class SurfaceGrid
 * \brief The triangles of a surface in a hash grid: finds whether a changed triangle would pass through the others.
 *
 * A triangle is taken out with the coordinates it was put in with. */
class SurfaceGrid
{
public:
  /** \param cellSize  mm, best near the triangles' mean edge length. */
  explicit SurfaceGrid(double cellSize);

  void
  Insert(const TriangleIds & triangle, const std::vector<Vector3> & points);
  void
  Erase(const TriangleIds & triangle, const std::vector<Vector3> & points);

  /** A triangle's point p has moved to where it is now. \param before  where it was */
  void
  Move(const TriangleIds & triangle, IdType p, const Vector3 & before, const std::vector<Vector3> & points);

  /** Whether the triangle crosses one in the grid, other than those that have point `ignored`. */
  bool
  Crosses(const TriangleIds & triangle, IdType ignored, const std::vector<Vector3> & points) const;

  using Cell = std::array<std::int64_t, 3>;

  /** The cells that a box meets. */
  struct Range
  {
    Cell lower;
    Cell upper;
  };

private:
  /** A triangle as it was put in. */
  struct Entry
  {
    TriangleIds ids; ///< ascending
    Cell        lower;
  };

  void
  Insert(const TriangleIds & triangle, const Range & range);
  void
  Erase(const TriangleIds & triangle, const Range & range);

  double                                                m_Scale;
  std::unordered_map<std::uint64_t, std::vector<Entry>> m_Cells;
};

/** Pairs of triangles of a surface that cross, each once, in ascending order: the audit of a whole surface. */
std::vector<std::array<int, 2>>
FindCrossingTriangles(const std::vector<TriangleIds> & triangles, const std::vector<Vector3> & points);
} // namespace bone

#endif
