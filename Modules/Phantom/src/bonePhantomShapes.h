/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef bonePhantomShapes_h
#define bonePhantomShapes_h

#include "bonePhantomModel.h"

#include <algorithm>
#include <cmath>
#include <vector>

/** \file
 * Implicit shapes of the analytic phantoms, written once for double and for Dual (value and gradient). All are signed
 * distances or functions with gradients of norm at most 1, and so are their smooth unions and intersections. */
namespace bone::shapes
{
/** A number with its gradient in space: forward-mode differentiation. */
struct Dual
{
  double                v{ 0.0 };
  std::array<double, 3> d{ { 0.0, 0.0, 0.0 } };

  Dual() = default;
  Dual(double value) // NOLINT: constants mix with duals
    : v(value)
  {}
  Dual(double value, const std::array<double, 3> & derivative)
    : v(value)
    , d(derivative)
  {}
};

/** f(a) of derivative f'(a). */
inline Dual
Chain(const Dual & a, double value, double slope)
{
  return { value, { { slope * a.d[0], slope * a.d[1], slope * a.d[2] } } };
}
inline Dual
operator+(const Dual & a, const Dual & b)
{
  return { a.v + b.v, { { a.d[0] + b.d[0], a.d[1] + b.d[1], a.d[2] + b.d[2] } } };
}
inline Dual
operator-(const Dual & a, const Dual & b)
{
  return { a.v - b.v, { { a.d[0] - b.d[0], a.d[1] - b.d[1], a.d[2] - b.d[2] } } };
}
inline Dual
operator-(const Dual & a)
{
  return Chain(a, -a.v, -1.0);
}
inline Dual
operator*(const Dual & a, const Dual & b)
{
  return { a.v * b.v, { { a.v * b.d[0] + b.v * a.d[0], a.v * b.d[1] + b.v * a.d[1], a.v * b.d[2] + b.v * a.d[2] } } };
}
inline Dual
operator/(const Dual & a, double b)
{
  return Chain(a, a.v / b, 1.0 / b);
}

inline double
ValueOf(double a)
{
  return a;
}
inline double
ValueOf(const Dual & a)
{
  return a.v;
}
inline double
Chain(double, double value, double)
{
  return value;
}

/** Square root; the gradient at 0 is taken as 0. */
template <typename T>
T
Sqrt(const T & a)
{
  const double root = std::sqrt(std::max(ValueOf(a), 0.0));
  return Chain(a, root, root > 0.0 ? 0.5 / root : 0.0);
}
template <typename T>
T
Exp(const T & a)
{
  const double value = std::exp(ValueOf(a));
  return Chain(a, value, value);
}
template <typename T>
T
Sin(const T & a)
{
  return Chain(a, std::sin(ValueOf(a)), std::cos(ValueOf(a)));
}
template <typename T>
T
Abs(const T & a)
{
  return ValueOf(a) < 0.0 ? -a : a;
}
template <typename T>
T
Max(const T & a, const T & b)
{
  return ValueOf(a) < ValueOf(b) ? b : a;
}
template <typename T>
T
Square(const T & a)
{
  return a * a;
}

/** Quintic step from 0 (a <= 0) to 1 (a >= 1), twice continuously differentiable; steepest slope 1.875. */
template <typename T>
T
SmoothStep(const T & a)
{
  const double t = std::clamp(ValueOf(a), 0.0, 1.0);
  const double value = t * t * t * (t * (6.0 * t - 15.0) + 10.0);
  const double slope = 30.0 * t * t * (1.0 - t) * (1.0 - t);
  return Chain(a, value, slope);
}

/** Union: the smaller of both, blended over |a - b| < k by a cubic (I. Quilez); lies below the minimum by at most k/6.
 * Its gradient is a convex combination of theirs. */
template <typename T>
T
SmoothMin(const T & a, const T & b, double k)
{
  const T      smaller = ValueOf(b) < ValueOf(a) ? b : a;
  const double gap = std::abs(ValueOf(a) - ValueOf(b));
  if (gap >= k)
  {
    return smaller;
  }
  const T h = (T(k) - Abs(a - b)) / k;
  return smaller - h * h * h * T(k / 6.0);
}
template <typename T>
T
SmoothMax(const T & a, const T & b, double k)
{
  return -SmoothMin(T(-a), T(-b), k);
}

/** A point or vector with coordinates of type T. */
template <typename T>
struct Point
{
  T x, y, z;
};
template <typename T>
Point<T>
Minus(const Point<T> & p, const Vector3 & q)
{
  return { p.x - T(q.x()), p.y - T(q.y()), p.z - T(q.z()) };
}
template <typename T>
T
Dot(const Point<T> & p, const Vector3 & q)
{
  return p.x * T(q.x()) + p.y * T(q.y()) + p.z * T(q.z());
}
template <typename T>
T
SquaredNorm(const Point<T> & p)
{
  return p.x * p.x + p.y * p.y + p.z * p.z;
}

/** The argument of a function of space, ready for differentiation. */
inline Point<double>
Variable(const Vector3 & x, double)
{
  return { x.x(), x.y(), x.z() };
}
inline Point<Dual>
Variable(const Vector3 & x, const Dual &)
{
  return { { x.x(), { { 1, 0, 0 } } }, { x.y(), { { 0, 1, 0 } } }, { x.z(), { { 0, 0, 1 } } } };
}

struct Ball
{
  Vector3 centre;
  double  radius;

