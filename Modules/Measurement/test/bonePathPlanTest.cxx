/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "bonePathPlan.h"

#include "boneDensityTestMeshes.h"
#include "boneTestBodies.h"

#include <itkMultiThreaderBase.h>

#include <gtest/gtest.h>

#include <cmath>

namespace PathPlanTests
{
using namespace bone;

/** 40 x 40 x 60 mm about the origin; denser toward x = 6, y = -4, like a bundle of trabeculae along z. */
const MeshArrays &
Block()
{
  static const MeshArrays mesh = [] {
    MeshArrays block = test::MakeBlock({ 10, 10, 15 }, Vector3(-20, -20, -30), 4.0, 0.0);
    block.neighbors = ComputeFaceNeighbors(block.tetrahedra);
    test::SetDensity(
      block, 1, [](const Vector3 & x) { return 500.0 - 2.0 * (x - Vector3(6, -4, x.z())).squaredNorm(); });
    return block;
  }();
  return mesh;
}

TEST(PathPlan, PercentilesAreLinearBetweenValues)
{
  EXPECT_EQ(Percentile({ 1, 2, 4 }, 0.5), 2.0);
  EXPECT_EQ(Percentile({ 1, 2, 4 }, 0.75), 3.0);
  EXPECT_EQ(Percentile({ 1, 2, 4 }, 1.0), 4.0);
  EXPECT_EQ(Percentile({ 7 }, 0.3), 7.0);
  EXPECT_TRUE(std::isnan(Percentile({}, 0.3)));
}

TEST(PathPlan, ClearanceAndBreakthroughAreThoseOfTheBlock)
{
  const PathPlanner planner(Block());
  // Enters through the upper face and ends 10 mm above the lower one.
  const auto inside = planner.Assess({ Vector3(0, 0, 35), Vector3(0, 0, -20), 3.0 }, 2.0, 2.0);
  EXPECT_NEAR(inside.entry, 10.0, 0.3);          // 5 mm to the face, and 3 + 2 below it
  EXPECT_NEAR(inside.leastClearance, 7.0, 1e-9); // of the tip
  EXPECT_TRUE(std::isnan(inside.breakthrough));
  EXPECT_TRUE(inside.IsSafe(2.0));
  EXPECT_NEAR(inside.boneShare, 50.0 / 55.0, 1e-9);
  EXPECT_EQ(inside.along.size(), 50u * 24u);
  EXPECT_EQ(inside.around.size(), 50u * 24u);
  // Through both faces.
  const auto through = planner.Assess({ Vector3(0, 0, 35), Vector3(0, 0, -40), 3.0 }, 2.0, 2.0);
  EXPECT_NEAR(through.breakthrough, 35.0 + 30.0 - 3.0, 0.3);
  EXPECT_NEAR(through.leastClearance, -13.0, 1e-9);
  EXPECT_FALSE(through.IsSafe(2.0));
  // Along a face.
  const auto beside = planner.Assess({ Vector3(18, 0, 20), Vector3(18, 0, -20), 3.0 }, 2.0, 2.0);
  EXPECT_TRUE(std::isnan(beside.entry));
  EXPECT_FALSE(beside.IsSafe(0.0));
  EXPECT_FALSE(beside.IsSafe(-10.0));
}

TEST(PathPlan, DensitiesOfALinearFieldAreThoseOfTheAxis)
{
  MeshArrays mesh = Block();
  test::SetDensity(mesh, 1, [](const Vector3 & x) { return 300.0 + 4.0 * x.z() + 3.0 * x.x(); });
  const auto found = PathPlanner(mesh).Assess({ Vector3(2, 0, 20), Vector3(2, 0, -10), 3.0 }, 2.0, 2.0);
  double     along = 0.0, around = 0.0;
  for (const double value : found.along)
  {
    along += value / static_cast<double>(found.along.size());
  }
  for (const double value : found.around)
  {
    around += value / static_cast<double>(found.around.size());
  }
  EXPECT_NEAR(along, 300.0 + 4.0 * 5.0 + 6.0, 1e-9);
  EXPECT_NEAR(around, along, 1e-9);
  EXPECT_TRUE(std::is_sorted(found.along.begin(), found.along.end()));
}

TEST(PathPlan, ASearchFindsTheBundleAndStaysWithinItsBounds)
{
  const PathPlanner  planner(Block());
  const Capsule      start{ Vector3(2, 0, 32), Vector3(2, 0, 8), 3.0 };
  PathPlanParameters parameters;
  Capsule            best;
  ASSERT_TRUE(planner.Search(start, parameters, best));
  EXPECT_NEAR(best.from.x(), 6.0, 0.7);
  EXPECT_NEAR(best.from.y(), -4.0, 0.7);
  EXPECT_NEAR((best.to - best.from).head<2>().norm(), 0.0, 1.5);
  EXPECT_LE(std::abs((best.to - best.from).norm() - 24.0), parameters.searchDepth + 1e-9);
  EXPECT_TRUE(planner.Assess(best, parameters.margin, parameters.shell).IsSafe(parameters.margin));
  EXPECT_GT(planner.Assess(best, 2.0, 2.0).MeanAround(), planner.Assess(start, 2.0, 2.0).MeanAround());
  parameters.searchShift = 1.0;
  parameters.searchAngle = 0.0;
  ASSERT_TRUE(planner.Search(start, parameters, best));
  EXPECT_NEAR((best.from - start.from).head<2>().cwiseAbs().maxCoeff(), 1.0, 1e-9);
  EXPECT_NEAR((best.to - best.from).normalized().z(), -1.0, 1e-12);
}

TEST(PathPlan, ASearchKeepsTheMarginWhereTheDensestBoneIsAtTheSurface)
{
  MeshArrays mesh = Block();
  test::SetDensity(mesh, 1, [](const Vector3 & x) { return 300.0 + 10.0 * x.x(); });
  const PathPlanner  planner(mesh);
  PathPlanParameters parameters;
  parameters.searchAngle = 0.0;
  parameters.searchShift = 8.0;
  Capsule best;
  ASSERT_TRUE(planner.Search({ Vector3(9, 0, 32), Vector3(9, 0, 8), 3.0 }, parameters, best));
  EXPECT_LE(best.from.x(), 15.0 + 1e-9); // radius 3 and margin 2 from the face at 20
  EXPECT_GE(best.from.x(), 14.5);
  Capsule none;
  EXPECT_FALSE(planner.Search({ Vector3(100, 0, 32), Vector3(100, 0, -12), 3.0 }, parameters, none));
  EXPECT_EQ(none.from.x(), 100.0);
}

TEST(PathPlan, DoesNotDependOnTheNumberOfThreads)
{
  const PathPlanner planner(Block());
  const Capsule     start{ Vector3(2, 0, 32), Vector3(2, 0, 8), 3.0 };
  const auto        before = itk::MultiThreaderBase::GetGlobalDefaultNumberOfThreads();
  Capsule           one, four;
  itk::MultiThreaderBase::SetGlobalDefaultNumberOfThreads(1);
  planner.Search(start, PathPlanParameters(), one);
  itk::MultiThreaderBase::SetGlobalDefaultNumberOfThreads(4);
  planner.Search(start, PathPlanParameters(), four);
  itk::MultiThreaderBase::SetGlobalDefaultNumberOfThreads(before);
  EXPECT_EQ(one.from, four.from);
  EXPECT_EQ(one.to, four.to);
}

TEST(PathPlan, MeasuresSayWhatWasFound)
{
  const auto list =
    PlanPath(Block(), { Vector3(0, 0, 35), Vector3(0, 0, 5), 3.0 }, true, PathPlanParameters(), "screw");
  const auto find = [&list](const std::string & name) {
    const auto at =
      std::find_if(list.measures.begin(), list.measures.end(), [&](const Measure & m) { return m.name == name; });
    return at == list.measures.end() ? Measure() : *at;
  };
  EXPECT_EQ(find("screw.search").text, "found");
  EXPECT_EQ(find("screw.safe").text, "yes");
  EXPECT_EQ(find("screw.densityAlongPercentiles").value.size(), 5u);
  EXPECT_GT(find("screw.volume").value.at(0), 400.0);
  const auto lacks = [&list](const std::string & name) {
    return std::any_of(
      list.missing.begin(), list.missing.end(), [&](const MissingMeasure & missing) { return missing.name == name; });
  };
  EXPECT_TRUE(lacks("screw.breakthrough"));
  EXPECT_FALSE(lacks("screw.entry"));
}

TEST(PathPlan, RefusesWhatIsNoPathAndAModelWithoutDensity)
{
  const PathPlanner planner(Block());
  EXPECT_THROW(planner.Assess({ Vector3::Zero(), Vector3::Zero(), 1.0 }, 1.0, 1.0), std::invalid_argument);
  EXPECT_THROW(PathPlanner(test::MakeTube({})), std::invalid_argument);
}
} // namespace PathPlanTests
