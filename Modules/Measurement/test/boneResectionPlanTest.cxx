/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneResectionPlan.h"

#include "boneDensityTestMeshes.h"
#include "boneTestBodies.h"
#include "boneTestMeasures.h"

#include <gtest/gtest.h>

namespace ResectionPlanTests
{
using namespace bone;

/** 8 x 12 x 16 mm about the origin, density 100 + 5 x. */
MeshArrays
Beam()
{
  MeshArrays mesh = test::MakeBlock({ 4, 6, 8 }, Vector3(-4, -6, -8), 2.0, 0.1);
  test::SetDensity(mesh, 1, [](const Vector3 & x) { return 100.0 + 5.0 * x.x(); });
  return mesh;
}

TEST(ResectionPlan, ARectangleHasItsMoments)
{
  const auto section = MeasureSection(Beam(), { Vector3(50, 60, 1.3), Vector3::UnitZ() });
  EXPECT_NEAR(section.shape.area, 96.0, 1e-10);
  EXPECT_NEAR((section.shape.centroid - Vector3(0, 0, 1.3)).norm(), 0.0, 1e-10);
  EXPECT_NEAR(section.shape.largest, 8.0 * 12.0 * 12.0 * 12.0 / 12.0, 1e-7);
  EXPECT_NEAR(section.shape.smallest, 12.0 * 8.0 * 8.0 * 8.0 / 12.0, 1e-7);
  EXPECT_NEAR(std::abs(section.shape.largestAxis.x()), 1.0, 1e-9); // bending about x is the stiffest
  // The density's first moment moves its centroid: 5 * 512 over 9600.
  EXPECT_NEAR(section.density.area, 9600.0, 1e-8);
  EXPECT_NEAR(section.density.centroid.x(), 5.0 * 512.0 / 9600.0, 1e-10);
  EXPECT_NEAR(section.density.largest, 100.0 * 1152.0, 1e-5);
  EXPECT_NEAR(section.density.smallest, 100.0 * 512.0 - 9600.0 * std::pow(5.0 * 512.0 / 9600.0, 2), 1e-5);
}

TEST(ResectionPlan, AnObliqueSectionIsLongerAndTheIntegralAlongTheNormalIsTheMass)
{
  MeshArrays mesh = test::MakeTube({});
  test::SetDensity(mesh, 4, [](const Vector3 & x) { return 200.0 + x.x() * x.z() + 30.0 * std::cos(0.3 * x.y()); });
  const Vector3 normal = Vector3(0.3, -0.2, 1.0).normalized();
  // Simpson's rule of the section's integral between two planes, beside the integral between them.
  const double lower = 8.0, upper = 8.001;
  double       sum = 0.0;
  for (const auto & [share, weight] : { std::pair(0.0, 1.0), std::pair(0.5, 4.0), std::pair(1.0, 1.0) })
  {
    sum += weight / 6.0 * MeasureSection(mesh, { (lower + share * (upper - lower)) * normal, normal }).density.area;
  }
  Solid slab = MakeHalfSpace(lower * normal, normal);
  slab.halfSpaces.push_back({ upper * normal, -normal });
  const double mass = IntegrateSolid(mesh, slab).total.mass;
  EXPECT_NEAR(sum * (upper - lower) / mass, 1.0, 1e-6);
}

TEST(ResectionPlan, RemovedAndKeptAddUp)
{
  const MeshArrays mesh = Beam();
  const auto       plan = PlanResection(mesh, Vector3(0, 0, 2), Vector3(0, 0, 3), "r");
  EXPECT_NEAR(ValueOf(plan, "r.removed.volume"), 96.0 * 6.0, 1e-8);
  EXPECT_NEAR(ValueOf(plan, "r.kept.volume"), 96.0 * 10.0, 1e-8);
  EXPECT_NEAR(ValueOf(plan, "r.removed.mass"), 9600.0 * 6.0, 1e-6);
  EXPECT_NEAR(ValueOf(plan, "r.removed.meanDensity"), 100.0, 1e-9);
  EXPECT_NEAR(ValueOf(plan, "r.section.area"), 96.0, 1e-9);
  EXPECT_TRUE(plan.missing.empty());
}

TEST(ResectionPlan, RefusesAPlaneBesideTheBoneAndSaysWhereThereIsNoDensity)
{
  MeshArrays mesh = Beam();
  EXPECT_THROW(PlanResection(mesh, Vector3(0, 0, 9), Vector3::UnitZ()), std::invalid_argument);
  EXPECT_THROW(PlanResection(mesh, Vector3::Zero(), Vector3::Zero()), std::invalid_argument);
  mesh.maximumDegree = -1;
  mesh.coefficients.clear();
  mesh.degree.clear();
  const auto plan = PlanResection(mesh, Vector3::Zero(), Vector3::UnitZ());
  EXPECT_NEAR(ValueOf(plan, "resection.section.area"), 96.0, 1e-9);
  EXPECT_FALSE(plan.missing.empty());
}
} // namespace ResectionPlanTests
