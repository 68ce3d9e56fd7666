/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneContourTiler.h"

#include "boneMeshValidator.h"
#include "boneSectionBuilder.h"
#include "boneSectionJoin.h"
#include "boneSlabTiler.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <stdexcept>

namespace bone
{
namespace
{
using namespace tiling;

constexpr double LeastCapHeight = 0.2; // of the slab
constexpr double MostCapHeight = 0.9;
constexpr double LargestAreaLeftOut = 40.0; // mm^2

/** A piece of a slice: slice and position among its pieces. */
using PieceId = std::pair<int, int>;

/** No way to fill the space between some pieces of two slices. */
class SlabFailure : public std::runtime_error
{
public:
  SlabFailure(const std::string & what, std::vector<PieceId> pieces)
    : std::runtime_error(what)
    , m_Pieces(std::move(pieces))
  {}

  const std::vector<PieceId> &
  GetPieces() const
  {
    return m_Pieces;
  }

private:
  std::vector<PieceId> m_Pieces;
};

/** Slices with a point at which the interface round a region is no 2-manifold: its faces there form several sheets, or
 * more than two of them share an edge. */
std::set<int>
PinchedInterfaceSlices(const MeshArrays & mesh)
{
  std::set<int> slices;
  const int     deepest = *std::max_element(mesh.region.begin(), mesh.region.end());
  for (int region = 2; region <= deepest; ++region)
  {
    // The faces at a point, as directed edges opposite to it; a single sheet is a single closed chain of them.
    std::map<IdType, std::map<IdType, IdType>> links;
    std::map<IdType, std::size_t>              faces;
    for (const auto & face : BoundaryFaces(mesh, region))
    {
      for (int k = 0; k < 3; ++k)
      {
        links[face[k]][face[(k + 1) % 3]] = face[(k + 2) % 3];
        ++faces[face[k]];
      }
    }
    for (const auto & [point, next] : links)
    {
      std::size_t length = 1;
      const auto  start = next.begin()->first;
      auto        here = next.find(next.begin()->second);
      while (here != next.end() && here->first != start && length <= faces[point])
      {
        ++length;
        here = next.find(here->second);
      }
      if (here == next.end() || length != faces[point])
      {
        slices.insert(mesh.slice[point]);
      }
    }
  }
  return slices;
}

/** Tiles all slabs of a stack in order. Pieces named in `plain` do without their inner layers. */
class StackTiler
{
public:
  StackTiler(const ContourStack &      stack,
             const TilingMetric &      metric,
             const TilingParameters &  parameters,
             const std::set<PieceId> & plain,
             TilingReport &            report)
    : m_Stack(stack)
    , m_Parameters(parameters)
    , m_Plain(plain)
    , m_Report(report)
    , m_Slabs(stack, metric, m_Pool, m_Tetrahedra, report)
  {}

