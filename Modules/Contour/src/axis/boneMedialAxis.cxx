/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneMedialAxis.h"

#include "boneContourStack.h"
#include "bonePlanarCrossing.h"
#include "bonePredicates.h"

#include <boost/polygon/polygon.hpp>
#include <boost/polygon/voronoi.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>

namespace bone
{
namespace
{
constexpr double UnitsPerMillimetre = 1e4;

using IntegerPoint = boost::polygon::point_data<std::int32_t>;
using IntegerSegment = boost::polygon::segment_data<std::int32_t>;
using Diagram = boost::polygon::voronoi_diagram<double>;

// A polyline between two nodes of the graph, its inner points those of a parabola's arc.
struct AxisEdge
{
  std::size_t          a;
  std::size_t          b;
  std::vector<Vector2> between;
  bool                 significant;
  bool                 used;
};

// The part of the diagram that lies in the region.
struct AxisGraph
{
  std::vector<Vector2>                  points;
  std::vector<double>                   clearance;
  std::vector<AxisEdge>                 edges;
  std::vector<std::vector<std::size_t>> edgesAt;
};

// The contours of a region, edge by edge, with their lengths.
class RegionBorder
{
public:
  struct Foot
  {
    Vector2     point;
    double      place; ///< along its contour
    std::size_t contour;
  };

  explicit RegionBorder(const std::vector<Polygon> & contours)
    : m_Contours(contours)
  {
    for (std::size_t c = 0; c < contours.size(); ++c)
    {
      double length = 0.0;
      for (std::size_t i = 0; i < contours[c].size(); ++i)
      {
        m_Edges.push_back({ c, i, length });
        length += (End(m_Edges.back()) - Start(m_Edges.back())).norm();
      }
      m_Lengths.push_back(length);
    }
  }

  // Nearest point of an edge, edges numbered over all contours.
  Foot
  FootOn(const Vector2 & q, std::size_t edge) const
  {
    const Edge &    e = m_Edges[edge];
    const Vector2 & a = Start(e);
    const Vector2   d = End(e) - a;
    const double    squared = d.squaredNorm();
    const double    t = squared > 0.0 ? std::clamp((q - a).dot(d) / squared, 0.0, 1.0) : 0.0;
    return { a + t * d, e.before + t * std::sqrt(squared), e.contour };
  }

  double
  Clearance(const Vector2 & q) const
  {
    double best = std::numeric_limits<double>::max();
    for (std::size_t e = 0; e < m_Edges.size(); ++e)
    {
      best = std::min(best, (q - this->FootOn(q, e).point).squaredNorm());
    }
    return std::sqrt(best);
  }

  // How much longer the way along the contour is than the straight one; without end between different contours.
  double
  ChordResidual(const Foot & a, const Foot & b) const
  {
    if (a.contour != b.contour)
    {
      return std::numeric_limits<double>::infinity();
    }
    const double along = std::abs(a.place - b.place);
    return std::min(along, m_Lengths[a.contour] - along) - (a.point - b.point).norm();
  }

  bool
  Holds(const Vector2 & q) const
  {
    bool inside = false;
    for (const Polygon & contour : m_Contours)
    {
      inside = inside != PointInPolygon(q, contour);
    }
    return inside;
  }

  std::size_t
  GetNumberOfEdges() const
  {
    return m_Edges.size();
  }
  const Vector2 &
  GetStart(std::size_t edge) const
  {
    return Start(m_Edges[edge]);
  }
  const Vector2 &
  GetEnd(std::size_t edge) const
  {
    return End(m_Edges[edge]);
  }

private:
  struct Edge
  {
    std::size_t contour;
    std::size_t first;
    double      before;
  };

  const Vector2 &
  Start(const Edge & edge) const
  {
    return m_Contours[edge.contour][edge.first];
  }
  const Vector2 &
  End(const Edge & edge) const
  {
    const Polygon & contour = m_Contours[edge.contour];
    return contour[(edge.first + 1) % contour.size()];
  }

  const std::vector<Polygon> & m_Contours;
  std::vector<Edge>            m_Edges;
  std::vector<double>          m_Lengths;
};

class AxisFinder
{
public:
  AxisFinder(const std::vector<Polygon> & contours, const MedialAxisParameters & parameters)
    : m_Border(contours)
    , m_Origin(contours[0][0])
    , m_Parameters(parameters)
  {
    std::vector<IntegerSegment> segments;
    for (std::size_t e = 0; e < m_Border.GetNumberOfEdges(); ++e)
    {
      segments.emplace_back(this->ToGrid(m_Border.GetStart(e)), this->ToGrid(m_Border.GetEnd(e)));
    }
    boost::polygon::construct_voronoi(segments.begin(), segments.end(), &m_Diagram);
  }

