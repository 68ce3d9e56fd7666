/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneImageGradient.h"

#include <gtest/gtest.h>

#include <cmath>

namespace ImageGradientTests
{
TEST(ImageGradient, IsExactForLinearImagesAndNothingAtTheBorder)
{
  constexpr int             columns = 20, rows = 16;
  const bone::ImageGradient gradient(columns, rows, 1.0);
  std::vector<float>        image, x(columns * rows), y(columns * rows);
  for (int r = 0; r < rows; ++r)
  {
    for (int c = 0; c < columns; ++c)
    {
      image.push_back(3.0f * static_cast<float>(c) - 2.0f * static_cast<float>(r));
    }
  }
  gradient.Apply(image.data(), x.data(), y.data());
  const int radius = gradient.Radius();
  EXPECT_EQ(radius, 3);
  for (int r = 0; r < rows; ++r)
  {
    for (int c = 0; c < columns; ++c)
    {
      const bool inside = c >= radius && r >= radius && c < columns - radius && r < rows - radius;
      EXPECT_NEAR(x[r * columns + c], inside ? 3.0f : 0.0f, 1e-4f);
      EXPECT_NEAR(y[r * columns + c], inside ? -2.0f : 0.0f, 1e-4f);
    }
  }
}

TEST(ImageGradient, OfABoxIsAsOfTheWholeImage)
{
  constexpr int             columns = 20, rows = 16;
  const bone::ImageGradient gradient(columns, rows, 1.0);
  std::vector<float>        image, x(columns * rows), y(columns * rows);
  for (int i = 0; i < columns * rows; ++i)
  {
    image.push_back(static_cast<float>(std::sin(0.7 * i) + 0.01 * i * i));
  }
  gradient.Apply(image.data(), x.data(), y.data());
  for (const bone::PixelBox & box : { bone::PixelBox{ { 6, 4 }, { 11, 9 } },
                                      bone::PixelBox{ { 0, 0 }, { 5, 16 } },
                                      bone::PixelBox{ { 18, 14 }, { 20, 16 } } })
  {
    ASSERT_EQ(box.GetNumberOfPixels(), static_cast<std::size_t>(box.Columns() * box.Rows()));
    std::vector<float> inX(box.GetNumberOfPixels(), 9.0f), inY(inX);
    gradient.Apply(image.data(), box, inX.data(), inY.data());
    for (int i = 0; i < box.Columns() * box.Rows(); ++i)
    {
      const int at = (box.first[1] + i / box.Columns()) * columns + box.first[0] + i % box.Columns();
      EXPECT_EQ(inX[i], x[at]);
      EXPECT_EQ(inY[i], y[at]);
    }
  }
}

TEST(ImageGradient, OfAWaveIsDampedAsByAGaussian)
{
  constexpr int             columns = 64, rows = 16;
  const bone::ImageGradient gradient(columns, rows, 2.0);
  const double              frequency = 0.3;
  std::vector<float>        image, x(columns * rows), y(columns * rows);
  for (int i = 0; i < columns * rows; ++i)
  {
    image.push_back(static_cast<float>(std::sin(frequency * (i % columns))));
  }
  gradient.Apply(image.data(), x.data(), y.data());
  const double damping = std::exp(-0.5 * std::pow(2.0 * frequency, 2));
  for (int c = 10; c < columns - 10; ++c)
  {
    EXPECT_NEAR(x[8 * columns + c], damping * frequency * std::cos(frequency * c), 0.03 * frequency);
  }
}
} // namespace ImageGradientTests
