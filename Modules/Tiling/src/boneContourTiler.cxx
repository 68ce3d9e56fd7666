/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneContourTiler.h"

#include "boneMeshValidator.h"
#include "boneOwnFrame.h"
#include "boneSectionBuilder.h"
#include "boneSectionJoin.h"
#include "boneSlabFilling.h"
#include "boneSlabTiler.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <functional>
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

constexpr double LeastCapHeight = 0.2; // of the slab
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

/** Whether several pieces belong to one or more of the other slice. */
bool
IsBranching(const Group & group)
{
  return !group.lower.empty() && !group.upper.empty() && group.lower.size() + group.upper.size() > 2;
}

/** Tiles all slabs of a stack in order. The holes in `closed` are left out; those around voids are added to it. */
class StackTiler
{
public:
  StackTiler(const ContourStack & stack,
             const TilingMetric & metric,
             const TilingGuide &  guide,
             ClosedHoles &        closed,
             TilingReport &       report,
             const Execution &    execution)
    : m_Stack(stack)
    , m_Guide(guide)
    , m_Closed(closed)
    , m_Report(report)
    , m_Execution(execution)
    , m_Slabs(stack, metric, m_Pool, m_Tetrahedra, report, m_Execution)
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
      m_Execution.Report(0.05 * (k + 1) / slices);
    }
    MatchSlices();
    const Execution slabs = m_Execution.Part(0.1, 0.6);
    for (int k = 0; k < slices; ++k)
    {
      BuildSlice(k);
      if (k > 0)
      {
        TileSlab(k - 1);
      }
      slabs.Report((k + 1.0) / slices);
    }
    CloseOutermost(0, false, m_Stack.GetOpenStart());
    CloseOutermost(slices - 1, true, m_Stack.GetOpenEnd());
    RunFillings(m_Execution.Part(0.6, 0.95));
    m_Execution.Report(0.95);
    return Assemble();
  }

