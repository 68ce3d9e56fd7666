/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "bonePhantomModel.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>

namespace bone
{
namespace
{
/** Integral of the standard normal density up to t. */
double
NormalCdf(double t)
{
  return 0.5 * std::erfc(-t * M_SQRT1_2);
}

/** Gaussian measure (standard deviation 1) of { s : value + slope s + curvature s^2 / 2 < 0 }. */
double
MeasureBelowZero(double value, double slope, double curvature)
{
  const double planar = std::abs(slope) > 1e-12 ? NormalCdf(-value / std::abs(slope)) : (value < 0.0 ? 1.0 : 0.0);
  if (std::abs(curvature) < 1e-9 * std::abs(slope))
  {
    return planar;
  }
  const double discriminant = slope * slope - 2.0 * curvature * value;
  if (!(discriminant > 0.0))
  {
    return curvature > 0.0 ? 0.0 : 1.0;
  }
  // Stable roots of curvature/2 s^2 + slope s + value.
  const double q = -(slope + std::copysign(std::sqrt(discriminant), slope));
  const double a = q / curvature;
  const double b = q != 0.0 ? 2.0 * value / q : -a;
  const double between = NormalCdf(std::max(a, b)) - NormalCdf(std::min(a, b));
  return curvature > 0.0 ? between : 1.0 - between;
}

/** Gaussian measure (standard deviation 1) of the places t in -3..3 where `profile` (13 values, half a unit apart) runs
 * below zero, straight between the values and constant beyond. */
double
MeasureBelowZero(const std::array<double, 13> & profile)
{
  constexpr double step = 0.5;
  constexpr double start = -3.0;
  double           measure = profile.front() < 0.0 ? NormalCdf(start) : 0.0;
  for (std::size_t i = 0; i + 1 < profile.size(); ++i)
  {
    const double a = profile[i];
    const double b = profile[i + 1];
    const double left = start + step * static_cast<double>(i);
    const double crossing = (a < 0.0) != (b < 0.0) ? left + step * a / (a - b) : left + step;
    const double from = a < 0.0 ? left : crossing;
    const double to = a < 0.0 ? crossing : left + step;
    if (a < 0.0 || b < 0.0)
    {
      measure += NormalCdf(to) - NormalCdf(from);
    }
  }
  return measure + (profile.back() < 0.0 ? NormalCdf(start) : 0.0);
}
} // namespace

int
PhantomModel::RegionOf(const Levels & levels)
{
  if (!(levels[Periosteal] < 0.0))
  {
    return Region::Outside;
  }
  if (!(levels[Endosteal] < 0.0))
  {
    return Region::Cortical;
  }
  return levels[Cavity] < 0.0 ? Region::Medullary : Region::Trabecular;
}

int
PhantomModel::Region(const Vector3 & x) const
{
  return RegionOf(this->EvaluateLevels(x));
}

double
PhantomModel::Density(const Vector3 & x) const
{
  const Levels levels = this->EvaluateLevels(x);
  return this->EvaluateMaterials(x, levels)[RegionOf(levels)];
}

double
PhantomModel::BlurredDensity(const Vector3 & x, const Eigen::Matrix3d & axes, const Vector3 & sigma) const
{
  // x + spread * y has the point spread's distribution where y has the standard normal one.
  const Eigen::Matrix3d spread = axes * sigma.asDiagonal();
  Gradients             gradients;
  const Levels          levels = this->EvaluateLevels(x, gradients);
  const Materials       materials = this->EvaluateMaterials(x, levels);
  double                density = materials[0];
  for (int i = 0; i < this->GetNumberOfSurfaces(); ++i)
  {
    double        inside = levels[i] < 0.0 ? 1.0 : 0.0;
    const Vector3 gradient = spread.transpose() * gradients[i];
    const double  width = gradient.norm() / std::max(gradients[i].norm(), 1e-300);
    if (gradient.norm() > 1e-9 && std::abs(levels[i]) < GaussianTail * width * this->GetLipschitzBound(i))
    {
      inside = this->MeasureInside(i, x, levels[i], spread, gradient.normalized());
    }
    density += (materials[i + 1] - materials[i]) * inside;
  }
  return density;
}

double
PhantomModel::MeasureInside(int                     surface,
                            const Vector3 &         x,
                            double                  level,
                            const Eigen::Matrix3d & spread,
                            const Vector3 &         normal) const
{
  const auto at = [&](const Vector3 & y) { return this->EvaluateLevels(x + spread * y)[surface]; };

  // Mean of the level over the tangent plane less the level at its origin: three-point Gauss-Hermite quadrature.
  const Vector3 first = normal.unitOrthogonal();
  const Vector3 second = normal.cross(first);
  double        curve = -4.0 * level;
  for (const Vector3 & tangent : { first, second })
  {
    curve += at(std::sqrt(3.0) * tangent) + at(-std::sqrt(3.0) * tangent);
  }
  curve /= 6.0;

  const double reach = 2.0;
  const double above = at(reach * normal);
  const double below = at(-reach * normal);
  const double bend = above + below - 2.0 * level;
  if (std::abs(bend) < 0.05 * (above - below))
  {
    return MeasureBelowZero(level + curve, (above - below) / (2.0 * reach), bend / (reach * reach));
  }
  // The middle of a thin layer or a strong blend: step along the normal.
  std::array<double, 13> profile;
  for (int i = 0; i < 13; ++i)
  {
    profile[i] = curve + (i == 2 ? below : i == 6 ? level : i == 10 ? above : at(0.5 * (i - 6) * normal));
  }
  return MeasureBelowZero(profile);
}

Vector3
PhantomModel::ClosestPoint(int surface, const Vector3 & x) const
{
  Gradients  gradients;
  const auto step = [&](const Vector3 & p) -> Vector3 {
    const double value = this->EvaluateLevels(p, gradients)[surface];
    if (gradients[surface].norm() < 1e-6)
    {
      // Exactly in the middle of a plate: any side will do.
      return 1e-3 * Vector3(0.36, 0.48, 0.8);
    }
    return value / gradients[surface].squaredNorm() * gradients[surface];
  };
  const auto land = [&](Vector3 p) {
    for (int i = 0; i < 30; ++i)
    {
      const Vector3 move = step(p);
      p -= move;
      if (move.squaredNorm() < 1e-18)
      {
        break;
      }
    }
    return p;
  };
  if (surface >= this->GetNumberOfSurfaces())
  {
    return x;
  }
  Vector3 foot = land(x);
  double  best = (x - foot).norm();
  double  damping = 1.0;
  for (int i = 0; i < 200 && damping > 1e-6; ++i)
  {
    step(foot);
    const Vector3 normal = gradients[surface].normalized();
    const Vector3 offset = x - foot;
    const Vector3 tangential = offset - offset.dot(normal) * normal;
    if (tangential.norm() < 1e-8)
    {
      break;
    }
    const Vector3 candidate = land(foot + damping * tangential);
    const double  distance = (x - candidate).norm();
    if (distance < best)
    {
      foot = candidate;
      best = distance;
      damping = std::min(1.0, 1.5 * damping);
    }
    else
    {
      damping *= 0.5;
    }
  }
  return foot;
}

double
PhantomModel::Distance(int surface, const Vector3 & x) const
{
  const double value = this->EvaluateLevels(x)[surface];
  if (surface >= this->GetNumberOfSurfaces())
  {
    return std::numeric_limits<double>::infinity();
  }
  return std::copysign((x - this->ClosestPoint(surface, x)).norm(), value);
}

double
PhantomModel::CorticalThickness(const Vector3 & x) const
{
  const Vector3 foot = this->ClosestPoint(Periosteal, x);
  Gradients     gradients;
  this->EvaluateLevels(foot, gradients);
  const Vector3 inward = -gradients[Periosteal].normalized();
  const auto    isCortical = [&](double depth) {
    const Levels levels = this->EvaluateLevels(foot + depth * inward);
    return levels[Periosteal] < 0.0 && levels[Endosteal] >= 0.0;
  };
  const double step = 0.05;
  const double most = 500.0;
  double       inside = step;
  while (inside < most && isCortical(inside + step))
  {
    inside += step;
  }
  double outside = inside + step;
  while (outside - inside > 1e-9)
  {
    const double middle = 0.5 * (inside + outside);
    (isCortical(middle) ? inside : outside) = middle;
  }
  return outside;
}

Vector3
PhantomModel::GetLowerCorner() const
{
  return { this->GetExtent(Vector3::UnitX()).lower,
           this->GetExtent(Vector3::UnitY()).lower,
           this->GetExtent(Vector3::UnitZ()).lower };
}

Vector3
PhantomModel::GetUpperCorner() const
{
  return { this->GetExtent(Vector3::UnitX()).upper,
           this->GetExtent(Vector3::UnitY()).upper,
           this->GetExtent(Vector3::UnitZ()).upper };
}
} // namespace bone
