/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "bonePhantomSampler.h"

#include "boneFemurPhantom.h"
#include "boneHemipelvisPhantom.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

using namespace bone;

namespace PhantomSamplerTests
{
/** The ideal density convolved with a Gaussian, by brute force on a fine grid with a random offset. */
double
Convolve(const PhantomModel & model, const Vector3 & x, const Eigen::Matrix3d & axes, const Vector3 & sigma)
{
  constexpr int    reach = 14;
  constexpr double step = 0.27;
  double           sum = 0.0;
  double           weights = 0.0;
  for (int k = -reach; k <= reach; ++k)
  {
    for (int j = -reach; j <= reach; ++j)
    {
      for (int i = -reach; i <= reach; ++i)
      {
        const Vector3 t = step * (Vector3(i, j, k) + Vector3(0.31, 0.17, -0.23));
        const double  weight = std::exp(-0.5 * t.squaredNorm());
        sum += weight * model.Density(x + axes * sigma.cwiseProduct(t));
        weights += weight;
      }
    }
  }
  return sum / weights;
}

Eigen::Matrix3d
Oblique()
{
  return Eigen::AngleAxisd(0.5, Vector3(1, 2, -1).normalized()).toRotationMatrix();
}

/** Compares the sampler with brute force at points near a surface. */
void
ExpectAgreement(PhantomModel::Pointer model,
                const Vector3 &       spacing,
                const Vector3 &       sigma,
                int                   count,
                double                tolerance)
{
  PhantomGrid grid;
  grid.axes = Oblique();
  grid.spacing = spacing;
  grid.origin = Vector3(3.1, -2.2, 7.3);
  const PhantomSampler                   sampler(model, grid, sigma);
  std::mt19937                           random(11);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  const Vector3                          lower = model->GetLowerCorner();
  const Vector3                          size = model->GetUpperCorner() - lower;
  for (int n = 0; n < count;)
  {
    const double  a = unit(random), b = unit(random), c = unit(random);
    const Vector3 x = lower + size.cwiseProduct(Vector3(a, b, c));
    if (std::abs(model->EvaluateLevels(x)[n % model->GetNumberOfSurfaces()]) < 0.5)
    {
      const Vector3 index = (grid.axes.transpose() * (x - grid.origin)).cwiseQuotient(spacing);
      PhantomBlock  voxel;
      for (int d = 0; d < 3; ++d)
      {
        voxel.start[d] = std::lround(index[d]);
        voxel.size[d] = 1;
      }
      float density = 0.0F;
      sampler.SampleDensity(voxel, &density);
      const Vector3 centre = grid.At(voxel.start[0], voxel.start[1], voxel.start[2]);
      EXPECT_NEAR(density, Convolve(*model, centre, grid.axes, sigma), tolerance) << "at " << centre.transpose();
      ++n;
    }
  }
}

TEST(PhantomSampler, AgreesWithBruteForceForANarrowPointSpread)
{
  ExpectAgreement(std::make_shared<FemurPhantom>(), { 0.7, 0.8, 1.0 }, { 0.3, 0.3, 0.42 }, 40, 30.0);
  ExpectAgreement(std::make_shared<HemipelvisPhantom>(), { 0.7, 0.8, 1.0 }, { 0.3, 0.3, 0.42 }, 40, 30.0);
}

TEST(PhantomSampler, AgreesWithBruteForceForAWidePointSpread)
{
  ExpectAgreement(std::make_shared<FemurPhantom>(), { 0.7, 0.7, 3.0 }, { 0.3, 0.3, 1.27 }, 30, 30.0);
  ExpectAgreement(std::make_shared<HemipelvisPhantom>(), { 2.0, 1.0, 1.5 }, { 0.9, 0.5, 0.7 }, 30, 30.0);
}

TEST(PhantomSampler, GivesTheIdealDensityWithoutPointSpread)
{
  const auto        femur = std::make_shared<FemurPhantom>();
  const PhantomGrid grid;
  PhantomBlock      block;
  block.start = { { -30, -30, -8 } };
  block.size = { { 80, 60, 3 } };
  std::vector<float>   density(80 * 60 * 3);
  std::vector<short>   regions(80 * 60 * 3);
  const PhantomSampler sampler(femur, grid, Vector3::Zero());
  sampler.SampleDensity(block, density.data());
  sampler.SampleRegions(block, regions.data());
  std::size_t n = 0;
  for (int k = -8; k < -5; ++k)
  {
    for (int j = -30; j < 30; ++j)
    {
      for (int i = -30; i < 50; ++i, ++n)
      {
        EXPECT_EQ(density[n], static_cast<float>(femur->Density(grid.At(i, j, k))));
        EXPECT_EQ(regions[n], femur->Region(grid.At(i, j, k)));
      }
    }
  }
}

TEST(PhantomSampler, DoesNotDependOnTheBlock)
{
  const auto  hip = std::make_shared<HemipelvisPhantom>();
  PhantomGrid grid;
  grid.axes = Oblique();
  grid.spacing = Vector3(1.3, 1.1, 2.4);
  const PhantomSampler sampler(hip, grid, { 0.3, 0.6, 1.0 });
  PhantomBlock         whole;
  whole.start = { { -20, -20, -10 } };
  whole.size = { { 40, 40, 10 } };
  std::vector<float> density(16000);
  sampler.SampleDensity(whole, density.data());
  for (long k = 0; k < 10; k += 3)
  {
    PhantomBlock part;
    part.start = { { -15, -13, -10 + k } };
    part.size = { { 25, 17, 1 } };
    std::vector<float> values(25 * 17);
    sampler.SampleDensity(part, values.data());
    for (long j = 0; j < 17; ++j)
    {
      for (long i = 0; i < 25; ++i)
      {
        EXPECT_EQ(values[j * 25 + i], density[(k * 40 + j + 7) * 40 + i + 5]);
      }
    }
  }
}

TEST(PhantomSampler, BlurredEdgeIsHalfwayOnTheSurface)
{
  const FemurPhantom femur;
  const Vector3      x = femur.ClosestPoint(PhantomModel::Periosteal,
                                       femur.GetShaftCentre(-150.0) - Vector3(femur.GetParameters().shaftRadius, 0, 0));
  const auto         materials = femur.EvaluateMaterials(x, femur.EvaluateLevels(x));
  const double       mean = 0.5 * (materials[0] + materials[1]);
  EXPECT_NEAR(femur.BlurredDensity(x, Oblique(), { 0.3, 0.3, 0.45 }), mean, 16.0);
  EXPECT_NEAR(femur.BlurredDensity(x, Oblique(), { 0.1, 0.4, 0.2 }), mean, 16.0);
}

TEST(PhantomNoise, IsStandardNormal)
{
  constexpr int count = 200000;
  double        sum = 0.0, squares = 0.0, fourth = 0.0, neighbours = 0.0, before = 0.0;
  for (int n = 0; n < count; ++n)
  {
    const double value = PhantomNoise(5, n);
    sum += value;
    squares += value * value;
    fourth += value * value * value * value;
    neighbours += value * before;
    before = value;
  }
  EXPECT_NEAR(sum / count, 0.0, 0.01);
  EXPECT_NEAR(squares / count, 1.0, 0.015);
  EXPECT_NEAR(fourth / count, 3.0, 0.15);
  EXPECT_NEAR(neighbours / count, 0.0, 0.01);
  EXPECT_NE(PhantomNoise(1, 0), PhantomNoise(2, 0));
}
} // namespace PhantomSamplerTests
