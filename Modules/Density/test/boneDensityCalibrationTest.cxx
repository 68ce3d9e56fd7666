/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneDensityCalibration.h"

#include "boneDensityEvaluation.h"
#include "boneDensityQuantityChoices.h"
#include "boneDensityTestMeshes.h"
#include "boneReferenceRegion.h"

#include <gtest/gtest.h>

namespace DensityCalibrationTests
{
using namespace bone;

MeshArrays
MeshWithDensity()
{
  MeshArrays mesh = test::MakeBlock({ { 2, 2, 2 } }, Vector3(0, 0, 0), 5.0, 0.1);
  mesh.maximumDegree = 2;
  mesh.degree.assign(mesh.tetrahedra.size(), 1);
  mesh.coefficients.assign(mesh.tetrahedra.size() * 10, 0.0);
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
  {
    for (int i = 0; i < 4; ++i)
    {
      mesh.coefficients[10 * t + i] = test::Linear(mesh.points[mesh.tetrahedra[t][i]]);
    }
  }
  mesh.quantity = DensityQuantity::HounsfieldUnit;
  return mesh;
}

TEST(DensityCalibration, ReferencesOnALineGiveThatLine)
{
  const Calibration calibration = CalibrateDensity({ { "a", 10, 8 }, { "b", 110, 88 }, { "c", 1010, 808 } },
                                                   DensityQuantity::HydroxyapatiteMilligramPerCubicCentimetre);
  EXPECT_NEAR(calibration.law.slope, 0.8, 1e-12);
  EXPECT_NEAR(calibration.law.intercept, 0, 1e-10);
  EXPECT_NEAR(calibration.rms, 0, 1e-10);
  EXPECT_NEAR(calibration.correlation, 1, 1e-12);
  EXPECT_EQ(calibration.law.low, 10);
  EXPECT_EQ(calibration.law.high, 1010);
}

TEST(DensityCalibration, ResidualsAddUpToNothing)
{
  const Calibration calibration = CalibrateDensity({ { "a", 0, -3 }, { "b", 100, 90 }, { "c", 200, 160 } },
                                                   DensityQuantity::K2HPO4MilligramPerCubicCentimetre);
  EXPECT_NEAR(calibration.residuals[0] + calibration.residuals[1] + calibration.residuals[2], 0, 1e-10);
  EXPECT_GT(calibration.rms, 1);
}

TEST(DensityCalibration, RefusesReferencesThatMakeNoLine)
{
  const auto to = DensityQuantity::AshGramPerCubicCentimetre;
  EXPECT_THROW(CalibrateDensity({}, to), std::invalid_argument);
  EXPECT_THROW(CalibrateDensity({ { "a", 1, 1 } }, to), std::invalid_argument);
  EXPECT_THROW(CalibrateDensity({ { "a", 1, 1 }, { "b", 1, 2 } }, to), std::invalid_argument);
  EXPECT_THROW(CalibrateDensity({ { "a", 1, 2 }, { "b", 2, 1 } }, to), std::invalid_argument);
  EXPECT_THROW(CalibrateDensity({ { "a", 1, 2 }, { "b", std::nan(""), 3 } }, to), std::invalid_argument);
}

TEST(DensityCalibration, ALawActsOnValuesAsOnCoefficients)
{
  MeshArrays         mesh = MeshWithDensity();
  const auto         before = MeasureRegions(mesh);
  const TetraLocator locator(mesh);
  const CellLocation place = locator.Find(Vector3(3.3, 4.1, 7.2));
  const double       value = DensityAt(mesh, place);
  DensityLaw         law;
  law.to = DensityQuantity::K2HPO4MilligramPerCubicCentimetre;
  law.slope = 0.7;
  law.intercept = -12;
  law.low = -1e9;
  law.high = 1e9;
  EXPECT_EQ(ConvertDensity(mesh, law), 0);
  EXPECT_NEAR(DensityAt(mesh, place), law(value), 1e-9);
  EXPECT_EQ(mesh.quantity, law.to);
  const auto after = MeasureRegions(mesh);
  EXPECT_NEAR(after[0].mean, law(before[0].mean), 1e-9);
  EXPECT_NEAR(after[0].standardDeviation, 0.7 * before[0].standardDeviation, 1e-9);
  EXPECT_EQ(mesh.coefficients[4], 0) << "what a tetrahedron of lower degree does not use stays 0";
}

TEST(DensityCalibration, MixingQuantitiesIsAnError)
{
  MeshArrays mesh = MeshWithDensity();
  EXPECT_THROW(ConvertDensity(mesh, FindDensityLaw("les1994")), std::invalid_argument);
  EXPECT_EQ(mesh.quantity, DensityQuantity::HounsfieldUnit);
  mesh.quantity = DensityQuantity::K2HPO4MilligramPerCubicCentimetre;
  EXPECT_NO_THROW(ConvertDensity(mesh, FindDensityLaw("les1994")));
  EXPECT_THROW(ConvertDensity(mesh, FindDensityLaw("keyak2005")), std::invalid_argument);
  EXPECT_NO_THROW(ConvertDensity(mesh, FindDensityLaw("schileo2008")));
  EXPECT_EQ(mesh.quantity, DensityQuantity::ApparentGramPerCubicCentimetre);
  EXPECT_THROW(RequireDensityQuantity(DensityQuantity::Unknown, DensityQuantity::HounsfieldUnit, "the CT"),
               std::invalid_argument);
  mesh.maximumDegree = -1;
  EXPECT_THROW(ConvertDensity(mesh, DensityLaw()), std::invalid_argument);
}

TEST(DensityCalibration, SaysHowMuchLiesOutsideTheRangeOfALaw)
{
  MeshArrays mesh = MeshWithDensity();
  DensityLaw law;
  law.low = 0;
  law.high = 1;
  EXPECT_NEAR(ConvertDensity(mesh, law), 1, 1e-12);
}

TEST(DensityCalibration, PublishedLawsHaveNamesUnitsAndSources)
{
  // 1 g/cm^3 of K2HPO4 is 1.2726 g/cm^3 of ash, which is 2.13 of apparent density.
  EXPECT_NEAR(FindDensityLaw("les1994")(1000), 1.2726, 1e-12);
  EXPECT_NEAR(FindDensityLaw("keyak2005")(1000), 0.9503, 1e-12);
  EXPECT_NEAR(FindDensityLaw("schileo2008")(0.598), 1, 1e-12);
  for (const DensityLaw & law : PublishedDensityLaws())
  {
    EXPECT_FALSE(law.source.empty());
    EXPECT_LT(law.low, law.high);
    EXPECT_NE(law.from, law.to);
  }
  EXPECT_THROW(FindDensityLaw("smith"), std::invalid_argument);
  EXPECT_EQ(ParseChoice<DensityQuantity>("ha"), DensityQuantity::HydroxyapatiteMilligramPerCubicCentimetre);
  EXPECT_THROW(ParseChoice<DensityQuantity>("kg"), std::invalid_argument);
}

TEST(MeasureReference, FindsARodOnAnObliqueImage)
{
  const Vector3 from(8, -6, 25), to(12, -2, 34);
  const auto    image = test::ObliqueImage<test::DoubleImage>(
    [&](const Vector3 & x) { return (x - ClosestPointOnSegment(x, from, to)).norm() <= 4 ? 200.0 : 20.0; });
  const auto inside = MeasureReference(*image, { from, to, 3.9 });
  EXPECT_EQ(inside.mean, 200);
  EXPECT_EQ(inside.standardDeviation, 0);
  const double volume = 3.14159265 * 3.9 * 3.9 * ((to - from).norm() + 4.0 / 3 * 3.9);
  EXPECT_NEAR(static_cast<double>(inside.voxels) * 0.8 * 1.1 * 1.7 / volume, 1, 0.05);
  EXPECT_LT(MeasureReference(*image, { from, to, 6.0 }).mean, 150);
  EXPECT_EQ(MeasureReference(*image, { Vector3(500, 0, 0), Vector3(500, 0, 9), 3.0 }).voxels, 0u);
}
} // namespace DensityCalibrationTests
