/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneFilterCases.h"

#include <gtest/gtest.h>
#include <itkImageRegionIterator.h>

#include <algorithm>
#include <cmath>

// Filters whose CT, mask or label map may be of any pixel type give the same for all of them.

namespace bone
{
namespace test
{
namespace FilterTypesTests
{
/** The values of an image by `map`, as another type. */
template <typename TPixel, typename TImage, typename TMap>
typename itk::Image<TPixel, 3>::Pointer
Convert(const TImage * from, TMap && map)
{
  auto to = itk::Image<TPixel, 3>::New();
  to->CopyInformation(from);
  to->SetRegions(from->GetBufferedRegion());
  to->Allocate();
  itk::ImageRegionConstIterator<TImage> in(from, from->GetBufferedRegion());
  for (itk::ImageRegionIterator<itk::Image<TPixel, 3>> out(to, to->GetBufferedRegion()); !out.IsAtEnd(); ++out, ++in)
  {
    out.Set(static_cast<TPixel>(map(in.Get())));
  }
  return to;
}

/** Labels as a type: the bone is 7, all else 0. */
template <typename TPixel>
typename itk::Image<TPixel, 3>::Pointer
LabelsAs()
{
  return Convert<TPixel>(Specimen::Get().labels.GetPointer(), [](short label) { return label != 0 ? 7 : 0; });
}

/** The CT in whole numbers that every type can hold. */
template <typename TPixel>
typename itk::Image<TPixel, 3>::Pointer
CTAs()
{
  return Convert<TPixel>(Specimen::Get().ct.GetPointer(),
                         [](float hu) { return std::clamp(std::round((hu + 1024.0F) / 12.0F), 0.0F, 255.0F); });
}

template <typename TPixel>
std::vector<Vector3>
ImprovedPoints()
{
  auto filter = MeshQualityFilter<Mesh, itk::Image<TPixel, 3>>::New();
  filter->SetInput(Specimen::Get().pipeline.GetTiling()->GetOutput());
  filter->SetContours(Specimen::Get().pipeline.GetSnake()->GetOutput());
  filter->SetLabelImage(LabelsAs<TPixel>());
  filter->SetLabel(7);
  filter->Update();
  return filter->GetOutput()->GetArrays().points;
}

template <typename TPixel>
std::vector<double>
FittedCoefficients()
{
  auto filter = DensityFitFilter<itk::Image<TPixel, 3>, Mesh>::New();
  filter->SetImage(CTAs<TPixel>());
  filter->SetMesh(Specimen::Get().pipeline.GetQuality()->GetOutput());
  filter->Update();
  return filter->GetOutput()->GetArrays().coefficients;
}

template <typename TPixel>
std::vector<double>
CalibratedCoefficients()
{
  using Image = itk::Image<TPixel, 3>;
  auto filter = DensityCalibrationFilter<Image, Mesh, Image>::New();
  filter->SetInput(Specimen::Get().pipeline.GetFit()->GetOutput());
  filter->SetImage(CTAs<TPixel>());
  filter->SetLabels(LabelsAs<TPixel>());
  filter->SetReferences({ { "nothing", 0.0, 0.0 }, { "bone", 800.0, 7 } },
                        DensityQuantity::HydroxyapatiteMilligramPerCubicCentimetre);
  filter->Update();
  return filter->GetOutput()->GetArrays().coefficients;
}

template <typename TPixel>
std::vector<float>
Radiograph()
{
  using Image = itk::Image<TPixel, 3>;
  auto filter = VoxelDRRImageFilter<Image, CTImage, Image>::New();
  filter->SetInput(CTAs<TPixel>());
  filter->SetMask(LabelsAs<TPixel>());
  filter->SetMaskLabel(7);
  filter->SetGeometry(Specimen::Get().geometry);
  filter->Update();
  const CTImage * image = filter->GetOutput();
  return { image->GetBufferPointer(), image->GetBufferPointer() + image->GetBufferedRegion().GetNumberOfPixels() };
}

template <typename TPixel>
class FilterTypes : public testing::Test
{
};
using Pixels = testing::Types<unsigned char, short, unsigned short, int, float>;
TYPED_TEST_SUITE(FilterTypes, Pixels, );

TYPED_TEST(FilterTypes, LabelMapsOfTheMeshQuality)
{
  static const auto expected = ImprovedPoints<double>();
  EXPECT_EQ(ImprovedPoints<TypeParam>(), expected);
}

TYPED_TEST(FilterTypes, ImagesOfTheDensityFit)
{
  static const auto expected = FittedCoefficients<double>();
  EXPECT_EQ(FittedCoefficients<TypeParam>(), expected);
}

TYPED_TEST(FilterTypes, ImagesAndLabelMapsOfTheCalibration)
{
  static const auto expected = CalibratedCoefficients<double>();
  EXPECT_NE(expected, Specimen::Get().pipeline.GetFit()->GetOutput()->GetArrays().coefficients);
  EXPECT_EQ(CalibratedCoefficients<TypeParam>(), expected);
}

TYPED_TEST(FilterTypes, ImagesAndMasksOfTheRadiograph)
{
  static const auto expected = Radiograph<double>();
  EXPECT_GT(*std::max_element(expected.begin(), expected.end()), 0.0F);
  EXPECT_EQ(Radiograph<TypeParam>(), expected);
}
} // namespace test
} // namespace FilterTypesTests
} // namespace bone
