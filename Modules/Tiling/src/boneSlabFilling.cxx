/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSlabFilling.h"

#include "boneConstrainedTriangulation.h"
#include "bonePlanarOverlay.h"
#include "bonePredicates.h"
#include "boneSlabSurface.h"
#include "boneSteinerCollapse.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <stdexcept>

namespace bone
{
namespace tiling
{
namespace
{
constexpr int    Corners = 4;
constexpr int    OverlayTries = 6;
constexpr double ShiftGain = 1.5;         ///< a shift leans upright walls too, so it must pay
constexpr int    UsualShifts = 2;         ///< looked at always; others where these do not do
constexpr double LeastVolume = 1e-11;     ///< mm^3, of a cell that is not thin
constexpr double SurfaceTolerance = 0.12; ///< of the slab's height
constexpr double NearPoints = 0.1;        // mm
constexpr double PartPoints = 0.4;        // mm
constexpr double Shift = 1e-5;            // mm, parts vertices of the two slices that lie over each other

/** The triangulation of a slice and of what is outside the bone. */
struct Side
{
  Vector2          shift{ Vector2::Zero() }; ///< subtracted from the slice's coordinates
  BoxTriangulation box;
  std::vector<int> poolId; ///< of each vertex; -1 for the box
  std::vector<int> region; ///< of each triangle; 0 outside
  std::vector<int> group;  ///< of each triangle; -1 outside
  std::vector<int> piece;  ///< of each triangle; -1 outside
};

struct Bounds
{
  Vector2 low, high;
};

/** A box around all contours, those of the upper slice moved by -shift. */
Bounds
BoundsOf(const VertexPool &           pool,
         const std::vector<Section> & lower,
         const std::vector<Section> & upper,
         const Vector2 &              shift)
{
  Bounds bounds{ Vector2::Constant(std::numeric_limits<double>::max()),
                 Vector2::Constant(std::numeric_limits<double>::lowest()) };
  for (const auto * sections : { &lower, &upper })
  {
    for (const Section & section : *sections)
    {
      for (int v : section.walks[0])
      {
        const Vector2 q = sections == &upper ? Vector2(pool.plane[v] - shift) : pool.plane[v];
        bounds.low = bounds.low.cwiseMin(q);
        bounds.high = bounds.high.cwiseMax(q);
      }
    }
  }
  const double margin = 0.2 * (bounds.high - bounds.low).norm() + 1.0;
  bounds.low.array() -= margin;
  bounds.high.array() += margin;
  return bounds;
}

Side
MakeSide(const VertexPool &           pool,
         const std::vector<Section> & sections,
         const std::vector<int> &     groupOf,
         const Bounds &               bounds,
         const Vector2 &              shift)
{
  Side side;
  side.shift = shift;
  ConstrainedTriangulation outside(bounds.low, bounds.high);
  std::map<int, int>       local;
  side.poolId.assign(Corners, -1);
  for (const Section & section : sections)
  {
    std::vector<const Walk *> loops{ &section.walks[0] };
    for (const Walk & hole : section.holes)
    {
      loops.push_back(&hole);
    }
    for (const Walk * loop : loops)
    {
      for (int v : *loop)
      {
        const int id = outside.Insert(pool.plane[v] - shift);
        if (id != static_cast<int>(side.poolId.size()))
        {
          throw std::runtime_error("contours touch");
        }
        local[v] = id;
        side.poolId.push_back(v);
      }
    }
    for (const Walk * loop : loops)
    {
      for (std::size_t i = 0; i < loop->size(); ++i)
      {
        outside.Constrain(local[(*loop)[i]], local[(*loop)[(i + 1) % loop->size()]]);
      }
    }
  }
  side.box.points = outside.GetPoints();
  const std::vector<char> inside = outside.Inside();
  for (std::size_t t = 0; t < inside.size(); ++t)
  {
    if (!inside[t])
    {
      side.box.triangles.push_back(outside.GetTriangles()[t].vertices);
      side.region.push_back(0);
      side.group.push_back(-1);
      side.piece.push_back(-1);
    }
  }
  for (std::size_t s = 0; s < sections.size(); ++s)
  {
    for (const PlanarTriangle & triangle : SectionTriangles(sections[s]))
    {
      std::array<int, 3> vertices;
      for (int i = 0; i < 3; ++i)
      {
        const int  v = triangle.vertices[i];
        const auto added = local.emplace(v, static_cast<int>(side.poolId.size()));
        if (added.second)
        {
          side.poolId.push_back(v);
          side.box.points.push_back(pool.plane[v] - shift);
        }
        vertices[i] = added.first->second;
      }
      side.box.triangles.push_back(vertices);
      side.region.push_back(triangle.region);
      side.group.push_back(groupOf[s]);
      side.piece.push_back(static_cast<int>(s));
    }
  }
  return side;
}

/** Whether a vertex lies inside one region and may be moved a little without turning a triangle over. */
bool
IsInner(const Side & side, int vertex)
{
  int region = 0;
  for (std::size_t t = 0; t < side.box.triangles.size(); ++t)
  {
    const auto & ids = side.box.triangles[t];
    const auto   at = std::find(ids.begin(), ids.end(), vertex);
    if (at != ids.end())
    {
      if (side.region[t] == 0 || (region != 0 && side.region[t] != region))
      {
        return false;
      }
      region = side.region[t];
      const auto      i = static_cast<std::size_t>(at - ids.begin());
      const Vector2 & a = side.box.points[ids[(i + 1) % 3]];
      const Vector2 & b = side.box.points[ids[(i + 2) % 3]];
      const Vector2   x = side.box.points[vertex] - a, d = b - a;
      if ((d.x() * x.y() - d.y() * x.x()) < 4 * PartPoints * d.norm())
      {
        return false;
      }
    }
  }
  return region != 0;
}

PlanarOverlay
OverlaySides(const Side & lower, const Side & upper)
{
  // Medial axes of both slices often meet in nearly the same point, whose fans of triangles would cross each other in a
  // knot of that size.
  BoxTriangulation parted = upper.box;
  for (std::size_t v = Corners; v < parted.points.size(); ++v)
  {
    const bool near = std::any_of(lower.box.points.begin() + Corners, lower.box.points.end(), [&](const Vector2 & q) {
      return (q - upper.box.points[v]).squaredNorm() < NearPoints * NearPoints;
    });
    if (near && IsInner(upper, static_cast<int>(v)))
    {
      parted.points[v] += PartPoints * Vector2(0.8, 0.6);
    }
  }
  for (int attempt = 1;; ++attempt)
  {
    BoxTriangulation moved = parted;
    for (std::size_t v = Corners; v < moved.points.size(); ++v)
    {
      // No two vertices by the same amount, lest edges of both slices stay collinear.
      const double angle = 2.399963 * static_cast<double>(v) * attempt;
      moved.points[v] += Shift * attempt * Vector2(1.0 + 0.3 * std::cos(angle), 0.618 + 0.3 * std::sin(angle));
    }
    try
    {
      return Overlay(lower.box, moved);
    }
    catch (const std::runtime_error &)
    {
      if (attempt >= OverlayTries)
      {
        throw;
      }
    }
  }
}

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
MakeColumn(int lower, int upper, bool together, int steps, bool parted)
{
  Column column{ lower };
  if (parted)
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

class SlabFiller
{
public:
  SlabFiller(const ContourStack & stack, const Side & lower, const Side & upper, int slice, const VertexPool & pool)
    : m_Stack(stack)
    , m_Sides{ &lower, &upper }
    , m_Slice(slice)
    , m_Pool(pool)
    , m_Overlay(OverlaySides(lower, upper))
  {}

  /** Area of bone that has the same region, of the same group, on both slices. */
  double
  CommonArea() const
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

  /** The groups with members on both slices that overlap does not join into one. */
  std::vector<int>
  PartedGroups(const std::vector<Group> & groups) const
  {
    std::set<std::array<int, 2>> links;
    for (const auto & t : m_Overlay.triangles)
    {
      if (Together(t))
      {
        links.insert({ { m_Sides[0]->piece[t.first], m_Sides[1]->piece[t.second] } });
      }
    }
    std::vector<int> parted;
    for (std::size_t g = 0; g < groups.size(); ++g)
    {
      if (!groups[g].lower.empty() && !groups[g].upper.empty() && !Joined(groups[g], links))
      {
        parted.push_back(static_cast<int>(g));
      }
    }
    return parted;
  }

  /** `thin`: whether a cell is so flat that it may be inverted in another frame. */
  SlabFilling
  Run(double low, double high, bool & thin)
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
    const MeshArrays mesh = CollapseSteinerPoints(m_Mesh, m_FirstSteiner, PlacesOf(low, high));
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
    {
      const Id4 &  c = mesh.tetrahedra[t];
      const auto & p = mesh.points;
      thin = thin || (mesh.region[t] > 0 && !(SignedVolume(p[c[0]], p[c[1]], p[c[2]], p[c[3]]) > LeastVolume));
    }
    return BoneOf(mesh);
  }

private:
  /** True where a triangle of the overlay lies in the same group on both slices. */
  bool
  Together(const PlanarOverlay::Triangle & t) const
  {
    return m_Sides[0]->group[t.first] >= 0 && m_Sides[0]->group[t.first] == m_Sides[1]->group[t.second];
  }

  void
  MakeColumns()
  {
    int  jump = 1;
    bool parted = false;
    for (const auto & t : m_Overlay.triangles)
    {
      const int a = m_Sides[0]->region[t.first], b = m_Sides[1]->region[t.second];
      jump = std::max(jump, std::abs(a - b));
      parted = parted || (a > 0 && b > 0 && m_Sides[0]->group[t.first] != m_Sides[1]->group[t.second]);
    }
    if (parted)
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
                                     parted));
    }
    m_Planes = static_cast<int>(m_Columns.front().size()) - 1;
  }

