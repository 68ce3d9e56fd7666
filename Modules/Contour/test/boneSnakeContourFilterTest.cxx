/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSnakeContourFilter.h"

#include "boneContourTestTools.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

namespace bone
{
namespace SnakeContourFilterTests
{
using testing::HasSubstr;
using Filter = SnakeContourFilter<TestCT>;

// A bowed tube: radius 9, cortex from 9 to 6.5, trabecular at 250 HU.
double
BowedTube(double x, double y, double z)
{
  return TubeDensity(x - 0.05 * z, y + 0.02 * z, 9.0, 6.5, 250.0);
}

short
BowedLabel(double x, double y, double z)
{
  return std::hypot(x - 0.05 * z, y + 0.02 * z) < 9.0 ? 3 : 0;
}

// The first slice's contour, a little off.
ContourStack::Pointer
StartContour(const ContourStack & frame, const Polygon & polygon, double height)
{
  auto stack = ContourStack::New();
  stack->SetFrame(frame.GetU(), frame.GetV());
  ContourSlice slice;
  slice.origin = stack->FromPlane({ 0, 0 }, height);
  Contour contour;
  for (const Vector2 & q : polygon)
  {
    contour.points.push_back(stack->FromPlane(q, height));
  }
  slice.contours = { contour };
  stack->SetSlices({ slice });
  return stack;
}

Filter::Pointer
FromLabel(const TestGrid & grid)
{
  auto filter = Filter::New();
  filter->SetInput(MakeImage<TestCT>(grid, BowedTube));
  filter->SetLabelImage(MakeImage<TestLabels>(grid, BowedLabel));
  filter->SetLabel(3);
  return filter;
}

double
MeanRadius(const ContourStack & stack, std::size_t k, int layer)
{
  double sum = 0.0;
  int    count = 0;
  for (const Contour & contour : stack.GetSlices()[k].contours)
  {
    for (const Vector3 & p : contour.points)
    {
      if (contour.layer == layer)
      {
        sum += std::hypot(p.x() - 0.05 * p.z(), p.y() + 0.02 * p.z());
        ++count;
      }
    }
  }
  return sum / count;
}

TEST(SnakeContourFilter, FindsTheLayersOfATubeFromItsLabel)
{
  const TestGrid grid;
  auto           filter = FromLabel(grid);
  filter->Update();
  const ContourStack * stack = filter->GetOutput();
  ASSERT_EQ(stack->GetSlices().size(), grid.size[2]);
  EXPECT_TRUE(stack->GetOpenStart());
  EXPECT_TRUE(stack->GetOpenEnd());
  EXPECT_THAT(filter->GetWarnings(), testing::Contains(HasSubstr("leaves the image")));
  for (std::size_t k = 0; k < stack->GetSlices().size(); ++k)
  {
    EXPECT_DOUBLE_EQ(stack->GetHeight(k), 5.0 + 2.0 * static_cast<double>(k));
    ASSERT_EQ(stack->GetSlices()[k].contours.size(), 2u);
    EXPECT_NEAR(MeanRadius(*stack, k, 0), 9.0, 0.1);
    EXPECT_NEAR(MeanRadius(*stack, k, 1), 6.5, 0.2);
    const Polygon outer = PlanePoints(*stack, stack->GetSlices()[k].contours[0]);
    const Polygon inner = PlanePoints(*stack, stack->GetSlices()[k].contours[1]);
    EXPECT_GT(SignedArea(outer), 0.0);
    for (const Vector2 & q : inner)
    {
      EXPECT_GT(DistanceTo(q, outer), 0.85);
    }
  }
}

TEST(SnakeContourFilter, FollowsATubeFromOneContourBothWays)
{
  const TestGrid grid;
  auto           labelled = FromLabel(grid);
  labelled->Update();
  auto filter = Filter::New();
  filter->SetInput(MakeImage<TestCT>(grid, BowedTube));
  filter->SetInitialContours(
    StartContour(*labelled->GetOutput(), Ellipse(10.5, 8.0, 60, { 0.7, -0.4 }), 5.0 + 2.0 * 5));
  filter->Update();
  const ContourStack * stack = filter->GetOutput();
  ASSERT_EQ(stack->GetSlices().size(), grid.size[2]);
  for (std::size_t k = 0; k < stack->GetSlices().size(); ++k)
  {
    EXPECT_NEAR(MeanRadius(*stack, k, 0), 9.0, 0.08);
    EXPECT_TRUE(filter->GetReport().slices[k].converged);
    EXPECT_GT(filter->GetReport().slices[k].iterations, 0);
  }
}

TEST(SnakeContourFilter, ContoursEndWhereTheBoneDoes)
{
  const TestGrid grid;
  const auto     ends = [](double x, double y, double z) { return z < 20.0 ? BowedTube(x, y, z) : 50.0; };
  auto           labelled = FromLabel(grid);
  labelled->Update();
  auto filter = Filter::New();
  filter->SetInput(MakeImage<TestCT>(grid, ends));
  filter->SetInitialContours(StartContour(*labelled->GetOutput(), Ellipse(9.0, 9.0, 60), 7.0));
  filter->Update();
  EXPECT_EQ(filter->GetOutput()->GetSlices().size(), 8u); // 5, 7, ..., 19
  EXPECT_TRUE(filter->GetOutput()->GetOpenStart());
  EXPECT_FALSE(filter->GetOutput()->GetOpenEnd());
}

TEST(SnakeContourFilter, FollowsALabelOfOneSliceWhenAsked)
{
  const TestGrid grid;
  auto           filter = Filter::New();
  filter->SetInput(MakeImage<TestCT>(grid, BowedTube));
  filter->SetLabelImage(MakeImage<TestLabels>(
    grid, [](double x, double y, double z) { return std::abs(z - 11.0) < 0.5 ? BowedLabel(x, y, z) : 0; }));
  filter->SetNumberOfLayers(1);
  filter->Update();
  EXPECT_EQ(filter->GetOutput()->GetSlices().size(), 1u);
  filter->FollowLabelOn();
  filter->Update();
  ASSERT_EQ(filter->GetOutput()->GetSlices().size(), grid.size[2]);
  for (std::size_t k = 0; k < filter->GetOutput()->GetSlices().size(); ++k)
  {
    EXPECT_NEAR(MeanRadius(*filter->GetOutput(), k, 0), 9.0, 0.08);
  }
}

TEST(SnakeContourFilter, RefinementMovesTheOutlineToTheEdge)
{
  // A label that is half a voxel too large all around.
  const TestGrid grid;
  auto           filter = Filter::New();
  filter->SetInput(MakeImage<TestCT>(grid, BowedTube));
  filter->SetLabelImage(MakeImage<TestLabels>(
    grid, [](double x, double y, double z) { return std::hypot(x - 0.05 * z, y + 0.02 * z) < 9.4 ? 1 : 0; }));
  filter->Update();
  EXPECT_NEAR(MeanRadius(*filter->GetOutput(), 4, 0), 9.4, 0.1);
  filter->RefineLabelOutlineOn();
  filter->Update();
  EXPECT_NEAR(MeanRadius(*filter->GetOutput(), 4, 0), 9.0, 0.08);
}

TEST(SnakeContourFilter, MovesWithARigidMotionOfItsInput)
{
  TestGrid grid;
  auto     still = FromLabel(grid);
  still->Update();
  grid.rotation = Eigen::AngleAxisd(0.7, Vector3(1, 2, -0.5).normalized()).toRotationMatrix();
  auto moved = FromLabel(grid);
  moved->Update();
  for (Filter * filter : { still.GetPointer(), moved.GetPointer() })
  {
    auto snake = Filter::New();
    snake->SetInput(filter->GetInput());
    snake->SetInitialContours(StartContour(
      *filter->GetOutput(), PlanePoints(*filter->GetOutput(), filter->GetOutput()->GetSlices()[3].contours[0]), 11.0));
    snake->Update();
    filter->SetInitialContours(snake->GetOutput()); // its result on all slices
    filter->Update();
  }
  const auto & a = still->GetOutput()->GetSlices();
  const auto & b = moved->GetOutput()->GetSlices();
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t k = 0; k < a.size(); ++k)
  {
    ASSERT_EQ(a[k].contours.size(), b[k].contours.size());
    for (std::size_t c = 0; c < a[k].contours.size(); ++c)
    {
      ASSERT_EQ(a[k].contours[c].points.size(), b[k].contours[c].points.size());
      for (std::size_t i = 0; i < a[k].contours[c].points.size(); ++i)
      {
        ASSERT_LT((grid.rotation * a[k].contours[c].points[i] - b[k].contours[c].points[i]).norm(), 1e-3);
      }
    }
  }
}

TEST(SnakeContourFilter, HonoursTheRegionsIndexAndOtherAxes)
{
  TestGrid grid;
  auto     plain = FromLabel(grid);
  plain->Update();
  grid.start = { { 17, -4, 9 } };
  auto shifted = FromLabel(grid);
  shifted->Update();
  EXPECT_NEAR((plain->GetOutput()->GetSlices()[2].contours[0].points[0] -
               shifted->GetOutput()->GetSlices()[2].contours[0].points[0])
                .norm(),
              0.0,
              1e-9);
  grid.size = { { 60, 56, 30 } };
  auto across = FromLabel(grid);
  across->SetAxis(0);
  across->SetSliceStep(2.0);
  across->Update();
  EXPECT_NEAR(std::abs(across->GetOutput()->GetNormal().x()), 1.0, 1e-12);
  for (std::size_t k = 1; k < across->GetOutput()->GetSlices().size(); ++k)
  {
    EXPECT_LE(across->GetOutput()->GetHeight(k) - across->GetOutput()->GetHeight(k - 1), 2.0 + 1e-9);
  }
}

TEST(SnakeContourFilter, KeepsSplitsAndHolesOfTheLabel)
{
  TestGrid grid;
  grid.size = { { 90, 70, 12 } };
  grid.origin = { -31, -31, 0 };
  const auto inside = [](double x, double y, double z) {
    if (z < 8.0) // a ring
    {
      return std::abs(std::hypot(x, y) - 10.0) < 4.0;
    }
    return std::hypot(x - 11.0, y) < 7.0 || std::hypot(x + 11.0, y) < 7.0; // two disks
  };
  auto filter = Filter::New();
  filter->SetInput(MakeImage<TestCT>(grid, [&](double x, double y, double z) { return inside(x, y, z) ? 800 : 40; }));
  filter->SetLabelImage(
    MakeImage<TestLabels>(grid, [&](double x, double y, double z) { return inside(x, y, z) ? 1 : 0; }));
  filter->Update();
  const auto & slices = filter->GetOutput()->GetSlices();
  for (std::size_t k = 0; k < slices.size(); ++k)
  {
    int outer = 0;
    int holes = 0;
    int innerInRing = 0;
    for (const Contour & contour : slices[k].contours)
    {
      outer += contour.layer == 0 && contour.region == Region::Cortical;
      holes += contour.layer == 0 && contour.region == Region::Outside;
      innerInRing += contour.layer > 0 && k < 4;
    }
    EXPECT_EQ(outer, k < 4 ? 1 : 2) << k;
    EXPECT_EQ(holes, k < 4 ? 1 : 0) << k;
    EXPECT_EQ(innerInRing, 0) << k;
  }
}

TEST(SnakeContourFilter, FindsAMedullaryCavity)
{
  TestGrid grid;
  grid.size = { { 60, 56, 24 } };
  auto filter = Filter::New();
  filter->SetInput(MakeImage<TestCT>(grid, [](double x, double y, double) {
    return TubeDensity(x, y, 12.0, 9.0, 130.0) - 180.0 * Blurred(6.0 - std::hypot(x, y), 0.6);
  }));
  filter->SetLabelImage(
    MakeImage<TestLabels>(grid, [](double x, double y, double) { return std::hypot(x, y) < 12.0 ? 1 : 0; }));
  filter->Update();
  for (const ContourSlice & slice : filter->GetOutput()->GetSlices())
  {
    ASSERT_EQ(slice.contours.size(), 3u);
    const Polygon cavity = PlanePoints(*filter->GetOutput(), slice.contours[2]);
    EXPECT_EQ(slice.contours[2].region, Region::Medullary);
    EXPECT_NEAR(std::sqrt(SignedArea(cavity) / M_PI), 6.0, 0.4);
  }
  filter->SetNumberOfLayers(1);
  filter->Update();
  EXPECT_EQ(filter->GetOutput()->GetNumberOfContours(), 24u);
}

TEST(SnakeContourFilter, IsLazyAndTheSameForAnyNumberOfThreads)
{
  const TestGrid grid;
  auto           one = FromLabel(grid);
  one->RefineLabelOutlineOn();
  one->SetNumberOfWorkUnits(1);
  one->Update();
  const auto time = one->GetOutput()->GetMTime();
  one->Update();
  EXPECT_EQ(one->GetOutput()->GetMTime(), time);
  auto three = FromLabel(grid);
  three->RefineLabelOutlineOn();
  three->SetNumberOfWorkUnits(3);
  three->Update();
  for (std::size_t k = 0; k < one->GetOutput()->GetSlices().size(); ++k)
  {
    const auto & a = one->GetOutput()->GetSlices()[k].contours;
    const auto & b = three->GetOutput()->GetSlices()[k].contours;
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t c = 0; c < a.size(); ++c)
    {
      EXPECT_EQ(a[c].points, b[c].points);
    }
  }
  one->SetNumberOfLayers(2);
  one->Update();
  EXPECT_NE(one->GetOutput()->GetMTime(), time);
}

