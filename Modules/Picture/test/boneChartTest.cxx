/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneChart.h"

#include "bonePictureTestTools.h"
#include "boneTicks.h"

#include <gtest/gtest.h>
#include <gmock/gmock.h>

#include <cmath>

namespace ChartTests
{
using namespace bone;
using ::testing::DoubleEq;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

/** Mean place of the pixels of a color. */
Vector2
CentreOfColor(const PictureImage * image, const Color & color)
{
  const auto size = image->GetLargestPossibleRegion().GetSize();
  Vector2    sum = Vector2::Zero();
  int        count = 0;
  for (long r = 0; r < static_cast<long>(size[1]); ++r)
  {
    for (long c = 0; c < static_cast<long>(size[0]); ++c)
    {
      if (PixelOf(image, c, r) == color)
      {
        sum += Vector2(c + 0.5, r + 0.5);
        ++count;
      }
    }
  }
  return sum / count;
}

Chart
ChartOf(const std::vector<Vector2> & points, bool log)
{
  Chart chart;
  chart.x = { "", false, false, 0.0, 4.0 };
  chart.y = { "", log, false, log ? 1.0 : 0.0, log ? 100.0 : 10.0 };
  chart.series = { { "", points, false, true } };
  return chart;
}

TEST(Ticks, AreMultiplesOfOneTwoAndFive)
{
  EXPECT_THAT(LinearTicks(0.0, 10.0, 6), ElementsAre(0.0, 2.0, 4.0, 6.0, 8.0, 10.0));
  EXPECT_THAT(LinearTicks(-0.3, 0.3, 8),
              ElementsAre(DoubleEq(-0.3), DoubleEq(-0.2), -0.1, 0.0, 0.1, DoubleEq(0.2), DoubleEq(0.3)));
  EXPECT_THAT(LinearTicks(3.0, 21.0, 5), ElementsAre(5.0, 10.0, 15.0, 20.0));
  EXPECT_THAT(LinearTicks(1.0, 1.0, 5), IsEmpty());
  EXPECT_THAT(LinearTicks(0.0, std::nan(""), 5), IsEmpty());
  for (int most = 2; most < 12; ++most)
  {
    EXPECT_LE(LinearTicks(-7.3, 113.0, most).size(), static_cast<std::size_t>(most));
  }
}

TEST(Ticks, OfLogarithmicAxesArePowers)
{
  EXPECT_THAT(LogTicks(1.0, 100.0, 8), ElementsAre(1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0));
  EXPECT_THAT(LogTicks(1.0, 1e4, 8), ElementsAre(1.0, 10.0, 100.0, 1000.0, 10000.0));
  EXPECT_THAT(LogTicks(3.0, 7.0, 8), ElementsAre(5.0));
  EXPECT_LE(LogTicks(1e-12, 1e12, 8).size(), 8U);
  EXPECT_THAT(LogTicks(0.0, 7.0, 8), IsEmpty());
}

TEST(Ticks, LengthsAreOneTwoAndFive)
{
  EXPECT_DOUBLE_EQ(NiceLength(79.0), 50.0);
  EXPECT_DOUBLE_EQ(NiceLength(50.0), 50.0);
  EXPECT_DOUBLE_EQ(NiceLength(0.0499), 0.02);
  EXPECT_DOUBLE_EQ(NiceLength(1000.0), 1000.0);
  EXPECT_EQ(NiceLength(-1.0), 0.0);
  EXPECT_DOUBLE_EQ(NiceStep(51.0), 100.0);
  EXPECT_DOUBLE_EQ(NiceStep(0.2), 0.2);
  EXPECT_EQ(TickText(0.05), "0.05");
  EXPECT_EQ(TickText(-120.0), "-120");
  EXPECT_EQ(TickText(50000.0), "50000");
  EXPECT_EQ(TickText(100.0 / 3.0), "33.33");
  EXPECT_THAT(TickTexts({ 10000.25, 10000.5 }), ElementsAre("10000.25", "10000.5"));
  EXPECT_DOUBLE_EQ(RoundInRange(1717.3, 2000.0), 1720.0);
}

TEST(Chart, MarkersLieWhereTheAxesSay)
{
  const auto at = [](const Vector2 & p, bool log) {
    return CentreOfColor(DrawChart(ChartOf({ p }, log)).GetImage(), SeriesColor(0));
  };
  for (const bool log : { false, true })
  {
    const Vector2 low = at({ 1.0, log ? 2.0 : 2.0 }, log), high = at({ 3.0, log ? 50.0 : 8.0 }, log);
    const Vector2 middle = at({ 2.0, log ? 10.0 : 5.0 }, log);
    EXPECT_GT(high.x(), low.x() + 100.0);
    EXPECT_LT(high.y(), low.y() - 80.0);
    EXPECT_NEAR(middle.x(), 0.5 * (low.x() + high.x()), 1.0);
    EXPECT_NEAR(middle.y(), 0.5 * (low.y() + high.y()), 1.0);
  }
}

TEST(Chart, LeavesOutWhatItsAxesHaveNoPlaceFor)
{
  const auto drawn = [](const std::vector<Vector2> & points, bool log) {
    return CountColor(DrawChart(ChartOf(points, log)).GetImage(), SeriesColor(0));
  };
  EXPECT_EQ(drawn({ { 1.0, -3.0 } }, true), 0);
  EXPECT_EQ(drawn({ { 1.0, std::nan("") } }, false), 0);
  EXPECT_EQ(drawn({ { 9.0, 3.0 } }, false), 0); // right of the axis' end
  EXPECT_GT(drawn({ { 1.0, 3.0 } }, true), 20);
}

TEST(Chart, IsDrawnOfNothingAndOfOnePoint)
{
  EXPECT_NO_THROW(DrawChart({}).GetPng());
  EXPECT_NO_THROW(DrawHistogram({}).GetPng());
  Chart chart;
  chart.series = { { "one", { { 0.0, 0.0 } } } };
  EXPECT_NO_THROW(DrawChart(chart).GetPng());
  chart.y.log = chart.x.log = true;
  EXPECT_NO_THROW(DrawChart(chart).GetPng());
}

TEST(Histogram, CountsEveryValueOnce)
{
  Histogram histogram;
  histogram.bins = 10;
  histogram.values = { 0.0, 0.05, 0.1, 0.55, 0.95, 1.0, std::nan(""), INFINITY };
  const auto bins = CountBins(histogram);
  ASSERT_EQ(bins.edges.size(), 6U); // ten bins of 0.1 and the last end would be eleven
  EXPECT_DOUBLE_EQ(bins.edges[1], 0.2);
  EXPECT_THAT(bins.counts, ElementsAre(3U, 0U, 1U, 0U, 2U));
  histogram.x.upper = 0.5;
  EXPECT_THAT(CountBins(histogram).counts, ElementsAre(1U, 0U, 1U, 0U, 1U));
  histogram.values = { 5.0, 5.0 };
  histogram.x.upper.reset();
  EXPECT_THAT(CountBins(histogram).counts, ::testing::Contains(2U));
  histogram.values.clear();
  EXPECT_THAT(CountBins(histogram).counts, IsEmpty());
}

TEST(Histogram, BarsAreAsHighAsTheirCounts)
{
  Histogram histogram;
  histogram.bins = 3;
  histogram.y = { "", false, false, 0.0, 10.0 };
  histogram.values = { 0.5, 0.5, 0.5, 0.5, 0.5, 2.5, 2.5, 2.5, 2.5, 2.5, 2.5, 2.5, 2.5, 2.5, 2.5 };
  const auto image = DrawHistogram(histogram).GetImage();
  const auto size = image->GetLargestPossibleRegion().GetSize();
  const auto column = [&](long c) {
    int count = 0;
    for (long r = 0; r < static_cast<long>(size[1]); ++r)
    {
      count += PixelOf(image, c, r) == SeriesColor(0) ? 1 : 0;
    }
    return count;
  };
  int highest = 0, lowest = 10000;
  for (long c = 0; c < static_cast<long>(size[0]); ++c)
  {
    highest = std::max(highest, column(c));
    lowest = column(c) > 0 ? std::min(lowest, column(c)) : lowest;
  }
  EXPECT_GT(highest, 100);
  EXPECT_NEAR(2.0 * lowest, highest, 2.0);
}
} // namespace ChartTests
