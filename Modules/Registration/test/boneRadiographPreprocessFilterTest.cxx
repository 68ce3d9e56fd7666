/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneRadiographPreprocessFilter.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace RadiographPreprocessFilterTests
{
using namespace bone;
using testing::HasSubstr;
using Image = itk::Image<float, 3>;
using Mask = itk::Image<short, 3>;
using Filter = RadiographPreprocessFilter<>;

constexpr int Columns = 120, Rows = 90;

template <typename TImage>
typename TImage::Pointer
Make(int columns, int rows, double value)
{
  auto                        image = TImage::New();
  typename TImage::RegionType region;
  region.SetIndex({ { 3, -2, 7 } });
  region.SetSize({ { static_cast<unsigned int>(columns), static_cast<unsigned int>(rows), 1 } });
  image->SetRegions(region);
  image->Allocate();
  image->FillBuffer(static_cast<typename TImage::PixelType>(value));
  typename TImage::SpacingType spacing;
  spacing[0] = 2.0;
  spacing[1] = 2.5;
  spacing[2] = 1.0;
  image->SetSpacing(spacing);
  return image;
}

template <typename TImage>
auto &
At(TImage * image, int column, int row)
{
  return image->GetBufferPointer()[row * static_cast<int>(image->GetBufferedRegion().GetSize(0)) + column];
}

/** The line integral of a body in the middle, 0 in the air around it. */
double
TrueIntegral(int column, int row)
{
  const double x = (column - 60) / 45.0, y = (row - 45) / 35.0;
  return 3 * std::sqrt(std::max(0.0, 1 - x * x - y * y)) * (1 + 0.05 * std::sin(0.4 * column));
}

Image::Pointer
Body(double open, double noise = 0.0)
{
  std::mt19937                     random(3);
  std::normal_distribution<double> normal(0, 1);
  auto                             image = Make<Image>(Columns, Rows, 0);
  for (int r = 0; r < Rows; ++r)
  {
    for (int c = 0; c < Columns; ++c)
    {
      At(image.GetPointer(), c, r) =
        static_cast<float>(open * std::exp(-TrueIntegral(c, r)) * (1 + noise * normal(random)));
    }
  }
  return image;
}

Filter::Pointer
Ready(Image * image, RadiographValues values = RadiographValues::Intensity)
{
  auto filter = Filter::New();
  filter->SetInput(image);
  filter->SetValues(values);
  return filter;
}

std::string
ErrorOf(Filter * filter)
{
  try
  {
    filter->Update();
  }
  catch (const itk::ExceptionObject & error)
  {
    const std::string text = error.GetDescription();
    EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 0) << text;
    return text;
  }
  return "none";
}

TEST(RadiographPreprocess, IntensitiesBecomeTheLineIntegralsThatMadeThem)
{
  auto filter = Ready(Body(40000));
  filter->SetOpenBeam(40000);
  filter->Update();
  for (int r = 0; r < Rows; ++r)
  {
    for (int c = 0; c < Columns; ++c)
    {
      ASSERT_NEAR(At(filter->GetOutput(), c, r), TrueIntegral(c, r), 1e-5) << c << ' ' << r;
      ASSERT_EQ(At(filter->GetWeights(), c, r), TrueIntegral(c, r) > 1e-6 ? 1 : 0) << c << ' ' << r;
    }
  }
  EXPECT_FALSE(filter->GetReport().openBeamEstimated);
  EXPECT_EQ(filter->GetReport().deadPixels, 0u);
  EXPECT_TRUE(filter->GetReport().collimator.empty());
  EXPECT_FALSE(filter->IsMonotoneOnly());
  EXPECT_EQ(filter->GetOutput()->GetLargestPossibleRegion(), filter->GetInput()->GetLargestPossibleRegion());
  EXPECT_EQ(filter->GetOutput()->GetSpacing(), filter->GetInput()->GetSpacing());
  EXPECT_EQ(filter->GetWeights()->GetLargestPossibleRegion(), filter->GetInput()->GetLargestPossibleRegion());
}

