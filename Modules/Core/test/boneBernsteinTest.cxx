/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneBernstein.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>
#include <stdexcept>

namespace BernsteinTests
{
using namespace bone;

std::vector<double>
RandomCoefficients(int degree, std::mt19937_64 & random)
{
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<double>                    c(BernsteinCount(degree));
  for (double & x : c)
  {
    x = uniform(random);
  }
  return c;
}

Barycentric
RandomBarycentric(std::mt19937_64 & random)
{
  std::exponential_distribution<double> exponential;
  Barycentric                           mu;
  for (int i = 0; i < 4; ++i)
  {
    mu[i] = exponential(random);
  }
  return mu / mu.sum();
}

/** Gauss-Legendre nodes and weights on [0, 1], by Newton's method. */
std::vector<std::pair<double, double>>
GaussLegendre(int n)
{
  std::vector<std::pair<double, double>> rule;
  for (int i = 0; i < n; ++i)
  {
    double x = std::cos(std::acos(-1.0) * (i + 0.75) / (n + 0.5)), slope = 1;
    for (int iteration = 0; iteration < 50; ++iteration)
    {
      double p0 = 1, p1 = x;
      for (int k = 2; k <= n; ++k)
      {
        const double p2 = ((2 * k - 1) * x * p1 - (k - 1) * p0) / k;
        p0 = p1;
        p1 = p2;
      }
      slope = n * (x * p1 - p0) / (x * x - 1);
      x -= p1 / slope;
    }
    rule.emplace_back(0.5 * (1 + x), 1 / ((1 - x * x) * slope * slope));
  }
  return rule;
}

/** Mean over a tetrahedron of a function of mu, by a collapsed Gauss rule exact for polynomials of degree 2n - 3. */
template <typename TFunction>
double
MeanOverTetrahedron(int n, const TFunction & f)
{
  double sum = 0;
  for (const auto & [u, wu] : GaussLegendre(n))
  {
    for (const auto & [v, wv] : GaussLegendre(n))
    {
      for (const auto & [w, ww] : GaussLegendre(n))
      {
        const Barycentric mu(u, (1 - u) * v, (1 - u) * (1 - v) * w, (1 - u) * (1 - v) * (1 - w));
        sum += 6 * wu * wv * ww * (1 - u) * (1 - u) * (1 - v) * f(mu);
      }
    }
  }
  return sum;
}

const Vector3 A(1, 2, 3), B(4, 2.5, 2), C(0.5, 5, 3.5), D(2, 3, 7);

class BernsteinOfDegree : public testing::TestWithParam<int>
{
protected:
  const int           m_Degree{ GetParam() };
  std::mt19937_64     m_Random{ 20240501u + static_cast<unsigned>(GetParam()) };
  std::vector<double> m_C{ RandomCoefficients(m_Degree, m_Random) };
};

TEST_P(BernsteinOfDegree, OrderIsByFallingExponents)
{
  int position = 0;
  for (int i = m_Degree; i >= 0; --i)
  {
    for (int j = m_Degree - i; j >= 0; --j)
    {
      for (int k = m_Degree - i - j; k >= 0; --k, ++position)
      {
        const std::array<int, 4> expected = { i, j, k, m_Degree - i - j - k };
        EXPECT_EQ(BernsteinExponents(m_Degree)[position], expected);
        EXPECT_EQ(BernsteinIndex(m_Degree, i, j, k), position);
      }
    }
  }
  EXPECT_EQ(position, BernsteinCount(m_Degree));
}

TEST_P(BernsteinOfDegree, BasisIsAPositivePartitionOfUnity)
{
  std::vector<double> basis(m_C.size());
  for (int trial = 0; trial < 20; ++trial)
  {
    BernsteinBasis(m_Degree, RandomBarycentric(m_Random), basis.data());
    EXPECT_NEAR(std::accumulate(basis.begin(), basis.end(), 0.0), 1, 1e-14);
    for (double b : basis)
    {
      EXPECT_GT(b, 0);
    }
  }
}

TEST_P(BernsteinOfDegree, BasisIsTheMultinomialFormula)
{
  const Barycentric   mu = RandomBarycentric(m_Random);
  std::vector<double> basis(m_C.size());
  BernsteinBasis(m_Degree, mu, basis.data());
  for (std::size_t p = 0; p < basis.size(); ++p)
  {
    double expected = std::tgamma(m_Degree + 1);
    for (int i = 0; i < 4; ++i)
    {
      const int e = BernsteinExponents(m_Degree)[p][i];
      expected *= std::pow(mu[i], e) / std::tgamma(e + 1);
    }
    EXPECT_NEAR(basis[p], expected, 1e-14);
  }
}

TEST_P(BernsteinOfDegree, ValueIsTheSumOverTheBasisOutsideTheTetrahedronToo)
{
  std::vector<double> basis(m_C.size());
  for (const Barycentric & mu : { RandomBarycentric(m_Random), Barycentric(1.4, -0.3, 0.2, -0.3) })
  {
    BernsteinBasis(m_Degree, mu, basis.data());
    const double expected = std::inner_product(basis.begin(), basis.end(), m_C.begin(), 0.0);
    EXPECT_NEAR(BernsteinValue(m_Degree, m_C.data(), mu), expected, 1e-12);
  }
}

TEST_P(BernsteinOfDegree, TakesTheFirstCoefficientAtVertexZero)
{
  EXPECT_DOUBLE_EQ(BernsteinValue(m_Degree, m_C.data(), { 1, 0, 0, 0 }), m_C.front());
  EXPECT_DOUBLE_EQ(BernsteinValue(m_Degree, m_C.data(), { 0, 0, 0, 1 }), m_C.back());
}

TEST_P(BernsteinOfDegree, GradientMatchesFiniteDifferences)
{
  const double h = 1e-5;
  for (int trial = 0; trial < 5; ++trial)
  {
    const Barycentric mu = RandomBarycentric(m_Random);
    const Vector3     x = mu[0] * A + mu[1] * B + mu[2] * C + mu[3] * D;
    const Vector3     gradient = BernsteinGradient(m_Degree, m_C.data(), mu, A, B, C, D);
    for (int k = 0; k < 3; ++k)
    {
      const auto at = [&](double step) {
        return BernsteinValue(m_Degree, m_C.data(), BarycentricCoordinates(x + step * Vector3::Unit(k), A, B, C, D));
      };
      EXPECT_NEAR(gradient[k], (at(h) - at(-h)) / (2 * h), 1e-7);
    }
  }
}

TEST_P(BernsteinOfDegree, BarycentricGradientObeysEulersHomogeneityLaw)
{
  const Barycentric mu = RandomBarycentric(m_Random);
  EXPECT_NEAR(BernsteinBarycentricGradient(m_Degree, m_C.data(), mu).dot(mu),
              m_Degree * BernsteinValue(m_Degree, m_C.data(), mu),
              1e-12);
}

TEST_P(BernsteinOfDegree, IntegralMatchesQuadrature)
{
  const double mean =
    MeanOverTetrahedron(8, [&](const Barycentric & mu) { return BernsteinValue(m_Degree, m_C.data(), mu); });
  EXPECT_NEAR(BernsteinIntegral(m_Degree, m_C.data(), 2.5), 2.5 * mean, 1e-12);
}

TEST_P(BernsteinOfDegree, SegmentControlValuesDescribeTheRestriction)
{
  const Barycentric   entry = RandomBarycentric(m_Random), exit = RandomBarycentric(m_Random);
  std::vector<double> values(m_Degree + 1);
  BernsteinSegmentControlValues(m_Degree, m_C.data(), entry, exit, values.data());
  for (double s : { 0.0, 0.3, 0.8, 1.0 })
  {
    double univariate = 0;
    for (int k = 0; k <= m_Degree; ++k)
    {
      const double binomial = std::tgamma(m_Degree + 1) / (std::tgamma(k + 1) * std::tgamma(m_Degree - k + 1));
      univariate += values[k] * binomial * std::pow(s, k) * std::pow(1 - s, m_Degree - k);
    }
    EXPECT_NEAR(univariate, BernsteinValue(m_Degree, m_C.data(), (1 - s) * entry + s * exit), 1e-13);
  }
}

TEST_P(BernsteinOfDegree, ControlValuesAlongAnEdgeAreItsCoefficients)
{
  std::vector<double> values(m_Degree + 1);
  BernsteinSegmentControlValues(m_Degree, m_C.data(), { 0, 1, 0, 0 }, { 0, 0, 1, 0 }, values.data());
  for (int k = 0; k <= m_Degree; ++k)
  {
    EXPECT_EQ(values[k], m_C[BernsteinIndex(m_Degree, 0, m_Degree - k, k)]);
  }
}

TEST_P(BernsteinOfDegree, SegmentIntegralMatchesGaussQuadrature)
{
  const Barycentric entry = RandomBarycentric(m_Random), exit = RandomBarycentric(m_Random);
  double            sum = 0;
  for (const auto & [s, weight] : GaussLegendre(6))
  {
    sum += weight * BernsteinValue(m_Degree, m_C.data(), (1 - s) * entry + s * exit);
  }
  EXPECT_NEAR(BernsteinSegmentIntegral(m_Degree, m_C.data(), entry, exit, 3.0), 3 * sum, 1e-13);
}

TEST_P(BernsteinOfDegree, ElevationKeepsThePolynomialAndItsIntegral)
{
  for (int to = m_Degree; to <= MaximumBernsteinDegree; ++to)
  {
    std::vector<double> elevated(BernsteinCount(to));
    BernsteinElevate(m_Degree, m_C.data(), to, elevated.data());
    for (int trial = 0; trial < 5; ++trial)
    {
      const Barycentric mu = RandomBarycentric(m_Random);
      EXPECT_NEAR(BernsteinValue(to, elevated.data(), mu), BernsteinValue(m_Degree, m_C.data(), mu), 1e-13);
    }
    EXPECT_NEAR(BernsteinIntegral(to, elevated.data(), 1), BernsteinIntegral(m_Degree, m_C.data(), 1), 1e-14);
  }
}

TEST_P(BernsteinOfDegree, InnerProductMatchesQuadrature)
{
  for (int other : { 0, 2, 5, MaximumBernsteinDegree })
  {
    const std::vector<double> g = RandomCoefficients(other, m_Random);
    const double              mean = MeanOverTetrahedron(10, [&](const Barycentric & mu) {
      return BernsteinValue(m_Degree, m_C.data(), mu) * BernsteinValue(other, g.data(), mu);
    });
    EXPECT_NEAR(BernsteinInnerProduct(m_Degree, m_C.data(), other, g.data(), 1.5), 1.5 * mean, 1e-12);
  }
}

TEST_P(BernsteinOfDegree, ValueStaysWithinTheControlValues)
{
  const auto [low, high] = std::minmax_element(m_C.begin(), m_C.end());
  for (int trial = 0; trial < 20; ++trial)
  {
    const double value = BernsteinValue(m_Degree, m_C.data(), RandomBarycentric(m_Random));
    EXPECT_GE(value, *low - 1e-14);
    EXPECT_LE(value, *high + 1e-14);
  }
}

INSTANTIATE_TEST_SUITE_P(Bernstein, BernsteinOfDegree, testing::Range(0, MaximumBernsteinDegree + 1));

TEST(Bernstein, DegreeOneIsTheValuesAtTheVertices)
{
  const double      c[] = { 3, 5, 7, 11 };
  const Barycentric mu(0.1, 0.2, 0.3, 0.4);
  EXPECT_DOUBLE_EQ(BernsteinValue(1, c, mu), 0.3 + 1.0 + 2.1 + 4.4);
}

TEST(Bernstein, RefusesADegreeThatItDoesNotKnow)
{
  const double      c[1] = { 1 };
  double            out[1];
  const Barycentric mu(0.25, 0.25, 0.25, 0.25);
  for (int degree : { -1, MaximumBernsteinDegree + 1 })
  {
    EXPECT_THROW(BernsteinExponents(degree), std::out_of_range);
    EXPECT_THROW(BernsteinIndex(degree, 0, 0, 0), std::out_of_range);
    EXPECT_THROW(BernsteinBasis(degree, mu, out), std::out_of_range);
    EXPECT_THROW(BernsteinValue(degree, c, mu), std::out_of_range);
    EXPECT_THROW(BernsteinBarycentricGradient(degree, c, mu), std::out_of_range);
    EXPECT_THROW(BernsteinIntegral(degree, c, 1), std::out_of_range);
    EXPECT_THROW(BernsteinSegmentIntegral(degree, c, mu, mu, 1), std::out_of_range);
    EXPECT_THROW(BernsteinElevate(degree, c, 1, out), std::out_of_range);
    EXPECT_THROW(BernsteinInnerProduct(0, c, degree, c, 1), std::out_of_range);
  }
  EXPECT_THROW(BernsteinElevate(1, c, 0, out), std::out_of_range);
  EXPECT_THROW(BernsteinIndex(2, 2, 1, 0), std::out_of_range);
}

TEST(Barycentric, CoordinatesReproduceThePoint)
{
  std::mt19937_64 random(5);
  for (int trial = 0; trial < 20; ++trial)
  {
    const Barycentric mu = RandomBarycentric(random);
    const Vector3     x = mu[0] * A + mu[1] * B + mu[2] * C + mu[3] * D;
    EXPECT_LT((BarycentricCoordinates(x, A, B, C, D) - mu).norm(), 1e-13);
  }
}
} // namespace BernsteinTests
