/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneInnerLayers.h"

#include "bonePlanarCrossing.h"

#include <gtest/gtest.h>

#include <cmath>

namespace bone
{
namespace InnerLayersTests
{
constexpr double Cortex = 2.0;

/** Distance to the surface of a bone's cross-section, positive inside (mm). */
using Depth = std::function<double(const Vector2 &)>;

/** The CT of a bone with a cortex of even thickness on every slice. */
PlaneSource
ImageOf(const Depth & depth)
{
  return [depth](double, const Vector2 & low, const Vector2 & high) {
    PlaneField field;
    field.grid.spacing = Vector2::Constant(0.5);
    field.grid.origin = low;
    for (int a = 0; a < 2; ++a)
    {
      field.grid.size[static_cast<std::size_t>(a)] = static_cast<int>(std::ceil((high[a] - low[a]) / 0.5)) + 1;
    }
    for (int j = 0; j < field.grid.size[1]; ++j)
    {
      for (int i = 0; i < field.grid.size[0]; ++i)
      {
        const double d = depth(field.grid.Node(i, j));
        field.values.push_back(d < 0.0 ? 0.0F : d < Cortex ? 1200.0F : 200.0F);
      }
    }
    return field;
  };
}

Polygon
Circle(double radius, const Vector2 & centre = Vector2::Zero())
{
  Polygon polygon;
  for (int i = 0; i < 90; ++i)
  {
    const double t = 2.0 * 3.14159265358979 * i / 90;
    polygon.push_back(centre + radius * Vector2(std::cos(t), std::sin(t)));
  }
  return polygon;
}

/** 20 slices, 1 mm apart. */
std::vector<Section>
Layered(const SectionPiece & piece, const Depth & depth)
{
  std::vector<Section> sections;
  for (int k = 0; k < 20; ++k)
  {
    sections.push_back({ 1.0 * k, { piece } });
  }
  FindInnerLayers(sections, ImageOf(depth), Vector2(0.5, 0.5), ExtractionParameters(), Execution());
  return sections;
}

bool
Cross(const SectionPiece & piece)
{
  std::vector<PlanarChain> chains;
  chains.push_back({ piece.outer, true });
  for (const auto * loops : { &piece.holes, &piece.endosteal, &piece.medullary })
  {
    for (const Polygon & loop : *loops)
    {
      chains.push_back({ loop, true });
    }
  }
  return FindPlanarCrossing(chains).found;
}

TEST(BoneLayers, APlateOfTwoThickEndsHasTwoEndostealContours)
{
  // Two disks, joined by a plate whose cortices meet.
  const Depth depth = [](const Vector2 & q) {
    const double disks = 9.0 - std::min((q - Vector2(-15, 0)).norm(), (q - Vector2(15, 0)).norm());
    const double plate = std::min(1.5 - std::abs(q.y()), 15.0 - std::abs(q.x()));
    return std::max(disks, plate);
  };
  Polygon outer;
  for (const Vector2 & q : Circle(9.0, { 15, 0 }))
  {
    if (q.x() > 15.0 || std::abs(q.y()) > 1.5)
    {
      outer.push_back(q);
    }
  }
  std::rotate(outer.begin(),
              std::find_if(outer.begin(), outer.end(), [](const Vector2 & q) { return q.y() < -1.5 && q.x() < 7; }),
              outer.end());
  const std::size_t half = outer.size();
  for (std::size_t i = 0; i < half; ++i)
  {
    outer.push_back(-outer[i]);
  }
  ASSERT_GT(SignedArea(outer), 500.0);
  const auto sections = Layered({ outer, {}, {}, {} }, depth);
  for (const Section & section : sections)
  {
    const SectionPiece & piece = section.pieces[0];
    ASSERT_EQ(piece.endosteal.size(), 2U);
    EXPECT_FALSE(Cross(piece));
    for (const Polygon & endosteal : piece.endosteal)
    {
      EXPECT_NEAR(SignedArea(endosteal), 3.1416 * 49.0, 16.0); // a disk with a cortex of 2 mm
    }
  }
}

TEST(BoneLayers, AroundAHoleTheEndostealContourIsParted)
{
  const Vector2 centre(3, 0); // of the hole; the narrowest place is on the right
  const Depth   depth = [&centre](const Vector2 & q) { return std::min(20.0 - q.norm(), (q - centre).norm() - 5.0); };
  Polygon       hole = Circle(5.0, centre);
  std::reverse(hole.begin(), hole.end());
  const auto sections = Layered({ Circle(20.0), { hole }, {}, {} }, depth);
  for (const Section & section : sections)
  {
    const SectionPiece & piece = section.pieces[0];
    ASSERT_EQ(piece.endosteal.size(), 1U);
    EXPECT_FALSE(Cross(piece));
    EXPECT_FALSE(PointInPolygon(centre, piece.endosteal[0]));
    const double slit = 8.0 * 1.6; // length and width
    EXPECT_NEAR(SignedArea(piece.endosteal[0]), 3.1416 * (18.0 * 18.0 - 7.0 * 7.0) - slit, 40.0);
    EXPECT_FALSE(PointInPolygon({ 14, 0 }, piece.endosteal[0]));
    EXPECT_TRUE(PointInPolygon({ -10, 0 }, piece.endosteal[0]));
  }
}

TEST(BoneLayers, EndostealContoursMustLastForTheLengthWhereverTheBoneLies)
{
  // Dense to its middle but for five slices, one millimetre apart.
  for (const double start : { 0.0, 1000.0, -1000.0 })
  {
    const PlaneSource planes = [start](double height, const Vector2 & low, const Vector2 & high) {
      const bool hollow = std::abs(height - start - 9.0) < 2.5;
      return ImageOf([hollow](const Vector2 & q) {
        const double depth = 12.0 - q.norm();
        return hollow ? depth : std::min(depth, 0.5 * Cortex);
      })(height, low, high);
    };
    for (const double length : { 3.0, 8.0 })
    {
      std::vector<Section> sections;
      for (int k = 0; k < 20; ++k)
      {
        sections.push_back({ start + k, { { Circle(12.0), {}, {}, {} } } });
      }
      ExtractionParameters parameters;
      parameters.minimumLength = length;
      parameters.thicknessSmoothing = 0.1; // each slice by itself
      FindInnerLayers(sections, planes, Vector2(0.5, 0.5), parameters, Execution());
      for (int k = 0; k < 20; ++k)
      {
        const bool expected = length < 4.0 && std::abs(k - 9) < 2.5;
        EXPECT_EQ(sections[static_cast<std::size_t>(k)].pieces[0].endosteal.size(), expected ? 1U : 0U)
          << start << ' ' << length << ' ' << k;
      }
    }
  }
}
} // namespace InnerLayersTests
} // namespace bone
