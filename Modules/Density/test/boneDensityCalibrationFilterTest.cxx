/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneDensityCalibrationFilter.h"

#include "boneDensityEvaluation.h"
#include "boneDensityFitFilter.h"
#include "boneDensityTestMeshes.h"

#include <gtest/gtest.h>

namespace DensityCalibrationFilterTests
{
using namespace bone;
using Filter = DensityCalibrationFilter<>;

constexpr auto K2HPO4 = DensityQuantity::K2HPO4MilligramPerCubicCentimetre;
constexpr auto Ash = DensityQuantity::AshGramPerCubicCentimetre;
constexpr auto Apparent = DensityQuantity::ApparentGramPerCubicCentimetre;

/** A block of tetrahedra whose density is 100 HU everywhere. */
DensityMesh<double>::Pointer
MeshOf100HU()
{
  MeshArrays mesh = test::MakeBlock({ { 2, 2, 2 } }, Vector3(0, 0, 0), 5.0, 0.1);
  mesh.maximumDegree = 2;
  mesh.degree.assign(mesh.tetrahedra.size(), 2);
  mesh.coefficients.assign(mesh.tetrahedra.size() * 10, 100.0);
  mesh.quantity = DensityQuantity::HounsfieldUnit;
  return test::ToMesh(mesh);
}

Filter::Pointer
MakeFilter()
{
  auto filter = Filter::New();
  filter->SetInput(MeshOf100HU());
  return filter;
}

double
Mean(const Filter & filter)
{
  return MeasureRegions(filter.GetOutput()->GetArrays())[0].mean;
}

/** Rods along z of 0, 200 and 800 HU in water of -50, on an oblique image, and their axes. */
struct RodPhantom
{
  RodPhantom()
  {
    image = test::ObliqueImage<test::Image>([this](const Vector3 & x) {
      for (int rod = 0; rod < 3; ++rod)
      {
        if ((x - ClosestPointOnSegment(x, from[rod], to[rod])).norm() <= 3)
        {
          return value[rod];
        }
      }
      return -50.0;
    });
    labels = Filter::LabelImageType::New();
    labels->CopyInformation(image);
    labels->SetRegions(image->GetBufferedRegion());
    labels->Allocate(true);
    const std::size_t count = image->GetBufferedRegion().GetNumberOfPixels();
    for (std::size_t v = 0; v < count; ++v)
    {
      const float x = image->GetBufferPointer()[v];
      labels->GetBufferPointer()[v] = static_cast<short>(x == 0.0F ? 1 : x == 200.0F ? 2 : x == 800.0F ? 3 : 0);
    }
  }

  std::vector<DensityReference>
  Rods() const
  {
    return { { "a", -5.0, ReferenceRegion{ from[0], to[0], 2.5 } },
             { "b", 155.0, ReferenceRegion{ from[1], to[1], 2.5 } },
             { "c", 635.0, ReferenceRegion{ from[2], to[2], 2.5 } } };
  }

