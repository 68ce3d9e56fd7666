/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSlabFilling.h"

#include "boneLayerLinks.h"
#include "bonePlanarOverlay.h"
#include "bonePredicates.h"
#include "boneSlabCuts.h"
#include "boneSlabSide.h"
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
#include <tuple>

namespace bone
{
namespace tiling
{
namespace
{
constexpr double ShiftGain = 1.5;   ///< a shift leans upright walls too, so it must pay
constexpr double LinkShare = 0.15;  ///< of a part's area, by which two parts of a layer belong together
constexpr double SmallShift = 0.03; // mm
constexpr int    SmallShifts = 3;
constexpr double WiderBox = 0.7;          ///< mm, with each small shift where no shift will do
constexpr int    UsualShifts = 2;         ///< looked at always; others where these do not do
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

class SlabFiller
{
public:
  SlabFiller(const ContourStack &  stack,
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

  std::set<LayerLink>
  Links() const
  {
    const auto &below = *m_Sides[0], &above = *m_Sides[1];
    return FindLayerLinks({ { &below.box, &above.box } },
                          { { &below.region, &above.region } },
                          { { &below.group, &above.group } },
                          m_Overlay,
                          LinkShare);
  }

  /** The groups with members on both slices that overlap does not join into one. */
  std::vector<int>
  SeparatedGroups(const std::vector<Group> & groups) const
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

  /** `thin`: whether a cell is so flat that it may be inverted in another frame. */
  SlabFilling
  Run(double low, double high, const Execution & execution, bool & thin)
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

  const ContourStack &  m_Stack;
  const SlabSide *      m_Sides[2];
  int                   m_Slice;
  const VertexPool &    m_Pool;
  std::vector<PieceCut> m_Cuts;
  PlanarOverlay         m_Overlay;
  std::vector<Column>   m_Columns;
  int                   m_Planes{ 1 };
  MeshArrays            m_Mesh;
  IdType                m_First[2];
  IdType                m_FirstSteiner{ 0 };
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
  SlabSide                    below, above;
  std::unique_ptr<SlabFiller> filler;
  std::vector<int>            separated;
  std::ptrdiff_t              lost{ 0 }; ///< parts of layers that overlap where no slice is moved, and do not here
  double                      common{ 0.0 };

  bool
  IsBetterThan(const Alignment & other) const
  {
    return std::make_tuple(separated.size(), lost, -common) <
           std::make_tuple(other.separated.size(), other.lost, -other.common);
  }
};

/** Lays the slices over each other and fills the space between them. */
class Aligner
{
public:
  Aligner(const ContourStack &         stack,
          const std::vector<Section> & lower,
          const std::vector<Section> & upper,
          const std::vector<Group> &   groups,
          const VertexPool &           pool,
          const Execution &            execution,
          bool                         split)
    : m_Stack(stack)
    , m_Lower(lower)
    , m_Upper(upper)
    , m_Groups(groups)
    , m_Pool(pool)
    , m_Execution(execution)
    , m_Split(split)
    , m_LowerGroup(lower.size(), -1)
    , m_UpperGroup(upper.size(), -1)
    , m_Slice((lower.empty() ? upper : lower).front().slice)
  {
    for (std::size_t g = 0; g < groups.size(); ++g)
    {
      for (int i : groups[g].lower)
      {
        m_LowerGroup[i] = static_cast<int>(g);
      }
      for (int i : groups[g].upper)
      {
        m_UpperGroup[i] = static_cast<int>(g);
      }
    }
  }

  SlabFilling
  Run(double low, double high)
  {
    this->FindAlignments();
    for (std::size_t a = 0; a < m_Alignments.size(); ++a)
    {
      if (this->Fill(*m_Alignments[a], low, high))
      {
        return *m_Filling;
      }
      // Vertices right above each other give flat cells. A small shift separates them and keeps what the next
      // alignment would lose.
      const bool dear = a + 1 < m_Alignments.size() && m_Alignments[a + 1]->lost > m_Alignments[a]->lost;
      for (int i = 1; dear && i <= SmallShifts; ++i)
      {
        const auto moved = this->Align(m_Alignments[a]->above.shift + i * SmallShift * Vector2(0.8, 0.6));
        if (moved && moved->lost <= m_Alignments[a]->lost && this->Fill(*moved, low, high))
        {
          return *m_Filling;
        }
      }
    }
    if (m_Filling)
    {
      return *m_Filling;
    }
    throw std::runtime_error("slice " + std::to_string(m_Slice) + ": the space next to it cannot be filled, " +
                             m_Reason + "; use a smaller slice step");
  }

private:
  /** Vertices of a symmetric section may lie on a diagonal of the box but for rounding, or on edges of the other slice:
   * then other boxes and shifts are tried. */
  void
  FindAlignments()
  {
    this->FindAlignmentsOfAttempt();
    while (m_Alignments.empty() && m_Attempt < SmallShifts)
    {
      ++m_Attempt;
      this->FindAlignmentsOfAttempt();
    }
  }