TEST(SnakeContourFilter, RefusesBadInputInPlainWords)
{
  TestGrid   grid;
  const auto message = [](Filter * filter) { return MessageOf([&] { filter->Update(); }); };
  auto       filter = Filter::New();
  filter->SetInput(MakeImage<TestCT>(grid, BowedTube));
  EXPECT_THAT(message(filter), HasSubstr("'LabelImage' or 'InitialContours'"));
  filter->SetLabelImage(MakeImage<TestLabels>(grid, BowedLabel));
  filter->SetLabel(7);
  EXPECT_THAT(message(filter), HasSubstr("no voxel of label 7"));
  filter->SetLabel(3);
  filter->SetAxis(3);
  EXPECT_THAT(message(filter), HasSubstr("Axis"));
  filter->SetAxis(2);
  filter->SetSliceStep(std::nan(""));
  EXPECT_THAT(message(filter), HasSubstr("SliceStep"));
  filter->SetSliceStep(0.0);
  filter->SetInput(MakeImage<TestCT>(grid, [](double, double, double) { return -1000.0; }));
  EXPECT_THAT(message(filter), HasSubstr("holds no bone"));
  grid.size[2] = 1;
  filter->SetInput(MakeImage<TestCT>(grid, BowedTube));
  EXPECT_THAT(message(filter), HasSubstr("has 1 voxels along axis 2"));
  grid = TestGrid();
  grid.origin.z() = 500.0;
  filter->SetInput(MakeImage<TestCT>(grid, BowedTube));
  EXPECT_THAT(message(filter), HasSubstr("beyond the CT's slices"));
  auto drawn = Filter::New();
  drawn->SetInput(MakeImage<TestCT>(TestGrid(), BowedTube));
  drawn->SetInitialContours(StartContour(*ContourStack::New(), Ellipse(9, 9, 50), -60.0));
  EXPECT_THAT(message(drawn), HasSubstr("beyond the CT's slices"));
  auto upright = ContourStack::New();
  upright->SetFrame({ 0, 1, 0 }, { 0, 0, 1 });
  drawn->SetInitialContours(StartContour(*upright, Ellipse(5, 5, 50), 0.0));
  EXPECT_THAT(message(drawn), HasSubstr("not parallel"));
}