  AxisGraph
  MakeGraph() const
  {
    AxisGraph                           graph;
    std::map<const void *, std::size_t> idOf;
    const auto                          vertexId = [&](const Diagram::vertex_type * vertex) {
      const auto inserted = idOf.emplace(vertex, graph.points.size());
      if (inserted.second)
      {
        graph.points.push_back(this->Position(vertex));
        graph.clearance.push_back(m_Border.Clearance(graph.points.back()));
      }
      return inserted.first->second;
    };
    for (const Diagram::edge_type & edge : m_Diagram.edges())
    {
      // Each edge once, finite, between two different parts of the border, and inside.
      if (&edge > edge.twin() || !edge.is_finite() || !edge.is_primary())
      {
        continue;
      }
      std::vector<Vector2> between = this->ArcOf(edge);
      const Vector2 middle = between.empty() ? 0.5 * (this->Position(edge.vertex0()) + this->Position(edge.vertex1()))
                                             : between[between.size() / 2];
      if (!m_Border.Holds(middle))
      {
        continue;
      }
      const auto a = m_Border.FootOn(middle, edge.cell()->source_index());
      const auto b = m_Border.FootOn(middle, edge.twin()->cell()->source_index());
      const bool significant = m_Border.ChordResidual(a, b) > m_Parameters.significance * (middle - a.point).norm();
      const auto from = vertexId(edge.vertex0());
      const auto to = vertexId(edge.vertex1());
      graph.edges.push_back({ from, to, std::move(between), significant, false });
    }
    graph.edgesAt.resize(graph.points.size());
    for (std::size_t e = 0; e < graph.edges.size(); ++e)
    {
      graph.edgesAt[graph.edges[e].a].push_back(e);
      graph.edgesAt[graph.edges[e].b].push_back(e);
    }
    return graph;
  }

  double
  Clearance(const Vector2 & q) const
  {
    return m_Border.Clearance(q);
  }

private:
  IntegerPoint
  ToGrid(const Vector2 & q) const
  {
    const Vector2 scaled = UnitsPerMillimetre * (q - m_Origin);
    return IntegerPoint(static_cast<std::int32_t>(std::lround(scaled.x())),
                        static_cast<std::int32_t>(std::lround(scaled.y())));
  }
  Vector2
  Position(const Diagram::vertex_type * vertex) const
  {
    return m_Origin + Vector2(vertex->x(), vertex->y()) / UnitsPerMillimetre;
  }

  Vector2
  CornerOf(const Diagram::cell_type & cell) const
  {
    return cell.source_category() == boost::polygon::SOURCE_CATEGORY_SEGMENT_START_POINT
             ? m_Border.GetStart(cell.source_index())
             : m_Border.GetEnd(cell.source_index());
  }

  // Inner points of a curved edge, which is as far from a corner as from a line: none for a straight one.
  std::vector<Vector2>
  ArcOf(const Diagram::edge_type & edge) const
  {
    std::vector<Vector2> points;
    if (!edge.is_curved())
    {
      return points;
    }
    const bool    cornerHere = edge.cell()->contains_point();
    const auto &  line = cornerHere ? *edge.twin()->cell() : *edge.cell();
    const Vector2 corner = this->CornerOf(cornerHere ? *edge.cell() : *edge.twin()->cell());
    const Vector2 base = m_Border.GetStart(line.source_index());
    const Vector2 along = (m_Border.GetEnd(line.source_index()) - base).normalized();
    const Vector2 across(-along.y(), along.x());
    const Vector2 from = this->Position(edge.vertex0());
    const Vector2 to = this->Position(edge.vertex1());
    const double  height = (corner - base).dot(across);
    const int     parts = std::min(16, static_cast<int>(std::ceil((to - from).norm() / (0.2 * m_Parameters.spacing))));
    if (std::abs(height) < 1e-3)
    {
      return points;
    }
    for (int k = 1; k < parts; ++k)
    {
      const double s =
        ((1.0 - static_cast<double>(k) / parts) * from + static_cast<double>(k) / parts * to - base).dot(along);
      const Vector2 foot = base + s * along;
      points.push_back(foot + (corner - foot).squaredNorm() / (2.0 * height) * across);
    }
    return points;
  }

