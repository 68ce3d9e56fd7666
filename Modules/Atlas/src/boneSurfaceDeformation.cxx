/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSurfaceDeformation.h"

#include "boneAcrossFit.h"

#include <algorithm>
#include <cmath>

namespace bone
{
namespace
{
constexpr std::size_t VerticesAtOnce = 64; // vertices that a thread takes at once

std::vector<std::vector<IdType>>
EdgeNeighbors(const TriangleSurface & surface)
{
  std::vector<std::vector<IdType>> neighbors(surface.points.size());
  for (const auto & t : surface.triangles)
  {
    for (int i = 0; i < 3; ++i)
    {
      neighbors[t[i]].push_back(t[(i + 1) % 3]);
      neighbors[t[i]].push_back(t[(i + 2) % 3]);
    }
  }
  for (auto & list : neighbors)
  {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }
  return neighbors;
}

/** Sorts each ring of each vertex by the angle around the vertex's normal. */
void
SortRings(const TriangleSurface & surface, const Execution & execution, RingNeighbors & rings)
{
  const std::vector<Vector3> normals = PointNormals(surface);
  execution.Silent().For(
    surface.points.size(),
    [&](std::size_t v) {
      Vector3 u = normals[v].unitOrthogonal();
      if (normals[v].isZero())
      {
        return;
      }
      const Vector3 w = normals[v].cross(u);
      const auto    angle = [&](IdType p) {
        const Vector3 d = surface.points[p] - surface.points[v];
        return std::atan2(d.dot(w), d.dot(u));
      };
      for (std::size_t r = 1; r + 1 < rings.start[v].size(); ++r)
      {
        std::stable_sort(rings.ring[v].begin() + rings.start[v][r],
                         rings.ring[v].begin() + rings.start[v][r + 1],
                         [&](IdType a, IdType b) { return angle(a) < angle(b); });
      }
    },
    VerticesAtOnce);
}

/** A third of the area of the triangles around each point. */
std::vector<double>
PointAreas(const TriangleSurface & surface)
{
  std::vector<double> areas(surface.points.size(), 0.0);
  for (const auto & t : surface.triangles)
  {
    const Vector3 & a = surface.points[t[0]];
    const double    area = (surface.points[t[1]] - a).cross(surface.points[t[2]] - a).norm() / 6;
    for (const IdType p : t)
    {
      areas[p] += area;
    }
  }
  return areas;
}

/** Where the target pulls each vertex to, and how much that counts. */
struct Pull
{
  std::vector<Vector3> place;
  std::vector<double>  weight;
};

class FocusDeformation
{
public:
  FocusDeformation(const TriangleSurface &         source,
                   const DirectedSurface &         target,
                   const AdaptiveFocusParameters & parameters,
                   const Execution &               execution)
    : m_Source(source)
    , m_Target(target)
    , m_P(parameters)
    , m_Execution(execution)
    , m_Rings(FindRings(
        source,
        std::max(parameters.attributeLayers, *std::max_element(parameters.rings.begin(), parameters.rings.end())),
        execution))
    , m_Rest(source.points)
    , m_RestAttributes(AttributeVectors(source.points, m_Rings, parameters.attributeLayers, execution))
    , m_TargetArea(PointAreas(target.GetSurface()))
    , m_SourceArea(PointAreas(source))
  {
    m_Focus.assign(source.points.size(), 1.0);
  }

  std::vector<Vector3>
  Run()
  {
    const std::vector<double> distinct = this->Distinctness();
    for (std::size_t stage = 0; stage < m_P.rings.size(); ++stage)
    {
      // Vertices with distinct attributes lead at first; with small segments all count alike.
      const double lead = m_P.focus * (1.0 - static_cast<double>(stage) / static_cast<double>(m_P.rings.size()));
      for (std::size_t v = 0; v < m_Focus.size(); ++v)
      {
        m_Focus[v] = m_SourceArea[v] * std::exp(lead * distinct[v]);
      }
      for (int i = 0; i < m_P.iterations; ++i)
      {
        this->Step(m_P.rings[stage]);
        m_Execution.Report((static_cast<double>(stage) + (i + 1.0) / m_P.iterations) /
                           static_cast<double>(m_P.rings.size()));
      }
    }
    return m_Source.points;
  }

private:
  /** -1..1: rank of a vertex by the size of its first attribute. */
  std::vector<double>
  Distinctness() const
  {
    const std::size_t   n = m_Rest.size();
    std::vector<double> size(n), distinct(n);
    for (std::size_t v = 0; v < n; ++v)
    {
      // Volume spanned with the farthest layer, relative to that of a regular cap of its width.
      const auto & start = m_Rings.start[v];
      const auto   layer = static_cast<std::size_t>(m_P.attributeLayers);
      Vector3      mean = Vector3::Zero();
      double       spread = 0;
      const auto   count = start[layer + 1] - start[1];
      for (auto i = start[1]; i < start[layer + 1]; ++i)
      {
        const Vector3 d = m_Rest[m_Rings.ring[v][i]] - m_Rest[v];
        mean += d;
        spread += d.norm();
      }
      size[v] = count > 0 && spread > 0 ? mean.norm() / spread : 0.0;
    }
    std::vector<std::size_t> order(n);
    for (std::size_t v = 0; v < n; ++v)
    {
      order[v] = v;
    }
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return size[a] < size[b]; });
    for (std::size_t i = 0; i < n; ++i)
    {
      distinct[order[i]] = 2.0 * static_cast<double>(i) / static_cast<double>(n) - 1.0;
    }
    return distinct;
  }

