/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSurfaceSection.h"

#include "boneTestFemur.h"
#include "boneTestSurfaces.h"

#include <gtest/gtest.h>

namespace SurfaceSectionTests
{
using namespace bone;

TEST(SurfaceSection, OfABoxIsARectangle)
{
  const auto            box = test::Box(Vector3(3, 4, 5));
  const TriangleSurface surface{ box.points, box.triangles };
  for (const double z : { 5.0, 0.0, 1.7 }) // a plane in which a face lies cuts there
  {
    const auto loops = CutSurface(surface, Vector3(9, 9, z), Vector3::UnitZ());
    ASSERT_EQ(loops.size(), 1u) << z;
    EXPECT_NEAR(loops[0].area, 48.0, 1e-12);
    EXPECT_NEAR((loops[0].centroid - Vector3(0, 0, z)).norm(), 0.0, 1e-12);
    EXPECT_NEAR(loops[0].Width(Vector3::UnitY()), 8.0, 1e-12);
    EXPECT_TRUE(loops[0].Holds(Vector3(2.9, 3.9, z)));
    EXPECT_FALSE(loops[0].Holds(Vector3(3.1, 0, z)));
  }
  EXPECT_TRUE(CutSurface(surface, Vector3(0, 0, 5.1), Vector3::UnitZ()).empty());
  EXPECT_TRUE(CutSurface(surface, Vector3(0, 0, -5.0), Vector3::UnitZ()).empty());
  EXPECT_THROW(FindSection(surface, Vector3(0, 0, 5.1), Vector3::UnitZ()), std::invalid_argument);
  EXPECT_NEAR(CutSurface(surface, Vector3::Zero(), -Vector3::UnitZ())[0].area, 48.0, 1e-12);
}

TEST(SurfaceSection, AHoleHasANegativeArea)
{
  // A torus about z.
  const auto torus =
    test::MarchSurface([](const Vector3 & x) { return std::hypot(std::hypot(x.x(), x.y()) - 20.0, x.z()) - 6.0; },
                       Vector3(-28.1, -28.3, -8.2),
                       Vector3(28.4, 28.2, 8.3),
                       1.7);
  const auto across = CutSurface(torus, Vector3(0, 0, 0.3), Vector3::UnitZ());
  ASSERT_EQ(across.size(), 2u);
  EXPECT_NEAR(across[0].area + across[1].area, M_PI * (26.0 * 26.0 - 14.0 * 14.0), 15.0);
  EXPECT_LT(std::min(across[0].area, across[1].area), -550.0);
  // A plane along the axis cuts two discs; the one asked for is found.
  const auto along = FindSection(torus, Vector3(0.2, 18.0, 0.0), Vector3::UnitX());
  EXPECT_NEAR(along.centroid.y(), 20.0, 0.1);
  EXPECT_NEAR(FindSection(torus, Vector3(0.2, -1.0, 0.0), Vector3::UnitX()).centroid.y(), -20.0, 0.1);
}
} // namespace SurfaceSectionTests