  /** Alignments at the shifts that may do, best first. */
  void
  FindAlignmentsOfAttempt()
  {
    int tried = 0;
    for (const Vector2 & candidate : CandidateShifts(m_Pool, m_Lower, m_Upper, m_Groups))
    {
      const Vector2 shift = candidate + m_Attempt * SmallShift * Vector2(0.8, 0.6);
      if (tried++ >= UsualShifts && !m_Alignments.empty() && m_Alignments.front()->separated.empty())
      {
        break;
      }
      if (auto alignment = this->Align(shift))
      {
        m_Alignments.push_back(std::move(alignment));
        std::stable_sort(
          m_Alignments.begin(), m_Alignments.end(), [](const auto & a, const auto & b) { return a->IsBetterThan(*b); });
      }
    }
  }

  /** Null where that cannot be; m_Reason then says why. */
  std::unique_ptr<Alignment>
  Align(const Vector2 & shift)
  {
    m_Execution.ThrowIfAborted();
    auto alignment = std::make_unique<Alignment>();
    try
    {
      SlabBounds bounds = BoundsOf(m_Pool, m_Lower, m_Upper, shift);
      bounds.high += m_Attempt * WiderBox * Vector2(1.0, 0.6);
      alignment->below = MakeSide(m_Pool, m_Lower, m_LowerGroup, bounds, Vector2::Zero());
      alignment->above = MakeSide(m_Pool, m_Upper, m_UpperGroup, bounds, shift);
      auto cuts = m_Split ? FindPieceCuts(m_Pool, m_Lower, m_Upper, m_Groups, shift) : std::vector<PieceCut>{};
      alignment->filler = std::make_unique<SlabFiller>(
        m_Stack, alignment->below, alignment->above, m_Slice, m_Pool, std::move(cuts), m_Execution);
    }
    catch (const std::runtime_error & error)
    {
      m_Reason = error.what();
      return nullptr;
    }
    alignment->separated = alignment->filler->SeparatedGroups(m_Groups);
    alignment->common = alignment->filler->CommonArea() / (shift.isZero() ? 1.0 : ShiftGain);
    const std::set<LayerLink> links = alignment->filler->Links();
    m_Unmoved = shift.isZero() ? links : m_Unmoved;
    alignment->lost = std::count_if(
      m_Unmoved.begin(), m_Unmoved.end(), [&links](const LayerLink & link) { return links.count(link) == 0; });
    return alignment;
  }

  /** Whether m_Filling now is one without flat cells; else it may be one with such. */
  bool
  Fill(const Alignment & alignment, double low, double high)
  {
    try
    {
      bool        thin = false;
      SlabFilling filling = alignment.filler->Run(low, high, m_Execution, thin);
      filling.separated = alignment.separated;
      if (!thin || !m_Filling)
      {
        m_Filling = std::move(filling);
      }
      return !thin;
    }
    catch (const std::runtime_error & error)
    {
      m_Reason = error.what();
      return false;
    }
  }

  const ContourStack &                    m_Stack;
  const std::vector<Section> &            m_Lower;
  const std::vector<Section> &            m_Upper;
  const std::vector<Group> &              m_Groups;
  const VertexPool &                      m_Pool;
  const Execution &                       m_Execution;
  bool                                    m_Split;
  std::vector<int>                        m_LowerGroup;
  std::vector<int>                        m_UpperGroup;
  int                                     m_Slice;
  int                                     m_Attempt{ 0 }; ///< at alignments, while there are none
  std::vector<std::unique_ptr<Alignment>> m_Alignments;
  std::set<LayerLink>                     m_Unmoved; ///< that overlap where no slice is moved
  std::optional<SlabFilling>              m_Filling;
  std::string                             m_Reason;
};
} // namespace

SlabFilling
FillSlab(const ContourStack &         stack,
         const std::vector<Section> & lower,
         const std::vector<Section> & upper,
         const std::vector<Group> &   groups,
         double                       lowerHeight,
         double                       upperHeight,
         const VertexPool &           pool,
         const Execution &            execution,
         bool                         split)
{
  return Aligner(stack, lower, upper, groups, pool, execution, split).Run(lowerHeight, upperHeight);
}
} // namespace tiling
} // namespace bone
