/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneFemurPhantom.h"

#include "bonePhantomShapes.h"

#include <itkMacro.h>

#include <cmath>
#include <limits>

namespace bone
{
using namespace shapes;

namespace
{
/** Anteroposterior over mediolateral diameter of the shaft. */
constexpr double ShaftAspect = 1.06;
/** Half a wave of the shaft's forward bow, mm. */
constexpr double BowLength = 190.0;
/** Heights (mm) between which the shaft narrows. */
constexpr double FlareTop = -30.0;
constexpr double FlareBottom = -115.0;
/** Radius of the flare at its top over the shaft's radius. */
constexpr double Flare = 1.35;

/** The ball of a trochanter or of the neck's foot, scaled with the subject. */
Ball
Scaled(double x, double y, double z, double radius, double scale)
{
  return { scale * Vector3(x, y, z), scale * radius };
}

RoundCone
GreaterTrochanter(double s)
{
  return { Scaled(-7, 4, -22, 19, s), Scaled(-19, 9, 18, 9, s) };
}

RoundCone
LesserTrochanter(double s)
{
  return { Scaled(6, 7, -44, 10, s), Scaled(14, 15, -41, 5.5, s) };
}

template <typename T>
T
BowAt(const T & z, double bow)
{
  return Square(Sin(z * T(M_PI_2 / BowLength))) * T(-bow);
}

/** 0 at the top of the flare, 1 in the shaft. */
template <typename T>
T
ShaftBlend(const T & z)
{
  return SmoothStep((z - T(FlareTop)) / (FlareBottom - FlareTop));
}

double
ShaftRadius(const FemurParameters & p, double z)
{
  return p.shaftRadius * (Flare + (1.0 - Flare) * ShaftBlend(z));
}
} // namespace

FemurParameters
FemurParameters::ForSubject(std::uint64_t seed)
{
  SubjectDraws    draws(seed);
  FemurParameters p;
  const auto      vary = [&draws](double & value, double range) { value += range * draws.Next(); };
  vary(p.scale, 0.06);
  vary(p.headRadius, 2.0);
  vary(p.neckRadius, 1.2);
  vary(p.neckLength, 4.0);
  vary(p.neckShaftAngle, 7.0);
  vary(p.anteversion, 10.0);
  vary(p.shaftRadius, 1.2);
  vary(p.bow, 4.0);
  vary(p.shaftCortex, 0.8);
  vary(p.headCortex, 0.15);
  vary(p.calcarCortex, 0.5);
  vary(p.shaftDensity, 80.0);
  vary(p.headDensity, 70.0);
  vary(p.trabecularDensity, 35.0);
  vary(p.compressiveDensity, 40.0);
  vary(p.trabecularHeadDensity, 50.0);
  return p;
}

FemurPhantom::FemurPhantom(const FemurParameters & parameters)
  : m_P(parameters)
{
  for (const double size : { m_P.scale,
                             m_P.headRadius,
                             m_P.neckRadius,
                             m_P.neckLength,
                             m_P.shaftRadius,
                             m_P.length,
                             m_P.headCortex,
                             m_P.shaftCortex,
                             m_P.trabecularDepth,
                             m_P.cavityRadius })
  {
    if (!(size > 0.0 && size < 1000.0))
    {
      itkGenericExceptionMacro("FemurPhantom: every size must be positive and below 1000 mm, but one is " << size
                                                                                                          << ".");
    }
  }
  if (!(m_P.neckRadius < m_P.headRadius))
  {
    itkGenericExceptionMacro("FemurPhantom: the neck (radius "
                             << m_P.neckRadius << " mm) must be thinner than the head (" << m_P.headRadius << " mm).");
  }
  if (!(m_P.neckShaftAngle >= 100.0 && m_P.neckShaftAngle <= 150.0))
  {
    itkGenericExceptionMacro("FemurPhantom: the neck-shaft angle must lie in 100..150 degrees, but is "
                             << m_P.neckShaftAngle << ".");
  }
  if (!(m_P.shaftCortex + m_P.trabecularDepth + 2.0 < m_P.shaftRadius && m_P.headCortex <= m_P.shaftCortex &&
        m_P.shaftCortex <= 8.0 && m_P.calcarCortex >= 0.0 && m_P.calcarCortex <= 4.0))
  {
    itkGenericExceptionMacro("FemurPhantom: a shaft of radius "
                             << m_P.shaftRadius << " mm cannot hold a cortex of " << m_P.shaftCortex
                             << " mm (head: " << m_P.headCortex << " mm, calcar: " << m_P.calcarCortex
                             << " mm more) and trabecular bone of " << m_P.trabecularDepth << " mm around a cavity.");
  }
  const double lean = (180.0 - m_P.neckShaftAngle) * M_PI / 180.0;
  const double turn = m_P.anteversion * M_PI / 180.0;
  m_HeadCentre =
    m_P.neckLength * Vector3(std::sin(lean) * std::cos(turn), -std::sin(lean) * std::sin(turn), std::cos(lean));
  m_Calcar = m_P.scale * Vector3(16.0, -1.0, -24.0);
}

Vector3
FemurPhantom::GetShaftCentre(double z) const
{
  return { 0.0, BowAt(z, m_P.bow), z };
}

template <typename T>
std::array<T, 3>
FemurPhantom::Evaluate(const Vector3 & x) const
{
  const auto p = Variable(x, T());
  const T    blend = ShaftBlend(p.z);
  const T    radius = (T(Flare) + blend * T(1.0 - Flare)) * T(m_P.shaftRadius);
  const T    forward = p.y - BowAt(p.z, m_P.bow);
  const T    above = Max(p.z - T(-12.0), T(0.0));
  const T    shaft = Sqrt(Square(p.x) + Square(forward / ShaftAspect) + Square(above)) - radius;

  // The linea aspera is a thin sweep along the back of the shaft that ends below the lesser trochanter.
  const T ridgeAbove = Max(p.z - T(-70.0), T(0.0));
  const T ridge = Sqrt(Square(p.x) + Square(forward - radius * T(0.6)) + Square(ridgeAbove)) - radius * T(0.5);

  const RoundCone neck{ Scaled(0, 0, -8, 17.5, m_P.scale), { 0.85 * m_HeadCentre, m_P.neckRadius } };
  T               bone = SmoothMin(shaft, ridge, 3.0);
  bone = SmoothMin(bone, LesserTrochanter(m_P.scale)(p), 8.0);
  bone = SmoothMin(bone, neck(p), 12.0);
  bone = SmoothMin(bone, GreaterTrochanter(m_P.scale)(p), 10.0);
  bone = SmoothMin(bone, Ball{ m_HeadCentre, m_P.headRadius }(p), 5.0);

  const T thickness =
    T(m_P.headCortex) + blend * T(m_P.shaftCortex - m_P.headCortex) + Bump(p, m_Calcar, 12.0) * T(m_P.calcarCortex);
  const T endosteum = bone + thickness;

  const T dome = Max(p.z - T(-80.0), T(0.0)) * T(0.45);
  const T cavity = Sqrt(Square(p.x) + Square(forward) + Square(dome)) - T(m_P.cavityRadius);
  return { { bone, endosteum, SmoothMax(endosteum + T(m_P.trabecularDepth), cavity, 3.0) } };
}

PhantomModel::Levels
FemurPhantom::EvaluateLevels(const Vector3 & x) const
{
  return this->Evaluate<double>(x);
}

PhantomModel::Levels
FemurPhantom::EvaluateLevels(const Vector3 & x, Gradients & gradients) const
{
  const auto duals = this->Evaluate<Dual>(x);
  Levels     levels;
  for (int i = 0; i < MaximumSurfaces; ++i)
  {
    levels[i] = duals[i].v;
    gradients[i] = Vector3(duals[i].d[0], duals[i].d[1], duals[i].d[2]);
  }
  return levels;
}

double
FemurPhantom::GetLipschitzBound(int surface) const
{
  // The bow and the flare of the shaft steepen its function, the endosteal depth adds its own slope.
  const double bow = m_P.bow * M_PI_2 / BowLength;
  const double flare = 1.5 * 1.875 * (Flare - 1.0) * m_P.shaftRadius / (FlareTop - FlareBottom);
  const double depth =
    1.875 * (m_P.shaftCortex - m_P.headCortex) / (FlareTop - FlareBottom) + 0.61 * m_P.calcarCortex / 12.0;
  return std::hypot(1.0, bow) + flare + (surface == Periosteal ? 0.0 : depth);
}

PhantomModel::Materials
FemurPhantom::EvaluateMaterials(const Vector3 & x, const Levels &) const
{
  const double  shaft = ShaftBlend(x.z());
  const double  wave = std::cos(x.z() / 35.0);
  const Vector3 crown = m_HeadCentre + 0.5 * m_P.headRadius * Vector3(0.3, 0.0, 0.95);
  const double  compressive = Gaussian(SegmentDistance(x, crown, m_Calcar) / 6.5);
  const double  tensile = Gaussian(SegmentDistance(x, m_P.scale * Vector3(-24.0, 5.0, -18.0), m_HeadCentre) / 6.5);
  return { { m_P.softTissueDensity,
             m_P.headDensity + (m_P.shaftDensity - m_P.headDensity) * shaft + 40.0 * shaft * wave,
             m_P.trabecularDensity * (1.0 - 0.3 * shaft) +
               m_P.trabecularHeadDensity * Gaussian((x - m_HeadCentre).norm() / 17.0) +
               m_P.compressiveDensity * (compressive + 0.5 * tensile),
             m_P.marrowDensity + 15.0 * wave } };
}

PhantomModel::Interval
FemurPhantom::GetExtent(const Vector3 & direction) const
{
  constexpr double bulge = 1.5;
  Interval         interval{ std::numeric_limits<double>::max(), std::numeric_limits<double>::lowest() };
  for (const RoundCone & cone : { GreaterTrochanter(m_P.scale), LesserTrochanter(m_P.scale) })
  {
    Extend(interval, cone.a, direction);
    Extend(interval, cone.b, direction);
  }
  Extend(interval, { m_HeadCentre, m_P.headRadius }, direction);
  const double across = std::sqrt(std::max(0.0, 1.0 - direction.z() * direction.z()));
  for (double z = -m_P.length; z < 0.0; z += 5.0)
  {
    // A horizontal disc of the shaft, wide enough for the linea aspera.
    Extend(interval, { this->GetShaftCentre(z), 1.12 * ShaftRadius(m_P, z) * across }, direction);
  }
  // Nothing bulges at the cut.
  const bool down = std::abs(direction.z()) > 0.999;
  interval.lower -= down && direction.z() > 0.0 ? 0.0 : bulge;
  interval.upper += down && direction.z() < 0.0 ? 0.0 : bulge;
  return interval;
}
} // namespace bone
