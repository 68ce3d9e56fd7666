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
  Deviation(IdType a, IdType b) const;

  using Samples = std::vector<const ContourShape::Sample *>;
  /** The third point of a triangle at an edge. */
  using Corner = std::pair<Edge, IdType>;

  /** Triangles of the mesh that may become others with the same rim, and what they cost. */
  struct Patch
  {
    std::vector<TriangleIds> triangles;
    std::vector<Corner>      beyond;  ///< at the rim, of the triangles next to it
    Samples                  samples; ///< of the triangles
    double                   area;    ///< mm^2 that the samples stand for
    double                   energy;  ///< mm^4, of the triangles and their edges
  };

  Patch
  At(const std::vector<TriangleIds> & triangles) const;

  /** What it would cost less (mm^4, below 0) if a patch became these triangles; 0 or above: not less. */
  double
  Change(const Patch & patch, const std::vector<TriangleIds> & added) const;

  /** Gives the points of contours of a patch that goes to the triangles that come. */
  void
  Replace(const Patch & patch, const std::vector<TriangleIds> & added);

private:
  Samples
  SamplesOf(const std::vector<TriangleIds> & triangles) const;
  std::vector<Corner>
  CornersBeyond(const std::vector<TriangleIds> & triangles) const;
  double
  Energy(const Patch & patch, const std::vector<TriangleIds> & triangles, double enough) const;
  double
  SquaredDistance(const ContourShape::Sample & sample, const TriangleIds & triangle) const;

  const TetraComplex &           m_Complex;
  const SurfaceBending &         m_Bending;
  std::map<TriangleIds, Samples> m_Samples; ///< of each triangle, its ids ascending
};
} // namespace bone

#endif