TEST(SnakeContourFilter, TellsHeightsAndEndsAsTheyAreInThePlacement)
{
  struct Case
  {
    Placement    placement;
    const char * height; // of -60 mm
    const char * end;    // of the first slice
  };
  const Eigen::Matrix3d turned = Vector3(1.0, -1.0, -1.0).asDiagonal();
  const Case            cases[] = { { {}, "at -60 mm", "at its first slice" },
                                    { { Eigen::Matrix3d::Identity(), { 1.0, 2.0, 300.0 } }, "at 240 mm", "at its first slice" },
                                    { { turned, { 1.0, 2.0, 300.0 } }, "at 360 mm", "at its last slice" } };
  const auto            ends = [](double x, double y, double z) { return z < 20.0 ? BowedTube(x, y, z) : 50.0; };
  for (const Case & c : cases)
  {
    auto filter = Filter::New();
    filter->SetInput(MakeImage<TestCT>(TestGrid(), ends));
    filter->SetPlacement(c.placement);
    filter->SetInitialContours(StartContour(*ContourStack::New(), Ellipse(9.0, 9.0, 60), -60.0));
    EXPECT_THAT(MessageOf([&] { filter->Update(); }), HasSubstr(c.height));
    filter->SetInitialContours(StartContour(*ContourStack::New(), Ellipse(9.0, 9.0, 60), 7.0));
    filter->Update();
    EXPECT_THAT(filter->GetWarnings(), testing::Contains(HasSubstr(c.end)));
  }
}

