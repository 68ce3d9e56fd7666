/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "bonePrimitiveFit.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

namespace bone
{
namespace
{
constexpr int    MostReweightings = 100;
constexpr double TukeyReach = 4.685;    // standard deviations
constexpr double LeastDeviation = 0.01; // mm
constexpr double StillDistance = 1e-9;  // mm
constexpr double FlatShare = 1e-8;      // of the largest variance: less is none

using Residuals = std::vector<double>;

void
RequirePoints(const std::vector<Vector3> & points, const std::vector<double> & weights, int least, const char * shape)
{
  if (points.size() != weights.size())
  {
    throw std::invalid_argument("A fit needs as many weights as points.");
  }
  const auto used = std::count_if(weights.begin(), weights.end(), [](double w) { return w > 0.0; });
  if (used < least)
  {
    throw std::invalid_argument("A " + std::string(shape) + " needs " + std::to_string(least) +
                                " points, but there are " + std::to_string(used) + ".");
  }
}

/** Median of |residual| by weight. */
double
MedianResidual(const Residuals & residuals, const std::vector<double> & weights)
{
  std::vector<std::size_t> order(residuals.size());
  std::iota(order.begin(), order.end(), std::size_t{ 0 });
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::abs(residuals[a]) < std::abs(residuals[b]);
  });
  const double half = 0.5 * std::accumulate(weights.begin(), weights.end(), 0.0);
  double       sum = 0.0;
  for (const std::size_t i : order)
  {
    sum += weights[i];
    if (sum >= half)
    {
      return std::abs(residuals[i]);
    }
  }
  return 0.0;
}

/** Weights times Tukey's biweight of the residuals. */
std::vector<double>
RobustWeights(const Residuals & residuals, const std::vector<double> & weights)
{
  const double        reach = TukeyReach * std::max(1.4826 * MedianResidual(residuals, weights), LeastDeviation);
  std::vector<double> robust(weights);
  for (std::size_t i = 0; i < robust.size(); ++i)
  {
    const double share = residuals[i] / reach;
    robust[i] *= std::abs(share) < 1.0 ? std::pow(1.0 - share * share, 2) : 0.0;
  }
  return robust;
}

double
RootMeanSquare(const Residuals & residuals, const std::vector<double> & weights)
{
  double sum = 0.0, weight = 0.0;
  for (std::size_t i = 0; i < residuals.size(); ++i)
  {
    sum += weights[i] * residuals[i] * residuals[i];
    weight += weights[i];
  }
  return weight > 0.0 ? std::sqrt(sum / weight) : 0.0;
}

Vector3
WeightedMean(const std::vector<Vector3> & points, const std::vector<double> & weights)
{
  Vector3 sum = Vector3::Zero();
  double  weight = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    sum += weights[i] * points[i];
    weight += weights[i];
  }
  return sum / weight;
}

/** Mean and principal axes of weighted points, variances ascending. */
struct PrincipalAxes
{
  Vector3         mean;
  Vector3         variances;
  Eigen::Matrix3d axes;

  PrincipalAxes(const std::vector<Vector3> & points, const std::vector<double> & weights)
    : mean(WeightedMean(points, weights))
  {
    Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
    for (std::size_t i = 0; i < points.size(); ++i)
    {
      moments += weights[i] * (points[i] - mean) * (points[i] - mean).transpose();
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(moments);
    variances = solver.eigenvalues();
    axes = solver.eigenvectors();
  }
};

/** Least squares of |x|^2 - 2 c.x - k, about the points' mean. */
FittedSphere
AlgebraicSphere(const std::vector<Vector3> & points, const std::vector<double> & weights)
{
  const PrincipalAxes frame(points, weights);
  if (!(frame.variances[0] > FlatShare * frame.variances[2]))
  {
    throw std::invalid_argument("No sphere fits points that lie in one plane.");
  }
  Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
  Eigen::Vector4d right = Eigen::Vector4d::Zero();
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    const Vector3         x = points[i] - frame.mean;
    const Eigen::Vector4d row(2.0 * x.x(), 2.0 * x.y(), 2.0 * x.z(), 1.0);
    normal += weights[i] * row * row.transpose();
    right += weights[i] * x.squaredNorm() * row;
  }
  const Eigen::Vector4d solution = normal.ldlt().solve(right);
  const Vector3         centre = solution.head<3>();
  return { frame.mean + centre, std::sqrt(std::max(solution[3] + centre.squaredNorm(), 0.0)), 0.0 };
}

