/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneContourTiler.h"

#include "boneMeshValidator.h"
#include "boneRandomStack.h"

#include <gtest/gtest.h>

#include <set>

namespace
{
/** Points of the boundary of the regions from `least` inward at which its faces do not form a single fan. */
int
PinchedPoints(const bone::MeshArrays & mesh, int least)
{
  std::map<bone::IdType, std::map<bone::IdType, bone::IdType>> links;
  std::map<bone::IdType, std::size_t>                          faces;
  for (const auto & face : bone::BoundaryFaces(mesh, least))
  {
    for (int k = 0; k < 3; ++k)
    {
      links[face[k]][face[(k + 1) % 3]] = face[(k + 2) % 3];
      ++faces[face[k]];
    }
  }
  int pinched = 0;
  for (const auto & [point, next] : links)
  {
    std::size_t length = 0;
    auto        here = next.begin();
    do
    {
      here = next.find(here->second);
      ++length;
    } while (here != next.end() && here != next.begin() && length <= faces[point]);
    pinched += here == next.end() || length != faces[point];
  }
  return pinched;
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
    EXPECT_EQ(PinchedPoints(mesh, least), 0) << "regions from " << least << " inward";
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

INSTANTIATE_TEST_SUITE_P(Seeds, RandomStackTest, testing::Range(0u, 8u));
} // namespace
