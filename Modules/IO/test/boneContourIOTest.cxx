/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneContourIO.h"

#include "boneTestFiles.h"

#include <Eigen/Geometry>

#include <cmath>

namespace bone
{
using testing::AllOf;
using testing::HasSubstr;

namespace ContourIOTests
{
std::vector<Vector2>
Circle(double x, double y, double radius, int n)
{
  std::vector<Vector2> circle;
  for (int i = 0; i < n; ++i)
  {
    const double angle = 2 * 3.14159265358979 * i / n;
    circle.emplace_back(x + radius * std::cos(angle), y + radius * std::sin(angle));
  }
  return circle;
}

Contour
MakeContour(const ContourStack *         stack,
            double                       height,
            const std::vector<Vector2> & polygon,
            int                          layer,
            int                          id,
            int                          region)
{
  Contour contour;
  for (const Vector2 & q : polygon)
  {
    contour.points.push_back(stack->FromPlane(q, height));
  }
  contour.layer = layer;
  contour.id = id;
  contour.region = region;
  return contour;
}

// Three oblique slices: two nested contours with an axis and a hole; nothing; one contour with a single-point axis.
ContourStack::Pointer
MakeStack()
{
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.4, Vector3(1, -2, 0.5).normalized()).toRotationMatrix();
  auto                  stack = ContourStack::New();
  stack->SetFrame(turn.col(0), turn.col(1));
  ContourStack::SliceContainer slices(3);
  for (int k = 0; k < 3; ++k)
  {
    slices[k].origin = stack->FromPlane({ 1, 2 }, 10.0 + 4.0 / 3 * k);
  }
  auto hole = Circle(14, 0, 1, 7);
  std::reverse(hole.begin(), hole.end());
  const double first = slices[0].origin.dot(stack->GetNormal()), last = slices[2].origin.dot(stack->GetNormal());
  auto         axis = MakeContour(stack, first, { { -1, 0 }, { 0, 0.5 }, { 1, 0 } }, 2, 3, Trabecular);
  axis.axis = true;
  axis.clearance = { 9.0, 9.5, 9.25 };
  slices[0].contours = { MakeContour(stack, first, Circle(0, 0, 20, 30), 0, 0, Cortical),
                         MakeContour(stack, first, Circle(0, 0, 10, 20), 1, 1, Trabecular),
                         MakeContour(stack, first, hole, 0, 2, Outside),
                         axis };
  auto point = MakeContour(stack, last, { { 0, 0 } }, 1, 7, Cortical);
  point.axis = true;
  slices[2].contours = { point, MakeContour(stack, last, Circle(0, 0, 5, 9), 0, 4, Cortical) };
  stack->SetSlices(slices);
  stack->SetOpenEnd(true);
  return stack;
}

// An ASCII .vtp of polylines without any array.
std::string
PlainVtp(const std::vector<std::vector<Vector3>> & lines, const std::string & cellData = "")
{
  std::ostringstream points, connectivity, offsets;
  int                count = 0;
  for (const auto & line : lines)
  {
    for (const Vector3 & p : line)
    {
      points << p.x() << ' ' << p.y() << ' ' << p.z() << ' ';
      connectivity << count++ << ' ';
    }
    offsets << count << ' ';
  }
  return "<VTKFile type=\"PolyData\" version=\"0.1\" byte_order=\"LittleEndian\"><PolyData><Piece NumberOfPoints=\"" +
         std::to_string(count) + "\" NumberOfLines=\"" + std::to_string(lines.size()) +
         "\"><Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">" + points.str() +
         "</DataArray></Points><Lines><DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">" +
         connectivity.str() + "</DataArray><DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">" +
         offsets.str() + "</DataArray></Lines><CellData>" + cellData + "</CellData></Piece></PolyData></VTKFile>";
}

std::vector<Vector3>
Square(double x, double half, double z)
{
  return { { x - half, -half, z }, { x - half, half, z }, { x + half, half, z }, { x + half, -half, z } }; // clockwise
}

std::string
Markups(const std::string & system, const std::string & type, const std::vector<Vector3> & points)
{
  std::ostringstream text;
  text << R"({"@schema": "markups-schema-v1.0.3.json", "markups": [{"type": ")" << type << R"(", "coordinateSystem": ")"
       << system << R"(", "controlPoints": [)";
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    text << (i > 0 ? "," : "") << R"({"id": ")" << i << R"(", "position": [)" << points[i].x() << "," << points[i].y()
         << "," << points[i].z() << R"(], "positionStatus": "defined"})";
  }
  text << "]}]}";
  return text.str();
}