  MeshArrays
  Run()
  {
    const int slices = static_cast<int>(m_Stack.GetSlices().size());
    m_Sections.resize(slices);
    for (int k = 0; k < slices; ++k)
    {
      CollectSlice(k);
    }
    for (int k = 0; k < slices; ++k)
    {
      BuildSlice(k);
      if (k > 0)
      {
        TileSlab(k - 1);
      }
      Progress(0.9 * (k + 1) / slices);
    }
    CloseEnds();
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

  /** Sorts the contours of slice k into pieces and matches them with those of the slice before. */
  void
  CollectSlice(int k)
  {
    m_Pieces.push_back(CollectPieces(m_Stack, k, m_Report));
    for (std::size_t i = 0; i < m_Pieces[k].size(); ++i)
    {
      PieceOutline & piece = m_Pieces[k][i];
      if (m_Plain.count({ k, static_cast<int>(i) }) > 0 && piece.loops.size() > 1)
      {
        m_Report.loopsLeftOut += static_cast<int>(piece.loops.size()) - 1;
        m_Report.notes.push_back("slice " + std::to_string(k) + ", contour " + std::to_string(piece.loops[0].id) +
                                 ": its inner contours were left out, the slab could not be tiled with them");
        piece.loops.resize(1);
        piece.axis.clear();
      }
    }
    m_CappedBelow.emplace_back(m_Pieces[k].size(), 1);
    m_CappedAbove.emplace_back(m_Pieces[k].size(), 1);
    if (k > 0)
    {
      m_Groups.push_back(MatchPieces(Outlines(k - 1), Outlines(k), m_Stack.GetHeight(k) - m_Stack.GetHeight(k - 1)));
    }
  }

  std::vector<std::vector<Vector2>>
  Outlines(int k) const
  {
    std::vector<std::vector<Vector2>> polygons;
    for (const PieceOutline & piece : m_Pieces[k])
    {
      polygons.push_back(piece.loops.front().points);
    }
    return polygons;
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
    return BuildSection(m_Stack, m_Pieces[k][i], carried, tolerance, k, m_Stack.GetHeight(k), m_Pool, report);
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
    for (Group & group : m_Groups[k])
    {
      if (group.lower.empty() || group.upper.empty())
      {
        continue;
      }
      Count(Pick(k, group.lower), Pick(k + 1, group.upper));
      if (!TryCutOpen(k, group, low, high) && !m_Slabs.TryDirect(Pick(k, group.lower), Pick(k + 1, group.upper)) &&
          !TryOtherAxes(k, group))
      {
        TileOrThin(k, group, low, high);
      }
      for (int i : group.lower)
      {
        m_CappedAbove[k][i] = 0;
      }
      for (int i : group.upper)
      {
        m_CappedBelow[k + 1][i] = 0;
      }
    }
    if (WallsCross(m_Pool, m_Stack, m_Tetrahedra, begin, low, high))
    {
      std::vector<PieceId> layered;
      for (const Group & group : m_Groups[k])
      {
        const auto pieces = LayeredPieces(k, group);
        layered.insert(layered.end(), pieces.begin(), pieces.end());
      }
      throw SlabFailure(
        "slice " + std::to_string(k) +
          ": surfaces of neighbouring pieces cross on the way to the next slice; use a smaller slice step",
        layered);
    }
  }

  void
  Count(const std::vector<Section> & lower, const std::vector<Section> & upper)
  {
    std::vector<Section> both = lower;
    both.insert(both.end(), upper.begin(), upper.end());
    const std::size_t regions = RegionsOf(both).size();
    ++m_Report.slabs;
    m_Report.branchings += both.size() > 2;
    m_Report.layerBranchings +=
      std::any_of(both.begin(), both.end(), [regions](const Section & s) { return s.region.size() < regions; });
  }

  /** An open ring against a closed one, below or above, is tiled with that one cut open at the mouth. */
  bool
  TryCutOpen(int k, const Group & group, double low, double high)
  {
    if (group.lower.size() != 1 || group.upper.size() != 1)
    {
      return false;
    }
    Section lower = m_Sections[k][group.lower[0]], upper = m_Sections[k + 1][group.upper[0]];
    if (lower.hole == upper.hole)
    {
      return false;
    }
    const Section & ring = lower.hole ? lower : upper;
    const Section & other = lower.hole ? upper : lower;
    const auto      outline = OuterPolygon(m_Pool.plane, other);
    // A hole that begins in solid bone is drawn to a point; one before a mouth has little bone across it.
    int covered = 0;
    for (int v : ring.walks.back())
    {
      covered += PointInPolygon(m_Pool.plane[v], outline);
    }
    Section open;
    if (2 * covered > static_cast<int>(ring.walks.back().size()) || !CutOpen(m_Pool.plane, ring, outline, open))
    {
      return false;
    }
    (lower.hole ? lower : upper) = open;
    try
    {
      m_Slabs.TileGroup({ lower }, { upper }, low, high);
    }
    catch (const std::runtime_error & error)
    {
      throw SlabFailure(error.what(), LayeredPieces(k, group));
    }
    return true;
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

  /** Tiles a group by the ways out; where they fail, without its small pieces that no other slice knows. */
  void
  TileOrThin(int k, Group & group, double low, double high)
  {
    try
    {
      m_Slabs.TileGroup(Pick(k, group.lower), Pick(k + 1, group.upper), low, high);
    }
    catch (const std::runtime_error & error)
    {
      if (!LeaveOutSmallest(k, group))
      {
        throw SlabFailure(error.what(), LayeredPieces(k, group));
      }
      TileOrThin(k, group, low, high);
    }
  }

  std::vector<PieceId>
  LayeredPieces(int k, const Group & group) const
  {
    std::vector<PieceId> pieces;
    for (int i : group.lower)
    {
      if (m_Pieces[k][i].loops.size() > 1)
      {
        pieces.emplace_back(k, i);
      }
    }
    for (int i : group.upper)
    {
      if (m_Pieces[k + 1][i].loops.size() > 1)
      {
        pieces.emplace_back(k + 1, i);
      }
    }
    return pieces;
  }

  /** True where piece i of slice k has a counterpart on the slice on its other side. */
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

  bool
  LeaveOutSmallest(int k, Group & group)
  {
    const bool         below = group.lower.size() > 1;
    std::vector<int> & leaves = below ? group.lower : group.upper;
    const int          slice = below ? k : k + 1;
    if (leaves.size() < 2)
    {
      return false;
    }
    const auto area = [&](int i) { return OuterArea(slice, i); };
    const auto smallest =
      std::min_element(leaves.begin(), leaves.end(), [&](int a, int b) { return area(a) < area(b); });
    if (Continues(slice, *smallest, !below) || area(*smallest) > LargestAreaLeftOut)
    {
      return false;
    }
    ++m_Report.piecesLeftOut;
    m_Report.notes.push_back("slice " + std::to_string(slice) + ": a piece of " + std::to_string(area(*smallest)) +
                             " mm2 that no other slice knows cannot be joined and was left out");
    m_CappedBelow[slice][*smallest] = m_CappedAbove[slice][*smallest] = 0;
    leaves.erase(smallest);
    return true;
  }

  /** Closes what has no counterpart on the next slice, up or down; flat where the bone leaves the image. */
  void
  CloseEnds()
  {
    const int slices = static_cast<int>(m_Sections.size());
    for (int k = 0; k < slices; ++k)
    {
      for (std::size_t i = 0; i < m_Sections[k].size(); ++i)
      {
        const bool lone = m_CappedBelow[k][i] && m_CappedAbove[k][i];
        if (m_CappedBelow[k][i])
        {
          Close(k, i, false, k == 0 && m_Stack.GetOpenStart() && !lone);
        }
        if (m_CappedAbove[k][i])
        {
          Close(k, i, true, k + 1 == slices && m_Stack.GetOpenEnd() && !lone);
        }
      }
    }
  }

  void
  Close(int k, std::size_t i, bool above, bool open)
  {
    if (open)
    {
      ++m_Report.flatCuts;
      return;
    }
    const int    slices = static_cast<int>(m_Sections.size());
    const int    next = above ? k + 1 : k - 1, previous = above ? k - 1 : k + 1;
    const double here = m_Stack.GetHeight(k);
    const auto   has = [slices](int s) { return s >= 0 && s < slices; };
    const double reach = has(next) ? std::abs(m_Stack.GetHeight(next) - here)
                                   : (has(previous) ? std::abs(m_Stack.GetHeight(previous) - here) : 1.0);
    // Of a rounded end the area falls linearly with height; where it would reach 0 is the end.
    double share = 0.5;
    if (has(previous))
    {
      const double area = OuterArea(k, i);
      double       before = 0.0;
      for (const Group & group : m_Groups[std::min(k, previous)])
      {
        const auto & own = above ? group.upper : group.lower;
        if (std::count(own.begin(), own.end(), static_cast<int>(i)) > 0)
        {
          for (int j : above ? group.lower : group.upper)
          {
            before = std::max(before, OuterArea(previous, j));
          }
        }
      }
      share = before > area ? area / (before - area) : MostCapHeight;
    }
    const double height = reach * std::clamp(share, LeastCapHeight, MostCapHeight);
    m_Slabs.Cap(m_Sections[k][i], above ? here + height : here - height, above);
  }

  double
  OuterArea(int k, std::size_t i) const
  {
    return std::abs(SignedArea(OuterPolygon(m_Pool.plane, m_Sections[k][i])));
  }

  MeshArrays
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
    RemoveUnusedPoints(mesh);
    mesh.neighbors = ComputeFaceNeighbors(mesh.tetrahedra);
    Progress(0.95);
    const MeshValidation validation = ValidateMesh(mesh);
    if (!validation.IsValid())
    {
      std::vector<PieceId> layered;
      for (const int k : PinchedInterfaceSlices(mesh))
      {
        for (std::size_t i = 0; i < m_Pieces[k].size(); ++i)
        {
          if (m_Pieces[k][i].loops.size() > 1)
          {
            layered.emplace_back(k, static_cast<int>(i));
          }
        }
      }
      throw SlabFailure("the contours cannot be tiled into a valid mesh: " + validation.Summary(), layered);
    }
    Progress(1.0);
    return mesh;
  }

  const ContourStack &                   m_Stack;
  const TilingParameters &               m_Parameters;
  const std::set<PieceId> &              m_Plain;
  TilingReport &                         m_Report;
  VertexPool                             m_Pool;
  std::vector<TiledTetra>                m_Tetrahedra;
  SlabTiler                              m_Slabs;
  std::vector<std::vector<Section>>      m_Sections;
  std::vector<std::vector<PieceOutline>> m_Pieces;
  std::vector<PlanarTree>                m_Carried; ///< axes from below for the slice built last
  std::vector<std::vector<Group>>        m_Groups;  ///< of slice k and k + 1
  std::vector<std::vector<char>>         m_CappedBelow, m_CappedAbove;
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
  const SpanLengthMetric span;
  std::set<PieceId>      plain;
  for (;;)
  {
    report = TilingReport();
    StackTiler tiler(stack, parameters.metric ? *parameters.metric : span, parameters, plain, report);
    try
    {
      return tiler.Run();
    }
    catch (const SlabFailure & failure)
    {
      if (failure.GetPieces().empty())
      {
        throw;
      }
      plain.insert(failure.GetPieces().begin(), failure.GetPieces().end());
    }
  }
}
} // namespace bone
