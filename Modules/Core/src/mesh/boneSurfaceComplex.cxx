/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSurfaceComplex.h"

#include "boneEdgeUses.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <stdexcept>

namespace bone
{
namespace
{
constexpr double FlatTolerance = 1e-6;
constexpr double RimTurn = 30.0 / 180.0 * 3.14159265358979323846;
constexpr int    MinimumFlatFaces = 3;

struct Face
{
  std::array<IdType, 3> vertices; // outward from `tetra`
  IdType                tetra;
  int                   side;
};

std::vector<EdgeUse>
EdgesOf(const std::vector<Face> & faces)
{
  return SortedEdges(faces.size(), [&faces](std::size_t f, std::size_t i) { return faces[f].vertices[i]; });
}

/** Finds flat cuts among boundary faces: one number a face, -1 for none. */
class FlatCutFinder
{
public:
  FlatCutFinder(const std::vector<Vector3> & points, const std::vector<Face> & faces)
    : m_Points(points)
    , m_Faces(faces)
    , m_Number(faces.size(), -1)
    , m_Adjacent(faces.size(), std::array<int, 3>{ -1, -1, -1 })
  {
    ForEachEdge(EdgesOf(faces), [&](auto first, auto last) {
      if (last - first == 2)
      {
        Connect(first->Face(), first[1].Face());
        Connect(first[1].Face(), first->Face());
      }
    });
    CollectVertices();
  }

  std::vector<int>
  Run()
  {
    std::vector<char> seen(m_Faces.size(), 0);
    int               count = 0;
    for (std::size_t f = 0; f < m_Faces.size(); ++f)
    {
      if (seen[f] || !HasCoplanarNeighbor(static_cast<int>(f)) || !IsSupporting(static_cast<int>(f)))
      {
        continue;
      }
      const std::vector<int> patch = Grow(static_cast<int>(f));
      for (int g : patch)
      {
        seen[g] = 1;
      }
      if (patch.size() >= MinimumFlatFaces && TurnAtRim(patch) >= RimTurn)
      {
        for (int g : patch)
        {
          m_Number[g] = count;
        }
        ++count;
      }
    }
    return m_Number;
  }

private:
  void
  Connect(int from, int to)
  {
    *std::find(m_Adjacent[from].begin(), m_Adjacent[from].end() - 1, -1) = to;
  }

  void
  CollectVertices()
  {
    for (const Face & face : m_Faces)
    {
      m_Vertices.insert(m_Vertices.end(), face.vertices.begin(), face.vertices.end());
    }
    std::sort(m_Vertices.begin(), m_Vertices.end());
    m_Vertices.erase(std::unique(m_Vertices.begin(), m_Vertices.end()), m_Vertices.end());
    Eigen::AlignedBox3d box;
    for (IdType v : m_Vertices)
    {
      box.extend(m_Points[v]);
    }
    m_Tolerance = box.isEmpty() ? 0.0 : FlatTolerance * box.diagonal().norm();
  }

  Vector3
  Normal(int f) const
  {
    const auto & v = m_Faces[f].vertices;
    return (m_Points[v[1]] - m_Points[v[0]]).cross(m_Points[v[2]] - m_Points[v[0]]).normalized();
  }

  bool
  InPlane(int f, const Vector3 & normal, const Vector3 & origin) const
  {
    return std::all_of(m_Faces[f].vertices.begin(), m_Faces[f].vertices.end(), [&](IdType v) {
      return std::abs(normal.dot(m_Points[v] - origin)) <= m_Tolerance;
    });
  }

  bool
  HasCoplanarNeighbor(int f) const
  {
    const Vector3 normal = Normal(f), &origin = m_Points[m_Faces[f].vertices[0]];
    return std::any_of(
      m_Adjacent[f].begin(), m_Adjacent[f].end(), [&](int g) { return g >= 0 && InPlane(g, normal, origin); });
  }

