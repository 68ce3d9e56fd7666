/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneMeshValidator.h"

#include "boneEdgeUses.h"
#include "bonePredicates.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <limits>
#include <numeric>
#include <sstream>

namespace bone
{
namespace
{
using Triangle = std::array<IdType, 3>;

constexpr std::size_t MaximumExamples = 5;

template <typename... TParts>
std::string
Say(const TParts &... parts)
{
  std::ostringstream text;
  (text << ... << parts);
  return text.str();
}

// Counts a failure; only the first few are put in words.
template <typename... TParts>
void
Fail(MeshCheck & check, const TParts &... parts)
{
  if (check.failures++ < MaximumExamples)
  {
    check.examples.push_back(Say(parts...));
  }
}

class DisjointSets
{
public:
  explicit DisjointSets(std::size_t size)
    : m_Parent(size)
  {
    std::iota(m_Parent.begin(), m_Parent.end(), std::size_t{ 0 });
  }
  std::size_t
  Find(std::size_t x)
  {
    while (m_Parent[x] != x)
    {
      m_Parent[x] = m_Parent[m_Parent[x]];
      x = m_Parent[x];
    }
    return x;
  }
  void
  Unite(std::size_t a, std::size_t b)
  {
    a = Find(a);
    b = Find(b);
    m_Parent[std::max(a, b)] = std::min(a, b);
  }
  std::size_t
  Count() const
  {
    std::size_t roots = 0;
    for (std::size_t x = 0; x < m_Parent.size(); ++x)
    {
      roots += m_Parent[x] == x ? 1 : 0;
    }
    return roots;
  }

private:
  std::vector<std::size_t> m_Parent;
};

// A face as one tetrahedron sees it; uses of the same face are neighbours after sorting.
struct FaceUse
{
  std::uint64_t lowMiddle; // smallest and middle vertex
  IdType        high;
  IdType        tetra;
  std::int8_t   side;
  bool          odd; // parity of the outward order against the sorted one

