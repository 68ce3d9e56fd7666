/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneClosedBSpline.h"

#include "boneSparseCholesky.h"

#include <algorithm>
#include <cmath>

namespace bone
{
namespace
{
std::array<double, 4>
BasisOf(double t, int order)
{
  switch (order)
  {
    case 0:
      return { { (1.0 - t) * (1.0 - t) * (1.0 - t) / 6.0,
                 (3.0 * t * t * t - 6.0 * t * t + 4.0) / 6.0,
                 (-3.0 * t * t * t + 3.0 * t * t + 3.0 * t + 1.0) / 6.0,
                 t * t * t / 6.0 } };
    case 1:
      return { { -0.5 * (1.0 - t) * (1.0 - t), 1.5 * t * t - 2.0 * t, -1.5 * t * t + t + 0.5, 0.5 * t * t } };
    default:
      return { { 1.0 - t, 3.0 * t - 2.0, -3.0 * t + 1.0, t } };
  }
}

// Cumulative length at each point, and the whole length at the end.
std::vector<double>
ArcLength(const Polygon & points)
{
  std::vector<double> length(1, 0.0);
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    length.push_back(length.back() + (points[(i + 1) % points.size()] - points[i]).norm());
  }
  return length;
}

// Control points that bring the curve nearest to points[i] at the parameters t[i].
ClosedBSpline
SolveControlPoints(const Polygon & points, const std::vector<double> & t, std::size_t m)
{
  // Row r holds the entries of columns r .. r + 3 (cyclic) of the symmetric matrix.
  Eigen::MatrixX4d band = Eigen::MatrixX4d::Zero(static_cast<Eigen::Index>(m), 4);
  Eigen::MatrixX2d right = Eigen::MatrixX2d::Zero(static_cast<Eigen::Index>(m), 2);
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    const double span = std::floor(t[i]);
    const auto   basis = BasisOf(t[i] - span, 0);
    for (int a = 0; a < 4; ++a)
    {
      const auto row = static_cast<Eigen::Index>((static_cast<std::size_t>(span) + static_cast<std::size_t>(a)) % m);
      right.row(row) += basis[a] * points[i].transpose();
      for (int b = a; b < 4; ++b)
      {
        band(row, b - a) += basis[a] * basis[b];
      }
    }
  }
  // A whiff of stiffness (squared second differences) keeps the matrix regular where a span holds no point.
  const double stiffness = 1e-6 * static_cast<double>(points.size()) / static_cast<double>(m);
  band.rowwise() += stiffness * Eigen::RowVector4d(6.0, -4.0, 1.0, 0.0);
  std::vector<SparseEntry> entries;
  entries.reserve(7 * m);
  for (std::size_t r = 0; r < m; ++r)
  {
    for (std::size_t d = 0; d < 4; ++d)
    {
      const auto   row = static_cast<Eigen::Index>(r);
      const auto   column = static_cast<Eigen::Index>((r + d) % m);
      const double value = band(row, static_cast<Eigen::Index>(d));
      entries.push_back({ row, column, value });
      if (d > 0)
      {
        entries.push_back({ column, row, value });
      }
    }
  }
  SparseCholesky factor;
  factor.Factorize(static_cast<Eigen::Index>(m), entries);
  const Eigen::MatrixXd solution = factor.Solve(right);
  std::vector<Vector2>  control(m);
  for (std::size_t i = 0; i < m; ++i)
  {
    control[i] = solution.row(static_cast<Eigen::Index>(i)).transpose();
  }
  return ClosedBSpline(std::move(control));
}

// Moves each parameter to the curve's nearest point (one Newton step, at most half a span); returns the largest
// distance.
double
CorrectParameters(const ClosedBSpline & curve, const Polygon & points, std::vector<double> & t)
{
  const auto m = static_cast<double>(curve.GetNumberOfControlPoints());
  double     largest = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    const Vector2 d1 = curve.Evaluate(t[i], 1);
    const Vector2 off = curve.Evaluate(t[i]) - points[i];
    const double  slope = d1.squaredNorm() + off.dot(curve.Evaluate(t[i], 2));
    if (slope > 0.0)
    {
      t[i] -= std::clamp(off.dot(d1) / slope, -0.5, 0.5);
      t[i] -= m * std::floor(t[i] / m);
      t[i] = t[i] < m ? t[i] : 0.0;
    }
    largest = std::max(largest, (curve.Evaluate(t[i]) - points[i]).norm());
  }
  return largest;
}
} // namespace

ClosedBSpline::ClosedBSpline(std::vector<Vector2> controlPoints)
  : m_Control(std::move(controlPoints))
{}

Vector2
ClosedBSpline::Evaluate(double t, int order) const
{
  const auto   m = static_cast<double>(m_Control.size());
  const double wrapped = t - m * std::floor(t / m);
  const auto   span = std::min(static_cast<std::size_t>(wrapped), m_Control.size() - 1);
  const auto   basis = BasisOf(wrapped - static_cast<double>(span), order);
  Vector2      value = Vector2::Zero();
  for (std::size_t a = 0; a < 4; ++a)
  {
    value += basis[a] * m_Control[(span + a) % m_Control.size()];
  }
  return value;
}

double
ClosedBSpline::Curvature(double t) const
{
  const Vector2 d1 = this->Evaluate(t, 1);
  const Vector2 d2 = this->Evaluate(t, 2);
  const double  speed = std::max(d1.norm(), 1e-12);
  return (d1.x() * d2.y() - d1.y() * d2.x()) / (speed * speed * speed);
}

BSplineFit
FitClosedBSpline(const Polygon & points, std::size_t numberOfControlPoints)
{
  const std::size_t         m = numberOfControlPoints;
  const std::vector<double> length = ArcLength(points);
  std::vector<double>       t(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    t[i] = std::min(length[i] / length.back() * static_cast<double>(m), std::nextafter(static_cast<double>(m), 0.0));
  }
  BSplineFit fit;
  for (int pass = 0; pass < 3; ++pass)
  {
    fit.curve = SolveControlPoints(points, t, m);
    fit.deviation = CorrectParameters(fit.curve, points, t);
  }
  return fit;
}

BSplineFit
FitClosedBSplineWithin(const Polygon & points, double tolerance)
{
  const std::size_t most = std::max<std::size_t>(4, points.size() / 2);
  std::size_t       tooFew = 3;
  std::size_t       m = std::min<std::size_t>(6, most);
  BSplineFit        fit = FitClosedBSpline(points, m);
  while (fit.deviation > tolerance && m < most)
  {
    tooFew = m;
    m = std::min(most, m + (m + 1) / 2);
    fit = FitClosedBSpline(points, m);
  }
  while (m - tooFew > 1 + m / 6 && m > 6)
  {
    const std::size_t middle = (m + tooFew) / 2;
    BSplineFit        smaller = FitClosedBSpline(points, middle);
    if (smaller.deviation <= tolerance)
    {
      m = middle;
      fit = std::move(smaller);
    }
    else
    {
      tooFew = middle;
    }
  }
  return fit;
}
} // namespace bone
