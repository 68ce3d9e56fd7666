/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneTetraComplex.h"

#include <algorithm>
#include <utility>

namespace bone
{
namespace
{
using Pair = std::pair<IdType, IdType>;

Pair
Ordered(IdType a, IdType b)
{
  return a < b ? Pair(a, b) : Pair(b, a);
}

bool
Contains(const std::vector<IdType> & values, IdType value)
{
  return std::find(values.begin(), values.end(), value) != values.end();
}

template <typename T>
void
SortUnique(std::vector<T> & values)
{
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

/** Whether every value that is in both a and b is in c, all sorted. */
template <typename T>
bool
CommonIsWithin(const std::vector<T> & a, const std::vector<T> & b, const std::vector<T> & c)
{
  std::vector<T> common;
  std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(common));
  return std::includes(c.begin(), c.end(), common.begin(), common.end());
}

/** Vertices and edges of the link of v, and of the link of the edge v w, in the complex of surface faces. */
struct SurfaceLink
{
  std::vector<IdType> vertices;
  std::vector<Pair>   edges;
  std::vector<IdType> edgeVertices;
  bool                hasEdge{ false };

  SurfaceLink(const TetraComplex & complex, IdType v, IdType w)
  {
    std::vector<TetraComplex::SurfaceFace> faces;
    complex.SurfaceStar(v, faces);
    for (const auto & face : faces)
    {
      if (face.a == w || face.b == w)
      {
        hasEdge = true;
        edgeVertices.push_back(face.a == w ? face.b : face.a);
        vertices.push_back(edgeVertices.back());
      }
      else
      {
        vertices.insert(vertices.end(), { face.a, face.b });
        edges.push_back(Ordered(face.a, face.b));
      }
    }
    SortUnique(vertices);
    SortUnique(edges);
    SortUnique(edgeVertices);
  }
};

std::array<IdType, 3>
FaceKey(const Id4 & cell, int i)
{
  std::array<IdType, 3> key = { cell[TetraFaces[i][0]], cell[TetraFaces[i][1]], cell[TetraFaces[i][2]] };
  std::sort(key.begin(), key.end());
  return key;
}
} // namespace

const char *
MeshOperationName(MeshOperation operation)
{
  static constexpr const char * names[MeshOperationCount] = { "done",        "surface",  "topology",
                                                              "orientation", "quality",  "overlap",
                                                              "density",     "distance", "volume" };
  return names[static_cast<int>(operation)];
}

TetraComplex::TetraComplex(const MeshArrays & mesh)
  : m_Points(mesh.points)
  , m_Cells(mesh.tetrahedra)
  , m_Neighbors(mesh.neighbors.empty() ? ComputeFaceNeighbors(mesh.tetrahedra) : mesh.neighbors)
  , m_Region(mesh.region.empty() ? std::vector<int>(mesh.tetrahedra.size(), Cortical) : mesh.region)
  , m_Star(mesh.points.size())
  , m_AliveCount(static_cast<IdType>(mesh.tetrahedra.size()))
  , m_Changed(mesh.points.size(), 0)
{
  if (mesh.neighbors.empty())
  {
    MeshArrays withNeighbors;
    withNeighbors.points = mesh.points;
    withNeighbors.tetrahedra = mesh.tetrahedra;
    withNeighbors.neighbors = m_Neighbors;
    withNeighbors.region = m_Region;
    m_Surfaces = FindSurfaces(withNeighbors);
  }
  else
  {
    m_Surfaces = FindSurfaces(mesh);
  }
  for (std::size_t t = 0; t < m_Cells.size(); ++t)
  {
    for (IdType p : m_Cells[t])
    {
      m_Star[p].push_back(static_cast<IdType>(t));
    }
  }
}

std::vector<IdType>
TetraComplex::PointNeighbors(IdType p) const
{
  std::vector<IdType> neighbors;
  for (IdType t : m_Star[p])
  {
    for (IdType q : m_Cells[t])
    {
      if (q != p && !Contains(neighbors, q))
      {
        neighbors.push_back(q);
      }
    }
  }
  return neighbors;
}

void
TetraComplex::SurfaceStar(IdType p, std::vector<SurfaceFace> & faces) const
{
  faces.clear();
  if (m_Surfaces.dimension[p] == 3)
  {
    return;
  }
  for (IdType t : m_Star[p])
  {
    const Id4 & c = m_Cells[t];
    for (int i = 0; i < 4; ++i)
    {
      if (c[i] == p || !Carries(t, i))
      {
        continue;
      }
      const auto & f = TetraFaces[i];
      const int    k = c[f[0]] == p ? 0 : c[f[1]] == p ? 1 : 2;
      faces.push_back({ c[f[(k + 1) % 3]], c[f[(k + 2) % 3]], m_Surfaces.faceSurface[t][i], t });
    }
  }
}

void
TetraComplex::EraseFromStar(IdType p, IdType t)
{
  auto & star = m_Star[p];
  star.erase(std::find(star.begin(), star.end(), t));
}

void
TetraComplex::SetNeighbor(IdType t, IdType oldNeighbor, IdType newNeighbor, int surface)
{
  if (t < 0)
  {
    return;
  }
  Id4 &     neighbors = m_Neighbors[t];
  const int i = static_cast<int>(std::find(neighbors.begin(), neighbors.end() - 1, oldNeighbor) - neighbors.begin());
  neighbors[i] = newNeighbor;
  m_Surfaces.faceSurface[t][i] = surface;
}

void
TetraComplex::NoteChange(const std::vector<IdType> & cells)
{
  ++m_Clock;
  for (IdType t : cells)
  {
    for (IdType p : m_Cells[t])
    {
      m_Changed[p] = m_Clock;
    }
  }
}

std::vector<IdType>
TetraComplex::EdgeStar(IdType a, IdType b) const
{
  std::vector<IdType> cells;
  for (IdType t : m_Star[a])
  {
    if (Has(t, b))
    {
      cells.push_back(t);
    }
  }
  return cells;
}

std::vector<TetraComplex::OuterFace>
TetraComplex::TakeOut(const std::vector<IdType> & removed)
{
  std::vector<OuterFace> outer;
  for (IdType t : removed)
  {
    for (int i = 0; i < 4; ++i)
    {
      if (m_Neighbors[t][i] < 0 || !Contains(removed, m_Neighbors[t][i]))
      {
        outer.push_back({ FaceKey(m_Cells[t], i), m_Neighbors[t][i], m_Surfaces.faceSurface[t][i], false, false });
      }
    }
    for (IdType p : m_Cells[t])
    {
      EraseFromStar(p, t);
    }
  }
  return outer;
}

std::vector<IdType>
TetraComplex::AllocateSlots(const std::vector<IdType> & removed, std::size_t count)
{
  std::vector<IdType> ids(removed.begin(), removed.begin() + std::min(removed.size(), count));
  for (std::size_t k = ids.size(); k < count; ++k)
  {
    ids.push_back(Size());
    m_Cells.emplace_back();
    m_Neighbors.emplace_back();
    m_Region.push_back(0);
    m_Surfaces.faceSurface.emplace_back();
  }
  for (std::size_t k = count; k < removed.size(); ++k)
  {
    m_Cells[removed[k]] = Id4{ -1, -1, -1, -1 };
  }
  m_AliveCount += static_cast<IdType>(count) - static_cast<IdType>(removed.size());
  return ids;
}

void
TetraComplex::LinkFaces(const std::vector<IdType> & cells, std::vector<OuterFace> & outer, int surface)
{
  // By its vertices: while slots are reused, an id alone could name two faces.
  const auto setBack = [this](IdType t, const std::array<IdType, 3> & key, IdType neighbor, int s) {
    for (int j = 0; j < 4; ++j)
    {
      if (FaceKey(m_Cells[t], j) == key)
      {
        m_Neighbors[t][j] = neighbor;
        m_Surfaces.faceSurface[t][j] = s;
      }
    }
  };
  for (IdType t : cells)
  {
    for (int i = 0; i < 4; ++i)
    {
      const auto key = FaceKey(m_Cells[t], i);
      const auto at = std::find_if(outer.begin(), outer.end(), [&key](const OuterFace & f) { return f.key == key; });
      if (at == outer.end())
      {
        // An inner face, whose other cell finds it here; or, where there is none, one of the surface.
        m_Neighbors[t][i] = -1;
        m_Surfaces.faceSurface[t][i] = surface;
        outer.push_back({ key, t, -1, true, false });
        continue;
      }
      at->used = true;
      const bool newSurface = at->neighbor >= 0 && at->surface < 0 && m_Region[at->neighbor] != m_Region[t];
      const int  s = newSurface ? surface : at->surface;
      m_Neighbors[t][i] = at->neighbor;
      m_Surfaces.faceSurface[t][i] = s;
      if (at->neighbor >= 0)
      {
        setBack(at->neighbor, key, t, s);
      }
    }
  }
  for (const OuterFace & face : outer)
  {
    if (!face.used && !face.inner && face.neighbor >= 0)
    {
      setBack(face.neighbor, face.key, -1, surface);
    }
  }
}

std::vector<IdType>
TetraComplex::Replace(const std::vector<IdType> & removed, const std::vector<Id4> & created)
{
  return ReplaceAcross(removed, created, std::vector<int>(created.size(), m_Region[removed.front()]), -1);
}

std::vector<IdType>
TetraComplex::ReplaceAcross(const std::vector<IdType> & removed,
                            const std::vector<Id4> &    created,
                            const std::vector<int> &    regions,
                            int                         surface)
{
  NoteChange(removed);
  std::vector<OuterFace>    outer = TakeOut(removed);
  const std::vector<IdType> ids = AllocateSlots(removed, created.size());
  for (std::size_t k = 0; k < ids.size(); ++k)
  {
    m_Cells[ids[k]] = created[k];
    m_Region[ids[k]] = regions[k];
    for (IdType p : created[k])
    {
      m_Star[p].push_back(ids[k]);
    }
  }
  LinkFaces(ids, outer, surface);
  NoteChange(ids);
  return ids;
}

IdType
TetraComplex::SplitEdge(IdType a, IdType b, const Vector3 & x)
{
  const IdType n = static_cast<IdType>(m_Points.size());
  m_Points.push_back(x);
  m_Star.emplace_back();
  m_Changed.push_back(0);
  m_Surfaces.dimension.push_back(3);
  m_Surfaces.curve.emplace_back();
  m_Parent.push_back(a);
  const std::vector<IdType> removed = EdgeStar(a, b);
  std::vector<Id4>          created;
  for (IdType t : removed)
  {
    for (IdType p : { a, b })
    {
      created.push_back(m_Cells[t]);
      created.back()[LocalIndex(t, p)] = n;
    }
  }
  Replace(removed, created);
  return n;
}

MeshOperation
TetraComplex::CanCollapse(IdType v, IdType w) const
{
  const int dimension = m_Surfaces.dimension[v];
  if (dimension == 0 || (dimension == 1 && !Contains(m_Surfaces.curve[v], w)))
  {
    return MeshOperation::Surface;
  }
  if (dimension < 3)
  {
    const SurfaceLink a(*this, v, w);
    if (!a.hasEdge)
    {
      return MeshOperation::Surface;
    }
    const SurfaceLink b(*this, w, v);
    if (!CommonIsWithin(a.vertices, b.vertices, a.edgeVertices) || !CommonIsWithin(a.edges, b.edges, {}))
    {
      return MeshOperation::Topology;
    }
    if (!CommonIsWithin(m_Surfaces.curve[v], m_Surfaces.curve[w], {}))
    {
      return MeshOperation::Topology;
    }
  }
  for (IdType t : m_Star[v])
  {
    const IdType opposite = m_Neighbors[t][LocalIndex(t, v)];
    if (opposite >= 0 && !Has(t, w) && Has(opposite, w))
    {
      return MeshOperation::Topology;
    }
  }
  return LinksMeetInEdgeLink(v, w) ? MeshOperation::Done : MeshOperation::Topology;
}

bool
TetraComplex::LinksMeetInEdgeLink(IdType v, IdType w) const
{
  // Neighbours of v are marked with 1, those that w shares by the edge's link with 2. The star of w may be large.
  thread_local std::vector<char> marks; // 0 between calls
  std::vector<char> &            mark = marks;
  mark.resize(std::max(mark.size(), m_Points.size()), 0);
  for (IdType t : m_Star[v])
  {
    const char kind = Has(t, w) ? 2 : 1;
    for (IdType p : m_Cells[t])
    {
      mark[p] = std::max(mark[p], kind);
    }
  }
  // An edge of v's link that is none of the edge's.
  const auto sharedEdge = [&](IdType p, IdType q) {
    bool found = false;
    for (IdType t : m_Star[v])
    {
      if (Has(t, p) && Has(t, q))
      {
        if (Has(t, w))
        {
          return false;
        }
        found = true;
      }
    }
    return found;
  };
  bool meet = true;
  for (std::size_t k = 0; k < m_Star[w].size() && meet; ++k)
  {
    IdType shared[3];
    int    n = 0;
    for (IdType p : m_Cells[m_Star[w][k]])
    {
      if (p != v && p != w && mark[p] > 0)
      {
        meet = meet && mark[p] == 2;
        shared[n++] = p;
      }
    }
    if (meet && n > 1 && !Has(m_Star[w][k], v))
    {
      meet = !sharedEdge(shared[0], shared[1]) &&
             (n < 3 || (!sharedEdge(shared[0], shared[2]) && !sharedEdge(shared[1], shared[2])));
    }
  }
  for (IdType t : m_Star[v])
  {
    for (IdType p : m_Cells[t])
    {
      mark[p] = 0;
    }
  }
  return meet;
}

std::vector<IdType>
TetraComplex::Collapse(IdType v, IdType w)
{
  std::vector<IdType>       changed;
  const std::vector<IdType> star = std::move(m_Star[v]);
  NoteChange(star);
  m_Star[v].clear();
  for (IdType t : star)
  {
    const int i = LocalIndex(t, v);
    if (!Has(t, w))
    {
      m_Cells[t][i] = w;
      m_Star[w].push_back(t);
      changed.push_back(t);
      continue;
    }
    const int    j = LocalIndex(t, w);
    const IdType atV = m_Neighbors[t][j], atW = m_Neighbors[t][i];
    const int    surface = std::max(m_Surfaces.faceSurface[t][i], m_Surfaces.faceSurface[t][j]);
    SetNeighbor(atV, t, atW, surface);
    SetNeighbor(atW, t, atV, surface);
    for (IdType p : m_Cells[t])
    {
      if (p != v)
      {
        EraseFromStar(p, t);
      }
    }
    m_Cells[t] = Id4{ -1, -1, -1, -1 };
    --m_AliveCount;
  }
  if (m_Surfaces.dimension[v] == 1)
  {
    auto &       curve = m_Surfaces.curve;
    const IdType x = curve[v][0] == w ? curve[v][1] : curve[v][0];
    std::replace(curve[w].begin(), curve[w].end(), v, x);
    std::replace(curve[x].begin(), curve[x].end(), v, w);
    std::sort(curve[w].begin(), curve[w].end());
    std::sort(curve[x].begin(), curve[x].end());
    curve[v].clear();
  }
  return changed;
}

MeshArrays
TetraComplex::Compact(const MeshArrays & source, std::vector<IdType> & pointId, std::vector<IdType> & cellSlot) const
{
  MeshArrays          mesh;
  std::vector<IdType> newId(m_Cells.size(), -1);
  cellSlot.clear();
  for (IdType t = 0; t < Size(); ++t)
  {
    if (IsAlive(t))
    {
      newId[t] = static_cast<IdType>(cellSlot.size());
      cellSlot.push_back(t);
    }
  }
  mesh.points = m_Points;
  mesh.layer = source.layer;
  mesh.slice = source.slice;
  for (std::size_t k = 0; k < m_Parent.size(); ++k)
  {
    const IdType p = static_cast<IdType>(source.points.size() + k);
    if (!source.layer.empty())
    {
      mesh.layer.push_back(m_Star[p].empty() ? 0 : m_Region[m_Star[p].front()]);
    }
    if (!source.slice.empty())
    {
      mesh.slice.push_back(mesh.slice[m_Parent[k]]);
    }
  }
  for (IdType t : cellSlot)
  {
    mesh.tetrahedra.push_back(m_Cells[t]);
    Id4 neighbors = m_Neighbors[t];
    for (IdType & n : neighbors)
    {
      n = n < 0 ? -1 : newId[n];
    }
    mesh.neighbors.push_back(neighbors);
    if (!source.region.empty())
    {
      mesh.region.push_back(m_Region[t]);
    }
  }
  pointId = RemoveUnusedPoints(mesh);
  return mesh;
}

std::vector<std::array<IdType, 3>>
BoundaryFaces(const TetraComplex & complex)
{
  std::vector<std::array<IdType, 3>> faces;
  for (IdType t = 0; t < complex.Size(); ++t)
  {
    for (int i = 0; i < 4 && complex.IsAlive(t); ++i)
    {
      if (complex.Neighbors(t)[i] < 0)
      {
        const Id4 & c = complex.Cell(t);
        faces.push_back({ { c[TetraFaces[i][0]], c[TetraFaces[i][1]], c[TetraFaces[i][2]] } });
      }
    }
  }
  return faces;
}

double
MeanBoundaryEdge(const TetraComplex & complex)
{
  const auto faces = BoundaryFaces(complex);
  double     sum = 0.0;
  for (const auto & face : faces)
  {
    sum += (complex.Points()[face[0]] - complex.Points()[face[1]]).norm();
  }
  return sum > 0 ? sum / static_cast<double>(faces.size()) : 1.0;
}
} // namespace bone