  /** A point in the stack's frame, where all of a slice are at exactly one height. */
  static Vector3
  At(const Vector2 & q, double height)
  {
    return { q.x(), q.y(), height };
  }

  void
  MakePoints(double low, double high)
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

  /** Where the points in between belong. */
  SteinerPlaces
  PlacesOf(double low, double high) const
  {
    const SlabSurface surface = FindSlabSurface({ { &m_Sides[0]->box, &m_Sides[1]->box } },
                                                { { &m_Sides[0]->region, &m_Sides[1]->region } },
                                                m_Overlay,
                                                m_Columns);
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
  Steiner(int plane, int v) const
  {
    return m_FirstSteiner + static_cast<IdType>(plane) * static_cast<IdType>(m_Overlay.points.size()) + v;
  }

  void
  AddCell(IdType a, IdType b, IdType c, IdType d, bool mirrored, int region)
  {
    m_Mesh.tetrahedra.push_back(mirrored ? Id4{ { a, b, d, c } } : Id4{ { a, b, c, d } });
    m_Mesh.region.push_back(region);
  }

  /** The prisms between the slices and the overlay next to them. */
  void
  FillPrisms()
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

  /** The cells of a prism at the side opposite its smallest vertex: a fan about the smaller end of that side's edge. */
  void
  FillSideOpposite(int s, int plane, const std::array<int, 3> & v, int region)
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

  /** Prisms between the copies of the overlay. */
  void
  FillMiddle()
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

  /** The bone among the cells; vertices in between get the layer that they bound. */
  SlabFilling
  BoneOf(const MeshArrays & filled) const
  {
    constexpr int Unseen = std::numeric_limits<int>::max();
    SlabFilling   result;
    result.slice = m_Slice;
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

  /** Throws where a cell turned over when its points were brought from the stack's frame to space. */
  void
  VerifyInSpace(const SlabFilling & filling) const
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

  const ContourStack & m_Stack;
  const Side *         m_Sides[2];
  int                  m_Slice;
  const VertexPool &   m_Pool;
  PlanarOverlay        m_Overlay;
  std::vector<Column>  m_Columns;
  int                  m_Planes{ 1 };
  MeshArrays           m_Mesh;
  IdType               m_First[2];
  IdType               m_FirstSteiner{ 0 };
};
Vector2
CentroidOf(const VertexPool & pool, const std::vector<Section> & sections, const std::vector<int> & ids)
{
  Vector2 moment = Vector2::Zero();
  double  area = 0.0;
  for (int i : ids)
  {
    const auto polygon = OuterPolygon(pool.plane, sections[i]);
    for (std::size_t k = 1; k + 1 < polygon.size(); ++k)
    {
      const Vector2 d = polygon[k] - polygon[0], e = polygon[k + 1] - polygon[0];
      const double  twice = d.x() * e.y() - d.y() * e.x();
      moment += twice * (polygon[0] + polygon[k] + polygon[k + 1]) / 3.0;
      area += twice;
    }
  }
  return moment / area;
}

/** How far the upper slice may be moved against the lower one: not at all, by the mean way of the groups' centroids,
 * by the way of a group's. */
std::vector<Vector2>
CandidateShifts(const VertexPool &           pool,
                const std::vector<Section> & lower,
                const std::vector<Section> & upper,
                const std::vector<Group> &   groups)
{
  std::vector<Vector2> ways;
  Vector2              mean = Vector2::Zero();
  for (const Group & group : groups)
  {
    if (!group.lower.empty() && !group.upper.empty())
    {
      ways.push_back(CentroidOf(pool, upper, group.upper) - CentroidOf(pool, lower, group.lower));
      mean += ways.back();
    }
  }
  std::vector<Vector2> shifts{ Vector2::Zero() };
  if (!ways.empty())
  {
    shifts.push_back(mean / static_cast<double>(ways.size()));
  }
  if (ways.size() > 1)
  {
    shifts.insert(shifts.end(), ways.begin(), ways.end());
  }
  return shifts;
}

/** The slices' triangulations at a shift and their overlay. */
struct Alignment
{
  Side                        below, above;
  std::unique_ptr<SlabFiller> filler;
  std::vector<int>            parted;
  double                      common{ 0.0 };

  bool
  IsBetterThan(const Alignment & other) const
  {
    return parted.size() != other.parted.size() ? parted.size() < other.parted.size() : common > other.common;
  }
};

/** The slices laid over each other at the shifts that may do, best first; `reason` says why others fail. */
std::vector<std::unique_ptr<Alignment>>
FindAlignments(const ContourStack &         stack,
               const std::vector<Section> & lower,
               const std::vector<Section> & upper,
               const std::vector<Group> &   groups,
               const VertexPool &           pool,
               std::string &                reason)
{
  std::vector<int> lowerGroup(lower.size(), -1), upperGroup(upper.size(), -1);
  for (std::size_t g = 0; g < groups.size(); ++g)
  {
    for (int i : groups[g].lower)
    {
      lowerGroup[i] = static_cast<int>(g);
    }
    for (int i : groups[g].upper)
    {
      upperGroup[i] = static_cast<int>(g);
    }
  }
  const int                               slice = (lower.empty() ? upper : lower).front().slice;
  std::vector<std::unique_ptr<Alignment>> alignments;
  int                                     tried = 0;
  for (const Vector2 & shift : CandidateShifts(pool, lower, upper, groups))
  {
    if (tried++ >= UsualShifts && !alignments.empty() && alignments.front()->parted.empty())
    {
      break;
    }
    auto alignment = std::make_unique<Alignment>();
    try
    {
      const Bounds bounds = BoundsOf(pool, lower, upper, shift);
      alignment->below = MakeSide(pool, lower, lowerGroup, bounds, Vector2::Zero());
      alignment->above = MakeSide(pool, upper, upperGroup, bounds, shift);
      alignment->filler = std::make_unique<SlabFiller>(stack, alignment->below, alignment->above, slice, pool);
      alignment->parted = alignment->filler->PartedGroups(groups);
      alignment->common = alignment->filler->CommonArea() / (shift.isZero() ? 1.0 : ShiftGain);
      alignments.push_back(std::move(alignment));
    }
    catch (const std::runtime_error & error)
    {
      reason = error.what();
    }
    std::stable_sort(
      alignments.begin(), alignments.end(), [](const auto & a, const auto & b) { return a->IsBetterThan(*b); });
  }
  return alignments;
}
} // namespace

SlabFilling
FillSlab(const ContourStack &         stack,
         const std::vector<Section> & lower,
         const std::vector<Section> & upper,
         const std::vector<Group> &   groups,
         double                       lowerHeight,
         double                       upperHeight,
         const VertexPool &           pool)
{
  std::string                reason;
  std::optional<SlabFilling> usable;
  for (const auto & alignment : FindAlignments(stack, lower, upper, groups, pool, reason))
  {
    try
    {
      bool        thin = false;
      SlabFilling filling = alignment->filler->Run(lowerHeight, upperHeight, thin);
      filling.parted = alignment->parted;
      if (!thin)
      {
        return filling;
      }
      if (!usable)
      {
        usable = std::move(filling);
      }
    }
    catch (const std::runtime_error & error)
    {
      reason = error.what();
    }
  }
  if (usable)
  {
    return *usable;
  }
  throw std::runtime_error("slice " + std::to_string((lower.empty() ? upper : lower).front().slice) +
                           ": the space next to it cannot be filled, " + reason + "; use a smaller slice step");
}
} // namespace tiling
} // namespace bone