TEST(RadiographPreprocess, LineIntegralsPassThrough)
{
  auto image = Make<Image>(Columns, Rows, 0);
  for (int i = 0; i < Columns * Rows; ++i)
  {
    image->GetBufferPointer()[i] = 0.37f * static_cast<float>((i * 7919) % 1000) - 50;
  }
  auto filter = Ready(image, RadiographValues::Integral);
  filter->Update();
  for (int i = 0; i < Columns * Rows; ++i)
  {
    ASSERT_EQ(filter->GetOutput()->GetBufferPointer()[i], image->GetBufferPointer()[i]);
    ASSERT_EQ(filter->GetWeights()->GetBufferPointer()[i], 1);
  }
}

TEST(RadiographPreprocess, TheOpenBeamIsEstimatedFromAirAndSaidToBe)
{
  auto filter = Ready(Body(5000, 0.05));
  filter->Update();
  EXPECT_TRUE(filter->GetReport().openBeamEstimated);
  EXPECT_NEAR(filter->GetReport().openBeam, 5000, 50);
  // The body covers pi 45 35 of the 120 x 90 pixels.
  EXPECT_NEAR(filter->GetReport().airShare, 1 - 4948.0 / 10800, 0.05);
  filter->SetOpenBeam(4000);
  filter->Update();
  EXPECT_EQ(filter->GetReport().openBeam, 4000);
  EXPECT_FALSE(filter->GetReport().openBeamEstimated);
}

TEST(RadiographPreprocess, AnImageWithoutAirSaysSo)
{
  auto filter = Ready(Body(5000));
  filter->SetCrop({ 40, 25, 40, 40 });
  filter->Update();
  EXPECT_LT(filter->GetReport().airShare, 0.05);
}

TEST(RadiographPreprocess, PixelsAtOrAboveAirHaveTheAirsWeight)
{
  auto filter = Ready(Body(100));
  filter->SetOpenBeam(100);
  filter->SetAirWeight(0.25);
  filter->Update();
  EXPECT_EQ(At(filter->GetWeights(), 1, 1), 0.25f);
  EXPECT_EQ(At(filter->GetWeights(), 60, 45), 1);
}

TEST(RadiographPreprocess, ScatterOfTheSameModelIsSubtracted)
{
  const double        open = 20000;
  auto                image = Body(open);
  const DetectorGrid  grid{ { { Columns, Rows } }, { 2.0, 2.5 } };
  std::vector<double> primary(image->GetBufferPointer(), image->GetBufferPointer() + grid.Count());
  const auto          scatter = ComputeScatter(primary, grid, { 0.6, 35, open }, Execution());
  for (std::size_t i = 0; i < primary.size(); ++i)
  {
    image->GetBufferPointer()[i] += static_cast<float>(scatter[i]);
  }
  auto filter = Ready(image);
  filter->SetOpenBeam(open);
  filter->SetScatterWidth(35);
  filter->Update();
  const double without = std::abs(At(filter->GetOutput(), 60, 45) - TrueIntegral(60, 45));
  EXPECT_GT(without, 0.2);
  filter->SetScatterToPrimary(0.6);
  filter->Update();
  double worst = 0;
  for (int r = 0; r < Rows; ++r)
  {
    for (int c = 0; c < Columns; ++c)
    {
      worst = std::max(worst, std::abs(At(filter->GetOutput(), c, r) - TrueIntegral(c, r)));
    }
  }
  EXPECT_LT(worst, 1e-3);
  EXPECT_GT(filter->GetReport().scatterToPrimary, 0.2);
  EXPECT_GT(filter->GetReport().scatterIterations, 2);

  // The same from line integrals, whose open beam is 1.
  for (std::size_t i = 0; i < primary.size(); ++i)
  {
    image->GetBufferPointer()[i] = static_cast<float>(-std::log(image->GetBufferPointer()[i] / open));
  }
  image->Modified();
  filter->SetValues(RadiographValues::Integral);
  filter->Update();
  EXPECT_NEAR(At(filter->GetOutput(), 60, 45), TrueIntegral(60, 45), 1e-3);
}