  bool
  IsSupporting(int f) const
  {
    const Vector3 normal = Normal(f), &origin = m_Points[m_Faces[f].vertices[0]];
    return std::all_of(
      m_Vertices.begin(), m_Vertices.end(), [&](IdType v) { return normal.dot(m_Points[v] - origin) <= m_Tolerance; });
  }

  std::vector<int>
  Grow(int seed) const
  {
    const Vector3     normal = Normal(seed), &origin = m_Points[m_Faces[seed].vertices[0]];
    std::vector<int>  patch{ seed };
    std::vector<char> taken(m_Faces.size(), 0);
    taken[seed] = 1;
    for (std::size_t i = 0; i < patch.size(); ++i)
    {
      for (int g : m_Adjacent[patch[i]])
      {
        if (g >= 0 && !taken[g] && InPlane(g, normal, origin))
        {
          taken[g] = 1;
          patch.push_back(g);
        }
      }
    }
    return patch;
  }

  /** Mean angle, over the rim, between the patch's normal and that of the boundary beyond. */
  double
  TurnAtRim(const std::vector<int> & patch) const
  {
    std::vector<int> sorted = patch;
    std::sort(sorted.begin(), sorted.end());
    const Vector3 normal = Normal(patch.front());
    double        sum = 0.0;
    int           count = 0;
    for (int f : patch)
    {
      for (int g : m_Adjacent[f])
      {
        if (g >= 0 && !std::binary_search(sorted.begin(), sorted.end(), g))
        {
          sum += std::acos(std::clamp(normal.dot(Normal(g)), -1.0, 1.0));
          ++count;
        }
      }
    }
    return count > 0 ? sum / count : 0.0;
  }

  const std::vector<Vector3> &    m_Points;
  const std::vector<Face> &       m_Faces;
  std::vector<int>                m_Number;
  std::vector<std::array<int, 3>> m_Adjacent;
  std::vector<IdType>             m_Vertices;
  double                          m_Tolerance{ 0.0 };
};

/** Each surface face once: boundary faces from their cell, interface faces from the cell of the smaller region. */
void
CollectFaces(const MeshArrays & mesh, std::vector<Face> & boundary, std::vector<Face> & interface)
{
  const auto region = [&mesh](IdType t) { return mesh.region.empty() ? int{ Cortical } : mesh.region[t]; };
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
  {
    for (int i = 0; i < 4; ++i)
    {
      const IdType n = mesh.neighbors[t][i];
      const Id4 &  v = mesh.tetrahedra[t];
      const Face   face{ { v[TetraFaces[i][0]], v[TetraFaces[i][1]], v[TetraFaces[i][2]] }, static_cast<IdType>(t), i };
      if (n < 0)
      {
        boundary.push_back(face);
      }
      else if (region(static_cast<IdType>(t)) < region(n))
      {
        interface.push_back(face);
      }
    }
  }
}

/** Dimension of a point from the fans of surface faces around it. */
class PointClassifier
{
public:
  PointClassifier(const std::vector<Face> & faces, const std::vector<EdgeUse> & edges, SurfaceComplex & complex)
    : m_Faces(faces)
    , m_Edges(edges)
    , m_Complex(complex)
  {}

  /** Union-find over (face, corner) pairs: corners joined across edges that are no curve make one fan. */
  void
  Run(const std::vector<int> & surfaceOfFace)
  {
    m_Parent.resize(3 * m_Faces.size());
    std::iota(m_Parent.begin(), m_Parent.end(), 0);
    std::vector<int> sheets(m_Complex.dimension.size(), -1); // faces at a point's curve edges
    ForEachEdge(m_Edges, [&](auto first, auto last) {
      if (last - first == 2 && surfaceOfFace[first->Face()] == surfaceOfFace[first[1].Face()])
      {
        Join(first[0], first[1]);
        return;
      }
      const IdType a = first->First(), b = first->Second();
      for (const IdType v : { a, b })
      {
        const int count = static_cast<int>(last - first);
        sheets[v] = sheets[v] == -1 || sheets[v] == count ? count : -2;
        m_Complex.curve[v].push_back(v == a ? b : a);
      }
    });
    SetDimensions(sheets);
  }

private:
  int
  Corner(int face, IdType v) const
  {
    const auto & vertices = m_Faces[face].vertices;
    return 3 * face + static_cast<int>(std::find(vertices.begin(), vertices.end(), v) - vertices.begin());
  }