  const RegionBorder           m_Border;
  Vector2                      m_Origin;
  const MedialAxisParameters & m_Parameters;
  Diagram                      m_Diagram;
};

std::size_t
Degree(const AxisGraph & graph, std::size_t p)
{
  return static_cast<std::size_t>(std::count_if(
    graph.edgesAt[p].begin(), graph.edgesAt[p].end(), [&graph](std::size_t e) { return !graph.edges[e].used; }));
}

// Moves the end p of a straight edge along it to where the clearance is `least`; false where that is not on it.
bool
ShortenEdge(AxisGraph & graph, const AxisEdge & edge, std::size_t p, double least)
{
  const std::size_t other = edge.a == p ? edge.b : edge.a;
  if (!edge.significant || !edge.between.empty() || !(graph.clearance[other] > least))
  {
    return false;
  }
  const double t = (least - graph.clearance[p]) / (graph.clearance[other] - graph.clearance[p]);
  graph.points[p] += t * (graph.points[other] - graph.points[p]);
  graph.clearance[p] = least;
  return true;
}

// Takes back ends that do not count or run into sharp corners; the point of largest clearance stays.
void
TrimEnds(AxisGraph & graph, std::size_t centre, double least)
{
  std::vector<std::size_t> ends(graph.points.size());
  for (std::size_t p = 0; p < ends.size(); ++p)
  {
    ends[p] = p;
  }
  while (!ends.empty())
  {
    const std::size_t p = ends.back();
    ends.pop_back();
    if (p == centre || Degree(graph, p) != 1)
    {
      continue;
    }
    for (std::size_t e : graph.edgesAt[p])
    {
      AxisEdge & edge = graph.edges[e];
      const bool bad = !edge.significant || graph.clearance[p] < least;
      if (!edge.used && bad && !ShortenEdge(graph, edge, p, least))
      {
        edge.used = true;
        ends.push_back(edge.a == p ? edge.b : edge.a);
      }
    }
  }
  for (auto & around : graph.edgesAt)
  {
    around.erase(std::remove_if(around.begin(), around.end(), [&graph](std::size_t e) { return graph.edges[e].used; }),
                 around.end());
  }
}

// The polyline from an end or fork along `first` to the next end or fork, or back to its start.
Polygon
WalkBranch(AxisGraph & graph, std::size_t start, std::size_t first)
{
  Polygon     branch(1, graph.points[start]);
  std::size_t at = start;
  for (std::size_t e = first; e < graph.edges.size();)
  {
    AxisEdge & edge = graph.edges[e];
    edge.used = true;
    if (edge.a == at)
    {
      branch.insert(branch.end(), edge.between.begin(), edge.between.end());
    }
    else
    {
      branch.insert(branch.end(), edge.between.rbegin(), edge.between.rend());
    }
    at = edge.a == at ? edge.b : edge.a;
    if (graph.points[at] != branch.back())
    {
      branch.push_back(graph.points[at]);
    }
    e = graph.edges.size();
    if (graph.edgesAt[at].size() == 2 && at != start)
    {
      for (std::size_t next : graph.edgesAt[at])
      {
        e = graph.edges[next].used ? e : next;
      }
    }
  }
  return branch;
}

// All branches; those from ends and forks first, then cycles that hang on none.
std::vector<Polygon>
WalkBranches(AxisGraph & graph)
{
  std::vector<Polygon> branches;
  for (const bool cycles : { false, true })
  {
    for (std::size_t p = 0; p < graph.points.size(); ++p)
    {
      for (std::size_t e : graph.edgesAt[p])
      {
        if (!graph.edges[e].used && (cycles || graph.edgesAt[p].size() != 2))
        {
          branches.push_back(WalkBranch(graph, p, e));
        }
      }
    }
  }
  return branches;
}

double
LengthOf(const Polygon & branch)
{
  double length = 0.0;
  for (std::size_t i = 0; i + 1 < branch.size(); ++i)
  {
    length += (branch[i + 1] - branch[i]).norm();
  }
  return length;
}

// Even samples, both ends kept; at least three parts where both ends are one.
Polygon
SampleBranch(const Polygon & branch, double spacing)
{
  const double length = LengthOf(branch);
  const int    least = branch.front() == branch.back() ? 3 : 1;
  const int    parts = std::max(least, static_cast<int>(std::lround(length / spacing)));
  Polygon      result(1, branch.front());
  double       passed = 0.0;
  int          next = 1;
  for (std::size_t i = 0; i + 1 < branch.size(); ++i)
  {
    const Vector2 d = branch[i + 1] - branch[i];
    const double  l = d.norm();
    for (; next < parts && length * next / parts < passed + l; ++next)
    {
      result.push_back(branch[i] + (length * next / parts - passed) / l * d);
    }
    passed += l;
  }
  result.push_back(branch.back());
  return result;
}

bool
CrossEachOther(const Polygon & a, const Polygon & b)
{
  for (std::size_t i = 0; i + 1 < a.size(); ++i)
  {
    for (std::size_t j = 0; j + 1 < b.size(); ++j)
    {
      if (Orient2D(a[i], a[i + 1], b[j]) * Orient2D(a[i], a[i + 1], b[j + 1]) < 0 &&
          Orient2D(b[j], b[j + 1], a[i]) * Orient2D(b[j], b[j + 1], a[i + 1]) < 0)
      {
        return true;
      }
    }
  }
  return false;
}

// Sampling cuts corners: branches are sampled more finely until every chord stays in the region and none cross.
std::vector<Polygon>
SampleInside(const std::vector<Polygon> & branches, double spacing, const std::vector<Polygon> & contours)
{
  std::vector<Polygon> sampled(branches.size());
  std::vector<double>  step(branches.size(), spacing);
  std::vector<char>    bad(branches.size(), 1);
  const auto           leaves = [&contours](const Polygon & branch) {
    std::vector<PlanarChain> chains;
    for (const Polygon & contour : contours)
    {
      chains.push_back({ contour, true });
    }
    chains.push_back({ branch, false });
    return FindPlanarCrossing(chains).found;
  };
  while (std::find(bad.begin(), bad.end(), 1) != bad.end())
  {
    for (std::size_t b = 0; b < branches.size(); ++b)
    {
      for (; bad[b] != 0; step[b] *= 0.5)
      {
        const bool last = step[b] < 0.05 * spacing;
        sampled[b] = last ? branches[b] : SampleBranch(branches[b], step[b]);
        bad[b] = !last && leaves(sampled[b]);
      }
    }
    for (std::size_t b = 0; b < branches.size(); ++b)
    {
      for (std::size_t other = 0; other < b; ++other)
      {
        if (CrossEachOther(sampled[b], sampled[other]))
        {
          bad[b] = bad[b] != 0 || step[b] >= 0.05 * spacing;
          bad[other] = bad[other] != 0 || step[other] >= 0.05 * spacing;
        }
      }
    }
  }
  return sampled;
}
} // namespace

std::vector<AxisBranch>
ComputeMedialAxis(const std::vector<Polygon> & contours, const MedialAxisParameters & parameters)
{
  const AxisFinder finder(contours, parameters);
  AxisGraph        graph = finder.MakeGraph();
  const auto       widest = std::max_element(graph.clearance.begin(), graph.clearance.end());
  if (widest == graph.clearance.end())
  {
    return {};
  }
  const double radius = *widest;
  const auto   centre = static_cast<std::size_t>(widest - graph.clearance.begin());
  TrimEnds(graph, centre, 0.5 * std::min(parameters.spacing, radius));
  std::vector<Polygon> branches = WalkBranches(graph);
  double               length = 0.0;
  for (const Polygon & branch : branches)
  {
    length += LengthOf(branch);
  }
  if (contours.size() == 1 && length < parameters.roundness * radius)
  {
    return { { { graph.points[centre] }, { radius } } };
  }
  std::vector<AxisBranch> result;
  for (Polygon & branch : SampleInside(branches, parameters.spacing, contours))
  {
    AxisBranch sampled{ std::move(branch), {} };
    for (const Vector2 & q : sampled.points)
    {
      sampled.clearance.push_back(finder.Clearance(q));
    }
    result.push_back(std::move(sampled));
  }
  return result;
}

std::vector<int>
FindPolygonsAround(const std::vector<Polygon> & polygons)
{
  std::vector<double> areas;
  for (const Polygon & polygon : polygons)
  {
    areas.push_back(std::abs(SignedArea(polygon)));
  }
  std::vector<int> around(polygons.size(), -1);
  for (std::size_t i = 0; i < polygons.size(); ++i)
  {
    for (std::size_t j = 0; j < polygons.size(); ++j)
    {
      const bool smaller = around[i] < 0 || areas[j] < areas[static_cast<std::size_t>(around[i])];
      if (areas[j] > areas[i] && smaller && PointInPolygon(polygons[i][0], polygons[j]))
      {
        around[i] = static_cast<int>(j);
      }
    }
  }
  return around;
}
} // namespace bone
