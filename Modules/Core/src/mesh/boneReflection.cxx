/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneReflection.h"

#include "boneBernstein.h"

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
  mesh.points = ReflectPoints(std::move(mesh.points));
  for (auto * ids : { &mesh.tetrahedra, &mesh.neighbors })
  {
    for (Id4 & four : *ids)
    {
      std::swap(four[0], four[1]);
    }
  }
  const auto row = static_cast<std::size_t>(BernsteinCount(std::max(mesh.maximumDegree, 0)));
  for (std::size_t t = 0; t < mesh.degree.size(); ++t)
  {
    double * const c = &mesh.coefficients[t * row];
    for (const auto & e : BernsteinExponents(mesh.degree[t]))
    {
      if (e[0] > e[1])
      {
        std::swap(c[BernsteinIndex(mesh.degree[t], e[0], e[1], e[2])],
                  c[BernsteinIndex(mesh.degree[t], e[1], e[0], e[2])]);
      }
    }
  }
  return mesh;
}
} // namespace bone
