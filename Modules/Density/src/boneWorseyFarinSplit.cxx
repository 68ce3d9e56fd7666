/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneWorseyFarinSplit.h"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace bone
{
namespace
{
/** Adds points to a mesh, with their attributes. */
class SplitPoints
{
public:
  explicit SplitPoints(MeshArrays & mesh)
    : m_Mesh(mesh)
  {}

  /** A point among `count` vertices. */
  IdType
  Add(const Vector3 & point, const IdType * vertices, int count)
  {
    m_Mesh.points.push_back(point);
    if (!m_Mesh.layer.empty())
    {
      int layer = m_Mesh.layer[vertices[0]];
      std::for_each(vertices, vertices + count, [&](IdType v) { layer = std::max(layer, m_Mesh.layer[v]); });
      m_Mesh.layer.push_back(layer);
    }
    if (!m_Mesh.slice.empty())
    {
      m_Mesh.slice.push_back(m_Mesh.slice[vertices[0]]);
    }
    return static_cast<IdType>(m_Mesh.points.size() - 1);
  }

private:
  MeshArrays & m_Mesh;
};

std::array<IdType, 3>
FaceOf(const Id4 & tetra, int face)
{
  return { tetra[TetraFaces[face][0]], tetra[TetraFaces[face][1]], tetra[TetraFaces[face][2]] };
}

/** Twice the outward area vector. */
Vector3
FaceNormal(const MeshArrays & mesh, const Id4 & tetra, int face)
{
  const auto f = FaceOf(tetra, face);
  return (mesh.points[f[1]] - mesh.points[f[0]]).cross(mesh.points[f[2]] - mesh.points[f[0]]);
}

/** Radii of the inscribed spheres. */
std::vector<double>
Inradii(const MeshArrays & mesh)
{
  std::vector<double> radii(mesh.tetrahedra.size());
  for (std::size_t t = 0; t < radii.size(); ++t)
  {
    const Id4 & v = mesh.tetrahedra[t];
    double      area = 0;
    for (int face = 0; face < 4; ++face)
    {
      area += FaceNormal(mesh, v, face).norm() / 2;
    }
    radii[t] = 3 * SignedVolume(mesh.points[v[0]], mesh.points[v[1]], mesh.points[v[2]], mesh.points[v[3]]) / area;
    if (!(radii[t] > 0))
    {
      throw std::invalid_argument("Tetrahedron " + std::to_string(t) +
                                  " is flat or inverted; a density with a continuous gradient needs a valid mesh.");
    }
  }
  return radii;
}

/** For each face of each tetrahedron its split point, which two tetrahedra share; added to `split`, whose incentres are
 * there already. */
std::vector<Id4>
AddFacePoints(const MeshArrays & mesh, const std::vector<Id4> & neighbors, MeshArrays & split)
{
  const std::vector<double> radius = Inradii(mesh);
  const std::size_t         first = mesh.points.size();
  std::vector<Id4>          ids(mesh.tetrahedra.size());
  SplitPoints               points(split);
  for (std::size_t t = 0; t < ids.size(); ++t)
  {
    for (int face = 0; face < 4; ++face)
    {
      const IdType  other = neighbors[t][face];
      const Vector3 centre = split.points[first + t];
      if (other >= 0 && other < static_cast<IdType>(t))
      {
        const Id4 & back = neighbors[other];
        ids[t][face] = ids[other][std::find(back.begin(), back.end(), static_cast<IdType>(t)) - back.begin()];
        continue;
      }
      // The incentres' distances to the face are the radii.
      const Vector3 point =
        other >= 0
          ? Vector3((radius[other] * centre + radius[t] * split.points[first + other]) / (radius[other] + radius[t]))
          : Vector3(centre + radius[t] * FaceNormal(mesh, mesh.tetrahedra[t], face).normalized());
      ids[t][face] = points.Add(point, FaceOf(mesh.tetrahedra[t], face).data(), 3);
    }
  }
  return ids;
}
} // namespace

Eigen::Vector4d
IncentreCoordinates(const MeshArrays & mesh, const Id4 & tetra)
{
  Eigen::Vector4d areas;
  for (int face = 0; face < 4; ++face)
  {
    areas[face] = FaceNormal(mesh, tetra, face).norm();
  }
  return areas / areas.sum();
}

MeshArrays
SplitWorseyFarin(const MeshArrays & mesh)
{
  const std::size_t cells = mesh.tetrahedra.size();
  MeshArrays        split;
  split.points = mesh.points;
  split.layer = mesh.layer;
  split.slice = mesh.slice;
  split.quantity = mesh.quantity;
  SplitPoints points(split);
  for (const Id4 & v : mesh.tetrahedra)
  {
    const Eigen::Vector4d share = IncentreCoordinates(mesh, v);
    Vector3               centre = Vector3::Zero();
    for (int i = 0; i < 4; ++i)
    {
      centre += share[i] * mesh.points[v[i]];
    }
    points.Add(centre, v.data(), 4);
  }
  const std::vector<Id4> neighbors = mesh.neighbors.empty() ? ComputeFaceNeighbors(mesh.tetrahedra) : mesh.neighbors;
  const std::vector<Id4> facePoint = AddFacePoints(mesh, neighbors, split);
  constexpr auto         parts = WorseyFarinParts();
  split.tetrahedra.reserve(WorseyFarinCells * cells);
  for (std::size_t t = 0; t < cells; ++t)
  {
    std::array<IdType, 9> ids;
    std::copy_n(mesh.tetrahedra[t].begin(), 4, ids.begin());
    std::copy_n(facePoint[t].begin(), 4, ids.begin() + 4);
    ids[8] = static_cast<IdType>(mesh.points.size() + t);
    for (const auto & part : parts)
    {
      split.tetrahedra.push_back({ ids[part[0]], ids[part[1]], ids[part[2]], ids[part[3]] });
    }
    if (!mesh.region.empty())
    {
      split.region.insert(split.region.end(), WorseyFarinCells, mesh.region[t]);
    }
  }
  if (!mesh.neighbors.empty())
  {
    split.neighbors = ComputeFaceNeighbors(split.tetrahedra);
  }
  return split;
}
} // namespace bone
