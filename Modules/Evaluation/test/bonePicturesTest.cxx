/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "bonePictures.h"

#include "boneLabelCrop.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace PicturesTests
{
using namespace bone;

/** 40 x 40 x 30 voxels of 1 x 1 x 2 mm, lowest corner at (-20, -20, 100); grey by its place. */
CTImage::Pointer
WholeCT()
{
  auto image = CTImage::New();
  image->SetRegions(CTImage::SizeType{ { 40, 40, 30 } });
  const double spacing[3] = { 1.0, 1.0, 2.0 };
  const double origin[3] = { -20.0, -20.0, 100.0 };
  image->SetSpacing(spacing);
  image->SetOrigin(origin);
  image->Allocate();
  for (std::size_t k = 0; k < 40 * 40 * 30; ++k)
  {
    image->GetBufferPointer()[k] = static_cast<float>(k % 40);
  }
  return image;
}

/** Squares on `count` slices of WholeCT from its tenth on. */
ContourStack::Pointer
Stack(int count)
{
  ContourStack::SliceContainer slices;
  for (int k = 0; k < count; ++k)
  {
    const double z = 120.0 + 2.0 * k;
    Contour      square;
    square.points = { { -6, -6, z }, { 6, -6, z }, { 6, 6, z }, { -6, 6, z } };
    slices.push_back({ { 0, 0, z }, { square } });
  }
  auto stack = ContourStack::New();
  stack->SetSlices(std::move(slices));
  return stack;
}

bool
IsSame(const PictureImage * a, const PictureImage * b)
{
  const auto size = a->GetLargestPossibleRegion().GetSize();
  return size == b->GetLargestPossibleRegion().GetSize() &&
         std::equal(a->GetBufferPointer(), a->GetBufferPointer() + size[0] * size[1], b->GetBufferPointer());
}

/** Pixels whose channels are each within three of a colour's. */
int
CountOf(const PictureImage * image, const Color & color)
{
  const auto size = image->GetLargestPossibleRegion().GetSize();
  return static_cast<int>(std::count_if(
    image->GetBufferPointer(), image->GetBufferPointer() + size[0] * size[1], [&](const PictureImage::PixelType & p) {
      return std::abs(p[0] - color[0]) < 4 && std::abs(p[1] - color[1]) < 4 && std::abs(p[2] - color[2]) < 4;
    }));
}

TEST(DrawSlices, HasAPanelForEachSliceUpToSix)
{
  const auto   ct = WholeCT();
  const Window window{ 0.0, 40.0 };
  const Color  outline = ContourStyles()[0].color;
  const auto   lines = [&](int slices) {
    return CountOf(DrawSlices(ct, Stack(slices), window, "HU").GetImage(), outline);
  };
  const int one = lines(1);
  const int legend = 2 * one - lines(2); // pixels that are not of a panel
  EXPECT_GT(one - legend, 500);
  for (const int slices : { 3, 5, 6 })
  {
    EXPECT_NEAR(lines(slices) - legend, slices * (one - legend), 0.02 * one) << slices;
  }
  EXPECT_NEAR(lines(17) - legend, 6 * (one - legend), 0.02 * one);
}

TEST(DrawSlices, TitlesTellTheSlicesOfTheWholeCT)
{
  const auto          ct = WholeCT();
  const auto          stack = Stack(3);
  const Window        window{ 0.0, 40.0 };
  CTImage::RegionType region;
  region.SetIndex({ { 5, 5, 7 } });
  region.SetSize({ { 30, 30, 15 } });
  const auto crop = Crop(ct, region);
  const auto expected = DrawSlices(ct, stack, window, "HU").GetImage();
  EXPECT_TRUE(IsSame(DrawSlices(crop, stack, window, "HU", ct).GetImage(), expected));
  EXPECT_FALSE(IsSame(DrawSlices(crop, stack, window, "HU").GetImage(), expected));
}

TEST(DrawSlices, RefusesAStackOfNothing)
{
  EXPECT_THROW(DrawSlices(WholeCT(), ContourStack::New(), {}, "HU"), std::invalid_argument);
}

Comparison
OfLevels(const std::vector<float> & levels, float reference)
{
  const auto panel = [](float value) { return Panel{ 50, 40, std::vector<float>(2000, value) }; };
  Comparison comparison;
  comparison.title = "a plane";
  comparison.reference = panel(reference);
  comparison.window = { 0.0, 100.0 };
  comparison.scale = 10.0;
  for (const float level : levels)
  {
    comparison.levels.push_back({ "level", panel(level) });
  }
  return comparison;
}

TEST(DrawComparison, DifferencesAreRedWhereTheModelIsHigher)
{
  const Color red{ { 103, 0, 31 } }, blue{ { 5, 48, 97 } }, white{ { 247, 247, 247 } };
  const auto  picture = DrawComparison({ OfLevels({ 20.0F, 30.0F, 40.0F, 50.0F }, 30.0F) }).GetImage();
  // Full red twice, as 20 above is as 10 above. Some pixels of texts and bars have these colours too.
  EXPECT_NEAR(CountOf(picture, red), 4000, 350);
  EXPECT_NEAR(CountOf(picture, blue), 2000, 350);
  EXPECT_NEAR(CountOf(picture, white), 2000, 350);
}

TEST(DrawComparison, NothingIsDrawnBesideTheBone)
{
  const Color white{ { 247, 247, 247 } }, nothing{ { 72, 72, 72 } };
  const auto  picture = DrawComparison({ OfLevels({ 0.0F }, 0.0F) }).GetImage();
  EXPECT_NEAR(CountOf(picture, nothing), 2000, 350);
  EXPECT_LT(CountOf(picture, white), 350);
}

TEST(DrawComparison, DrawsTheReferenceOnce)
{
  // White in its window, which levels and differences are not.
  const auto shown = [](std::size_t levels) {
    Comparison comparison = OfLevels(std::vector<float>(levels, 0.0F), 51.0F);
    return CountOf(DrawComparison({ comparison }).GetImage(), { { 130, 130, 130 } });
  };
  EXPECT_NEAR(shown(1), 2000, 350);
  EXPECT_NEAR(shown(3), 2000, 350);
  EXPECT_NEAR(shown(6), 2000, 350);
  // Four levels a row, then another row.
  const auto size = [](std::size_t levels) {
    const Canvas canvas = DrawComparison({ OfLevels(std::vector<float>(levels, 0.0F), 51.0F) });
    return Vector2(canvas.GetWidth(), canvas.GetHeight());
  };
  EXPECT_GT(size(4).x(), size(3).x());
  EXPECT_EQ(size(5).x(), size(4).x());
  EXPECT_GT(size(5).y(), 1.6 * size(4).y());
}
} // namespace PicturesTests
