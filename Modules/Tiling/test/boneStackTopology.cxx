/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneStackTopology.h"

#include "boneMeshValidator.h"
#include "boneStackPixels.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <set>

namespace bone
{
namespace
{
/** Euler characteristic of pixels joined over their edges (voxels over their faces). */
long
EulerOfMask(const StackMask * mask)
{
  const auto            size = mask->GetLargestPossibleRegion().GetSize();
  const auto            nx = static_cast<std::ptrdiff_t>(size[0]), ny = static_cast<std::ptrdiff_t>(size[1]);
  const unsigned char * p = mask->GetBufferPointer();
  const std::ptrdiff_t  step[] = { 1, nx, nx * ny };
  const std::ptrdiff_t  end = nx * ny * static_cast<std::ptrdiff_t>(size[2] - 1) - nx - 1;
  long                  euler = 0;
  for (std::ptrdiff_t i = 0; i < end; ++i)
  {
    if (!p[i])
    {
      continue; // the last slices, rows and columns are empty
    }
    const bool x = p[i + step[0]], y = p[i + step[1]], z = p[i + step[2]];
    const bool xy = x && y && p[i + step[0] + step[1]], xz = x && z && p[i + step[0] + step[2]],
               yz = y && z && p[i + step[1] + step[2]];
    euler += 1 - x - y - z + xy + xz + yz - (xy && xz && yz && p[i + step[0] + step[1] + step[2]]);
  }
  return euler;
}

} // namespace

long
EulerOfCells(const MeshArrays & mesh, const std::vector<std::size_t> & chosen)
{
  std::set<IdType>                points;
  std::set<std::array<IdType, 2>> edges;
  std::set<std::array<IdType, 3>> faces;
  for (const std::size_t t : chosen)
  {
    Id4 c = mesh.tetrahedra[t];
    std::sort(c.begin(), c.end());
    for (int i = 0; i < 4; ++i)
    {
      points.insert(c[i]);
      faces.insert({ { c[i == 0], c[1 + (i <= 1)], c[2 + (i <= 2)] } });
      for (int j = i + 1; j < 4; ++j)
      {
        edges.insert({ { c[i], c[j] } });
      }
    }
  }
  return static_cast<long>(points.size()) - static_cast<long>(edges.size()) + static_cast<long>(faces.size()) -
         static_cast<long>(chosen.size());
}

int
CountJoined(const std::vector<std::vector<IdType>> & joined, std::size_t points)
{
  std::vector<IdType> root(points);
  std::iota(root.begin(), root.end(), 0);
  const auto find = [&root](IdType p) {
    while (root[p] != p)
    {
      p = root[p] = root[root[p]];
    }
    return p;
  };
  std::set<IdType> roots;
  for (const auto & set : joined)
  {
    for (IdType p : set)
    {
      root[find(p)] = find(set[0]);
    }
  }
  for (const auto & set : joined)
  {
    roots.insert(find(set[0]));
  }
  return static_cast<int>(roots.size());
}
std::ostream &
operator<<(std::ostream & os, const BodyTopology & topology)
{
  return os << topology.components << '/' << topology.handles << '/' << topology.voids;
}

BodyTopology
TopologyOfStack(const ContourStack & stack, int least, double pixel)
{
  int                      outside = 0;
  const StackMask::Pointer mask = PixelsInside(stack, least, pixel, outside);
  BodyTopology             topology;
  LabelParts(mask, false, topology.components);
  topology.voids = outside - 1;
  topology.handles = topology.components + topology.voids - static_cast<int>(EulerOfMask(mask));
  return topology;
}

BodyTopology
TopologyOfMesh(const MeshArrays & mesh, int least)
{
  std::vector<std::vector<IdType>> cells, faces;
  std::vector<std::size_t>         chosen;
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
  {
    if (mesh.region[t] >= least)
    {
      chosen.push_back(t);
      cells.emplace_back(mesh.tetrahedra[t].begin(), mesh.tetrahedra[t].end());
    }
  }
  for (const auto & f : BoundaryFaces(mesh, least))
  {
    faces.emplace_back(f.begin(), f.end());
  }
  BodyTopology topology;
  topology.components = CountJoined(cells, mesh.points.size());
  topology.voids = CountJoined(faces, mesh.points.size()) - topology.components;
  topology.handles = topology.components + topology.voids - static_cast<int>(EulerOfCells(mesh, chosen));
  return topology;
}
} // namespace bone