TEST(SnakeContourFilter, DoubtsALabelThatLiesBesideTheBone)
{
  const TestGrid grid;
  auto           filter = FromLabel(grid);
  filter->Update();
  EXPECT_GT(filter->GetReport().brighterShare, 0.99);
  EXPECT_THAT(filter->GetReport().doubts, testing::IsEmpty());
  filter->SetLabelImage(
    MakeImage<TestLabels>(grid, [](double x, double y, double z) { return BowedLabel(x - 6.0, y, z); }));
  filter->Update();
  EXPECT_LT(filter->GetReport().brighterShare, 0.65);
  ASSERT_THAT(filter->GetReport().doubts, testing::ElementsAre(HasSubstr("do CT and label map belong together?")));
  EXPECT_THAT(filter->GetWarnings(), testing::Contains(filter->GetReport().doubts.front()));
  // A bone that leaves the image on all sides but one.
  auto cut = FromLabel(grid);
  cut->SetInput(MakeImage<TestCT>(grid, [](double x, double, double) { return x < 12.0 ? 700.0 : 40.0; }));
  cut->SetLabelImage(MakeImage<TestLabels>(grid, [](double x, double, double) { return x < 12.0 ? 3 : 0; }));
  cut->Update();
  EXPECT_GT(cut->GetReport().brighterShare, 0.99);
}

