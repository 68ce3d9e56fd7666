/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneDensityImageFilter.h"

#include "boneDensityFitFilter.h"
#include "boneDensityTestMeshes.h"

#include <itkImageRegionConstIteratorWithIndex.h>
#include <itkPipelineMonitorImageFilter.h>
#include <itkStreamingImageFilter.h>

#include <gtest/gtest.h>

#include <cmath>

namespace DensityImageFilterTests
{
using namespace bone;
using Filter = DensityImageFilter<>;

/** Density Linear() on the block [0, 20] x [-15, 5] x [20, 40]. */
DensityMesh<double>::Pointer
LinearBlock()
{
  MeshArrays mesh = test::MakeBlock({ { 4, 4, 4 } }, Vector3(0, -15, 20), 5.0, 0.15);
  mesh.maximumDegree = 1;
  mesh.degree.assign(mesh.tetrahedra.size(), 1);
  for (const Id4 & tetra : mesh.tetrahedra)
  {
    for (IdType v : tetra)
    {
      mesh.coefficients.push_back(test::Linear(mesh.points[v]));
    }
  }
  return test::ToMesh(mesh);
}

bool
InBlock(const itk::Point<double, 3> & x, double margin)
{
  return x[0] > margin && x[0] < 20 - margin && x[1] > -15 + margin && x[1] < 5 - margin && x[2] > 20 + margin &&
         x[2] < 40 - margin;
}

TEST(DensityImageFilter, SamplesALinearDensityOnAnObliqueReferenceGrid)
{
  const auto reference = test::ObliqueImage<test::Image>([](const Vector3 &) { return 0; });
  auto       filter = Filter::New();
  filter->SetInput(LinearBlock());
  filter->SetReferenceImage(reference);
  filter->SetOutsideValue(-5000);
  filter->Update();
  const auto * image = filter->GetOutput();
  EXPECT_EQ(image->GetLargestPossibleRegion(), reference->GetLargestPossibleRegion());
  EXPECT_EQ(image->GetDirection(), reference->GetDirection());
  std::size_t inside = 0;
  for (itk::ImageRegionConstIteratorWithIndex<test::Image> it(image, image->GetBufferedRegion()); !it.IsAtEnd(); ++it)
  {
    itk::Point<double, 3> x;
    image->TransformIndexToPhysicalPoint(it.GetIndex(), x);
    if (InBlock(x, 1e-9))
    {
      ASSERT_NEAR(it.Get(), test::Linear(Vector3(x[0], x[1], x[2])), 1e-4);
      ++inside;
    }
    else if (!InBlock(x, -1e-9))
    {
      ASSERT_EQ(it.Get(), -5000);
    }
  }
  EXPECT_NEAR(static_cast<double>(inside) * 0.8 * 1.1 * 1.7, 8000, 150);
}

Filter::Pointer
OnGivenGrid(double start)
{
  auto                filter = Filter::New();
  Filter::SizeType    size = { { 12, 12, 12 } };
  Filter::SpacingType spacing;
  Filter::PointType   origin;
  spacing.Fill(2.0);
  origin[0] = start;
  origin[1] = start - 15;
  origin[2] = start + 20;
  filter->SetInput(LinearBlock());
  filter->SetSize(size);
  filter->SetSpacing(spacing);
  filter->SetOrigin(origin);
  return filter;
}

TEST(DensityImageFilter, FillsAGivenGridWithoutGapsOnFaces)
{
  // Voxel centres lie on the block's faces and on those of its undisturbed outer tetrahedra.
  auto filter = OnGivenGrid(0.0);
  filter->Update();
  for (itk::ImageRegionConstIteratorWithIndex<test::Image> it(filter->GetOutput(),
                                                              filter->GetOutput()->GetBufferedRegion());
       !it.IsAtEnd();
       ++it)
  {
    const auto index = it.GetIndex();
    const bool inside = index[0] <= 10 && index[1] <= 10 && index[2] <= 10;
    EXPECT_EQ(it.Get() != -1024, inside) << index;
  }
}

TEST(DensityImageFilter, HasTheSameOutputForAnyNumberOfThreads)
{
  std::vector<float> one;
  for (unsigned int threads : { 1u, 2u, 5u })
  {
    auto filter = OnGivenGrid(0.3);
    filter->SetNumberOfWorkUnits(threads);
    filter->Update();
    const float *            p = filter->GetOutput()->GetBufferPointer();
    const std::vector<float> all(p, p + filter->GetOutput()->GetBufferedRegion().GetNumberOfPixels());
    one = one.empty() ? all : one;
    EXPECT_EQ(all, one);
  }
}

TEST(DensityImageFilter, FillsTheRequestedRegionOnly)
{
  auto whole = OnGivenGrid(0.3);
  whole->Update();
  auto                    part = OnGivenGrid(0.3);
  test::Image::RegionType region;
  region.SetIndex({ { 3, 4, 2 } });
  region.SetSize({ { 5, 2, 6 } });
  part->GetOutput()->SetRequestedRegion(region);
  part->GetOutput()->Update();
  EXPECT_EQ(part->GetOutput()->GetBufferedRegion(), region);
  for (itk::ImageRegionConstIteratorWithIndex<test::Image> it(part->GetOutput(), region); !it.IsAtEnd(); ++it)
  {
    EXPECT_EQ(it.Get(), whole->GetOutput()->GetPixel(it.GetIndex()));
  }
}

TEST(DensityImageFilter, CanBeStreamed)
{
  auto whole = OnGivenGrid(0.3), pieces = OnGivenGrid(0.3);
  whole->Update();
  auto monitor = itk::PipelineMonitorImageFilter<test::Image>::New();
  monitor->SetInput(pieces->GetOutput());
  auto stream = itk::StreamingImageFilter<test::Image, test::Image>::New();
  stream->SetInput(monitor->GetOutput());
  stream->SetNumberOfStreamDivisions(4);
  stream->Update();
  EXPECT_TRUE(monitor->VerifyAllInputCanStream(4));
  const std::size_t count = whole->GetOutput()->GetBufferedRegion().GetNumberOfPixels();
  const float *     expected = whole->GetOutput()->GetBufferPointer();
  EXPECT_TRUE(std::equal(expected, expected + count, stream->GetOutput()->GetBufferPointer()));
}

TEST(DensityImageFilter, AnAbortLeavesTheFilterReusable)
{
  auto filter = OnGivenGrid(0.3);
  filter->SetNumberOfWorkUnits(1);
  filter->Update();
  const float *            p = filter->GetOutput()->GetBufferPointer();
  const std::size_t        count = filter->GetOutput()->GetBufferedRegion().GetNumberOfPixels();
  const std::vector<float> expected(p, p + count);
  std::vector<float>       seen;
  bool                     stop = true;
  filter->AddObserver(itk::ProgressEvent(), [&](const itk::EventObject &) {
    seen.push_back(filter->GetProgress());
    filter->SetAbortGenerateData(stop && seen.back() > 0.3F);
  });
  filter->Modified();
  EXPECT_THROW(filter->Update(), itk::ProcessAborted);
  stop = false;
  seen.clear();
  filter->Update();
  EXPECT_TRUE(std::is_sorted(seen.begin(), seen.end()));
  p = filter->GetOutput()->GetBufferPointer();
  EXPECT_EQ(std::vector<float>(p, p + count), expected);
}

TEST(DensityImageFilter, RoundsAndClipsToAnIntegerPixel)
{
  using ByteImage = itk::Image<unsigned char, 3>;
  auto filter = DensityImageFilter<DensityMesh<double>, ByteImage>::New();
  filter->SetInput(LinearBlock());
  filter->SetReferenceImage(test::ObliqueImage<test::Image>([](const Vector3 &) { return 0; }));
  filter->Update();
  const auto * image = filter->GetOutput();
  int          clipped = 0;
  for (itk::ImageRegionConstIteratorWithIndex<ByteImage> it(image, image->GetBufferedRegion()); !it.IsAtEnd(); ++it)
  {
    itk::Point<double, 3> x;
    image->TransformIndexToPhysicalPoint(it.GetIndex(), x);
    if (InBlock(x, 1e-9))
    {
      const double value = test::Linear(Vector3(x[0], x[1], x[2]));
      EXPECT_LE(std::abs(it.Get() - std::min(value, 255.0)), 0.5 + 1e-9);
      clipped += value > 255 ? 1 : 0;
    }
    else if (!InBlock(x, -1e-9))
    {
      EXPECT_EQ(it.Get(), 0); // OutsideValue is clipped too
    }
  }
  EXPECT_GT(clipped, 0);
}

TEST(DensityImageFilter, ReturnsTheImageThatAModelWasFittedTo)
{
  const auto image = test::ObliqueImage<test::Image>(test::Smooth);
  auto       fit = DensityFitFilter<test::Image>::New();
  fit->SetInput(test::ToMesh(test::MakeBlock({ { 4, 4, 4 } }, Vector3(0, -15, 20), 5.0, 0.15)));
  fit->SetImage(image);
  fit->SetDegree(4);
  auto sample = Filter::New();
  sample->SetInput(fit->GetOutput());
  sample->SetReferenceImage(image);
  sample->Update();
  double      sum = 0;
  std::size_t count = 0;
  for (itk::ImageRegionConstIteratorWithIndex<test::Image> it(image, image->GetBufferedRegion()); !it.IsAtEnd(); ++it)
  {
    const float value = sample->GetOutput()->GetPixel(it.GetIndex());
    if (value != -1024)
    {
      sum += std::abs(value - it.Get());
      ++count;
    }
  }
  EXPECT_LT(sum / static_cast<double>(count), 5); // of a range of 600
}

TEST(DensityImageFilter, RunsOnlyWhenSomethingChanged)
{
  auto fit = DensityFitFilter<test::Image>::New();
  fit->SetInput(test::ToMesh(test::MakeBlock({ { 2, 2, 2 } }, Vector3(5, -10, 25), 5.0, 0.1)));
  fit->SetImage(test::ObliqueImage<test::Image>(test::Smooth));
  auto sample = Filter::New();
  sample->SetInput(fit->GetOutput());
  sample->SetReferenceImage(fit->GetImage());
  int fits = 0, samples = 0;
  fit->AddObserver(itk::StartEvent(), [&fits](const itk::EventObject &) { ++fits; });
  sample->AddObserver(itk::StartEvent(), [&samples](const itk::EventObject &) { ++samples; });
  sample->Update();
  sample->Update();
  EXPECT_EQ(fits, 1);
  EXPECT_EQ(samples, 1);
  sample->SetOutsideValue(0);
  sample->Update();
  EXPECT_EQ(fits, 1);
  EXPECT_EQ(samples, 2);
  fit->SetDegree(2);
  sample->Update();
  EXPECT_EQ(fits, 2);
  EXPECT_EQ(samples, 3);
}

TEST(DensityImageFilter, RefusesAMissingMeshDensityOrGrid)
{
  auto filter = Filter::New();
  EXPECT_THROW(filter->Update(), itk::ExceptionObject);
  filter->SetInput(LinearBlock());
  EXPECT_THROW(filter->Update(), itk::ExceptionObject); // no grid
  filter = OnGivenGrid(0.0);
  Filter::SpacingType spacing;
  spacing.Fill(std::nan(""));
  filter->SetSpacing(spacing);
  EXPECT_THROW(filter->Update(), itk::ExceptionObject);
  filter = OnGivenGrid(0.0);
  filter->SetInput(test::ToMesh(test::MakeBlock({ { 2, 2, 2 } }, Vector3(0, 0, 0), 5.0, 0.1)));
  EXPECT_THROW(filter->Update(), itk::ExceptionObject); // no density
}

TEST(DensityImageFilter, MayBeNaNOutsideUnlessPixelsAreIntegers)
{
  auto filter = OnGivenGrid(0.3);
  filter->SetOutsideValue(std::nan(""));
  filter->Update();
  EXPECT_TRUE(std::isnan(filter->GetOutput()->GetPixel({ { 11, 11, 11 } })));
  auto shorts = DensityImageFilter<DensityMesh<double>, itk::Image<short, 3>>::New();
  shorts->SetInput(LinearBlock());
  shorts->SetReferenceImage(filter->GetOutput());
  shorts->SetOutsideValue(std::nan(""));
  EXPECT_THROW(shorts->Update(), itk::ExceptionObject);
}

TEST(DensityImageFilter, PrintsItsParameters)
{
  std::ostringstream text;
  Filter::New()->Print(text);
  EXPECT_NE(text.str().find("OutsideValue: -1024"), std::string::npos);
}
} // namespace DensityImageFilterTests
