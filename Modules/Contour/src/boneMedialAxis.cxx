/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneMedialAxis.h"

#include "boneContourStack.h"
#include "bonePlanarCrossing.h"

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

struct AxisEdge
{
  int  a;
  int  b;
  bool used;
};

// The significant part of the diagram inside the polygon, as a graph.
struct AxisGraph
{
  std::vector<Vector2>          points;
  std::vector<double>           clearance;
  std::vector<AxisEdge>         edges;
  std::vector<std::vector<int>> edgesAt;
};

class AxisFinder
{
public:
  AxisFinder(const Polygon & polygon, const MedialAxisParameters & parameters)
    : m_Polygon(polygon)
    , m_Parameters(parameters)
    , m_Length(1, 0.0)
  {
    std::vector<IntegerPoint> corners;
    for (std::size_t i = 0; i < polygon.size(); ++i)
    {
      const Vector2 scaled = UnitsPerMillimetre * (polygon[i] - polygon[0]);
      corners.emplace_back(static_cast<std::int32_t>(std::lround(scaled.x())),
                           static_cast<std::int32_t>(std::lround(scaled.y())));
      m_Length.push_back(m_Length.back() + (polygon[(i + 1) % polygon.size()] - polygon[i]).norm());
    }
    for (std::size_t i = 0; i < corners.size(); ++i)
    {
      m_Segments.emplace_back(corners[i], corners[(i + 1) % corners.size()]);
    }
    boost::polygon::construct_voronoi(m_Segments.begin(), m_Segments.end(), &m_Diagram);
  }

  AxisGraph
  MakeGraph()
  {
    AxisGraph                   graph;
    std::map<const void *, int> idOf;
    const auto                  vertexId = [&](const Diagram::vertex_type * vertex) {
      const auto inserted = idOf.emplace(vertex, static_cast<int>(graph.points.size()));
      if (inserted.second)
      {
        graph.points.push_back(m_Polygon[0] + Vector2(vertex->x(), vertex->y()) / UnitsPerMillimetre);
        graph.clearance.push_back(this->Clearance(graph.points.back()));
      }
      return inserted.first->second;
    };
    for (const Diagram::edge_type & edge : m_Diagram.edges())
    {
      // Each edge once, finite, between two different parts of the contour, and inside.
      if (&edge > edge.twin() || !edge.is_finite() || !edge.is_primary() || !this->IsSignificant(edge))
      {
        continue;
      }
      const int a = vertexId(edge.vertex0());
      const int b = vertexId(edge.vertex1());
      if (a != b)
      {
        graph.edges.push_back({ a, b, false });
      }
    }
    graph.edgesAt.resize(graph.points.size());
    for (std::size_t e = 0; e < graph.edges.size(); ++e)
    {
      graph.edgesAt[static_cast<std::size_t>(graph.edges[e].a)].push_back(static_cast<int>(e));
      graph.edgesAt[static_cast<std::size_t>(graph.edges[e].b)].push_back(static_cast<int>(e));
    }
    return graph;
  }

  // Centre of the largest disk inside, of the diagram's vertices.
  Vector2
  LargestDisk(double & radius) const
  {
    Vector2 centre = Vector2::Zero();
    radius = 0.0;
    for (const Diagram::vertex_type & vertex : m_Diagram.vertices())
    {
      const Vector2 q = m_Polygon[0] + Vector2(vertex.x(), vertex.y()) / UnitsPerMillimetre;
      if (PointInPolygon(q, m_Polygon))
      {
        const double clearance = this->Clearance(q);
        centre = clearance > radius ? q : centre;
        radius = std::max(radius, clearance);
      }
    }
    return centre;
  }

private:
  double
  Clearance(const Vector2 & q) const
  {
    double best = std::numeric_limits<double>::max();
    for (std::size_t i = 0; i < m_Polygon.size(); ++i)
    {
      best = std::min(best, (q - this->Foot(q, i, nullptr)).squaredNorm());
    }
    return std::sqrt(best);
  }

  // Nearest point of an edge of the polygon, and its place along the contour.
  Vector2
  Foot(const Vector2 & q, std::size_t i, double * place) const
  {
    const Vector2 & a = m_Polygon[i];
    const Vector2   d = m_Polygon[(i + 1) % m_Polygon.size()] - a;
    const double    squared = d.squaredNorm();
    const double    t = squared > 0.0 ? std::clamp((q - a).dot(d) / squared, 0.0, 1.0) : 0.0;
    if (place != nullptr)
    {
      *place = m_Length[i] + t * std::sqrt(squared);
    }
    return a + t * d;
  }

  bool
  IsSignificant(const Diagram::edge_type & edge) const
  {
    const Vector2 q =
      m_Polygon[0] + 0.5 / UnitsPerMillimetre *
                       Vector2(edge.vertex0()->x() + edge.vertex1()->x(), edge.vertex0()->y() + edge.vertex1()->y());
    if (!PointInPolygon(q, m_Polygon))
    {
      return false;
    }
    double        placeA = 0.0;
    double        placeB = 0.0;
    const Vector2 a = this->Foot(q, edge.cell()->source_index(), &placeA);
    const Vector2 b = this->Foot(q, edge.twin()->cell()->source_index(), &placeB);
    const double  along = std::abs(placeA - placeB);
    const double  residual = std::min(along, m_Length.back() - along) - (a - b).norm();
    return residual > m_Parameters.significance * (q - a).norm();
  }

