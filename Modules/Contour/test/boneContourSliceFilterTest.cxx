/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneContourSliceFilter.h"

#include "boneContourTestTools.h"
#include "boneSliceSelection.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace bone
{
namespace ContourSliceFilterTests
{
using testing::HasSubstr;

ContourSlice
SliceOf(const ContourStack & frame, double height, const std::vector<Polygon> & polygons)
{
  ContourSlice slice;
  slice.origin = { 0.0, 0.0, height };
  for (std::size_t c = 0; c < polygons.size(); ++c)
  {
    Contour contour;
    contour.id = static_cast<int>(c);
    for (const Vector2 & q : polygons[c])
    {
      contour.points.push_back(frame.FromPlane(q, height));
    }
    slice.contours.push_back(contour);
  }
  return slice;
}

/** A cylinder of 40 slices 1 mm apart whose radius falls from 20 to 12 mm between heights 20 and 23. */
ContourStack::Pointer
Shoulder(int empty = 0)
{
  auto                         stack = ContourStack::New();
  ContourStack::SliceContainer slices;
  for (int k = 0; k < 40; ++k)
  {
    const double r = k <= 20 ? 20.0 : k >= 23 ? 12.0 : 20.0 - 8.0 * (k - 20) * (k - 20) / 9.0;
    slices.push_back(SliceOf(
      *stack, k, k < empty || k >= 40 - empty ? std::vector<Polygon>() : std::vector<Polygon>{ Ellipse(r, r, 90) }));
  }
  stack->SetSlices(slices);
  return stack;
}

std::vector<double>
HeightsOf(const ContourStack & stack)
{
  std::vector<double> heights;
  for (std::size_t k = 0; k < stack.GetSlices().size(); ++k)
  {
    heights.push_back(stack.GetHeight(k));
  }
  return heights;
}

TEST(ContourSliceFilter, KeepsAllByDefault)
{
  auto filter = ContourSliceFilter::New();
  filter->SetInput(Shoulder());
  filter->Update();
  EXPECT_EQ(filter->GetOutput()->GetSlices().size(), 40U);
  EXPECT_EQ(filter->GetMisplacedVolume(), 0.0);
}

TEST(ContourSliceFilter, SlicesGatherWhereSectionsChange)
{
  auto filter = ContourSliceFilter::New();
  filter->SetInput(Shoulder());
  filter->SetMeanSpacing(5.0);
  filter->Update();
  const auto heights = HeightsOf(*filter->GetOutput());
  EXPECT_EQ(heights.size(), 9U);
  EXPECT_EQ(heights.front(), 0.0);
  EXPECT_EQ(heights.back(), 39.0);
  for (const double shoulder : { 20.0, 21.0, 22.0, 23.0 })
  {
    EXPECT_THAT(heights, testing::Contains(shoulder));
  }
  for (std::size_t k = 1; k < heights.size(); ++k)
  {
    EXPECT_LE(heights[k] - heights[k - 1], 1.75 * 5.0);
  }
  // All that is between the slices kept is known from them.
  EXPECT_LT(filter->GetMisplacedVolume(), 20.0);
}

TEST(ContourSliceFilter, ChoosesBetterThanEvenSpacing)
{
  // The volume misplaced by the chosen slices is no more than by any even choice of as many.
  auto         stack = Shoulder();
  const double best = SelectSlices(*stack, 9, 9.0, Execution()).volume;
  for (const double gap : { 5.0, 6.0, 7.0 })
  {
    // A smaller gap leaves fewer choices.
    EXPECT_LE(best, SelectSlices(*stack, 9, gap, Execution()).volume);
  }
  // More slices never misplace more.
  EXPECT_LE(SelectSlices(*stack, 12, 9.0, Execution()).volume, best);
  EXPECT_EQ(SelectSlices(*stack, 40, 9.0, Execution()).volume, 0.0);
}

TEST(ContourSliceFilter, GapsComeBeforeTheNumberOfSlices)
{
  EXPECT_EQ(SelectSlices(*Shoulder(), 2, 13.0, Execution()).slices, (std::vector<std::size_t>{ 0, 13, 26, 39 }));
}

TEST(ContourSliceFilter, LeavesOutSlicesBeyondTheBone)
{
  auto filter = ContourSliceFilter::New();
  filter->SetInput(Shoulder(3));
  filter->SetMeanSpacing(4.0);
  filter->Update();
  const auto heights = HeightsOf(*filter->GetOutput());
  EXPECT_EQ(heights.front(), 3.0);
  EXPECT_EQ(heights.back(), 36.0);
}

TEST(ContourSliceFilter, SaysWhatIsWrong)
{
  auto filter = ContourSliceFilter::New();
  filter->SetInput(Shoulder());
  const auto message = [&filter] {
    try
    {
      filter->Update();
    }
    catch (const itk::ExceptionObject & error)
    {
      return std::string(error.GetDescription());
    }
    return std::string();
  };
  filter->SetMeanSpacing(-1.0);
  EXPECT_THAT(message(), HasSubstr("MeanSpacing"));
  filter->SetMeanSpacing(4.0);
  filter->SetMaximumGap(0.5);
  EXPECT_THAT(message(), HasSubstr("MaximumGap"));
}
} // namespace ContourSliceFilterTests
} // namespace bone
