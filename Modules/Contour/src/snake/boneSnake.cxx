/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSnake.h"

#include "boneContourStack.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace bone
{
namespace
{
constexpr int    FlowIterations = 80;
constexpr double FlowSmoothness = 0.2;

Vector2
OutwardNormal(const Polygon & contour, std::size_t i)
{
  const std::size_t n = contour.size();
  const Vector2     tangent = contour[(i + 1) % n] - contour[(i + n - 1) % n];
  const Vector2     normal(tangent.y(), -tangent.x());
  const double      length = normal.norm();
  return length > 0.0 ? Vector2(normal / length) : Vector2::Zero();
}

// Central differences at an inner node.
Vector2
SlopeAt(const PlaneField & f, int i, int j)
{
  const PlaneGrid & grid = f.grid;
  return { (f.values[grid.Offset(i + 1, j)] - f.values[grid.Offset(i - 1, j)]) / (2.0 * grid.spacing.x()),
           (f.values[grid.Offset(i, j + 1)] - f.values[grid.Offset(i, j - 1)]) / (2.0 * grid.spacing.y()) };
}

// Spreads a component of the edges' gradient: diffusion, held to the data where that has weight.
void
Diffuse(PlaneField & flow, const std::vector<float> & weight)
{
  const PlaneGrid &        grid = flow.grid;
  const double             pixel = grid.spacing.minCoeff();
  const float              wx = static_cast<float>(FlowSmoothness * std::pow(pixel / grid.spacing.x(), 2));
  const float              wy = static_cast<float>(FlowSmoothness * std::pow(pixel / grid.spacing.y(), 2));
  const auto               row = static_cast<std::ptrdiff_t>(grid.size[0]);
  const std::vector<float> data = flow.values;
  std::vector<float>       next = data;
  for (int iteration = 0; iteration < FlowIterations; ++iteration)
  {
    for (int j = 1; j + 1 < grid.size[1]; ++j)
    {
      const std::size_t first = grid.Offset(1, j);
      const float *     v = flow.values.data() + first;
      for (std::ptrdiff_t i = 0; i + 2 < row; ++i)
      {
        const std::size_t n = first + static_cast<std::size_t>(i);
        next[n] = v[i] + wx * (v[i - 1] + v[i + 1] - 2.0F * v[i]) + wy * (v[i - row] + v[i + row] - 2.0F * v[i]) -
                  weight[n] * (v[i] - data[n]);
      }
    }
    flow.values.swap(next);
  }
}

double
MeanMotion(const Polygon & a, const Polygon & b)
{
  double squared = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i)
  {
    squared += (a[i] - b[i]).squaredNorm();
  }
  return std::sqrt(squared / static_cast<double>(a.size()));
}

// The internal energy's matrix for points `spacing` apart: diagonal and two off-diagonals.
struct InternalForces
{
  InternalForces(const SnakeContourParameters & parameters, double spacing)
  {
    const double a = parameters.elasticity / (spacing * spacing);
    const double b = parameters.rigidity / (spacing * spacing * spacing * spacing);
    diagonal = 2.0 * a + 6.0 * b;
    first = -a - 4.0 * b;
    second = b;
  }

  double
  Energy(const Polygon & x) const
  {
    double            sum = 0.0;
    const std::size_t n = x.size();
    for (std::size_t i = 0; i < n; ++i)
    {
      sum +=
        diagonal * x[i].squaredNorm() + 2.0 * (first * x[i].dot(x[(i + 1) % n]) + second * x[i].dot(x[(i + 2) % n]));
    }
    return sum;
  }

  double diagonal;
  double first;
  double second;
};

// Follows the flow, with steps of half a pixel at first, halved when most of the contour steps to and fro; false where
// the contour vanishes.
bool
FollowFlow(Polygon & contour, const BoneEdges & edges, const SnakeContourParameters & parameters, SnakeResult & result)
{
  const double        pixel = edges.GetPixel();
  double              step = 0.5;
  std::vector<double> before;
  for (int iteration = 0; iteration < parameters.maximumNumberOfIterations && step > 0.05; ++iteration)
  {
    const double         spacing = Perimeter(contour) / static_cast<double>(contour.size());
    const InternalForces internal(parameters, spacing);
    Polygon              moved = contour;
    std::vector<double>  force(contour.size());
    double               turned = 0.0;
    for (std::size_t i = 0; i < contour.size(); ++i)
    {
      // Along the normal only: points do not slide together.
      const Vector2 normal = OutwardNormal(contour, i);
      force[i] = edges.Flow(contour[i]).dot(normal);
      moved[i] += step * parameters.externalWeight * pixel * force[i] * normal;
      turned += i < before.size() ? force[i] * before[i] : 0.0;
    }
    const std::vector<double> diagonal(contour.size(), 1.0 + step * internal.diagonal);
    CyclicPentadiagonal(diagonal, step * internal.first, step * internal.second).Solve(moved);
    const double motion = MeanMotion(contour, moved);
    contour = ResampleUniform(moved, pixel);
    ++result.iterations;
    if (!(std::abs(SignedArea(contour)) > 9.0 * pixel * pixel))
    {
      return false;
    }
    step *= turned < 0.0 ? 0.5 : 1.0;
    before = std::move(force);
    if (motion < std::max(parameters.convergenceTolerance, 0.02 * pixel))
    {
      break;
    }
  }
  return true;
}

// Draws points to their edges; bounded: on the normals of where they started, within reach.
void
SettleOnEdges(Polygon &                      contour,
              const BoneEdges &              edges,
              double                         reach,
              bool                           bounded,
              const SnakeContourParameters & parameters,
              SnakeResult &                  result)
{
  const std::size_t    n = contour.size();
  const Polygon        anchor = contour;
  const InternalForces internal(parameters, Perimeter(contour) / static_cast<double>(n));
  std::vector<double>  slopes;
  for (int iteration = 0; iteration < parameters.maximumNumberOfIterations; ++iteration)
  {
    Polygon             moved = contour;
    std::vector<double> diagonal(n);
    slopes.clear();
    for (std::size_t i = 0; i < n; ++i)
    {
      // A weight on the point's own place damps it; the edge's weight draws it on.
      const Vector2 normal = OutwardNormal(bounded ? anchor : contour, i);
      double        offset = 0.0;
      double        slope = 0.0;
      const bool    found = edges.FindEdge(bounded ? anchor[i] : contour[i], normal, reach, offset, slope);
      const double  damping = found ? 0.2 : 0.5;
      const double  weight = found ? parameters.externalWeight : 0.0;
      const Vector2 target = (bounded ? anchor[i] : contour[i]) + offset * normal;
      moved[i] = damping * contour[i] + weight * target;
      diagonal[i] = damping + weight + internal.diagonal;
      if (found)
      {
        slopes.push_back(slope);
      }
    }
    CyclicPentadiagonal(diagonal, internal.first, internal.second).Solve(moved);
    for (std::size_t i = 0; bounded && i < n; ++i)
    {
      const Vector2 off = moved[i] - anchor[i];
      moved[i] = anchor[i] + off * std::min(1.0, reach / std::max(off.norm(), 1e-12));
    }
    const double motion = MeanMotion(contour, moved);
    contour = bounded ? moved : ResampleUniform(moved, Perimeter(moved) / static_cast<double>(n));
    ++result.iterations;
    if (motion < parameters.convergenceTolerance || contour.size() != n)
    {
      result.converged = true;
      break;
    }
  }
  result.reason = result.converged ? "motion below tolerance" : "iterations used up";
  result.support = static_cast<double>(slopes.size()) / static_cast<double>(n);
  if (!slopes.empty())
  {
    const auto middle = slopes.begin() + static_cast<std::ptrdiff_t>(slopes.size() / 2);
    std::nth_element(slopes.begin(), middle, slopes.end());
    result.strength = *middle;
  }
  result.energy = internal.Energy(contour);
}
} // namespace

