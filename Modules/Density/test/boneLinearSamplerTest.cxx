/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneLinearSampler.h"

#include "boneDensityTestMeshes.h"

#include <itkLinearInterpolateImageFunction.h>

#include <gtest/gtest.h>

namespace LinearSamplerTests
{
using namespace bone;

TEST(LinearSampler, AgreesWithItksLinearInterpolation)
{
  std::mt19937                           random(3);
  std::uniform_real_distribution<double> uniform(0, 1);
  const auto image = test::ObliqueImage<test::Image>([&](const Vector3 &) { return 1000 * uniform(random); });
  const auto region = image->GetBufferedRegion();
  const LinearSampler<float> sampler(image->GetBufferPointer(), MakeVoxelGrid(*image, region).size);
  auto                       interpolator = itk::LinearInterpolateImageFunction<test::Image>::New();
  interpolator->SetInputImage(image);
  for (int trial = 0; trial < 5000; ++trial)
  {
    Vector3                         index;
    itk::ContinuousIndex<double, 3> itkIndex;
    for (unsigned int axis = 0; axis < 3; ++axis)
    {
      index[axis] = uniform(random) * (static_cast<double>(region.GetSize(axis)) - 1);
      itkIndex[axis] = index[axis] + static_cast<double>(region.GetIndex(axis));
    }
    EXPECT_NEAR(sampler(index), interpolator->EvaluateAtContinuousIndex(itkIndex), 1e-9);
  }
}

TEST(LinearSampler, TakesTheNearestValueBeyondTheOutermostCentres)
{
  const std::array<float, 8> voxels = { { 0, 1, 2, 3, 4, 5, 6, 7 } };
  const LinearSampler<float> sampler(voxels.data(), { { 2, 2, 2 } });
  EXPECT_EQ(sampler({ -5, 0.5, 0 }), 1);
  EXPECT_EQ(sampler({ 1.4, 9, 1 }), 7);
  EXPECT_EQ(sampler({ 1, 1, 1 }), 7);
}

TEST(LinearSampler, TakesAnImageOneVoxelThick)
{
  const std::array<float, 2> voxels = { { 10, 20 } };
  EXPECT_EQ(LinearSampler<float>(voxels.data(), { { 2, 1, 1 } })({ 0.5, 0.3, -0.2 }), 15);
  EXPECT_EQ(LinearSampler<float>(voxels.data(), { { 1, 1, 2 } })({ 0, 0, 0.25 }), 12.5);
}
} // namespace LinearSamplerTests