/** One Gauss-Newton step of the distances; returns how far the sphere moves, mm. */
double
ImproveSphere(const std::vector<Vector3> & points, const std::vector<double> & weights, FittedSphere & sphere)
{
  Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
  Eigen::Vector4d right = Eigen::Vector4d::Zero();
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    const Vector3 x = points[i] - sphere.centre;
    const double  distance = x.norm();
    if (distance > 0.0)
    {
      Eigen::Vector4d row;
      row << x / distance, 1.0;
      normal += weights[i] * row * row.transpose();
      right += weights[i] * (distance - sphere.radius) * row;
    }
  }
  const Eigen::Vector4d step = normal.ldlt().solve(right);
  sphere.centre += step.head<3>();
  sphere.radius += step[3];
  return step.norm();
}
} // namespace

FittedSphere
FitSphere(const std::vector<Vector3> & points, const std::vector<double> & weights)
{
  RequirePoints(points, weights, 4, "sphere");
  FittedSphere        sphere = AlgebraicSphere(points, weights);
  std::vector<double> robust = weights;
  Residuals           residuals(points.size());
  double              step = 1.0;
  for (int i = 0; i < MostReweightings && step > StillDistance; ++i)
  {
    for (std::size_t p = 0; p < points.size(); ++p)
    {
      residuals[p] = (points[p] - sphere.centre).norm() - sphere.radius;
    }
    robust = RobustWeights(residuals, weights);
    step = ImproveSphere(points, robust, sphere);
    if (!std::isfinite(step) || !(sphere.radius > 0.0))
    {
      throw std::invalid_argument("No sphere fits the points.");
    }
  }
  sphere.deviation = RootMeanSquare(residuals, robust);
  return sphere;
}

FittedLine
FitLine(const std::vector<Vector3> & points, const std::vector<double> & weights)
{
  RequirePoints(points, weights, 2, "line");
  const PrincipalAxes frame(points, weights);
  if (!(frame.variances[1] < (1.0 - FlatShare) * frame.variances[2]))
  {
    throw std::invalid_argument("No line fits points that spread alike in two directions.");
  }
  FittedLine line{ frame.mean, frame.axes.col(2), 0.0 };
  Residuals  residuals;
  for (const Vector3 & p : points)
  {
    residuals.push_back(line.Distance(p));
  }
  line.deviation = RootMeanSquare(residuals, weights);
  return line;
}

FittedPlane
FitPlane(const std::vector<Vector3> & points, const std::vector<double> & weights)
{
  RequirePoints(points, weights, 3, "plane");
  FittedPlane         plane;
  std::vector<double> robust = weights;
  Residuals           residuals(points.size());
  double              step = 1.0;
  for (int i = 0; i < MostReweightings && step > StillDistance; ++i)
  {
    const PrincipalAxes frame(points, robust);
    if (!(frame.variances[1] > FlatShare * frame.variances[2] &&
          frame.variances[0] < (1.0 - FlatShare) * frame.variances[1]))
    {
      throw std::invalid_argument("No one plane fits points that lie on a line or spread alike in all directions.");
    }
    const Vector3 normal = (frame.axes.col(0).dot(plane.normal) < 0.0 ? -1.0 : 1.0) * frame.axes.col(0);
    step = (normal - plane.normal).norm() * std::sqrt(frame.variances[2]) + (frame.mean - plane.point).norm();
    plane = { frame.mean, normal, 0.0 };
    for (std::size_t p = 0; p < points.size(); ++p)
    {
      residuals[p] = plane.normal.dot(points[p] - plane.point);
    }
    plane.deviation = RootMeanSquare(residuals, robust);
    robust = RobustWeights(residuals, weights);
  }
  return plane;
}
} // namespace bone
