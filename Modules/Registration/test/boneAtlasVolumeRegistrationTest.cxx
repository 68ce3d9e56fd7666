/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneAtlasVolumeRegistration.h"

#include "boneDeformableModel.h"
#include "boneQualityMeasures.h"
#include "boneTriangleDistance.h"
#include "boneTriangleSurface.h"
#include "boneVolumeDensity.h"
#include "boneVolumeTestBody.h"

#include <gtest/gtest.h>

namespace AtlasVolumeRegistrationTests
{
using namespace bone;
using Image = itk::Image<float, 3>;
using Registration = AtlasVolumeRegistration<>;

Image::Pointer
ToImage(const VoxelVolume & volume)
{
  auto                 image = Image::New();
  Image::PointType     origin;
  Image::SpacingType   spacing;
  Image::DirectionType direction;
  for (unsigned int c = 0; c < 3; ++c)
  {
    const Vector3 axis = volume.grid.axes.col(c);
    spacing[c] = axis.norm();
    origin[c] = volume.grid.origin[c];
    for (unsigned int r = 0; r < 3; ++r)
    {
      direction(r, c) = axis[r] / axis.norm();
    }
  }
  image->SetOrigin(origin);
  image->SetSpacing(spacing);
  image->SetDirection(direction);
  image->SetRegions(Image::SizeType{ { static_cast<itk::SizeValueType>(volume.grid.size[0]),
                                       static_cast<itk::SizeValueType>(volume.grid.size[1]),
                                       static_cast<itk::SizeValueType>(volume.grid.size[2]) } });
  image->Allocate();
  std::copy(volume.values.begin(), volume.values.end(), image->GetBufferPointer());
  return image;
}

/** A body of the atlas, with its first mode at 1.2 and its second at -0.9. */
MeshArrays
Body(const StatisticalModelContent & atlas)
{
  DeformableRadiographParameters parameters;
  parameters.smoothModes = 0;
  const DeformableModel model(atlas, parameters);
  Eigen::VectorXd       coefficients = Eigen::VectorXd::Zero(model.GetNumberOfCoefficients());
  coefficients.head<2>() << 1.2, -0.9;
  MeshArrays body = atlas.mean;
  body.points = model.MovePoints(coefficients);
  return body;
}

MeshArrays
Moved(MeshArrays body, const RigidPose & pose)
{
  for (Vector3 & x : body.points)
  {
    x = pose.Apply(x);
  }
  return body;
}

Registration::Pointer
MakeFilter(const StatisticalModelContent & atlas, const Image * image)
{
  auto model = StatisticalModel::New();
  model->SetContent(atlas);
  auto filter = Registration::New();
  filter->SetImage(image);
  filter->SetModel(model);
  filter->SetHypotheses(30000);
  filter->SetSmoothModes(30);
  return filter;
}

/** Mean distance of the found surface's points from the true one, of those that `counts` says. */
double
DistanceOf(const MeshArrays & found, const MeshArrays & truth, const std::function<bool(const Vector3 &)> & counts = {})
{
  std::vector<IdType>    ids;
  const TriangleSurface  there = ExteriorSurface(truth, ids);
  const TriangleDistance distance(there.points, there.triangles);
  double                 sum = 0.0, n = 0.0;
  for (const Vector3 & x : ExteriorSurface(found, ids).points)
  {
    if (!counts || counts(x))
    {
      sum += std::abs(distance.FindNearest(x).distance);
      n += 1.0;
    }
  }
  return sum / n;
}

double
VolumeOf(const MeshArrays & mesh)
{
  std::vector<IdType> ids;
  return EnclosedVolume(ExteriorSurface(mesh, ids));
}

TEST(AtlasVolumeRegistration, FindsABodyWhereverItLies)
{
  const auto       atlas = test::BarAtlas();
  const MeshArrays body = Body(atlas);
  const auto       image = ToImage(test::Scan(body, test::SomePose()));
  auto             filter = MakeFilter(atlas, image);
  filter->Update();
  const auto & result = filter->GetResult();
  const auto & mesh = filter->GetOutput()->GetArrays();
  EXPECT_EQ(result.quality, RegistrationQuality::Ok);
  EXPECT_FALSE(result.mirrored);
  EXPECT_LT(DistanceOf(mesh, Moved(body, test::SomePose())), 0.3);
  EXPECT_EQ(CountInverted(mesh), 0U);
  EXPECT_EQ(result.support.visible, 1.0);

  // Volume, density and label map agree with the body's.
  const auto & whole = result.regions.back();
  EXPECT_EQ(whole.region, -1);
  EXPECT_NEAR(whole.volume, VolumeOf(mesh), 1e-6 * whole.volume);
  EXPECT_NEAR(whole.volume, VolumeOf(body), 2.0 * whole.volumeDeviation);
  EXPECT_NEAR(whole.density, whole.mass / whole.volume, 1e-9 * whole.density);
  std::size_t labelled = 0;
  const auto  count = image->GetBufferedRegion().GetNumberOfPixels();
  for (std::size_t i = 0; i < count; ++i)
  {
    labelled += filter->GetLabelImage()->GetBufferPointer()[i] > 0 ? 1 : 0;
  }
  EXPECT_NEAR(static_cast<double>(labelled) * 1.5 * 1.5 * 1.5, whole.volume, 0.01 * whole.volume);
  ASSERT_EQ(filter->GetLabelImage()->GetOrigin(), image->GetOrigin());
}

TEST(AtlasVolumeRegistration, FindsABodyOfTheOtherSideInTheMirror)
{
  const auto       atlas = test::BarAtlas();
  const MeshArrays body = ReflectMesh(Body(atlas));
  const auto       image = ToImage(test::Scan(body, test::SomePose()));
  auto             filter = MakeFilter(atlas, image);
  filter->SetMirror(MirrorMode::Try);
  filter->Update();
  const auto & result = filter->GetResult();
  EXPECT_TRUE(result.mirrored);
  EXPECT_EQ(CountInverted(filter->GetOutput()->GetArrays()), 0U);
  EXPECT_LT(DistanceOf(filter->GetOutput()->GetArrays(), Moved(body, test::SomePose())), 0.3);
  // The pose is that of the reflected mean.
  MeshArrays mean = Moved(ReflectMesh(atlas.mean), result.pose);
  EXPECT_LT(DistanceOf(mean, Moved(body, test::SomePose())), 3.0);
}

TEST(AtlasVolumeRegistration, TheMirrorChangesNothingButTheSide)
{
  const auto        atlas = test::BarAtlas();
  const VoxelVolume ct = test::Scan(Body(atlas), test::SomePose());
  VoxelGrid         mirrored = ct.grid;
  mirrored.axes.row(0) *= -1.0;
  mirrored.origin[0] *= -1.0;
  AtlasVolumeParameters parameters;
  parameters.hypotheses = 30000;
  parameters.smoothModes = 30;
  const auto one = RegisterVolume(atlas, ct.View(), parameters, Execution());
  parameters.mirror = MirrorMode::Always;
  const auto            other = RegisterVolume(atlas, { mirrored, ct.values.data() }, parameters, Execution());
  const Eigen::Matrix3d mirror = Vector3(-1, 1, 1).asDiagonal();
  EXPECT_LT((other.coefficients - one.coefficients).cwiseAbs().maxCoeff(), 1e-9);
  ASSERT_EQ(other.mesh.points.size(), one.mesh.points.size());
  for (std::size_t p = 0; p < one.mesh.points.size(); p += 50)
  {
    EXPECT_LT((other.mesh.points[p] - mirror * one.mesh.points[p]).norm(), 1e-6);
    EXPECT_LT((other.pose.Apply(mirror * atlas.mean.points[p]) - mirror * one.pose.Apply(atlas.mean.points[p])).norm(),
              1e-6);
  }
  // In the CT's space translations are reflected, and rotation vectors, which are axial, reflected and turned round.
  const auto ofSteps = [](const VolumeRegistrationResult & result) {
    Eigen::Matrix<double, 6, 6> turn = Eigen::Matrix<double, 6, 6>::Zero();
    turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = result.pose.rotation;
    return Eigen::MatrixXd(turn * result.covariance.topLeftCorner<6, 6>() * turn.transpose());
  };
  Eigen::Matrix<double, 6, 6> reflect = Eigen::Matrix<double, 6, 6>::Zero();
  reflect.topLeftCorner<3, 3>() = mirror;
  reflect.bottomRightCorner<3, 3>() = -mirror;
  const Eigen::MatrixXd expected = reflect * ofSteps(one) * reflect.transpose();
  EXPECT_LT((ofSteps(other) - expected).cwiseAbs().maxCoeff(), 1e-6 * expected.cwiseAbs().maxCoeff());
  EXPECT_GT(std::abs(expected(0, 1)), 1e-6 * expected.cwiseAbs().maxCoeff()); // which changes its sign
}

TEST(AtlasVolumeRegistration, WhatTheImageDoesNotShowFollowsTheAtlas)
{
  const auto       atlas = test::BarAtlas();
  const MeshArrays body = Body(atlas);
  VoxelVolume      ct = test::Scan(body, RigidPose());
  ct.grid.size[2] = static_cast<int>((50.0 - ct.grid.origin[2]) / 1.5); // of 83 mm
  ct.values.resize(ct.grid.NumberOfVoxels());
  auto filter = MakeFilter(atlas, ToImage(ct));
  filter->Update();
  const auto & result = filter->GetResult();
  const auto & mesh = filter->GetOutput()->GetArrays();
  const double end = ct.grid.Centre(0, 0, ct.grid.size[2] - 1)[2];
  EXPECT_LT(result.support.visible, 0.8);
  EXPECT_LT(DistanceOf(mesh, body, [end](const Vector3 & x) { return x[2] < end; }), 0.4);
  EXPECT_LT(DistanceOf(mesh, body), 1.5);
  const auto beyond = CellsBeyond(mesh, ct.View());
  ASSERT_GT(std::count(beyond.begin(), beyond.end(), true), 100);
  for (std::size_t t = 0; t < beyond.size(); ++t)
  {
    if (beyond[t])
    {
      ASSERT_EQ(mesh.coefficients[4 * t], atlas.mean.coefficients[4 * t]) << t;
    }
  }
}

TEST(AtlasVolumeRegistration, IsTheSameForAnyNumberOfThreads)
{
  const auto atlas = test::BarAtlas();
  const auto image = ToImage(test::Scan(Body(atlas), test::SomePose()));
  auto       one = MakeFilter(atlas, image), two = MakeFilter(atlas, image);
  one->SetNumberOfWorkUnits(1);
  two->SetNumberOfWorkUnits(2);
  one->Update();
  two->Update();
  EXPECT_EQ(one->GetOutput()->GetArrays().points, two->GetOutput()->GetArrays().points);
  EXPECT_EQ(one->GetOutput()->GetArrays().coefficients, two->GetOutput()->GetArrays().coefficients);
}

TEST(AtlasVolumeRegistration, TakesImagesOfIntegers)
{
  using Shorts = itk::Image<short, 3>;
  const auto atlas = test::BarAtlas();
  const auto body = Body(atlas);
  const auto image = ToImage(test::Scan(body, test::SomePose()));
  auto       shorts = Shorts::New();
  shorts->CopyInformation(image);
  shorts->SetRegions(image->GetBufferedRegion());
  shorts->Allocate();
  std::transform(image->GetBufferPointer(),
                 image->GetBufferPointer() + image->GetBufferedRegion().GetNumberOfPixels(),
                 shorts->GetBufferPointer(),
                 [](float v) { return static_cast<short>(std::lround(v)); });
  auto model = StatisticalModel::New();
  model->SetContent(atlas);
  auto filter = AtlasVolumeRegistration<Shorts, DensityMesh<float>, itk::Image<unsigned char, 3>>::New();
  filter->SetImage(shorts);
  filter->SetModel(model);
  filter->SetHypotheses(30000);
  filter->SetSmoothModes(30);
  filter->Update();
  EXPECT_LT(DistanceOf(filter->GetOutput()->GetArrays(), Moved(body, test::SomePose())), 0.3);
  EXPECT_GT(std::count(filter->GetLabelImage()->GetBufferPointer(),
                       filter->GetLabelImage()->GetBufferPointer() + shorts->GetBufferedRegion().GetNumberOfPixels(),
                       1),
            1000);
}

TEST(AtlasVolumeRegistration, RefusesACTWithoutTheBone)
{
  const auto  atlas = test::BarAtlas();
  VoxelVolume air = test::Scan(Body(atlas), RigidPose());
  VoxelVolume ball = air;
  for (std::size_t i = 0; i < air.values.size(); ++i)
  {
    const auto    row = static_cast<std::size_t>(air.grid.size[0]), slice = row * air.grid.size[1];
    const Vector3 x =
      air.grid.Centre(static_cast<int>(i % row), static_cast<int>(i % slice / row), static_cast<int>(i / slice));
    air.values[i] = -1000.0F + static_cast<float>(i % 7);
    ball.values[i] = (x - Vector3(5, 0, 40)).norm() < 22.0 ? 900.0F : 40.0F;
  }
  for (const VoxelVolume & ct : { air, ball })
  {
    auto filter = MakeFilter(atlas, ToImage(ct));
    EXPECT_THROW(filter->Update(), itk::ExceptionObject);
  }
}

TEST(AtlasVolumeRegistration, RefusesWhatItCannotUse)
{
  auto       atlas = test::BarAtlas();
  const auto image = ToImage(test::Scan(Body(atlas), RigidPose()));
  const auto message = [&](const StatisticalModelContent & content, const Image * ct) -> std::string {
    try
    {
      MakeFilter(content, ct)->Update();
    }
    catch (const itk::ExceptionObject & error)
    {
      return error.GetDescription();
    }
    return "";
  };
  EXPECT_NE(message(atlas, nullptr).find("Image"), std::string::npos);
  auto other = atlas;
  other.mean.quantity = DensityQuantity::AshGramPerCubicCentimetre;
  EXPECT_NE(message(other, image).find("not in HU"), std::string::npos);
  other = atlas;
  other.shapeScores = Eigen::MatrixXd(0, 2);
  other.subjects.clear();
  EXPECT_NE(message(other, image).find("four"), std::string::npos);
  auto hole = ToImage(test::Scan(Body(atlas), RigidPose()));
  hole->SetPixel({ { 3, 3, 3 } }, std::numeric_limits<float>::quiet_NaN());
  EXPECT_NE(message(atlas, hole).find("not finite"), std::string::npos);
}

TEST(AtlasVolumeRegistration, TakesTheDensityOfWhatTheCTShows)
{
  const auto        atlas = test::BarAtlas();
  const VoxelVolume ct = test::Scan(atlas.mean, RigidPose());
  VolumeView        half = ct.View();
  half.grid.size[2] /= 2;
  for (const double score : { -1.0, 1.5 })
  {
    MeshArrays fitted = atlas.mean;
    for (double & c : fitted.coefficients)
    {
      c *= 1.0 + 0.1 * score;
    }
    for (const VolumeView & view : { ct.View(), half })
    {
      VolumeRegistrationResult result;
      result.mesh = atlas.mean;
      RegionEstimate whole;
      whole.region = -1;
      whole.volume = VolumeOf(atlas.mean);
      whole.volumeDeviation = 0.02 * whole.volume;
      result.regions = { whole };
      TakeVolumeDensity(atlas, view, {}, fitted, result);
      ASSERT_EQ(result.densityScores.size(), 1);
      EXPECT_NEAR(result.densityScores[0], score, 0.02);
      const auto beyond = CellsBeyond(atlas.mean, view);
      // The grid's axes are those of space.
      const double end = view.grid.Centre(0, 0, view.grid.size[2] - 1)[2];
      for (std::size_t t = 0; t < beyond.size(); ++t)
      {
        const Id4 & ids = atlas.mean.tetrahedra[t];
        ASSERT_EQ(beyond[t], std::any_of(ids.begin(), ids.end(), [&](IdType p) {
                    return atlas.mean.points[static_cast<std::size_t>(p)][2] > end;
                  }));
      }
      for (std::size_t t = 0; t < beyond.size(); ++t)
      {
        ASSERT_EQ(result.mesh.coefficients[4 * t], (beyond[t] ? atlas.mean : fitted).coefficients[4 * t]);
      }
      EXPECT_NEAR(result.regions[0].massDeviation,
                  0.02 * 0.5 * (result.regions[0].density + 40.0) * whole.volume,
                  1e-6 * result.regions[0].mass);
    }
  }
}
} // namespace AtlasVolumeRegistrationTests
