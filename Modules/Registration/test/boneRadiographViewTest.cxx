/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneRadiographView.h"

#include <gtest/gtest.h>

namespace RadiographViewTests
{
using namespace bone;

/** Values that are column + 10 * row. */
RadiographView
Ramp(int columns, int rows)
{
  RadiographView view;
  view.view.size = { { columns, rows } };
  view.view.spacing = { 0.5, 2.0 };
  view.view.detectorOrigin = Vector3(1, 2, 3);
  for (int r = 0; r < rows; ++r)
  {
    for (int c = 0; c < columns; ++c)
    {
      view.values.push_back(static_cast<float>(c + 10 * r));
    }
  }
  return view;
}

TEST(RadiographView, ReducedPixelsAreMeansAndLieInTheMiddle)
{
  const RadiographView reduced = ReduceView(Ramp(7, 4), 2);
  EXPECT_EQ(reduced.view.size, (std::array<int, 2>{ { 3, 2 } }));
  EXPECT_FLOAT_EQ(reduced.values[0], 5.5f);
  EXPECT_FLOAT_EQ(reduced.values[5], 4.5f + 25.0f);
  // Pixel (0, 0) is the mean of four whose centres lie about half a pixel on; U is x and V is -z.
  EXPECT_TRUE(reduced.view.detectorOrigin.isApprox(Vector3(1.25, 2, 2), 1e-12));
  EXPECT_TRUE(reduced.view.spacing.isApprox(Vector2(1.0, 4.0), 1e-12));
}

TEST(RadiographView, PixelsWithoutWeightDoNotCount)
{
  RadiographView view = Ramp(4, 2);
  view.weights.assign(8, 1.0f);
  view.weights[0] = 0.0f;
  view.values[0] = std::numeric_limits<float>::quiet_NaN();
  const RadiographView reduced = ReduceView(view, 2);
  EXPECT_FLOAT_EQ(reduced.values[0], (1.0f + 10.0f + 11.0f) / 3.0f);
  EXPECT_FLOAT_EQ(reduced.weights[0], 0.75f);
  EXPECT_FLOAT_EQ(reduced.weights[1], 1.0f);
}

TEST(RadiographView, ReductionComesNearestToTheSizeAskedFor)
{
  EXPECT_EQ(ReductionTo(Ramp(256, 100).view, 64), 4);
  EXPECT_EQ(ReductionTo(Ramp(100, 200).view, 64), 3);
  EXPECT_EQ(ReductionTo(Ramp(40, 30).view, 64), 1);
}
} // namespace RadiographViewTests