  std::array<Vector3, 3>                  from{ { { 4, -8, 26 }, { 12, -6, 26 }, { 8, 0, 26 } } };
  std::array<Vector3, 3>                  to{ { { 4, -8, 32 }, { 12, -6, 32 }, { 8, 0, 32 } } };
  std::array<double, 3>                   value{ { 0.0, 200.0, 800.0 } };
  test::Image::Pointer                    image;
  itk::SmartPointer<itk::Image<short, 3>> labels;
};

TEST(DensityCalibrationFilter, AGivenLineThenLawsInOrder)
{
  const auto filter = MakeFilter();
  filter->SetLine(-10.0, 0.8, K2HPO4);
  filter->SetLaws({ "les1994", "schileo2008" });
  filter->Update();
  EXPECT_NEAR(Mean(*filter), (0.0526 + 1.22 * 0.070) / 0.598, 1e-12);
  EXPECT_EQ(filter->GetOutput()->GetCells().quantity, Apparent);
  ASSERT_EQ(filter->GetSteps().size(), 3U);
  EXPECT_EQ(filter->GetSteps()[1].law.name, "les1994");
  EXPECT_EQ(filter->GetSteps()[1].outside, 0.0);
  EXPECT_FALSE(filter->GetCalibration());
  EXPECT_EQ(filter->GetInput()->GetCells().quantity, DensityQuantity::HounsfieldUnit) << "the input stays";
}

TEST(DensityCalibrationFilter, RodsLabelsAndKnownValuesGiveTheSameLine)
{
  const RodPhantom phantom;
  auto             filter = MakeFilter();
  filter->SetImage(phantom.image);
  filter->SetLabels(phantom.labels);
  auto references = phantom.Rods();
  for (int way = 0; way < 3; ++way)
  {
    for (int rod = 0; rod < 3 && way > 0; ++rod)
    {
      references[rod].measure =
        way == 1 ? DensityReference::Measure(rod + 1) : DensityReference::Measure(phantom.value[rod]);
    }
    filter->SetReferences(references, K2HPO4);
    filter->Update();
    ASSERT_TRUE(filter->GetCalibration());
    EXPECT_NEAR(filter->GetCalibration()->law.slope, 0.8, 1e-12) << way;
    EXPECT_NEAR(filter->GetCalibration()->law.intercept, -5.0, 1e-9) << way;
    EXPECT_NEAR(filter->GetCalibration()->rms, 0.0, 1e-9) << way;
    EXPECT_NEAR(Mean(*filter), 75.0, 1e-9);
  }
}

TEST(DensityCalibrationFilter, CalibratingTheImageOrTheModelIsTheSame)
{
  const auto image =
    test::ObliqueImage<test::Image>([](const Vector3 & x) { return 300 + 20 * x[0] - 9 * x[1] * x[2]; });
  auto       calibrated = test::ObliqueImage<test::Image>([](const Vector3 & x) {
    return -10 + 0.8 * static_cast<double>(static_cast<float>(300 + 20 * x[0] - 9 * x[1] * x[2]));
  });
  const auto block = test::MakeBlock({ { 2, 2, 2 } }, Vector3(4, -8, 25), 4.0, 0.1);
  const auto fit = [&block](const test::Image * of, DensityQuantity quantity) {
    auto filter = DensityFitFilter<>::New();
    filter->SetInput(test::ToMesh(block));
    filter->SetImage(of);
    filter->SetDegree(2);
    filter->SetQuantity(quantity);
    filter->Update();
    return DensityMesh<double>::Pointer(filter->GetOutput());
  };
  auto filter = Filter::New();
  filter->SetInput(fit(image, DensityQuantity::HounsfieldUnit));
  filter->SetLine(-10.0, 0.8, K2HPO4);
  filter->Update();
  const auto & model = filter->GetOutput()->GetCells().coefficients;
  const auto   direct = fit(calibrated, K2HPO4);
  const auto & expected = direct->GetCells().coefficients;
  ASSERT_EQ(model.size(), expected.size());
  for (std::size_t i = 0; i < model.size(); ++i)
  {
    EXPECT_NEAR(model[i], expected[i], 1e-3);
  }
}

TEST(DensityCalibrationFilter, MixingQuantitiesIsAnError)
{
  auto filter = MakeFilter();
  filter->SetLaws({ "les1994" });
  EXPECT_THROW(filter->Update(), itk::ExceptionObject) << "HU is no K2HPO4";
  filter->SetLine(0.0, 1.0, K2HPO4);
  filter->SetLaws({ "keyak2005" });
  EXPECT_THROW(filter->Update(), itk::ExceptionObject) << "K2HPO4 is no HA";
  filter->SetLaws({});
  filter->Update();
  auto second = Filter::New();
  second->SetInput(filter->GetOutput());
  second->SetLine(0.0, 1.0, Ash);
  EXPECT_THROW(second->Update(), itk::ExceptionObject) << "calibrated twice";
}

TEST(DensityCalibrationFilter, RefusesWhatIsMissing)
{
  const RodPhantom phantom;
  auto             filter = MakeFilter();
  EXPECT_THROW(filter->Update(), itk::ExceptionObject) << "nothing to apply";
  filter->SetReferences(phantom.Rods(), K2HPO4);
  EXPECT_THROW(filter->Update(), itk::ExceptionObject) << "no image";
  filter->SetImage(phantom.image);
  EXPECT_NO_THROW(filter->Update());
  filter->SetReferences({ { "a", 0.0, 1 }, { "b", 100.0, 2 } }, K2HPO4);
  EXPECT_THROW(filter->Update(), itk::ExceptionObject) << "no labels";
  filter->SetLabels(phantom.labels);
  EXPECT_NO_THROW(filter->Update());
  filter->SetReferences({ { "a", 0.0, 1 }, { "b", 100.0, 7 } }, K2HPO4);
  EXPECT_THROW(filter->Update(), itk::ExceptionObject) << "no voxel";
  filter->SetReferences({ { "a", 100.0, 1 }, { "b", 0.0, 2 } }, K2HPO4);
  EXPECT_THROW(filter->Update(), itk::ExceptionObject) << "falling";
  filter->SetReferences(phantom.Rods(), DensityQuantity::HounsfieldUnit);
  EXPECT_THROW(filter->Update(), itk::ExceptionObject) << "leads nowhere";
  filter->SetLine(0.0, std::nan(""), K2HPO4);
  EXPECT_THROW(filter->Update(), itk::ExceptionObject) << "not a number";
  filter->SetLine(0.0, 1.0, K2HPO4);
  filter->SetLaws({ "smith" });
  EXPECT_THROW(filter->Update(), itk::ExceptionObject) << "no such law";
}

TEST(DensityCalibrationFilter, LabelsOfAnyTypeAndMeshesOfFloats)
{
  const RodPhantom phantom;
  using ByteImage = itk::Image<unsigned char, 3>;
  using FloatMesh = DensityMesh<float>;
  auto labels = ByteImage::New();
  labels->CopyInformation(phantom.labels);
  labels->SetRegions(phantom.labels->GetBufferedRegion());
  labels->Allocate();
  const short * from = phantom.labels->GetBufferPointer();
  std::copy_n(from, labels->GetBufferedRegion().GetNumberOfPixels(), labels->GetBufferPointer());
  auto filter = DensityCalibrationFilter<test::Image, FloatMesh, ByteImage>::New();
  filter->SetInput(test::ToMesh<FloatMesh>(MeshOf100HU()->GetArrays()));
  filter->SetImage(phantom.image);
  filter->SetLabels(labels);
  filter->SetReferences({ { "a", -5.0, 1 }, { "b", 155.0, 2 } }, K2HPO4);
  filter->Update();
  EXPECT_NEAR(MeasureRegions(filter->GetOutput()->GetArrays())[0].mean, 75.0, 1e-9);
}

TEST(DensityCalibrationFilter, RefusesALineBesideReferencesAndOneThatIsNone)
{
  auto filter = MakeFilter();
  filter->SetReferences({ { "a", 0.0, 1.0 }, { "b", 100.0, 2.0 } }, K2HPO4);
  filter->Update();
  filter->SetLine(std::vector<double>{ 0.0, 1.0 });
  EXPECT_THROW(filter->Update(), itk::ExceptionObject);
  filter->SetReferences({}, K2HPO4);
  for (const auto & line : { std::vector<double>{ 1.0 }, { 0.0, -1.0 } })
  {
    filter->SetLine(line);
    EXPECT_THROW(filter->Update(), itk::ExceptionObject);
  }
}

TEST(DensityCalibrationFilter, RunsAgainOnlyOnChange)
{
  auto filter = MakeFilter();
  filter->SetLine(0.0, 1.0, K2HPO4);
  filter->Update();
  const auto time = filter->GetOutput()->GetMTime();
  filter->SetLine(0.0, 1.0, K2HPO4);
  filter->SetLaws({});
  filter->Update();
  EXPECT_EQ(filter->GetOutput()->GetMTime(), time);
  filter->SetLine(1.0, 1.0, K2HPO4);
  filter->Update();
  EXPECT_GT(filter->GetOutput()->GetMTime(), time);
  EXPECT_NEAR(Mean(*filter), 101.0, 1e-12);
}
} // namespace DensityCalibrationFilterTests
