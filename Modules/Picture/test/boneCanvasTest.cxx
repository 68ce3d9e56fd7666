/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCanvas.h"

#include "bonePictureTestTools.h"
#include "boneSvgIds.h"
#include "boneUtf8.h"

#include <vtkSmartPointer.h>
#include <vtkXMLDataElement.h>
#include <vtkXMLUtilities.h>

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>

namespace CanvasTests
{
using namespace bone;
namespace fs = std::filesystem;

Canvas
SomePicture()
{
  Canvas canvas(120.0, 60.0);
  canvas.DrawPanel({ 10.0, 10.0, 40.0, 40.0 }, Panel{ 2, 2, { 0.0F, 1.0F, 2.0F, 3.0F } }, { 0.0, 3.0 });
  canvas.DrawLine({ 60.0, 10.0 }, { 110.0, 50.0 }, { { 200, 0, 0 } });
  canvas.FillPolygon({ { 70.0, 40.0 }, { 80.0, 40.0 }, { 75.0, 50.0 } }, { { 0, 0, 200 } });
  canvas.DrawText({ 60.0, 20.0 }, "a < b & \"c\" \u00B0", { 10.0 });
  return canvas;
}

int
BigEndian(const std::string & bytes, std::size_t at)
{
  int value = 0;
  for (std::size_t k = at; k < at + 4; ++k)
  {
    value = value * 256 + static_cast<unsigned char>(bytes[k]);
  }
  return value;
}

std::vector<std::string>
Ids(const std::string & svg, const std::string & before, char after)
{
  std::vector<std::string> ids;
  for (std::size_t at = svg.find(before); at != std::string::npos; at = svg.find(before, at + 1))
  {
    const std::size_t begin = at + before.size();
    ids.push_back(svg.substr(begin, svg.find(after, begin) - begin));
  }
  return ids;
}

TEST(Canvas, DrawsAPanelThroughItsWindow)
{
  const Panel panel{ 4, 1, { 0.0F, 10.0F, std::nanf(""), 30.0F } };
  Canvas      canvas(4.0, 1.0, { { 9, 9, 9 } });
  canvas.DrawPanel(0.0, 0.0, panel, { 0.0, 20.0 });
  const auto image = canvas.GetImage();
  EXPECT_EQ(PixelOf(image, 0, 0), (Color{ { 0, 0, 0 } }));
  EXPECT_EQ(PixelOf(image, 1, 0), (Color{ { 128, 128, 128 } }));
  EXPECT_EQ(PixelOf(image, 2, 0), (Color{ { 9, 9, 9 } })); // nothing there
  EXPECT_EQ(PixelOf(image, 3, 0), (Color{ { 255, 255, 255 } }));
}

TEST(Canvas, DrawsDifferencesBlueBelowAndRedAboveZero)
{
  const Panel panel{ 3, 1, { -5.0F, 0.0F, 5.0F } };
  Canvas      canvas(3.0, 1.0);
  canvas.DrawPanel(0.0, 0.0, panel, { -5.0, 5.0 }, ColorMap::Diverging);
  const auto image = canvas.GetImage();
  EXPECT_EQ(PixelOf(image, 0, 0), (Color{ { 5, 48, 97 } }));
  EXPECT_EQ(PixelOf(image, 1, 0), (Color{ { 247, 247, 247 } }));
  EXPECT_EQ(PixelOf(image, 2, 0), (Color{ { 103, 0, 31 } }));
}

TEST(Canvas, FillsThePlaceOfAPanelAndNoMore)
{
  Canvas canvas(50.0, 40.0, { { 9, 9, 9 } });
  canvas.DrawPanel({ 10.0, 5.0, 30.0, 20.0 }, Panel{ 3, 1, { 1.0F, 1.0F, 1.0F } }, { 0.0, 1.0 });
  const auto image = canvas.GetImage();
  EXPECT_EQ(CountColor(image, { { 255, 255, 255 } }), 30 * 20);
  EXPECT_EQ(PixelOf(image, 10, 5), (Color{ { 255, 255, 255 } }));
  EXPECT_EQ(PixelOf(image, 9, 5), (Color{ { 9, 9, 9 } }));
  EXPECT_EQ(PixelOf(image, 39, 24), (Color{ { 255, 255, 255 } }));
  EXPECT_EQ(PixelOf(image, 39, 25), (Color{ { 9, 9, 9 } }));
}

TEST(Canvas, DrawsLinesPolygonsAndText)
{
  Canvas canvas(40.0, 40.0);
  canvas.DrawLine({ 0.0, 10.0 }, { 40.0, 10.0 }, { { 255, 0, 0 } }, 4.0);
  canvas.FillPolygon({ { 5.0, 20.0 }, { 15.0, 20.0 }, { 15.0, 30.0 }, { 5.0, 30.0 } }, { { 0, 0, 255 } });
  const auto before = canvas.GetImage();
  EXPECT_EQ(CountColor(before, { { 255, 0, 0 } }), 40 * 4);
  EXPECT_EQ(CountColor(before, { { 0, 0, 255 } }), 100);
  canvas.DrawText({ 39.0, 38.0 }, "H", { 16.0, { { 0, 255, 0 } }, TextAlign::Right });
  const auto after = canvas.GetImage();
  int        green = 0;
  for (long r = 26; r < 39; ++r) // 0.729 x 16 pixels high
  {
    for (long c = 26; c < 40; ++c)
    {
      green += PixelOf(after, c, r)[0] < 100 ? 1 : 0;
    }
  }
  EXPECT_GT(green, 25); // two strokes and a bar
}

TEST(Canvas, MeasuresTextOfAllAlphabets)
{
  const double one = Canvas::MeasureText("m", { 10.0 });
  EXPECT_GT(one, 5.0);
  EXPECT_NEAR(Canvas::MeasureText("mmmm", { 10.0 }), 4.0 * one, 1e-6);
  EXPECT_NEAR(Canvas::MeasureText("m", { 30.0 }), 3.0 * one, 1e-6);
  EXPECT_GT(Canvas::MeasureText("H\u00FCfte", { 10.0 }), 0.0);
  EXPECT_NEAR(Canvas::MeasureText("\xFF", { 10.0 }), Canvas::MeasureText("?", { 10.0 }), 1e-6);
}

TEST(Utf8, ReplacesWhatIsNone)
{
  EXPECT_EQ(ToValidUtf8("a\u00FC\u2212\U0001F9B4"), "a\u00FC\u2212\U0001F9B4");
  EXPECT_EQ(ToValidUtf8("a\nb\x7F"), "a b ");
  EXPECT_EQ(ToValidUtf8("\xFF\x80g"), "??g");
  EXPECT_EQ(ToValidUtf8("\xC3"), "?");                // cut off
  EXPECT_EQ(ToValidUtf8("\xC0\xAF"), "??");           // longer than it need be
  EXPECT_EQ(ToValidUtf8("\xED\xA0\x80"), "???");      // a surrogate
  EXPECT_EQ(ToValidUtf8("\xF5\x80\x80\x80"), "????"); // above the last character
}

TEST(Canvas, PngHasItsSignatureAndSizeAtAScale)
{
  const Canvas canvas = SomePicture();
  for (const double scale : { 1.0, 2.5 })
  {
    const std::string png = canvas.GetPng(scale);
    EXPECT_EQ(png.substr(0, 8), "\x89PNG\r\n\x1A\n");
    EXPECT_EQ(BigEndian(png, 16), 120 * scale);
    EXPECT_EQ(BigEndian(png, 20), 60 * scale);
    const auto size = canvas.GetImage(scale)->GetLargestPossibleRegion().GetSize();
    EXPECT_EQ(size[0], 120 * scale);
    EXPECT_EQ(size[1], 60 * scale);
  }
  // A pixel of the panel at twice the size.
  EXPECT_EQ(PixelOf(canvas.GetImage(2.0), 22, 22), (Color{ { 0, 0, 0 } }));
  EXPECT_EQ(PixelOf(canvas.GetImage(2.0), 98, 98), (Color{ { 255, 255, 255 } }));
}

TEST(Canvas, SvgIsWellFormedAndRefersToItself)
{
  const std::string svg = SomePicture().GetSvg("P7");
  const auto root = vtkSmartPointer<vtkXMLDataElement>::Take(vtkXMLUtilities::ReadElementFromString(svg.c_str()));
  ASSERT_NE(root, nullptr);
  EXPECT_STREQ(root->GetName(), "svg");
  EXPECT_STREQ(root->GetAttribute("width"), "120px");
  EXPECT_STREQ(root->GetAttribute("height"), "60px");
  const auto                  ids = Ids(svg, " id=\"", '"');
  const std::set<std::string> distinct(ids.begin(), ids.end());
  EXPECT_FALSE(ids.empty());
  EXPECT_EQ(ids.size(), distinct.size());
  for (const std::string & id : ids)
  {
    EXPECT_EQ(id.substr(0, 3), "P7-");
  }
  auto references = Ids(svg, "href=\"#", '"');
  for (const std::string & id : Ids(svg, "url(#", ')'))
  {
    references.push_back(id);
  }
  EXPECT_FALSE(references.empty());
  for (const std::string & id : references)
  {
    EXPECT_EQ(distinct.count(id), 1) << id;
  }
}

TEST(Canvas, SvgOfTheSamePictureIsTheSame)
{
  const Canvas canvas = SomePicture();
  const auto   svg = canvas.GetSvg();
  EXPECT_EQ(canvas.GetSvg(), svg);
  EXPECT_EQ(SomePicture().GetSvg(), svg);
}

TEST(SvgIds, AreRenamedWhereverTheyStand)
{
  EXPECT_EQ(RenameSvgIds(R"x(<g id="a9"><use xlink:href="#a9"/><p c="url(#b)" d="a9"/><g id="b"/></g>)x", "p"),
            R"x(<g id="p-1"><use xlink:href="#p-1"/><p c="url(#p-2)" d="a9"/><g id="p-2"/></g>)x");
}

TEST(Canvas, WritesFilesByTheirExtension)
{
  const Canvas canvas = SomePicture();
  const auto   folder = fs::temp_directory_path() / "boneCanvasTest";
  fs::remove_all(folder);
  fs::create_directories(folder);
  const std::pair<std::string, std::string> files[] = { { "a.PNG", "\x89PNG" },
                                                        { "a.svg", "<?xml" },
                                                        { "a.pdf", "%PDF" } };
  for (const auto & [name, begin] : files)
  {
    canvas.Write((folder / name).string());
    std::ifstream     file(folder / name, std::ios::binary);
    const std::string content{ std::istreambuf_iterator<char>(file), {} };
    EXPECT_EQ(content.substr(0, begin.size()), begin) << name;
  }
  EXPECT_THROW(canvas.Write((folder / "a.jpg").string()), IOError);
  EXPECT_THROW(canvas.Write((folder / "none" / "a.png").string()), IOError);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), {}), 3);
  fs::remove_all(folder);
}