class ContourIOTest : public FileTest
{
protected:
  ContourStack::Pointer
  Read(const std::string & name, const std::string & text)
  {
    WriteText(name, text);
    return ReadContours(Path(name));
  }
  std::string
  ErrorOfReading(const std::string & name, const std::string & text)
  {
    WriteText(name, text);
    return ErrorOf([&] { ReadContours(Path(name)); });
  }
};

TEST_F(ContourIOTest, AStackIsReadAsWritten)
{
  const auto stack = MakeStack();
  stack->Verify();
  WriteContours(stack, Path("c.vtp"));
  EXPECT_THAT(Files(), testing::ElementsAre("c.vtp"));
  const auto back = ReadContours(Path("c.vtp"));
  EXPECT_TRUE(back->GetU().isApprox(stack->GetU(), 1e-14));
  EXPECT_TRUE(back->GetNormal().isApprox(stack->GetNormal(), 1e-14));
  EXPECT_EQ(back->GetOpenStart(), false);
  EXPECT_EQ(back->GetOpenEnd(), true);
  ASSERT_EQ(back->GetSlices().size(), 3u);
  for (std::size_t k = 0; k < 3; ++k)
  {
    const auto & a = stack->GetSlices()[k];
    const auto & b = back->GetSlices()[k];
    EXPECT_EQ(a.origin, b.origin);
    ASSERT_EQ(a.contours.size(), b.contours.size());
    for (std::size_t c = 0; c < a.contours.size(); ++c)
    {
      EXPECT_EQ(a.contours[c].points, b.contours[c].points);
      EXPECT_EQ(a.contours[c].layer, b.contours[c].layer);
      EXPECT_EQ(a.contours[c].id, b.contours[c].id);
      EXPECT_EQ(a.contours[c].region, b.contours[c].region);
      EXPECT_EQ(a.contours[c].axis, b.contours[c].axis);
      if (!a.contours[c].clearance.empty())
      {
        EXPECT_EQ(a.contours[c].clearance, b.contours[c].clearance);
      }
    }
  }
}

TEST_F(ContourIOTest, AnEmptyStackIsReadAsWritten)
{
  WriteContours(ContourStack::New(), Path("c.vtp"));
  EXPECT_THAT(ErrorOf([&] { ReadContours(Path("c.vtp")); }),
              testing::AnyOf("no IOError was thrown", HasSubstr("c.vtp: ")));
}

TEST_F(ContourIOTest, PlainPolylinesFindTheirSlicesHolesAndDirections)
{
  auto closed = Square(0, 10, 5);
  closed.push_back(closed.front()); // repeats its first point
  const auto stack = Read("c.vtp", PlainVtp({ Square(0, 10, 8.01), closed, Square(0, 5, 5.001), Square(30, 2, 5) }));
  EXPECT_EQ(stack->GetNormal(), Vector3(0, 0, 1));
  EXPECT_EQ(stack->GetU(), Vector3(1, 0, 0));
  ASSERT_EQ(stack->GetSlices().size(), 2u);
  const auto & slice = stack->GetSlices()[0];
  ASSERT_EQ(slice.contours.size(), 3u);
  int holes = 0;
  for (const auto & contour : slice.contours)
  {
    std::vector<Vector2> polygon;
    for (const auto & point : contour.points)
    {
      polygon.push_back(stack->ToPlane(point));
    }
    EXPECT_EQ(polygon.size(), 4u);
    EXPECT_EQ(SignedArea(polygon) < 0, contour.region == Outside);
    holes += contour.region == Outside ? 1 : 0;
  }
  EXPECT_EQ(holes, 1);
  EXPECT_NEAR(stack->GetHeight(1), 8.01, 1e-12);
}

