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
#include <stdexcept>

namespace bone
{
namespace
{
using namespace tiling;

constexpr double LeastCapHeight = 0.2; // of the slab
constexpr double MostCapHeight = 0.9;

/** Tiles all slabs of a stack in order. */
class StackTiler
{
public:
  StackTiler(const ContourStack &     stack,
             const TilingMetric &     metric,
             const TilingParameters & parameters,
             TilingReport &           report)
    : m_Stack(stack)
    , m_Parameters(parameters)
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
      BuildSlice(k);
      Progress(0.3 * (k + 1) / slices);
    }
    for (int k = 0; k < slices; ++k)
    {
      m_CappedBelow.emplace_back(m_Sections[k].size(), 1);
      m_CappedAbove.emplace_back(m_Sections[k].size(), 1);
    }
    for (int k = 0; k + 1 < slices; ++k)
    {
      TileSlab(k);
      Progress(0.3 + 0.6 * (k + 1) / slices);
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

  /** Matches the pieces of slice k with those of the slice before and triangulates them. */
  void
  BuildSlice(int k)
  {
    auto                              pieces = CollectPieces(m_Stack, k, m_Report);
    std::vector<std::vector<Vector2>> polygons;
    for (const PieceOutline & piece : pieces)
    {
      polygons.push_back(piece.loops.front().points);
    }
    std::vector<PlanarTree> carried(pieces.size());
    if (k > 0)
    {
      m_Groups.push_back(MatchPieces(m_Polygons, polygons, m_Stack.GetHeight(k) - m_Stack.GetHeight(k - 1)));
      for (const Group & group : m_Groups.back())
      {
        for (int i : group.upper)
        {
          carried[i] = AxisOf(k - 1, group.lower);
        }
      }
    }
    for (std::size_t i = 0; i < pieces.size(); ++i)
    {
      m_Sections[k].push_back(BuildSection(
        m_Stack, std::move(pieces[i]), carried[i], CarriedTolerance, k, m_Stack.GetHeight(k), m_Pool, m_Report));
      ++m_Report.sections;
    }
    m_Polygons = std::move(polygons);
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

  void
  TileSlab(int k)
  {
    const double      low = m_Stack.GetHeight(k), high = m_Stack.GetHeight(k + 1);
    const std::size_t begin = m_Tetrahedra.size();
    for (const Group & group : m_Groups[k])
    {
      if (group.lower.empty() || group.upper.empty())
      {
        continue;
      }
      std::vector<Section> lower, upper;
      for (int i : group.lower)
      {
        lower.push_back(m_Sections[k][i]);
        m_CappedAbove[k][i] = 0;
      }
      for (int i : group.upper)
      {
        upper.push_back(m_Sections[k + 1][i]);
        m_CappedBelow[k + 1][i] = 0;
      }
      m_Slabs.TileGroup(lower, upper, low, high);
    }
    if (WallsCross(m_Pool, m_Stack, m_Tetrahedra, begin, low, high))
    {
      throw std::runtime_error(
        "slice " + std::to_string(k) +
        ": surfaces of neighbouring pieces cross on the way to the next slice; use a smaller slice "
        "step");
    }
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
      throw std::runtime_error("the contours cannot be tiled into a valid mesh: " + validation.Summary());
    }
    Progress(1.0);
    return mesh;
  }

  const ContourStack &              m_Stack;
  const TilingParameters &          m_Parameters;
  TilingReport &                    m_Report;
  VertexPool                        m_Pool;
  std::vector<TiledTetra>           m_Tetrahedra;
  SlabTiler                         m_Slabs;
  std::vector<std::vector<Section>> m_Sections;
  std::vector<std::vector<Vector2>> m_Polygons; ///< outer contours of the slice built last
  std::vector<std::vector<Group>>   m_Groups;   ///< of slice k and k + 1
  std::vector<std::vector<char>>    m_CappedBelow, m_CappedAbove;
};
} // namespace

MeshArrays
TileContours(const ContourStack & stack, const TilingParameters & parameters, TilingReport & report)
{
  report = TilingReport();
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
  StackTiler             tiler(stack, parameters.metric ? *parameters.metric : span, parameters, report);
  return tiler.Run();
}
} // namespace bone