CyclicPentadiagonal::CyclicPentadiagonal(const std::vector<double> & diagonal, double first, double second)
  : m_Open(diagonal.size() - 2)
  , m_D(m_Open)
  , m_L1(m_Open, 0.0)
  , m_L2(m_Open, 0.0)
{
  for (std::size_t i = 0; i < m_Open; ++i)
  {
    m_L2[i] = i > 1 ? second / m_D[i - 2] : 0.0;
    m_L1[i] = i > 0 ? (first - (i > 1 ? m_L2[i] * m_D[i - 2] * m_L1[i - 1] : 0.0)) / m_D[i - 1] : 0.0;
    m_D[i] =
      diagonal[i] - (i > 0 ? m_L1[i] * m_L1[i] * m_D[i - 1] : 0.0) - (i > 1 ? m_L2[i] * m_L2[i] * m_D[i - 2] : 0.0);
  }
  for (auto & border : m_Border)
  {
    border.assign(m_Open, 0.0);
  }
  // Unknown n - 2 neighbours n - 4, n - 3 and, around the end, 0; unknown n - 1 neighbours n - 3 and 0, 1.
  m_Border[0][m_Open - 1] += first;
  m_Border[0][m_Open - 2] += second;
  m_Border[0][0] += second;
  m_Border[1][m_Open - 1] += second;
  m_Border[1][0] += first;
  m_Border[1][1] += second;
  m_Schur << diagonal[m_Open], first, first, diagonal[m_Open + 1];
  for (int a = 0; a < 2; ++a)
  {
    m_Reduced[a] = m_Border[a];
    this->SolveOpen(m_Reduced[a]);
  }
  for (int a = 0; a < 2; ++a)
  {
    for (int b = 0; b < 2; ++b)
    {
      for (std::size_t i = 0; i < m_Open; ++i)
      {
        m_Schur(a, b) -= m_Border[a][i] * m_Reduced[b][i];
      }
    }
  }
}

