/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneEnhancedSmoothing.h"

#include "../../Core/test/boneTestBodies.h"

#include <gtest/gtest.h>

using namespace bone;

namespace EnhancedSmoothingTests
{
constexpr IdType Inner = 0;

/** A cone with a deep conical pit in its top, around one inner point at the origin, which sees the pit's tip at z = 0.5
 * and has eight of its ten neighbours on the rim at z = 4: their mean, at z = 3.15, lies far outside. */
MeshArrays
HollowCone()
{
  MeshArrays mesh;
  mesh.points = { { 0, 0, 0 }, { 0, 0, 0.5 }, { 0, 0, -1 } };
  for (int i = 0; i < 8; ++i)
  {
    const double angle = i * std::acos(-1.0) / 4;
    mesh.points.push_back({ 4 * std::cos(angle), 4 * std::sin(angle), 4 });
    for (IdType tip : { 1, 2 })
    {
      mesh.tetrahedra.push_back({ Inner, tip, 3 + i, 3 + (i + 1) % 8 });
    }
  }
  test::MakePositive(mesh);
  return mesh;
}

/** z of the inner point after one iteration. */
double
HeightAfter(double weight, SmoothingReport & report)
{
  TetraComplex             complex(HollowCone());
  PointMover               mover(complex);
  const SurfaceTarget      target(complex, 0.0, 0);
  TetraSmoothingParameters parameters;
  parameters.weight = weight;
  parameters.angleFloor = 0.0;
  EnhancedIteration(complex, mover, target, parameters, SurfaceMotion::None, report);
  EXPECT_NEAR(complex.Points()[Inner].head<2>().norm(), 0.0, 1e-12);
  return complex.Points()[Inner].z();
}

TEST(EnhancedIteration, EachStepBackKeepsTheWeightsShareOfTheOldPlace)
{
  // A quarter of the way is left by each step back: 0.7875 lies beyond the pit's tip, 0.196875 does not.
  SmoothingReport report;
  EXPECT_NEAR(HeightAfter(0.75, report), 3.15 / 16, 1e-12);
  EXPECT_EQ(report.moves, 1u);
  EXPECT_EQ(report.weighted, 1u);
}

TEST(EnhancedIteration, APointStaysWhereNoStepBackIsFarEnough)
{
  // After six steps nine tenths of the way are left each time: 3.15 * 0.9^6 is 1.67.
  SmoothingReport report;
  EXPECT_EQ(HeightAfter(0.1, report), 0.0);
  EXPECT_EQ(report.moves, 0u);
  EXPECT_EQ(report.refused[static_cast<int>(MeshOperation::Orientation)], 1u);
}
} // namespace EnhancedSmoothingTests
