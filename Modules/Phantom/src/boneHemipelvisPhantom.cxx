/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneHemipelvisPhantom.h"

#include "bonePhantomShapes.h"

#include <itkMacro.h>

#include <cmath>
#include <limits>

namespace bone
{
using namespace shapes;

namespace
{
/** Half axes of the wing's outline, mm. */
constexpr double WingHalfWidth = 76.0;
constexpr double WingHalfHeight = 54.0;
/** The ball around the acetabulum is larger than the bowl, lies deeper, and ends at a plane face, mm. */
constexpr double CupWall = 7.5;
constexpr double CupShift = 4.0;
constexpr double FaceHeight = 3.0;

struct Link
{
  double    blend;
  RoundCone cone;
};

/** The links that join wing, acetabulum, ischium and pubis, in the order of their union. */
std::array<Link, 8>
Links(const HemipelvisParameters & p)
{
  const double s = p.scale;
  const double r = p.ramusRadius;
  const auto   ball = [s](double x, double y, double z, double radius) { return Ball{ s * Vector3(x, y, z), radius }; };
  return { {
    { 14.0, { ball(10, 8, 24, 15 * s), ball(26, 44, 50, 11 * s) } },        // arcuate line
    { 12.0, { ball(30, 52, 52, 11 * s), ball(42, 80, 70, 9 * s) } },        // sacroiliac part
    { 10.0, { ball(10, 16, -8, 15 * s), ball(18, 30, -60, 12.5 * s) } },    // ischium down to its tuberosity
    { 6.0, { ball(20, 26, -66, 1.25 * r), ball(46, -8, -70, 0.9 * r) } },   // ramus of the ischium
    { 6.0, { ball(46, -8, -70, 0.9 * r), ball(72, -40, -46, r) } },         // inferior ramus of the pubis
    { 8.0, { ball(74, -44, -22, 1.35 * r), ball(76, -44, -44, 1.1 * r) } }, // body of the pubis
    { 9.0, { ball(22, -16, -4, 12 * s), ball(72, -46, -18, 1.2 * r) } },    // superior ramus of the pubis
    { 10.0, { ball(-8, -18, 26, 10 * s), ball(-24, -34, 62, 6.5 * s) } },   // front edge of the wing
  } };
}
} // namespace

HemipelvisParameters
HemipelvisParameters::ForSubject(std::uint64_t seed)
{
  SubjectDraws         draws(seed);
  HemipelvisParameters p;
  const auto           vary = [&draws](double & value, double range) { value += range * draws.Next(); };
  vary(p.scale, 0.07);
  vary(p.cupRadius, 2.0);
  vary(p.inclination, 6.0);
  vary(p.cupAnteversion, 8.0);
  vary(p.wingThickness, 0.6);
  vary(p.crestThickness, 1.4);
  vary(p.wingRadius, 15.0);
  vary(p.ramusRadius, 0.8);
  vary(p.cortex, 0.15);
  vary(p.wingCortex, 0.2);
  vary(p.corticalDensity, 80.0);
  vary(p.trabecularDensity, 35.0);
  vary(p.trabecularCupDensity, 50.0);
  return p;
}

HemipelvisPhantom::HemipelvisPhantom(const HemipelvisParameters & parameters)
  : m_P(parameters)
{
  for (const double size :
       { m_P.scale, m_P.cupRadius, m_P.wingThickness, m_P.crestThickness, m_P.wingRadius, m_P.ramusRadius, m_P.cortex })
  {
    if (!(size > 0.0 && size < 1000.0))
    {
      itkGenericExceptionMacro("HemipelvisPhantom: every size must be positive and below 1000 mm, but one is " << size
                                                                                                               << ".");
    }
  }
  if (!(m_P.wingThickness <= m_P.crestThickness && m_P.wingCortex >= 0.0 && m_P.wingCortex <= 4.0))
  {
    itkGenericExceptionMacro("HemipelvisPhantom: the wing ("
                             << m_P.wingThickness << " mm) must not be thicker than its crest (" << m_P.crestThickness
                             << " mm), and its additional cortex (" << m_P.wingCortex << " mm) must lie in 0..4 mm.");
  }
  const double down = m_P.inclination * M_PI / 180.0;
  const double forward = m_P.cupAnteversion * M_PI / 180.0;
  m_Opening = Vector3(-std::cos(down) * std::cos(forward), -std::sin(forward), -std::sin(down) * std::cos(forward));
  m_WingCentre = m_P.scale * Vector3(-6.0, 22.0, 80.0);
  m_WingU = Vector3(75.0, 130.0, 0.0).normalized();
  m_WingNormal = m_WingU.cross(Vector3(-30.0, 5.0, 95.0)).normalized();
  m_WingV = m_WingNormal.cross(m_WingU);
}

template <typename T>
std::array<T, 2>
HemipelvisPhantom::Evaluate(const Vector3 & x) const
{
  const double s = m_P.scale;
  const auto   p = Variable(x, T());

  // The wing: a shell of a cylinder within an ellipse, its edge rounded, thicker toward the edge.
  const auto q = Minus(p, m_WingCentre);
  const T    u = Dot(q, m_WingU);
  const T    v = Dot(q, m_WingV);
  const T    w = Dot(q, m_WingNormal);
  const T    off = Sqrt(Square(u) + Square(w - T(m_P.wingRadius))) - T(m_P.wingRadius);
  const T    ellipse = Sqrt(Square(u / (s * WingHalfWidth)) + Square(v / (s * WingHalfHeight)));
  const T    edge = Max((ellipse - T(1.0)) * T(s * WingHalfHeight), T(0.0));
  const T    half = T(0.5 * m_P.wingThickness) +
                 SmoothStep((ellipse - T(0.15)) / 0.85) * T(0.5 * (m_P.crestThickness - m_P.wingThickness));
  T bone = Sqrt(Square(off) + Square(edge)) - half;

  for (const Link & link : Links(m_P))
  {
    bone = SmoothMin(bone, link.cone(p), link.blend);
  }

  // The acetabulum: a ball with a plane face, blended in, and the bowl cut out.
  const Vector3 centre = -CupShift * m_Opening;
  const T       face = Dot(p, m_Opening) - T(FaceHeight);
  bone = SmoothMin(bone, SmoothMax(Ball{ centre, m_P.cupRadius + CupWall }(p), face, 4.0), 8.0);
  const T bowl = Ball{ Vector3::Zero(), m_P.cupRadius }(p);
  bone = SmoothMax(bone, T(-bowl), 3.0);

  const T depth =
    T(m_P.cortex) + Bump(p, m_WingCentre, 26.0 * s) * T(m_P.wingCortex) + Exp(Square(bowl / 5.0) * T(-0.5)) * T(0.6);
  return { { bone, bone + depth } };
}

PhantomModel::Levels
HemipelvisPhantom::EvaluateLevels(const Vector3 & x) const
{
  const auto values = this->Evaluate<double>(x);
  return { { values[0], values[1], std::numeric_limits<double>::infinity() } };
}

PhantomModel::Levels
HemipelvisPhantom::EvaluateLevels(const Vector3 & x, Gradients & gradients) const
{
  const auto duals = this->Evaluate<Dual>(x);
  for (int i = 0; i < 2; ++i)
  {
    gradients[i] = Vector3(duals[i].d[0], duals[i].d[1], duals[i].d[2]);
  }
  gradients[Cavity].setZero();
  return { { duals[0].v, duals[1].v, std::numeric_limits<double>::infinity() } };
}

double
HemipelvisPhantom::GetLipschitzBound(int surface) const
{
  // Beyond its edge the bent wing has a slope of at most sqrt 2; its varying thickness and the depth add their own.
  const double wing = 0.5 * 1.875 * (m_P.crestThickness - m_P.wingThickness) / (0.85 * m_P.scale * WingHalfHeight);
  const double depth = 0.61 * (m_P.wingCortex / (26.0 * m_P.scale) + 0.6 / 5.0);
  return M_SQRT2 + wing + (surface == Periosteal ? 0.0 : depth);
}

PhantomModel::Materials
HemipelvisPhantom::EvaluateMaterials(const Vector3 & x, const Levels &) const
{
  const double wall = x.norm() - m_P.cupRadius;
  return { { m_P.softTissueDensity,
             m_P.corticalDensity + 60.0 * std::sin(x.z() / 30.0) * std::cos(x.y() / 45.0),
             m_P.trabecularDensity + m_P.trabecularCupDensity * Gaussian(wall / 14.0),
             0.0 } };
}

PhantomModel::Interval
HemipelvisPhantom::GetExtent(const Vector3 & direction) const
{
  constexpr double bulge = 1.5;
  Interval         interval{ std::numeric_limits<double>::max(), std::numeric_limits<double>::lowest() };
  for (const Link & link : Links(m_P))
  {
    Extend(interval, link.cone.a, direction);
    Extend(interval, link.cone.b, direction);
  }
  // The acetabulum's ball up to its face: the highest point of the ball, or of the rim where that is cut off.
  const double cut = FaceHeight + CupShift;
  const double outer = m_P.cupRadius + CupWall;
  for (const double sign : { -1.0, 1.0 })
  {
    const double  slope = sign * direction.dot(m_Opening);
    const bool    isCut = outer * slope > cut;
    const Vector3 centre = (isCut ? FaceHeight : -CupShift) * m_Opening;
    const double  reach = isCut ? std::sqrt((outer * outer - cut * cut) * (1.0 - slope * slope)) : outer;
    const double  shadow = centre.dot(direction) + sign * reach;
    interval.lower = std::min(interval.lower, shadow);
    interval.upper = std::max(interval.upper, shadow);
  }
  // The edge of the wing on its cylinder, and where its rounding ends.
  const double half = 0.5 * m_P.crestThickness;
  const double end = 1.0 + half / (m_P.scale * WingHalfHeight);
  for (int i = 0; i < 360; i += 3)
  {
    const double angle = i * M_PI / 180.0;
    for (const double grow : { 1.0, end })
    {
      const double  u = grow * m_P.scale * WingHalfWidth * std::cos(angle);
      const double  v = grow * m_P.scale * WingHalfHeight * std::sin(angle);
      const double  w = m_P.wingRadius - std::sqrt(std::max(0.0, m_P.wingRadius * m_P.wingRadius - u * u));
      const Vector3 point = m_WingCentre + u * m_WingU + v * m_WingV + w * m_WingNormal;
      Extend(interval, { point, grow > 1.0 ? 0.0 : half }, direction);
    }
  }
  return { interval.lower - bulge, interval.upper + bulge };
}
} // namespace bone