  bool
  SameFace(const FaceUse & other) const
  {
    return lowMiddle == other.lowMiddle && high == other.high;
  }
};

std::string
FaceName(const FaceUse & face)
{
  return Say("face (", face.lowMiddle >> 32, ", ", face.lowMiddle & 0xffffffffu, ", ", face.high, ")");
}

std::vector<FaceUse>
SortedFaces(const std::vector<Id4> & tetrahedra)
{
  std::vector<FaceUse> faces;
  faces.reserve(4 * tetrahedra.size());
  for (std::size_t t = 0; t < tetrahedra.size(); ++t)
  {
    for (int side = 0; side < 4; ++side)
    {
      Triangle v;
      for (int k = 0; k < 3; ++k)
      {
        v[k] = tetrahedra[t][TetraFaces[side][k]];
      }
      const bool odd = (v[0] > v[1]) != ((v[0] > v[2]) != (v[1] > v[2]));
      std::sort(v.begin(), v.end());
      faces.push_back({ PairKey(v[0], v[1]), v[2], static_cast<IdType>(t), static_cast<std::int8_t>(side), odd });
    }
  }
  std::sort(faces.begin(), faces.end(), [](const FaceUse & a, const FaceUse & b) {
    if (a.lowMiddle != b.lowMiddle)
    {
      return a.lowMiddle < b.lowMiddle;
    }
    return a.high != b.high ? a.high < b.high : a.tetra < b.tetra;
  });
  return faces;
}

// Calls visit(first, last) for the uses of each face.
template <typename TVisitor>
void
ForEachFace(const std::vector<FaceUse> & faces, TVisitor && visit)
{
  for (auto first = faces.begin(); first != faces.end();)
  {
    const auto last = std::find_if(first, faces.end(), [&](const FaceUse & face) { return !face.SameFace(*first); });
    visit(first, last);
    first = last;
  }
}

// Faces met by exactly one tetrahedron that `inside` accepts, with that tetrahedron.
struct Surface
{
  std::vector<Triangle> faces;
  std::vector<IdType>   owner;
};

template <typename TInside>
Surface
ExtractSurface(const std::vector<FaceUse> & faces, const std::vector<Id4> & tetrahedra, TInside && inside)
{
  Surface surface;
  ForEachFace(faces, [&](auto first, auto last) {
    const auto member = [&](const FaceUse & use) { return inside(use.tetra); };
    if (std::count_if(first, last, member) != 1)
    {
      return;
    }
    const FaceUse & use = *std::find_if(first, last, member);
    const Id4 &     v = tetrahedra[use.tetra];
    const auto &    local = TetraFaces[use.side];
    surface.faces.push_back({ v[local[0]], v[local[1]], v[local[2]] });
    surface.owner.push_back(use.tetra);
  });
  return surface;
}

std::vector<EdgeUse>
EdgesOf(const Surface & surface)
{
  return SortedEdges(surface.faces.size(), [&surface](std::size_t f, std::size_t i) { return surface.faces[f][i]; });
}

// Numbers of a surface's fans: corners joined across edges, one root a fan.
std::size_t
CheckFans(const Surface & surface, DisjointSets & corners, const std::string & where, MeshCheck & check)
{
  std::vector<std::pair<IdType, std::size_t>> fans;
  for (std::size_t c = 0; c < 3 * surface.faces.size(); ++c)
  {
    if (corners.Find(c) == c)
    {
      fans.emplace_back(surface.faces[c / 3][c % 3], c);
    }
  }
  std::sort(fans.begin(), fans.end());
  std::size_t vertices = 0;
  for (std::size_t i = 0; i < fans.size();)
  {
    std::size_t end = i + 1;
    while (end < fans.size() && fans[end].first == fans[i].first)
    {
      ++end;
    }
    ++vertices;
    if (end - i > 1)
    {
      Fail(
        check, "point ", fans[i].first, where, " is shared by ", end - i, " sheets that meet nowhere else around it");
    }
    i = end;
  }
  return vertices;
}

// Every edge with two faces, every vertex with one fan; returns the Euler characteristic.
int
CheckClosedManifold(const Surface & surface, const std::string & where, MeshCheck & check)
{
  const auto   edges = EdgesOf(surface);
  std::size_t  numberOfEdges = 0;
  DisjointSets corners(3 * surface.faces.size());
  const auto   vertexOf = [&](std::uint32_t corner) { return surface.faces[corner / 3][corner % 3]; };
  const auto   next = [](std::uint32_t corner) { return corner - corner % 3 + (corner + 1) % 3; };
  ForEachEdge(edges, [&](auto first, auto last) {
    ++numberOfEdges;
    if (last - first != 2)
    {
      Fail(
        check, "edge (", first->key >> 32, ", ", first->key & 0xffffffffu, ")", where, " has ", last - first, " faces");
    }
    for (auto other = first + 1; other != last; ++other)
    {
      const std::uint32_t a = first->corner, b = other->corner;
      const bool          sameWay = vertexOf(a) == vertexOf(b);
      corners.Unite(a, sameWay ? b : next(b));
      corners.Unite(next(a), sameWay ? next(b) : b);
    }
  });
  const std::size_t vertices = CheckFans(surface, corners, where, check);
  return static_cast<int>(static_cast<std::ptrdiff_t>(vertices) - static_cast<std::ptrdiff_t>(numberOfEdges) +
                          static_cast<std::ptrdiff_t>(surface.faces.size()));
}

bool
IdsInRange(const MeshArrays & mesh, MeshCheck & check)
{
  const auto np = static_cast<IdType>(mesh.points.size());
  if (mesh.tetrahedra.empty())
  {
    Fail(check, "there are no tetrahedra");
  }
  bool inRange = true;
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
  {
    for (IdType v : mesh.tetrahedra[t])
    {
      if (v < 0 || v >= np)
      {
        Fail(check, "tetrahedron ", t, " names point ", v, " where there are ", np, " points");
        inRange = false;
      }
    }
  }
  return inRange;
}

std::vector<bool>
CheckFinite(const MeshArrays & mesh, MeshCheck & check)
{
  std::vector<bool> finite(mesh.points.size());
  for (std::size_t p = 0; p < mesh.points.size(); ++p)
  {
    finite[p] = mesh.points[p].allFinite();
    if (!finite[p])
    {
      Fail(check, "point ", p, " has a coordinate that is not finite");
    }
  }
  return finite;
}

void
CheckDistinct(const MeshArrays & mesh, MeshCheck & check)
{
  struct Cell
  {
    Id4         vertices;
    std::size_t tetra;
  };
  std::vector<Cell> cells(mesh.tetrahedra.size());
  for (std::size_t t = 0; t < cells.size(); ++t)
  {
    Id4 v = mesh.tetrahedra[t];
    std::sort(v.begin(), v.end());
    cells[t] = { v, t };
    if (std::adjacent_find(v.begin(), v.end()) != v.end())
    {
      Fail(check, "tetrahedron ", t, " repeats a vertex");
    }
  }
  std::sort(cells.begin(), cells.end(), [](const Cell & a, const Cell & b) {
    return a.vertices != b.vertices ? a.vertices < b.vertices : a.tetra < b.tetra;
  });
  for (std::size_t i = 1; i < cells.size(); ++i)
  {
    if (cells[i].vertices == cells[i - 1].vertices)
    {
      Fail(check, "tetrahedra ", cells[i - 1].tetra, " and ", cells[i].tetra, " have the same vertices");
    }
  }
}

void
CheckOrientation(const MeshArrays & mesh, const std::vector<bool> & finite, MeshCheck & check)
{
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
  {
    const Id4 & v = mesh.tetrahedra[t];
    if (!(finite[v[0]] && finite[v[1]] && finite[v[2]] && finite[v[3]]))
    {
      continue;
    }
    const int sign = Orient3D(mesh.points[v[0]], mesh.points[v[1]], mesh.points[v[2]], mesh.points[v[3]]);
    if (sign <= 0)
    {
      Fail(check, "tetrahedron ", t, sign < 0 ? " is inverted" : " is flat");
    }
  }
}

void
CheckFaces(const std::vector<FaceUse> & faces, MeshCheck & check)
{
  ForEachFace(faces, [&](auto first, auto last) {
    if (last - first > 2)
    {
      Fail(check, FaceName(*first), " belongs to ", last - first, " tetrahedra");
    }
    else if (last - first == 2 && first->odd == first[1].odd)
    {
      Fail(check, FaceName(*first), " has tetrahedra ", first->tetra, " and ", first[1].tetra, " on the same side");
    }
  });
}

void
CheckNeighbors(const MeshArrays & mesh, const std::vector<FaceUse> & faces, MeshCheck & check)
{
  if (mesh.neighbors.empty())
  {
    return;
  }
  if (mesh.neighbors.size() != mesh.tetrahedra.size())
  {
    Fail(check, mesh.neighbors.size(), " rows of neighbours for ", mesh.tetrahedra.size(), " tetrahedra");
    return;
  }
  const auto expect = [&](const FaceUse & use, IdType expected) {
    const IdType found = mesh.neighbors[use.tetra][use.side];
    if (found != expected)
    {
      Fail(check,
           "neighbour ",
           static_cast<int>(use.side),
           " of tetrahedron ",
           use.tetra,
           " is given as ",
           found,
           " but is ",
           expected);
    }
  };
  ForEachFace(faces, [&](auto first, auto last) {
    for (auto use = first; use != last; ++use)
    {
      expect(*use, last - first == 2 ? (use == first ? first + 1 : first)->tetra : -1);
    }
  });
}

void
CheckInterfaces(const MeshArrays & mesh, const std::vector<FaceUse> & faces, MeshCheck & check)
{
  if (mesh.region.empty())
  {
    return;
  }
  if (mesh.region.size() != mesh.tetrahedra.size())
  {
    Fail(check, mesh.region.size(), " regions for ", mesh.tetrahedra.size(), " tetrahedra");
    return;
  }
  std::vector<int> regions = mesh.region;
  std::sort(regions.begin(), regions.end());
  regions.erase(std::unique(regions.begin(), regions.end()), regions.end());
  // The union from the smallest region on is the whole body, whose boundary has its own check.
  for (std::size_t i = 1; i < regions.size(); ++i)
  {
    const int k = regions[i];
    if (k > 1)
    {
      const auto surface =
        ExtractSurface(faces, mesh.tetrahedra, [&](IdType tetra) { return mesh.region[tetra] >= k; });
      CheckClosedManifold(surface, Say(" of the interface around region ", k), check);
    }
  }
}

void
CheckPoints(const MeshArrays & mesh, const std::vector<bool> & finite, MeshCheck & check)
{
  std::vector<bool> used(mesh.points.size(), false);
  for (const Id4 & tetra : mesh.tetrahedra)
  {
    for (IdType v : tetra)
    {
      used[v] = true;
    }
  }
  std::vector<std::size_t> order;
  for (std::size_t p = 0; p < mesh.points.size(); ++p)
  {
    if (!used[p])
    {
      Fail(check, "no tetrahedron uses point ", p);
    }
    if (finite[p])
    {
      order.push_back(p);
    }
  }
  const auto less = [&](std::size_t a, std::size_t b) {
    const Vector3 & p = mesh.points[a];
    const Vector3 & q = mesh.points[b];
    return std::lexicographical_compare(p.data(), p.data() + 3, q.data(), q.data() + 3);
  };
  std::sort(
    order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return less(a, b) || (!less(b, a) && a < b); });
  for (std::size_t i = 1; i < order.size(); ++i)
  {
    if (mesh.points[order[i]] == mesh.points[order[i - 1]])
    {
      Fail(check, "points ", order[i - 1], " and ", order[i], " coincide");
    }
  }
}

// The tetrahedra joined across faces.
DisjointSets
BodyComponents(const std::vector<FaceUse> & faces, std::size_t numberOfTetrahedra)
{
  DisjointSets body(numberOfTetrahedra);
  ForEachFace(faces, [&](auto first, auto last) {
    for (auto use = first + 1; use != last; ++use)
    {
      body.Unite(first->tetra, use->tetra);
    }
  });
  return body;
}

// The boundary's faces joined across edges, where they belong to one component of the body.
DisjointSets
BoundarySheets(const Surface & boundary, DisjointSets & body)
{
  DisjointSets sheets(boundary.faces.size());
  ForEachEdge(EdgesOf(boundary), [&](auto first, auto last) {
    for (auto a = first; a != last; ++a)
    {
      for (auto b = a + 1; b != last; ++b)
      {
        const std::size_t f = a->corner / 3, g = b->corner / 3;
        if (body.Find(boundary.owner[f]) == body.Find(boundary.owner[g]))
        {
          sheets.Unite(f, g);
        }
      }
    }
  });
  return sheets;
}

// Of the sheets of a component of the body the one that reaches furthest along x is its outside; every other one
// encloses a void.
void
CheckVoids(const MeshArrays & mesh, const Surface & boundary, DisjointSets & body, MeshCheck & check)
{
  DisjointSets sheets = BoundarySheets(boundary, body);
  struct Face
  {
    std::size_t component, sheet, face;
    double      reach;
  };
  std::vector<Face> furthest;
  for (std::size_t f = 0; f < boundary.faces.size(); ++f)
  {
    double reach = -std::numeric_limits<double>::infinity();
    for (IdType v : boundary.faces[f])
    {
      reach = std::max(reach, mesh.points[v].x());
    }
    furthest.push_back({ body.Find(boundary.owner[f]), sheets.Find(f), f, reach });
  }
  std::sort(furthest.begin(), furthest.end(), [](const Face & a, const Face & b) {
    if (a.component != b.component)
    {
      return a.component < b.component;
    }
    return a.reach != b.reach ? a.reach > b.reach : a.face < b.face;
  });
  for (std::size_t i = 0, outside = 0; i < furthest.size(); ++i)
  {
    if (i == 0 || furthest[i].component != furthest[i - 1].component)
    {
      outside = furthest[i].sheet;
    }
    else if (furthest[i].sheet != outside && furthest[i].sheet == furthest[i].face)
    {
      Fail(check, "the body encloses a void next to point ", boundary.faces[furthest[i].face][0]);
    }
  }
}
} // namespace