TEST_F(ContourIOTest, PlainPolylinesWithSliceNumbers)
{
  const std::string slices = "<DataArray type=\"Int32\" Name=\"Slice\" format=\"ascii\">7 3</DataArray>";
  const auto        stack = Read("c.vtp", PlainVtp({ Square(0, 10, 2), Square(0, 10, 1) }, slices));
  ASSERT_EQ(stack->GetSlices().size(), 2u);
  EXPECT_NEAR(stack->GetHeight(0), 1, 1e-12);
}

TEST_F(ContourIOTest, RefusesAContourThatCrossesItself)
{
  auto bow = Square(0, 10, 0);
  std::swap(bow[1], bow[2]);
  EXPECT_THAT(ErrorOfReading("c.vtp", PlainVtp({ bow })), AllOf(HasSubstr("c.vtp: "), HasSubstr("crosses")));
  EXPECT_THAT(ErrorOfReading("c.mrk.json", Markups("LPS", "ClosedCurve", bow)), HasSubstr("crosses"));
  EXPECT_THAT(ErrorOfReading("c.vtp", PlainVtp({ Square(0, 10, 0), Square(9, 10, 0) })), HasSubstr("crosses"));
}

TEST_F(ContourIOTest, RefusesWhatHasNoPlanes)
{
  auto twisted = Square(0, 10, 0);
  twisted[0].z() += 3;
  EXPECT_THAT(ErrorOfReading("c.vtp", PlainVtp({ twisted })), HasSubstr("does not lie in a plane"));
  EXPECT_THAT(ErrorOfReading("c.vtp", PlainVtp({ { { 0, 0, 0 }, { 1, 0, 0 }, { 2, 0, 0 } } })),
              HasSubstr("span no plane"));
  EXPECT_THAT(ErrorOfReading("c.vtp", PlainVtp({ { { 0, 0, 0 }, { 1, 0, 0 } } })),
              HasSubstr("polyline 0 has 2 points"));
  EXPECT_THAT(ErrorOfReading("c.vtp", PlainVtp({ { { 0, 0, 0 } } })), HasSubstr("polyline 0 has 1 points"));
  EXPECT_THAT(ErrorOfReading("c.vtp", PlainVtp({})), HasSubstr("c.vtp: "));
}

TEST_F(ContourIOTest, RefusesBrokenFiles)
{
  EXPECT_THAT(ErrorOf([&] { ReadContours(Path("no.vtp")); }), HasSubstr("there is no such file"));
  EXPECT_THAT(ErrorOfReading("c.txt", "text"), HasSubstr("is no image"));
  EXPECT_THAT(ErrorOfReading("c.vtp", "text"), HasSubstr("is no readable VTK poly data"));
  WriteContours(MakeStack(), Path("c.vtp"));
  const std::string good = ReadText("c.vtp");
  EXPECT_THAT(ErrorOfReading("c.vtp", good.substr(0, good.size() / 2)), HasSubstr("c.vtp: "));
  const auto plain =
    PlainVtp({ Square(0, 10, 2) }, "<DataArray type=\"Int32\" Name=\"Slice\" format=\"ascii\">-1</DataArray>");
  EXPECT_THAT(ErrorOfReading("c.vtp", plain), HasSubstr("'Slice' has the value -1"));
}

