/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneRigidRegistration.h"

#include "boneOutwardMove.h"
#include "boneRegistrationTestBody.h"

#include <gtest/gtest.h>

namespace RigidBundleTests
{
using namespace bone;
using namespace bone::test;

const RigidPose Truth = PoseOf(2, -3, 2, 0.05, 0.04, -0.06);
const RigidPose Start = PoseOf(1.2, -2, 1, 0.07, 0.03, -0.03);

/** Refined from the start alone. */
RigidRadiographParameters
Refinement()
{
  RigidRadiographParameters parameters;
  parameters.searchTranslation = parameters.searchRotation = 0.0;
  parameters.pixels = parameters.searchPixels = 96;
  return parameters;
}

/** The body turned about, behind the first one in the second view and beside it in the first. */
MeshArrays
Neighbour()
{
  MeshArrays mesh = Body(12);
  for (Vector3 & x : mesh.points)
  {
    x = Vector3(50, 20, 34) + Vector3(-(x.x() - 10), x.z() - 30, x.y() - 20);
  }
  return mesh;
}

void
Add(std::vector<RadiographView> & xrays, const std::vector<RadiographView> & others)
{
  for (std::size_t v = 0; v < xrays.size(); ++v)
  {
    for (std::size_t i = 0; i < xrays[v].values.size(); ++i)
    {
      xrays[v].values[i] += others[v].values[i];
    }
  }
}

TEST(RigidBundle, BodiesThatHideEachOtherAreFoundTogether)
{
  const MeshArrays body = Body(12), neighbour = Neighbour();
  auto             xrays = TwoXRays(body, Truth);
  const RigidPose  other = Start.Moved((Eigen::Matrix<double, 6, 1>() << 1, 1, -1, -0.03, 0.02, 0.01).finished());
  Add(xrays, TwoXRays(neighbour, other));
  const auto result = RegisterRigidBodies({ { body }, { neighbour } }, xrays, Start, Refinement(), Execution());
  ASSERT_EQ(result.bodies.size(), 2u);
  const double together = LargestDistance(body, result.bodies[0].pose, Truth);
  const double ofOther = LargestDistance(neighbour, result.bodies[1].pose, other);
  EXPECT_LT(together, 0.02);
  EXPECT_LT(ofOther, 0.02);
  const auto alone = RegisterRigid({ body }, xrays, Start, Refinement(), Execution());
  EXPECT_GT(LargestDistance(body, alone.pose, Truth), 5.0 * together);
}

TEST(RigidBundle, OrderOfBodiesDoesNotMatter)
{
  const MeshArrays body = Body(8), neighbour = Neighbour();
  auto             xrays = TwoXRays(body, Truth);
  Add(xrays, TwoXRays(neighbour, Truth));
  AddNoise(xrays, 0.02f); // without any, the covariance tells how near to the truth the last step came
  const auto one = RegisterRigidBodies({ { body }, { neighbour } }, xrays, Start, Refinement(), Execution());
  const auto two = RegisterRigidBodies({ { neighbour }, { body } }, xrays, Start, Refinement(), Execution());
  EXPECT_LT(LargestDistance(body, one.bodies[0].pose, two.bodies[1].pose), 1e-3);
  EXPECT_LT((one.bodies[0].covariance - two.bodies[1].covariance).norm(), 1e-2 * one.bodies[0].covariance.norm());
}

TEST(RigidBundle, FindsWhereAViewIs)
{
  const MeshArrays body = Body(12);
  auto             xrays = TwoXRays(body, Truth);
  // What the second view is from where it is said to be.
  const RigidPose motion = PoseOf(0.6, -0.5, 0.7, 0.006, -0.004, 0.005);
  const auto      exact = xrays[1].view;
  RigidPose       back; // of the motion
  back.rotation = motion.rotation.transpose();
  back.centre = motion.centre;
  back.translation = -(back.rotation * motion.translation);
  xrays[1].view = back.ToModelSpace(exact);
  RigidRadiographParameters parameters = Refinement();
  const auto                taken = RegisterRigidBodies({ { body } }, xrays, Start, parameters, Execution());
  EXPECT_EQ(taken.views[1].motion.translation, Vector3(Vector3::Zero()));
  parameters.viewTranslationDeviation = 1.0;
  parameters.viewRotationDeviation = 0.5;
  const auto result = RegisterRigidBodies({ { body } }, xrays, Start, parameters, Execution());
  EXPECT_LT(LargestDistance(body, result.bodies[0].pose, Truth),
            0.2 * LargestDistance(body, taken.bodies[0].pose, Truth));
  EXPECT_LT(LargestDistance(body, result.views[1].motion, motion), 0.1);
  EXPECT_EQ(result.views[0].motion.rotation, Eigen::Matrix3d(Eigen::Matrix3d::Identity()));
  // Where views may be elsewhere, less is known.
  const auto known = RegisterRigid({ body }, TwoXRays(body, Truth), Start, Refinement(), Execution());
  EXPECT_GT(result.bodies[0].covariance.trace(), known.covariance.trace());
  EXPECT_GT(result.views[1].covariance(0, 0), 0.0);
  EXPECT_LT(result.views[1].covariance(0, 0), 1.0);
}

TEST(RigidBundle, ASurfaceThatLiesOutsideTheModelsIsNotTakenForDepth)
{
  const MeshArrays           body = Body(12);
  MeshArrays                 larger = body;
  const std::vector<Vector3> outward = OutwardMove(body);
  for (std::size_t p = 0; p < outward.size(); ++p)
  {
    larger.points[p] += 0.3 * outward[p];
  }
  const std::vector<RadiographView> xray{ TwoXRays(larger, Truth)[0] };
  double                            errors[2];
  for (int i = 0; i < 2; ++i)
  {
    RigidRadiographParameters parameters = Refinement();
    parameters.surfaceDeviation = i == 0 ? 0.0 : 0.2;
    const auto result = RegisterRigid({ body }, xray, Start, parameters, Execution());
    errors[i] = std::abs((result.pose.Apply(result.pose.centre) - Truth.Apply(result.pose.centre)).y());
  }
  EXPECT_GT(errors[0], 1.0);
  EXPECT_LT(errors[1], 0.3 * errors[0]);
}

TEST(RigidBundle, ABodyThatFailsDoesNotMoveTheOthers)
{
  const MeshArrays body = Body(12);
  MeshArrays       elsewhere = Neighbour();
  for (Vector3 & x : elsewhere.points)
  {
    x.z() += 3000.0; // in no view
  }
  const auto xrays = TwoXRays(body, Truth);
  const auto result = RegisterRigidBodies({ { elsewhere }, { body } }, xrays, Start, Refinement(), Execution());
  const auto alone = RegisterRigid({ body }, xrays, Start, Refinement(), Execution());
  EXPECT_EQ(result.bodies[0].quality, RegistrationQuality::Failed);
  EXPECT_GE(result.bodies[0].covariance(0, 0), 1e6);
  EXPECT_EQ(result.bodies[1].pose.translation, alone.pose.translation);
  EXPECT_EQ(result.bodies[1].covariance, alone.covariance);
}
TEST(RigidBundle, TheOnlyViewCannotBeElsewhere)
{
  const MeshArrays          body = Body(4);
  RigidRadiographParameters parameters = Refinement();
  parameters.viewRotationDeviation = 0.1;
  EXPECT_THROW(RegisterRigidBodies({ { body } }, { TwoXRays(body, Truth)[0] }, Start, parameters, Execution()),
               std::invalid_argument);
}
TEST(RigidBundle, FindsWhereAViewIsByTwoBodies)
{
  // The motion's centre lies between them.
  const MeshArrays body = Body(12), neighbour = Neighbour();
  auto             xrays = TwoXRays(body, Truth);
  Add(xrays, TwoXRays(neighbour, Truth));
  const RigidPose motion = PoseOf(0.3, 0.4, -0.6, 0.01, -0.008, 0.012);
  RigidPose       back;
  back.rotation = motion.rotation.transpose();
  back.centre = motion.centre;
  back.translation = -(back.rotation * motion.translation);
  xrays[1].view = back.ToModelSpace(xrays[1].view);
  RigidRadiographParameters parameters = Refinement();
  parameters.viewTranslationDeviation = 1.0;
  parameters.viewRotationDeviation = 0.8;
  const auto result = RegisterRigidBodies({ { body }, { neighbour } }, xrays, Start, parameters, Execution());
  EXPECT_LT(LargestDistance(body, result.bodies[0].pose, Truth), 0.05);
  EXPECT_LT(LargestDistance(neighbour, result.bodies[1].pose, Truth), 0.05);
  EXPECT_LT(LargestDistance(neighbour, result.views[1].motion, motion), 0.05);
}

TEST(RigidBundle, CovariancesAreAlongTheGeometrysAxes)
{
  // Turned by a right angle about z, the view's depth, y, is the model's x.
  const MeshArrays body = Body(12);
  const RigidPose  turned = PoseOf(0, 0, 0, 0, 0, std::acos(0.0));
  const auto       xray = TwoXRays(body, turned)[0];
  const auto       result = RegisterRigid({ body }, { xray }, turned, Refinement(), Execution());
  EXPECT_LT(LargestDistance(body, result.pose, turned), 0.1);
  EXPECT_GT(result.covariance(1, 1), 9.0 * result.covariance(0, 0));
}
} // namespace RigidBundleTests
