/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSlabFiller.h"

#include "bonePredicates.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace bone
{
namespace tiling
{
namespace
{
constexpr double LinkShare = 0.15;        ///< of a part's area, by which two parts of a layer belong together
constexpr double LeastVolume = 1e-11;     ///< mm^3, of a cell that is not thin
constexpr double SurfaceTolerance = 0.12; ///< of the slab's height

/** One step of regions between neighbours at most: from `from` down to `to` within `steps` steps, staying bone as long
 * as it can. */
void
AppendDescent(int from, int to, int steps, Column & column)
{
  for (int i = 1; i <= steps; ++i)
  {
    column.push_back(i == steps ? to : std::max({ to, from - i, from > 0 ? 1 : 0 }));
  }
}

Column
MakeColumn(int lower, int upper, bool together, int steps, bool separated)
{
  Column column{ lower };
  if (separated)
  {
    const int between = together ? std::min(lower, upper) : 0;
    AppendDescent(lower, between, steps, column);
    Column down{ upper };
    AppendDescent(upper, between, steps, down);
    column.insert(column.end(), down.rbegin() + 1, down.rend());
  }
  else if (lower >= upper)
  {
    AppendDescent(lower, upper, steps, column);
  }
  else
  {
    Column down{ upper };
    AppendDescent(upper, lower, steps, down);
    column.assign(down.rbegin(), down.rend());
  }
  return column;
}

/** True where links between lower and upper pieces join all pieces of a group. */
bool
Joined(const Group & group, const std::set<std::array<int, 2>> & links)
{
  std::set<int> lower{ group.lower.front() }, upper;
  for (std::size_t before = 0; lower.size() + upper.size() > before;)
  {
    before = lower.size() + upper.size();
    for (const auto & link : links)
    {
      if (lower.count(link[0]) > 0 || upper.count(link[1]) > 0)
      {
        lower.insert(link[0]);
        upper.insert(link[1]);
      }
    }
  }
  return lower.size() == group.lower.size() && upper.size() == group.upper.size();
}
} // namespace

SlabFiller::SlabFiller(const ContourStack &  stack,
                       const SlabSide &      lower,
                       const SlabSide &      upper,
                       int                   slice,
                       const VertexPool &    pool,
                       std::vector<PieceCut> cuts,
                       const Execution &     execution)
  : m_Stack(stack)
  , m_Sides{ &lower, &upper }
  , m_Slice(slice)
  , m_Pool(pool)
  , m_Cuts(std::move(cuts))
  , m_Overlay(OverlaySides(lower, upper, execution))
{}

double
SlabFiller::CommonArea() const
{
  double common = 0.0;
  for (const auto & t : m_Overlay.triangles)
  {
    if (m_Sides[0]->region[t.first] == m_Sides[1]->region[t.second] && Together(t))
    {
      const auto &  p = m_Overlay.points;
      const Vector2 d = p[t.vertices[1]] - p[t.vertices[0]], e = p[t.vertices[2]] - p[t.vertices[0]];
      common += 0.5 * (d.x() * e.y() - d.y() * e.x());
    }
  }
  return common;
}

std::set<LayerLink>
SlabFiller::Links() const
{
  const auto &below = *m_Sides[0], &above = *m_Sides[1];
  return FindLayerLinks({ { &below.box, &above.box } },
                        { { &below.region, &above.region } },
                        { { &below.group, &above.group } },
                        m_Overlay,
                        LinkShare);
}

std::vector<int>
SlabFiller::SeparatedGroups(const std::vector<Group> & groups) const
{
  std::set<std::array<int, 2>> links;
  for (const auto & t : m_Overlay.triangles)
  {
    if (Together(t))
    {
      links.insert({ { m_Sides[0]->piece[t.first], m_Sides[1]->piece[t.second] } });
    }
  }
  std::vector<int> separated;
  for (std::size_t g = 0; g < groups.size(); ++g)
  {
    if (!groups[g].lower.empty() && !groups[g].upper.empty() && !Joined(groups[g], links))
    {
      separated.push_back(static_cast<int>(g));
    }
  }
  return separated;
}

SlabFilling
SlabFiller::Run(double low, double high, const Execution & execution, bool & thin)
{
  MakeColumns();
  MakePoints(low, high);
  FillPrisms();
  FillMiddle();
  for (const Id4 & c : m_Mesh.tetrahedra)
  {
    const auto & p = m_Mesh.points;
    if (Orient3D(p[c[0]], p[c[1]], p[c[2]], p[c[3]]) <= 0)
    {
      throw std::runtime_error("its contours are too close to be told apart");
    }
  }
  const MeshArrays mesh = CollapseSteinerPoints(m_Mesh, m_FirstSteiner, PlacesOf(low, high), execution);
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
  {
    const Id4 &  c = mesh.tetrahedra[t];
    const auto & p = mesh.points;
    thin = thin || (mesh.region[t] > 0 && !(SignedVolume(p[c[0]], p[c[1]], p[c[2]], p[c[3]]) > LeastVolume));
  }
  return BoneOf(mesh);
}

bool
SlabFiller::Together(const PlanarOverlay::Triangle & t) const
{
  return m_Sides[0]->group[t.first] >= 0 && m_Sides[0]->group[t.first] == m_Sides[1]->group[t.second];
}

void
SlabFiller::MakeColumns()
{
  int  jump = 1;
  bool separated = false;
  for (const auto & t : m_Overlay.triangles)
  {
    const int a = m_Sides[0]->region[t.first], b = m_Sides[1]->region[t.second];
    jump = std::max(jump, std::abs(a - b));
    separated = separated || (a > 0 && b > 0 && m_Sides[0]->group[t.first] != m_Sides[1]->group[t.second]);
  }
  if (separated)
  {
    // Regions end before the bone between pieces does.
    for (const auto & t : m_Overlay.triangles)
    {
      jump = std::max({ jump, m_Sides[0]->region[t.first], m_Sides[1]->region[t.second] });
    }
  }
  for (const auto & t : m_Overlay.triangles)
  {
    m_Columns.push_back(MakeColumn(m_Sides[0]->region[t.first],
                                   m_Sides[1]->region[t.second],
                                   m_Sides[0]->group[t.first] == m_Sides[1]->group[t.second],
                                   jump,
                                   separated));
  }
  m_Planes = static_cast<int>(m_Columns.front().size()) - 1;
}

Vector3
SlabFiller::At(const Vector2 & q, double height)
{
  return { q.x(), q.y(), height };
}

void
SlabFiller::MakePoints(double low, double high)
{
  for (int s = 0; s < 2; ++s)
  {
    m_First[s] = static_cast<IdType>(m_Mesh.points.size());
    for (std::size_t v = 0; v < m_Sides[s]->poolId.size(); ++v)
    {
      const int id = m_Sides[s]->poolId[v];
      m_Mesh.points.push_back(
        At(id >= 0 ? m_Pool.plane[id] : Vector2(m_Sides[s]->box.points[v] + m_Sides[s]->shift), s == 0 ? low : high));
    }
  }
  m_FirstSteiner = static_cast<IdType>(m_Mesh.points.size());
  for (int plane = 0; plane < m_Planes; ++plane)
  {
    const double share = (plane + 1.0) / (m_Planes + 1.0);
    for (const Vector2 & q : m_Overlay.points)
    {
      m_Mesh.points.push_back(At(q + share * m_Sides[1]->shift, (1 - share) * low + share * high));
    }
  }
}

SteinerPlaces
SlabFiller::PlacesOf(double low, double high) const
{
  const SlabSurface surface = FindSlabSurface({ { &m_Sides[0]->box, &m_Sides[1]->box } },
                                              { { &m_Sides[0]->region, &m_Sides[1]->region } },
                                              m_Overlay,
                                              m_Columns,
                                              MeasureCuts(m_Cuts, { { m_Sides[0], m_Sides[1] } }, m_Overlay));
  SteinerPlaces     places;
  places.tolerance = SurfaceTolerance * (high - low);
  for (std::size_t i = 0; i < surface.height.size(); ++i)
  {
    const double share = surface.height[i];
    places.ideal.push_back(share < 0 ? m_Mesh.points[m_FirstSteiner + i]
                                     : At(m_Overlay.points[i % m_Overlay.points.size()] + share * m_Sides[1]->shift,
                                          (1 - share) * low + share * high));
  }
  for (const auto & face : surface.faces)
  {
    places.faces.push_back({ { m_FirstSteiner + face[0], m_FirstSteiner + face[1], m_FirstSteiner + face[2] } });
  }
  return places;
}

IdType
SlabFiller::Steiner(int plane, int v) const
{
  return m_FirstSteiner + static_cast<IdType>(plane) * static_cast<IdType>(m_Overlay.points.size()) + v;
}

void
SlabFiller::AddCell(IdType a, IdType b, IdType c, IdType d, bool mirrored, int region)
{
  m_Mesh.tetrahedra.push_back(mirrored ? Id4{ { a, b, d, c } } : Id4{ { a, b, c, d } });
  m_Mesh.region.push_back(region);
}

void
SlabFiller::FillPrisms()
{
  for (int s = 0; s < 2; ++s)
  {
    const bool mirrored = s == 1;
    const int  plane = s == 0 ? 0 : m_Planes - 1;
    const auto rotated = [&](int t) {
      std::array<int, 3> v = m_Sides[s]->box.triangles[t];
      std::rotate(v.begin(), std::min_element(v.begin(), v.end()), v.end());
      return v;
    };
    for (const auto & t : m_Overlay.triangles)
    {
      const int owner = s == 0 ? t.first : t.second;
      AddCell(m_First[s] + rotated(owner)[0],
              Steiner(plane, t.vertices[0]),
              Steiner(plane, t.vertices[1]),
              Steiner(plane, t.vertices[2]),
              mirrored,
              m_Sides[s]->region[owner]);
    }
    for (std::size_t t = 0; t < m_Sides[s]->box.triangles.size(); ++t)
    {
      FillSideOpposite(s, plane, rotated(static_cast<int>(t)), m_Sides[s]->region[t]);
    }
  }
}

void
SlabFiller::FillSideOpposite(int s, int plane, const std::array<int, 3> & v, int region)
{
  const bool       mirrored = s == 1;
  const int        b = v[1], c = v[2];
  std::vector<int> chain = m_Overlay.chains[s].at({ { std::min(b, c), std::max(b, c) } });
  if (b > c)
  {
    std::reverse(chain.begin(), chain.end()); // from b to c now
  }
  const IdType apex = m_First[s] + v[0], fan = m_First[s] + std::min(b, c);
  for (std::size_t i = chain.size() - 1; i > 0; --i)
  {
    AddCell(apex, fan, Steiner(plane, chain[i]), Steiner(plane, chain[i - 1]), mirrored, region);
  }
  if (fan == m_First[s] + b)
  {
    AddCell(apex, fan, m_First[s] + c, Steiner(plane, chain.back()), mirrored, region);
  }
  else
  {
    AddCell(apex, fan, Steiner(plane, chain.front()), m_First[s] + b, mirrored, region);
  }
}

void
SlabFiller::FillMiddle()
{
  for (int plane = 0; plane + 1 < m_Planes; ++plane)
  {
    for (std::size_t t = 0; t < m_Overlay.triangles.size(); ++t)
    {
      auto v = m_Overlay.triangles[t].vertices;
      std::rotate(v.begin(), std::min_element(v.begin(), v.end()), v.end());
      const int    region = m_Columns[t][plane + 1];
      const IdType low[3] = { Steiner(plane, v[0]), Steiner(plane, v[1]), Steiner(plane, v[2]) };
      const IdType high[3] = { Steiner(plane + 1, v[0]), Steiner(plane + 1, v[1]), Steiner(plane + 1, v[2]) };
      AddCell(low[0], high[0], high[1], high[2], false, region);
      if (v[1] < v[2])
      {
        AddCell(low[0], low[1], low[2], high[2], false, region);
        AddCell(low[0], low[1], high[2], high[1], false, region);
      }
      else
      {
        AddCell(low[0], low[1], low[2], high[1], false, region);
        AddCell(low[0], low[2], high[2], high[1], false, region);
      }
    }
  }
}

SlabFilling
SlabFiller::BoneOf(const MeshArrays & filled) const
{
  constexpr int Unseen = std::numeric_limits<int>::max();
  SlabFilling   result;
  result.slice = m_Slice;
  result.split = static_cast<int>(m_Cuts.size());
  std::vector<int> least(filled.points.size(), std::numeric_limits<int>::max());
  for (std::size_t t = 0; t < filled.tetrahedra.size(); ++t)
  {
    for (IdType v : filled.tetrahedra[t])
    {
      least[v] = std::min(least[v], filled.region[t]);
    }
  }
  std::vector<int> id(filled.points.size(), Unseen);
  for (std::size_t t = 0; t < filled.tetrahedra.size(); ++t)
  {
    if (filled.region[t] == 0)
    {
      continue;
    }
    TiledTetra cell;
    cell.region = filled.region[t];
    for (int i = 0; i < 4; ++i)
    {
      const IdType v = filled.tetrahedra[t][i];
      if (id[v] == Unseen)
      {
        if (v < m_First[1])
        {
          id[v] = m_Sides[0]->poolId[v];
        }
        else if (v < m_FirstSteiner)
        {
          id[v] = m_Sides[1]->poolId[v - m_First[1]];
        }
        else
        {
          const Vector3 & p = filled.points[v];
          result.points.push_back(m_Stack.FromPlane({ p.x(), p.y() }, p.z()));
          result.layers.push_back(least[v]);
          id[v] = -static_cast<int>(result.points.size());
        }
      }
      cell.vertices[i] = id[v];
    }
    result.tetrahedra.push_back(cell);
  }
  VerifyInSpace(result);
  return result;
}

void
SlabFiller::VerifyInSpace(const SlabFilling & filling) const
{
  for (const TiledTetra & cell : filling.tetrahedra)
  {
    std::array<Vector3, 4> p;
    for (int i = 0; i < 4; ++i)
    {
      const IdType v = cell.vertices[i];
      p[i] = v < 0 ? filling.points[static_cast<std::size_t>(-1 - v)] : m_Pool.space[v];
    }
    if (Orient3D(p[0], p[1], p[2], p[3]) <= 0)
    {
      throw std::runtime_error("its contours are too close to be told apart");
    }
  }
}
} // namespace tiling
} // namespace bone
