/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneDensityEvaluation.h"

#include "boneDensityRaster.h"
#include "boneTestBodies.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>

namespace DensityEvaluationTests
{
using namespace bone;

double
Linear(const Vector3 & x)
{
  return 100 + 3 * x[0] - 2 * x[1] + 5 * x[2];
}

MeshArrays
Tube(int degree)
{
  test::TubeShape shape;
  shape.seed = 11;
  MeshArrays mesh = test::MakeTube(shape);
  test::SetDensity(mesh, degree, Linear);
  return mesh;
}

/** An oblique, anisotropic grid that covers the mesh. */
VoxelGrid
ObliqueGrid(const MeshArrays & mesh)
{
  VoxelGrid grid;
  grid.axes = Eigen::AngleAxisd(0.4, Vector3(1, 2, -1).normalized()).toRotationMatrix() *
              Eigen::DiagonalMatrix<double, 3>(0.9, 1.3, 0.7);
  Vector3 lower = Vector3::Constant(1e9), upper = Vector3::Constant(-1e9);
  for (const Vector3 & p : mesh.points)
  {
    const Vector3 index = grid.axes.inverse() * p;
    lower = lower.cwiseMin(index);
    upper = upper.cwiseMax(index);
  }
  grid.origin = grid.axes * (lower - Vector3(2.3, 1.7, 3.1));
  for (int axis = 0; axis < 3; ++axis)
  {
    grid.size[axis] = static_cast<int>(upper[axis] - lower[axis]) + 6;
  }
  return grid;
}

TEST(DensityRaster, AgreesWithTheLocatorAtEveryVoxelOfAnObliqueGrid)
{
  const MeshArrays    mesh = Tube(2);
  const VoxelGrid     grid = ObliqueGrid(mesh);
  const TetraLocator  locator(mesh);
  const DensityRaster raster(mesh, grid);
  std::vector<double> values(static_cast<std::size_t>(grid.size[0]) * grid.size[1]);
  std::vector<IdType> cells(values.size());
  std::size_t         inside = 0;
  for (int k = 0; k < grid.size[2]; ++k)
  {
    raster.FillSlice(k, -1e6, values.data(), cells.data());
    for (int j = 0; j < grid.size[1]; ++j)
    {
      for (int i = 0; i < grid.size[0]; ++i)
      {
        const std::size_t  at = static_cast<std::size_t>(j) * grid.size[0] + i;
        const CellLocation place = locator.Find(grid.Centre(i, j, k));
        ASSERT_EQ(cells[at], place.cell);
        ASSERT_NEAR(values[at], place.Found() ? DensityAt(mesh, place) : -1e6, 1e-9);
        inside += place.Found() ? 1 : 0;
      }
    }
  }
  EXPECT_GT(inside, 1000u);
}

TEST(DensityRaster, LeavesNoGapAndTakesTheLowestCellOnSharedFaces)
{
  // Voxel centres fall on the cube's vertices, edges and faces.
  MeshArrays mesh;
  for (int v = 0; v < 8; ++v)
  {
    mesh.points.emplace_back(4 * (v & 1), 2 * (v & 2), v & 4);
  }
  mesh.tetrahedra = { { 0, 3, 5, 6 }, { 0, 1, 3, 5 }, { 0, 2, 3, 6 }, { 0, 4, 5, 6 }, { 3, 5, 6, 7 } };
  test::MakePositive(mesh);
  mesh.maximumDegree = 0;
  mesh.degree.assign(5, 0);
  mesh.coefficients = { 0, 1, 2, 3, 4 };
  VoxelGrid grid;
  grid.size = { 5, 5, 5 };
  const TetraLocator  locator(mesh);
  std::vector<double> values(25);
  for (int k = 0; k < 5; ++k)
  {
    DensityRaster(mesh, grid).FillSlice(k, -1, values.data());
    for (int v = 0; v < 25; ++v)
    {
      EXPECT_EQ(values[v], locator.Find(grid.Centre(v % 5, v / 5, k)).cell);
    }
  }
}

TEST(DensityRaster, RefusesAMeshWithoutDensityAndASingularGrid)
{
  MeshArrays mesh = Tube(1);
  VoxelGrid  grid;
  grid.axes.setZero();
  EXPECT_THROW(DensityRaster(mesh, grid), std::invalid_argument);
  mesh.maximumDegree = -1;
  EXPECT_THROW(DensityRaster(mesh, VoxelGrid()), std::invalid_argument);
}

TEST(DensityEvaluation, ALinearDensityHasItsValueAndGradientEverywhere)
{
  for (int degree : { 1, 3 })
  {
    const MeshArrays   mesh = Tube(degree);
    const TetraLocator locator(mesh);
    for (std::size_t p = 0; p < mesh.points.size(); p += 5)
    {
      const CellLocation place = locator.Find(0.9 * mesh.points[p] + 0.1 * mesh.points[mesh.points.size() / 2]);
      if (place.Found())
      {
        const Vector3 x = 0.9 * mesh.points[p] + 0.1 * mesh.points[mesh.points.size() / 2];
        EXPECT_NEAR(DensityAt(mesh, place), Linear(x), 1e-10);
        EXPECT_LT((DensityGradientAt(mesh, place) - Vector3(3, -2, 5)).norm(), 1e-9);
      }
    }
  }
}

TEST(DensityEvaluation, RegionsHaveTheirVolumeMassMeanAndDeviation)
{
  // Cell 0 is a corner of a cube with density x: known moments of a tetrahedron. Region 2 is constant.
  MeshArrays mesh;
  mesh.points = { { 0, 0, 0 }, { 2, 0, 0 }, { 0, 2, 0 }, { 0, 0, 2 }, { 2, 2, 2 } };
  mesh.tetrahedra = { { 0, 1, 2, 3 }, { 1, 2, 3, 4 } };
  test::MakePositive(mesh);
  mesh.region = { 1, 2 };
  mesh.maximumDegree = 2;
  mesh.degree = { 1, 0 };
  mesh.coefficients.assign(20, 0.0);
  mesh.coefficients[1] = 2; // x at vertex 1
  mesh.coefficients[10] = 7;
  const auto regions = MeasureRegions(mesh);
  ASSERT_EQ(regions.size(), 2u);
  EXPECT_EQ(regions[0].region, 1);
  EXPECT_EQ(regions[0].tetrahedra, 1u);
  EXPECT_NEAR(regions[0].volume, 8.0 / 6, 1e-14);
  EXPECT_NEAR(regions[0].mean, 0.5, 1e-14);
  EXPECT_NEAR(regions[0].mass, 8.0 / 12, 1e-14);
  EXPECT_NEAR(regions[0].standardDeviation, std::sqrt(4 * 3.0 / 80), 1e-14); // variance of one mu is 3/80
  EXPECT_NEAR(regions[1].mean, 7, 1e-14);
  EXPECT_NEAR(regions[1].standardDeviation, 0, 1e-14);
}

TEST(DensityEvaluation, ComparisonMatchesADirectSumOverTheVoxels)
{
  const MeshArrays   mesh = Tube(1);
  const VoxelGrid    grid = ObliqueGrid(mesh);
  const TetraLocator locator(mesh);
  const auto         centre = [&grid](std::size_t offset) {
    const auto nx = static_cast<std::size_t>(grid.size[0]), ny = static_cast<std::size_t>(grid.size[1]);
    return grid.Centre(
      static_cast<int>(offset % nx), static_cast<int>(offset / nx % ny), static_cast<int>(offset / nx / ny));
  };
  const VoxelReference reference = [&](std::size_t offset, double & value) {
    value = Linear(centre(offset)) + (offset % 2 == 0 ? 1.0 : -3.0);
    return offset % 5 != 0;
  };
  const DensityComparison found = CompareDensity(mesh, grid, reference);
  std::vector<double>     truth;
  std::size_t             uncovered = 0;
  double                  absolute = 0, bias = 0;
  for (std::size_t offset = 0; offset < grid.NumberOfVoxels(); ++offset)
  {
    double value;
    if (reference(offset, value))
    {
      if (!locator.Find(centre(offset)).Found())
      {
        ++uncovered;
        continue;
      }
      truth.push_back(value);
      absolute += std::abs(Linear(centre(offset)) - value);
      bias += Linear(centre(offset)) - value;
    }
  }
  const auto n = static_cast<double>(truth.size());
  EXPECT_EQ(found.voxels, truth.size());
  EXPECT_EQ(found.uncovered, uncovered);
  EXPECT_NEAR(found.meanAbsolute, absolute / n, 1e-9);
  EXPECT_NEAR(found.bias, bias / n, 1e-9);
  std::sort(truth.begin(), truth.end());
  const auto percentile = [&](double q) {
    const double at = q * (n - 1);
    const auto   i = static_cast<std::size_t>(at);
    return truth[i] + (at - static_cast<double>(i)) * (truth[i + 1] - truth[i]);
  };
  EXPECT_NEAR(found.range, percentile(0.99) - percentile(0.01), 1e-3);
  EXPECT_NEAR(found.meanAbsolutePercent, 100 * found.meanAbsolute / found.range, 1e-12);
  // |difference| is 1 or 3.
  const double threes = (found.meanAbsolute - 1) / 2;
  EXPECT_NEAR(found.standardDeviation, 2 * std::sqrt(threes * (1 - threes)), 1e-9);
  EXPECT_NEAR(found.rootMeanSquare, std::sqrt(1 + 8 * threes), 1e-9);
}

TEST(DensityEvaluation, ComparisonOfNothingIsZero)
{
  const MeshArrays mesh = Tube(1);
  const auto       none = CompareDensity(mesh, ObliqueGrid(mesh), [](std::size_t, double &) { return false; });
  EXPECT_EQ(none.voxels, 0u);
  EXPECT_EQ(none.meanAbsolute, 0);
}
TEST(DensityProfile, OfALinearDensityIsThatLineInsideAndNothingOutside)
{
  const MeshArrays   mesh = Tube(3);
  const TetraLocator locator(mesh);
  Vector3            middle = Vector3::Zero();
  for (const IdType p : mesh.tetrahedra[0])
  {
    middle += 0.25 * mesh.points[p];
  }
  const Vector3 from = middle - Vector3(200, 0, 0), to = middle + Vector3(200, 0, 0);
  const auto    profile = DensityProfile(mesh, locator, from, to, 2001);
  std::size_t   inside = 0;
  for (const DensityProfilePoint & p : profile)
  {
    EXPECT_NEAR(p.distance, (p.point - from).norm(), 1e-9);
    if (p.cell < 0)
    {
      EXPECT_TRUE(std::isnan(p.value) && std::isnan(p.gradient[0]));
      continue;
    }
    ++inside;
    EXPECT_NEAR(p.value, Linear(p.point), 1e-8);
    EXPECT_LT((p.gradient - Vector3(3, -2, 5)).norm(), 1e-8);
  }
  EXPECT_GT(inside, 3u);
  EXPECT_LT(inside, profile.size());
  EXPECT_THROW(DensityProfile(mesh, locator, from, to, 1), std::invalid_argument);
}
} // namespace DensityEvaluationTests