private:
  /** Sorts the contours of slice k into pieces. */
  void
  CollectSlice(int k)
  {
    m_Pieces.push_back(CollectPieces(m_Stack, k, m_Closed[k], m_Report));
  }

  void
  MatchSlices()
  {
    std::vector<double> heights;
    for (std::size_t k = 0; k < m_Pieces.size(); ++k)
    {
      heights.push_back(m_Stack.GetHeight(k));
    }
    m_Groups = MatchPieces(m_Pieces, heights, m_Guide.correspondence.get());
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
    return BuildSection(
      m_Stack, m_Pieces[k][i], carried, tolerance, k, m_Stack.GetHeight(k), m_Pool, report, m_Execution);
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
    const auto branchings = static_cast<int>(std::count_if(m_Groups[k].begin(), m_Groups[k].end(), IsBranching));
    if (tiled && !WallsCross(m_Pool, m_Stack, m_Tetrahedra, begin, low, high))
    {
      m_Report.splitBranchings += m_Guide.branching == BranchingKind::Splitting ? branchings : 0;
      return;
    }
    m_Report.filledBranchings += branchings;
    m_Tetrahedra.resize(begin);
    m_Fillings.push_back([this, k, low, high](const Execution & execution) {
      return FillSlab(m_Stack,
                      m_Sections[k],
                      m_Sections[k + 1],
                      m_Groups[k],
                      low,
                      high,
                      m_Pool,
                      execution,
                      m_Guide.branching == BranchingKind::Splitting);
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
    return CanBeKnitted(k, group) &&
           (TryKnit(group, Pick(k, group.lower), Pick(k + 1, group.upper)) || TryOtherAxes(k, group));
  }

  /** Whether there is a way to knit a group with pieces on both slices: composites and splitting are for several pieces
   * against one. What is split must go on beyond its slice: in parts that meet nothing but each other at the cut, four
   * faces would meet there. */
  bool
  CanBeKnitted(int k, const Group & group) const
  {
    if (!IsBranching(group))
    {
      return true;
    }
    const bool oneBelow = group.lower.size() == 1, oneAbove = group.upper.size() == 1;
    if ((!oneBelow && !oneAbove) || m_Guide.branching == BranchingKind::Filling)
    {
      return false;
    }
    return m_Guide.branching == BranchingKind::Composite ||
           (oneBelow ? Continues(k, group.lower.front(), false) : Continues(k + 1, group.upper.front(), true));
  }

  bool
  TryKnit(const Group & group, const std::vector<Section> & lower, const std::vector<Section> & upper)
  {
    return m_Guide.branching == BranchingKind::Splitting && IsBranching(group) ? m_Slabs.TrySplit(lower, upper)
                                                                               : m_Slabs.TryDirect(lower, upper);
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
      if (TryKnit(group, Pick(k, group.lower), upper))
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
    m_Fillings.push_back([this, &section, here, reach, above](const Execution & execution) {
      const std::vector<Section> one{ section }, none;
      return above ? FillSlab(m_Stack, one, none, { { { 0 }, {} } }, here, here + reach, m_Pool, execution)
                   : FillSlab(m_Stack, none, one, { { {}, { 0 } } }, here - reach, here, m_Pool, execution);
    });
    ++m_Report.filledEnds;
  }

  /** Fills what was put off; the spaces do not depend on each other. Of several errors the first one's is thrown. */
  void
  RunFillings(const Execution & execution)
  {
    std::vector<SlabFilling>        fillings(m_Fillings.size());
    std::vector<std::exception_ptr> errors(m_Fillings.size());
    const auto                      count = static_cast<double>(m_Fillings.size());
    execution.For(m_Fillings.size(), [&](std::size_t i) {
      try
      {
        fillings[i] = m_Fillings[i](execution.Part(i / count, (i + 1) / count));
      }
      catch (const std::runtime_error &)
      {
        errors[i] = std::current_exception();
      }
    });
    for (std::size_t i = 0; i < fillings.size(); ++i)
    {
      if (errors[i])
      {
        std::rethrow_exception(errors[i]);
      }
      Append(fillings[i]);
      m_Report.splitFillings += fillings[i].split;
      Report(fillings[i]);
    }
  }

  /** Says which corresponding pieces were not joined; throws where the user had asked for them to be. */
  void
  Report(const SlabFilling & filling)
  {
    const int    k = filling.slice;
    const auto & given = m_Guide.correspondence;
    const auto   list = [](const std::vector<int> & ids) {
      std::string text;
      for (int id : ids)
      {
        text += (text.empty() ? "" : ", ") + std::to_string(id);
      }
      return text;
    };
    for (int g : filling.separated)
    {
      const std::string text = "slice " + std::to_string(k) + ", contour " + list(IdsOf(k, m_Groups[k][g].lower)) +
                               ": corresponds to contour " + list(IdsOf(k + 1, m_Groups[k][g].upper)) +
                               " of the next slice but does not overlap all of it";
      if (given && given->slabs.count(k) > 0)
      {
        throw std::runtime_error(text + " and cannot be joined to it; use a smaller slice step");
      }
      ++m_Report.separatedGroups;
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
    m_Execution.Report(0.98);
    if (FindVoids(mesh))
    {
      return std::nullopt;
    }
    RemoveUnusedPoints(mesh);
    return mesh;
  }

  const ContourStack &                                       m_Stack;
  const TilingGuide &                                        m_Guide;
  ClosedHoles &                                              m_Closed;
  TilingReport &                                             m_Report;
  Execution                                                  m_Execution;
  VertexPool                                                 m_Pool;
  std::vector<TiledTetra>                                    m_Tetrahedra;
  SlabTiler                                                  m_Slabs;
  std::vector<std::vector<Section>>                          m_Sections;
  std::vector<std::vector<PieceOutline>>                     m_Pieces;
  std::vector<PlanarTree>                                    m_Carried;  ///< axes from below for the slice built last
  std::vector<std::vector<Group>>                            m_Groups;   ///< of slice k and k + 1
  std::vector<std::function<SlabFilling(const Execution &)>> m_Fillings; ///< put off until all slices are there
};
/** A metric of places in space, for steps in a frame. */
class MetricInSpace : public TilingMetric
{
public:
  MetricInSpace(const TilingMetric & metric, const OwnFrame & frame)
    : m_Metric(metric)
    , m_Frame(frame)
  {}

  double
  Evaluate(const TilingStep & step) const override
  {
    TilingStep placed = step;
    for (int i = 0; i < 2 * step.numberOfEdges; ++i)
    {
      placed.edges[i] = m_Frame.ToSpace(step.edges[i]);
    }
    for (int i = 0; i < 3 * step.numberOfFaces; ++i)
    {
      placed.faces[i] = m_Frame.ToSpace(step.faces[i]);
    }
    return m_Metric.Evaluate(placed);
  }

private:
  const TilingMetric & m_Metric;
  const OwnFrame &     m_Frame;
};

MeshArrays
TileInFrame(const OwnFrame & frame, const TilingGuide & guide, TilingReport & report, const Execution & execution)
{
  const SpanLengthMetric              span;
  std::unique_ptr<const TilingMetric> given;
  if (guide.metric)
  {
    given = std::make_unique<MetricInSpace>(*guide.metric, frame);
  }
  const ContourStack & stack = frame.GetStack();
  ClosedHoles          holes(stack.GetSlices().size());
  // Tiling again, here or in another frame, goes through the same progress, which stands still until it gets further.
  for (;;)
  {
    report = TilingReport();
    StackTiler tiler(stack, given ? *given : span, guide, holes, report, execution.Part(0.0, 0.95));
    if (auto mesh = tiler.Run())
    {
      for (Vector3 & p : mesh->points)
      {
        p = frame.ToGivenPlace(p);
      }
      execution.Report(0.95);
      const MeshValidation validation = ValidateMesh(*mesh);
      if (!validation.IsValid())
      {
        throw std::runtime_error("the contours cannot be tiled into a valid mesh: " + validation.Summary());
      }
      execution.Report(1.0);
      return std::move(*mesh);
    }
  }
}
} // namespace

MeshArrays
TileContours(const ContourStack & stack, const TilingGuide & guide, TilingReport & report, const Execution & execution)
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
  // With rounded coordinates in its own frame a stack is tiled alike however it lies. Where rounding does harm (cells
  // that are flat in space, contours that nearly touch), the coordinates in space are taken.
  try
  {
    return TileInFrame(OwnFrame(stack, true), guide, report, execution);
  }
  catch (const std::runtime_error &)
  {
    return TileInFrame(OwnFrame(stack, false), guide, report, execution);
  }
}
} // namespace bone