  int
  Root(int i)
  {
    while (m_Parent[i] != i)
    {
      i = m_Parent[i] = m_Parent[m_Parent[i]];
    }
    return i;
  }

  void
  Join(const EdgeUse & a, const EdgeUse & b)
  {
    for (const IdType v : { a.First(), a.Second() })
    {
      m_Parent[Root(Corner(a.Face(), v))] = Root(Corner(b.Face(), v));
    }
  }

  void
  SetDimensions(const std::vector<int> & sheets)
  {
    std::vector<int> fans(m_Complex.dimension.size(), 0);
    for (std::size_t f = 0; f < m_Faces.size(); ++f)
    {
      for (int k = 0; k < 3; ++k)
      {
        const int corner = static_cast<int>(3 * f) + k;
        fans[m_Faces[f].vertices[k]] += Root(corner) == corner;
      }
    }
    for (std::size_t p = 0; p < fans.size(); ++p)
    {
      auto & curve = m_Complex.curve[p];
      std::sort(curve.begin(), curve.end());
      if (fans[p] > 0)
      {
        const bool onSurface = curve.empty() && fans[p] == 1;
        const bool onCurve = curve.size() == 2 && sheets[p] > 0 && fans[p] == sheets[p];
        m_Complex.dimension[p] = onSurface ? 2 : onCurve ? 1 : 0;
      }
    }
  }

  const std::vector<Face> &    m_Faces;
  const std::vector<EdgeUse> & m_Edges;
  SurfaceComplex &             m_Complex;
  std::vector<int>             m_Parent;
};
} // namespace

SurfaceComplex
FindSurfaces(const MeshArrays & mesh)
{
  if (mesh.neighbors.size() != mesh.tetrahedra.size())
  {
    throw std::invalid_argument("FindSurfaces: the mesh lacks face neighbours; compute them first.");
  }
  std::vector<Face> faces, interface;
  CollectFaces(mesh, faces, interface);
  std::vector<int> flat = FlatCutFinder(mesh.points, faces).Run();
  flat.resize(faces.size() + interface.size(), -1);
  faces.insert(faces.end(), interface.begin(), interface.end());

  SurfaceComplex complex;
  complex.faceSurface.assign(mesh.tetrahedra.size(), Id4{ -1, -1, -1, -1 });
  complex.dimension.assign(mesh.points.size(), 3);
  complex.curve.resize(mesh.points.size());
  const auto region = [&mesh](IdType t) { return mesh.region.empty() ? int{ Cortical } : mesh.region[t]; };
  std::map<std::array<int, 3>, int> number;
  std::vector<int>                  surfaceOfFace;
  for (std::size_t f = 0; f < faces.size(); ++f)
  {
    const IdType            t = faces[f].tetra, n = mesh.neighbors[t][faces[f].side];
    SurfaceComplex::Surface surface;
    surface.outer = n < 0 ? SurfaceComplex::OutsideRegion : region(t);
    surface.inner = n < 0 ? region(t) : region(n);
    surface.flat = flat[f];
    const auto found =
      number.emplace(std::array<int, 3>{ surface.outer, surface.inner, surface.flat }, complex.surfaces.size());
    if (found.second)
    {
      complex.surfaces.push_back(surface);
    }
    const int id = found.first->second;
    surfaceOfFace.push_back(id);
    complex.faceSurface[t][faces[f].side] = id;
    if (n >= 0)
    {
      const Id4 & back = mesh.neighbors[n];
      complex.faceSurface[n][std::find(back.begin(), back.end() - 1, t) - back.begin()] = id;
    }
  }
  const std::vector<EdgeUse> edges = EdgesOf(faces);
  PointClassifier(faces, edges, complex).Run(surfaceOfFace);
  return complex;
}
} // namespace bone
