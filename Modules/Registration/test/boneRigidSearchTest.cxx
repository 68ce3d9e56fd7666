/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneRigidSearch.h"

#include "boneRegistrationTestBody.h"
#include "boneRigidRegistration.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <random>

namespace RigidSearchTests
{
using namespace bone;
using namespace bone::test;

const RigidPose Start = PoseOf(0, 0, 0, 0, 0, 0);

RigidRadiographParameters
Parameters(int searches)
{
  RigidRadiographParameters parameters;
  parameters.searchPixels = 48;
  parameters.pixels = 96;
  parameters.population = 20;
  parameters.searches = searches;
  return parameters;
}

RigidRegistrationResult
Search(const std::vector<RadiographView> & views, const RigidRadiographParameters & parameters)
{
  return SearchRigid({ Body(12), Body(8) }, views, Start, parameters, Execution(), {});
}

TEST(RigidSearch, WhereAllIsHopelessTheBestIsRefinedToTheEnd)
{
  std::vector<RadiographView>           views = TwoXRays(Body(8), Start);
  std::mt19937                          random(3);
  std::uniform_real_distribution<float> uniform(0.0f, 100.0f);
  for (RadiographView & view : views)
  {
    std::generate(view.values.begin(), view.values.end(), [&] { return uniform(random); });
  }
  const auto              result = Search(views, Parameters(2));
  RigidRegistrationResult judged = result;
  JudgePose(Body(12), views, Parameters(2), Execution(), judged);
  EXPECT_EQ(result.searches, 2);
  EXPECT_EQ(result.quality, RegistrationQuality::Failed);
  EXPECT_EQ(result.cost, judged.cost);
  EXPECT_EQ(result.distinctness, judged.distinctness);
}

TEST(RigidSearch, OneViewMustBeMoreDistinctThanTwo)
{
  // Noise takes the distinctness from where both are ok to where neither is.
  const RigidPose truth = PoseOf(4, -3, 5, 0.1, 0.05, -0.1);
  std::size_t     between = 0;
  for (float noise = 0.0f; noise < 1.0f; noise += 0.04f)
  {
    std::vector<RadiographView> views = TwoXRays(Body(12), truth);
    AddNoise(views, noise);
    for (const bool single : { false, true })
    {
      views.resize(single ? 1 : 2);
      RigidRegistrationResult judged;
      judged.pose = truth;
      JudgePose(Body(12), views, Parameters(1), Execution(), judged);
      const bool loose = !single && judged.leastDistinctness < 0.28 * judged.distinctness;
      const bool ok = judged.distinctness >= (single ? 0.45 : 0.38) && !loose;
      EXPECT_EQ(judged.quality == RegistrationQuality::Ok, ok) << judged.distinctness << (single ? ", one view" : "");
      between += judged.distinctness >= 0.38 && judged.distinctness < 0.45 ? 1 : 0;
    }
  }
  EXPECT_GE(between, 3u);
}

TEST(RigidSearch, APoseThatIsNotDistinctIsOkWhenThreeSearchesFoundIt)
{
  const RigidPose truth = PoseOf(4, -3, 5, 0.1, 0.05, -0.1);
  // Noise makes the true pose less distinct.
  std::vector<RadiographView> views = TwoXRays(Body(12), truth);
  AddNoise(views, 0.62f);
  RigidRegistrationResult judged;
  judged.pose = truth;
  JudgePose(Body(12), views, Parameters(1), Execution(), judged);
  ASSERT_EQ(judged.quality, RegistrationQuality::Suspect) << judged.distinctness;
  // Images about as fine before the last step: on coarser ones noise is less, and the pose clear.
  RigidRadiographParameters twice = Parameters(2), dozen = Parameters(12);
  twice.searchPixels = dozen.searchPixels = 80;
  const auto once = Search(views, twice), often = Search(views, dozen);
  EXPECT_EQ(once.quality, RegistrationQuality::Suspect);
  EXPECT_EQ(often.quality, RegistrationQuality::Ok);
  EXPECT_GE(often.searches, 3);
  EXPECT_LT(LargestDistance(Body(12), often.pose, truth), 1.0);
}

TEST(RigidSearch, APoseThatIsNotClearIsFoundTwice)
{
  const RigidPose             truth = PoseOf(4, -3, 5, 0.1, 0.05, -0.1);
  std::vector<RadiographView> views = TwoXRays(Body(12), truth);
  AddNoise(views, 0.42f);
  RigidRadiographParameters dozen = Parameters(12);
  dozen.searchPixels = 80;
  const auto result = Search(views, dozen);
  ASSERT_GT(result.distinctness, 0.55);
  ASSERT_LT(result.distinctness, 0.75);
  EXPECT_EQ(result.quality, RegistrationQuality::Ok);
  EXPECT_GE(result.searches, 2);
  EXPECT_LT(LargestDistance(Body(12), result.pose, truth), 1.0);
  // Nothing else can be asked of a single search.
  dozen.searches = 1;
  EXPECT_EQ(Search(views, dozen).quality, RegistrationQuality::Ok);
}

TEST(RigidSearch, APoseThatOneOfTwoSearchesFoundIsSuspect)
{
  const RigidPose             truth = PoseOf(4, -3, 5, 0.1, 0.05, -0.1);
  std::vector<RadiographView> views = TwoXRays(Body(12), truth);
  AddNoise(views, 0.42f);
  int lost = 0;
  for (int seed = 1; seed <= 10; ++seed)
  {
    RigidRadiographParameters one = Parameters(1);
    one.searchPixels = 80;
    one.population = 6;
    one.seed = seed;
    RigidRadiographParameters two = one;
    two.searches = 2;
    const bool isFirstRight = LargestDistance(Body(12), Search(views, one).pose, truth) < 3.0;
    const auto result = Search(views, two);
    const bool isFound = LargestDistance(Body(12), result.pose, truth) < 3.0;
    lost += !isFirstRight && isFound ? 1 : 0;
    EXPECT_TRUE(isFirstRight || result.quality != RegistrationQuality::Ok) << "seed " << seed;
  }
  EXPECT_GT(lost, 0) << "of the first searches, where the second one found the pose";
}

TEST(RigidSearch, WhatDoesNotShowIsNoMatterOfTheJudgement)
{
  const MeshArrays body = WithTail(Body(12));
  MeshArrays       longer = body;
  for (Vector3 & x : longer.points)
  {
    x.z() -= x.z() < -60.0 ? 2.0 * (-60.0 - x.z()) : 0.0;
  }
  auto views = TwoXRays(body, Start);
  AddNoise(views, 0.2f);
  RigidRegistrationResult judged[2];
  for (int i = 0; i < 2; ++i)
  {
    judged[i].pose = Start;
    JudgePose(i == 0 ? body : longer, views, Parameters(1), Execution(), judged[i]);
  }
  EXPECT_NEAR(judged[0].distinctness, judged[1].distinctness, 0.05 * judged[0].distinctness);
}

TEST(RigidSearch, AClearPoseIsLeftToTheLastAdjustment)
{
  const RigidPose truth = PoseOf(4, -3, 5, 0.1, 0.05, -0.1);
  const auto      views = TwoXRays(Body(12), truth);
  const auto      result = Search(views, Parameters(3));
  EXPECT_EQ(result.quality, RegistrationQuality::Ok);
  EXPECT_EQ(result.searches, 1);
  EXPECT_LT(LargestDistance(Body(12), result.pose, truth), 2.0);
  // It was judged on smaller images.
  RigidRegistrationResult judged = result;
  JudgePose(Body(12), views, Parameters(3), Execution(), judged);
  EXPECT_NE(result.cost, judged.cost);
  // Beyond what was to be searched it is not clear.
  RigidRadiographParameters narrow = Parameters(1);
  narrow.searchTranslation = 4.5;
  EXPECT_EQ(Search(views, narrow).quality, RegistrationQuality::Suspect);
}

/** Largest distance between two poses of what lies above the middle. */
double
DistanceAbove(const MeshArrays & mesh, const RigidPose & a, const RigidPose & b)
{
  MeshArrays above = mesh;
  above.points.clear();
  std::copy_if(mesh.points.begin(), mesh.points.end(), std::back_inserter(above.points), [](const Vector3 & x) {
    return x.z() >= Start.centre.z();
  });
  return LargestDistance(above, a, b);
}

TEST(RigidSearch, TurnsWhatTheViewsShow)
{
  // Turns about the centre of all of it move what shows farther than is searched.
  const MeshArrays          tailed = WithTail(Body(12));
  RigidRadiographParameters parameters = Parameters(3);
  parameters.searchTranslation = 8.0;
  for (const double turn : { -0.3, 0.3 })
  {
    const RigidPose truth = PoseOf(4, -3, 5, turn, -turn, 0.1);
    const auto      result = SearchRigid({ tailed }, TwoXRays(tailed, truth), Start, parameters, Execution(), {});
    EXPECT_LT(DistanceAbove(tailed, result.pose, truth), 1.5) << turn;
    EXPECT_EQ(result.quality, RegistrationQuality::Ok) << turn;
  }
}

/** A bent rod about (10, 20, 30), 100 mm long, along z; `bend` mm towards y at its ends. */
MeshArrays
Rod(double bend)
{
  MeshArrays rod = BallMesh(10, Vector3::Zero(), 1.0);
  for (Vector3 & p : rod.points)
  {
    p = Start.centre + Vector3(7 * p.x(), 9 * p.y() + bend * p.z() * p.z(), 50 * p.z());
  }
  rod.maximumDegree = 0;
  rod.degree.assign(rod.tetrahedra.size(), 0);
  rod.coefficients.assign(rod.tetrahedra.size(), 600.0);
  return rod;
}

/** Of an X-ray along y of the rod in this pose, with noise. */
RigidRegistrationResult
SearchRod(double bend, const RigidPose & truth, const RigidPose & start, const RigidRadiographParameters & parameters)
{
  auto                            xray = XRayOf(Rod(bend), ViewOf({ 0, 1, 0 }), truth);
  std::mt19937                    random(3);
  std::normal_distribution<float> normal(0.0f, 0.05f * *std::max_element(xray.values.begin(), xray.values.end()));
  for (float & x : xray.values)
  {
    x += normal(random);
  }
  return SearchRigid({ Rod(bend) }, { xray }, start, parameters, Execution(), {});
}

TEST(RigidSearch, FromOneViewOtherTiltsAreTried)
{
  RigidRadiographParameters refined = Parameters(1);
  refined.searchTranslation = refined.searchRotation = 0.0;
  const RigidPose truth = PoseOf(0, 0, 0, 0.35, 0, 0), mirrored = PoseOf(0, 0, 0, -0.35, 0, 0);
  const auto      result = SearchRod(6.0, truth, mirrored, refined);
  EXPECT_LT((result.pose.rotation.transpose() * truth.rotation - Eigen::Matrix3d::Identity()).norm(), 0.05);
  EXPECT_EQ(result.quality, RegistrationQuality::Ok);
  EXPECT_FALSE(result.ambiguous);
}

TEST(RigidSearch, APoseOfOneViewIsAmbiguousWhereAnotherTiltFitsAsWell)
{
  const auto straight = SearchRod(0.0, PoseOf(0, 0, 0, 0.175, 0, 0), Start, Parameters(1));
  EXPECT_TRUE(straight.ambiguous);
  EXPECT_EQ(straight.quality, RegistrationQuality::Suspect) << straight.distinctness;
}

TEST(RigidSearch, ABoneSeenAlongItsLongestAxisHasNoOtherTilts)
{
  RigidRadiographParameters refined = Parameters(1);
  refined.searchTranslation = refined.searchRotation = 0.0;
  const RigidPose endOn = PoseOf(0, 0, 0, 0.5 * std::acos(-1.0), 0, 0);
  const auto      result = SearchRod(0.0, endOn, endOn, refined);
  EXPECT_FALSE(result.ambiguous);
  EXPECT_TRUE(result.pose.translation.allFinite());
}

TEST(RigidSearch, TheSearchOfOneViewLeavesItsDepthToTheLastStep)
{
  RigidRadiographParameters parameters = Parameters(2);
  parameters.searchTranslation = 10.0;
  for (const double depth : { 9.9, 11.0 })
  {
    const auto xray = XRayOf(Body(12), ViewOf({ 0, 1, 0 }), PoseOf(1, depth, -2, 0.1, 0.05, -0.1));
    const auto result = SearchRigid({ Body(12) }, { xray }, Start, parameters, Execution(), {});
    EXPECT_FALSE(result.beyondSearch) << depth;
    EXPECT_EQ(result.quality, RegistrationQuality::Ok) << depth;
  }
  // It is when it is known.
  const auto registered = [&](double depth) {
    const auto xray = XRayOf(Body(12), ViewOf({ 0, 1, 0 }), PoseOf(1, depth, -2, 0.1, 0.05, -0.1));
    return RegisterRigid({ Body(12) }, { xray }, Start, parameters, Execution(), {});
  };
  const auto within = registered(9.9), beyond = registered(12.0);
  EXPECT_EQ(within.quality, RegistrationQuality::Ok);
  EXPECT_FALSE(within.beyondSearch);
  EXPECT_EQ(beyond.quality, RegistrationQuality::Suspect);
  EXPECT_TRUE(beyond.beyondSearch);
  const auto aside = XRayOf(Body(12), ViewOf({ 0, 1, 0 }), PoseOf(11, 1, -2, 0.1, 0.05, -0.1));
  EXPECT_TRUE(SearchRigid({ Body(12) }, { aside }, Start, parameters, Execution(), {}).beyondSearch);
}
} // namespace RigidSearchTests
