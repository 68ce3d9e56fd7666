/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneReportPage.h"

#include "boneAtomicFile.h"
#include "boneBernstein.h"
#include "boneIOError.h"
#include "bonePageData.h"

#include <gmock/gmock.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>

#include <jpeglib.h>
#include <zlib.h>

namespace ReportPageTests
{
using bone::IdType;
using testing::HasSubstr;
using testing::Not;

std::string
FromBase64(const std::string & text)
{
  static const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string              bytes;
  unsigned int             bits = 0;
  int                      count = 0;
  for (const char c : text)
  {
    if (c == '=')
    {
      break;
    }
    bits = (bits << 6) + static_cast<unsigned int>(digits.find(c));
    count += 6;
    if (count >= 8)
    {
      count -= 8;
      bytes += static_cast<char>((bits >> count) & 0xff);
    }
  }
  return bytes;
}

std::string
Gunzip(const std::string & packed)
{
  z_stream stream{};
  inflateInit2(&stream, 15 + 16);
  std::string bytes(1 << 22, '\0');
  stream.next_in = reinterpret_cast<Bytef *>(const_cast<char *>(packed.data()));
  stream.avail_in = static_cast<uInt>(packed.size());
  stream.next_out = reinterpret_cast<Bytef *>(&bytes[0]);
  stream.avail_out = static_cast<uInt>(bytes.size());
  EXPECT_EQ(inflate(&stream, Z_FINISH), Z_STREAM_END);
  bytes.resize(stream.total_out);
  inflateEnd(&stream);
  return bytes;
}

/** Reads an array as the page's script does. */
std::vector<double>
Unpack(const nlohmann::json & array)
{
  const std::string bytes = Gunzip(FromBase64(array.at("data")));
  const std::string type = array.at("type");
  const bool        isSigned = type[0] == 'i';
  const auto        size = static_cast<std::size_t>(std::stoi(type.substr(isSigned ? 3 : 4)) / 8);
  const auto        length = array.at("length").get<std::size_t>();
  EXPECT_EQ(bytes.size(), size * length);
  EXPECT_EQ(array.value("planes", false), size > 1);
  std::vector<std::uint64_t> raw(length);
  const auto                 delta = array.value("delta", std::size_t{ 0 });
  const std::uint64_t        modulus = std::uint64_t{ 1 } << (8 * size);
  for (std::size_t i = 0; i < length; ++i)
  {
    for (std::size_t b = 0; b < size; ++b)
    {
      raw[i] += std::uint64_t{ static_cast<unsigned char>(bytes[b * length + i]) } << (8 * b);
    }
    raw[i] = (raw[i] + (delta > 0 && i >= delta ? raw[i - delta] : 0)) % modulus;
  }
  std::vector<double> values;
  for (std::size_t i = 0; i < length; ++i)
  {
    const double number = isSigned && raw[i] >= modulus / 2 ? static_cast<double>(raw[i]) - static_cast<double>(modulus)
                                                            : static_cast<double>(raw[i]);
    if (array.contains("step"))
    {
      const auto & offset = array["offset"];
      values.push_back(offset[i % offset.size()].get<double>() + array["step"].get<double>() * number);
    }
    else
    {
      values.push_back(number);
    }
  }
  return values;
}

/** The grey values of one slice, as the page's script has them. */
std::vector<double>
Slice(const nlohmann::json & slices, std::size_t k)
{
  const auto &           packed = slices["values"];
  const std::string      bytes = FromBase64(packed["jpeg"]);
  jpeg_error_mgr         errors{};
  jpeg_decompress_struct reader{};
  reader.err = jpeg_std_error(&errors);
  jpeg_create_decompress(&reader);
  jpeg_mem_src(&reader, reinterpret_cast<const unsigned char *>(bytes.data()), bytes.size());
  jpeg_read_header(&reader, TRUE);
  jpeg_start_decompress(&reader);
  std::vector<unsigned char> row(3 * reader.output_width);
  std::vector<double>        values;
  const auto                 across = packed["across"].get<std::size_t>();
  const std::size_t          left = k % across * packed["tile"][0].get<std::size_t>();
  const std::size_t          top = k / across * packed["tile"][1].get<std::size_t>();
  while (reader.output_scanline < reader.output_height)
  {
    const std::size_t r = reader.output_scanline;
    JSAMPROW          line = row.data();
    jpeg_read_scanlines(&reader, &line, 1);
    for (std::size_t c = 0; r >= top && r < top + slices["rows"].get<std::size_t>() && c < slices["columns"]; ++c)
    {
      values.push_back(packed["offset"].get<double>() + packed["step"].get<double>() * row[3 * (left + c)]);
    }
  }
  jpeg_destroy_decompress(&reader);
  return values;
}

TEST(PageData, NumbersComeBackWithinHalfAStep)
{
  for (const double scale : { 1.0, 300.0, 1e5, 1e8 })
  {
    std::vector<double> values;
    for (int i = 0; i < 1000; ++i)
    {
      values.push_back(scale * std::sin(0.37 * i) + (i % 3));
    }
    for (const std::size_t delta : { 0, 1, 3 })
    {
      const auto back = Unpack(bone::PackNumbers(values, 0.5, { 0.0, 1.0, 2.0 }, delta));
      ASSERT_EQ(back.size(), values.size());
      for (std::size_t i = 0; i < values.size(); ++i)
      {
        ASSERT_NEAR(back[i], values[i], 0.2501) << scale << ' ' << delta << ' ' << i;
      }
    }
  }
}

TEST(PageData, NumbersTakeAsFewBytesAsHoldThem)
{
  const auto type = [](std::vector<IdType> ids) { return bone::PackIds(ids, 0)["type"].get<std::string>(); };
  EXPECT_EQ(type({ 0, 255 }), "uint8");
  EXPECT_EQ(type({ 0, 256 }), "uint16");
  EXPECT_EQ(type({ 65536 }), "uint32");
  EXPECT_EQ(type({}), "uint8");
  EXPECT_EQ(type({ -128, 127 }), "int8");
  EXPECT_EQ(type({ -1, 128 }), "int16");
}

TEST(PageData, RefusesWhatHasNoNumber)
{
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(bone::PackNumbers({ 0.0, nan }, 1.0, { 0.0 }, 0), std::invalid_argument);
  EXPECT_THROW(bone::PackNumbers({ 1e300 }, 1.0, { 0.0 }, 0), std::invalid_argument);
  EXPECT_THROW(bone::PackNumbers({ 1.0 }, 0.0, { 0.0 }, 0), std::invalid_argument);
  EXPECT_THROW(bone::PackNumbers({ 1.0 }, 1.0, {}, 0), std::invalid_argument);
}

/** Two tetrahedra of degrees 1 and 2. */
bone::MeshArrays
SmallMesh()
{
  bone::MeshArrays mesh;
  mesh.points = { { 0, 0, 0 }, { 10, 0, 0 }, { 0, 20, 0 }, { 0, 0, 40 }, { 10, 20, 40 } };
  mesh.tetrahedra = { { { 0, 1, 2, 3 } }, { { 1, 2, 3, 4 } } };
  mesh.neighbors = bone::ComputeFaceNeighbors(mesh.tetrahedra);
  mesh.region = { 1, 2 };
  mesh.degree = { 1, 2 };
  mesh.maximumDegree = 2;
  mesh.quantity = bone::DensityQuantity::HounsfieldUnit;
  mesh.coefficients = { 100, 200, 300, 400, 0, 0, 0, 0, 0, 0, -5, 15, 25, 35, 45, 55, 65, 75, 85, 1500.25 };
  return mesh;
}

TEST(PageData, LevelHoldsPointsCellsAndEachCellsOwnCoefficients)
{
  const bone::MeshArrays mesh = SmallMesh();
  const auto             level = bone::PackLevel("level 1", mesh, 0.5);
  EXPECT_EQ(level["name"], "level 1");
  EXPECT_EQ(Unpack(level["tetrahedra"]), (std::vector<double>{ 0, 1, 2, 3, 1, 2, 3, 4 }));
  EXPECT_EQ(Unpack(level["regions"]), (std::vector<double>{ 1, 2 }));
  EXPECT_EQ(Unpack(level["degrees"]), (std::vector<double>{ 1, 2 }));
  const auto points = Unpack(level["points"]);
  ASSERT_EQ(points.size(), 15u);
  EXPECT_NEAR(points[13], 20.0, 40.0 / 65535.0);
  EXPECT_NEAR(points[14], 40.0, 40.0 / 65535.0);
  const auto coefficients = Unpack(level["coefficients"]);
  ASSERT_EQ(coefficients.size(), 14u); // 4 and 10: none of the row's padding
  EXPECT_EQ(coefficients[3], 400.0);
  EXPECT_EQ(coefficients[4], -5.0);
  EXPECT_NEAR(coefficients[13], 1500.25, 0.2501);
}

TEST(PageData, ModelNamesUnitAndRegions)
{
  const bone::MeshArrays mesh = SmallMesh();
  const auto             model = bone::PackModel({ { "level 1", &mesh } }, nullptr, { { "tip", { 1, 2, 3 } } });
  EXPECT_EQ(model["unit"], "HU");
  EXPECT_EQ(model["regions"]["1"], "cortical");
  EXPECT_EQ(model["regions"]["2"], "trabecular");
  EXPECT_EQ(model["landmarks"][0]["position"], (nlohmann::json{ 1.0, 2.0, 3.0 }));
  EXPECT_LT(model["range"][0].get<double>(), model["range"][1].get<double>());
  bone::MeshArrays bare = mesh;
  bare.maximumDegree = -1;
  bare.degree.clear();
  bare.coefficients.clear();
  bare.quantity = bone::DensityQuantity::Unknown;
  const auto without = bone::PackModel({ { "mesh", &bare } }, nullptr, {});
  EXPECT_FALSE(without["levels"][0].contains("coefficients"));
  EXPECT_EQ(without["unit"], "density units");
}

TEST(PageData, SlicesShowEachPointOfTheCTAtItsPixel)
{
  auto                    ct = bone::CTImage::New();
  bone::CTImage::SizeType size = { { 20, 20, 5 } };
  ct->SetRegions(size);
  ct->Allocate();
  ct->FillBuffer(0.0F);
  ct->SetPixel({ { 14, 5, 2 } }, 1000.0F);
  bone::ContourStack::SliceContainer slices;
  for (const double z : { 1.0, 2.0, 3.0 })
  {
    bone::Contour square;
    square.points = { { 4, 4, z }, { 16, 4, z }, { 16, 16, z }, { 4, 16, z } };
    slices.push_back({ { 0, 0, z }, { square } });
  }
  auto stack = bone::ContourStack::New();
  stack->SetSlices(slices);
  const auto packed = bone::PackSlices(ct, *stack, { 0.0, 1000.0 }, "HU", { "one", "two", "three" });
  EXPECT_EQ(packed["count"], 3);
  EXPECT_EQ(packed["titles"][2], "three");
  EXPECT_EQ(packed["letters"]["right"], "L"); // +x is the patient's left, shown on the right
  EXPECT_EQ(packed["letters"]["top"], "A");
  const auto   columns = packed["columns"].get<std::size_t>();
  const auto   before = Slice(packed, 0), slice = Slice(packed, 1);
  const auto   bright = std::max_element(slice.begin(), slice.end());
  const auto   at = static_cast<std::size_t>(bright - slice.begin());
  const double pixel = packed["pixel"];
  EXPECT_NEAR(pixel, 1.0, 0.05); // a voxel
  EXPECT_GT(*bright, 700.0);
  EXPECT_LT(*std::max_element(before.begin(), before.end()), 20.0);
  // From the contour's first corner (4, 4), whose pixel is given, the bead lies 10 mm to the right and 1 mm down.
  const auto contours = nlohmann::json::parse(Gunzip(FromBase64(packed["contours"]["gzip"])));
  const auto corner = contours[1][0]["points"];
  EXPECT_NEAR((static_cast<double>(at % columns) - corner[0].get<double>()) * pixel, 10.0, pixel);
  EXPECT_NEAR((static_cast<double>(at / columns) - corner[1].get<double>()) * pixel, 1.0, pixel);
  EXPECT_EQ(contours[0][0]["name"], "periosteal");
}

TEST(PageData, AtlasHoldsChangesAtOneStandardDeviation)
{
  bone::StatisticalModelContent content;
  content.mean = SmallMesh();
  content.shape.mean = bone::StackPoints(content.mean.points);
  content.shape.modes = Eigen::MatrixXd::Zero(15, 2);
  content.shape.modes(4, 0) = 1.0;
  content.shape.modes(7, 1) = 1.0;
  content.shape.variances = Eigen::Vector2d(9.0, 4.0);
  content.shape.totalVariance = 18.0;
  content.density.mean = Eigen::Map<const Eigen::VectorXd>(content.mean.coefficients.data(), 20);
  content.density.modes = Eigen::MatrixXd::Zero(20, 1);
  content.density.modes(19, 0) = 1.0;
  content.density.variances = Eigen::VectorXd::Constant(1, 400.0);
  content.density.totalVariance = 400.0;
  auto model = bone::StatisticalModel::New();
  model->SetContent(content);
  const auto atlas = bone::PackAtlas(*model, 1, bone::XRayGeometry::View());
  ASSERT_EQ(atlas["shape"].size(), 1u); // as many as asked for
  EXPECT_DOUBLE_EQ(atlas["shape"][0]["share"], 0.5);
  const auto change = Unpack(atlas["shape"][0]["displacements"]);
  ASSERT_EQ(change.size(), 15u);
  EXPECT_NEAR(change[4], 3.0, 1e-3);
  EXPECT_EQ(change[7], 0.0);
  const auto density = Unpack(atlas["density"][0]["coefficients"]);
  ASSERT_EQ(density.size(), 14u);
  EXPECT_NEAR(density[13], 20.0, 0.1);
  EXPECT_EQ(atlas["letters"]["right"], "L"); // the view looks from in front
}

TEST(ReportPage, EscapesAndHoldsAllParts)
{
  bone::ReportPage page("a<b> & \"c\"", "build");
  page.SetWarnings({ "Dice < 0.9" });
  page.BeginSection("levels", "Levels & more");
  page.AddText("1 < 2");
  page.AddTable({ "caption", { "", "x" }, { { "row", "5 > 4" } } });
  page.AddPicture("\x89PNG....", "a \"bone\"", "the bone");
  page.AddPicture("\xff\xd8....", "joint", "the joint");
  page.AddPicture("<svg a=\"1.2345 10.5\"\n/>", "chart", "the chart");
  const std::string html = page.GetHtml();
  EXPECT_THAT(html, HasSubstr("<title>BoneTK report: a&lt;b&gt; &amp; &quot;c&quot;</title>"));
  EXPECT_THAT(html, HasSubstr("<li>Dice &lt; 0.9</li>"));
  EXPECT_THAT(html, HasSubstr("<h2>Levels &amp; more</h2>"));
  EXPECT_THAT(html, HasSubstr("<th scope=\"row\">row</th><td>5 &gt; 4</td>"));
  EXPECT_THAT(html, HasSubstr("src=\"data:image/png;base64,"));
  EXPECT_THAT(html, HasSubstr("src=\"data:image/jpeg;base64,"));
  EXPECT_THAT(html, HasSubstr("src=\"data:image/svg+xml,%3Csvg a=%221.23 10.5%22 /%3E\" alt=\"chart\""));
  EXPECT_THAT(html, Not(HasSubstr("bonetk-data"))); // nothing to draw
  EXPECT_LT(html.find("Dice &lt; 0.9"), html.find("<h2>Levels"));
}

TEST(ReportPage, DataCannotEndItsScript)
{
  const bone::MeshArrays mesh = SmallMesh();
  bone::ReportPage       page("x", "build");
  page.BeginSection("model", "Model");
  page.AddModel(bone::PackModel({ { "</script><script>alert(1)", &mesh } }, nullptr, {}));
  const std::string html = page.GetHtml();
  EXPECT_THAT(html, Not(HasSubstr("</script><script>alert")));
  if (bone::ReportPage::HasScript())
  {
    EXPECT_THAT(html, HasSubstr("<div id=\"viewer\"></div>"));
    EXPECT_THAT(html, HasSubstr("\\u003c/script>"));
  }
  else
  {
    EXPECT_THAT(html, HasSubstr("made without npm"));
  }
}

TEST(Provenance, ChecksumsAreThoseOfMd5sum)
{
  const std::string folder = testing::TempDir() + "bone-report-test";
  std::filesystem::remove_all(folder);
  std::filesystem::create_directory(folder);
  const std::string a = folder + "/a", b = folder + "/b";
  bone::WriteFileAtomically(b, "world\n");
  bone::WriteFileAtomically(a, "hello ");
  const auto one = bone::DescribeInput(b);
  EXPECT_EQ(one.bytes, 6u);
  EXPECT_EQ(one.md5, "591785b794601e212b260e25925636fd");
  const auto both = bone::DescribeInput(folder); // "hello world\n"
  EXPECT_EQ(both.bytes, 12u);
  EXPECT_EQ(both.md5, "6f5902ac237024bdd0c176cb93063dc4");
  EXPECT_THROW(bone::DescribeInput(folder + "/none"), bone::IOError);
  std::filesystem::remove_all(folder);
}
} // namespace ReportPageTests