  const Polygon &              m_Polygon;
  const MedialAxisParameters & m_Parameters;
  std::vector<double>          m_Length;
  std::vector<IntegerSegment>  m_Segments;
  Diagram                      m_Diagram;
};

int
Degree(const AxisGraph & graph, std::size_t p)
{
  return static_cast<int>(std::count_if(graph.edgesAt[p].begin(), graph.edgesAt[p].end(), [&graph](int e) {
    return !graph.edges[static_cast<std::size_t>(e)].used;
  }));
}

// Takes back ends that run into sharp corners, until their clearance is `least`.
void
TrimEnds(AxisGraph & graph, double least)
{
  std::vector<std::size_t> ends;
  for (std::size_t p = 0; p < graph.points.size(); ++p)
  {
    ends.push_back(p);
  }
  while (!ends.empty())
  {
    const std::size_t p = ends.back();
    ends.pop_back();
    if (Degree(graph, p) != 1 || graph.clearance[p] >= least)
    {
      continue;
    }
    for (int e : graph.edgesAt[p])
    {
      AxisEdge & edge = graph.edges[static_cast<std::size_t>(e)];
      if (!edge.used)
      {
        edge.used = true;
        ends.push_back(static_cast<std::size_t>(edge.a) == p ? static_cast<std::size_t>(edge.b)
                                                             : static_cast<std::size_t>(edge.a));
      }
    }
  }
  for (auto & around : graph.edgesAt)
  {
    around.erase(std::remove_if(around.begin(),
                                around.end(),
                                [&graph](int e) { return graph.edges[static_cast<std::size_t>(e)].used; }),
                 around.end());
  }
}

// The polyline from an end or fork along `first` to the next end or fork.
AxisBranch
WalkBranch(AxisGraph & graph, int start, int first)
{
  AxisBranch branch(1, graph.points[static_cast<std::size_t>(start)]);
  int        at = start;
  for (int e = first; e >= 0;)
  {
    AxisEdge & edge = graph.edges[static_cast<std::size_t>(e)];
    edge.used = true;
    at = edge.a == at ? edge.b : edge.a;
    branch.push_back(graph.points[static_cast<std::size_t>(at)]);
    e = -1;
    const auto & around = graph.edgesAt[static_cast<std::size_t>(at)];
    if (around.size() == 2)
    {
      for (int next : around)
      {
        e = graph.edges[static_cast<std::size_t>(next)].used ? e : next;
      }
    }
  }
  return branch;
}

double
LengthOf(const AxisBranch & branch)
{
  double length = 0.0;
  for (std::size_t i = 0; i + 1 < branch.size(); ++i)
  {
    length += (branch[i + 1] - branch[i]).norm();
  }
  return length;
}

// Even samples, both ends kept.
AxisBranch
SampleBranch(const AxisBranch & branch, double spacing)
{
  const double length = LengthOf(branch);
  const int    parts = std::max(1, static_cast<int>(std::lround(length / spacing)));
  AxisBranch   result(1, branch.front());
  double       passed = 0.0;
  int          next = 1;
  for (std::size_t i = 0; i + 1 < branch.size(); ++i)
  {
    const Vector2 d = branch[i + 1] - branch[i];
    const double  l = d.norm();
    for (; next < parts && length * next / parts <= passed + l; ++next)
    {
      result.push_back(branch[i] + (length * next / parts - passed) / l * d);
    }
    passed += l;
  }
  result.push_back(branch.back());
  return result;
}

// Sampling cuts corners: it is made finer until every chord stays inside the polygon.
AxisBranch
SampleInside(const AxisBranch & branch, double spacing, const Polygon & polygon)
{
  for (double step = spacing; step > 0.05 * spacing; step *= 0.5)
  {
    AxisBranch sampled = SampleBranch(branch, step);
    if (!FindPlanarCrossing({ { polygon, true }, { sampled, false } }).found)
    {
      return sampled;
    }
  }
  return branch;
}
} // namespace

std::vector<AxisBranch>
ComputeMedialAxis(const Polygon & polygon, const MedialAxisParameters & parameters)
{
  AxisFinder              finder(polygon, parameters);
  AxisGraph               graph = finder.MakeGraph();
  double                  radius = 0.0;
  const Vector2           centre = finder.LargestDisk(radius);
  std::vector<AxisBranch> branches;
  double                  length = 0.0;
  TrimEnds(graph, 0.5 * std::min(parameters.spacing, radius));
  for (std::size_t p = 0; p < graph.points.size(); ++p)
  {
    if (graph.edgesAt[p].size() == 2)
    {
      continue;
    }
    for (int e : graph.edgesAt[p])
    {
      if (!graph.edges[static_cast<std::size_t>(e)].used)
      {
        branches.push_back(WalkBranch(graph, static_cast<int>(p), e));
        length += LengthOf(branches.back());
      }
    }
  }
  if (length < parameters.roundness * radius)
  {
    return { { centre } };
  }
  for (AxisBranch & branch : branches)
  {
    branch = SampleInside(branch, parameters.spacing, polygon);
  }
  return branches;
}
} // namespace bone
