/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneMeasureReport.h"

#include "boneDensityEvaluation.h"
#include "boneTestBodies.h"
#include "boneTestFemur.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace MeasureReportTests
{
using namespace bone;

MeshArrays
Rod(DensityQuantity quantity)
{
  MeshArrays mesh = test::MakeTube({});
  test::SetDensity(mesh, 1, [](const Vector3 & x) { return 500.0 + 10.0 * x.z(); });
  mesh.quantity = quantity;
  return mesh;
}

const nlohmann::json &
Named(const nlohmann::json & list, const std::string & name)
{
  for (const auto & entry : list)
  {
    if (entry.at("name") == name)
    {
      return entry;
    }
  }
  throw std::runtime_error(name + " is missing");
}

TEST(MeasureReport, RegionsAreThoseOfTheMesh)
{
  const MeshArrays mesh = Rod(DensityQuantity::HounsfieldUnit);
  const auto       report = ReportMeasures(MeasureModel(mesh, {}));
  for (const RegionDensity & region : MeasureRegions(mesh))
  {
    const std::string name = "model.region" + std::to_string(region.region);
    EXPECT_NEAR(Named(report["measures"], name + ".volume")["value"], region.volume, 1e-8 * region.volume);
    EXPECT_NEAR(Named(report["measures"], name + ".mass")["value"], region.mass, 1e-8 * region.mass);
    EXPECT_NEAR(Named(report["measures"], name + ".meanDensity")["value"], region.mean, 1e-8 * region.mean);
  }
  EXPECT_EQ(Named(report["measures"], "model.meanDensity")["unit"], "HU");
  EXPECT_FALSE(Named(report["measures"], "model.mass").contains("errorBound"));
  EXPECT_TRUE(report["landmarks"].empty());
}

TEST(MeasureReport, MassesAreInMilligramsWhereTheDensityHasAUnit)
{
  const auto mass = [](DensityQuantity quantity) {
    return Named(ReportMeasures(MeasureModel(Rod(quantity), {}))["measures"], "model.mass");
  };
  const auto hounsfield = mass(DensityQuantity::HounsfieldUnit);
  EXPECT_EQ(hounsfield["unit"], "HU mm^3");
  const auto mineral = mass(DensityQuantity::HydroxyapatiteMilligramPerCubicCentimetre);
  EXPECT_EQ(mineral["unit"], "mg");
  EXPECT_NEAR(mineral["value"].get<double>() / hounsfield["value"].get<double>(), 1e-3, 1e-12);
  const auto ash = mass(DensityQuantity::AshGramPerCubicCentimetre); // 1 g/cm^3 is 1 mg/mm^3
  EXPECT_EQ(ash["unit"], "mg");
  EXPECT_NEAR(ash["value"].get<double>() / hounsfield["value"].get<double>(), 1.0, 1e-12);
}

TEST(MeasureReport, MeanDensityIsWithinItsBound)
{
  const Vector3 centre(1.5, 0, 11);
  const auto    report = ReportMeasures(
    MeasureModel(Rod(DensityQuantity::HounsfieldUnit), {}, { { "ball1", "a ball", MakeBall(centre, 4.0) } }));
  const auto & mean = Named(report["measures"], "ball1.meanDensity");
  EXPECT_GT(mean["errorBound"], 0.0);
  EXPECT_NEAR(mean["value"], 610.0, mean["errorBound"].get<double>());
  EXPECT_THAT(mean["definition"].get<std::string>(), testing::HasSubstr("a ball"));
}

TEST(MeasureReport, WhatAModelLacksIsSaid)
{
  MeshArrays mesh = test::MakeTube({});
  const auto report = ReportMeasures(MeasureModel(mesh, { { "tip", Vector3(0, 0, 30) } }));
  EXPECT_THAT(Named(report["missing"], "model.mass")["reason"].get<std::string>(), testing::HasSubstr("no density"));
  EXPECT_THAT(Named(report["missing"], "femur")["reason"].get<std::string>(), testing::HasSubstr("no landmark"));
  const auto & tip = Named(report["landmarks"], "tip");
  EXPECT_NEAR(tip["distance"], 8.0, 1e-9);
  EXPECT_EQ(tip["value"], (std::vector<double>{ 0, 0, 30 }));
  EXPECT_EQ(tip["barycentric"].size(), 4u);
}

TEST(MeasureReport, ASurfaceHasNoDensityButABonesMeasures)
{
  const test::FemurShape shape;
  const TriangleSurface  surface = shape.Surface(4.0);
  const auto             report = ReportMeasures(MeasureSurface(surface, shape.Landmarks()));
  EXPECT_NEAR(Named(report["measures"], "headRadius")["value"], shape.headRadius, 0.1);
  EXPECT_NEAR(Named(report["measures"], "model.volume")["value"], EnclosedVolume(surface), 1e-6);
  EXPECT_EQ(Named(report["measures"], "side")["value"], "right");
  EXPECT_EQ(Named(report["measures"], "headCentre")["value"].size(), 3u);
  EXPECT_THAT(Named(report["missing"], "neckCorticalThickness")["reason"].get<std::string>(),
              testing::HasSubstr("surface"));
  EXPECT_FALSE(report["landmarks"][0].contains("cell"));
}
} // namespace MeasureReportTests