TEST_F(ContourIOTest, ReadsSlicerCurvesInLpsAndRas)
{
  const auto points = Square(0, 10, 3);
  auto       mirrored = points;
  for (auto & p : mirrored)
  {
    p.head<2>() *= -1;
  }
  const auto lps = Read("l.mrk.json", Markups("LPS", "ClosedCurve", points));
  const auto ras = Read("r.mrk.json", Markups("RAS", "ClosedCurve", mirrored));
  ASSERT_EQ(lps->GetSlices().size(), 1u);
  EXPECT_EQ(lps->GetSlices()[0].contours[0].points.size(), 4u);
  EXPECT_EQ(lps->GetSlices()[0].contours[0].points, ras->GetSlices()[0].contours[0].points);
  EXPECT_EQ(lps->GetSlices()[0].contours[0].region, Cortical);
}

TEST_F(ContourIOTest, ClosedContoursComeBackFromSlicerCurves)
{
  const auto stack = MakeStack();
  WriteContours(stack, Path("c.mrk.json"));
  const auto back = ReadContours(Path("c.mrk.json"));
  ASSERT_EQ(back->GetSlices().size(), 2u); // the empty slice leaves no trace
  EXPECT_NEAR(back->GetNormal().dot(stack->GetNormal()), 1.0, 1e-12);
  for (std::size_t k : { 0, 2 })
  {
    std::vector<Contour> closed;
    for (const Contour & contour : stack->GetSlices()[k].contours)
    {
      if (!contour.axis)
      {
        closed.push_back(contour);
      }
    }
    const auto & found = back->GetSlices()[k / 2].contours;
    ASSERT_EQ(found.size(), closed.size());
    for (std::size_t c = 0; c < closed.size(); ++c)
    {
      EXPECT_EQ(found[c].layer, closed[c].layer);
      EXPECT_EQ(found[c].region, closed[c].region);
      EXPECT_EQ(found[c].id, closed[c].id);
      ASSERT_EQ(found[c].points.size(), closed[c].points.size());
      for (std::size_t i = 0; i < closed[c].points.size(); ++i)
      {
        EXPECT_NEAR((found[c].points[i] - closed[c].points[i]).norm(), 0.0, 1e-9);
      }
    }
  }
}

TEST_F(ContourIOTest, SaysWhatIsWrongWithMarkups)
{
  const auto points = Square(0, 10, 3);
  EXPECT_THAT(ErrorOfReading("c.mrk.json", "text"), HasSubstr("is no JSON"));
  EXPECT_THAT(ErrorOfReading("c.mrk.json", "{}"), HasSubstr("'markups' is missing"));
  EXPECT_THAT(ErrorOfReading("c.mrk.json", "[]"), HasSubstr("markups"));
  EXPECT_THAT(ErrorOfReading("c.mrk.json", R"({"markups": []})"), HasSubstr("holds no contours"));
  EXPECT_THAT(ErrorOfReading("c.mrk.json", Markups("LPS", "Fiducial", points)), HasSubstr("type 'Fiducial'"));
  EXPECT_THAT(ErrorOfReading("c.mrk.json", Markups("LAS", "ClosedCurve", points)), HasSubstr("'LAS'"));
  EXPECT_THAT(ErrorOfReading("c.mrk.json", Markups("LPS", "ClosedCurve", { points[0] })),
              HasSubstr("1 control points"));
}

TEST_F(ContourIOTest, AWriteThatFailsLeavesNothing)
{
  EXPECT_THAT(ErrorOf([&] { WriteContours(MakeStack(), Path("c.json")); }), HasSubstr("must end in .vtp"));
  EXPECT_THAT(ErrorOf([&] {
                const FullDisk full(1000);
                WriteContours(MakeStack(), Path("c.vtp"));
              }),
              HasSubstr("cannot write"));
  EXPECT_THAT(Files(), testing::IsEmpty());
}
} // namespace ContourIOTests
} // namespace bone
