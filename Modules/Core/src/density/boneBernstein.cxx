/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneBernstein.h"

#include <algorithm>
#include <mutex>
#include <numeric>
#include <stdexcept>
#include <string>

namespace bone
{
namespace
{
constexpr int MaximumCount = BernsteinCount(MaximumBernsteinDegree);

constexpr double
Factorial(int n)
{
  double f = 1;
  for (int i = 2; i <= n; ++i)
  {
    f *= i;
  }
  return f;
}

/** The order puts exponents (i, j, k, l) at a position that depends on j, k and l alone. */
constexpr int
Position(int j, int k, int l)
{
  const int r = j + k + l, s = k + l;
  return r * (r + 1) * (r + 2) / 6 + s * (s + 1) / 2 + l;
}

/** For each position: (j, k, l) and the positions with j, k or l raised by one; factorials. One table serves every
 * degree. */
struct OrderTable
{
  std::array<std::array<int, 3>, MaximumCount>   exponents{};
  std::array<std::array<int, 3>, MaximumCount>   raised{};
  std::array<double, MaximumBernsteinDegree + 1> factorial{};
};

constexpr OrderTable
MakeOrderTable()
{
  OrderTable table;
  int        position = 0;
  for (int r = 0; r <= MaximumBernsteinDegree; ++r)
  {
    table.factorial[r] = Factorial(r);
    for (int j = r; j >= 0; --j)
    {
      for (int k = r - j; k >= 0; --k, ++position)
      {
        const int l = r - j - k;
        table.exponents[position] = { j, k, l };
        table.raised[position] = { Position(j + 1, k, l), Position(j, k + 1, l), Position(j, k, l + 1) };
      }
    }
  }
  return table;
}

constexpr OrderTable Order = MakeOrderTable();

inline void
CheckDegree(int degree)
{
  if (degree < 0 || degree > MaximumBernsteinDegree)
  {
    throw std::out_of_range("Bernstein degree " + std::to_string(degree) + " is outside 0.." +
                            std::to_string(MaximumBernsteinDegree) + ".");
  }
}

/** One step of de Casteljau: the blossom with one argument fixed to mu, degree -> degree - 1. May work in place. */
inline void
FixArgument(int degree, const double * c, const Barycentric & mu, double * reduced)
{
  const int count = BernsteinCount(degree - 1);
  for (int p = 0; p < count; ++p)
  {
    const std::array<int, 3> & up = Order.raised[p];
    reduced[p] = mu[0] * c[p] + mu[1] * c[up[0]] + mu[2] * c[up[1]] + mu[3] * c[up[2]];
  }
}

using Powers = std::array<double, MaximumBernsteinDegree + 1>;

/** Powers of x over their factorials, 0..degree. */
inline Powers
ScaledPowers(int degree, double x)
{
  Powers p;
  p[0] = 1;
  for (int i = 1; i <= degree; ++i)
  {
    p[i] = p[i - 1] * x / i;
  }
  return p;
}

/** Sum over positions, nested by exponent; the degree is known to the compiler, which unrolls it. */
template <int VDegree>
double
NestedValue(const double * c, const Barycentric & mu)
{
  const Powers a = ScaledPowers(VDegree, mu[0]), b = ScaledPowers(VDegree, mu[1]);
  const Powers e = ScaledPowers(VDegree, mu[2]), f = ScaledPowers(VDegree, mu[3]);
  double       value = 0;
  for (int r = 0, position = 0; r <= VDegree; ++r)
  {
    double shell = 0;
    for (int s = 0; s <= r; ++s)
    {
      double row = 0;
      for (int l = 0; l <= s; ++l, ++position)
      {
        row += c[position] * e[s - l] * f[l];
      }
      shell += row * b[r - s];
    }
    value += shell * a[VDegree - r];
  }
  return value * Factorial(VDegree);
}

std::vector<double>
MakeGramMatrix(int rows, int columns)
{
  const int           n = BernsteinCount(rows), m = BernsteinCount(columns), total = rows + columns;
  const double        scale = Factorial(rows) * Factorial(columns) / Factorial(total) / BernsteinCount(total);
  std::vector<double> gram(static_cast<std::size_t>(n) * m);
  for (int p = 0; p < n; ++p)
  {
    const auto & a = Order.exponents[p];
    for (int q = 0; q < m; ++q)
    {
      const auto &             b = Order.exponents[q];
      const std::array<int, 4> low = { rows - a[0] - a[1] - a[2], a[0], a[1], a[2] };
      const std::array<int, 4> high = { columns - b[0] - b[1] - b[2], b[0], b[1], b[2] };
      double                   value = scale;
      for (int i = 0; i < 4; ++i)
      {
        value *= Factorial(low[i] + high[i]) / (Factorial(low[i]) * Factorial(high[i]));
      }
      gram[static_cast<std::size_t>(p) * m + q] = value;
    }
  }
  return gram;
}
} // namespace

const std::vector<std::array<int, 4>> &
BernsteinExponents(int degree)
{
  CheckDegree(degree);
  static const auto exponents = [] {
    std::array<std::vector<std::array<int, 4>>, MaximumBernsteinDegree + 1> all;
    for (int n = 0; n <= MaximumBernsteinDegree; ++n)
    {
      for (int p = 0; p < BernsteinCount(n); ++p)
      {
        const auto & e = Order.exponents[p];
        all[n].push_back({ n - e[0] - e[1] - e[2], e[0], e[1], e[2] });
      }
    }
    return all;
  }();
  return exponents[degree];
}

int
BernsteinIndex(int degree, int i, int j, int k)
{
  CheckDegree(degree);
  const int l = degree - i - j - k;
  if (i < 0 || j < 0 || k < 0 || l < 0)
  {
    throw std::out_of_range("Bernstein exponents must be at least 0 and add up to the degree.");
  }
  return Position(j, k, l);
}

void
BernsteinBasis(int degree, const Barycentric & mu, double * values)
{
  CheckDegree(degree);
  std::array<Powers, 4> power;
  for (int i = 0; i < 4; ++i)
  {
    power[i] = ScaledPowers(degree, mu[i]);
  }
  const double scale = Order.factorial[degree];
  for (int r = 0, position = 0; r <= degree; ++r)
  {
    for (int s = 0; s <= r; ++s)
    {
      const double head = scale * power[0][degree - r] * power[1][r - s];
      for (int l = 0; l <= s; ++l, ++position)
      {
        values[position] = head * power[2][s - l] * power[3][l];
      }
    }
  }
}

double
BernsteinValue(int degree, const double * c, const Barycentric & mu)
{
  switch (degree)
  {
    case 0:
      return c[0];
    case 1:
      return c[0] * mu[0] + c[1] * mu[1] + c[2] * mu[2] + c[3] * mu[3];
    case 2:
      return NestedValue<2>(c, mu);
    case 3:
      return NestedValue<3>(c, mu);
    case 4:
      return NestedValue<4>(c, mu);
    case 5:
      return NestedValue<5>(c, mu);
    case 6:
      return NestedValue<6>(c, mu);
    case 7:
      return NestedValue<7>(c, mu);
    case 8:
      return NestedValue<8>(c, mu);
    default:
      CheckDegree(degree);
      return 0;
  }
}

Eigen::Vector4d
BernsteinBarycentricGradient(int degree, const double * c, const Barycentric & mu)
{
  CheckDegree(degree);
  if (degree == 0)
  {
    return Eigen::Vector4d::Zero();
  }
  std::array<double, MaximumCount> basis;
  BernsteinBasis(degree - 1, mu, basis.data());
  Eigen::Vector4d gradient = Eigen::Vector4d::Zero();
  const int       count = BernsteinCount(degree - 1);
  for (int p = 0; p < count; ++p)
  {
    const std::array<int, 3> & up = Order.raised[p];
    gradient += basis[p] * Eigen::Vector4d(c[p], c[up[0]], c[up[1]], c[up[2]]);
  }
  return degree * gradient;
}

Vector3
BernsteinGradient(int                 degree,
                  const double *      coefficients,
                  const Barycentric & mu,
                  const Vector3 &     a,
                  const Vector3 &     b,
                  const Vector3 &     c,
                  const Vector3 &     d)
{
  const Eigen::Vector4d g = BernsteinBarycentricGradient(degree, coefficients, mu);
  const Vector3         u = b - a, v = c - a, w = d - a;
  const Vector3         n = v.cross(w);
  return ((g[1] - g[0]) * n + (g[2] - g[0]) * w.cross(u) + (g[3] - g[0]) * u.cross(v)) / u.dot(n);
}

double
BernsteinIntegral(int degree, const double * c, double volume)
{
  CheckDegree(degree);
  const int count = BernsteinCount(degree);
  return volume * std::accumulate(c, c + count, 0.0) / count;
}

void
BernsteinSegmentControlValues(int                 degree,
                              const double *      c,
                              const Barycentric & entry,
                              const Barycentric & exit,
                              double *            values)
{
  CheckDegree(degree);
  std::array<double, MaximumCount> fixed, work; // arguments fixed to the entry; those then fixed to the exit
  std::copy_n(c, BernsteinCount(degree), fixed.data());
  for (int k = degree; k >= 0; --k)
  {
    // `fixed` holds the blossom with degree - k arguments at the entry; the other k go to the exit.
    const double * from = fixed.data();
    for (int m = k; m > 0; --m)
    {
      FixArgument(m, from, exit, work.data());
      from = work.data();
    }
    values[k] = from[0];
    if (k > 0)
    {
      FixArgument(k, fixed.data(), entry, fixed.data());
    }
  }
}

double
BernsteinSegmentIntegral(int                 degree,
                         const double *      c,
                         const Barycentric & entry,
                         const Barycentric & exit,
                         double              length)
{
  std::array<double, MaximumBernsteinDegree + 1> values;
  BernsteinSegmentControlValues(degree, c, entry, exit, values.data());
  return length * std::accumulate(values.data(), values.data() + degree + 1, 0.0) / (degree + 1);
}

void
BernsteinElevate(int from, const double * c, int to, double * elevated)
{
  CheckDegree(from);
  CheckDegree(to);
  if (to < from)
  {
    throw std::out_of_range("A Bernstein polynomial of degree " + std::to_string(from) +
                            " cannot be elevated to the lower degree " + std::to_string(to) + ".");
  }
  std::array<double, MaximumCount> now, next;
  std::copy_n(c, BernsteinCount(from), now.data());
  for (int n = from; n < to; ++n)
  {
    std::fill_n(next.data(), BernsteinCount(n + 1), 0.0);
    for (int p = 0; p < BernsteinCount(n); ++p)
    {
      const auto & e = Order.exponents[p];
      const double share = now[p] / (n + 1);
      next[p] += (n - e[0] - e[1] - e[2] + 1) * share;
      for (int i = 0; i < 3; ++i)
      {
        next[Order.raised[p][i]] += (e[i] + 1) * share;
      }
    }
    std::swap(now, next);
  }
  std::copy_n(now.data(), BernsteinCount(to), elevated);
}

const std::vector<double> &
BernsteinGramMatrix(int degreeF, int degreeG)
{
  CheckDegree(degreeF);
  CheckDegree(degreeG);
  constexpr int                                             degrees = MaximumBernsteinDegree + 1;
  static std::array<std::vector<double>, degrees * degrees> matrices;
  static std::array<std::once_flag, degrees * degrees>      made;
  const int                                                 slot = degreeF * degrees + degreeG;
  std::call_once(made[slot], [&] { matrices[slot] = MakeGramMatrix(degreeF, degreeG); });
  return matrices[slot];
}

double
BernsteinInnerProduct(int degreeF, const double * f, int degreeG, const double * g, double volume)
{
  const double * row = BernsteinGramMatrix(degreeF, degreeG).data();
  const int      n = BernsteinCount(degreeF), m = BernsteinCount(degreeG);
  double         sum = 0;
  for (int p = 0; p < n; ++p, row += m)
  {
    sum += f[p] * std::inner_product(row, row + m, g, 0.0);
  }
  return volume * sum;
}

Barycentric
BarycentricCoordinates(const Vector3 & x, const Vector3 & a, const Vector3 & b, const Vector3 & c, const Vector3 & d)
{
  const Vector3 u = b - a, v = c - a, w = d - a, r = x - a;
  const Vector3 n = v.cross(w);
  const double  scale = 1.0 / u.dot(n);
  const double  m1 = r.dot(n) * scale, m2 = r.dot(w.cross(u)) * scale, m3 = r.dot(u.cross(v)) * scale;
  return { 1.0 - m1 - m2 - m3, m1, m2, m3 };
}
} // namespace bone
