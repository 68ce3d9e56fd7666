/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneTriangleSurface.h"

namespace bone
{
TriangleSurface
ExteriorSurface(const MeshArrays & mesh, std::vector<IdType> & pointId, int least)
{
  TriangleSurface     surface;
  std::vector<IdType> number(mesh.points.size(), -1);
  surface.triangles = BoundaryFaces(mesh, least);
  for (const auto & triangle : surface.triangles)
  {
    for (const IdType p : triangle)
    {
      number[p] = 0;
    }
  }
  pointId.clear();
  for (std::size_t p = 0; p < number.size(); ++p)
  {
    if (number[p] == 0)
    {
      number[p] = static_cast<IdType>(pointId.size());
      pointId.push_back(static_cast<IdType>(p));
      surface.points.push_back(mesh.points[p]);
    }
  }
  for (auto & triangle : surface.triangles)
  {
    triangle = { number[triangle[0]], number[triangle[1]], number[triangle[2]] };
  }
  return surface;
}

std::vector<Vector3>
PointNormals(const TriangleSurface & surface)
{
  std::vector<Vector3> normals(surface.points.size(), Vector3::Zero());
  for (const auto & t : surface.triangles)
  {
    const Vector3 normal =
      (surface.points[t[1]] - surface.points[t[0]]).cross(surface.points[t[2]] - surface.points[t[0]]);
    for (const IdType p : t)
    {
      normals[p] += normal;
    }
  }
  for (Vector3 & normal : normals)
  {
    const double length = normal.norm();
    normal = length > 0 ? Vector3(normal / length) : Vector3(Vector3::Zero());
  }
  return normals;
}

double
EnclosedVolume(const TriangleSurface & surface)
{
  double        volume = 0;
  const Vector3 origin = surface.points.empty() ? Vector3(Vector3::Zero()) : surface.points.front();
  for (const auto & t : surface.triangles)
  {
    volume += (surface.points[t[0]] - origin).dot((surface.points[t[1]] - origin).cross(surface.points[t[2]] - origin));
  }
  return volume / 6.0;
}
} // namespace bone