void
CyclicPentadiagonal::SolveOpen(std::vector<double> & values) const
{
  for (std::size_t i = 0; i < m_Open; ++i)
  {
    values[i] -= (i > 0 ? m_L1[i] * values[i - 1] : 0.0) + (i > 1 ? m_L2[i] * values[i - 2] : 0.0);
  }
  for (std::size_t i = m_Open; i-- > 0;)
  {
    values[i] /= m_D[i];
    values[i] -=
      (i + 1 < m_Open ? m_L1[i + 1] * values[i + 1] : 0.0) + (i + 2 < m_Open ? m_L2[i + 2] * values[i + 2] : 0.0);
  }
}

void
CyclicPentadiagonal::Solve(std::vector<Vector2> & values) const
{
  const Eigen::Matrix2d inverse = m_Schur.inverse();
  std::vector<double>   open(m_Open);
  for (int axis = 0; axis < 2; ++axis)
  {
    Vector2 last(values[m_Open][axis], values[m_Open + 1][axis]);
    for (std::size_t i = 0; i < m_Open; ++i)
    {
      open[i] = values[i][axis];
      last.x() -= m_Reduced[0][i] * values[i][axis];
      last.y() -= m_Reduced[1][i] * values[i][axis];
    }
    last = (inverse * last).eval();
    this->SolveOpen(open);
    for (std::size_t i = 0; i < m_Open; ++i)
    {
      values[i][axis] = open[i] - m_Reduced[0][i] * last.x() - m_Reduced[1][i] * last.y();
    }
    values[m_Open][axis] = last.x();
    values[m_Open + 1][axis] = last.y();
  }
}

Polygon
ResampleUniform(const Polygon & polygon, double spacing)
{
  const double length = Perimeter(polygon);
  const int    count = std::max(8, static_cast<int>(std::lround(length / spacing)));
  const double step = length / count;
  Polygon      result;
  double       passed = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i)
  {
    const Vector2 a = polygon[i];
    const Vector2 d = polygon[(i + 1) % polygon.size()] - a;
    const double  l = d.norm();
    while (static_cast<int>(result.size()) < count && static_cast<double>(result.size()) * step < passed + l)
    {
      result.push_back(a + (static_cast<double>(result.size()) * step - passed) / l * d);
    }
    passed += l;
  }
  return result;
}

BoneEdges::BoneEdges(const PlaneField & image, const std::vector<Polygon> & start, double sigma, double minimumSlope)
  : m_Image(image)
  , m_MinimumSlope(minimumSlope)
{
  SmoothField(m_Image, sigma);
  this->ComputeFlow(this->EdgeMap(start));
}

// Slopes that rise towards the inside of the start contours, the strongest tenth being 1; empty without any.
PlaneField
BoneEdges::EdgeMap(const std::vector<Polygon> & start) const
{
  const PlaneGrid & grid = m_Image.grid;
  PlaneField        map{ grid, {} };
  if (start.empty())
  {
    return map;
  }
  const PlaneField   inside = ComputeDistanceField(start, grid).distance;
  std::vector<float> strengths;
  map.values.assign(grid.Count(), 0.0F);
  for (int j = 1; j + 1 < grid.size[1]; ++j)
  {
    for (int i = 1; i + 1 < grid.size[0]; ++i)
    {
      const Vector2 inward = SlopeAt(inside, i, j);
      const double  length = inward.norm();
      const double  rise = length > 0.0 ? SlopeAt(m_Image, i, j).dot(inward) / length : 0.0;
      if (rise > m_MinimumSlope)
      {
        map.values[grid.Offset(i, j)] = static_cast<float>(rise);
        strengths.push_back(static_cast<float>(rise));
      }
    }
  }
  if (strengths.empty())
  {
    map.values.clear();
    return map;
  }
  const auto high = strengths.begin() + static_cast<std::ptrdiff_t>(strengths.size() * 9 / 10);
  std::nth_element(strengths.begin(), high, strengths.end());
  for (float & value : map.values)
  {
    value = std::min(1.0F, value / *high);
  }
  return map;
}