TEST(RadiographPreprocess, DeadPixelsAreReplacedAndHaveNoWeight)
{
  auto image = Body(10000, 0.01);
  At(image.GetPointer(), 60, 45) = 0;
  At(image.GetPointer(), 30, 40) = 60000;
  At(image.GetPointer(), 80, 50) = 9;
  At(image.GetPointer(), 81, 50) = 8; // a pair
  At(image.GetPointer(), 0, 0) = 1;   // in the corner
  for (int c = 50; c < 70; ++c)
  {
    At(image.GetPointer(), c, 60) *= 0.3f; // a wire is no dead pixel
  }
  auto filter = Ready(image);
  filter->SetOpenBeam(12000);
  filter->Update();
  EXPECT_EQ(filter->GetReport().deadPixels, 5u);
  for (const auto & [c, r] : std::vector<std::pair<int, int>>{ { 60, 45 }, { 30, 40 }, { 80, 50 }, { 81, 50 } })
  {
    EXPECT_EQ(At(filter->GetWeights(), c, r), 0);
    EXPECT_NEAR(At(filter->GetOutput(), c, r), TrueIntegral(c, r) + std::log(1.2), 0.1) << c << ' ' << r;
  }
  EXPECT_EQ(At(filter->GetWeights(), 55, 60), 1);
  EXPECT_NEAR(At(filter->GetOutput(), 55, 60), TrueIntegral(55, 60) + std::log(1.2 / 0.3), 0.05);
  filter->SetDeadPixelThreshold(0);
  filter->Update();
  EXPECT_EQ(filter->GetReport().deadPixels, 0u);
  EXPECT_EQ(At(filter->GetWeights(), 30, 40), 0) << "still above air";
  EXPECT_EQ(At(filter->GetWeights(), 80, 50), 1);
}

TEST(RadiographPreprocess, WhatIsNotANumberHasNoWeightAndLeavesNoNaN)
{
  for (const auto values : { RadiographValues::Integral, RadiographValues::Intensity, RadiographValues::Display })
  {
    auto image = Body(1000);
    At(image.GetPointer(), 60, 45) = std::numeric_limits<float>::quiet_NaN();
    At(image.GetPointer(), 70, 45) = std::numeric_limits<float>::infinity();
    auto filter = Ready(image, values);
    filter->Update();
    EXPECT_EQ(filter->GetReport().notFinite, 2u);
    EXPECT_EQ(At(filter->GetWeights(), 60, 45), 0);
    EXPECT_EQ(At(filter->GetWeights(), 70, 45), 0);
    for (int i = 0; i < Columns * Rows; ++i)
    {
      ASSERT_TRUE(std::isfinite(filter->GetOutput()->GetBufferPointer()[i])) << i;
    }
  }
}

TEST(RadiographPreprocess, PixelsAtZeroHaveNoWeight)
{
  auto image = Body(1000);
  for (int c = 40; c < 80; ++c)
  {
    for (int r = 40; r < 50; ++r)
    {
      At(image.GetPointer(), c, r) = 0;
    }
  }
  auto filter = Ready(image);
  filter->SetOpenBeam(1001);
  filter->Update();
  EXPECT_EQ(filter->GetReport().saturated, 400u);
  EXPECT_EQ(At(filter->GetWeights(), 60, 45), 0);
  EXPECT_TRUE(std::isfinite(At(filter->GetOutput(), 60, 45)));
}

TEST(RadiographPreprocess, MaskAndCropLeaveTheirPixelsAlone)
{
  auto mask = Make<Mask>(Columns, Rows, 0);
  for (int c = 40; c < 80; ++c)
  {
    At(mask.GetPointer(), c, 45) = -3;
  }
  auto filter = Ready(Body(1000));
  filter->SetMask(mask);
  filter->SetCrop({ 50, 20, 20, 60 });
  filter->Update();
  for (int r = 0; r < Rows; ++r)
  {
    for (int c = 0; c < Columns; ++c)
    {
      ASSERT_EQ(At(filter->GetWeights(), c, r), r == 45 && c >= 50 && c < 70 ? 1 : 0) << c << ' ' << r;
    }
  }
  EXPECT_NEAR(filter->GetReport().usedShare, 20.0 / (Columns * Rows), 1e-9);
}