  Pull
  FindPull() const
  {
    const std::size_t          n = m_Rest.size();
    const std::vector<Vector3> normals = PointNormals(m_Source);
    const Eigen::MatrixXd attributes = AttributeVectors(m_Source.points, m_Rings, m_P.attributeLayers, m_Execution);
    Pull                  pull{ std::vector<Vector3>(n), std::vector<double>(n) };
    m_Execution.Silent().For(
      n,
      [&](std::size_t v) {
        const auto   match = m_Target.Find(m_Source.points[v], normals[v]);
        const double agreement =
          match.triangle < 0 ? 0.0 : std::max(0.0, normals[v].dot(m_Target.NormalAt(match.triangle, match.point)));
        const double change =
          (attributes.col(static_cast<Eigen::Index>(v)) - m_RestAttributes.col(static_cast<Eigen::Index>(v))).norm();
        pull.place[v] = match.point;
        pull.weight[v] =
          agreement * agreement / (1 + 2 * (change / m_P.attributeWidth) * (change / m_P.attributeWidth));
      },
      VerticesAtOnce);
    this->AddTargetPull(pull);
    return pull;
  }

  /** The target's vertices pull what is nearest to them: so tips are drawn out. */
  void
  AddTargetPull(Pull & pull) const
  {
    const DirectedSurface               source(m_Source);
    const auto &                        points = m_Target.GetSurface().points;
    const std::size_t                   stride = std::max<std::size_t>(1, points.size() / m_P.targetPoints);
    std::vector<DirectedSurface::Match> matches(points.size());
    m_Execution.Silent().For(
      points.size() / stride,
      [&](std::size_t i) {
        matches[i * stride] = source.Find(points[i * stride], m_Target.GetPointNormals()[i * stride]);
      },
      VerticesAtOnce);
    std::vector<Vector3> sum(m_Rest.size(), Vector3::Zero());
    std::vector<double>  weight(m_Rest.size(), 0.0);
    for (std::size_t p = 0; p < points.size(); ++p)
    {
      if (matches[p].triangle < 0)
      {
        continue;
      }
      const auto &  ids = m_Source.triangles[static_cast<std::size_t>(matches[p].triangle)];
      const Vector3 share = source.Weights(matches[p].triangle, matches[p].point);
      const double  agreement =
        static_cast<double>(stride) *
        std::max(0.0, source.NormalAt(matches[p].triangle, matches[p].point).dot(m_Target.GetPointNormals()[p]));
      for (int i = 0; i < 3; ++i)
      {
        const double w = m_TargetArea[p] * share[i] * agreement;
        sum[ids[i]] += w * (points[p] - matches[p].point);
        weight[ids[i]] += w;
      }
    }
    for (std::size_t v = 0; v < m_Rest.size(); ++v)
    {
      if (weight[v] > 0)
      {
        // Both directions count by the area they stand for.
        const double both = m_SourceArea[v] * pull.weight[v] + weight[v];
        pull.place[v] =
          (m_SourceArea[v] * pull.weight[v] * pull.place[v] + weight[v] * (m_Source.points[v] + sum[v] / weight[v])) /
          both;
        pull.weight[v] = std::max(pull.weight[v], std::min(1.0, weight[v] / m_SourceArea[v]));
      }
    }
  }

