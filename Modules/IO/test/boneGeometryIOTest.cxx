/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneGeometryIO.h"

#include "boneTestFiles.h"

#include <Eigen/Geometry>

namespace bone
{
using testing::AllOf;
using testing::HasSubstr;

namespace GeometryIOTests
{
XRayGeometry::Pointer
MakeView(bool parallel, double angle)
{
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(angle, Vector3(1, 2, 3).normalized()).toRotationMatrix();
  XRayGeometry::View    view;
  view.parallel = parallel;
  // What the other kind of beam has is not written: leave it at its default.
  (parallel ? view.direction : view.source) =
    parallel ? Vector3(turn * Vector3(0, 1, 0)) : Vector3(turn * Vector3(0, -900, 10));
  view.detectorOrigin = turn * Vector3(-100.0 / 3, 200, 7);
  view.detectorU = turn * Vector3(1, 0, 0);
  view.detectorV = turn * Vector3(0, 0, -1);
  view.size = { { 300, 201 } };
  view.spacing = { 0.1 + 0.2, 1.0 / 3 };
  auto geometry = XRayGeometry::New();
  geometry->SetView(view);
  return geometry;
}

void
ExpectSame(const XRayGeometry::View & a, const XRayGeometry::View & b)
{
  EXPECT_EQ(a.parallel, b.parallel);
  EXPECT_EQ(a.source, b.source);
  EXPECT_EQ(a.direction, b.direction);
  EXPECT_EQ(a.detectorOrigin, b.detectorOrigin);
  EXPECT_EQ(a.detectorU, b.detectorU);
  EXPECT_EQ(a.detectorV, b.detectorV);
  EXPECT_EQ(a.size, b.size);
  EXPECT_EQ(a.spacing, b.spacing);
}

class GeometryIOTest : public FileTest
{
protected:
  std::string
  ErrorOfReading(const std::string & text)
  {
    WriteText("g.json", text);
    return ErrorOf([&] { ReadGeometry(Path("g.json")); });
  }
  const std::string m_Good = R"("source": [0, -900, 0], "detectorOrigin": [0, 100, 0], "detectorU": [1, 0, 0],
                                "detectorV": [0, 0, -1], "size": [3, 4], "spacing": [1, 2])";
};

TEST_F(GeometryIOTest, RefusesMorePixelsThanADetectorHas)
{
  std::string view = m_Good;
  view.replace(view.find("[3, 4]"), 6, "[200000, 100000]");
  WriteText("g.json", "{" + view + "}");
  EXPECT_THAT(ErrorOf([&] { ReadGeometry(Path("g.json")); }), testing::HasSubstr("asks for 2e+10 pixels"));
}

TEST_F(GeometryIOTest, ViewsAreReadAsWritten)
{
  for (const auto & views : { std::vector<XRayGeometry::Pointer>{ MakeView(false, 0.3) },
                              { MakeView(true, 1.0) },
                              { MakeView(false, 0), MakeView(true, -2), MakeView(false, 0.7) } })
  {
    WriteGeometry(views, Path("g.json"));
    const auto back = ReadGeometry(Path("g.json"));
    ASSERT_EQ(back.size(), views.size());
    for (std::size_t i = 0; i < views.size(); ++i)
    {
      ExpectSame(back[i]->GetView(), views[i]->GetView());
    }
  }
}

TEST_F(GeometryIOTest, ReadsTheDocumentedObjectAlone)
{
  WriteText("g.json", "{" + m_Good + "}");
  const auto views = ReadGeometry(Path("g.json"));
  ASSERT_EQ(views.size(), 1u);
  EXPECT_EQ(views[0]->GetView().size, (std::array<int, 2>{ { 3, 4 } }));
  EXPECT_EQ(views[0]->GetView().source, Vector3(0, -900, 0));
}

TEST_F(GeometryIOTest, SaysWhichMemberIsMissingUnknownOrWrong)
{
  const auto without = [&](const std::string & from, const std::string & to) {
    std::string text = "{" + m_Good + "}";
    return text.replace(text.find(from), from.size(), to);
  };
  EXPECT_THAT(ErrorOf([&] { ReadGeometry(Path("no.json")); }), HasSubstr("there is no such file"));
  EXPECT_THAT(ErrorOfReading("This is a text."), HasSubstr("g.json: is no JSON: "));
  EXPECT_THAT(ErrorOfReading("[]"), HasSubstr("holds no view"));
  EXPECT_THAT(ErrorOfReading("[1]"), HasSubstr("is number where an object is needed"));
  EXPECT_THAT(ErrorOfReading("{}"), HasSubstr("'source' (or, for a parallel beam, 'direction') is missing"));
  EXPECT_THAT(ErrorOfReading(without("\"source\": [0, -900, 0],", "")), HasSubstr("'source'"));
  EXPECT_THAT(ErrorOfReading(without("\"source\"", "\"sauce\"")), HasSubstr("'sauce' is unknown; there are source"));
  EXPECT_THAT(ErrorOfReading(without("\"size\"", "\"direction\": [0, 1, 0], \"size\"")), HasSubstr("both"));
  EXPECT_THAT(ErrorOfReading(without("\"detectorU\": [1, 0, 0],", "")), HasSubstr("'detectorU' is missing"));
  EXPECT_THAT(ErrorOfReading(without("[1, 0, 0]", "[1, 0]")), HasSubstr("'detectorU' must be a list of 3 numbers"));
  EXPECT_THAT(ErrorOfReading(without("[1, 0, 0]", "[1, 0, \"x\"]")), HasSubstr("'detectorU' must be a list of 3"));
  EXPECT_THAT(ErrorOfReading(without("[3, 4]", "[3, 4.5]")), HasSubstr("'size' must be two positive whole numbers"));
  EXPECT_THAT(ErrorOfReading(without("[3, 4]", "[0, 4]")), HasSubstr("'size' must be two positive whole numbers"));
  EXPECT_THAT(ErrorOfReading(without("[1, 2]", "[1, -2]")), HasSubstr("spacing"));
  EXPECT_THAT(ErrorOfReading(without("[1, 0, 0]", "[2, 0, 0]")), HasSubstr("unit vectors"));
  EXPECT_THAT(ErrorOfReading("[{" + m_Good + "}, {}]"), AllOf(HasSubstr("view 2"), HasSubstr("is missing")));
}

/** A view of plastimatch's handedness, the detector before the source. */
XRayGeometry::Pointer
MakeUsualView(double angle)
{
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(angle, Vector3(1, 2, 3).normalized()).toRotationMatrix();
  XRayGeometry::View    view;
  view.source = turn * Vector3(10, -900, 20);
  view.detectorOrigin = turn * Vector3(-100, 200, 70);
  view.detectorU = turn * Vector3(1, 0, 0);
  view.detectorV = turn * Vector3(0, 0, -1);
  view.size = { { 300, 201 } };
  view.spacing = { 0.3, 0.4 };
  auto geometry = XRayGeometry::New();
  geometry->SetView(view);
  return geometry;
}

void
ExpectClose(const XRayGeometry & a, const XRayGeometry & b)
{
  EXPECT_EQ(a.GetView().size, b.GetView().size);
  EXPECT_NEAR((a.GetView().source - b.GetView().source).norm(), 0, 1e-8);
  for (const Vector2 & pixel : { Vector2(0, 0), Vector2(299, 0), Vector2(0, 200) })
  {
    EXPECT_NEAR((a.GetPixelPoint(pixel[0], pixel[1]) - b.GetPixelPoint(pixel[0], pixel[1])).norm(), 0, 1e-8);
  }
}

TEST_F(GeometryIOTest, OtherConventionsComeBack)
{
  const std::vector<XRayGeometry::Pointer> views = { MakeUsualView(0.3), MakeUsualView(-2) };
  for (auto convention : { GeometryConvention::Matrix, GeometryConvention::Plastimatch })
  {
    WriteGeometry(views, Path("g.json"), convention);
    const auto back = ReadGeometry(Path("g.json"));
    ASSERT_EQ(back.size(), views.size());
    for (std::size_t i = 0; i < views.size(); ++i)
    {
      ExpectClose(*back[i], *views[i]);
    }
    EXPECT_THAT(ErrorOf([&] { WriteGeometry({ MakeView(true, 0) }, Path("p.json"), convention); }),
                HasSubstr("parallel beam"));
  }
}

TEST_F(GeometryIOTest, RtksFilesComeBackThroughAJsonThatNamesThem)
{
  const std::vector<XRayGeometry::Pointer> views = { MakeUsualView(0.3), MakeUsualView(-2) };
  const RtkGrid                            grid = WriteRtkGeometry(views, Path("g.xml"));
  EXPECT_TRUE(grid.rowsDown);
  WriteText("g.json", R"({"rtk": "g.xml", "size": [300, 201], "spacing": [0.3, 0.4], "rowsDown": true})");
  const auto back = ReadGeometry(Path("g.json"));
  ASSERT_EQ(back.size(), 2u);
  ExpectClose(*back[0], *views[0]);
  ExpectClose(*back[1], *views[1]);
  EXPECT_THAT(ErrorOf([&] { WriteRtkGeometry({ views[0], MakeView(true, 0) }, Path("h.xml")); }), HasSubstr("stack"));
}

TEST_F(GeometryIOTest, ReadsAnRtkFileWithCommonParameters)
{
  const std::string head =
    "<?xml version=\"1.0\"?>\n<!DOCTYPE RTKGEOMETRY>\n<RTKThreeDCircularGeometry version=\"3\">\n";
  const std::string tail = "</RTKThreeDCircularGeometry>\n";
  const std::string common = "<SourceToIsocenterDistance>1000</"
                             "SourceToIsocenterDistance><SourceToDetectorDistance>1500</SourceToDetectorDistance>";
  WriteText(
    "g.xml",
    head + common +
      "<Projection><GantryAngle>0</GantryAngle><Matrix>-1500 0 0 0 0 -1500 0 0 0 0 1 -1000</Matrix></Projection>"
      "<Projection><GantryAngle>90</GantryAngle><ProjectionOffsetX>5</ProjectionOffsetX></Projection>" +
      tail);
  const auto projections = ReadRtkGeometry(Path("g.xml"));
  ASSERT_EQ(projections.size(), 2u);
  EXPECT_EQ(projections[1].gantryAngle, 90);
  EXPECT_EQ(projections[1].projectionOffsetX, 5);
  EXPECT_EQ(projections[1].sourceToDetector, 1500);

  const auto errorOf = [&](const std::string & text) {
    WriteText("e.xml", text);
    return ErrorOf([&] { ReadRtkGeometry(Path("e.xml")); });
  };
  EXPECT_THAT(errorOf("no XML"), HasSubstr("is no RTK geometry"));
  EXPECT_THAT(errorOf("<VTKFile/>"), HasSubstr("is no RTK geometry"));
  EXPECT_THAT(errorOf(head + tail), HasSubstr("no projection"));
  EXPECT_THAT(errorOf(head + "<Projection><GantryAngle>x</GantryAngle></Projection>" + tail), HasSubstr("GantryAngle"));
  EXPECT_THAT(errorOf(head + common + "<Projection><Matrix>1 2 3 4 5 6 7 8 9 10 11 12</Matrix></Projection>" + tail),
              HasSubstr("does not follow"));
  EXPECT_THAT(errorOf(head + "<RadiusCylindricalDetector>900</RadiusCylindricalDetector><Projection/>" + tail),
              HasSubstr("flat"));
  EXPECT_THAT(ErrorOf([&] { ReadRtkGeometry(Path("no.xml")); }), HasSubstr("no such file"));
}

TEST_F(GeometryIOTest, AWriteThatFailsLeavesNothing)
{
  EXPECT_THAT(ErrorOf([&] { WriteGeometry({ MakeView(false, 0) }, Path("no/g.json")); }), HasSubstr("no folder"));
  EXPECT_THAT(ErrorOf([&] {
                const FullDisk full(100);
                WriteGeometry({ MakeView(false, 0) }, Path("g.json"));
              }),
              HasSubstr("cannot write"));
  EXPECT_THAT(Files(), testing::IsEmpty());
}
} // namespace GeometryIOTests
} // namespace bone