void
BoneEdges::ComputeFlow(const PlaneField & map)
{
  const PlaneGrid & grid = m_Image.grid;
  m_FlowX = m_FlowY = PlaneField{ grid, std::vector<float>(grid.Count(), 0.0F) };
  if (map.values.empty())
  {
    return;
  }
  // What the data says, in pixels, and how much say it has.
  const double       pixel = this->GetPixel();
  std::vector<float> weight(grid.Count(), 0.0F);
  for (int j = 1; j + 1 < grid.size[1]; ++j)
  {
    for (int i = 1; i + 1 < grid.size[0]; ++i)
    {
      const Vector2     g = pixel * SlopeAt(map, i, j);
      const std::size_t n = grid.Offset(i, j);
      m_FlowX.values[n] = static_cast<float>(g.x());
      m_FlowY.values[n] = static_cast<float>(g.y());
      weight[n] = static_cast<float>(g.squaredNorm());
    }
  }
  Diffuse(m_FlowX, weight);
  Diffuse(m_FlowY, weight);
}

Vector2
BoneEdges::Flow(const Vector2 & q) const
{
  // Full force where the flow is more than a trace; linear through zero on the edge.
  const Vector2 flow(m_FlowX.Sample(q), m_FlowY.Sample(q));
  const double  length = flow.norm();
  return length > 0.0 ? Vector2(flow / std::max(length, 0.02)) : Vector2::Zero();
}

bool
BoneEdges::FindEdge(const Vector2 & q, const Vector2 & outward, double reach, double & offset, double & slope) const
{
  // The fall is measured over a pixel: between the image's nodes the interpolant's own slope ripples.
  constexpr int       half = 2;
  const double        step = 0.25 * this->GetPixel();
  const int           count = std::max(2, static_cast<int>(std::ceil(reach / step)));
  const double        width = reach / 1.5;
  std::vector<double> fall;
  {
    std::vector<double> values;
    for (int k = -count - 1 - half; k <= count + 1 + half; ++k)
    {
      values.push_back(m_Image.SampleCubic(q + k * step * outward));
    }
    for (std::size_t k = 0; k + 2 * half < values.size(); ++k)
    {
      fall.push_back((values[k] - values[k + 2 * half]) / (2 * half * step));
    }
  }
  std::size_t found = 0;
  double      best = 0.0;
  for (std::size_t k = 1; k + 1 < fall.size(); ++k)
  {
    const double at = (static_cast<int>(k) - count - 1) * step;
    const double score = fall[k] * std::exp(-0.5 * at * at / (width * width));
    if (fall[k] > m_MinimumSlope && fall[k] >= fall[k - 1] && fall[k] >= fall[k + 1] && score > best)
    {
      best = score;
      found = k;
    }
  }
  if (found == 0)
  {
    return false;
  }
  const double bend = fall[found - 1] - 2.0 * fall[found] + fall[found + 1];
  const double shift = bend < 0.0 ? 0.5 * step * (fall[found - 1] - fall[found + 1]) / bend : 0.0;
  offset = std::clamp((static_cast<int>(found) - count - 1) * step + shift, -reach, reach);
  slope = fall[found];
  return true;
}

SnakeResult
EvolveSnake(const Polygon & start, const BoneEdges & edges, const SnakeContourParameters & parameters)
{
  SnakeResult  result;
  const double pixel = edges.GetPixel();
  result.contour = ResampleUniform(start, pixel);
  if (!FollowFlow(result.contour, edges, parameters, result))
  {
    result.contour.clear();
    result.reason = "vanished";
    return result;
  }
  SettleOnEdges(result.contour, edges, 2.0 * pixel, false, parameters, result);
  return result;
}

SnakeResult
RefineSnake(const Polygon & start, const BoneEdges & edges, double bound, const SnakeContourParameters & parameters)
{
  SnakeResult result;
  result.contour = ResampleUniform(start, edges.GetPixel());
  SettleOnEdges(result.contour, edges, bound, true, parameters, result);
  return result;
}
} // namespace bone
