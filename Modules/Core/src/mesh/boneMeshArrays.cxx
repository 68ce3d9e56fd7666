/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneMeshArrays.h"

#include <algorithm>
#include <numeric>
#include <stdexcept>

namespace bone
{
std::string
DensityQuantityName(DensityQuantity quantity)
{
  switch (quantity)
  {
    case DensityQuantity::HounsfieldUnit:
      return "HU";
    case DensityQuantity::K2HPO4MilligramPerCubicCentimetre:
      return "K2HPO4 mg/cm3";
    case DensityQuantity::HydroxyapatiteMilligramPerCubicCentimetre:
      return "HA mg/cm3";
    case DensityQuantity::AshGramPerCubicCentimetre:
      return "ash g/cm3";
    case DensityQuantity::ApparentGramPerCubicCentimetre:
      return "apparent g/cm3";
    case DensityQuantity::Unknown:
      break;
  }
  return "unknown";
}

std::vector<Id4>
ComputeFaceNeighbors(const std::vector<Id4> & tetrahedra)
{
  struct Face
  {
    std::array<IdType, 3> vertices;
    IdType                tetra;
    int                   side;
  };
  std::vector<Face> faces;
  faces.reserve(4 * tetrahedra.size());
  for (std::size_t t = 0; t < tetrahedra.size(); ++t)
  {
    for (int i = 0; i < 4; ++i)
    {
      std::array<IdType, 3> v;
      for (int k = 0; k < 3; ++k)
      {
        v[k] = tetrahedra[t][TetraFaces[i][k]];
      }
      std::sort(v.begin(), v.end());
      faces.push_back({ v, static_cast<IdType>(t), i });
    }
  }
  std::sort(faces.begin(), faces.end(), [](const Face & a, const Face & b) {
    return a.vertices != b.vertices ? a.vertices < b.vertices : a.tetra < b.tetra;
  });
  std::vector<Id4> neighbors(tetrahedra.size(), Id4{ -1, -1, -1, -1 });
  for (std::size_t i = 0; i < faces.size();)
  {
    std::size_t end = i + 1;
    while (end < faces.size() && faces[end].vertices == faces[i].vertices)
    {
      ++end;
    }
    if (end - i == 2)
    {
      neighbors[faces[i].tetra][faces[i].side] = faces[i + 1].tetra;
      neighbors[faces[i + 1].tetra][faces[i + 1].side] = faces[i].tetra;
    }
    i = end;
  }
  return neighbors;
}

std::vector<IdType>
RemoveUnusedPoints(MeshArrays & mesh)
{
  std::vector<IdType> newId(mesh.points.size(), -1);
  for (const Id4 & tetra : mesh.tetrahedra)
  {
    for (IdType v : tetra)
    {
      newId[v] = 0;
    }
  }
  std::vector<IdType> oldId;
  for (std::size_t p = 0; p < mesh.points.size(); ++p)
  {
    if (newId[p] == 0)
    {
      newId[p] = static_cast<IdType>(oldId.size());
      oldId.push_back(static_cast<IdType>(p));
    }
  }
  const auto gather = [&oldId](auto & values) {
    if (values.empty())
    {
      return;
    }
    for (std::size_t i = 0; i < oldId.size(); ++i)
    {
      values[i] = values[oldId[i]];
    }
    values.resize(oldId.size());
  };
  gather(mesh.points);
  gather(mesh.layer);
  gather(mesh.slice);
  for (Id4 & tetra : mesh.tetrahedra)
  {
    for (IdType & v : tetra)
    {
      v = newId[v];
    }
  }
  return oldId;
}

std::vector<std::array<IdType, 3>>
BoundaryFaces(const MeshArrays & mesh, int minimumRegion)
{
  if (mesh.neighbors.size() != mesh.tetrahedra.size() ||
      (minimumRegion > 0 && mesh.region.size() != mesh.tetrahedra.size()))
  {
    throw std::invalid_argument("BoundaryFaces: the mesh lacks face neighbours or regions; compute them first.");
  }
  const auto inside = [&](IdType t) { return t >= 0 && (minimumRegion <= 0 || mesh.region[t] >= minimumRegion); };
  std::vector<std::array<IdType, 3>> faces;
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
  {
    if (!inside(static_cast<IdType>(t)))
    {
      continue;
    }
    for (int i = 0; i < 4; ++i)
    {
      if (!inside(mesh.neighbors[t][i]))
      {
        const Id4 & v = mesh.tetrahedra[t];
        faces.push_back({ v[TetraFaces[i][0]], v[TetraFaces[i][1]], v[TetraFaces[i][2]] });
      }
    }
  }
  return faces;
}
} // namespace bone
