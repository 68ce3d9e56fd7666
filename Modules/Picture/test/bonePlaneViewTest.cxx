/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "bonePlaneView.h"

#include "boneFigure.h"
#include "bonePictureTestTools.h"
#include "boneXRayPicture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace PlaneViewTests
{
using namespace bone;

constexpr double Degree = 0.017453292519943295;

Eigen::Matrix3d
Turn(const Vector3 & axis, double degrees)
{
  return Eigen::AngleAxisd(degrees * Degree, axis.normalized()).toRotationMatrix();
}

/** An image of 40 mm cubed about `centre`, with these axes. */
CTImage::Pointer
ImageOf(const Eigen::Matrix3d & axes, const Vector3 & spacing, const Vector3 & centre)
{
  auto                   image = CTImage::New();
  CTImage::DirectionType direction;
  CTImage::SizeType      size;
  Vector3                origin = centre;
  for (unsigned int d = 0; d < 3; ++d)
  {
    size[d] = static_cast<itk::SizeValueType>(std::lround(40.0 / spacing[d])) + 1;
    origin -= 0.5 * static_cast<double>(size[d] - 1) * spacing[d] * axes.col(d);
    for (unsigned int r = 0; r < 3; ++r)
    {
      direction(r, d) = axes(r, d);
    }
  }
  image->SetRegions(size);
  image->SetDirection(direction);
  image->SetSpacing(spacing.data());
  image->SetOrigin(origin.data());
  image->Allocate();
  image->FillBuffer(0.0F);
  return image;
}

struct Orientation
{
  std::string     name;
  Eigen::Matrix3d axes;
  Vector3         spacing;
};

std::vector<Orientation>
Orientations()
{
  Eigen::Matrix3d ras = Eigen::Vector3d(-1.0, -1.0, 1.0).asDiagonal();
  Eigen::Matrix3d sagittal; // columns run to the back, rows to the feet, slices to the right
  sagittal << 0, 0, -1, 1, 0, 0, 0, -1, 0;
  return { { "LPS", Eigen::Matrix3d::Identity(), { 1.0, 1.0, 2.0 } },
           { "RAS", ras, { 1.0, 1.0, 2.0 } },
           { "sagittal", sagittal, { 1.0, 2.0, 1.0 } },
           { "oblique", Turn({ 1.0, 2.0, 3.0 }, 12.0), { 1.0, 1.0, 1.0 } } };
}

/** Which of the sides left and right, and of top and bottom, is a direction's. */
bool
IsOnSide(const std::string & letter, const std::string & low, const std::string & high, double share)
{
  return letter == low ? share < 0.5 : letter == high ? share > 0.5 : true;
}

TEST(PlaneView, ABeadLiesWhereTheLettersSay)
{
  const Vector3 centre(5.0, -7.0, 11.0);
  for (const Orientation & orientation : Orientations())
  {
    const auto image = ImageOf(orientation.axes, orientation.spacing, centre);
    // The voxel nearest to 10 mm to the left, front and head of the centre.
    const Vector3         wanted = centre + Vector3(10.0, -10.0, 10.0);
    itk::Point<double, 3> point;
    std::copy(wanted.data(), wanted.data() + 3, point.Begin());
    CTImage::IndexType index;
    ASSERT_TRUE(image->TransformPhysicalPointToIndex(point, index));
    image->SetPixel(index, 1000.0F);
    image->TransformIndexToPhysicalPoint(index, point);
    const Vector3              bead(point[0], point[1], point[2]);
    const std::vector<Vector3> corners = { centre + Vector3::Constant(18.0), centre - Vector3::Constant(18.0) };

    for (int axis = 0; axis < 3; ++axis)
    {
      const PlaneView view = FramePlane((axis == 1 ? -1.0 : 1.0) * Vector3::Unit(axis), bead, corners, 0.0, 144);
      const Panel     panel = SamplePlane(image, view);
      const auto      brightest = std::max_element(panel.values.begin(), panel.values.end(), [](float a, float b) {
        return b > a || (std::isnan(a) && !std::isnan(b));
      });
      const auto      at = static_cast<int>(brightest - panel.values.begin());
      const int       column = at % panel.columns, row = at / panel.columns;
      const auto      expected = view.Project(bead);
      EXPECT_NEAR(column, expected.x(), 0.51) << orientation.name << axis;
      EXPECT_NEAR(row, expected.y(), 0.51) << orientation.name << axis;

      const SideLetters letters = view.Letters();
      EXPECT_EQ(letters.top, axis == 2 ? "A" : "S");
      EXPECT_EQ(letters.bottom, axis == 2 ? "P" : "I");
      EXPECT_EQ(letters.left, axis == 0 ? "A" : "R");
      EXPECT_EQ(letters.right, axis == 0 ? "P" : "L");
      // The bead is at the patient's left, front and head.
      const double across = (column + 0.5) / panel.columns, downward = (row + 0.5) / panel.rows;
      for (const std::string letter : { "L", "A", "S" })
      {
        EXPECT_TRUE(IsOnSide(letter, letters.left, letters.right, across)) << orientation.name << axis << letter;
        EXPECT_TRUE(IsOnSide(letter, letters.top, letters.bottom, downward)) << orientation.name << axis << letter;
      }
    }
  }
}

TEST(PlaneView, AFigureShowsTheBeadWhereOverlaysAreDrawn)
{
  const auto image = ImageOf(Eigen::Matrix3d::Identity(), { 1.0, 1.0, 1.0 }, Vector3::Zero());
  image->SetPixel({ { 30, 10, 30 } }, 1000.0F); // at (10, -10, 10)
  const Vector3   bead(10.0, -10.0, 10.0);
  const PlaneView view =
    FramePlane(Vector3::UnitZ(), bead, { Vector3::Constant(18.0), Vector3::Constant(-18.0) }, 0.0, 72);
  Vector2   drawn;
  PanelCell cell;
  cell.panel = SamplePlane(image, view);
  cell.style.title = "a bead";
  cell.style.window = { 0.0, 500.0 };
  cell.overlay = [&](Canvas &, const Rectangle & place) { drawn = PanelPoint(place, cell.panel, view.Project(bead)); };
  const auto picture = DrawFigure({ { { "heading", { { cell } } } }, {}, "" }).GetImage();
  const auto at = PixelOf(picture, std::lround(drawn.x() - 0.5), std::lround(drawn.y() - 0.5));
  EXPECT_GT(at[0], 250);
  EXPECT_LT(PixelOf(picture, std::lround(drawn.x() - 0.5) + 3, std::lround(drawn.y() - 0.5))[0], 20);
}

TEST(PlaneView, AxialViewHasLeftToTheRightAndFrontUp)
{
  const std::vector<Vector3> points = { { -10, -20, 5 }, { 30, 40, 5 } };
  const PlaneView            view = FramePlane(Vector3::UnitZ(), points[0], points, 5.0, 70);
  EXPECT_TRUE(view.right.isApprox(Vector3::UnitX()));
  EXPECT_TRUE(view.down.isApprox(Vector3::UnitY()));
  EXPECT_TRUE(view.corner.isApprox(Vector3(-15, -25, 5)));
  EXPECT_NEAR(view.Project(points[1]).x(), 45.0 / view.pixel, 1e-9);
}

TEST(PlaneView, CutFollowsThePointsAndHasTheHeadUp)
{
  std::vector<Vector3> points;
  for (int i = 0; i < 50; ++i)
  {
    points.emplace_back(std::cos(i) * 10.0, std::sin(2.0 * i), 4.0 * i);
  }
  const PlaneView view = FrameLargestCut(points, 2.0, 200);
  EXPECT_LT(view.down.z(), -0.99);
  EXPECT_GT(view.right.x(), 0.99);
}

TEST(DirectionLetters, TellTheSecondAxisBeyondTwentyDegrees)
{
  EXPECT_EQ(DirectionLetters(Vector3::UnitX()), "L");
  EXPECT_EQ(DirectionLetters(-Vector3::UnitX()), "R");
  EXPECT_EQ(DirectionLetters(Vector3::UnitY()), "P");
  EXPECT_EQ(DirectionLetters(-Vector3::UnitY()), "A");
  EXPECT_EQ(DirectionLetters(Vector3::UnitZ()), "S");
  EXPECT_EQ(DirectionLetters(-Vector3::UnitZ()), "I");
  const auto turned = [](double degrees) {
    return Vector3(std::cos(degrees * Degree), -std::sin(degrees * Degree), 0.0);
  };
  EXPECT_EQ(DirectionLetters(turned(19.0)), "L");
  EXPECT_EQ(DirectionLetters(turned(21.0)), "LA");
  EXPECT_EQ(DirectionLetters(3.0 * turned(60.0)), "AL");
  EXPECT_EQ(DirectionLetters(Vector3::Zero()), "");
}

TEST(DescribePlane, NamesOrientationAndPlace)
{
  EXPECT_EQ(DescribePlane(-Vector3::UnitY(), { 1.0, 12.34, 3.0 }), "coronal plane, y = 12.3 mm");
  EXPECT_EQ(DescribePlane(Vector3::UnitZ(), { 1.0, 2.0, -0.01 }), "axial plane, z = 0.0 mm");
  EXPECT_EQ(DescribePlane(Turn(Vector3::UnitZ(), 18.2) * Vector3::UnitX(), { 1.0, 12.34, -3.0 }),
            "oblique plane, 18\u00B0 from sagittal, through (1.0, 12.3, -3.0) mm");
}

TEST(DescribeSlice, CountsTheSlicesOfTheFile)
{
  const auto image = ImageOf(Eigen::Matrix3d::Identity(), { 1.0, 1.0, 2.0 }, Vector3::Zero()); // z: -20, -18, ...
  EXPECT_EQ(DescribeSlice(image, Vector3::UnitZ(), { 0.0, 0.0, -20.0 }), "CT slice 0, z = -20.0 mm");
  EXPECT_EQ(DescribeSlice(image, -Vector3::UnitZ(), { 0.0, 0.0, 12.05 }), "CT slice 16, z = 12.1 mm");
  EXPECT_EQ(DescribeSlice(image, Vector3::UnitZ(), { 0.0, 0.0, 11.0 }), "between CT slices 15 and 16, z = 11.0 mm");
  EXPECT_EQ(DescribeSlice(image, Vector3::UnitZ(), { 0.0, 0.0, 22.0 }), "z = 22.0 mm");
  EXPECT_EQ(DescribeSlice(image, Vector3::UnitY(), { 0.0, 3.0, 0.0 }), "CT slice 23, y = 3.0 mm");
  EXPECT_EQ(DescribeSlice(image, Vector3(0.0, 0.6, 0.8), { 0.0, 5.0, 0.0 }), "3.0 mm along (0.00, 0.60, 0.80)");

  const Eigen::Matrix3d flipped = Eigen::Vector3d(1.0, -1.0, -1.0).asDiagonal();
  EXPECT_EQ(DescribeSlice(ImageOf(flipped, { 1.0, 1.0, 2.0 }, Vector3::Zero()), Vector3::UnitZ(), { 0.0, 0.0, -20.0 }),
            "CT slice 20, z = -20.0 mm");
  const auto tilted = Turn(Vector3::UnitX(), 30.0);
  EXPECT_EQ(DescribeSlice(ImageOf(tilted, { 1.0, 1.0, 2.0 }, Vector3::Zero()), tilted.col(2), 4.0 * tilted.col(2)),
            "CT slice 12, 4.0 mm along (0.00, -0.50, 0.87)");
}

TEST(XRayPicture, AViewFromTheFrontHasThePatientsLeftToTheRight)
{
  const auto front = XRayGeometry::Framing(
    Vector3::Constant(-50.0), Vector3::Constant(50.0), Vector3::UnitY(), Vector3::UnitZ(), 1000.0, 1200.0, 100);
  EXPECT_EQ(DescribeView(front), "AP view");
  EXPECT_EQ(LettersOf(front).right, "L");
  EXPECT_EQ(LettersOf(front).left, "R");
  EXPECT_EQ(LettersOf(front).top, "S");
  EXPECT_EQ(LettersOf(front).bottom, "I");
  // What is 10 mm apart at the centre is so many pixels apart.
  auto geometry = XRayGeometry::New();
  geometry->SetView(front);
  const double pixels = (geometry->ProjectPoint({ 10, 0, 0 }) - geometry->ProjectPoint({ 0, 0, 0 })).norm();
  EXPECT_NEAR(PixelSizeAt(front, Vector3::Zero()).x() * pixels, 10.0, 1e-9);

  const auto view = [](const Vector3 & beam) {
    return XRayGeometry::Framing(
      Vector3::Constant(-50.0), Vector3::Constant(50.0), beam, Vector3::UnitZ(), 1000.0, 1200.0, 100);
  };
  EXPECT_EQ(DescribeView(view(-Vector3::UnitY())), "PA view");
  EXPECT_EQ(DescribeView(view(-Vector3::UnitX())), "lateral view, beam from L to R");
  EXPECT_EQ(LettersOf(view(-Vector3::UnitX())).right, "P");
  EXPECT_EQ(DescribeView(view(Turn(Vector3::UnitZ(), 30.0) * Vector3::UnitY())), "oblique view, beam from AL to PR");
  XRayGeometry::View parallel = front;
  parallel.parallel = true;
  parallel.direction = -Vector3::UnitY();
  EXPECT_EQ(DescribeView(parallel), "PA view");
  EXPECT_EQ(PixelSizeAt(parallel, Vector3::Zero()), parallel.spacing);
}
} // namespace PlaneViewTests