  template <typename T>
  T
  operator()(const Point<T> & p) const
  {
    return Sqrt(SquaredNorm(Minus(p, centre))) - T(radius);
  }
};

/** Convex hull of two balls: exact signed distance outside and in the shell, C1. */
struct RoundCone
{
  Ball a;
  Ball b;

  template <typename T>
  T
  operator()(const Point<T> & p) const
  {
    const Vector3 axis = b.centre - a.centre;
    const double  length = axis.norm();
    const double  shrink = (a.radius - b.radius) / length;
    const double  side = std::sqrt(1.0 - shrink * shrink);
    const auto    q = Minus(p, a.centre);
    const T       along = Dot(q, axis) / length;
    const T       across = Sqrt(Max(SquaredNorm(q) - along * along, T(0.0)));
    const double  foot = ValueOf(along) - ValueOf(across) * shrink / side;
    if (foot <= 0.0)
    {
      return Sqrt(across * across + along * along) - T(a.radius);
    }
    if (foot >= length)
    {
      return Sqrt(across * across + Square(along - T(length))) - T(b.radius);
    }
    return across * T(side) + along * T(shrink) - T(a.radius);
  }
};

/** exp(-|x - centre|^2 / (2 width^2)); steepest slope 0.61 / width. */
template <typename T>
T
Bump(const Point<T> & p, const Vector3 & centre, double width)
{
  return Exp(SquaredNorm(Minus(p, centre)) / (-2.0 * width * width));
}

/** Distance of x to the segment from a to b. */
inline double
SegmentDistance(const Vector3 & x, const Vector3 & a, const Vector3 & b)
{
  const Vector3 axis = b - a;
  const double  t = std::clamp((x - a).dot(axis) / axis.squaredNorm(), 0.0, 1.0);
  return (x - a - t * axis).norm();
}

/** exp(-t^2 / 2). */
inline double
Gaussian(double t)
{
  return std::exp(-0.5 * t * t);
}

/** Widens an interval so that it holds the ball's shadow. */
inline void
Extend(PhantomModel::Interval & interval, const Ball & ball, const Vector3 & direction)
{
  const double middle = ball.centre.dot(direction);
  interval.lower = std::min(interval.lower, middle - ball.radius);
  interval.upper = std::max(interval.upper, middle + ball.radius);
}
} // namespace bone::shapes

namespace bone
{
/** Repeatable draws for a subject: the k-th number in [-1, 1], more often near 0 (mean of two uniform numbers), a hash
 * of seed and k alone; 0 for seed 0, the mean subject. */
class SubjectDraws
{
public:
  explicit SubjectDraws(std::uint64_t seed)
    : m_Seed(seed)
  {}
  double
  Next();

private:
  std::uint64_t m_Seed;
  std::uint64_t m_Count{ 0 };
};

/** splitmix64's output function (S. Vigna): a 64-bit hash whose bits all depend on all bits of x. */
inline std::uint64_t
HashBits(std::uint64_t x)
{
  x += 0x9e3779b97f4a7c15ULL;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

/** Uniform number in (0, 1) from 64 random bits. */
inline double
UnitInterval(std::uint64_t bits)
{
  return (static_cast<double>(bits >> 11) + 0.5) * 0x1.0p-53;
}

inline double
SubjectDraws::Next()
{
  if (m_Seed == 0)
  {
    return 0.0;
  }
  const std::uint64_t a = HashBits(HashBits(m_Seed) + 2 * m_Count);
  const std::uint64_t b = HashBits(HashBits(m_Seed) + 2 * m_Count + 1);
  ++m_Count;
  return UnitInterval(a) + UnitInterval(b) - 1.0;
}
} // namespace bone

#endif
