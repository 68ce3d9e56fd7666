/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneDensityFitKernel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>

namespace DensityFitKernelTests
{
using namespace bone;

std::vector<double>
RandomValues(std::size_t count, unsigned seed)
{
  std::mt19937_64                        random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<double>                    values(count);
  std::generate(values.begin(), values.end(), [&] { return uniform(random); });
  return values;
}

template <typename TFunction>
std::vector<double>
Sampled(const DensityFitKernel & kernel, const TFunction & f)
{
  std::vector<double> values;
  for (const Barycentric & mu : kernel.SamplePoints())
  {
    values.push_back(f(mu));
  }
  return values;
}

std::vector<double>
Fitted(const DensityFitKernel & kernel, const std::vector<double> & values)
{
  std::vector<double> c(kernel.GetNumberOfCoefficients());
  kernel.Fit(values.data(), c.data());
  return c;
}

class FitOfDegree : public testing::TestWithParam<int>
{
protected:
  const int m_Degree{ GetParam() };
};

TEST_P(FitOfDegree, TakesMoreThanTwiceAsManySamplesAsCoefficientsAllInside)
{
  const DensityFitKernel kernel(m_Degree, DensityFitKernel::MinimumLattice(m_Degree));
  EXPECT_GT(kernel.SamplePoints().size(), 2u * BernsteinCount(m_Degree));
  EXPECT_LE(BernsteinCount(kernel.GetLattice() - 1), 2 * BernsteinCount(m_Degree));
  Barycentric mean = Barycentric::Zero();
  for (const Barycentric & mu : kernel.SamplePoints())
  {
    EXPECT_GT(mu.minCoeff(), 0);
    EXPECT_NEAR(mu.sum(), 1, 1e-15);
    mean += mu / static_cast<double>(kernel.SamplePoints().size());
  }
  EXPECT_LT((mean.array() - 0.25).abs().maxCoeff(), 1e-14);
}

TEST_P(FitOfDegree, ReproducesPolynomialsOfItsDegreeAndBelow)
{
  for (int degree = 0; degree <= m_Degree; ++degree)
  {
    const std::vector<double> truth = RandomValues(BernsteinCount(degree), 3 + degree);
    std::vector<double>       expected(BernsteinCount(m_Degree));
    BernsteinElevate(degree, truth.data(), m_Degree, expected.data());
    for (int more : { 0, 3 })
    {
      const DensityFitKernel kernel(m_Degree, DensityFitKernel::MinimumLattice(m_Degree) + more);
      const auto             c = Fitted(
        kernel, Sampled(kernel, [&](const Barycentric & mu) { return BernsteinValue(degree, truth.data(), mu); }));
      for (std::size_t i = 0; i < c.size(); ++i)
      {
        EXPECT_NEAR(c[i], expected[i], 1e-10);
      }
    }
  }
}

TEST_P(FitOfDegree, LeavesAResidualOrthogonalToTheBasis)
{
  const DensityFitKernel    kernel(m_Degree, DensityFitKernel::MinimumLattice(m_Degree));
  const std::vector<double> values = RandomValues(kernel.SamplePoints().size(), 11);
  const auto                c = Fitted(kernel, values);
  std::vector<double>       basis(c.size()), moment(c.size(), 0.0);
  for (std::size_t s = 0; s < values.size(); ++s)
  {
    const Barycentric & mu = kernel.SamplePoints()[s];
    BernsteinBasis(m_Degree, mu, basis.data());
    const double residual = values[s] - BernsteinValue(m_Degree, c.data(), mu);
    for (std::size_t i = 0; i < c.size(); ++i)
    {
      moment[i] += residual * basis[i];
    }
  }
  for (double m : moment)
  {
    EXPECT_NEAR(m, 0, 1e-11);
  }
}

TEST_P(FitOfDegree, DoesNotDependOnTheOrderOfTheVertices)
{
  const DensityFitKernel kernel(m_Degree, DensityFitKernel::MinimumLattice(m_Degree));
  const auto             f = [](const Barycentric & mu) { return std::exp(mu[0] - 2 * mu[1]) * std::cos(5 * mu[2]); };
  const auto             turn = [](const Barycentric & mu) { return Barycentric(mu[1], mu[2], mu[3], mu[0]); };
  const auto             a = Fitted(kernel, Sampled(kernel, f));
  const auto             b = Fitted(kernel, Sampled(kernel, [&](const Barycentric & mu) { return f(turn(mu)); }));
  for (const Barycentric & mu : { Barycentric(0.1, 0.2, 0.3, 0.4), Barycentric(1, 0, 0, 0) })
  {
    EXPECT_NEAR(BernsteinValue(m_Degree, a.data(), turn(mu)), BernsteinValue(m_Degree, b.data(), mu), 1e-11);
  }
}

TEST_P(FitOfDegree, ManyAtOnceAreTheSameAsOneByOne)
{
  const DensityFitKernel    kernel(m_Degree, DensityFitKernel::MinimumLattice(m_Degree) + 1);
  const std::size_t         samples = kernel.SamplePoints().size(), count = BernsteinCount(m_Degree), fits = 7;
  const std::vector<double> values = RandomValues(fits * samples, 17);
  std::vector<double>       many(fits * count), one(count);
  kernel.FitMany(fits, values.data(), many.data());
  for (std::size_t f = 0; f < fits; ++f)
  {
    kernel.Fit(&values[f * samples], one.data());
    for (std::size_t i = 0; i < count; ++i)
    {
      EXPECT_NEAR(many[f * count + i], one[i], 1e-11);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(DensityFitKernel, FitOfDegree, testing::Range(0, MaximumBernsteinDegree + 1));

double
Overshoot(const std::vector<double> & c, const std::vector<double> & values)
{
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  const auto [least, most] = std::minmax_element(c.begin(), c.end());
  return std::max(*most - *high, *low - *least);
}

TEST(DensityFitKernel, TikhonovsTermTendsToTheLinearFit)
{
  for (int degree = 2; degree <= MaximumBernsteinDegree; degree += 3)
  {
    const int                 lattice = DensityFitKernel::MinimumLattice(degree);
    const DensityFitKernel    plain(degree, lattice), stiff(degree, lattice, 1e9);
    const std::vector<double> values = RandomValues(plain.SamplePoints().size(), 23);
    const auto                fit = Fitted(stiff, values);
    // Second differences along an edge vanish for a linear polynomial.
    const double bend = fit[BernsteinIndex(degree, degree, 0, 0)] - 2 * fit[BernsteinIndex(degree, degree - 1, 1, 0)] +
                        fit[BernsteinIndex(degree, degree - 2, 2, 0)];
    EXPECT_NEAR(bend, 0, 1e-6);
  }
}

TEST(DensityFitKernel, TikhonovsTermKeepsLinearFieldsAndBoundsControlValues)
{
  const Barycentric slope(3, -1, 2, 7);
  for (int degree = 1; degree <= MaximumBernsteinDegree; ++degree)
  {
    const int              lattice = DensityFitKernel::MinimumLattice(degree);
    const DensityFitKernel plain(degree, lattice), damped(degree, lattice, 1e-3);
    const auto          linear = Fitted(damped, Sampled(damped, [&](const Barycentric & mu) { return slope.dot(mu); }));
    std::vector<double> expected(linear.size());
    BernsteinElevate(1, slope.data(), degree, expected.data());
    for (std::size_t i = 0; i < linear.size(); ++i)
    {
      EXPECT_NEAR(linear[i], expected[i], 1e-10);
    }
    const std::vector<double> noise = RandomValues(plain.SamplePoints().size(), 29);
    if (degree > 2)
    {
      const double share = degree < 6 ? 1.0 : 0.5;
      EXPECT_LT(Overshoot(Fitted(damped, noise), noise), share * Overshoot(Fitted(plain, noise), noise));
    }
  }
}

TEST(DensityFitKernel, RefusesWhatItCannotFit)
{
  EXPECT_THROW(DensityFitKernel(-1, 5), std::out_of_range);
  EXPECT_THROW(DensityFitKernel(MaximumBernsteinDegree + 1, 20), std::out_of_range);
  EXPECT_THROW(DensityFitKernel(3, DensityFitKernel::MinimumLattice(3) - 1), std::invalid_argument);
  EXPECT_THROW(DensityFitKernel(3, 6, -1e-3), std::invalid_argument);
  EXPECT_THROW(DensityFitKernel(3, 6, std::nan("")), std::invalid_argument);
}

TEST(DensityFitKernel, ChoosesDenserPatternsForMorePointsWithinItsLimits)
{
  EXPECT_EQ(DensityFitKernel::LatticeWithPoints(3, 0, 20), DensityFitKernel::MinimumLattice(3));
  EXPECT_EQ(DensityFitKernel::LatticeWithPoints(3, 286, 20), 10);
  EXPECT_EQ(DensityFitKernel::LatticeWithPoints(3, 287, 20), 11);
  EXPECT_EQ(DensityFitKernel::LatticeWithPoints(3, 1e9, 20), 20);
}
} // namespace DensityFitKernelTests
