/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneContourTiler.h"

#include "boneMeshValidator.h"
#include "boneRandomStack.h"
#include "boneSlabTopology.h"
#include "boneSurfaceAudit.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <map>
#include <random>
#include <set>

namespace ContourTilerTests
{
using CellPlaces = std::array<std::array<double, 3>, 4>;

/** The cells by where their points lie, whatever their numbers. */
std::vector<CellPlaces>
CellsByPlace(const bone::MeshArrays & mesh)
{
  std::vector<CellPlaces> cells;
  for (const bone::Id4 & c : mesh.tetrahedra)
  {
    CellPlaces cell;
    for (int i = 0; i < 4; ++i)
    {
      const bone::Vector3 & p = mesh.points[c[i]];
      cell[i] = { p.x(), p.y(), p.z() };
    }
    std::sort(cell.begin(), cell.end());
    cells.push_back(cell);
  }
  std::sort(cells.begin(), cells.end());
  return cells;
}

/** The same contours in another order, with other ids and other first points. */
bone::ContourStack::Pointer
Renumbered(const bone::ContourStack & stack, unsigned seed)
{
  std::mt19937 engine(seed);
  auto         other = bone::ContourStack::New();
  other->Graft(&stack);
  auto slices = stack.GetSlices();
  for (bone::ContourSlice & slice : slices)
  {
    std::shuffle(slice.contours.begin(), slice.contours.end(), engine);
    for (std::size_t c = 0; c < slice.contours.size(); ++c)
    {
      auto & points = slice.contours[c].points;
      slice.contours[c].id = static_cast<int>(c);
      if (!slice.contours[c].axis)
      {
        std::rotate(
          points.begin(), points.begin() + static_cast<std::ptrdiff_t>(engine() % points.size()), points.end());
      }
    }
  }
  other->SetSlices(slices);
  return other;
}

bone::ContourStack::Pointer
Turned(const bone::ContourStack & stack, const Eigen::Matrix3d & rotation)
{
  auto other = bone::ContourStack::New();
  other->Graft(&stack);
  auto slices = stack.GetSlices();
  for (bone::ContourSlice & slice : slices)
  {
    slice.origin = rotation * slice.origin;
    for (bone::Contour & contour : slice.contours)
    {
      for (bone::Vector3 & p : contour.points)
      {
        p = rotation * p;
      }
    }
  }
  // A frame of its own, not the turned one.
  const bone::Vector3 normal = rotation * stack.GetNormal();
  other->SetFrame(normal.unitOrthogonal(), normal.cross(normal.unitOrthogonal()));
  other->SetSlices(slices);
  return other;
}

class RandomStackTest : public testing::TestWithParam<unsigned>
{
};

TEST_P(RandomStackTest, IsTiledWithAllItsContoursAndLayers)
{
  const auto stack = bone::RandomStack(GetParam()).Make();
  stack->Verify();
  bone::TilingReport report;
  const auto         mesh = bone::TileContours(*stack, {}, report);
  const auto         validation = bone::ValidateMesh(mesh);
  EXPECT_TRUE(validation.IsValid()) << validation.Summary();
  EXPECT_EQ(report.loopsLeftOut, 0);
  for (int least = 1; least <= 3; ++least)
  {
    EXPECT_EQ(bone::PinchedPoints(mesh, least), 0) << "regions from " << least << " inward";
    for (const auto & line : bone::FindSlabsOfOtherTopology(mesh, *stack, report.correspondence, least, 0.1))
    {
      ADD_FAILURE() << line;
    }
  }
  // Every contour's points are there, but for those of holes that were closed because they are voids.
  std::set<std::array<double, 3>> points;
  for (const auto & p : mesh.points)
  {
    points.insert({ { p.x(), p.y(), p.z() } });
  }
  int missing = 0;
  for (const auto & slice : stack->GetSlices())
  {
    for (const auto & contour : slice.contours)
    {
      const auto & p = contour.points.front();
      missing += points.count({ { p.x(), p.y(), p.z() } }) == 0;
    }
  }
  EXPECT_EQ(missing, report.holesLeftOut);
}

TEST(RandomStack, HasHolesAndThreeLayersInTheirOrder)
{
  int holes = 0, innermost = 0;
  for (unsigned seed = 0; seed < 20; ++seed)
  {
    const auto stack = bone::RandomStack(seed).Make();
    for (const auto & slice : stack->GetSlices())
    {
      for (const auto & contour : slice.contours)
      {
        std::vector<bone::Vector2> polygon;
        for (const auto & p : contour.points)
        {
          polygon.emplace_back(p.x(), p.y());
        }
        if (contour.region == bone::Region::Outside || contour.region == bone::Region::Medullary)
        {
          EXPECT_EQ(bone::SignedArea(polygon) > 0, contour.region == bone::Region::Medullary) << "seed " << seed;
        }
        holes += contour.region == bone::Region::Outside;
        innermost += contour.region == bone::Region::Medullary;
      }
    }
  }
  EXPECT_GT(holes, 10);
  EXPECT_GT(innermost, 100);
}

TEST(ContourTiler, RenumberingChangesNothingButTheNumbering)
{
  for (const unsigned seed : { 1u, 4u })
  {
    const auto         stack = bone::RandomStack(seed).Make();
    bone::TilingReport report;
    const auto         mesh = bone::TileContours(*stack, {}, report);
    EXPECT_TRUE(CellsByPlace(mesh) == CellsByPlace(bone::TileContours(*Renumbered(*stack, seed), {}, report))) << seed;
  }
}

TEST(ContourTiler, TurningTheStackKeepsTheNumberOfCells)
{
  const auto         stack = bone::RandomStack(4).Make();
  bone::TilingReport report;
  const auto         count = static_cast<double>(bone::TileContours(*stack, {}, report).tetrahedra.size());
  for (const double angle : { 0.5, 2.0, 4.0 })
  {
    const Eigen::Matrix3d rotation =
      Eigen::AngleAxisd(angle, bone::Vector3(0.3, angle - 2.0, 1.0).normalized()).toRotationMatrix();
    const auto mesh = bone::TileContours(*Turned(*stack, rotation), {}, report);
    EXPECT_NEAR(static_cast<double>(mesh.tetrahedra.size()) / count, 1.0, 0.01) << angle;
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomStackTest, testing::Range(0u, 8u));
// Bodies whose parts once came apart where a slab's slices were moved against each other.
INSTANTIATE_TEST_SUITE_P(Moved, RandomStackTest, testing::Values(11u, 155u, 170u));
} // namespace ContourTilerTests
