/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneSurfaceEnergy_h
#define boneSurfaceEnergy_h

#include "boneContourSamples.h"
#include "boneSurfaceBending.h"

#include <map>
#include <optional>
#include <set>

namespace bone
{
/** \class SurfaceEnergy
 * \brief What triangles of a mesh's surfaces cost: the squared distances of the contours' points that belong to them,
 * times the areas that these stand for, and the bending of their edges (mm^4).
 *
 * Follows the mesh through operations that replace triangles, as long as it is told of each. All that it is made of
 * must live as long. */
class SurfaceEnergy
{
public:
  using Edge = std::pair<IdType, IdType>; ///< ascending

  SurfaceEnergy(const TetraComplex & complex, const ContourSamples & contours, const SurfaceBending & bending);

  /** Edges of triangles that contours belong to. */
  std::set<Edge>
  Edges() const;

  /** Third points of the two surface triangles at an edge; none where there are others. */
  std::optional<std::array<IdType, 2>>
  Corners(IdType a, IdType b) const;

  /** Angle between the two triangles at an edge, rad; 0 where there are others. */
  double
  Turn(IdType a, IdType b) const;

  struct Change
  {
    double      energy;  ///< mm^4, below 0: less
    double      area;    ///< mm^2 that the points of contours stand for
    std::size_t samples; ///< points of contours
  };

  /** What it would change that triangles of the mesh become others with the same rim. */
  Change
  Compare(const std::vector<TriangleIds> & removed, const std::vector<TriangleIds> & added) const;

  /** Gives the points of contours of triangles that go to those that come. */
  void
  Replace(const std::vector<TriangleIds> & removed, const std::vector<TriangleIds> & added);

private:
  using Samples = std::vector<const ContourShape::Sample *>;
  /** The third point of a triangle at an edge. */
  using Corner = std::pair<Edge, IdType>;

  Samples
  SamplesOf(const std::vector<TriangleIds> & triangles) const;
  std::vector<Corner>
  CornersBeyond(const std::vector<TriangleIds> & triangles) const;
  double
  Bending(const std::vector<TriangleIds> & triangles, const std::vector<Corner> & beyond) const;
  double
  SquaredDistance(const ContourShape::Sample & sample, const TriangleIds & triangle) const;

  const TetraComplex &           m_Complex;
  const SurfaceBending &         m_Bending;
  std::map<TriangleIds, Samples> m_Samples; ///< of each triangle, its ids ascending
};
} // namespace bone

#endif