TEST(RadiographPreprocess, TheCollimatorsShadowHasNoWeight)
{
  auto image = Body(10000, 0.02);
  for (int r = 0; r < Rows; ++r)
  {
    for (int c = 0; c < Columns; ++c)
    {
      // 20 columns at the left and 15 rows at the bottom are shadowed.
      if (c < 20 || r >= Rows - 15)
      {
        At(image.GetPointer(), c, r) = 0.01f * At(image.GetPointer(), c, r) + 30;
      }
    }
  }
  auto filter = Ready(image);
  filter->SetAirWeight(1);
  filter->Update();
  ASSERT_EQ(filter->GetReport().collimator.size(), 2u);
  for (int r = 0; r < Rows; ++r)
  {
    for (int c = 0; c < Columns; ++c)
    {
      const int within = std::min(c - 20, Rows - 16 - r); // pixels within the border
      if (within < 0 || within > 3)
      {
        ASSERT_EQ(At(filter->GetWeights(), c, r), within < 0 ? 0 : 1) << c << ' ' << r;
      }
    }
  }
  EXPECT_NEAR(filter->GetReport().openBeam, 10000, 100) << "the shadow is no air";
  filter->DetectCollimatorOff();
  filter->Update();
  EXPECT_TRUE(filter->GetReport().collimator.empty());
  EXPECT_EQ(At(filter->GetWeights(), 5, 5), 1);
}

TEST(RadiographPreprocess, DisplayValuesRiseWithAttenuationWhicheverWayTheyAreShown)
{
  for (const bool boneIsBright : { true, false })
  {
    for (const auto curve : { DisplayCurve::Linear, DisplayCurve::Logarithm })
    {
      auto image = Make<Image>(Columns, Rows, 0);
      for (int r = 0; r < Rows; ++r)
      {
        for (int c = 0; c < Columns; ++c)
        {
          const double shown = 200 * std::pow(TrueIntegral(c, r) / 3.2, 0.6);
          At(image.GetPointer(), c, r) = static_cast<float>(std::round(boneIsBright ? 30 + shown : 230 - shown));
        }
      }
      auto filter = Ready(image, RadiographValues::Display);
      filter->SetLargerAttenuates(boneIsBright);
      filter->SetDisplayCurve(curve);
      EXPECT_TRUE(filter->IsMonotoneOnly());
      filter->Update();
      EXPECT_TRUE(filter->GetReport().monotoneOnly);
      EXPECT_EQ(At(filter->GetWeights(), 60, 45), 1);
      EXPECT_EQ(At(filter->GetWeights(), 1, 1), 0) << "air, at the end of the range";
      for (int c = 20; c < 104; c += 7)
      {
        for (int other = 20; other < 104; other += 7)
        {
          if (TrueIntegral(c, 45) > TrueIntegral(other, 45) + 0.1)
          {
            EXPECT_GT(At(filter->GetOutput(), c, 45), At(filter->GetOutput(), other, 45)) << c << ' ' << other;
          }
        }
      }
      EXPECT_GT(At(filter->GetOutput(), 100, 45), At(filter->GetOutput(), 1, 1));
    }
  }
}

TEST(RadiographPreprocess, QuantumWeightsAreThePhotonsShare)
{
  auto filter = Ready(Body(1000));
  filter->SetOpenBeam(1000);
  filter->QuantumWeightsOn();
  filter->Update();
  EXPECT_NEAR(At(filter->GetWeights(), 60, 45), std::exp(-TrueIntegral(60, 45)), 1e-5);
  EXPECT_NEAR(At(filter->GetWeights(), 90, 45), std::exp(-TrueIntegral(90, 45)), 1e-5);
}

TEST(RadiographPreprocess, RunsOnlyWhenSomethingChanged)
{
  auto image = Body(1000);
  auto mask = Make<Mask>(Columns, Rows, 1);
  auto filter = Ready(image);
  filter->SetMask(mask);
  int runs = 0;
  filter->AddObserver(itk::StartEvent(), [&runs](const itk::EventObject &) { ++runs; });
  filter->Update();
  filter->Update();
  filter->SetOpenBeam(0.0);
  filter->GetWeights()->Update();
  EXPECT_EQ(runs, 1);
  filter->SetOpenBeam(1000);
  filter->Update();
  EXPECT_EQ(runs, 2);
  mask->Modified();
  filter->Update();
  EXPECT_EQ(runs, 3);
  image->Modified();
  filter->GetWeights()->Update();
  EXPECT_EQ(runs, 4);
}

