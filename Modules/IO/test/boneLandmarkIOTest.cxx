/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneLandmarkIO.h"

#include "boneTestFiles.h"

namespace bone
{
using testing::HasSubstr;

namespace LandmarkIOTests
{
class LandmarkIO : public FileTest
{
protected:
  std::string
  Write(const std::string & text) const
  {
    WriteText("l.json", text);
    return Path("l.json");
  }
  std::string
  Markups(const std::string & points, const std::string & system = "LPS", const std::string & type = "Fiducial") const
  {
    return Write(R"({"markups": [{"type": ")" + type + R"(", "coordinateSystem": ")" + system +
                 R"(", "controlPoints": [)" + points + "]}]}");
  }
};

const std::string Two = R"({"label": "a", "position": [1, -2, 3], "positionStatus": "defined"},
                           {"label": "b", "position": [4, 5, 6]},
                           {"label": "later", "positionStatus": "undefined"})";

XRayGeometry::View
ObliqueView()
{
  XRayGeometry::View view;
  view.source = { 0, -900, 0 };
  view.detectorOrigin = { -50, 300, 80 };
  view.detectorU = { 0.8, 0, 0.6 };
  view.detectorV = { 0.6, 0, -0.8 };
  view.spacing = { 0.5, 0.25 };
  return view;
}

TEST_F(LandmarkIO, ReadsTheLabelledPointsOfMarkupsInEitherSystem)
{
  for (const std::string system : { "LPS", "RAS" })
  {
    const auto landmarks = ReadLandmarks(Markups(Two, system));
    ASSERT_EQ(landmarks.size(), 2u) << "what is not placed is passed over";
    EXPECT_EQ(landmarks[0].name, "a");
    EXPECT_EQ(landmarks[0].point, system == "LPS" ? Vector3(1, -2, 3) : Vector3(-1, 2, 3));
    EXPECT_EQ(landmarks[1].name, "b");
  }
}

TEST_F(LandmarkIO, ReadsNamesAndCoordinates)
{
  const auto landmarks = ReadLandmarks(Write(R"({"head": [1.5, 2, 3], "neck": [4, 5, 6]})"));
  ASSERT_EQ(landmarks.size(), 2u);
  EXPECT_EQ(landmarks[0].name, "head");
  EXPECT_EQ(landmarks[0].point, Vector3(1.5, 2, 3));
}

TEST_F(LandmarkIO, WhatWasWrittenIsReadBack)
{
  WriteLandmarks({ { "head", { 0.1, -2, 3 } }, { "neck", { 1e-7, 5, 1234.5678901234 } } }, Path("w.mrk.json"));
  const auto back = ReadLandmarks(Path("w.mrk.json"));
  ASSERT_EQ(back.size(), 2u);
  EXPECT_EQ(back[1].name, "neck");
  EXPECT_EQ(back[1].point, Vector3(1e-7, 5, 1234.5678901234));
}

TEST_F(LandmarkIO, ReadsPixels)
{
  const auto seen = ReadImageLandmarks(Write(R"({"a": [10.5, 20]})"), ObliqueView());
  ASSERT_EQ(seen.size(), 1u);
  EXPECT_EQ(seen[0].name, "a");
  EXPECT_EQ(seen[0].pixel, Vector2(10.5, 20));
}

TEST_F(LandmarkIO, PointsOnTheDetectorBecomeItsPixels)
{
  const auto geometry = XRayGeometry::New();
  geometry->SetView(ObliqueView());
  const Vector3 p = geometry->GetPixelPoint(33.25, 101);
  WriteLandmarks({ { "a", p + Vector3(0, 0.9, 0) } }, Path("p.mrk.json"));
  const auto seen = ReadImageLandmarks(Path("p.mrk.json"), ObliqueView());
  ASSERT_EQ(seen.size(), 1u);
  EXPECT_NEAR((seen[0].pixel - Vector2(33.25, 101)).norm(), 0, 1e-9);

  WriteLandmarks({ { "a", p + Vector3(0, 2, 0) } }, Path("p.mrk.json"));
  EXPECT_THAT(ErrorOf([&] { ReadImageLandmarks(Path("p.mrk.json"), ObliqueView()); }),
              HasSubstr("'a' lies 2 mm from the detector"));
}

TEST_F(LandmarkIO, RefusesWhatIsNoLandmarks)
{
  const auto error = [](const std::string & path) { return ErrorOf([&] { ReadLandmarks(path); }); };
  EXPECT_THAT(error(Path("none.json")), HasSubstr("none.json"));
  EXPECT_THAT(error(Write("text")), HasSubstr("is no JSON"));
  EXPECT_THAT(error(Write("[]")), HasSubstr("names and coordinates"));
  EXPECT_THAT(error(Write("{}")), HasSubstr("holds no landmarks"));
  EXPECT_THAT(error(Write(R"({"a": [1, 2]})")), HasSubstr("'a' must be a list of 3 numbers"));
  EXPECT_THAT(error(Write(R"({"a": [1, 2, 3e9]})")), HasSubstr("units mm"));
  EXPECT_THAT(error(Markups(Two, "LAS")), HasSubstr("'LAS'"));
  EXPECT_THAT(error(Markups(Two, "LPS", "ClosedCurve")), HasSubstr("'ClosedCurve'"));
  EXPECT_THAT(error(Markups(R"({"position": [1, 2, 3]})")), HasSubstr("without a name"));
  EXPECT_THAT(error(Markups(Two + "," + Two)), HasSubstr("two landmarks 'a'"));
}
} // namespace LandmarkIOTests
} // namespace bone
