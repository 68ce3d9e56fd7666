/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneDeformableRadiographRegistration.h"

#include "boneDeformablePosterior.h"

#include "boneDeformableTestAtlas.h"

#include <itkCommand.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

namespace DeformableRadiographRegistrationTests
{
using namespace bone;
using namespace bone::test;
using Image = itk::Image<float, 3>;
using Registration = DeformableRadiographRegistration<>;

const RigidPose       Truth = PoseOf(4, -3, 3, 0.08, 0.06, -0.07);
const Eigen::Vector2d TrueShape(1.0, -0.8);
constexpr double      TrueDensity = 0.7;

StatisticalModel::Pointer
Model(StatisticalModelContent content = Atlas())
{
  auto model = StatisticalModel::New();
  model->SetContent(std::move(content));
  return model;
}

/** The true bone in the space of the atlas. */
MeshArrays
TrueBone()
{
  return Model()->Synthesize(TrueShape, Eigen::VectorXd::Constant(1, TrueDensity));
}

/** Without smooth modes: all of the truth is in the atlas. */
DeformableRadiographParameters
Parameters()
{
  DeformableRadiographParameters parameters;
  parameters.smoothModes = 0;
  parameters.population = 30;
  parameters.pixels = 96;
  parameters.searchPixels = 48;
  parameters.softTissue = 0.0;
  return parameters;
}

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

/** X-rays of the bone in air, attenuation by the slope of bone from 0 HU on. */
std::vector<RadiographView>
LineIntegrals()
{
  auto xrays = TwoXRays(TrueBone(), Truth);
  for (RadiographView & xray : xrays)
  {
    for (float & x : xray.values)
    {
      x *= static_cast<float>(BoneSlopeAt60keV);
    }
  }
  return xrays;
}

Registration::Pointer
MakeRegistration(unsigned int views = 2)
{
  auto       registration = Registration::New();
  const auto xrays = LineIntegrals();
  registration->SetModel(Model());
  for (unsigned int v = 0; v < views; ++v)
  {
    auto geometry = XRayGeometry::New();
    geometry->SetView(xrays[v].view);
    registration->SetView(v, ToImage(xrays[v].values, xrays[v].view), geometry);
  }
  registration->SetParameters(Parameters());
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

/** The mean distance of points of the same number, mm. */
double
MeanDistance(const std::vector<Vector3> & a, const std::vector<Vector3> & b)
{
  double sum = 0.0;
  for (std::size_t p = 0; p < a.size(); ++p)
  {
    sum += (a[p] - b[p]).norm();
  }
  return sum / static_cast<double>(a.size());
}

std::vector<Vector3>
Moved(std::vector<Vector3> points, const RigidPose & pose)
{
  for (Vector3 & x : points)
  {
    x = pose.Apply(x);
  }
  return points;
}

TEST(DeformableRadiographRegistration, FindsPoseShapeAndDensity)
{
  auto registration = MakeRegistration();
  registration->Update();
  const auto & result = registration->GetResult();
  EXPECT_EQ(result.shapeModes, 2);
  EXPECT_EQ(result.smoothModes, 0);
  EXPECT_EQ(result.densityModes, 1);
  ASSERT_EQ(result.coefficients.size(), 3);
  EXPECT_NEAR(result.coefficients[0], TrueShape[0], 0.15);
  EXPECT_NEAR(result.coefficients[1], TrueShape[1], 0.15);
  EXPECT_NEAR(result.coefficients[2], TrueDensity, 0.25);
  EXPECT_LT(LargestDistance(SolidBody(8), result.pose, Truth), 0.5);
  EXPECT_EQ(result.covariance.rows(), 9);
  EXPECT_EQ(result.costs.size(), 2u);
  EXPECT_EQ(result.quality, RegistrationQuality::Ok);
  EXPECT_GT(result.precision, 0.0);
  EXPECT_GT(result.intensityPrecision, 0.0);
  ASSERT_FALSE(result.regions.empty());
  const RegionEstimate & whole = result.regions.back();
  double                 volume = 0.0;
  for (const Id4 & ids : result.mesh.tetrahedra)
  {
    const auto & x = result.mesh.points;
    volume += SignedVolume(x[ids[0]], x[ids[1]], x[ids[2]], x[ids[3]]);
  }
  EXPECT_EQ(whole.region, -1);
  EXPECT_NEAR(whole.volume, volume, 1e-6 * volume);
  EXPECT_NEAR(whole.mass, whole.density * whole.volume, 1e-9 * whole.mass);
  for (const double deviation : { whole.volumeDeviation, whole.densityDeviation, whole.massDeviation })
  {
    EXPECT_GT(deviation, 0.0);
  }
  EXPECT_LT(whole.densityDeviation, 0.1 * whole.density);

  const MeshArrays found = registration->GetOutput()->GetArrays();
  EXPECT_LT(MeanDistance(found.points, Moved(TrueBone().points, Truth)), 0.2);
  EXPECT_EQ(found.coefficients.size(), TrueBone().coefficients.size());
  ASSERT_EQ(result.pointDeviations.size(), found.points.size());
  for (const Vector3 & deviation : result.pointDeviations)
  {
    EXPECT_TRUE(deviation.minCoeff() > 0.0 && deviation.maxCoeff() < 10.0) << deviation.transpose();
  }
  const auto moved = registration->GetTransform()->TransformPoint(itk::Point<double, 3>(Vector3(1, 2, 3).data()));
  EXPECT_LT((Vector3(moved[0], moved[1], moved[2]) - result.pose.Apply({ 1, 2, 3 })).norm(), 1e-9);
}

TEST(DeformableRadiographRegistration, SearchesAgainWhereASearchLedAstray)
{
  const auto truth = Moved(TrueBone().points, Truth);
  for (int seed = 4; seed <= 6; ++seed)
  {
    auto registration = MakeRegistration();
    auto parameters = Parameters();
    parameters.searchTranslation = 30.0;
    parameters.searchRotation = 50.0;
    parameters.seed = seed;
    registration->SetParameters(parameters);
    registration->SetInitialTransform(PoseOf(20, -20, 20, 0.6, -0.5, 0.5).ToTransform());
    EXPECT_EQ(ErrorOf(registration), "");
    EXPECT_LT(MeanDistance(registration->GetResult().mesh.points, truth), 0.2) << "seed " << seed;
  }
}

TEST(DeformableRadiographRegistration, TurnsWhatTheViewsShow)
{
  const auto atlas = AtlasOf(WithTail(SolidBody(8)));
  const auto bone = Model(atlas)->Synthesize(TrueShape, Eigen::VectorXd::Constant(1, TrueDensity));
  auto       parameters = Parameters();
  parameters.intensities = false;
  const auto found = RegisterDeformable(atlas, TwoXRays(bone, Truth), RigidPose(), parameters, Execution());
  EXPECT_EQ(found.quality, RegistrationQuality::Ok);
  EXPECT_LT(MeanDistance(found.mesh.points, Moved(bone.points, Truth)), 1.0) << "the tail among them";
  // 64 mm up and down from the middle, with what a move of 10 mm would show.
  Vector3 sum = Vector3::Zero();
  double  count = 0.0;
  for (const Vector3 & x : atlas.mean.points)
  {
    sum += x.z() > 30.0 - 63.0 ? x : Vector3::Zero();
    count += x.z() > 30.0 - 63.0 ? 1.0 : 0.0;
  }
  EXPECT_LT((found.pose.centre - sum / count).norm(), 3.0) << found.pose.centre.transpose();
}

TEST(DeformableRadiographRegistration, AModeThatMovesAllOfTheBoneIsSearchedInItsPlace)
{
  // As one that does not: the same bone comes first.
  const auto first = [](const StatisticalModelContent & atlas) {
    Eigen::VectorXd coefficients;
    double          lowest = -1.0;
    auto            parameters = Parameters();
    parameters.intensities = false;
    RegisterDeformable(
      atlas, LineIntegrals(), RigidPose(), parameters, Execution(), [&](const Eigen::VectorXd & at, double cost) {
        coefficients = lowest < 0.0 ? at : coefficients;
        lowest = lowest < 0.0 ? cost : lowest;
      });
    return std::make_pair(coefficients, lowest);
  };
  const auto [inPlace, cost] = first(Atlas());
  const auto [aside, costAside] = first(AtlasOf(SolidBody(8), 60.0));
  EXPECT_LT((inPlace - aside).norm(), 0.05);
  EXPECT_NEAR(cost, costAside, 0.05 * cost);
}

TEST(DeformableRadiographRegistration, MovesWithViewsAndStart)
{
  auto straight = MakeRegistration();
  straight->SetSearchTranslation(0.0);
  straight->SetSearchRotation(0.0);
  straight->SetInitialTransform(Truth.ToTransform());
  straight->Update();

  // All of the geometry moved by `motion`: the views as seen from a space that is moved the other way.
  const RigidPose motion = PoseOf(40, -25, 60, 0.7, -0.4, 1.1);
  RigidPose       back;
  back.rotation = motion.rotation.transpose();
  back.translation = motion.ApplyInverse(Vector3::Zero());
  auto       turned = MakeRegistration();
  const auto xrays = LineIntegrals();
  for (unsigned int v = 0; v < 2; ++v)
  {
    auto geometry = XRayGeometry::New();
    geometry->SetView(back.ToModelSpace(xrays[v].view));
    turned->SetView(v, ToImage(xrays[v].values, xrays[v].view), geometry);
  }
  RigidPose initial;
  initial.rotation = motion.rotation * Truth.rotation;
  initial.translation = motion.Apply(Truth.Apply(Vector3::Zero()));
  turned->SetSearchTranslation(0.0);
  turned->SetSearchRotation(0.0);
  turned->SetInitialTransform(initial.ToTransform());
  turned->Update();
  EXPECT_LT(
    MeanDistance(turned->GetOutput()->GetArrays().points, Moved(straight->GetOutput()->GetArrays().points, motion)),
    0.02);
  EXPECT_LT((turned->GetResult().coefficients - straight->GetResult().coefficients).norm(), 0.02);
}

TEST(DeformableRadiographRegistration, SameResultForAnyNumberOfThreads)
{
  MeshArrays meshes[2];
  for (int i = 0; i < 2; ++i)
  {
    auto registration = MakeRegistration();
    registration->SetSmoothModes(6);
    registration->SetNumberOfWorkUnits(i == 0 ? 1 : 2);
    registration->Update();
    meshes[i] = registration->GetOutput()->GetArrays();
  }
  EXPECT_EQ(meshes[0].points, meshes[1].points);
  EXPECT_EQ(meshes[0].coefficients, meshes[1].coefficients);
}

TEST(DeformableRadiographRegistration, OneViewNeedsAPrior)
{
  auto registration = MakeRegistration(1);
  EXPECT_THAT(ErrorOf(registration), ::testing::HasSubstr("TranslationDeviation"));
  registration->SetSearchTranslation(0.0);
  registration->SetSearchRotation(0.0);
  registration->SetTranslationDeviation(2.0);
  registration->SetRotationDeviation(2.0);
  registration->SetInitialTransform(Truth.ToTransform());
  registration->Update();
  const auto & covariance = registration->GetResult().covariance;
  // The view looks along y. What it does not tell is as the prior has it.
  EXPECT_GT(covariance(1, 1), 4.0 * covariance(0, 0));
  EXPECT_LT(covariance(1, 1), 4.0 * 1.01);
}

TEST(DeformableRadiographRegistration, OneViewIsTrustedLess)
{
  DeformableRadiographParameters parameters = Parameters();
  parameters.searchTranslation = parameters.searchRotation = 0.0;
  parameters.translationDeviation = parameters.rotationDeviation = 2.0;
  parameters.intensities = false;
  auto       xrays = LineIntegrals();
  const auto beside = PoseOf(0, 0, 500, 0, 0, 0);
  const auto two = RegisterDeformable(Atlas(), xrays, beside, parameters, Execution());
  xrays.pop_back();
  const auto one = RegisterDeformable(Atlas(), xrays, beside, parameters, Execution());
  // They show nothing of the bone, so that the atlas alone speaks.
  EXPECT_TRUE(two.covariance.diagonal().tail<3>().isApproxToConstant(1.0));
  EXPECT_TRUE(one.covariance.diagonal().tail<3>().isApproxToConstant(1.5 * 1.5));
  // The pose's prior is what the user said.
  EXPECT_TRUE(one.covariance.diagonal().head<3>().isApproxToConstant(2.0 * 2.0));
}

TEST(DeformableRadiographRegistration, ABoneThatIsNotDistinctIsSuspect)
{
  // Noise leaves little of the edges.
  auto                             xrays = LineIntegrals();
  std::mt19937_64                  random(3);
  std::normal_distribution<double> noise(0.0, 0.12);
  for (RadiographView & xray : xrays)
  {
    for (float & x : xray.values)
    {
      x += static_cast<float>(noise(random));
    }
  }
  DeformableRadiographParameters parameters = Parameters();
  parameters.searchTranslation = parameters.searchRotation = 0.0;
  parameters.translationDeviation = parameters.rotationDeviation = 2.0;
  parameters.intensities = false;
  const auto two = RegisterDeformable(Atlas(), xrays, Truth, parameters, Execution());
  xrays.pop_back();
  const auto one = RegisterDeformable(Atlas(), xrays, Truth, parameters, Execution());
  for (const auto & result : { one, two })
  {
    ASSERT_GT(result.distinctness, 0.45) << "which of a bone that is known is ok";
    ASSERT_LT(result.distinctness, 1.5);
    EXPECT_EQ(result.quality, RegistrationQuality::Suspect);
  }
}

TEST(DeformableRadiographRegistration, ASurfaceThatMayLieOutsideIsCounted)
{
  double deviations[2];
  double whole = 0.0;
  double volume = 0.0;
  for (int i = 0; i < 2; ++i)
  {
    auto registration = MakeRegistration();
    registration->SetSurfaceDeviation(0.4 * i);
    registration->SetSearchTranslation(0.0);
    registration->SetSearchRotation(0.0);
    registration->SetInitialTransform(Truth.ToTransform());
    registration->Update();
    deviations[i] = registration->GetResult().regions.back().volumeDeviation;
    const MeshArrays & mesh = registration->GetResult().mesh;
    volume = registration->GetResult().regions.back().volume;
    whole = 0.0;
    for (const auto & face : BoundaryFaces(mesh))
    {
      const Vector3 & a = mesh.points[static_cast<std::size_t>(face[0])];
      whole += 0.5 * (mesh.points[static_cast<std::size_t>(face[1])] - a)
                       .cross(mesh.points[static_cast<std::size_t>(face[2])] - a)
                       .norm();
    }
  }
  // The two modes of shape take up most of a surface of which every point lies 0.4 mm outside.
  EXPECT_LT(deviations[0], 0.005 * volume);
  EXPECT_GT(deviations[1], 0.5 * 0.4 * whole);
  EXPECT_LT(deviations[1], 1.5 * 0.4 * whole);
}

TEST(DeformableRadiographRegistration, ABoneThatNoViewShowsMayBeAnywhere)
{
  auto registration = MakeRegistration();
  registration->SetIntensities(false);
  registration->SetSearchTranslation(0.0);
  registration->SetSearchRotation(0.0);
  registration->SetInitialTransform(PoseOf(0, 0, 500, 0, 0, 0).ToTransform());
  registration->Update();
  const DeformableRegistrationResult & result = registration->GetResult();
  EXPECT_EQ(result.quality, RegistrationQuality::Failed);
  EXPECT_EQ(result.coefficients.norm(), 0.0);
  ASSERT_TRUE(result.covariance.allFinite());
  EXPECT_GT(result.covariance.diagonal().head<3>().minCoeff(), 1e6);
  for (const Vector3 & deviation : result.pointDeviations)
  {
    EXPECT_GT(deviation.minCoeff(), 1e3);
  }
}

TEST(DeformableRadiographRegistration, TetrahedraThatCannotBeRepairedAreRefused)
{
  // Across the whole body: what no mode puts right.
  auto atlas = Atlas();
  for (std::size_t i = 0; i < 4; ++i)
  {
    atlas.mean.points[static_cast<std::size_t>(atlas.mean.tetrahedra.front()[i])] += 60.0 * Vector3::Unit(i % 3);
  }
  atlas.shape.mean = StackPoints(atlas.mean.points);
  auto registration = MakeRegistration();
  registration->SetModel(Model(std::move(atlas)));
  registration->SetSearchTranslation(0.0);
  registration->SetSearchRotation(0.0);
  EXPECT_THAT(ErrorOf(registration), ::testing::HasSubstr("cannot be repaired"));
}

TEST(DeformableRadiographRegistration, IsLazyAndTellsEachStep)
{
  auto   registration = MakeRegistration();
  int    steps = 0;
  double last = 0.0;
  auto   command = itk::FunctionCommand::New();
  command->SetCallback([&](const itk::EventObject &) {
    ++steps;
    last = registration->GetCurrentCost();
    EXPECT_EQ(registration->GetCurrentCoefficients().size(), 3);
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

TEST(DeformableRadiographRegistration, RefusesWhatItCannotUse)
{
  using ::testing::HasSubstr;
  EXPECT_THAT(ErrorOf(Registration::New()), HasSubstr("Model"));

  auto noView = Registration::New();
  noView->SetModel(Model());
  EXPECT_THAT(ErrorOf(noView), HasSubstr("There is no X-ray"));

  auto noGeometry = MakeRegistration();
  noGeometry->SetView(1, ToImage(std::vector<float>(96 * 96), ViewOf({ 0, 1, 0 })), nullptr);
  EXPECT_THAT(ErrorOf(noGeometry), HasSubstr("View 2 needs both"));

  auto constant = MakeRegistration();
  auto geometry = XRayGeometry::New();
  geometry->SetView(ViewOf({ 1, 0, 0 }));
  constant->SetView(1, ToImage(std::vector<float>(96 * 96, 3.0f), ViewOf({ 1, 0, 0 })), geometry);
  EXPECT_THAT(ErrorOf(constant), HasSubstr("View 2: "));

  auto noDensity = MakeRegistration();
  auto atlas = Atlas();
  atlas.mean.degree.clear();
  atlas.mean.coefficients.clear();
  atlas.mean.maximumDegree = -1;
  atlas.density = PrincipalModes();
  atlas.densityScores.resize(0, 0);
  noDensity->SetModel(Model(std::move(atlas)));
  EXPECT_THAT(ErrorOf(noDensity), HasSubstr("The input 'Model'"));

  auto few = MakeRegistration();
  auto three = Atlas();
  three.shapeScores = three.shapeScores.topRows(3).eval();
  few->SetModel(Model(std::move(three)));
  few->SetSmoothModes(9);
  EXPECT_THAT(ErrorOf(few), HasSubstr("give no smooth modes (0)"));

  // Density times mm, not attenuation.
  auto unit = MakeRegistration();
  for (unsigned int v = 0; v < 2; ++v)
  {
    const auto xray = TwoXRays(TrueBone(), Truth)[v];
    auto       view = XRayGeometry::New();
    view->SetView(xray.view);
    unit->SetView(v, ToImage(xray.values, xray.view), view);
  }
  EXPECT_THAT(ErrorOf(unit), HasSubstr("no line integrals of attenuation"));
  unit->SetIntensities(false);
  EXPECT_EQ(ErrorOf(unit), "");

  auto range = MakeRegistration();
  range->SetPatch(2);
  EXPECT_THAT(ErrorOf(range), HasSubstr("Patch is 2"));
}
TEST(DeformablePosterior, BonesDrawnScatterAsStated)
{
  auto registration = MakeRegistration();
  registration->SetSearchTranslation(0.0);
  registration->SetSearchRotation(0.0);
  registration->SetInitialTransform(Truth.ToTransform());
  registration->Update();
  const auto &              result = registration->GetResult();
  const DeformablePosterior posterior(Atlas(), Parameters(), result);
  constexpr int             draws = 400;
  std::vector<Vector3>      squares(result.mesh.points.size(), Vector3::Zero());
  for (int i = 0; i < draws; ++i)
  {
    const MeshArrays mesh = posterior.Draw(static_cast<std::uint64_t>(i));
    for (std::size_t p = 0; p < squares.size(); ++p)
    {
      squares[p] += (mesh.points[p] - result.mesh.points[p]).cwiseAbs2() / draws;
    }
  }
  Vector3 drawn = Vector3::Zero(), stated = Vector3::Zero();
  for (std::size_t p = 0; p < squares.size(); ++p)
  {
    drawn += squares[p];
    stated += result.pointDeviations[p].cwiseAbs2();
  }
  for (int k = 0; k < 3; ++k)
  {
    EXPECT_NEAR(std::sqrt(drawn[k] / stated[k]), 1.0, 0.15) << stated.transpose() / squares.size();
  }
  EXPECT_EQ(posterior.Draw(3).points, posterior.Draw(3).points);
  const auto factor = PosteriorFactor(result.covariance);
  EXPECT_LT((factor * factor.transpose() - result.covariance).norm(), 1e-9 * result.covariance.norm());
  auto others = Parameters();
  others.smoothModes = 3;
  EXPECT_THROW(DeformablePosterior(Atlas(), others, result), std::invalid_argument);
}
} // namespace DeformableRadiographRegistrationTests