  /** Moves every vertex by the affine map of its segment, fitted from rest to the pull. */
  void
  Step(int rings)
  {
    const Pull                   pull = this->FindPull();
    const std::vector<Vector3>   normals = PointNormals(m_Source);
    std::vector<AcrossFit::Term> terms(m_Rest.size());
    for (std::size_t v = 0; v < m_Rest.size(); ++v)
    {
      terms[v] = AcrossFit::MakeTerm(normals[v], pull.place[v] - m_Rest[v], m_P.slide, pull.weight[v] * m_Focus[v]);
    }
    std::vector<Vector3> moved(m_Rest.size());
    m_Execution.Silent().For(
      m_Rest.size(), [&](std::size_t v) { moved[v] = this->MapVertex(v, rings, terms); }, VerticesAtOnce);
    m_Source.points = std::move(moved);
  }

  Vector3
  MapVertex(std::size_t v, int rings, const std::vector<AcrossFit::Term> & terms) const
  {
    const auto & ids = m_Rings.ring[v];
    const auto & start = m_Rings.start[v];
    AcrossFit    fit;
    for (int r = 0; r <= rings; ++r)
    {
      const double x = r / (rings + 1.0);
      for (auto i = start[r]; i < start[r + 1]; ++i)
      {
        fit.Add(m_Rest[ids[i]] - m_Rest[v], terms[ids[i]], (1 - x * x) * (1 - x * x));
      }
    }
    Eigen::Matrix3d linear;
    Vector3         move;
    return fit.Solve(m_P.ridge, linear, move) ? Vector3(m_Rest[v] + move) : m_Source.points[v];
  }

  TriangleSurface                 m_Source; // where it is now
  const DirectedSurface &         m_Target;
  const AdaptiveFocusParameters & m_P;
  Execution                       m_Execution;
  RingNeighbors                   m_Rings;
  std::vector<Vector3>            m_Rest;
  Eigen::MatrixXd                 m_RestAttributes;
  std::vector<double>             m_TargetArea;
  std::vector<double>             m_SourceArea;
  std::vector<double>             m_Focus;
};
} // namespace

RingNeighbors
FindRings(const TriangleSurface & surface, int rings, const Execution & execution)
{
  const auto    neighbors = EdgeNeighbors(surface);
  RingNeighbors result;
  result.ring.resize(surface.points.size());
  result.start.resize(surface.points.size());
  constexpr std::size_t Batch = 256; // vertices that share a list of marks
  execution.Silent().For((surface.points.size() + Batch - 1) / Batch, [&](std::size_t batch) {
    std::vector<IdType> seen(surface.points.size(), -1);
    for (std::size_t v = batch * Batch; v < std::min(surface.points.size(), (batch + 1) * Batch); ++v)
    {
      auto & ring = result.ring[v];
      auto & start = result.start[v];
      ring = { static_cast<IdType>(v) };
      start = { 0, 1 };
      seen[v] = static_cast<IdType>(v);
      for (int r = 1; r <= rings; ++r)
      {
        for (auto i = start[r - 1]; i < start[r]; ++i)
        {
          for (const IdType p : neighbors[ring[i]])
          {
            if (seen[p] != static_cast<IdType>(v))
            {
              seen[p] = static_cast<IdType>(v);
              ring.push_back(p);
            }
          }
        }
        start.push_back(static_cast<std::int32_t>(ring.size()));
      }
    }
  });
  SortRings(surface, execution, result);
  return result;
}

Eigen::MatrixXd
AttributeVectors(const std::vector<Vector3> & points,
                 const RingNeighbors &        rings,
                 int                          layers,
                 const Execution &            execution)
{
  Eigen::MatrixXd attributes = Eigen::MatrixXd::Zero(layers, static_cast<Eigen::Index>(points.size()));
  execution.Silent().For(
    points.size(),
    [&](std::size_t v) {
      auto column = attributes.col(static_cast<Eigen::Index>(v));
      for (int layer = 1; layer <= layers; ++layer)
      {
        const auto   begin = rings.start[v][layer], count = rings.start[v][layer + 1] - begin;
        const auto * ring = rings.ring[v].data() + begin;
        for (std::int32_t i = 0; i < count; ++i)
        {
          column[layer - 1] += SignedVolume(points[v],
                                            points[ring[i]],
                                            points[ring[(i + count / 3) % count]],
                                            points[ring[(i + 2 * count / 3) % count]]);
        }
        column[layer - 1] /= std::max(count, 1);
      }
      const double sum = column.cwiseAbs().sum();
      if (sum > 0)
      {
        column /= sum;
      }
    },
    VerticesAtOnce);
  return attributes;
}

std::vector<Vector3>
DeformAdaptiveFocus(const TriangleSurface &         source,
                    const DirectedSurface &         target,
                    const AdaptiveFocusParameters & parameters,
                    const Execution &               execution)
{
  return FocusDeformation(source, target, parameters, execution).Run();
}
} // namespace bone
