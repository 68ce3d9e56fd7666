/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSurfacePhantom.h"

#include "bonePhantomShapes.h"
#include "boneSymmetricEigen.h"

#include <itkMacro.h>

#include <cmath>
#include <limits>

namespace bone
{
using namespace shapes;

namespace
{
/** Width of the blend that rounds the cavity's ends, mm. */
constexpr double CavityBlend = 10.0;
/** Width of the denser rim of trabecular bone, mm. */
constexpr double RimWidth = 4.0;
} // namespace

SurfacePhantomParameters
SurfacePhantomParameters::ForSubject(std::uint64_t seed)
{
  SubjectDraws             draws(seed);
  SurfacePhantomParameters p;
  const auto               vary = [&draws](double & value, double range) { value += range * draws.Next(); };
  vary(p.shaftCortex, 0.9);
  vary(p.endCortex, 0.25);
  vary(p.shaftDensity, 90.0);
  vary(p.endDensity, 90.0);
  vary(p.trabecularDensity, 50.0);
  vary(p.trabecularEndDensity, 70.0);
  return p;
}

SurfacePhantom::SurfacePhantom(const std::vector<Vector3> &                    points,
                               const std::vector<TriangleDistance::Triangle> & triangles,
                               const SurfacePhantomParameters &                parameters)
  : m_P(parameters)
  , m_Surface(points, triangles)
{
  this->Verify();
  this->FindAxis();
}

void
SurfacePhantom::Verify() const
{
  if (!(m_P.endCortex > 0.0 && m_P.shaftCortex > 0.0 && m_P.trabecularDepth > 0.0 && m_P.endCortex < 100.0 &&
        m_P.shaftCortex < 100.0 && m_P.trabecularDepth < 100.0))
  {
    itkGenericExceptionMacro(
      "SurfacePhantom: cortical and trabecular thickness must be positive and below 100 mm, but are "
      << m_P.endCortex << " (ends), " << m_P.shaftCortex << " (shaft) and " << m_P.trabecularDepth << ".");
  }
  if (!(m_P.transition > 0.0 && m_P.transition <= 1.0 && m_P.shaftStart < m_P.shaftEnd &&
        m_P.cavityStart < m_P.cavityEnd))
  {
    itkGenericExceptionMacro("SurfacePhantom: the transition must lie in 0..1 and shaft and cavity must start before "
                             "they end, but are "
                             << m_P.transition << ", " << m_P.shaftStart << ".." << m_P.shaftEnd << " and "
                             << m_P.cavityStart << ".." << m_P.cavityEnd << ".");
  }
}

void
SurfacePhantom::FindAxis()
{
  const auto &    points = m_Surface.GetPoints();
  double          total = 0.0;
  Vector3         mean = Vector3::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
  for (const auto & t : m_Surface.GetTriangles())
  {
    const double  area = 0.5 * (points[t[1]] - points[t[0]]).cross(points[t[2]] - points[t[0]]).norm();
    const Vector3 middle = (points[t[0]] + points[t[1]] + points[t[2]]) / 3.0 - points[0];
    total += area;
    mean += area * middle;
    second += area * middle * middle.transpose();
  }
  mean /= total;
  Vector3 direction = EigenOf<3>(second / total - mean * mean.transpose()).vectors.col(2);
  int     largest = 0;
  direction.cwiseAbs().maxCoeff(&largest);
  direction *= direction[largest] < 0.0 ? -1.0 : 1.0;

  const Interval extent = this->GetExtent(direction);
  const Vector3  centre = points[0] + mean;
  m_Axis = { centre + (extent.lower - centre.dot(direction)) * direction, direction };
  m_Length = extent.upper - extent.lower;
}

std::pair<double, double>
SurfacePhantom::Shaft(const Vector3 & x) const
{
  const double length = m_P.transition * m_Length;
  const double along = (x - m_Axis.point).dot(m_Axis.direction);
  const Dual   f(along, { { 1.0, 0.0, 0.0 } });
  const Dual   rise = SmoothStep((f - Dual(m_P.shaftStart * m_Length)) / length);
  const Dual   fall = SmoothStep((Dual(m_P.shaftEnd * m_Length) - f) / length);
  const Dual   s = rise * fall;
  return { s.v, s.d[0] };
}

PhantomModel::Levels
SurfacePhantom::EvaluateLevels(const Vector3 & x) const
{
  Gradients gradients;
  return this->EvaluateLevels(x, gradients);
}

PhantomModel::Levels
SurfacePhantom::EvaluateLevels(const Vector3 & x, Gradients & gradients) const
{
  const TriangleDistance::Nearest nearest = m_Surface.FindNearest(x);
  const auto [shaft, slope] = this->Shaft(x);
  const double  cortex = m_P.shaftCortex - m_P.endCortex;
  const double  endosteum = nearest.distance + m_P.endCortex + cortex * shaft;
  const Vector3 inner = nearest.gradient + cortex * slope * m_Axis.direction;
  gradients = { { nearest.gradient, inner, Vector3::Zero() } };
  Levels levels{ { nearest.distance, endosteum, std::numeric_limits<double>::infinity() } };
  if (m_P.medullaryCavity)
  {
    const double along = (x - m_Axis.point).dot(m_Axis.direction);
    const double middle = 0.5 * (m_P.cavityStart + m_P.cavityEnd) * m_Length;
    const double half = 0.5 * (m_P.cavityEnd - m_P.cavityStart) * m_Length;
    const double side = along < middle ? -1.0 : 1.0;
    const Dual   depth(endosteum + m_P.trabecularDepth, { { 1.0, 0.0, 0.0 } });
    const Dual   ends(side * (along - middle) - half, { { 0.0, side, 0.0 } });
    const Dual   cavity = SmoothMax(depth, ends, CavityBlend);
    levels[Cavity] = cavity.v;
    gradients[Cavity] = cavity.d[0] * inner + cavity.d[1] * m_Axis.direction;
  }
  return levels;
}

double
SurfacePhantom::GetLipschitzBound(int surface) const
{
  const double slope = 1.875 * std::abs(m_P.shaftCortex - m_P.endCortex) / (m_P.transition * m_Length);
  return surface == Periosteal ? 1.0 : 1.0 + slope;
}

PhantomModel::Materials
SurfacePhantom::EvaluateMaterials(const Vector3 & x, const Levels & levels) const
{
  const double shaft = this->Shaft(x).first;
  return { { m_P.softTissueDensity,
             m_P.endDensity + (m_P.shaftDensity - m_P.endDensity) * shaft,
             m_P.trabecularDensity + m_P.trabecularEndDensity * (1.0 - shaft) +
               m_P.trabecularRimDensity * Gaussian(levels[Periosteal] / RimWidth),
             m_P.marrowDensity } };
}

PhantomModel::Interval
SurfacePhantom::GetExtent(const Vector3 & direction) const
{
  Interval interval{ std::numeric_limits<double>::max(), std::numeric_limits<double>::lowest() };
  for (const auto & t : m_Surface.GetTriangles())
  {
    for (const IdType p : t)
    {
      Extend(interval, { m_Surface.GetPoints()[p], 0.0 }, direction);
    }
  }
  return interval;
}

Vector3
SurfacePhantom::ClosestPoint(int surface, const Vector3 & x) const
{
  return surface == Periosteal ? m_Surface.FindNearest(x).point : PhantomModel::ClosestPoint(surface, x);
}
} // namespace bone
