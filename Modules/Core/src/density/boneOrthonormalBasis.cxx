/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneOrthonormalBasis.h"

#include <Eigen/LU>

#include <cmath>

#include <mutex>
#include <stdexcept>
#include <string>

namespace bone
{
namespace
{
constexpr int N = MaximumBernsteinDegree;

/** P_{n+1} = (a x + b t) P_n - c t^2 P_{n-1} for the homogeneous Jacobi polynomials t^n P_n^{(alpha, 0)}(x / t). */
struct Step
{
  double a, b, c;
};

struct Tables
{
  std::array<std::array<Step, N>, 2 * N + 3>                      step;     // by alpha and n
  std::array<std::array<std::array<int, N + 1>, N + 1>, N + 1>    position; // by degrees in the three directions
  std::array<std::array<std::array<double, N + 1>, N + 1>, N + 1> norm;
};

Tables
MakeTables()
{
  Tables tables{};
  for (int alpha = 0; alpha <= 2 * N + 2; ++alpha)
  {
    tables.step[alpha][0] = { 0.5 * (alpha + 2), 0.5 * alpha, 0 };
    for (int n = 1; n < N; ++n)
    {
      const double s = 2 * n + alpha, scale = 1 / (2 * (n + 1) * (n + alpha + 1) * s);
      tables.step[alpha][n] = { (s + 1) * (s + 2) * s * scale,
                                (s + 1) * alpha * alpha * scale,
                                2 * (n + alpha) * n * (s + 2) * scale };
    }
  }
  int position = 0;
  for (int k = 0; k <= N; ++k)
  {
    for (int p = k; p >= 0; --p)
    {
      for (int q = k - p; q >= 0; --q)
      {
        const int r = k - p - q;
        tables.position[p][q][r] = position++;
        tables.norm[p][q][r] = std::sqrt((2.0 * p + 1) * (2.0 * p + 2 * q + 2) * (2.0 * k + 3) / 6);
      }
    }
  }
  return tables;
}

const Tables Table = MakeTables();

using JacobiRow = std::array<double, N + 1>;

inline void
Jacobi(int alpha, int degree, double x, double t, JacobiRow & values)
{
  values[0] = 1;
  double before = 0;
  for (int n = 0; n < degree; ++n)
  {
    const Step & step = Table.step[alpha][n];
    values[n + 1] = (step.a * x + step.b * t) * values[n] - step.c * t * t * before;
    before = values[n];
  }
}

inline void
CheckOrthonormalDegree(int degree)
{
  if (degree < 0 || degree > N)
  {
    throw std::out_of_range("Degree " + std::to_string(degree) + " is outside 0.." + std::to_string(N) + ".");
  }
}

/** Both changes of basis of one degree. */
struct Change
{
  Eigen::MatrixXd toBernstein;
  Eigen::MatrixXd toOrthonormal;
};

Change
MakeChange(int degree)
{
  const auto &    exponents = BernsteinExponents(degree);
  const auto      count = static_cast<Eigen::Index>(exponents.size());
  Eigen::MatrixXd bernstein(count, count), orthonormal(count, count); // by polynomial and point
  for (Eigen::Index point = 0; point < count; ++point)
  {
    const auto & [i, j, k, l] = exponents[point];
    const Barycentric mu = (Barycentric(i, j, k, l).array() + 0.25) / (degree + 1);
    BernsteinBasis(degree, mu, bernstein.col(point).data());
    OrthonormalBasis(degree, mu, orthonormal.col(point).data());
  }
  Change change;
  change.toBernstein = bernstein.transpose().fullPivLu().solve(orthonormal.transpose());
  const Eigen::Map<const Eigen::MatrixXd> gram(BernsteinGramMatrix(degree, degree).data(), count, count);
  change.toOrthonormal = change.toBernstein.transpose() * gram;
  return change;
}

const Change &
ChangeOf(int degree)
{
  CheckOrthonormalDegree(degree);
  static std::array<Change, N + 1>         changes;
  static std::array<std::once_flag, N + 1> made;
  std::call_once(made[degree], [degree] { changes[degree] = MakeChange(degree); });
  return changes[degree];
}
} // namespace

void
OrthonormalBasis(int degree, const Barycentric & mu, double * values)
{
  CheckOrthonormalDegree(degree);
  const double t1 = mu[0] + mu[1], t2 = t1 + mu[2];
  JacobiRow    first, second, third;
  Jacobi(0, degree, mu[1] - mu[0], t1, first);
  for (int p = 0; p <= degree; ++p)
  {
    Jacobi(2 * p + 1, degree - p, mu[2] - t1, t2, second);
    for (int q = 0; q <= degree - p; ++q)
    {
      Jacobi(2 * p + 2 * q + 2, degree - p - q, mu[3] - t2, t2 + mu[3], third);
      const double head = first[p] * second[q];
      const auto & position = Table.position[p][q];
      const auto & norm = Table.norm[p][q];
      for (int r = 0; r <= degree - p - q; ++r)
      {
        values[position[r]] = norm[r] * head * third[r];
      }
    }
  }
}

const Eigen::MatrixXd &
OrthonormalToBernstein(int degree)
{
  return ChangeOf(degree).toBernstein;
}

const Eigen::MatrixXd &
BernsteinToOrthonormal(int degree)
{
  return ChangeOf(degree).toOrthonormal;
}

double
BernsteinDamping(int n, int k)
{
  CheckOrthonormalDegree(n);
  if (k < 0 || k > n)
  {
    throw std::out_of_range("A polynomial of degree " + std::to_string(n) + " has no part of degree " +
                            std::to_string(k) + ".");
  }
  double value = 1;
  for (int i = 0; i < k; ++i)
  {
    value *= static_cast<double>(n - i) / (n + 4 + i);
  }
  return value;
}

void
BernsteinReduce(int from, const double * c, int to, double * reduced)
{
  CheckOrthonormalDegree(from);
  CheckOrthonormalDegree(to);
  if (to > from)
  {
    throw std::out_of_range("A Bernstein polynomial of degree " + std::to_string(from) +
                            " cannot be reduced to the higher degree " + std::to_string(to) + ".");
  }
  const Eigen::Map<const Eigen::VectorXd> in(c, BernsteinCount(from));
  Eigen::Map<Eigen::VectorXd>             out(reduced, BernsteinCount(to));
  out = OrthonormalToBernstein(to) * (BernsteinToOrthonormal(from).topRows(BernsteinCount(to)) * in);
}
} // namespace bone
