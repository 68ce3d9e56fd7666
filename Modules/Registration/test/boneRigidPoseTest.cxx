/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneRigidPose.h"

#include <gtest/gtest.h>
#include <itkEuler3DTransform.h>

#include <random>

namespace RigidPoseTests
{
using namespace bone;
using Step = Eigen::Matrix<double, 6, 1>;

/** A pose of any rotation, about a centre that is not the origin. */
RigidPose
AnyPose(unsigned int seed)
{
  std::mt19937                           random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto                             vector = [&](double size) {
    return Vector3(size * Vector3(uniform(random), uniform(random), uniform(random)));
  };
  RigidPose pose;
  pose.rotation = Eigen::AngleAxisd(3 * uniform(random), vector(1).normalized()).toRotationMatrix();
  pose.translation = vector(100);
  pose.centre = vector(80);
  return pose;
}

Step
AnyStep(unsigned int seed, double turn)
{
  std::mt19937                           random(seed + 1000);
  std::uniform_real_distribution<double> uniform(-1, 1);
  Step                                   step;
  for (int k = 0; k < 6; ++k)
  {
    step[k] = (k < 3 ? 20 : turn) * uniform(random);
  }
  return step;
}

const Vector3 point(31, -17, 8);

TEST(RigidPose, ApplyInverseUndoesApply)
{
  for (unsigned int seed = 0; seed < 8; ++seed)
  {
    const RigidPose pose = AnyPose(seed);
    EXPECT_NEAR((pose.ApplyInverse(pose.Apply(point)) - point).norm(), 0, 1e-10);
    EXPECT_GT((pose.Apply(point) - point).norm(), 1);
  }
}

TEST(RigidPose, AStepMovesTheModelInItsOwnSpaceBeforeThePose)
{
  const RigidPose pose = AnyPose(3);
  Step            step = Step::Zero();
  step.head<3>() << 3, -4, 5;
  EXPECT_NEAR((pose.Moved(step).Apply(point) - pose.Apply(point + Vector3(3, -4, 5))).norm(), 0, 1e-10);
  step << 0, 0, 0, 0, 0, 0.5;
  const Vector3 turned = Eigen::AngleAxisd(0.5, Vector3::UnitZ()) * (point - pose.centre) + pose.centre;
  EXPECT_NEAR((pose.Moved(step).Apply(point) - pose.Apply(turned)).norm(), 0, 1e-10);
}

TEST(RigidPose, StepToIsTheInverseOfMoved)
{
  for (unsigned int seed = 0; seed < 8; ++seed)
  {
    const RigidPose pose = AnyPose(seed);
    const Step      step = AnyStep(seed, 1.5);
    EXPECT_NEAR((pose.StepTo(pose.Moved(step)) - step).norm(), 0, 1e-9);
    RigidPose other = AnyPose(seed + 50);
    other.centre = pose.centre;
    const RigidPose moved = pose.Moved(pose.StepTo(other));
    EXPECT_NEAR((moved.Apply(point) - other.Apply(point)).norm(), 0, 1e-9);
    EXPECT_EQ(moved.centre, pose.centre);
  }
}

TEST(RigidPose, TheSameMotionAboutAnotherCentreMovesEveryPointAlike)
{
  const RigidPose pose = AnyPose(5), about = pose.About({ 10, 20, -30 });
  EXPECT_EQ(about.centre, Vector3(10, 20, -30));
  EXPECT_NEAR((about.Apply(point) - pose.Apply(point)).norm(), 0, 1e-10);
  EXPECT_GT((about.translation - pose.translation).norm(), 1) << "the translation belongs to the centre";
}

TEST(RigidPose, TheModelsOwnViewShowsAPointAtThePixelOfTheMovedPoint)
{
  for (const bool parallel : { false, true })
  {
    XRayGeometry::View view;
    view.parallel = parallel;
    view.source = { 20, -900, 10 };
    view.direction = Vector3(0.1, 1, -0.05).normalized();
    view.detectorOrigin = { -200, 400, 150 };
    view.spacing = { 0.7, 1.1 };
    for (unsigned int seed = 0; seed < 8; ++seed)
    {
      const RigidPose pose = AnyPose(seed);
      const auto      fixed = XRayGeometry::New(), moving = XRayGeometry::New();
      fixed->SetView(view);
      moving->SetView(pose.ToModelSpace(view));
      const Vector2 pixel = fixed->ProjectPoint(pose.Apply(point));
      ASSERT_TRUE(pixel.allFinite());
      EXPECT_NEAR((moving->ProjectPoint(point) - pixel).norm(), 0, 1e-8);
    }
  }
}

TEST(RigidPose, ItksTransformMovesPointsAlikeAndComesBack)
{
  for (unsigned int seed = 0; seed < 8; ++seed)
  {
    const RigidPose             pose = AnyPose(seed);
    const auto                  transform = pose.ToTransform();
    const itk::Point<double, 3> moved = transform->TransformPoint(itk::Point<double, 3>(point.data()));
    EXPECT_NEAR((Vector3(moved[0], moved[1], moved[2]) - pose.Apply(point)).norm(), 0, 1e-6);
    const RigidPose back = RigidPose::FromTransform(*transform);
    EXPECT_NEAR((back.rotation - pose.rotation).norm(), 0, 1e-8);
    EXPECT_NEAR((back.translation - pose.translation).norm(), 0, 1e-12);
    EXPECT_NEAR((back.centre - pose.centre).norm(), 0, 1e-12);
  }
}
} // namespace RigidPoseTests
