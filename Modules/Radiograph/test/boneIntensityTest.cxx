/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneIntensityImageFilter.h"

#include "boneAttenuationImageFilter.h"
#include "boneNoiseImageFilter.h"

#include <gtest/gtest.h>
#include <itkImage.h>
#include <itkStreamingImageFilter.h>

#include <numeric>

namespace IntensityTests
{
using namespace bone;
using Image = itk::Image<float, 3>;

Image::Pointer
MakeImage(int columns, int rows, float value)
{
  auto image = Image::New();
  image->SetRegions(Image::RegionType({ { 3, -2, 0 } },
                                      { { static_cast<unsigned int>(columns), static_cast<unsigned int>(rows), 1 } }));
  image->Allocate();
  image->FillBuffer(value);
  return image;
}

std::vector<float>
Pixels(const Image * image)
{
  return { image->GetBufferPointer(), image->GetBufferPointer() + image->GetBufferedRegion().GetNumberOfPixels() };
}
/** An image of different values from `first` on. */
Image::Pointer
MakeRamp(float first, float step)
{
  auto image = MakeImage(30, 20, 0);
  for (std::size_t i = 0; i < 600; ++i)
  {
    image->GetBufferPointer()[i] = first + static_cast<float>(i) * step;
  }
  return image;
}

/** The filter's pixels, asked for in so many pieces. */
template <typename TFilter>
std::vector<float>
Stream(TFilter * filter, Image * input, unsigned int pieces)
{
  unsigned int runs = 0;
  const auto   tag = filter->AddObserver(itk::StartEvent(), [&runs](const itk::EventObject &) { ++runs; });
  auto         streaming = itk::StreamingImageFilter<Image, Image>::New();
  filter->SetInput(input);
  filter->Modified();
  streaming->SetInput(filter->GetOutput());
  streaming->SetNumberOfStreamDivisions(pieces);
  streaming->Update();
  filter->RemoveObserver(tag);
  EXPECT_EQ(runs, pieces);
  return Pixels(streaming->GetOutput());
}

template <typename TFilter>
void
ExpectSameWhenStreamed(TFilter * filter, const std::function<Image::Pointer()> & makeInput)
{
  for (bool inPlace : { false, true })
  {
    if (auto * inPlaceFilter = dynamic_cast<itk::InPlaceImageFilter<Image, Image> *>(filter))
    {
      inPlaceFilter->SetInPlace(inPlace);
    }
    const auto whole = Stream(filter, makeInput(), 1), pieces = Stream(filter, makeInput(), 4);
    EXPECT_EQ(whole, pieces) << "in place: " << inPlace;
    EXPECT_NE(whole.front(), whole.back());
  }
}

TEST(AttenuationImageFilter, HasTheSamePixelsWhenStreamed)
{
  auto filter = AttenuationImageFilter<Image>::New();
  filter->SetHUToAttenuation(HUToAttenuation::Bilinear);
  ExpectSameWhenStreamed(filter.GetPointer(), [] { return MakeRamp(-900, 4); });
}

TEST(IntensityImageFilter, HasTheSamePixelsWhenStreamed)
{
  auto filter = IntensityImageFilter<Image>::New();
  filter->SetIncidentIntensity(1000);
  ExpectSameWhenStreamed(filter.GetPointer(), [] { return MakeRamp(0, 0.01f); });
}

TEST(NoiseImageFilter, HasTheSamePixelsWhenStreamed)
{
  auto filter = NoiseImageFilter<Image>::New();
  filter->SetElectronicNoise(0.5);
  ExpectSameWhenStreamed(filter.GetPointer(), [] { return MakeRamp(10, 1); });
}

TEST(AttenuationCurve, PassesThroughAirAndWaterAndRises)
{
  AttenuationCurve curve;
  EXPECT_EQ(curve.At(-234), -234);
  for (auto conversion : { HUToAttenuation::WaterScaled, HUToAttenuation::Bilinear })
  {
    curve.huToAttenuation = conversion;
    EXPECT_EQ(curve.At(-1000), 0);
    EXPECT_EQ(curve.At(-3000), 0);
    EXPECT_DOUBLE_EQ(curve.At(0), WaterAttenuationAt60keV);
    EXPECT_NEAR(curve.At(-1e-9), curve.At(1e-9), 1e-12);
  }
  EXPECT_DOUBLE_EQ(curve.At(1600), 0.06047);
}

TEST(AttenuationCurve, ATableIsLinearBetweenItsPointsAndConstantBeyond)
{
  AttenuationCurve curve;
  curve.huToAttenuation = HUToAttenuation::Table;
  curve.table = { { -1000, 0 }, { 0, 0.02 }, { 1000, 0.05 } };
  EXPECT_EQ(curve.At(-2000), 0);
  EXPECT_DOUBLE_EQ(curve.At(-500), 0.01);
  EXPECT_DOUBLE_EQ(curve.At(0), 0.02);
  EXPECT_DOUBLE_EQ(curve.At(500), 0.035);
  EXPECT_DOUBLE_EQ(curve.At(1000), 0.05);
  EXPECT_DOUBLE_EQ(curve.At(9000), 0.05);
}

TEST(AttenuationImageFilter, ConvertsVoxels)
{
  auto filter = AttenuationImageFilter<Image>::New();
  filter->SetInput(MakeImage(3, 2, 800));
  AttenuationCurve curve;
  curve.huToAttenuation = HUToAttenuation::Bilinear;
  filter->SetHUToAttenuation(HUToAttenuation::Bilinear);
  filter->Update();
  EXPECT_FLOAT_EQ(Pixels(filter->GetOutput())[4], static_cast<float>(curve.At(800)));
  filter->SetHUToAttenuation(HUToAttenuation::Table);
  EXPECT_THROW(filter->Update(), itk::ExceptionObject);
  filter->SetAttenuationTable({ { 0, 0.02 }, { -1000, 0 } });
  EXPECT_THROW(filter->Update(), itk::ExceptionObject);
  filter->SetAttenuationTable({ { -1000, 0 }, { 1000, 0.05 } });
  filter->Update();
  EXPECT_FLOAT_EQ(Pixels(filter->GetOutput())[4], 0.045f);
}

TEST(IntensityImageFilter, IsBeerAndLamberts)
{
  auto filter = IntensityImageFilter<Image>::New();
  filter->SetInput(MakeImage(3, 2, 2));
  filter->SetIncidentIntensity(1000);
  filter->Update();
  EXPECT_FLOAT_EQ(Pixels(filter->GetOutput())[0], 135.33528f);
  filter->SetIncidentIntensity(0);
  EXPECT_THROW(filter->Update(), itk::ExceptionObject);
}

TEST(NoiseImageFilter, HasTheMeanAndVarianceOfItsDistributions)
{
  const auto   image = MakeImage(150, 100, 4);
  const double count = 15000;
  for (double electronic : { 0.0, 0.5 })
  {
    auto filter = NoiseImageFilter<Image>::New();
    filter->SetInput(image);
    filter->SetPhotonsPerUnit(25);
    filter->SetElectronicNoise(electronic);
    filter->Update();
    const auto   values = Pixels(filter->GetOutput());
    const double mean = std::accumulate(values.begin(), values.end(), 0.0) / count;
    double       variance = 0;
    for (float value : values)
    {
      variance += (value - mean) * (value - mean) / count;
    }
    const double expected = 4.0 / 25 + electronic * electronic;
    EXPECT_NEAR(mean, 4, 5 * std::sqrt(expected / count));
    EXPECT_NEAR(variance, expected, 5 * expected * std::sqrt(2 / count));
  }
}

TEST(NoiseImageFilter, DependsOnTheSeedButNotOnThreads)
{
  std::vector<float> values[3];
  for (int k = 0; k < 3; ++k)
  {
    auto filter = NoiseImageFilter<Image>::New();
    filter->SetInput(MakeImage(30, 20, 50));
    filter->SetNumberOfWorkUnits(k == 1 ? 7 : 1);
    filter->SetSeed(k == 2 ? 5 : 1);
    filter->Update();
    values[k] = Pixels(filter->GetOutput());
  }
  EXPECT_EQ(values[0], values[1]);
  EXPECT_NE(values[0], values[2]);
}

TEST(NoiseImageFilter, RefusesWhatIsNoIntensity)
{
  auto filter = NoiseImageFilter<Image>::New();
  filter->SetInput(MakeImage(3, 2, -1));
  EXPECT_THROW(filter->Update(), itk::ExceptionObject);
  filter->SetInput(MakeImage(3, 2, 1));
  filter->SetPhotonsPerUnit(-1);
  EXPECT_THROW(filter->Update(), itk::ExceptionObject);
}
} // namespace IntensityTests
