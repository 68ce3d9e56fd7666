/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneTriangleSurface_h
#define boneTriangleSurface_h

#include "boneMeshArrays.h"

#include <vector>

namespace bone
{
/** A closed surface of triangles. */
struct TriangleSurface
{
  std::vector<Vector3>               points;    ///< mm
  std::vector<std::array<IdType, 3>> triangles; ///< counter-clockwise seen from outside

  bool
  operator==(const TriangleSurface & other) const
  {
    return points == other.points && triangles == other.triangles;
  }
  bool
  operator!=(const TriangleSurface & other) const
  {
    return !(*this == other);
  }
};

/** The exterior surface of the regions from `least` inward of a tetrahedral mesh (0: of the whole mesh), with its own
 * numbering in ascending order of the mesh's points; pointId: the mesh's id of each. Needs neighbors. */
TriangleSurface
ExteriorSurface(const MeshArrays & mesh, std::vector<IdType> & pointId, int least = 0);

/** Unit normals of the points, outward, area-weighted; zero where a point has none. */
std::vector<Vector3>
PointNormals(const TriangleSurface & surface);

/** Enclosed volume, mm^3; negative where the triangles look inward. */
double
EnclosedVolume(const TriangleSurface & surface);
} // namespace bone

#endif
