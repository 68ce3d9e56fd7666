/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneFitDensity.h"

#include "boneCellVoxels.h"
#include "boneDensityTestMeshes.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace FitDensityTests
{
using namespace bone;

/** A tetrahedron of 121.5 mm^3 with the centres of 120 voxels of 1 mm: all that are at least (1, 1, 1) with a sum of at
 * most 10. */
MeshArrays
Corner()
{
  MeshArrays mesh;
  mesh.points = { { 0.5, 0.5, 0.5 }, { 9.5, 0.5, 0.5 }, { 0.5, 9.5, 0.5 }, { 0.5, 0.5, 9.5 } };
  mesh.tetrahedra = { { 0, 1, 2, 3 } };
  return mesh;
}

template <typename TFunction>
ImageSampler
Values(TFunction f)
{
  return [f](const Vector3 * indices, std::size_t count, double * values) {
    std::transform(indices, indices + count, values, f);
  };
}

/** An image of 10^3 voxels that is 0 between them: what it is fitted to is known without interpolation. */
DensityFitImage
ZeroBetween(ImageSampler voxels)
{
  DensityFitImage image;
  image.grid.size = { { 10, 10, 10 } };
  image.grid.origin = Vector3::Zero();
  image.grid.axes = Eigen::Matrix3d::Identity();
  image.interpolated = Values([](const Vector3 &) { return 0.0; });
  image.voxels = std::move(voxels);
  return image;
}

DensityFitParameters
PlainParameters(int degree)
{
  DensityFitParameters parameters;
  parameters.degree = degree;
  parameters.voxelWeight = 1.0;
  parameters.tikhonov = 0.0;
  return parameters;
}

TEST(FitDensity, VoxelsCountBesideSamplesByTheirNumberAVolume)
{
  MeshArrays mesh = Corner();
  const auto image = ZeroBetween(Values([](const Vector3 &) { return 100.0; }));
  const auto report = FitDensity(mesh, image, PlainParameters(0), Execution());
  EXPECT_EQ(report.voxels, 120u);
  const double share = 120 / 121.5;
  EXPECT_NEAR(mesh.coefficients[0], 100 * share / (share + 1), 1e-9);
}

TEST(FitDensity, VoxelsOfLittleWeightCountLittleBesideSamples)
{
  MeshArrays mesh = Corner();
  auto       image = ZeroBetween(Values([](const Vector3 &) { return 100.0; }));
  image.weights = Values([](const Vector3 &) { return 0.1; });
  FitDensity(mesh, image, PlainParameters(0), Execution());
  const double share = 0.1 * 120 / 121.5;
  EXPECT_NEAR(mesh.coefficients[0], 100 * share / (share + 1), 1e-9);
}

TEST(FitDensity, TheBoundOnTheErrorCountsVoxelsThatSamplesDoNotShow)
{
  // No polynomial follows a chessboard: about half of its mean square of 100^2 is left at any degree.
  const auto image =
    ZeroBetween(Values([](const Vector3 & i) { return std::lround(i.sum()) % 2 == 0 ? 100.0 : -100.0; }));
  DensityFitParameters parameters = PlainParameters(2);
  parameters.maximumError = 40.0;
  MeshArrays mesh = Corner();
  FitDensity(mesh, image, parameters, Execution());
  EXPECT_EQ(mesh.degree[0], 2);
  parameters.maximumError = 80.0;
  FitDensity(mesh, image, parameters, Execution());
  EXPECT_EQ(mesh.degree[0], 0);
}

TEST(FitDensity, OutsideBeginsHalfAVoxelBeyondTheCentres)
{
  const auto outside = [](double lower, double upper) {
    MeshArrays mesh;
    mesh.points = {
      { lower, lower, lower }, { upper, lower, lower }, { lower, upper, lower }, { lower, lower, upper }
    };
    mesh.tetrahedra = { { 0, 1, 2, 3 } };
    return FitDensity(mesh, ZeroBetween(Values([](const Vector3 &) { return 0.0; })), PlainParameters(1), Execution())
      .outside;
  };
  EXPECT_EQ(outside(-0.5, 9.5), 0u);
  EXPECT_GT(outside(-0.5, 12.0), 0u);
  EXPECT_GT(outside(-3.0, 9.5), 0u);
}
} // namespace FitDensityTests
