/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneRigidRadiographRegistration.h"

#include "boneRegistrationTestBody.h"

#include <itkCommand.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace RigidRadiographRegistrationTests
{
using namespace bone;
using namespace bone::test;
using Image = itk::Image<float, 3>;
using Registration = RigidRadiographRegistration<>;

const RigidPose Truth = PoseOf(6, -4, 5, 0.15, 0.1, -0.12);

Image::Pointer
ToImage(const std::vector<float> & values, const XRayGeometry::View & view)
{
  auto image = Image::New();
  image->SetRegions(itk::Size<3>{
    { static_cast<itk::SizeValueType>(view.size[0]), static_cast<itk::SizeValueType>(view.size[1]), 1 } });
  image->Allocate();
  std::copy(values.begin(), values.end(), image->GetBufferPointer());
  return image;
}

DensityHierarchy<>::Pointer
Hierarchy()
{
  std::vector<DensityHierarchy<>::Level> levels;
  for (const int cells : { 12, 8 })
  {
    auto mesh = DensityMesh<double>::New();
    mesh->SetArrays(Body(cells));
    levels.emplace_back();
    levels.back().mesh = mesh;
  }
  auto hierarchy = DensityHierarchy<>::New();
  hierarchy->SetLevels(levels);
  return hierarchy;
}

/** A registration of the body's X-rays in a pose, the second view only where `views` is 2. */
Registration::Pointer
MakeRegistration(const RigidPose & truth, unsigned int views = 2)
{
  auto       registration = Registration::New();
  const auto xrays = TwoXRays(Body(12), truth);
  registration->SetModel(Hierarchy());
  for (unsigned int v = 0; v < views; ++v)
  {
    auto geometry = XRayGeometry::New();
    geometry->SetView(xrays[v].view);
    registration->SetView(v, ToImage(xrays[v].values, xrays[v].view), geometry);
  }
  registration->SetPixels(96);
  registration->SetSearchPixels(48);
  return registration;
}

std::string
ErrorOf(Registration * registration)
{
  try
  {
    registration->Update();
  }
  catch (const itk::ExceptionObject & error)
  {
    return error.GetDescription();
  }
  return "";
}

TEST(RigidRadiographRegistration, FindsThePoseFromAfar)
{
  auto registration = MakeRegistration(Truth);
  registration->Update();
  const auto & result = registration->GetResult();
  EXPECT_LT(LargestDistance(Body(12), result.pose, Truth), 0.1);
  EXPECT_EQ(result.quality, RegistrationQuality::Ok);
  EXPECT_TRUE(result.converged);
  EXPECT_EQ(result.costs.size(), 2u);
  EXPECT_GE(result.searches, 1);
  // The transform is the pose.
  const auto * transform = registration->GetTransform();
  const auto   moved = transform->TransformPoint(itk::Point<double, 3>(Vector3(1, 2, 3).data()));
  EXPECT_LT((Vector3(moved[0], moved[1], moved[2]) - result.pose.Apply({ 1, 2, 3 })).norm(), 1e-9);
}

TEST(RigidRadiographRegistration, BeginsWhereTheInitialTransformSays)
{
  auto registration = MakeRegistration(Truth);
  registration->SetSearchTranslation(0.0);
  registration->SetSearchRotation(0.0);
  registration->SetInitialTransform(PoseOf(5, -4.5, 6, 0.13, 0.12, -0.1).ToTransform());
  registration->Update();
  EXPECT_LT(LargestDistance(Body(12), registration->GetResult().pose, Truth), 0.1);
  EXPECT_EQ(registration->GetResult().searches, 1);
}

TEST(RigidRadiographRegistration, TheTruthIsAFixedPoint)
{
  auto registration = MakeRegistration(Truth);
  registration->SetSearchTranslation(0.0);
  registration->SetSearchRotation(0.0);
  registration->SetSearchPixels(96);
  registration->SetInitialTransform(Truth.ToTransform());
  registration->Update();
  EXPECT_LT(LargestDistance(Body(12), registration->GetResult().pose, Truth), 0.02);
  EXPECT_LT(registration->GetResult().cost, 0.001);
}

TEST(RigidRadiographRegistration, SameResultForAnyNumberOfThreads)
{
  RigidPose poses[2];
  for (int i = 0; i < 2; ++i)
  {
    auto registration = MakeRegistration(Truth);
    registration->SetNumberOfWorkUnits(i == 0 ? 1 : 5);
    registration->Update();
    poses[i] = registration->GetResult().pose;
  }
  EXPECT_EQ(poses[0].rotation, poses[1].rotation);
  EXPECT_EQ(poses[0].translation, poses[1].translation);
}

TEST(RigidRadiographRegistration, ASecondViewTellsTheDepth)
{
  double deviations[2];
  for (unsigned int views = 1; views <= 2; ++views)
  {
    auto registration = MakeRegistration(Truth, views);
    registration->SetSearchTranslation(0.0);
    registration->SetSearchRotation(0.0);
    // At the truth itself nothing but rounding would scatter.
    registration->SetInitialTransform(PoseOf(5, -4.5, 6, 0.13, 0.12, -0.1).ToTransform());
    registration->Update();
    // The first view looks along y.
    deviations[views - 1] = std::sqrt(registration->GetResult().covariance(1, 1));
  }
  EXPECT_GT(deviations[0], 3.0 * deviations[1]);
}

TEST(RigidRadiographRegistration, StatedDepthGrowsWithTheSurfacesDeviation)
{
  // Of an X-ray without noise the surface would be found exactly, whatever is said of it beforehand.
  auto                            xray = TwoXRays(Body(12), Truth)[0];
  std::mt19937                    random(5);
  std::normal_distribution<float> noise(0.0f, 0.05f * *std::max_element(xray.values.begin(), xray.values.end()));
  for (float & x : xray.values)
  {
    x += noise(random);
  }
  double variances[2];
  for (int i = 0; i < 2; ++i)
  {
    auto registration = MakeRegistration(Truth, 1);
    auto geometry = XRayGeometry::New();
    geometry->SetView(xray.view);
    registration->SetView(0, ToImage(xray.values, xray.view), geometry);
    registration->SetSearchTranslation(0.0);
    registration->SetSearchRotation(0.0);
    registration->SetInitialTransform(Truth.ToTransform());
    registration->SetSurfaceDeviation(0.2 * i);
    registration->Update();
    variances[i] = registration->GetResult().covariance(1, 1);
  }
  EXPECT_GT(variances[1], 2.0 * variances[0]);
}

TEST(RigidRadiographRegistration, AnXRayWithoutTheBoneIsNoSuccess)
{
  auto       registration = MakeRegistration(Truth);
  const auto view = ViewOf({ 0, 1, 0 });
  for (unsigned int v = 0; v < 2; ++v)
  {
    std::mt19937                          random(v + 3);
    std::uniform_real_distribution<float> uniform(0.0f, 100.0f);
    std::vector<float>                    noise(static_cast<std::size_t>(view.size[0] * view.size[1]));
    std::generate(noise.begin(), noise.end(), [&] { return uniform(random); });
    auto geometry = XRayGeometry::New();
    geometry->SetView(ViewOf(v == 0 ? Vector3(0, 1, 0) : Vector3(1, 0, 0)));
    registration->SetView(v, ToImage(noise, view), geometry);
  }
  registration->SetSearches(2);
  registration->Update();
  EXPECT_EQ(registration->GetResult().quality, RegistrationQuality::Failed);
  EXPECT_EQ(registration->GetResult().searches, 2);
}

/** Quality and distinctnesses of the pose that a body has in its X-rays. */
RigidRegistrationResult
Judged(const MeshArrays & body, std::vector<RadiographView> views)
{
  RigidRegistrationResult   result;
  RigidRadiographParameters parameters;
  parameters.pixels = 96;
  result.pose = PoseOf(0, 0, 0, 0, 0, 0);
  JudgePose(body, views, parameters, Execution(), result);
  return result;
}

TEST(RigidRadiographRegistration, APoseThatAMotionHardlyChangesIsSuspect)
{
  const RigidPose still = PoseOf(0, 0, 0, 0, 0, 0);
  MeshArrays      round = BallMesh(8, Vector3::Zero(), 1.0); // a body of revolution about z
  for (Vector3 & p : round.points)
  {
    p = Vector3(10, 20, 30) + Vector3(16, 16, 40).cwiseProduct(p);
  }
  round.maximumDegree = 0;
  round.degree.assign(round.tetrahedra.size(), 0);
  round.coefficients.assign(round.tetrahedra.size(), 600.0);
  // The X-rays show something else too, as a cost of nothing is distinct from anything.
  auto views = TwoXRays(round, still);
  for (RadiographView & view : views)
  {
    const auto other = XRayOf(Body(8), view.view, PoseOf(4, 8, 12, 0.4, 0.2, 0.3));
    for (std::size_t k = 0; k < view.values.size(); ++k)
    {
      view.values[k] += 0.3F * other.values[k];
    }
  }
  const auto two = Judged(round, views), one = Judged(round, { views[0] });
  EXPECT_GT(two.distinctness, 0.5);
  EXPECT_LT(two.leastDistinctness, 0.1);
  EXPECT_EQ(two.quality, RegistrationQuality::Suspect);
  // One view never holds its depth: it is not judged by that.
  EXPECT_LT(one.leastDistinctness, 0.28 * one.distinctness);
  EXPECT_EQ(one.quality, RegistrationQuality::Ok);
  const auto irregular = Judged(Body(12), TwoXRays(Body(12), still));
  EXPECT_GT(irregular.leastDistinctness, 0.28 * irregular.distinctness);
  EXPECT_EQ(irregular.quality, RegistrationQuality::Ok);
}

TEST(RigidRadiographRegistration, ABoneThatNoViewShowsIsNoSuccess)
{
  auto registration = MakeRegistration(Truth);
  registration->SetSearchTranslation(0.0);
  registration->SetSearchRotation(0.0);
  registration->SetInitialTransform(PoseOf(0, 0, 3000, 0, 0, 0).ToTransform());
  registration->Update();
  const auto & result = registration->GetResult();
  EXPECT_EQ(result.quality, RegistrationQuality::Failed);
  EXPECT_EQ(result.cost, 1.0);
  EXPECT_GE(result.covariance(0, 0), 1e6); // it could be anywhere
}

TEST(RigidRadiographRegistration, HasAnOutputForEachBody)
{
  auto registration = MakeRegistration(Truth);
  registration->SetSearchTranslation(0.0);
  registration->SetSearchRotation(0.0);
  registration->SetInitialTransform(Truth.ToTransform());
  registration->SetModel(1, Hierarchy());
  EXPECT_EQ(registration->GetNumberOfBodies(), 2u);
  registration->Update();
  for (unsigned int body = 0; body < 2; ++body)
  {
    const auto & pose = registration->GetResult(body).pose;
    const auto   moved = registration->GetTransform(body)->TransformPoint(itk::Point<double, 3>(0.0));
    EXPECT_LT((Vector3(moved[0], moved[1], moved[2]) - pose.Apply(Vector3::Zero())).norm(), 1e-9);
  }
  EXPECT_EQ(registration->GetViewCorrections().size(), 2u);

  auto noDensity = MakeRegistration(Truth);
  noDensity->SetModel(1, DensityHierarchy<>::New());
  EXPECT_THAT(ErrorOf(noDensity), ::testing::HasSubstr("The input 'Model1' has no level"));
}

TEST(RigidRadiographRegistration, IsLazyAndTellsEachStep)
{
  auto   registration = MakeRegistration(Truth);
  int    steps = 0;
  auto   command = itk::FunctionCommand::New();
  double last = 0.0;
  command->SetCallback([&](const itk::EventObject &) {
    ++steps;
    last = registration->GetCurrentCost();
  });
  registration->AddObserver(itk::IterationEvent(), command);
  registration->Update();
  EXPECT_GT(steps, 2);
  EXPECT_NEAR(last, registration->GetResult().cost, 1e-5);
  const int before = steps;
  registration->Update();
  EXPECT_EQ(steps, before);
  registration->SetIterations(registration->GetIterations() + 1);
  registration->Update();
  EXPECT_GT(steps, before);
}

TEST(RigidRadiographRegistration, StopsWhenAborted)
{
  auto registration = MakeRegistration(Truth);
  auto command = itk::FunctionCommand::New();
  command->SetCallback([&](const itk::EventObject &) {
    if (registration->GetProgress() > 0.05f)
    {
      registration->AbortGenerateDataOn();
    }
  });
  registration->AddObserver(itk::ProgressEvent(), command);
  EXPECT_THROW(registration->Update(), itk::ProcessAborted);
}

TEST(RigidRadiographRegistration, RefusesWhatItCannotUse)
{
  using ::testing::HasSubstr;
  EXPECT_THAT(ErrorOf(Registration::New()), HasSubstr("Model"));

  auto noView = Registration::New();
  noView->SetModel(Hierarchy());
  EXPECT_THAT(ErrorOf(noView), HasSubstr("There is no X-ray"));

  auto noGeometry = MakeRegistration(Truth);
  noGeometry->SetView(1, ToImage(std::vector<float>(96 * 96), ViewOf({ 0, 1, 0 })), nullptr);
  EXPECT_THAT(ErrorOf(noGeometry), HasSubstr("View 2 needs both"));

  auto otherSize = MakeRegistration(Truth);
  auto geometry = XRayGeometry::New();
  geometry->SetView(ViewOf({ 0, 1, 0 }, 48));
  otherSize->SetView(1, ToImage(std::vector<float>(96 * 96), ViewOf({ 0, 1, 0 })), geometry);
  EXPECT_THAT(ErrorOf(otherSize), HasSubstr("96 x 96 x 1 pixels, its geometry 48 x 48"));

  auto maskOfNothing = MakeRegistration(Truth);
  auto full = XRayGeometry::New();
  full->SetView(ViewOf({ 1, 0, 0 }));
  const auto xray = TwoXRays(Body(12), Truth)[1];
  maskOfNothing->SetView(
    1, ToImage(xray.values, xray.view), full, ToImage(std::vector<float>(96 * 96, 0.0f), xray.view));
  EXPECT_THAT(ErrorOf(maskOfNothing), HasSubstr("View 2: no pixel of the X-ray counts"));

  auto notFinite = MakeRegistration(Truth);
  auto values = xray.values;
  values[96 * 7 + 5] = std::numeric_limits<float>::quiet_NaN();
  notFinite->SetView(1, ToImage(values, xray.view), full);
  EXPECT_THAT(ErrorOf(notFinite), HasSubstr("View 2: pixel 5 7 is not finite"));

  auto noDensity = MakeRegistration(Truth);
  auto mesh = DensityMesh<double>::New();
  auto arrays = Body(4);
  arrays.degree.clear();
  arrays.coefficients.clear();
  arrays.maximumDegree = -1;
  mesh->SetArrays(std::move(arrays));
  auto hierarchy = DensityHierarchy<>::New();
  hierarchy->SetLevels({ DensityHierarchy<>::Level() });
  auto levels = hierarchy->GetLevels();
  levels[0].mesh = mesh;
  hierarchy->SetLevels(levels);
  noDensity->SetModel(hierarchy);
  EXPECT_THAT(ErrorOf(noDensity), HasSubstr("Level 1 of the input 'Model'"));

  auto range = MakeRegistration(Truth);
  range->SetPatch(2);
  EXPECT_THAT(ErrorOf(range), HasSubstr("Patch is 2"));
}
} // namespace RigidRadiographRegistrationTests
