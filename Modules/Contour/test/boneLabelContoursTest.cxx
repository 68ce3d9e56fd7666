/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneLabelContours.h"

#include "boneContourTestTools.h"

#include <gtest/gtest.h>

namespace bone
{
namespace LabelContoursTests
{
template <typename TFunction>
std::vector<unsigned char>
Voxels(const VoxelBox & box, TFunction && inside)
{
  std::vector<unsigned char> flags;
  for (int k = 0; k < box.size[2]; ++k)
  {
    for (int j = 0; j < box.size[1]; ++j)
    {
      for (int i = 0; i < box.size[0]; ++i)
      {
        flags.push_back(inside(Vector3(box.origin + Vector3(i, j, k).cwiseProduct(box.spacing))));
      }
    }
  }
  return flags;
}

VoxelBox
Box()
{
  VoxelBox box;
  box.size = { { 50, 50, 9 } };
  box.spacing = { 0.6, 0.6, 1.5 };
  box.origin = { -14.7, -14.7, -6.0 };
  return box;
}

PlaneGrid
PlaneOf(const VoxelBox & box)
{
  PlaneGrid grid;
  grid.size = { { box.size[0], box.size[1] } };
  grid.origin = box.origin.head<2>();
  grid.spacing = box.spacing.head<2>();
  return grid;
}

TEST(LabelField, ContourOfACylinderIsACircleOfTheLabelsArea)
{
  const VoxelBox   box = Box();
  const auto       flags = Voxels(box, [](const Vector3 & p) { return p.head<2>().norm() < 9.0; });
  const LabelField field(box, flags, 0.8, Execution());
  int              dropped = 0;
  const auto       pieces = ContoursOfLabel(field, PlaneOf(box), Vector3::UnitX(), Vector3::UnitY(), 0.0, 4.0, dropped);
  ASSERT_EQ(pieces.size(), 1u);
  EXPECT_TRUE(pieces[0].holes.empty());
  const double label = field.LabelArea(PlaneOf(box), Vector3::UnitX(), Vector3::UnitY(), 0.0);
  EXPECT_NEAR(SignedArea(pieces[0].outer), label, 2e-3 * label);
  double low = 1e9;
  double high = 0.0;
  for (const Vector2 & q : pieces[0].outer)
  {
    low = std::min(low, q.norm());
    high = std::max(high, q.norm());
  }
  // No stair-steps: the voxels' corners lie up to 0.4 mm off the circle.
  EXPECT_LT(high - low, 0.25);
}

TEST(LabelField, KeepsPlatesOfOneVoxelGapsAndHoles)
{
  const VoxelBox   box = Box();
  const auto       flags = Voxels(box, [](const Vector3 & p) {
    const bool plate = std::abs(p.x()) < 9.0 && (std::abs(p.y() - 0.3) < 0.25 || std::abs(p.y() - 1.5) < 0.25);
    const bool ring = std::abs((p.head<2>() - Vector2(0, -8)).norm() - 3.5) < 1.5;
    return plate || ring;
  });
  const LabelField field(box, flags, 0.8, Execution());
  int              dropped = 0;
  const auto       pieces = ContoursOfLabel(field, PlaneOf(box), Vector3::UnitX(), Vector3::UnitY(), 1.5, 4.0, dropped);
  ASSERT_EQ(pieces.size(), 3u);
  std::size_t holes = 0;
  double      area = 0.0;
  for (const SectionPiece & piece : pieces)
  {
    holes += piece.holes.size();
    area += SignedArea(piece.outer);
    for (const Polygon & hole : piece.holes)
    {
      EXPECT_LT(SignedArea(hole), 0.0);
      area += SignedArea(hole);
    }
  }
  EXPECT_EQ(holes, 1u);
  const double label = field.LabelArea(PlaneOf(box), Vector3::UnitX(), Vector3::UnitY(), 1.5);
  EXPECT_NEAR(area, label, 0.01 * label);
}

TEST(LabelField, ContoursOfAFewVoxelsHaveTheirArea)
{
  // Beside a large bone a rod of 13 voxels, which smoothing alone would shrink below the least area.
  const VoxelBox box = Box();
  const Vector2  rod(11.1, 0.3);
  const auto     flags =
    Voxels(box, [&](const Vector3 & p) { return p.head<2>().norm() < 7.0 || (p.head<2>() - rod).norm() < 1.3; });
  const LabelField field(box, flags, 0.8, Execution());
  int              dropped = 0;
  const auto       pieces = ContoursOfLabel(field, PlaneOf(box), Vector3::UnitX(), Vector3::UnitY(), 0.0, 4.5, dropped);
  EXPECT_EQ(dropped, 0);
  ASSERT_EQ(pieces.size(), 2u);
  const double area = std::min(SignedArea(pieces[0].outer), SignedArea(pieces[1].outer));
  EXPECT_NEAR(area, 13 * 0.36, 0.05 * 13 * 0.36);
}

TEST(LabelField, BetweenSlicesTheContourLiesBetweenTheirs)
{
  const VoxelBox   box = Box();
  const auto       flags = Voxels(box, [](const Vector3 & p) { return p.head<2>().norm() < 8.0 + 0.4 * p.z(); });
  const LabelField field(box, flags, 0.8, Execution());
  double           areas[3];
  for (int k = 0; k < 3; ++k)
  {
    int        dropped = 0;
    const auto pieces =
      ContoursOfLabel(field, PlaneOf(box), Vector3::UnitX(), Vector3::UnitY(), 0.75 * k, 4.0, dropped);
    ASSERT_EQ(pieces.size(), 1u);
    areas[k] = SignedArea(pieces[0].outer);
  }
  EXPECT_GT(areas[1], areas[0]);
  EXPECT_LT(areas[1], areas[2]);
}

TEST(Section, PolygonsOverlapWhereATipCrossesOneEdgeWhereverTheyBegin)
{
  Polygon       hexagon = Ellipse(10, 10, 6);
  const Polygon tip = { { 7.0, 4.5 }, { 12.0, 6.0 }, { 10.5, 8.0 } }; // through the edge in the first quadrant
  for (int k = 0; k < 6; ++k)
  {
    std::rotate(hexagon.begin(), hexagon.begin() + 1, hexagon.end());
    Polygon turned = tip, apart = tip;
    for (Vector2 & q : apart)
    {
      q += Vector2(3, 2);
    }
    for (int j = 0; j < 3; ++j)
    {
      std::rotate(turned.begin(), turned.begin() + 1, turned.end());
      std::rotate(apart.begin(), apart.begin() + 1, apart.end());
      EXPECT_TRUE(PolygonsOverlap(hexagon, turned)) << k << ' ' << j;
      EXPECT_TRUE(PolygonsOverlap(turned, hexagon)) << k << ' ' << j;
      EXPECT_FALSE(PolygonsOverlap(hexagon, apart)) << k << ' ' << j;
    }
  }
}

TEST(Section, DropsWhatExistsOnOneSliceOnly)
{
  std::vector<Section> sections;
  for (int k = 0; k < 8; ++k)
  {
    Section section{ 1.0 * k, { { Ellipse(10, 10, 60), {}, {}, {} } } };
    Polygon hole = Ellipse(2, 2, 20);
    std::reverse(hole.begin(), hole.end());
    if (k == 3)
    {
      section.pieces.push_back({ Ellipse(2, 2, 20, { 30, 0 }), {}, {}, {} });
      section.pieces[0].holes.push_back(hole);
    }
    if (k == 5 || k == 6)
    {
      section.pieces[0].holes.push_back(hole);
    }
    sections.push_back(section);
  }
  const auto lines = DropShortLived(sections, 3, 10.0);
  EXPECT_EQ(lines.size(), 2u);
  EXPECT_EQ(sections[3].pieces.size(), 1u);
  EXPECT_TRUE(sections[3].pieces[0].holes.empty());
  EXPECT_EQ(sections[5].pieces[0].holes.size(), 1u);
}

TEST(Section, KeepsAHoleThatIsTheEndOfANotch)
{
  // A ring open to one side below, closed on the last slice before it is solid.
  std::vector<Section> sections;
  Polygon              hole = Ellipse(5, 5, 40);
  std::reverse(hole.begin(), hole.end());
  Polygon open = Ellipse(10, 10, 60);
  open.erase(open.begin(), open.begin() + 4);
  open.erase(open.end() - 4, open.end());
  for (int i = 3; i < 38; ++i)
  {
    open.push_back(Ellipse(5.5, 5.5, 40)[static_cast<std::size_t>(40 - i)]);
  }
  for (int k = 0; k < 8; ++k)
  {
    Section section{ 1.0 * k, { { k < 3 ? open : Ellipse(10, 10, 60), {}, {}, {} } } };
    if (k == 3)
    {
      section.pieces[0].holes.push_back(hole);
    }
    sections.push_back(section);
  }
  ASSERT_GT(SignedArea(open), 0.0);
  EXPECT_TRUE(DropShortLived(sections, 3, 10.0).empty());
  EXPECT_EQ(sections[3].pieces[0].holes.size(), 1u);
}

TEST(Section, InnerContoursMustLast)
{
  std::vector<Section> sections;
  for (int k = 0; k < 10; ++k)
  {
    sections.push_back({ 1.0 * k, { { Ellipse(20, 10, 60), {}, {}, {} } } });
    auto & here = sections.back().pieces[0].endosteal;
    if (k == 2 || k == 3 || k == 9)
    {
      here.push_back(Ellipse(6, 6, 30, { 8, 0 })); // larger, but does not last
    }
    if (k < 7)
    {
      here.push_back(Ellipse(4, 4, 30, { -10, 0 }));
    }
  }
  EXPECT_EQ(DropShortLayers(sections, &SectionPiece::endosteal, 30.0, 3), 3);
  for (int k = 0; k < 10; ++k)
  {
    const auto & inner = sections[static_cast<std::size_t>(k)].pieces[0].endosteal;
    ASSERT_EQ(inner.size(), k < 7 ? 1U : 0U) << k;
    EXPECT_TRUE(inner.empty() || inner[0][0].x() < 0.0) << k;
  }
}
} // namespace LabelContoursTests
} // namespace bone
