/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneFigure.h"

#include "bonePictureTestTools.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace FigureTests
{
using namespace bone;

PanelCell
Cell(int columns, int rows, float value)
{
  PanelCell cell;
  cell.panel = { columns, rows, std::vector<float>(static_cast<std::size_t>(columns) * rows, value) };
  return cell;
}

Canvas
Draw(const PanelCell & cell)
{
  return DrawFigure({ { { "", { { cell } } } }, {}, "" });
}

/** Longest run of dark pixels in a row of the image below `top`. */
int
LongestDarkRun(const PictureImage * image, long top)
{
  const auto size = image->GetLargestPossibleRegion().GetSize();
  int        longest = 0;
  for (long r = top; r < static_cast<long>(size[1]); ++r)
  {
    int run = 0;
    for (long c = 0; c < static_cast<long>(size[0]); ++c)
    {
      run = PixelOf(image, c, r)[0] < 60 ? run + 1 : 0;
      longest = std::max(longest, run);
    }
  }
  return longest;
}

TEST(Figure, ScaleBarIsAsLongAsItSays)
{
  for (const double pixel : { 0.3, 0.5, 1.7 })
  {
    PanelCell cell = Cell(200, 50, 1.0F);
    cell.style.pixelSize = Vector2::Constant(pixel);
    const double length = ScaleBarLength(cell.panel, cell.style);
    EXPECT_LE(length, 0.4 * 200 * pixel);
    EXPECT_GT(length, 0.4 * 200 * pixel / 2.6);
    EXPECT_NEAR(LongestDarkRun(Draw(cell).GetImage(), 70), length / pixel, 1.0) << pixel;
    cell.style.zoom = 2.0;
    EXPECT_NEAR(LongestDarkRun(Draw(cell).GetImage(), 120), 2.0 * length / pixel, 1.0) << pixel;
  }
  EXPECT_EQ(ScaleBarLength(Cell(200, 50, 1.0F).panel, PanelStyle()), 0.0);
}

TEST(Figure, VoxelsThatAreNotSquareHaveTheirTrueAspect)
{
  PanelCell cell = Cell(60, 20, 1.0F);
  cell.style.pixelSize = { 0.5, 2.0 };
  EXPECT_EQ(ShownSize(cell.panel, cell.style), Vector2(60.0, 80.0));
  EXPECT_EQ(CountColor(Draw(cell).GetImage(), { { 255, 255, 255 } }) > 60 * 80, true);
  Rectangle seen;
  cell.overlay = [&seen](Canvas &, const Rectangle & place) { seen = place; };
  Draw(cell);
  EXPECT_EQ(seen.width, 60.0);
  EXPECT_EQ(seen.height, 80.0);
  // The bar is measured along the columns.
  EXPECT_NEAR(LongestDarkRun(Draw(cell).GetImage(), 95), ScaleBarLength(cell.panel, cell.style) / 0.5, 1.0);
}

TEST(PanelPoint, WholePixelsAreCentres)
{
  const Panel     panel = Cell(3, 2, 0.0F).panel;
  const Rectangle place{ 10.0, 20.0, 30.0, 40.0 };
  EXPECT_EQ(PanelPoint(place, panel, { 0.0, 0.0 }), Vector2(15.0, 30.0));
  EXPECT_EQ(PanelPoint(place, panel, { -0.5, -0.5 }), Vector2(10.0, 20.0));
  EXPECT_EQ(PanelPoint(place, panel, { 2.5, 1.5 }), Vector2(40.0, 60.0));
}

TEST(Figure, LettersStandAtTheirSides)
{
  PanelCell cell = Cell(100, 80, 0.0F);
  cell.style.window = { 0.0, 1.0 };
  const Rectangle place{ 12.0, 12.0, 100.0, 80.0 };
  const auto      bright = [&](const SideLetters & letters) {
    cell.style.letters = letters;
    const auto image = Draw(cell).GetImage();
    double     count = 0.0;
    Vector2    sum = Vector2::Zero();
    for (long r = 12; r < 92; ++r)
    {
      for (long c = 12; c < 112; ++c)
      {
        const double weight = PixelOf(image, c, r)[0] / 255.0;
        count += weight;
        sum += weight * Vector2(c + 0.5, r + 0.5);
      }
    }
    return Vector2(count > 0.0 ? Vector2(sum / count) : Vector2::Zero());
  };
  EXPECT_EQ(bright({}), Vector2::Zero());
  const Vector2 middle(place.x + 50.0, place.y + 40.0);
  const Vector2 left = bright({ "H", "", "", "" }), right = bright({ "", "H", "", "" });
  const Vector2 top = bright({ "", "", "H", "" }), bottom = bright({ "", "", "", "H" });
  EXPECT_LT(left.x(), place.x + 20.0);
  EXPECT_NEAR(left.y(), middle.y(), 1.0);
  EXPECT_GT(right.x(), place.x + 80.0);
  EXPECT_NEAR(right.y(), middle.y(), 1.0);
  EXPECT_LT(top.y(), place.y + 20.0);
  EXPECT_NEAR(top.x(), middle.x(), 1.0);
  EXPECT_GT(bottom.y(), place.y + 60.0);
  EXPECT_NEAR(bottom.x(), middle.x(), 1.0);
}

TEST(Figure, HasRoomForAllItsTexts)
{
  PanelCell  cell = Cell(20, 20, 1.0F);
  const auto narrow = Draw(cell).GetWidth();
  cell.style.title = "a title much wider than twenty pixels";
  EXPECT_GT(Draw(cell).GetWidth(), narrow + 100.0);
  cell.style.title.clear();
  cell.style.colorBar = true;
  EXPECT_GT(Draw(cell).GetWidth(), narrow + 100.0);
  Figure figure{ { { "", { { Cell(20, 20, 1.0F) } } } }, { ContourStyles().begin(), ContourStyles().end() }, "" };
  EXPECT_GT(DrawFigure(figure).GetWidth(), 350.0);
  const auto image = DrawFigure(figure).GetImage();
  for (const ContourStyle & style : ContourStyles())
  {
    EXPECT_GT(CountColor(image, style.color), 10) << style.name;
  }
}

TEST(Figure, ColorBarHasTheColoursOfItsMap)
{
  PanelCell cell = Cell(160, 20, 0.0F);
  cell.style.map = ColorMap::Diverging;
  cell.style.window = { -1.0, 1.0 };
  EXPECT_EQ(CountColor(Draw(cell).GetImage(), { { 103, 0, 31 } }, 12), 0);
  cell.style.colorBar = true;
  const auto image = Draw(cell).GetImage();
  EXPECT_GT(CountColor(image, { { 103, 0, 31 } }, 12), 10);
  EXPECT_GT(CountColor(image, { { 5, 48, 97 } }, 12), 10);
  cell.style.map = ColorMap::Sequential;
  EXPECT_GT(CountColor(Draw(cell).GetImage(), { { 253, 231, 37 } }, 12), 10);
}

TEST(Figure, AnEmptyPlaceKeepsItsColumn)
{
  std::vector<Rectangle> places;
  PanelCell              cell = Cell(50, 30, 0.0F);
  cell.overlay = [&places](Canvas &, const Rectangle & place) { places.push_back(place); };
  DrawFigure({ { { "", { { cell, cell }, { PanelCell(), cell } } } }, {}, "" });
  ASSERT_EQ(places.size(), 3U);
  EXPECT_EQ(places[2].x, places[1].x);
  EXPECT_GT(places[2].y, places[1].y + 30.0);
}
} // namespace FigureTests
