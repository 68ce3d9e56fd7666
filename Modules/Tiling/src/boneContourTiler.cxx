/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneContourTiler.h"

#include "boneMeshValidator.h"
#include "boneSectionBuilder.h"
#include "boneSectionJoin.h"
#include "boneSlabFilling.h"
#include "boneSlabTiler.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <stdexcept>

namespace bone
{
namespace
{
using namespace tiling;

constexpr double Pi = 3.14159265358979323846;
constexpr double AngleUnit = 1e-8;
constexpr double PlaceTolerance = 1e-6; // mm, within which coordinates are the same
constexpr double LeastCapHeight = 0.2;  // of the slab
constexpr double MostCapHeight = 0.9;
constexpr double FilledEndFactor = 1.5; // of its height; the outermost copy of the overlay lies at 2/3 or less

/** Ids of the holes of each slice that are left out. */
using ClosedHoles = std::vector<std::set<int>>;

/** The points of the surfaces that bound voids inside the body: connected boundary components that enclose no volume
 * of bone but of nothing. */
std::vector<char>
PointsAroundVoids(const MeshArrays & mesh)
{
  const auto          faces = BoundaryFaces(mesh);
  std::vector<IdType> root(mesh.points.size());
  std::iota(root.begin(), root.end(), 0);
  const auto find = [&root](IdType p) {
    while (root[p] != p)
    {
      p = root[p] = root[root[p]];
    }
    return p;
  };
  for (const auto & f : faces)
  {
    root[find(f[1])] = find(f[0]);
    root[find(f[2])] = find(f[0]);
  }
  std::vector<double> volume(mesh.points.size(), 0.0);
  const Vector3       origin = mesh.points.empty() ? Vector3(Vector3::Zero()) : mesh.points[0];
  for (const auto & f : faces)
  {
    volume[find(f[0])] += SignedVolume(origin, mesh.points[f[0]], mesh.points[f[1]], mesh.points[f[2]]);
  }
  std::vector<char> around(mesh.points.size(), 0);
  for (const auto & f : faces)
  {
    for (IdType p : f)
    {
      around[p] = volume[find(p)] < 0;
    }
  }
  return around;
}

/** In-plane axis of the contours themselves, so that a turned stack is tiled as it was: the direction of their largest
 * extent, toward the longer tail; the stack's own where they have none. */
Vector3
OwnAxis(const ContourStack & stack)
{
  constexpr double     leastDifference = 1e-3;
  std::vector<Vector2> points;
  for (const ContourSlice & slice : stack.GetSlices())
  {
    for (const Contour & contour : slice.contours)
    {
      for (std::size_t i = 0; i < contour.points.size() && !contour.axis; ++i)
      {
        points.push_back(stack.ToPlane(contour.points[i]));
      }
    }
  }
  Vector2 mean = Vector2::Zero();
  for (const Vector2 & q : points)
  {
    mean += q / static_cast<double>(points.size());
  }
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  for (const Vector2 & q : points)
  {
    spread += (q - mean) * (q - mean).transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(spread);
  const Vector2                                        values = axes.eigenvalues();
  if (!(values[1] - values[0] > leastDifference * values[1]))
  {
    return stack.GetU();
  }
  const Vector2 axis = axes.eigenvectors().col(1);
  double        tail = 0.0;
  for (const Vector2 & q : points)
  {
    tail += std::pow((q - mean).dot(axis), 3.0);
  }
  // Rounded, so that sums in another order give the same axis to the last bit.
  const double angle = AngleUnit * std::floor(std::atan2(axis.y(), axis.x()) / AngleUnit + 0.5) + (tail < 0 ? Pi : 0.0);
  return stack.FromPlane({ std::cos(angle), std::sin(angle) }, 0.0);
}

/** The same contours in an order and with first points that depend on where they lie alone, in their own frame: turning
 * or renumbering a stack then changes nothing but the numbering, and what rounding does. */
ContourStack::Pointer
InOwnOrder(const ContourStack & stack)
{
  auto own = ContourStack::New();
  own->Graft(&stack);
  const Vector3 axis = OwnAxis(stack);
  own->SetFrame(axis, stack.GetNormal().cross(axis));
  const auto before = [&own](const Vector3 & p, const Vector3 & q) {
    const Vector2 a = own->ToPlane(p), b = own->ToPlane(q);
    return std::abs(a.x() - b.x()) > PlaceTolerance ? a.x() < b.x() : a.y() < b.y() - PlaceTolerance;
  };
  ContourStack::SliceContainer slices = own->GetSlices();
  for (ContourSlice & slice : slices)
  {
    for (Contour & contour : slice.contours)
    {
      auto & points = contour.points;
      if (!contour.axis)
      {
        std::rotate(points.begin(), std::min_element(points.begin(), points.end(), before), points.end());
      }
      else if (before(points.back(), points.front()))
      {
        std::reverse(points.begin(), points.end());
        std::reverse(contour.clearance.begin(), contour.clearance.end());
      }
    }
    std::stable_sort(slice.contours.begin(), slice.contours.end(), [&before](const Contour & a, const Contour & b) {
      // Branches of a medial axis begin where others do.
      return std::lexicographical_compare(a.points.begin(), a.points.end(), b.points.begin(), b.points.end(), before);
    });
  }
  own->SetSlices(std::move(slices));
  return own;
}

/** Tiles all slabs of a stack in order. The holes in `closed` are left out; those around voids are added to it. */
class StackTiler
{
public:
  StackTiler(const ContourStack &     stack,
             const TilingMetric &     metric,
             const TilingParameters & parameters,
             ClosedHoles &            closed,
             TilingReport &           report)
    : m_Stack(stack)
    , m_Parameters(parameters)
    , m_Closed(closed)
    , m_Report(report)
    , m_Slabs(stack, metric, m_Pool, m_Tetrahedra, report)
  {}

  /** The mesh; or nothing where holes were found that are voids. */
  std::optional<MeshArrays>
  Run()
  {
    const int slices = static_cast<int>(m_Stack.GetSlices().size());
    m_Sections.resize(slices);
    for (int k = 0; k < slices; ++k)
    {
      CollectSlice(k);
    }
    MatchSlices();
    for (int k = 0; k < slices; ++k)
    {
      BuildSlice(k);
      if (k > 0)
      {
        TileSlab(k - 1);
      }
      Progress(0.5 * (k + 1) / slices);
    }
    CloseOutermost(0, false, m_Stack.GetOpenStart());
    CloseOutermost(slices - 1, true, m_Stack.GetOpenEnd());
    RunFillings();
    Progress(0.9);
    return Assemble();
  }

private:
  void
  Progress(double share) const
  {
    if (m_Parameters.progress)
    {
      m_Parameters.progress(share);
    }
  }

  /** Sorts the contours of slice k into pieces. */
  void
  CollectSlice(int k)
  {
    m_Pieces.push_back(CollectPieces(m_Stack, k, m_Closed[k], m_Report));
    m_Given.emplace_back();
    for (const Contour & contour : m_Stack.GetSlices()[k].contours)
    {
      for (const Vector3 & p : contour.points)
      {
        const Vector2 q = m_Stack.ToPlane(p);
        m_Given.back().emplace(std::array<double, 2>{ { q.x(), q.y() } }, p);
      }
    }
  }

  void
  MatchSlices()
  {
    std::vector<double> heights;
    for (std::size_t k = 0; k < m_Pieces.size(); ++k)
    {
      heights.push_back(m_Stack.GetHeight(k));
    }
    m_Groups = MatchPieces(m_Pieces, heights, m_Parameters.correspondence.get());
    for (int k = 0; k < static_cast<int>(m_Groups.size()); ++k)
    {
      auto & used = m_Report.correspondence.slabs[k];
      for (const Group & group : m_Groups[k])
      {
        used.push_back({ IdsOf(k, group.lower), IdsOf(k + 1, group.upper) });
      }
    }
  }

  std::vector<int>
  IdsOf(int k, const std::vector<int> & pieces) const
  {
    std::vector<int> ids;
    for (int i : pieces)
    {
      ids.push_back(m_Pieces[k][i].loops.front().id);
    }
    return ids;
  }

  /** Triangulates the pieces of slice k. */
  void
  BuildSlice(int k)
  {
    m_Carried.assign(m_Pieces[k].size(), PlanarTree{});
    if (k > 0)
    {
      for (const Group & group : m_Groups[k - 1])
      {
        for (int i : group.upper)
        {
          m_Carried[i] = AxisOf(k - 1, group.lower);
        }
      }
    }
    for (std::size_t i = 0; i < m_Pieces[k].size(); ++i)
    {
      m_Sections[k].push_back(Build(k, i, m_Carried[i], CarriedTolerance, m_Report));
      ++m_Report.sections;
    }
  }

  Section
  Build(int k, std::size_t i, const PlanarTree & carried, double tolerance, TilingReport & report)
  {
    const std::size_t mark = m_Pool.plane.size();
    Section           section =
      BuildSection(m_Stack, m_Pieces[k][i], carried, tolerance, k, m_Stack.GetHeight(k), m_Pool, report);
    for (std::size_t v = mark; v < m_Pool.plane.size(); ++v)
    {
      const auto given = m_Given[k].find({ m_Pool.plane[v].x(), m_Pool.plane[v].y() });
      if (given != m_Given[k].end())
      {
        m_Pool.space[v] = given->second;
      }
    }
    return section;
  }

  /** The medial axis of some sections of a slice, joined by bridges; empty where there is none. */
  PlanarTree
  AxisOf(int k, const std::vector<int> & ids) const
  {
    std::vector<Section> sections;
    for (int i : ids)
    {
      sections.push_back(m_Sections[k][i]);
    }
    Section joined;
    EdgeSet used;
    if (sections.empty() || !Compose(m_Pool.plane, sections, RegionsOf(sections), used, joined) || joined.hole)
    {
      return {};
    }
    return TreeOfWalk(m_Pool.plane, joined.walks.back());
  }

  std::vector<Section>
  Pick(int k, const std::vector<int> & ids) const
  {
    std::vector<Section> sections;
    for (int i : ids)
    {
      sections.push_back(m_Sections[k][i]);
    }
    return sections;
  }

  void
  TileSlab(int k)
  {
    const double      low = m_Stack.GetHeight(k), high = m_Stack.GetHeight(k + 1);
    const std::size_t begin = m_Tetrahedra.size();
    bool              tiled = true;
    for (const Group & group : m_Groups[k])
    {
      Count(Pick(k, group.lower), Pick(k + 1, group.upper));
      tiled = tiled && TileGroup(k, group);
    }
    if (tiled && !WallsCross(m_Pool, m_Stack, m_Tetrahedra, begin, low, high))
    {
      return;
    }
    m_Tetrahedra.resize(begin);
    m_Fillings.push_back([this, k, low, high] {
      return FillSlab(m_Stack, m_Sections[k], m_Sections[k + 1], m_Groups[k], low, high, m_Pool);
    });
    ++m_Report.filledSlabs;
  }

  bool
  TileGroup(int k, const Group & group)
  {
    if (group.upper.empty())
    {
      return std::all_of(group.lower.begin(), group.lower.end(), [&](int i) { return TryCap(k, i, true); });
    }
    if (group.lower.empty())
    {
      return std::all_of(group.upper.begin(), group.upper.end(), [&](int i) { return TryCap(k + 1, i, false); });
    }
    // Composites are for several pieces against one.
    return (group.lower.size() == 1 || group.upper.size() == 1) &&
           (m_Slabs.TryDirect(Pick(k, group.lower), Pick(k + 1, group.upper)) || TryOtherAxes(k, group));
  }

  void
  Count(const std::vector<Section> & lower, const std::vector<Section> & upper)
  {
    std::vector<Section> both = lower;
    both.insert(both.end(), upper.begin(), upper.end());
    const std::size_t regions = RegionsOf(both).size();
    if (lower.empty() || upper.empty())
    {
      return;
    }
    ++m_Report.slabs;
    m_Report.branchings += both.size() > 2;
    m_Report.layerBranchings +=
      std::any_of(both.begin(), both.end(), [regions](const Section & s) { return s.region.size() < regions; });
  }

  /** The slice above has no slab yet: it may take on the axis from below at any cost, or keep to its own. */
  bool
  TryOtherAxes(int k, const Group & group)
  {
    for (const bool carry : { true, false })
    {
      std::vector<Section> upper;
      TilingReport         scratch;
      for (int i : group.upper)
      {
        upper.push_back(
          Build(k + 1, i, carry ? m_Carried[i] : PlanarTree{}, std::numeric_limits<double>::max(), scratch));
      }
      if (m_Slabs.TryDirect(Pick(k, group.lower), upper))
      {
        for (std::size_t i = 0; i < upper.size(); ++i)
        {
          m_Sections[k + 1][group.upper[i]] = upper[i];
        }
        ++m_Report.otherAxes;
        return true;
      }
    }
    return false;
  }

  /** Closes what is on the first or last slice of the stack; flat where the bone leaves the image. */
  void
  CloseOutermost(int k, bool above, bool open)
  {
    for (std::size_t i = 0; i < m_Sections[k].size(); ++i)
    {
      if (open && Continues(k, static_cast<int>(i), !above))
      {
        ++m_Report.flatCuts;
        continue;
      }
      if (!TryCap(k, static_cast<int>(i), above))
      {
        FillEnd(m_Sections[k][i], m_Stack.GetHeight(k), EndHeight(k, static_cast<int>(i), above), above);
      }
    }
  }

  bool
  TryCap(int k, int i, bool above)
  {
    const double height = EndHeight(k, i, above);
    const bool   done = m_Slabs.TryCap(m_Sections[k][i], m_Stack.GetHeight(k) + (above ? height : -height), above);
    m_Report.caps += done;
    return done;
  }

  void
  FillEnd(const Section & section, double here, double height, bool above)
  {
    const double reach = FilledEndFactor * height;
    m_Fillings.push_back([this, &section, here, reach, above] {
      const std::vector<Section> one{ section }, none;
      return above ? FillSlab(m_Stack, one, none, { { { 0 }, {} } }, here, here + reach, m_Pool)
                   : FillSlab(m_Stack, none, one, { { {}, { 0 } } }, here - reach, here, m_Pool);
    });
    ++m_Report.filledEnds;
  }

  /** Fills what was put off; the spaces do not depend on each other. */
  void
  RunFillings()
  {
    std::vector<SlabFilling>        fillings(m_Fillings.size());
    std::vector<std::exception_ptr> errors(m_Fillings.size());
    const auto                      body = [&](std::size_t i) {
      try
      {
        fillings[i] = m_Fillings[i]();
      }
      catch (...)
      {
        errors[i] = std::current_exception();
      }
    };
    if (m_Parameters.parallel)
    {
      m_Parameters.parallel(m_Fillings.size(), body);
    }
    else
    {
      for (std::size_t i = 0; i < m_Fillings.size(); ++i)
      {
        body(i);
      }
    }
    for (std::size_t i = 0; i < fillings.size(); ++i)
    {
      if (errors[i])
      {
        std::rethrow_exception(errors[i]);
      }
      Append(fillings[i]);
      Report(fillings[i]);
    }
  }

  /** Says which corresponding pieces were not joined; throws where the user had asked for them to be. */
  void
  Report(const SlabFilling & filling)
  {
    const int    k = filling.slice;
    const auto & given = m_Parameters.correspondence;
    const auto   list = [](const std::vector<int> & ids) {
      std::string text;
      for (int id : ids)
      {
        text += (text.empty() ? "" : ", ") + std::to_string(id);
      }
      return text;
    };
    for (int g : filling.parted)
    {
      const std::string text = "slice " + std::to_string(k) + ", contour " + list(IdsOf(k, m_Groups[k][g].lower)) +
                               ": corresponds to contour " + list(IdsOf(k + 1, m_Groups[k][g].upper)) +
                               " of the next slice but does not overlap all of it";
      if (given && given->slabs.count(k) > 0)
      {
        throw std::runtime_error(text + " and cannot be joined to it; use a smaller slice step");
      }
      ++m_Report.partedGroups;
      m_Report.notes.push_back(text + "; what does not overlap ends there");
    }
  }

  void
  Append(const SlabFilling & filling)
  {
    const int first = static_cast<int>(m_Pool.plane.size());
    for (std::size_t i = 0; i < filling.points.size(); ++i)
    {
      m_Pool.Add(m_Stack.ToPlane(filling.points[i]), filling.points[i], filling.layers[i], filling.slice);
    }
    for (TiledTetra cell : filling.tetrahedra)
    {
      for (IdType & v : cell.vertices)
      {
        v = v < 0 ? first - 1 - v : v;
      }
      m_Tetrahedra.push_back(cell);
    }
  }

  /** True where piece i of slice k has a counterpart above or below. */
  bool
  Continues(int k, int i, bool above) const
  {
    const int slab = above ? k : k - 1;
    if (slab < 0 || slab >= static_cast<int>(m_Groups.size()))
    {
      return false;
    }
    return std::any_of(m_Groups[slab].begin(), m_Groups[slab].end(), [&](const Group & group) {
      const auto & own = above ? group.lower : group.upper;
      const auto & other = above ? group.upper : group.lower;
      return !other.empty() && std::count(own.begin(), own.end(), i) > 0;
    });
  }

  /** How far beyond slice k its piece i ends: of a rounded end the area falls linearly with height. */
  double
  EndHeight(int k, int i, bool above) const
  {
    const int    slices = static_cast<int>(m_Pieces.size());
    const int    next = above ? k + 1 : k - 1, previous = above ? k - 1 : k + 1;
    const double here = m_Stack.GetHeight(k);
    const auto   has = [slices](int s) { return s >= 0 && s < slices; };
    const double reach = has(next) ? std::abs(m_Stack.GetHeight(next) - here)
                                   : (has(previous) ? std::abs(m_Stack.GetHeight(previous) - here) : 1.0);
    double       share = 0.5;
    if (has(previous))
    {
      const double area = OuterArea(k, i);
      double       before = 0.0;
      for (const Group & group : m_Groups[std::min(k, previous)])
      {
        const auto & own = above ? group.upper : group.lower;
        if (std::count(own.begin(), own.end(), i) > 0)
        {
          for (int j : above ? group.lower : group.upper)
          {
            before = std::max(before, OuterArea(previous, j));
          }
        }
      }
      share = before > area ? area / (before - area) : MostCapHeight;
    }
    return reach * std::clamp(share, LeastCapHeight, MostCapHeight);
  }

  double
  OuterArea(int k, int i) const
  {
    return std::abs(SignedArea(m_Pieces[k][i].loops.front().points));
  }

  /** Adds the holes around voids to m_Closed; true where there are any. */
  bool
  FindVoids(const MeshArrays & mesh)
  {
    const std::vector<char> around = PointsAroundVoids(mesh);
    bool                    any = false;
    for (std::size_t k = 0; k < m_Sections.size(); ++k)
    {
      for (std::size_t i = 0; i < m_Sections[k].size(); ++i)
      {
        std::size_t hole = 0;
        for (const PieceOutline::Loop & loop : m_Pieces[k][i].loops)
        {
          if (loop.region == Region::Outside && around[m_Sections[k][i].holes[hole++].front()])
          {
            any = m_Closed[k].insert(loop.id).second || any;
          }
        }
      }
    }
    return any;
  }

  std::optional<MeshArrays>
  Assemble()
  {
    MeshArrays mesh;
    mesh.points = std::move(m_Pool.space);
    mesh.layer = std::move(m_Pool.layer);
    mesh.slice = std::move(m_Pool.slice);
    for (const TiledTetra & t : m_Tetrahedra)
    {
      mesh.tetrahedra.push_back(t.vertices);
      mesh.region.push_back(t.region);
    }
    mesh.neighbors = ComputeFaceNeighbors(mesh.tetrahedra);
    if (FindVoids(mesh))
    {
      return std::nullopt;
    }
    RemoveUnusedPoints(mesh);
    Progress(0.95);
    const MeshValidation validation = ValidateMesh(mesh);
    if (!validation.IsValid())
    {
      throw std::runtime_error("the contours cannot be tiled into a valid mesh: " + validation.Summary());
    }
    Progress(1.0);
    return mesh;
  }

  const ContourStack &                   m_Stack;
  const TilingParameters &               m_Parameters;
  ClosedHoles &                          m_Closed;
  TilingReport &                         m_Report;
  VertexPool                             m_Pool;
  std::vector<TiledTetra>                m_Tetrahedra;
  SlabTiler                              m_Slabs;
  std::vector<std::vector<Section>>      m_Sections;
  std::vector<std::vector<PieceOutline>> m_Pieces;
  /** The contours' points in space by their coordinates in the plane, lest rounding moves them. */
  std::vector<std::map<std::array<double, 2>, Vector3>> m_Given;
  std::vector<PlanarTree>                               m_Carried;  ///< axes from below for the slice built last
  std::vector<std::vector<Group>>                       m_Groups;   ///< of slice k and k + 1
  std::vector<std::function<SlabFilling()>>             m_Fillings; ///< put off until all slices are there
};
} // namespace

MeshArrays
TileContours(const ContourStack & stack, const TilingParameters & parameters, TilingReport & report)
{
  std::size_t closed = 0, slices = 0;
  for (const ContourSlice & slice : stack.GetSlices())
  {
    const auto here =
      std::count_if(slice.contours.begin(), slice.contours.end(), [](const Contour & c) { return !c.axis; });
    closed += static_cast<std::size_t>(here);
    slices += here > 0;
  }
  if (closed == 0 || slices < 2)
  {
    throw std::runtime_error("the stack has contours on " + std::to_string(slices) +
                             " slice(s); a mesh needs at least two slices with closed contours");
  }
  const ContourStack::Pointer own = InOwnOrder(stack);
  const SpanLengthMetric      span;
  ClosedHoles                 holes(stack.GetSlices().size());
  for (;;)
  {
    report = TilingReport();
    StackTiler tiler(*own, parameters.metric ? *parameters.metric : span, parameters, holes, report);
    if (auto mesh = tiler.Run())
    {
      return std::move(*mesh);
    }
  }
}
} // namespace bone