TEST(RadiographPreprocess, OneThreadAndTwoGiveTheSameBytes)
{
  std::vector<std::vector<float>> results;
  for (const unsigned int units : { 1u, 2u, 3u })
  {
    auto image = Body(3000, 0.1);
    At(image.GetPointer(), 60, 45) = 0;
    auto filter = Ready(image);
    filter->SetScatterToPrimary(0.5);
    filter->SetNumberOfWorkUnits(units);
    filter->Update();
    results.emplace_back(filter->GetOutput()->GetBufferPointer(),
                         filter->GetOutput()->GetBufferPointer() + Columns * Rows);
    results.back().insert(results.back().end(),
                          filter->GetWeights()->GetBufferPointer(),
                          filter->GetWeights()->GetBufferPointer() + Columns * Rows);
  }
  EXPECT_EQ(results[0], results[1]);
  EXPECT_EQ(results[0], results[2]);
}

TEST(RadiographPreprocess, TakesOtherPixelTypes)
{
  using Shorts = itk::Image<unsigned short, 3>;
  auto image = Make<Shorts>(Columns, Rows, 0);
  for (int r = 0; r < Rows; ++r)
  {
    for (int c = 0; c < Columns; ++c)
    {
      At(image.GetPointer(), c, r) = static_cast<unsigned short>(std::lround(60000 * std::exp(-TrueIntegral(c, r))));
    }
  }
  auto filter = RadiographPreprocessFilter<Shorts, itk::Image<double, 3>, itk::Image<unsigned char, 3>>::New();
  filter->SetInput(image);
  filter->SetValues(RadiographValues::Intensity);
  filter->SetOpenBeam(60000);
  filter->Update();
  EXPECT_NEAR(At(filter->GetOutput(), 60, 45), TrueIntegral(60, 45), 1e-3);
}

TEST(RadiographPreprocess, RefusesWhatShowsNothing)
{
  const auto body = Body(1000);
  auto       filter = Ready(body);
  filter->SetMask(Make<Mask>(Columns, Rows, 0));
  EXPECT_THAT(ErrorOf(filter), HasSubstr("the mask is 0 everywhere"));

  filter = Ready(body);
  filter->SetMask(Make<Mask>(Columns, Rows + 1, 1));
  EXPECT_THAT(ErrorOf(filter), HasSubstr("'Mask' is of 120 x 91 x 1 pixels and the radiograph of 120 x 90 x 1"));

  for (const auto values : { RadiographValues::Integral, RadiographValues::Intensity, RadiographValues::Display })
  {
    filter = Ready(Make<Image>(Columns, Rows, std::numeric_limits<double>::quiet_NaN()), values);
    EXPECT_THAT(ErrorOf(filter), HasSubstr("No pixel of the input is finite"));
    filter = Ready(Make<Image>(Columns, Rows, 5), values);
    filter->SetAirWeight(1);
    EXPECT_THAT(ErrorOf(filter), HasSubstr("it shows nothing"));
  }
  filter = Ready(Make<Image>(Columns, Rows, 0));
  EXPECT_THAT(ErrorOf(filter), HasSubstr("I0 cannot be estimated"));

  for (const double open : { -1.0, std::nan(""), std::numeric_limits<double>::infinity() })
  {
    filter = Ready(body);
    filter->SetOpenBeam(open);
    EXPECT_THAT(ErrorOf(filter), HasSubstr("OpenBeam is"));
  }
  filter = Ready(body);
  filter->SetOpenBeam(1e-3);
  EXPECT_THAT(ErrorOf(filter), HasSubstr("at or above I0"));

  for (const auto & crop : std::vector<std::vector<int>>{ { 0, 0, 5 }, { 100, 0, 30, 10 }, { 0, 0, 0, 5 } })
  {
    filter = Ready(body);
    filter->SetCrop(crop);
    EXPECT_THAT(ErrorOf(filter), HasSubstr("within the 120 x 90 pixels"));
  }
  filter = Ready(body, RadiographValues::Display);
  filter->SetScatterToPrimary(0.5);
  EXPECT_THAT(ErrorOf(filter), HasSubstr("Scatter cannot be subtracted from display values"));
}

TEST(RadiographPreprocess, RefusesAVolume)
{
  auto              image = Image::New();
  Image::RegionType region;
  region.SetSize({ { 8, 8, 4 } });
  image->SetRegions(region);
  image->Allocate(true);
  EXPECT_THAT(ErrorOf(Ready(image)), HasSubstr("8 x 8 x 4"));
}
} // namespace RadiographPreprocessFilterTests
