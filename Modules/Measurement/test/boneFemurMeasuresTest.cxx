/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneFemurMeasures.h"

#include "boneTestBodies.h"
#include "boneTestFemur.h"
#include "boneTestMeasures.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace FemurMeasuresTests
{
using namespace bone;
using test::FemurShape;

std::string
ReasonOf(const MeasureList & list, const std::string & name)
{
  for (const MissingMeasure & missing : list.missing)
  {
    if (missing.name == name)
    {
      return missing.reason;
    }
  }
  return "";
}

TEST(FemurMeasures, KnownAnglesAndSizesAreFound)
{
  for (const FemurShape & shape :
       { FemurShape(), FemurShape{ 25.0, 56.0, 119.0, 28.0, 15.0 }, FemurShape{ 21.0, 50.0, 138.0, -6.0, 12.5 } })
  {
    const auto femur = FitFemur(shape.Surface(), shape.Landmarks());
    const auto list = MeasureFemur(femur);
    EXPECT_TRUE(list.missing.empty());
    EXPECT_NEAR(ValueOf(list, "headRadius"), shape.headRadius, 0.05);
    EXPECT_NEAR((femur.head->centre - shape.HeadCentre()).norm(), 0.0, 0.05);
    EXPECT_NEAR(ValueOf(list, "neckShaftAngle"), shape.neckShaftAngle, 0.3);
    EXPECT_NEAR(ValueOf(list, "anteversion"), shape.anteversion, 0.5);
    EXPECT_NEAR(ValueOf(list, "femoralOffset"), shape.HeadCentre().head<2>().norm(), 0.1);
    EXPECT_NEAR(ValueOf(list, "neckHeight"), 2.0 * shape.neckRadius, 0.3);
    EXPECT_NEAR(ValueOf(list, "neckDepth"), 2.0 * shape.neckRadius, 0.3);
    EXPECT_NEAR(ValueOf(list, "neckSectionArea"), M_PI * shape.neckRadius * shape.neckRadius, 12.0);
    EXPECT_NEAR(femur.neck->narrowest, 30.0, 1.0);
    EXPECT_EQ(SideOf(list), "right");
  }
}

TEST(FemurMeasures, AnteversionIsSeenAlongTheLongAxisWhereACondyleIsHigher)
{
  FemurShape shape;
  shape.medialRise = 9.0;
  const auto list = MeasureFemur(FitFemur(shape.Surface(), shape.Landmarks()));
  EXPECT_NEAR(ValueOf(list, "anteversion"), shape.anteversion, 0.8);
}

TEST(FemurMeasures, MoveWithTheBone)
{
  const FemurShape shape;
  TriangleSurface  surface = shape.Surface();
  auto             landmarks = shape.Landmarks();
  const auto       still = MeasureFemur(FitFemur(surface, landmarks));
  const auto       turn = Eigen::AngleAxisd(2.3, Vector3(1, -2, 0.5).normalized());
  const Vector3    shift(300, -200, 1000);
  for (Vector3 & p : surface.points)
  {
    p = turn * p + shift;
  }
  for (Landmark & landmark : landmarks)
  {
    landmark.point = turn * landmark.point + shift;
  }
  const auto moved = MeasureFemur(FitFemur(surface, landmarks));
  EXPECT_EQ(SideOf(moved), "right");
  for (const Measure & measure : still.measures)
  {
    if (measure.value.size() == 1)
    {
      EXPECT_NEAR(ValueOf(moved, measure.name), measure.value[0], 1e-4) << measure.name;
    }
  }
}

TEST(FemurMeasures, AMirroredFemurIsALeftOneWithTheSameMeasures)
{
  const FemurShape shape;
  TriangleSurface  surface = shape.Surface();
  auto             landmarks = shape.Landmarks();
  const auto       right = MeasureFemur(FitFemur(surface, landmarks));
  for (Vector3 & p : surface.points)
  {
    p.x() = -p.x();
  }
  for (auto & t : surface.triangles)
  {
    std::swap(t[0], t[1]);
  }
  for (Landmark & landmark : landmarks)
  {
    landmark.point.x() = -landmark.point.x();
  }
  const auto left = MeasureFemur(FitFemur(surface, landmarks));
  EXPECT_EQ(SideOf(left), "left");
  for (const char * name : { "anteversion", "neckShaftAngle", "headRadius", "femoralOffset" })
  {
    EXPECT_NEAR(ValueOf(left, name), ValueOf(right, name), 1e-4) << name;
  }
}

TEST(FemurMeasures, HardlyDependOnWhereTheLandmarksAre)
{
  const FemurShape                       shape;
  const TriangleSurface                  surface = shape.Surface();
  std::mt19937                           random(2);
  std::uniform_real_distribution<double> uniform(-4.0, 4.0);
  for (int trial = 0; trial < 4; ++trial)
  {
    auto landmarks = shape.Landmarks();
    for (Landmark & landmark : landmarks)
    {
      landmark.point += Vector3(uniform(random), uniform(random), uniform(random));
    }
    const auto list = MeasureFemur(FitFemur(surface, landmarks));
    EXPECT_NEAR(ValueOf(list, "headRadius"), shape.headRadius, 0.05);
    EXPECT_NEAR(ValueOf(list, "neckShaftAngle"), shape.neckShaftAngle, 0.3);
    EXPECT_NEAR(ValueOf(list, "anteversion"), shape.anteversion, 0.5);
  }
}

TEST(FemurMeasures, WhatACutFemurLacksIsSaidWithItsReason)
{
  const FemurShape shape;
  const auto surface = test::MarchSurface([&shape](const Vector3 & x) { return std::max(shape(x), -210.3 - x.z()); },
                                          Vector3(-45.1, -50.3, -213.7),
                                          Vector3(75.2, 40.4, 75.6),
                                          2.9);
  const auto list = MeasureFemur(FitFemur(surface, shape.Landmarks()));
  EXPECT_NEAR(ValueOf(list, "neckShaftAngle"), shape.neckShaftAngle, 0.3);
  EXPECT_THAT(ReasonOf(list, "anteversion"), testing::HasSubstr("medial_condyle lies 1"));
  EXPECT_THAT(ReasonOf(list, "side"), testing::HasSubstr("medial_condyle"));
  auto few = shape.Landmarks();
  few.erase(few.begin());
  const auto without = MeasureFemur(FitFemur(surface, few));
  EXPECT_EQ(ReasonOf(without, "headRadius"), "landmark femoral_head is missing");
  EXPECT_EQ(ReasonOf(without, "neckShaftAngle"), "landmark femoral_head is missing");
  EXPECT_TRUE(MeasureFemur(FitFemur(surface, {})).measures.empty());
}

TEST(FemurMeasures, RefusesInterchangedCondyles)
{
  const FemurShape shape;
  auto             landmarks = shape.Landmarks();
  std::swap(landmarks[4].name, landmarks[5].name);
  EXPECT_THROW(FitFemur(shape.Surface(), landmarks), std::invalid_argument);
}

TEST(FemurMeasures, TheCortexOfARodHasItsThickness)
{
  test::TubeShape tube;
  tube.rings = { 2, 4 };
  tube.slices = 40;
  tube.around = 48;
  tube.spacing = 1.0;
  tube.bend = tube.jitter = 0.0;
  MeshArrays    mesh = test::MakeTube(tube);
  FemurGeometry femur;
  femur.head = FittedSphere{ Vector3(0, 0, 39.0), 15.0, 0.0 };
  femur.neck = FemurNeck();
  femur.neck->axis = Vector3::UnitZ();
  femur.neck->narrowest = 20.0;
  const double thickness = 2.0 * 12.0 / 6.5;
  const auto   list = MeasureNeckCortex(mesh, femur);
  EXPECT_NEAR(ValueOf(list, "neckCorticalThickness"), thickness, 0.02);
  ASSERT_EQ(list.measures.size(), 3u);
  ASSERT_EQ(list.measures[1].value.size(), 7u);
  for (const double value : list.measures[1].value)
  {
    EXPECT_NEAR(value, thickness, 0.02);
  }
  EXPECT_EQ(list.measures[2].value.front(), 15.0);
  EXPECT_EQ(list.measures[2].value.back(), 30.0);
  mesh.region.assign(mesh.region.size(), 1);
  EXPECT_EQ(MeasureNeckCortex(mesh, femur).missing.size(), 3u);
  femur.neck.reset();
  femur.neckReason = "landmark femoral_neck is missing";
  EXPECT_EQ(ReasonOf(MeasureNeckCortex(mesh, femur), "neckCorticalThickness"), femur.neckReason);
}
} // namespace FemurMeasuresTests
