/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneRigidCostMetric.h"

#include "bonePatchGradientCorrelation.h"
#include "boneRegistrationTestBody.h"

#include <itkGradientDescentOptimizerv4.h>
#include <itkPowellOptimizerv4.h>

#include <gtest/gtest.h>

namespace RigidCostTests
{
using namespace bone;
using namespace bone::test;
using Vector6 = Eigen::Matrix<double, 6, 1>;

/** The body, its X-rays in a pose, and the cost. */
struct Scene
{
  MeshArrays                       mesh;
  ProjectionModel                  model;
  std::unique_ptr<const RigidCost> cost;

  explicit Scene(const RigidPose & truth, std::vector<RadiographView> views = {})
    : mesh(Body(12))
    , model(mesh.points, mesh, {}, Execution())
  {
    cost = std::make_unique<const RigidCost>(
      model, views.empty() ? TwoXRays(mesh, truth) : views, [](const RadiographView & view) {
        return std::make_unique<PatchGradientCorrelation>(view, 16, 1.5);
      });
  }
};

const RigidPose Truth = PoseOf(3, -2, 1, 0.1, 0.05, -0.08);

TEST(RigidCost, IsNothingAtTheTruthAndMoreAllAround)
{
  const Scene         scene(Truth);
  std::vector<double> costs;
  EXPECT_NEAR(scene.cost->Evaluate(Truth, Execution(), &costs), 0.0, 1e-4);
  EXPECT_EQ(costs.size(), 2u);
  for (int k = 0; k < 12; ++k)
  {
    Vector6 step = Vector6::Zero();
    step[k / 2] = (k % 2 == 0 ? 1.0 : -1.0) * (k < 6 ? 2.0 : 0.05);
    EXPECT_GT(scene.cost->Evaluate(Truth.Moved(step), Execution()), 0.005) << k;
  }
}

// Pixels see edges of cells come and go, which makes the cost rough: gradients are summed along a way.
constexpr int Places = 40;

TEST(RigidCost, GradientsAlongAWayAddUpToTheCost)
{
  const Scene scene(Truth);
  Vector6     way;
  way << 1.5, -2, 1, 0.04, 0.06, -0.05;
  const auto at = [&](double share) { return Truth.Moved((0.5 + share) * way); };
  EXPECT_NEAR(
    scene.cost->EvaluateDerivatives(at(0.5), Execution()).cost, scene.cost->Evaluate(at(0.5), Execution()), 1e-6);
  double sum = 0.0;
  for (int i = 0; i < Places; ++i)
  {
    const RigidPose pose = at((i + 0.5) / Places);
    const Vector6   step = at(static_cast<double>(i) / Places).StepTo(at((i + 1.0) / Places));
    sum += scene.cost->EvaluateDerivatives(pose, Execution()).gradient.dot(step);
  }
  const double rise = scene.cost->Evaluate(at(1.0), Execution()) - scene.cost->Evaluate(at(0.0), Execution());
  EXPECT_GT(rise, 0.05);
  EXPECT_NEAR(sum, rise, 0.02 * rise);
}

TEST(RigidCost, DoesNotChangeWhenEverythingMoves)
{
  const Scene     scene(Truth);
  const RigidPose pose = PoseOf(1, 0, 2, 0.02, 0.08, 0.03);
  RigidPose       motion = PoseOf(30, -40, 50, 0.7, -0.4, 0.3);
  // The views move by the inverse of what ToModelSpace undoes.
  RigidPose inverse;
  inverse.rotation = motion.rotation.transpose();
  inverse.translation = motion.ApplyInverse(Vector3::Zero());
  std::vector<RadiographView> views = TwoXRays(scene.mesh, Truth);
  for (RadiographView & view : views)
  {
    view.view = inverse.ToModelSpace(view.view);
  }
  const Scene moved(Truth, views);
  RigidPose   movedPose;
  movedPose.rotation = motion.rotation * pose.rotation;
  movedPose.translation = motion.Apply(pose.Apply(Vector3::Zero()));
  EXPECT_NEAR(moved.cost->Evaluate(movedPose, Execution()), scene.cost->Evaluate(pose, Execution()), 1e-4);
}

TEST(RigidCost, NamesTheViewThatTellsNothing)
{
  auto views = TwoXRays(Body(12), Truth);
  std::fill(views[1].values.begin(), views[1].values.end(), 1.0f);
  try
  {
    Scene(Truth, views);
    FAIL() << "a constant view was taken";
  }
  catch (const std::invalid_argument & error)
  {
    EXPECT_EQ(std::string(error.what()).rfind("View 2: ", 0), 0u) << error.what();
  }
}

TEST(RigidCostMetric, DerivativesOfItsParametersPointDownhill)
{
  const Scene scene(Truth);
  auto        metric = RigidCostMetric::New();
  // From a start that is turned far, so that its axes are not those of the pose.
  const RigidPose start = Truth.Moved((Vector6() << 0, 0, 0, 0.5, -0.6, 0.4).finished());
  metric->SetCost(scene.cost.get(), start);
  const Vector6 back = start.StepTo(Truth);
  Vector6       way;
  way << 1.5, -2, 1, 0.03, 0.05, -0.04;
  const auto set = [&](double share) {
    RigidCostMetric::ParametersType parameters(6);
    for (unsigned int k = 0; k < 6; ++k)
    {
      parameters[k] = back[k] + (0.5 + share) * way[k];
    }
    metric->SetParameters(parameters);
  };
  double sum = 0.0;
  for (int i = 0; i < Places; ++i)
  {
    set((i + 0.5) / Places);
    RigidCostMetric::DerivativeType derivative;
    metric->GetDerivative(derivative);
    for (unsigned int k = 0; k < 6; ++k)
    {
      sum -= derivative[k] * way[k] / Places;
    }
  }
  set(1.0);
  const double end = metric->GetValue();
  set(0.0);
  const double rise = end - metric->GetValue();
  EXPECT_GT(rise, 0.05);
  EXPECT_NEAR(sum, rise, 0.02 * rise);
}

TEST(RigidCostMetric, ServesOptimisersOfITK)
{
  const Scene                                                  scene(Truth);
  const RigidPose                                              start = PoseOf(1.5, -1, 0, 0.08, 0.06, -0.05);
  itk::ObjectToObjectOptimizerBaseTemplate<double>::ScalesType scales(6);
  for (unsigned int k = 0; k < 6; ++k)
  {
    scales[k] = k < 3 ? 1.0 : 900.0; // a radian moves the body by some 30 mm
  }
  auto powell = itk::PowellOptimizerv4<double>::New();
  powell->SetStepLength(1.0);
  powell->SetStepTolerance(0.005);
  powell->SetValueTolerance(1e-5);
  powell->SetMaximumIteration(30);
  auto descent = itk::GradientDescentOptimizerv4::New();
  descent->SetLearningRate(8.0);
  descent->SetNumberOfIterations(80);
  descent->SetReturnBestParametersAndValue(true);
  descent->SetDoEstimateLearningRateOnce(false);
  for (const itk::ObjectToObjectOptimizerBaseTemplate<double>::Pointer & optimiser :
       { itk::ObjectToObjectOptimizerBaseTemplate<double>::Pointer(powell),
         itk::ObjectToObjectOptimizerBaseTemplate<double>::Pointer(descent) })
  {
    auto metric = RigidCostMetric::New();
    metric->SetCost(scene.cost.get(), start);
    optimiser->SetMetric(metric);
    optimiser->SetScales(scales);
    optimiser->StartOptimization();
    EXPECT_LT(LargestDistance(scene.mesh, metric->GetPose(), Truth), 0.4) << optimiser->GetNameOfClass();
  }
}
} // namespace RigidCostTests