TEST(Canvas, RefusesSizesThatCannotBe)
{
  EXPECT_THROW(Canvas(0.0, 10.0), std::invalid_argument);
  EXPECT_THROW(Canvas(10.0, std::nan("")), std::invalid_argument);
  const Canvas canvas(100.0, 100.0);
  EXPECT_THROW(canvas.GetPng(0.0), std::invalid_argument);
  EXPECT_THROW(canvas.GetPng(std::nan("")), std::invalid_argument);
  EXPECT_THROW(canvas.GetPng(400.0), std::invalid_argument);
}

TEST(ColorMap, IsClampedAndHasItsEnds)
{
  EXPECT_EQ(MapColor(ColorMap::Sequential, -1.0), (Color{ { 68, 1, 84 } }));
  EXPECT_EQ(MapColor(ColorMap::Sequential, 2.0), (Color{ { 253, 231, 37 } }));
  EXPECT_EQ(MapColor(ColorMap::Grey, std::nan("")), (Color{ { 0, 0, 0 } }));
  EXPECT_EQ(MapColor(ColorMap::Grey, 3.0, { 2.0, 2.0 }), (Color{ { 0, 0, 0 } }));
  EXPECT_EQ(MapColor(ColorMap::Diverging, 0.05), (Color{ { 19, 75, 135 } })); // half way to the second of eleven
}

TEST(ContourStyles, EveryKindHasItsOwn)
{
  std::set<std::string> names;
  std::set<Color>       colors;
  for (const ContourStyle & style : ContourStyles())
  {
    names.insert(style.name);
    colors.insert(style.color);
  }
  EXPECT_EQ(names.size(), 5U);
  EXPECT_EQ(colors.size(), 5U);
  Contour contour;
  EXPECT_EQ(StyleOf(contour).name, "periosteal");
  contour.layer = 1;
  EXPECT_EQ(StyleOf(contour).name, "endosteal");
  contour.layer = 3;
  EXPECT_EQ(StyleOf(contour).name, "medullary");
  contour.region = Region::Outside;
  EXPECT_EQ(StyleOf(contour).name, "hole");
  contour.axis = true;
  EXPECT_EQ(StyleOf(contour).name, "medial axis");
}
} // namespace CanvasTests
