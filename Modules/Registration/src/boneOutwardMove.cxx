/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneOutwardMove.h"

#include <algorithm>

namespace bone
{
std::vector<Vector3>
OutwardMove(const MeshArrays & mesh)
{
  std::vector<Vector3> move(mesh.points.size(), Vector3::Zero());
  for (const auto & face : BoundaryFaces(mesh))
  {
    const Vector3 & a = mesh.points[static_cast<std::size_t>(face[0])];
    const Vector3   area =
      (mesh.points[static_cast<std::size_t>(face[1])] - a).cross(mesh.points[static_cast<std::size_t>(face[2])] - a);
    for (const IdType p : face)
    {
      move[static_cast<std::size_t>(p)] += area;
    }
  }
  for (Vector3 & x : move)
  {
    x /= std::max(x.norm(), 1e-30);
  }
  return move;
}
} // namespace bone
