/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneReflection.h"

#include "bonePlacement.h"

#include <utility>

namespace bone
{
std::vector<Vector3>
ReflectPoints(std::vector<Vector3> points)
{
  for (Vector3 & x : points)
  {
    x[0] = -x[0];
  }
  return points;
}

MeshArrays
ReflectMesh(MeshArrays mesh)
{
  return Place(std::move(mesh), { Vector3(-1.0, 1.0, 1.0).asDiagonal(), Vector3::Zero() });
}
} // namespace bone
