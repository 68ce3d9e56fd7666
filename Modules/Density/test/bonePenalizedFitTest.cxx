/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "bonePenalizedFit.h"

#include <gtest/gtest.h>

#include <random>
#include <stdexcept>

namespace PenalizedFitTests
{
using namespace bone;

std::vector<Barycentric>
RandomPlaces(std::size_t count)
{
  std::mt19937                    random(5);
  std::exponential_distribution<> exponential;
  std::vector<Barycentric>        places(count);
  for (Barycentric & mu : places)
  {
    mu = Barycentric(exponential(random), exponential(random), exponential(random), exponential(random));
    mu /= mu.sum();
  }
  return places;
}

Eigen::VectorXd
Solve(const PenalizedFit & fit, const std::vector<Barycentric> & places, const std::vector<double> & values)
{
  Eigen::VectorXd result(BernsteinCount(fit.GetDegree()));
  fit.Solve(places.size(), places.data(), values.data(), nullptr, static_cast<double>(places.size()), result.data());
  return result;
}

TEST(PenalizedFit, ManyPlacesAndAFaintPenaltyGiveThePolynomial)
{
  const auto          places = RandomPlaces(200);
  std::vector<double> values(200), basis(BernsteinCount(3));
  Eigen::VectorXd     truth = Eigen::VectorXd::LinSpaced(BernsteinCount(3), -1, 2);
  for (std::size_t v = 0; v < places.size(); ++v)
  {
    OrthonormalBasis(3, places[v], basis.data());
    values[v] = truth.dot(Eigen::Map<Eigen::VectorXd>(basis.data(), truth.size()));
  }
  const Eigen::VectorXd found = Solve(PenalizedFit(3, { 1e-13, 1e-13, 1e-13, 1e-13 }), places, values);
  EXPECT_LT((found - truth).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(PenalizedFit, IsTheSameWithFewPlacesAsWithThosePlacesAndManyOfNoWeight)
{
  // One way goes by the places, the other by the coefficients.
  const PenalizedFit  fit(4, { 1.0, 0.5, 0.25, 2.0, 3.0 });
  const auto          places = RandomPlaces(60);
  std::vector<double> values(60), weights(60, 0.0);
  for (std::size_t v = 0; v < 60; ++v)
  {
    values[v] = std::sin(static_cast<double>(v));
    weights[v] = v < 9 ? 0.5 + static_cast<double>(v) : 0.0;
  }
  Eigen::VectorXd few(BernsteinCount(4)), many(BernsteinCount(4));
  fit.Solve(9, places.data(), values.data(), weights.data(), 7.0, few.data());
  fit.Solve(60, places.data(), values.data(), weights.data(), 7.0, many.data());
  EXPECT_LT((few - many).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(PenalizedFit, NoPlacesGiveNothingAndOneIsMetInPart)
{
  const PenalizedFit fit(2, { 1.0, 1.0, 1.0 });
  EXPECT_EQ(Solve(fit, {}, {}).norm(), 0);
  // At the middle: p = k / (total + k) y with k the reproducing kernel there.
  const Barycentric middle(0.25, 0.25, 0.25, 0.25);
  Eigen::VectorXd   basis(BernsteinCount(2));
  OrthonormalBasis(2, middle, basis.data());
  const double k = basis.squaredNorm();
  EXPECT_NEAR(Solve(fit, { middle }, { 8.0 }).dot(basis), 8 * k / (1 + k), 1e-12);
}

TEST(PenalizedFit, RefusesPenaltiesThatDoNotHoldIt)
{
  EXPECT_THROW(PenalizedFit(1, { 1.0 }), std::invalid_argument);
  EXPECT_THROW(PenalizedFit(1, { 1.0, 0.0 }), std::invalid_argument);
}
} // namespace PenalizedFitTests
