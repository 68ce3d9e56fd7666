/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneDRRImageFilter.h"

#include "boneProgressWatch.h"
#include "boneRadiographTestMeshes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace DRRImageFilterTests
{
using namespace bone;
using Mesh = DensityMesh<double>;
using Image = itk::Image<float, 3>;
using Filter = DRRImageFilter<Mesh, Image>;

const Vector3 lower(-20, -15, -10), upper(20, 15, 14);

MeshArrays
BoxArrays(int degree = 3)
{
  auto arrays = test::GridMesh({ { 4, 3, 3 } }, lower, Vector3(10, 10, 8), 0.2);
  test::SetRandom(arrays, degree, 4);
  return arrays;
}

Mesh::Pointer
MakeMesh(const MeshArrays & arrays)
{
  auto mesh = Mesh::New();
  mesh->SetArrays(arrays);
  return mesh;
}

XRayGeometry::Pointer
MakeGeometry()
{
  auto geometry = XRayGeometry::New();
  geometry->SetView(
    XRayGeometry::Framing(lower, upper, Vector3(0.4, 1, 0.2).normalized(), Vector3::UnitZ(), 400, 600, 70));
  return geometry;
}

Filter::Pointer
MakeFilter(const MeshArrays & arrays = BoxArrays())
{
  auto filter = Filter::New();
  filter->SetInput(MakeMesh(arrays));
  filter->SetGeometry(MakeGeometry());
  return filter;
}

std::vector<float>
Pixels(const Image * image)
{
  return { image->GetBufferPointer(), image->GetBufferPointer() + image->GetBufferedRegion().GetNumberOfPixels() };
}

/** Counts the executions of a filter. */
struct Counter
{
  explicit Counter(itk::ProcessObject * filter)
  {
    filter->AddObserver(itk::StartEvent(), [this](const itk::EventObject &) { ++runs; });
  }
  int runs{ 0 };
};

void
ExpectRefusal(Filter * filter, const std::string & words)
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

TEST(DRRImageFilter, TheOutputKnowsWhereItIs)
{
  const auto filter = MakeFilter();
  filter->Update();
  const auto * image = filter->GetOutput();
  const auto * geometry = filter->GetGeometry();
  const auto & view = geometry->GetView();
  const auto   size = image->GetLargestPossibleRegion().GetSize();
  EXPECT_EQ(size[0], static_cast<unsigned int>(view.size[0]));
  EXPECT_EQ(size[1], static_cast<unsigned int>(view.size[1]));
  EXPECT_EQ(size[2], 1u);
  Image::PointType point;
  image->TransformIndexToPhysicalPoint({ { 12, 34, 0 } }, point);
  const Vector3 expected = geometry->GetPixelPoint(12, 34);
  for (int k = 0; k < 3; ++k)
  {
    EXPECT_NEAR(point[k], expected[k], 1e-9);
  }
}

TEST(DRRImageFilter, WritesTheKernelsIntegrals)
{
  const auto arrays = BoxArrays();
  const auto filter = MakeFilter(arrays);
  filter->Update();
  const auto         pixels = Pixels(filter->GetOutput());
  std::vector<float> expected(pixels.size());
  ProjectMesh(arrays.points, arrays, filter->GetGeometry()->GetView(), {}, Execution(), expected.data());
  EXPECT_EQ(pixels, expected);
}

TEST(DRRImageFilter, MakesSeveralViewsInOneRun)
{
  const auto one = MakeFilter(), both = MakeFilter();
  auto       other = XRayGeometry::New();
  other->SetView(XRayGeometry::Framing(lower, upper, Vector3::UnitX(), Vector3::UnitZ(), 400, 600, 45));
  both->SetGeometry(1, other);
  both->GetOutput(1)->Update();
  one->SetGeometry(MakeGeometry());
  one->Update();
  EXPECT_EQ(Pixels(both->GetOutput(0)), Pixels(one->GetOutput()));
  one->SetGeometry(other);
  one->Update();
  EXPECT_EQ(Pixels(both->GetOutput(1)), Pixels(one->GetOutput()));
  EXPECT_EQ(both->GetOutput(1)->GetOrigin(), one->GetOutput()->GetOrigin());
  Counter counter(both);
  both->Update();
  both->GetOutput(1)->Update();
  EXPECT_EQ(counter.runs, 0);
  auto view = other->GetView();
  view.source.y() += 1;
  other->SetView(view);
  both->Update();
  EXPECT_EQ(counter.runs, 1);
  both->SetGeometry(3, other);
  ExpectRefusal(both, "View 2");
}

TEST(DRRImageFilter, HasTheSameOutputForAnyNumberOfThreads)
{
  const auto one = MakeFilter(), many = MakeFilter();
  one->SetNumberOfWorkUnits(1);
  many->SetNumberOfWorkUnits(7);
  one->Update();
  many->Update();
  EXPECT_EQ(Pixels(one->GetOutput()), Pixels(many->GetOutput()));
}

TEST(DRRImageFilter, RunsAgainOnlyAfterAChange)
{
  const auto filter = MakeFilter();
  Counter    counter(filter);
  filter->Update();
  filter->Update();
  filter->GetOutput()->Update();
  EXPECT_EQ(counter.runs, 1);

  filter->SetMinimumRegion(filter->GetMinimumRegion());
  filter->Update();
  EXPECT_EQ(counter.runs, 1);
  filter->SetMinimumRegion(0);
  filter->Update();
  EXPECT_EQ(counter.runs, 2);
}

TEST(DRRImageFilter, AGeometryOrMeshEditedInPlaceRunsIt)
{
  const auto filter = MakeFilter();
  Counter    counter(filter);
  filter->Update();
  const auto before = Pixels(filter->GetOutput());

  auto * geometry = const_cast<XRayGeometry *>(filter->GetGeometry());
  auto   view = geometry->GetView();
  geometry->SetView(view);
  filter->Update();
  EXPECT_EQ(counter.runs, 1);
  view.source += Vector3(20, 0, 0);
  view.size[0] += 5;
  geometry->SetView(view);
  filter->Update();
  EXPECT_EQ(counter.runs, 2);
  EXPECT_EQ(filter->GetOutput()->GetLargestPossibleRegion().GetSize(0), static_cast<unsigned int>(view.size[0]));
  EXPECT_NE(Pixels(filter->GetOutput()), before);

  const_cast<Mesh *>(filter->GetInput())->SetArrays(BoxArrays(1));
  filter->Update();
  EXPECT_EQ(counter.runs, 3);
}

TEST(DRRImageFilter, WhatItKeepsIsOfTheMeshAndParametersThatItHas)
{
  // Each change alone, after a run that has kept the model; a filter that is new knows none.
  const auto filter = MakeFilter();
  filter->Update();
  const auto expectThatOfANewOne = [&filter](const MeshArrays & arrays) {
    filter->Update();
    const auto other = MakeFilter(arrays);
    other->SetGeometry(const_cast<XRayGeometry *>(filter->GetGeometry()));
    other->SetMinimumRegion(filter->GetMinimumRegion());
    other->SetHUToAttenuation(filter->GetHUToAttenuation());
    other->Update();
    EXPECT_EQ(Pixels(filter->GetOutput()), Pixels(other->GetOutput()));
  };
  auto       arrays = BoxArrays();
  const auto before = Pixels(filter->GetOutput());
  arrays.coefficients[0] += 100;
  filter->SetInput(MakeMesh(arrays));
  expectThatOfANewOne(arrays);
  EXPECT_NE(Pixels(filter->GetOutput()), before);
  auto geometry = XRayGeometry::New();
  geometry->SetView(XRayGeometry::Framing(lower, upper, Vector3::UnitX(), Vector3::UnitZ(), 400, 600, 45));
  filter->SetGeometry(geometry);
  expectThatOfANewOne(arrays);
  filter->SetHUToAttenuation(HUToAttenuation::WaterScaled);
  expectThatOfANewOne(arrays);
  const auto mesh = MakeMesh(arrays);
  filter->SetInput(mesh);
  filter->Update();
  arrays.points[0] += Vector3(0.5, 0.25, -0.5);
  mesh->SetArrays(arrays);
  expectThatOfANewOne(arrays);
  filter->SetHUToAttenuation(HUToAttenuation::Bilinear);
  EXPECT_THROW(filter->Update(), itk::ExceptionObject);
}

TEST(DRRImageFilter, WaterScaledIsThatOfWaterPlusTheScaledDensity)
{
  auto arrays = BoxArrays();
  arrays.quantity = DensityQuantity::HounsfieldUnit;
  const auto density = MakeFilter(arrays), attenuation = MakeFilter(arrays);
  test::SetConstant(arrays, 1);
  const auto chords = MakeFilter(arrays);
  attenuation->SetHUToAttenuation(HUToAttenuation::WaterScaled);
  attenuation->SetWaterAttenuation(0.025);
  density->Update();
  attenuation->Update();
  chords->Update();
  const auto d = Pixels(density->GetOutput()), mu = Pixels(attenuation->GetOutput()), l = Pixels(chords->GetOutput());
  for (std::size_t i = 0; i < d.size(); ++i)
  {
    EXPECT_NEAR(mu[i], 0.025 * (l[i] + d[i] / 1000), 1e-5);
  }
}

TEST(DRRImageFilter, TakesAMeshOfFloatsAndMakesAnImageOfDoubles)
{
  const auto arrays = BoxArrays();
  auto       mesh = DensityMesh<float>::New();
  mesh->SetArrays(arrays);
  auto filter = DRRImageFilter<DensityMesh<float>, itk::Image<double, 3>>::New();
  filter->SetInput(mesh);
  filter->SetGeometry(MakeGeometry());
  filter->Update();
  const auto reference = MakeFilter(arrays);
  reference->Update();
  const auto expected = Pixels(reference->GetOutput());
  for (std::size_t i = 0; i < expected.size(); ++i)
  {
    EXPECT_NEAR(filter->GetOutput()->GetBufferPointer()[i], expected[i], 1e-4);
  }
}

TEST(DRRImageFilter, RefusesWhatItCannotProject)
{
  auto filter = Filter::New();
  ExpectRefusal(filter, "Geometry");
  filter->SetGeometry(MakeGeometry());
  ExpectRefusal(filter, "Mesh");

  ExpectRefusal(MakeFilter(MeshArrays()), "no tetrahedra");
  auto arrays = test::GridMesh({ { 1, 1, 1 } }, lower, Vector3(10, 10, 8));
  ExpectRefusal(MakeFilter(arrays), "no density");

  arrays = BoxArrays();
  arrays.coefficients[5] = std::numeric_limits<double>::quiet_NaN();
  ExpectRefusal(MakeFilter(arrays), "not finite");

  arrays = BoxArrays();
  arrays.region.clear();
  filter = MakeFilter(arrays);
  filter->SetMinimumRegion(2);
  ExpectRefusal(filter, "no regions");
  filter->SetMaximumRegion(1);
  ExpectRefusal(filter, "MinimumRegion");

  arrays = BoxArrays();
  arrays.quantity = DensityQuantity::AshGramPerCubicCentimetre;
  filter = MakeFilter(arrays);
  EXPECT_NO_THROW(filter->Update());
  filter->SetHUToAttenuation(HUToAttenuation::WaterScaled);
  ExpectRefusal(filter, "HUToAttenuation");
  filter->SetHUToAttenuation(HUToAttenuation::None);
  filter->SetWaterAttenuation(-1);
  ExpectRefusal(filter, "WaterAttenuation");
}

TEST(DRRImageFilter, ReportsProgressThatDoesNotFallAndStopsOnAbort)
{
  const auto filter = MakeFilter();
  filter->SetGeometry(1, MakeGeometry());
  filter->SetNumberOfWorkUnits(1); // other threads do not report
  const test::ProgressWatch watch(filter);
  filter->Update();
  EXPECT_FALSE(watch.falls);
  EXPECT_EQ(watch.last, 1.0f);
  const auto before = Pixels(filter->GetOutput());
  filter->Modified();
  test::ExpectUsableAfterAbort(filter);
  EXPECT_EQ(Pixels(filter->GetOutput()), before);
}

TEST(DRRImageFilter, PrintsItsParameters)
{
  std::ostringstream text;
  MakeFilter()->Print(text);
  for (const char * name : { "HUToAttenuation: none", "MinimumRegion" })
  {
    EXPECT_THAT(text.str(), testing::HasSubstr(name));
  }
}
} // namespace DRRImageFilterTests