TEST(SnakeContourFilter, DoubtsValuesThatAreNotHU)
{
  const TestGrid grid;
  auto           filter = FromLabel(grid);
  filter->SetInput(MakeImage<TestCT>(grid, [](double x, double y, double z) { return 1024.0 + BowedTube(x, y, z); }));
  filter->Update();
  EXPECT_THAT(filter->GetReport().doubts, testing::ElementsAre(HasSubstr("are its values HU?")));
  filter->SetInput(
    MakeImage<TestCT>(grid, [](double x, double y, double z) { return std::min(255.0, BowedTube(x, y, z)); }));
  filter->Update();
  EXPECT_THAT(filter->GetReport().doubts, testing::ElementsAre(HasSubstr("not a display window's?")));
  // Beside a blurred edge values are those of bone: it is looked beyond.
  filter->SetInput(MakeImage<TestCT>(
    grid, [](double x, double y, double z) { return TubeDensity(x - 0.05 * z, y + 0.02 * z, 9.0, 4.0, 250.0, 1.5); }));
  filter->Update();
  EXPECT_THAT(filter->GetReport().doubts, testing::IsEmpty());
}

TEST(SnakeContourFilter, DoubtsALabelOfTheCortexAlone)
{
  const TestGrid grid;
  const auto     holes = [&](double radius) {
    auto filter = FromLabel(grid);
    filter->SetLabelImage(MakeImage<TestLabels>(grid, [radius](double x, double y, double z) {
      return std::hypot(x - 0.05 * z, y + 0.02 * z) > radius ? BowedLabel(x, y, z) : 0;
    }));
    filter->Update();
    return filter->GetReport().doubts;
  };
  EXPECT_THAT(holes(6.5), testing::Contains(HasSubstr("Holes take 5")));
  EXPECT_THAT(holes(4.0), testing::Not(testing::Contains(HasSubstr("Holes"))));
}

template <typename TPixel>
class SnakeContourFilterTypes : public testing::Test
{
};
using PixelTypes = testing::Types<unsigned char, short, unsigned short, int, float, double>;
TYPED_TEST_SUITE(SnakeContourFilterTypes, PixelTypes);

// Values that every type can hold.
TYPED_TEST(SnakeContourFilterTypes, LabelAndCTOfAnyScalarGiveTheSameContours)
{
  const TestGrid grid;
  const auto     density = [](double x, double y, double z) {
    return std::clamp(std::round(BowedTube(x, y, z) / 4.0), 0.0, 255.0);
  };
  const auto run = [&](auto filter) {
    filter->SetLabel(3);
    filter->SetBoneThreshold(40.0);
    filter->SetMinimumEdgeSlope(10.0);
    filter->SetMedullaryThreshold(10.0);
    filter->Update();
    return filter->GetOutput()->GetSlices();
  };
  auto reference = Filter::New();
  reference->SetInput(MakeImage<TestCT>(grid, density));
  reference->SetLabelImage(MakeImage<TestLabels>(grid, BowedLabel));
  const auto expected = run(reference);
  using Image = itk::Image<TypeParam, 3>;
  auto filter = SnakeContourFilter<Image, Image>::New();
  filter->SetInput(MakeImage<Image>(grid, density));
  filter->SetLabelImage(MakeImage<Image>(grid, BowedLabel));
  const auto found = run(filter);
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t k = 0; k < found.size(); ++k)
  {
    ASSERT_EQ(found[k].contours.size(), expected[k].contours.size());
    for (std::size_t c = 0; c < found[k].contours.size(); ++c)
    {
      EXPECT_EQ(found[k].contours[c].points, expected[k].contours[c].points);
    }
  }
}
} // namespace SnakeContourFilterTests
} // namespace bone
