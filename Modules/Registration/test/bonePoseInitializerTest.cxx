/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "bonePoseInitializer.h"

#include "boneXRayConventions.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

namespace PoseInitializerTests
{
using namespace bone;
using testing::HasSubstr;
using View = XRayGeometry::View;

/** A C-arm at an angle: 0.5 mm pixels, 1000 mm from the source. */
View
Arm(double primary, double secondary = 0)
{
  CArmView arm;
  arm.primary = primary;
  arm.secondary = secondary;
  arm.spacing = { 0.5, 0.5 };
  return FromCArm(arm);
}

View
ParallelArm(double primary)
{
  View view = Arm(primary, 10);
  view.parallel = true;
  return view;
}

RigidPose
TruePose(unsigned int seed)
{
  std::mt19937                           random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  RigidPose                              pose;
  const Vector3                          axis(uniform(random), uniform(random), uniform(random));
  pose.rotation = Eigen::AngleAxisd(3 * uniform(random), axis.normalized()).toRotationMatrix();
  pose.translation = 40 * Vector3(uniform(random), uniform(random), uniform(random));
  return pose;
}

/** Landmarks within 60 mm of a model's middle, which is not the origin. */
std::vector<Vector3>
ModelPoints(std::size_t count, unsigned int seed)
{
  std::mt19937                           random(seed + 77);
  std::uniform_real_distribution<double> uniform(-60, 60);
  std::vector<Vector3>                   points;
  for (std::size_t i = 0; i < count; ++i)
  {
    const double x = uniform(random), y = uniform(random), z = uniform(random);
    points.emplace_back(x + 5, y - 10, z + 15);
  }
  return points;
}

std::vector<LandmarkPair>
Seen(const std::vector<View> & views, const std::vector<Vector3> & points, const RigidPose & pose)
{
  std::vector<LandmarkPair> pairs;
  for (unsigned int v = 0; v < views.size(); ++v)
  {
    const auto geometry = XRayGeometry::New();
    geometry->SetView(views[v]);
    for (std::size_t i = 0; i < points.size(); ++i)
    {
      pairs.push_back({ "p" + std::to_string(i), points[i], geometry->ProjectPoint(pose.Apply(points[i])), v });
    }
  }
  return pairs;
}

/** The largest distance of the points under both poses, mm. */
double
Apart(const RigidPose & a, const RigidPose & b, const std::vector<Vector3> & points)
{
  double most = 0;
  for (const Vector3 & p : points)
  {
    most = std::max(most, (a.Apply(p) - b.Apply(p)).norm());
  }
  return most;
}

void
AddNoise(std::vector<LandmarkPair> & pairs, double pixels, unsigned int seed)
{
  std::mt19937                     random(seed);
  std::normal_distribution<double> normal(0, pixels);
  for (LandmarkPair & pair : pairs)
  {
    const double c = normal(random), r = normal(random);
    pair.pixel += Vector2(c, r);
  }
}

std::string
ReasonAgainst(const std::vector<View> & views, const std::vector<LandmarkPair> & pairs)
{
  try
  {
    EstimatePose(views, pairs);
  }
  catch (const itk::ExceptionObject & error)
  {
    return error.GetDescription();
  }
  return "none";
}

TEST(PoseInitializer, FindsAnyPoseOfSixPointsInOneView)
{
  const std::vector<View> views = { Arm(20, -10) };
  for (unsigned int seed = 0; seed < 12; ++seed)
  {
    const auto points = ModelPoints(6, seed);
    const auto truth = TruePose(seed);
    const auto found = EstimatePose(views, Seen(views, points, truth));
    EXPECT_LT(Apart(found.pose, truth, points), 1e-6) << seed;
    EXPECT_LT(found.rms, 1e-6);
    EXPECT_EQ(std::count(found.inlier.begin(), found.inlier.end(), true), 6);
  }
}

TEST(PoseInitializer, FindsThePoseOfFourPointsAndOfCoplanarOnes)
{
  const std::vector<View> views = { Arm(-30) };
  for (unsigned int seed = 0; seed < 8; ++seed)
  {
    auto       points = ModelPoints(4, seed);
    const auto truth = TruePose(seed);
    EXPECT_LT(Apart(EstimatePose(views, Seen(views, points, truth)).pose, truth, points), 1e-5) << seed;
    for (Vector3 & p : points)
    {
      p.z() = 15;
    }
    points.emplace_back(5, 70, 15);
    const auto plane = EstimatePose(views, Seen(views, points, truth));
    EXPECT_LT(Apart(plane.pose, truth, points), 1e-4) << seed;
  }
}

TEST(PoseInitializer, FindsThePoseInSeveralViewsOfEitherBeam)
{
  const std::vector<std::vector<View>> sets = { { Arm(0), Arm(90) },
                                                { ParallelArm(0), ParallelArm(80) },
                                                { Arm(10), ParallelArm(100) } };
  for (const auto & views : sets)
  {
    for (unsigned int seed = 0; seed < 6; ++seed)
    {
      const auto points = ModelPoints(6, seed);
      const auto truth = TruePose(seed);
      const auto found = EstimatePose(views, Seen(views, points, truth));
      EXPECT_LT(Apart(found.pose, truth, points), 1e-6) << seed;
      EXPECT_FALSE(found.ambiguous);
    }
  }
}

TEST(PoseInitializer, OneParallelBeamLeavesTheDepthAndSaysSo)
{
  const std::vector<View> views = { ParallelArm(0) };
  const auto              points = ModelPoints(6, 3);
  const auto              truth = TruePose(3);
  const auto              found = EstimatePose(views, Seen(views, points, truth));
  EXPECT_LT(found.rms, 1e-6);
  EXPECT_LT((found.pose.rotation - truth.rotation).norm(), 1e-6);
  const Vector3 beam = found.pose.rotation.transpose() * views[0].direction;
  const double  depth = std::sqrt(beam.dot(found.covariance.topLeftCorner<3, 3>() * beam));
  EXPECT_GT(depth, 5000) << "mm, unknown";
  const Vector3 across = beam.unitOrthogonal();
  EXPECT_LT(std::sqrt(across.dot(found.covariance.topLeftCorner<3, 3>() * across)), 2);
}

TEST(PoseInitializer, TellsTwoOutliersOfTen)
{
  const std::vector<View> views = { Arm(15) };
  for (unsigned int seed = 0; seed < 10; ++seed)
  {
    const auto points = ModelPoints(10, seed);
    const auto truth = TruePose(seed);
    auto       pairs = Seen(views, points, truth);
    AddNoise(pairs, 0.5, seed);
    pairs[2].pixel += Vector2(60, -40);
    pairs[5].pixel = pairs[8].pixel + Vector2(15, 0); // a wrong name
    const auto found = EstimatePose(views, pairs);
    for (std::size_t i = 0; i < pairs.size(); ++i)
    {
      EXPECT_EQ(found.inlier[i], i != 2 && i != 5) << "seed " << seed << ", landmark " << i;
    }
    EXPECT_LT(found.rms, 0.6) << "mm; the noise is 0.25 mm along each axis";
    EXPECT_GT(found.distance[2], 20);
  }
}

TEST(PoseInitializer, NoiseOfAPixelGivesTheAccuracyThatItsCovarianceSays)
{
  const std::vector<View>   views = { Arm(0), Arm(60) };
  const auto                points = ModelPoints(8, 1);
  PoseInitializerParameters parameters;
  parameters.landmarkDeviation = 0.5; // a pixel
  const auto pairs = Seen(views, points, TruePose(1));
  double     mahalanobis = 0, error = 0;
  const int  trials = 60;
  for (int trial = 0; trial < trials; ++trial)
  {
    auto noisy = pairs;
    AddNoise(noisy, 1, 100 + trial);
    const auto found = EstimatePose(views, noisy, parameters);
    const auto step = found.pose.StepTo(TruePose(1).About(found.pose.centre));
    mahalanobis += step.dot(found.covariance.ldlt().solve(step)) / trials;
    error += step.head<3>().norm() / trials;
  }
  // Chi-squared of 6 degrees of freedom; its mean over 60 trials has a deviation of 0.45.
  EXPECT_NEAR(mahalanobis, 6, 1.6);
  // 0.5 mm at the detector are 0.35 mm at the isocentre, over some 16 landmarks.
  EXPECT_LT(error, 0.35);
  EXPECT_GT(error, 0.02);
}

TEST(PoseInitializer, ARigidMotionOfEverythingMovesThePose)
{
  const auto              points = ModelPoints(7, 4);
  const std::vector<View> views = { Arm(0), Arm(40, 20) };
  auto                    pairs = Seen(views, points, TruePose(4));
  AddNoise(pairs, 1, 9);
  pairs[3].pixel += Vector2(80, 0);
  const RigidPose   motion = TruePose(31);
  std::vector<View> moved;
  for (const View & view : views)
  {
    const RigidPose back{ motion.rotation.transpose(), motion.ApplyInverse(Vector3::Zero()), Vector3::Zero() };
    moved.push_back(back.ToModelSpace(view));
  }
  const auto found = EstimatePose(views, pairs), after = EstimatePose(moved, pairs);
  EXPECT_EQ(found.inlier, after.inlier);
  EXPECT_NEAR(found.rms, after.rms, 1e-6);
  for (const Vector3 & p : points)
  {
    EXPECT_LT((motion.Apply(found.pose.Apply(p)) - after.pose.Apply(p)).norm(), 1e-5);
  }
}

TEST(PoseInitializer, ManySamplesAreDrawnAtRandomAndAlwaysAlike)
{
  const std::vector<View> views = { Arm(15) };
  const auto              points = ModelPoints(20, 2);
  auto                    pairs = Seen(views, points, TruePose(2));
  AddNoise(pairs, 1, 5);
  for (std::size_t i = 0; i < 8; ++i)
  {
    pairs[i].pixel += Vector2(50.0 + 10 * i, 30 * (i % 2 == 0 ? 1.0 : -1.0));
  }
  const auto first = EstimatePose(views, pairs), second = EstimatePose(views, pairs);
  EXPECT_EQ(first.pose.rotation, second.pose.rotation);
  EXPECT_EQ(first.pose.translation, second.pose.translation);
  EXPECT_EQ(std::count(first.inlier.begin() + 8, first.inlier.end(), true), 12);
  EXPECT_EQ(std::count(first.inlier.begin(), first.inlier.begin() + 8, true), 0);
}

TEST(PoseInitializer, ThreePointsNeedAPrior)
{
  const std::vector<View> views = { Arm(0) };
  const auto              points = ModelPoints(3, 6);
  RigidPose               truth;
  truth.rotation = Eigen::AngleAxisd(0.2, Vector3(1, 2, -1).normalized()).toRotationMatrix();
  truth.translation = { 10, -15, 20 };
  const auto pairs = Seen(views, points, truth);
  EXPECT_THAT(ReasonAgainst(views, pairs), HasSubstr("Three landmarks in one view"));

  PosePrior prior;
  prior.translationDeviation = 1e4;
  prior.rotationDeviation = 10;
  prior.pose.centre = { 1, 2, 3 };
  const auto found = EstimatePose(views, pairs, {}, prior);
  EXPECT_LT(Apart(found.pose, truth, points), 0.1);
  EXPECT_EQ(found.pose.centre, prior.pose.centre);

  const std::vector<View> two = { Arm(0), Arm(90) };
  EXPECT_LT(Apart(EstimatePose(two, Seen(two, points, truth)).pose, truth, points), 1e-5);
}

TEST(PoseInitializer, APriorHoldsWhatLandmarksDoNotTell)
{
  const std::vector<View> views = { ParallelArm(0) };
  const auto              points = ModelPoints(6, 3);
  RigidPose               truth;
  truth.translation = { 10, 20, 30 };
  PosePrior prior;
  prior.pose.translation = { 0, 200, 0 };
  prior.translationDeviation = 30;
  prior.rotationDeviation = 0.2;
  const auto found = EstimatePose(views, Seen(views, points, truth), {}, prior);
  EXPECT_NEAR((found.pose.translation - prior.pose.translation).dot(views[0].direction), 0, 1);
  EXPECT_LT(found.rms, 0.1);
  const Vector3 beam = found.pose.rotation.transpose() * views[0].direction;
  // The covariance is about the prior's centre, from which the centroid is some 20 mm away.
  EXPECT_NEAR(std::sqrt(beam.dot(found.covariance.topLeftCorner<3, 3>() * beam)), 30, 1);
}

TEST(PoseInitializer, LandmarksOfNoAccuracyLeaveThePriorsDeviations)
{
  const std::vector<View>   views = { Arm(0) };
  PoseInitializerParameters parameters;
  parameters.landmarkDeviation = 10000;
  parameters.inlierDistance = 1000;
  PosePrior prior;
  prior.translationDeviation = 3;
  prior.rotationDeviation = 0.02;
  const auto points = ModelPoints(6, 3);
  prior.pose.centre = Vector3::Zero();
  for (const Vector3 & p : points)
  {
    prior.pose.centre += p / 6;
  }
  RigidPose truth;
  truth.translation = { 10, 0, 0 };
  const auto found = EstimatePose(views, Seen(views, points, truth), parameters, prior);
  EXPECT_LT(found.pose.translation.norm(), 0.1);
  for (int k = 0; k < 6; ++k)
  {
    EXPECT_NEAR(std::sqrt(found.covariance(k, k)), k < 3 ? 3 : 0.02, k < 3 ? 0.03 : 2e-4);
  }
}

TEST(PoseInitializer, APointsUncertaintyDoesNotDependOnThePriorsCentre)
{
  const std::vector<View>      views = { Arm(0) };
  const auto                   points = ModelPoints(6, 3);
  const Vector3                point(40, -30, 70);
  std::vector<Eigen::Matrix3d> covariances;
  for (const Vector3 & centre : { Vector3(0, 0, 0), Vector3(200, -100, 50) })
  {
    PosePrior prior;
    prior.pose.centre = centre;
    const auto                  found = EstimatePose(views, Seen(views, points, RigidPose()), {}, prior);
    const Vector3               r = point - found.pose.centre;
    Eigen::Matrix<double, 3, 6> byStep;
    byStep << 1, 0, 0, 0, r.z(), -r.y(), 0, 1, 0, -r.z(), 0, r.x(), 0, 0, 1, r.y(), -r.x(), 0;
    covariances.emplace_back(byStep * found.covariance * byStep.transpose());
  }
  EXPECT_LT((covariances[0] - covariances[1]).norm(), 1e-3 * covariances[0].norm());
}

TEST(PoseInitializer, RefusesWhatTellsNoPose)
{
  const std::vector<View> views = { Arm(0) };
  const auto              truth = TruePose(2);
  EXPECT_THAT(ReasonAgainst(views, {}), HasSubstr("there are 0"));
  EXPECT_THAT(ReasonAgainst(views, Seen(views, ModelPoints(2, 1), truth)), HasSubstr("there are 2"));
  std::vector<Vector3> line;
  for (int i = 0; i < 6; ++i)
  {
    line.emplace_back(10 * i, 5 * i, -3 * i + 0.1 * (i % 2));
  }
  EXPECT_THAT(ReasonAgainst(views, Seen(views, line, truth)), HasSubstr("on a line"));

  auto pairs = Seen(views, ModelPoints(6, 1), truth);
  pairs[2].view = 1;
  EXPECT_THAT(ReasonAgainst(views, pairs), HasSubstr("'p2' belongs to view 2 of 1"));
  pairs[2].view = 0;
  pairs[4].pixel.x() = std::nan("");
  EXPECT_THAT(ReasonAgainst(views, pairs), HasSubstr("'p4' has a coordinate that is not finite"));

  auto         mixed = Seen(views, ModelPoints(8, 1), truth);
  std::mt19937 random(3);
  for (LandmarkPair & pair : mixed)
  {
    pair.pixel = Vector2(random() % 500, random() % 500);
  }
  EXPECT_THAT(ReasonAgainst(views, mixed), HasSubstr("do not agree"));
}

TEST(PoseInitializer, SaysWhereASecondPoseExplainsTheLandmarks)
{
  // From afar a small flat set looks the same tilted either way.
  View view = Arm(0);
  view.source = { 0, 20000, 0 };
  const std::vector<View>    views = { view };
  const std::vector<Vector3> points = { { -30, 0, -30 }, { 30, 0, -30 }, { 30, 0, 30 }, { -30, 0, 30 } };
  RigidPose                  truth;
  truth.rotation = Eigen::AngleAxisd(0.5, Vector3::UnitX()).toRotationMatrix();
  EXPECT_TRUE(EstimatePose(views, Seen(views, points, truth)).ambiguous);
  auto solid = points;
  solid.emplace_back(0, 40, 0);
  EXPECT_FALSE(EstimatePose(views, Seen(views, solid, truth)).ambiguous);
}

TEST(MatchLandmarks, PairsByNameAndRefusesUnknownOnes)
{
  const std::vector<Landmark> model = { { "a", { 1, 2, 3 } }, { "b", { 4, 5, 6 } } };
  const auto                  pairs = MatchLandmarks(model, { { { "b", { 10, 20 } } }, { { "a", { 30, 40 } } } });
  ASSERT_EQ(pairs.size(), 2u);
  EXPECT_EQ(pairs[0].point, Vector3(4, 5, 6));
  EXPECT_EQ(pairs[0].view, 0u);
  EXPECT_EQ(pairs[1].name, "a");
  EXPECT_EQ(pairs[1].pixel, Vector2(30, 40));
  EXPECT_EQ(pairs[1].view, 1u);
  EXPECT_THROW(MatchLandmarks(model, { { { "c", { 1, 2 } } } }), itk::ExceptionObject);
  EXPECT_THROW(MatchLandmarks(model, { {} }), itk::ExceptionObject);
}
} // namespace PoseInitializerTests
