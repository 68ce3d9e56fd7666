/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "bonePredicates.h"

#include <boost/multiprecision/cpp_int.hpp>

#include <cmath>
#include <limits>

namespace bone
{
namespace
{
using Exact = boost::multiprecision::cpp_rational;

// Unit round-off of a double, and the static bounds of Shewchuk's first filter stage.
constexpr double Epsilon = std::numeric_limits<double>::epsilon() / 2;
constexpr double Bound2D = (3 + 16 * Epsilon) * Epsilon;
constexpr double Bound3D = (7 + 56 * Epsilon) * Epsilon;
constexpr double BoundCircle = (10 + 96 * Epsilon) * Epsilon;
// Below this products may underflow and the relative bounds do not hold.
constexpr double Tiny = 1e-280;

template <typename T>
int
Sign(const T & x)
{
  return (x > 0) - (x < 0);
}

Exact
Difference(double a, double b)
{
  return Exact(a) - Exact(b);
}
} // namespace

int
Orient3D(const Vector3 & a, const Vector3 & b, const Vector3 & c, const Vector3 & d)
{
  const Vector3 u = b - a, v = c - a, w = d - a;
  const double  vw = v.y() * w.z(), wv = v.z() * w.y();
  const double  vx = v.z() * w.x(), xv = v.x() * w.z();
  const double  vy = v.x() * w.y(), yv = v.y() * w.x();
  const double  det = u.x() * (vw - wv) + u.y() * (vx - xv) + u.z() * (vy - yv);
  const double  permanent = std::abs(u.x()) * (std::abs(vw) + std::abs(wv)) +
                           std::abs(u.y()) * (std::abs(vx) + std::abs(xv)) +
                           std::abs(u.z()) * (std::abs(vy) + std::abs(yv));
  const double bound = Bound3D * permanent + Tiny;
  if (det > bound || -det > bound)
  {
    return Sign(det);
  }
  Exact m[3][3];
  for (int k = 0; k < 3; ++k)
  {
    m[0][k] = Difference(b[k], a[k]);
    m[1][k] = Difference(c[k], a[k]);
    m[2][k] = Difference(d[k], a[k]);
  }
  const Exact exact = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
                      m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                      m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
  return Sign(exact);
}

int
CrossSign2D(const Vector2 & a, const Vector2 & b, const Vector2 & c, const Vector2 & d)
{
  const double left = (b.x() - a.x()) * (d.y() - c.y());
  const double right = (b.y() - a.y()) * (d.x() - c.x());
  const double det = left - right;
  const double bound = Bound2D * (std::abs(left) + std::abs(right)) + Tiny;
  if (det > bound || -det > bound)
  {
    return Sign(det);
  }
  return Sign(
    Exact(Difference(b.x(), a.x()) * Difference(d.y(), c.y()) - Difference(b.y(), a.y()) * Difference(d.x(), c.x())));
}

int
Orient2D(const Vector2 & a, const Vector2 & b, const Vector2 & c)
{
  return CrossSign2D(a, b, a, c);
}

int
InCircle2D(const Vector2 & a, const Vector2 & b, const Vector2 & c, const Vector2 & d)
{
  const Vector2 u = a - d, v = b - d, w = c - d;
  const double  uu = u.squaredNorm(), vv = v.squaredNorm(), ww = w.squaredNorm();
  const double  det =
    uu * (v.x() * w.y() - v.y() * w.x()) + vv * (w.x() * u.y() - w.y() * u.x()) + ww * (u.x() * v.y() - u.y() * v.x());
  const double permanent = uu * (std::abs(v.x() * w.y()) + std::abs(v.y() * w.x())) +
                           vv * (std::abs(w.x() * u.y()) + std::abs(w.y() * u.x())) +
                           ww * (std::abs(u.x() * v.y()) + std::abs(u.y() * v.x()));
  const double bound = BoundCircle * permanent + Tiny;
  if (det > bound || -det > bound)
  {
    return Sign(det);
  }
  Exact m[3][3];
  int   row = 0;
  for (const Vector2 * p : { &a, &b, &c })
  {
    m[row][0] = Difference(p->x(), d.x());
    m[row][1] = Difference(p->y(), d.y());
    m[row][2] = m[row][0] * m[row][0] + m[row][1] * m[row][1];
    ++row;
  }
  const Exact exact = m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]) +
                      m[1][2] * (m[2][0] * m[0][1] - m[2][1] * m[0][0]) +
                      m[2][2] * (m[0][0] * m[1][1] - m[0][1] * m[1][0]);
  return Sign(exact);
}
} // namespace bone