bool
MeshValidation::IsValid() const
{
  return std::all_of(checks.begin(), checks.end(), [](const MeshCheck & check) { return check.failures == 0; });
}

std::string
MeshValidation::Summary() const
{
  const auto failed =
    std::find_if(checks.begin(), checks.end(), [](const MeshCheck & check) { return check.failures > 0; });
  if (failed == checks.end())
  {
    return "valid";
  }
  return Say("the check '",
             failed->name,
             "' fails in ",
             failed->failures,
             failed->failures == 1 ? " place: " : " places, the first: ",
             failed->examples.front());
}

MeshValidation
ValidateMesh(const MeshArrays & mesh)
{
  MeshValidation result;
  result.checks.reserve(8); // references to checks stay good
  const auto begin = [&result](const char * name) -> MeshCheck & {
    result.checks.push_back({ name, 0, {} });
    return result.checks.back();
  };
  MeshCheck & ids = begin("ids");
  const bool  inRange = IdsInRange(mesh, ids);
  const auto  finite = CheckFinite(mesh, ids);
  if (!inRange)
  {
    return result;
  }
  CheckDistinct(mesh, ids);
  CheckOrientation(mesh, finite, begin("positive orientation"));
  const auto faces = SortedFaces(mesh.tetrahedra);
  CheckFaces(faces, begin("face manifold"));
  const auto boundary = ExtractSurface(faces, mesh.tetrahedra, [](IdType) { return true; });
  result.boundaryEuler = CheckClosedManifold(boundary, " of the boundary", begin("closed 2-manifold boundary"));
  CheckNeighbors(mesh, faces, begin("face neighbours"));
  CheckInterfaces(mesh, faces, begin("interfaces"));
  CheckPoints(mesh, finite, begin("points"));
  DisjointSets body = BodyComponents(faces, mesh.tetrahedra.size());
  result.components = static_cast<int>(body.Count());
  CheckVoids(mesh, boundary, body, begin("voids"));
  return result;
}

std::string
FindTopologyObstacle(const MeshArrays & mesh)
{
  MeshValidation result;
  result.checks = { { "ids", 0, {} }, { "face manifold", 0, {} } };
  if (IdsInRange(mesh, result.checks[0]))
  {
    CheckDistinct(mesh, result.checks[0]);
    CheckFaces(SortedFaces(mesh.tetrahedra), result.checks[1]);
  }
  return result.IsValid() ? "" : result.Summary();
}
} // namespace bone
