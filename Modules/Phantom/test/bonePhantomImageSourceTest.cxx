/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "bonePhantomImageSource.h"

#include "boneFemurPhantom.h"
#include "boneHemipelvisPhantom.h"
#include "boneMakePhantom.h"

#include <itkCommand.h>
#include <itkImageRegionConstIteratorWithIndex.h>
#include <itkPipelineMonitorImageFilter.h>
#include <itkStreamingImageFilter.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

using namespace bone;

namespace PhantomImageSourceTests
{
using ImageType = itk::Image<float, 3>;
using LabelType = itk::Image<short, 3>;
using SourceType = PhantomImageSource<ImageType>;

SourceType::Pointer
MakeSource(const std::string & name, double spacing, double sliceSpacing)
{
  auto                    source = SourceType::New();
  SourceType::SpacingType size;
  size[0] = size[1] = spacing;
  size[2] = sliceSpacing;
  source->SetModel(MakePhantom(name));
  source->SetSpacing(size);
  // Narrower than the voxels: a sharp and quickly made image.
  SourceType::SpacingType width;
  width.Fill(1.0);
  source->SetPointSpread(width);
  return source;
}

SourceType::DirectionType
Oblique()
{
  SourceType::DirectionType turn;
  SourceType::DirectionType tilt;
  turn.SetIdentity();
  tilt.SetIdentity();
  turn[0][0] = turn[1][1] = std::cos(0.4);
  turn[0][1] = -std::sin(0.4);
  turn[1][0] = std::sin(0.4);
  tilt[1][1] = tilt[2][2] = std::cos(-0.3);
  tilt[1][2] = -std::sin(-0.3);
  tilt[2][1] = std::sin(-0.3);
  return turn * tilt;
}

Vector3
PointOf(const itk::ImageBase<3> * image, const itk::Index<3> & index)
{
  itk::Point<double, 3> point;
  image->TransformIndexToPhysicalPoint(index, point);
  return { point[0], point[1], point[2] };
}

/** Connected parts (over edges) of the bone, or of the background, in slice k of a label map. */
int
CountComponents(const LabelType * labels, itk::IndexValueType k, bool background)
{
  const auto                         size = labels->GetLargestPossibleRegion().GetSize();
  const auto                         columns = static_cast<long>(size[0]);
  const auto                         rows = static_cast<long>(size[1]);
  std::vector<std::pair<long, long>> waiting;
  std::vector<bool>                  done(size[0] * size[1], false);
  int                                components = 0;
  const auto                         visit = [&](long i, long j) {
    if (i < 0 || j < 0 || i >= columns || j >= rows || done[j * columns + i] ||
        (labels->GetPixel({ { i, j, k } }) == 0) != background)
    {
      return false;
    }
    done[j * columns + i] = true;
    waiting.emplace_back(i, j);
    return true;
  };
  for (long n = 0; n < columns * rows; ++n)
  {
    components += visit(n % columns, n / columns) ? 1 : 0;
    while (!waiting.empty())
    {
      const auto [i, j] = waiting.back();
      waiting.pop_back();
      visit(i - 1, j);
      visit(i + 1, j);
      visit(i, j - 1);
      visit(i, j + 1);
    }
  }
  return components;
}

std::string
ErrorOf(SourceType * source)
{
  try
  {
    source->Update();
  }
  catch (const itk::ExceptionObject & error)
  {
    return error.GetDescription();
  }
  return "";
}

TEST(PhantomImageSource, LabelsAgreeWithTheModelOnAnObliqueAnisotropicGrid)
{
  for (const std::string & name : PhantomNames())
  {
    auto source = MakeSource(name, 1.7, 3.1);
    source->SetDirection(Oblique());
    source->Update();
    const LabelType * labels = source->GetLabelOutput();
    std::size_t       inside = 0;
    for (itk::ImageRegionConstIteratorWithIndex<LabelType> it(labels, labels->GetBufferedRegion()); !it.IsAtEnd(); ++it)
    {
      const int region = source->GetModel()->Region(PointOf(labels, it.GetIndex()));
      ASSERT_EQ(it.Get(), region);
      inside += region != 0 ? 1 : 0;
    }
    EXPECT_GT(inside, 5000U);
  }
}

TEST(PhantomImageSource, UsesTheGridItIsGiven)
{
  auto                  source = MakeSource("femur", 0.9, 1.4);
  SourceType::PointType origin;
  origin[0] = 12.0;
  origin[1] = -31.0;
  origin[2] = 3.0;
  source->FitToBoneOff();
  source->SetDirection(Oblique());
  source->SetOrigin(origin);
  source->SetSize({ { 40, 50, 12 } });
  source->SetStartIndex({ { -7, 3, 5 } });
  source->Update();
  const ImageType * image = source->GetOutput();
  EXPECT_EQ(image->GetOrigin(), origin);
  EXPECT_EQ(image->GetBufferedRegion().GetIndex(), (itk::Index<3>{ { -7, 3, 5 } }));
  EXPECT_EQ(source->GetLabelOutput()->GetBufferedRegion(), image->GetBufferedRegion());
  int bone = 0;
  for (itk::ImageRegionConstIteratorWithIndex<ImageType> it(image, image->GetBufferedRegion()); !it.IsAtEnd(); ++it)
  {
    const Vector3 x = PointOf(image, it.GetIndex());
    const auto    levels = source->GetModel()->EvaluateLevels(x);
    ASSERT_EQ(source->GetLabelOutput()->GetPixel(it.GetIndex()), PhantomModel::RegionOf(levels));
    if (std::abs(levels[0]) > 5.0 && std::abs(levels[1]) > 5.0 && std::abs(levels[2]) > 5.0)
    {
      ASSERT_NEAR(it.Get(), source->GetModel()->Density(x), 3.0);
      bone += levels[0] < 0.0 ? 1 : 0;
    }
  }
  EXPECT_GT(bone, 200);
}

TEST(PhantomImageSource, FitsTheBone)
{
  for (const bool oblique : { false, true })
  {
    auto source = MakeSource("hemipelvis", 3.0, 3.0);
    source->SetMargin(6.0);
    if (oblique)
    {
      source->SetDirection(Oblique());
    }
    source->Update();
    const auto region = source->GetLabelOutput()->GetBufferedRegion();
    for (itk::ImageRegionConstIteratorWithIndex<LabelType> it(source->GetLabelOutput(), region); !it.IsAtEnd(); ++it)
    {
      bool border = false;
      for (int a = 0; a < 3; ++a)
      {
        const auto place = it.GetIndex()[a];
        border = border || place < 2 || place >= static_cast<itk::IndexValueType>(region.GetSize(a)) - 2;
      }
      ASSERT_FALSE(border && it.Get() != 0);
    }
  }
}

TEST(PhantomImageSource, FemurLeavesTheImageAtItsLowerBorderOnly)
{
  auto source = MakeSource("femur", 2.0, 3.0);
  source->Update();
  const LabelType * labels = source->GetLabelOutput();
  const auto        region = labels->GetBufferedRegion();
  const double      cut = source->GetModel()->GetLowerCorner().z();
  EXPECT_NEAR(labels->GetOrigin()[2] - 1.5, cut, 1e-9);
  int below = 0;
  for (itk::ImageRegionConstIteratorWithIndex<LabelType> it(labels, region); !it.IsAtEnd(); ++it)
  {
    const auto index = it.GetIndex();
    below += index[2] == 0 && it.Get() != 0 ? 1 : 0;
    const bool side = index[0] == 0 || index[1] == 0 || index[0] + 1 == static_cast<long>(region.GetSize(0)) ||
                      index[1] + 1 == static_cast<long>(region.GetSize(1)) ||
                      index[2] + 1 == static_cast<long>(region.GetSize(2));
    ASSERT_FALSE(side && it.Get() != 0);
  }
  EXPECT_GT(below, 100);

  // The same with the third axis upside down: it leaves through the last slice.
  SourceType::DirectionType flipped;
  flipped.SetIdentity();
  flipped[1][1] = flipped[2][2] = -1.0;
  source->SetDirection(flipped);
  source->Update();
  const double last = labels->GetOrigin()[2] - 3.0 * static_cast<double>(labels->GetBufferedRegion().GetSize(2) - 1);
  EXPECT_NEAR(last - 1.5, cut, 1e-9);
}

TEST(PhantomImageSource, HemipelvisBranchesAndHasHoles)
{
  auto                    source = MakeSource("hemipelvis", 2.0, 2.0);
  SourceType::SpacingType none;
  none.Fill(0.0);
  source->SetPointSpread(none);
  for (std::uint64_t seed = 0; seed < 3; ++seed)
  {
    source->SetModel(MakePhantom("hemipelvis", seed));
    source->UpdateLargestPossibleRegion();
    const LabelType * labels = source->GetLabelOutput();
    int               two = 0, holes = 0;
    const auto        slices = static_cast<itk::IndexValueType>(labels->GetBufferedRegion().GetSize(2));
    for (itk::IndexValueType k = 0; k < slices; ++k)
    {
      two += CountComponents(labels, k, false) == 2 ? 1 : 0;
      holes += CountComponents(labels, k, true) > 1 ? 1 : 0;
    }
    EXPECT_GE(two, 8) << seed;
    EXPECT_GE(holes, 2) << seed;
  }
}

TEST(PhantomImageSource, GivesTheSameForAnyNumberOfThreads)
{
  std::vector<SourceType::Pointer> sources;
  for (const unsigned int threads : { 1U, 2U, 7U })
  {
    auto source = MakeSource("hemipelvis", 2.5, 3.0);
    source->SetNoise(25.0);
    source->SetNumberOfWorkUnits(threads);
    source->Update();
    sources.push_back(source);
  }
  const auto count = sources[0]->GetOutput()->GetBufferedRegion().GetNumberOfPixels();
  for (const auto & source : sources)
  {
    EXPECT_EQ(std::memcmp(sources[0]->GetOutput()->GetBufferPointer(),
                          source->GetOutput()->GetBufferPointer(),
                          count * sizeof(float)),
              0);
    EXPECT_EQ(std::memcmp(sources[0]->GetLabelOutput()->GetBufferPointer(),
                          source->GetLabelOutput()->GetBufferPointer(),
                          count * sizeof(short)),
              0);
  }
}

TEST(PhantomImageSource, AStreamedPieceIsThatOfTheWhole)
{
  auto whole = MakeSource("femur", 2.0, 3.0);
  whole->SetNoise(20.0);
  whole->Update();
  auto piece = MakeSource("femur", 2.0, 3.0);
  piece->SetNoise(20.0);
  piece->UpdateOutputInformation();
  ImageType::RegionType region = piece->GetOutput()->GetLargestPossibleRegion();
  region.SetIndex({ { 5, 4, 31 } });
  region.SetSize({ { 30, 20, 9 } });
  piece->GetOutput()->SetRequestedRegion(region);
  piece->GetOutput()->Update();
  EXPECT_EQ(piece->GetOutput()->GetBufferedRegion(), region);
  for (itk::ImageRegionConstIteratorWithIndex<ImageType> it(piece->GetOutput(), region); !it.IsAtEnd(); ++it)
  {
    ASSERT_EQ(it.Get(), whole->GetOutput()->GetPixel(it.GetIndex()));
    ASSERT_EQ(piece->GetLabelOutput()->GetPixel(it.GetIndex()), whole->GetLabelOutput()->GetPixel(it.GetIndex()));
  }
}

TEST(PhantomImageSource, NoiseHasTheMeanAndSigmaAskedFor)
{
  auto clean = MakeSource("femur", 2.0, 2.0);
  clean->Update();
  auto noisy = MakeSource("femur", 2.0, 2.0);
  noisy->SetNoise(30.0);
  noisy->Update();
  double       sum = 0.0, squares = 0.0;
  const auto   count = clean->GetOutput()->GetBufferedRegion().GetNumberOfPixels();
  const auto * a = clean->GetOutput()->GetBufferPointer();
  const auto * b = noisy->GetOutput()->GetBufferPointer();
  for (std::size_t n = 0; n < count; ++n)
  {
    const double difference = static_cast<double>(b[n]) - a[n];
    sum += difference;
    squares += difference * difference;
  }
  const auto number = static_cast<double>(count);
  EXPECT_NEAR(sum / number, 0.0, 5.0 * 30.0 / std::sqrt(number));
  EXPECT_NEAR(std::sqrt(squares / number), 30.0, 5.0 * 30.0 / std::sqrt(2.0 * number));
  const double before = b[1000];
  noisy->SetNoiseSeed(2);
  noisy->Update();
  EXPECT_NE(noisy->GetOutput()->GetBufferPointer()[1000], before);
}

TEST(PhantomImageSource, RoundsAndClampsIntegers)
{
  auto source = PhantomImageSource<itk::Image<unsigned char, 3>>::New();
  PhantomImageSource<itk::Image<unsigned char, 3>>::SpacingType spacing;
  spacing.Fill(4.0);
  source->SetModel(MakePhantom("femur"));
  source->SetSpacing(spacing);
  spacing.Fill(1.0);
  source->SetPointSpread(spacing);
  source->Update();
  const auto * image = source->GetOutput();
  int          white = 0, black = 0;
  for (std::size_t n = 0; n < image->GetBufferedRegion().GetNumberOfPixels(); ++n)
  {
    white += image->GetBufferPointer()[n] == 255 ? 1 : 0;
    black += image->GetBufferPointer()[n] == 0 ? 1 : 0;
  }
  EXPECT_GT(white, 100);
  EXPECT_GT(black, 10);
}

TEST(PhantomImageSource, IsLazy)
{
  auto source = MakeSource("femur", 4.0, 4.0);
  int  runs = 0;
  auto command = itk::FunctionCommand::New();
  command->SetCallback([&runs](const itk::EventObject &) { ++runs; });
  source->AddObserver(itk::StartEvent(), command);
  source->Update();
  source->Update();
  source->GetLabelOutput()->Update();
  EXPECT_EQ(runs, 1);
  source->SetNoise(0.0);
  source->SetModel(source->GetModel());
  source->Update();
  EXPECT_EQ(runs, 1);
  source->SetNoise(1.0);
  source->Update();
  EXPECT_EQ(runs, 2);
  source->SetModel(MakePhantom("femur", 3));
  source->UpdateLargestPossibleRegion();
  EXPECT_EQ(runs, 3);
}

TEST(PhantomImageSource, ProgressRisesAndAnAbortLeavesTheSourceReusable)
{
  auto source = MakeSource("femur", 2.0, 2.0);
  source->SetNumberOfWorkUnits(1);
  source->Update();
  const float *            p = source->GetOutput()->GetBufferPointer();
  const std::size_t        count = source->GetOutput()->GetBufferedRegion().GetNumberOfPixels();
  const std::vector<float> expected(p, p + count);
  std::vector<float>       seen;
  bool                     stop = true;
  source->AddObserver(itk::ProgressEvent(), [&](const itk::EventObject &) {
    seen.push_back(source->GetProgress());
    source->SetAbortGenerateData(stop && seen.back() > 0.5F);
  });
  source->Modified();
  EXPECT_THROW(source->Update(), itk::ProcessAborted);
  stop = false;
  seen.clear();
  source->Update();
  EXPECT_TRUE(std::is_sorted(seen.begin(), seen.end()));
  EXPECT_GE(seen.size(), 8U);
  EXPECT_EQ(seen.back(), 1.0F);
  p = source->GetOutput()->GetBufferPointer();
  EXPECT_EQ(std::vector<float>(p, p + count), expected);
}

TEST(PhantomImageSource, CanBeStreamed)
{
  auto whole = MakeSource("femur", 2.0, 3.0), pieces = MakeSource("femur", 2.0, 3.0);
  whole->SetNoise(20.0);
  whole->Update();
  pieces->SetNoise(20.0);
  auto monitor = itk::PipelineMonitorImageFilter<ImageType>::New();
  monitor->SetInput(pieces->GetOutput());
  auto stream = itk::StreamingImageFilter<ImageType, ImageType>::New();
  stream->SetInput(monitor->GetOutput());
  stream->SetNumberOfStreamDivisions(4);
  stream->Update();
  EXPECT_TRUE(monitor->VerifyAllInputCanStream(4));
  const float * expected = whole->GetOutput()->GetBufferPointer();
  EXPECT_TRUE(std::equal(expected,
                         expected + whole->GetOutput()->GetBufferedRegion().GetNumberOfPixels(),
                         stream->GetOutput()->GetBufferPointer()));
}

TEST(PhantomImageSource, RefusesWhatMakesNoImage)
{
  using testing::HasSubstr;
  auto source = SourceType::New();
  EXPECT_THAT(ErrorOf(source), HasSubstr("SetModel"));

  source = MakeSource("femur", -1.0, 2.0);
  EXPECT_THAT(ErrorOf(source), HasSubstr("Spacing must be positive"));
  source = MakeSource("femur", std::numeric_limits<double>::quiet_NaN(), 2.0);
  EXPECT_THAT(ErrorOf(source), HasSubstr("Spacing must be positive"));
  source = MakeSource("femur", 1e-4, 1e-4);
  EXPECT_THAT(ErrorOf(source), HasSubstr("larger spacing"));

  source = MakeSource("femur", 2.0, 2.0);
  source->SetNoise(-1.0);
  EXPECT_THAT(ErrorOf(source), HasSubstr("Noise"));

  source = MakeSource("femur", 2.0, 2.0);
  SourceType::DirectionType sheared;
  sheared.SetIdentity();
  sheared[0][1] = 0.5;
  source->SetDirection(sheared);
  EXPECT_THAT(ErrorOf(source), HasSubstr("rotation"));

  source = MakeSource("femur", 2.0, 2.0);
  source->FitToBoneOff();
  EXPECT_THAT(ErrorOf(source), HasSubstr("Size must be positive"));
}
} // namespace PhantomImageSourceTests
