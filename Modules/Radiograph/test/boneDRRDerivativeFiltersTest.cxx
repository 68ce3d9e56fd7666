/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneDRRAdjointFilter.h"
#include "boneDRRDerivativeImageFilter.h"

#include "boneProgressWatch.h"
#include "boneRadiographTestMeshes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace DRRDerivativeFiltersTests
{
using namespace bone;
using Mesh = DensityMesh<double>;
using Image = itk::Image<float, 3>;
using Forward = DRRDerivativeImageFilter<Mesh, Image>;
using Backward = DRRAdjointFilter<Mesh, Image>;

const Vector3 lower(-20, -15, -10), upper(20, 15, 14);

MeshArrays
Arrays()
{
  auto arrays = test::GridMesh({ { 3, 2, 2 } }, lower, Vector3(13, 15, 12), 0.2);
  test::SetRandom(arrays, 3, 4);
  return arrays;
}

Mesh::Pointer
MakeMesh(const MeshArrays & arrays = Arrays())
{
  auto mesh = Mesh::New();
  mesh->SetArrays(arrays);
  return mesh;
}

XRayGeometry::Pointer
Look(const Vector3 & beam, int pixels = 40)
{
  auto geometry = XRayGeometry::New();
  geometry->SetView(XRayGeometry::Framing(lower, upper, beam.normalized(), Vector3::UnitZ(), 400, 600, pixels));
  return geometry;
}
// Along the grid's planes rays would pass through edges, where an image has no derivative.
const Vector3 front(0.4, 1, 0.2), side(1, 0.1, 0.05);

RadiographModes
Modes(const MeshArrays & arrays)
{
  RadiographModes modes;
  modes.pose = true;
  modes.shape.resize(1);
  for (const Vector3 & p : arrays.points)
  {
    modes.shape[0].emplace_back(0.02 * p.y(), 0.01 * p.z(), -0.03 * p.x());
  }
  modes.density = { arrays.coefficients };
  return modes;
}

/** As large as the view. */
Image::Pointer
MakeImage(const XRayGeometry * geometry, float value)
{
  const auto & size = geometry->GetView().size;
  auto         image = Image::New();
  image->SetRegions(Image::RegionType(
    { { 0, 0, 0 } }, { { static_cast<unsigned int>(size[0]), static_cast<unsigned int>(size[1]), 1 } }));
  image->Allocate();
  image->FillBuffer(value);
  return image;
}

std::vector<float>
Pixels(const Image * image)
{
  return { image->GetBufferPointer(), image->GetBufferPointer() + image->GetBufferedRegion().GetNumberOfPixels() };
}

template <typename TFilter>
void
ExpectRefusal(TFilter * filter, const std::string & words)
{
  try
  {
    filter->Update();
    ADD_FAILURE() << "not refused: " << words;
  }
  catch (const itk::ExceptionObject & error)
  {
    EXPECT_THAT(error.what(), testing::HasSubstr(words));
  }
}

TEST(DRRDerivativeImageFilter, WritesTheKernelsImagesInTheViewsPlace)
{
  const auto arrays = Arrays();
  const auto modes = Modes(arrays);
  auto       filter = Forward::New();
  filter->SetInput(MakeMesh(arrays));
  filter->SetGeometry(Look(front));
  filter->SetModes(modes);
  filter->Update();
  std::vector<std::vector<float>> expected(1 + modes.Count(), Pixels(filter->GetOutput()));
  std::vector<float *>            pointers;
  for (auto & image : expected)
  {
    pointers.push_back(image.data());
  }
  ProjectMeshDerivatives(arrays.points, arrays, filter->GetGeometry()->GetView(), {}, modes, Execution(), pointers);
  ASSERT_EQ(filter->GetNumberOfIndexedOutputs(), 9u);
  for (unsigned int i = 0; i < 9; ++i)
  {
    EXPECT_EQ(Pixels(filter->GetOutput(i)), expected[i]) << i;
    EXPECT_EQ(filter->GetOutput(i)->GetOrigin(), filter->GetOutput()->GetOrigin());
  }
  // The density mode is the density itself.
  const auto byDensity = Pixels(filter->GetDerivative(7));
  for (std::size_t i = 0; i < byDensity.size(); ++i)
  {
    EXPECT_NEAR(byDensity[i], expected[0][i], 1e-4);
  }
}

TEST(DRRDerivativeImageFilter, RunsAgainOnlyAfterAChange)
{
  int  runs = 0;
  auto filter = Forward::New();
  filter->AddObserver(itk::StartEvent(), [&](const itk::EventObject &) { ++runs; });
  filter->SetInput(MakeMesh());
  filter->SetGeometry(Look(front));
  filter->SetModes(Modes(Arrays()));
  filter->Update();
  filter->GetDerivative(3)->Update();
  EXPECT_EQ(runs, 1);
  filter->SetModes({});
  filter->Update();
  EXPECT_EQ(runs, 2);
  EXPECT_EQ(filter->GetNumberOfIndexedOutputs(), 1u);
}

TEST(DRRDerivativeImageFilter, RefusesModesThatDoNotFit)
{
  auto filter = Forward::New();
  filter->SetInput(MakeMesh());
  filter->SetGeometry(Look(front));
  auto modes = Modes(Arrays());
  modes.shape[0].pop_back();
  filter->SetModes(modes);
  ExpectRefusal(filter.GetPointer(), "Shape mode 0");
  modes = Modes(Arrays());
  modes.density[0].push_back(1);
  filter->SetModes(modes);
  ExpectRefusal(filter.GetPointer(), "Density mode 0");
  filter->SetModes({});
  filter->SetGeometry(1, Look(front));
  ExpectRefusal(filter.GetPointer(), "second view");
}

TEST(DRRAdjointFilter, IsTheTransposeSummedOverTheViews)
{
  const auto arrays = Arrays();
  const auto mesh = MakeMesh(arrays);
  auto       backward = Backward::New();
  backward->SetInput(mesh);
  backward->SetHUToAttenuation(HUToAttenuation::WaterScaled);
  RadiographModes modes = Modes(arrays);
  modes.pose = false;
  double forwardShape = 0, forwardDensity = 0;
  for (unsigned int view = 0; view < 2; ++view)
  {
    auto forward = Forward::New();
    forward->SetInput(mesh);
    forward->SetGeometry(view == 0 ? Look(front) : Look(side, 31));
    forward->SetHUToAttenuation(HUToAttenuation::WaterScaled);
    forward->SetModes(modes);
    forward->Update();
    const auto weights = MakeImage(forward->GetGeometry(), 0);
    const auto shape = Pixels(forward->GetDerivative(0)), density = Pixels(forward->GetDerivative(1));
    for (std::size_t i = 0; i < shape.size(); ++i)
    {
      const auto weight = static_cast<float>(1 + i % 3);
      weights->GetBufferPointer()[i] = weight;
      forwardShape += weight * shape[i];
      forwardDensity += weight * density[i];
    }
    backward->SetImage(view, weights);
    backward->SetGeometry(view, forward->GetGeometry());
  }
  backward->Update();
  const auto & gradient = backward->GetOutput()->GetCells().coefficients;
  double       byDensity = 0, byShape = 0;
  for (std::size_t c = 0; c < gradient.size(); ++c)
  {
    byDensity += gradient[c] * modes.density[0][c];
  }
  for (std::size_t p = 0; p < arrays.points.size(); ++p)
  {
    byShape += backward->GetPointGradient()[p].dot(modes.shape[0][p]);
  }
  EXPECT_NEAR(byDensity, forwardDensity, 1e-5 * std::abs(forwardDensity));
  EXPECT_NEAR(byShape, forwardShape, 1e-5 * std::abs(forwardShape));
}

TEST(DRRAdjointFilter, DoesNotDependOnThreadsAndRunsAgainOnlyAfterAChange)
{
  const auto          geometry = Look(front);
  const auto          image = MakeImage(geometry, 0.5f);
  std::vector<double> gradients[2];
  for (unsigned int k = 0; k < 2; ++k)
  {
    int  runs = 0;
    auto filter = Backward::New();
    filter->AddObserver(itk::StartEvent(), [&](const itk::EventObject &) { ++runs; });
    filter->SetInput(MakeMesh());
    filter->SetImage(image);
    filter->SetGeometry(geometry);
    filter->SetNumberOfWorkUnits(k == 0 ? 1 : 5);
    filter->Update();
    filter->Update();
    EXPECT_EQ(runs, 1);
    gradients[k] = filter->GetOutput()->GetCells().coefficients;
    filter->SetMinimumRegion(2);
    filter->Update();
    EXPECT_EQ(runs, 2);
    EXPECT_NE(filter->GetOutput()->GetCells().coefficients, gradients[k]);
  }
  EXPECT_EQ(gradients[0], gradients[1]);
}

TEST(DRRAdjointFilter, RefusesWhatDoesNotFit)
{
  const auto geometry = Look(front);
  auto       filter = Backward::New();
  filter->SetInput(MakeMesh());
  filter->SetGeometry(geometry);
  ExpectRefusal(filter.GetPointer(), "Image");
  filter->SetImage(MakeImage(Look(front, 41), 1));
  ExpectRefusal(filter.GetPointer(), "its view has 40 columns");
  filter->SetImage(MakeImage(geometry, std::numeric_limits<float>::infinity()));
  ExpectRefusal(filter.GetPointer(), "not finite");
  filter->SetImage(MakeImage(geometry, 1));
  filter->SetGeometry(1, geometry);
  ExpectRefusal(filter.GetPointer(), "View 1 has no Image");
  filter->SetImage(1, MakeImage(geometry, 1));
  filter->SetHUToAttenuation(HUToAttenuation::Bilinear);
  ExpectRefusal(filter.GetPointer(), "no line");
}

TEST(DRRDerivativeImageFilter, ReportsProgressThatDoesNotFallAndStopsOnAbort)
{
  const auto arrays = Arrays();
  auto       filter = Forward::New();
  filter->SetInput(MakeMesh(arrays));
  filter->SetGeometry(Look(front));
  filter->SetModes(Modes(arrays));
  filter->SetNumberOfWorkUnits(1);
  const test::ProgressWatch watch(filter);
  filter->Update();
  EXPECT_FALSE(watch.falls);
  EXPECT_EQ(watch.last, 1.0f);
  EXPECT_GE(watch.steps, 10);
  const auto before = Pixels(filter->GetDerivative(7));
  filter->Modified();
  test::ExpectUsableAfterAbort(filter);
  EXPECT_EQ(Pixels(filter->GetDerivative(7)), before);
}

TEST(DRRAdjointFilter, ReportsProgressOfTwoViewsThatDoesNotFallAndStopsOnAbort)
{
  auto arrays = test::GridMesh({ { 10, 10, 10 } }, lower, Vector3(4, 3, 2.4), 0.2); // several chunks of cells
  test::SetRandom(arrays, 3, 4);
  auto filter = Backward::New();
  filter->SetInput(MakeMesh(arrays));
  for (unsigned int view = 0; view < 2; ++view)
  {
    const auto geometry = Look(view == 0 ? front : Vector3(Vector3::UnitX()));
    filter->SetImage(view, MakeImage(geometry, 1));
    filter->SetGeometry(view, geometry);
  }
  filter->SetNumberOfWorkUnits(1);
  const test::ProgressWatch watch(filter);
  filter->Update();
  EXPECT_FALSE(watch.falls);
  EXPECT_EQ(watch.last, 1.0f);
  EXPECT_GE(watch.steps, 10);
  const auto before = filter->GetOutput()->GetCells().coefficients;
  filter->Modified();
  test::ExpectUsableAfterAbort(filter);
  EXPECT_EQ(filter->GetOutput()->GetCells().coefficients, before);
}
} // namespace DRRDerivativeFiltersTests
