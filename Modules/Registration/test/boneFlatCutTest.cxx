/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneFlatCut.h"

#include "boneRadiographTestMeshes.h"

#include <gtest/gtest.h>

namespace FlatCutTests
{
using namespace bone;

/** A shaft of radius 20 mm from z = 0 to `length`, whose upper end is a hemisphere where `round`. */
MeshArrays
Shaft(bool round)
{
  constexpr int n = 8;
  MeshArrays    mesh = test::GridMesh({ { n, n, 12 } }, Vector3(-1, -1, 0), Vector3(2.0 / n, 2.0 / n, 5.0));
  for (Vector3 & p : mesh.points)
  {
    // From squares to circles.
    const double norm = std::hypot(p.x(), p.y());
    const double scale = norm > 0.0 ? 20.0 * std::max(std::abs(p.x()), std::abs(p.y())) / norm : 0.0;
    p.x() *= scale;
    p.y() *= scale;
    if (round && p.z() > 20.0)
    {
      const double share = (p.z() - 20.0) / 40.0; // the top becomes a dome
      p.z() = 20.0 + share * (20.0 + std::sqrt(std::max(0.0, 400.0 - p.x() * p.x() - p.y() * p.y())));
    }
  }
  test::SetConstant(mesh, 1000.0);
  return mesh;
}

TEST(FlatCut, AreTheFlatEndsOfAShaft)
{
  const auto cuts = FindFlatCuts(Shaft(false));
  ASSERT_EQ(cuts.size(), 2u);
  for (const FlatCut & cut : cuts)
  {
    EXPECT_NEAR(std::abs(cut.inward.z()), 1.0, 1e-9);
    EXPECT_NEAR(cut.offset, cut.inward.z() > 0.0 ? 0.0 : -60.0, 1e-9);
  }
}

TEST(FlatCut, ARoundEndIsNone)
{
  const auto cuts = FindFlatCuts(Shaft(true));
  ASSERT_EQ(cuts.size(), 1u);
  EXPECT_NEAR(cuts[0].inward.z(), 1.0, 1e-9);
}

TEST(FlatCut, HasMoreThanHalfOfTheSectionBeneathIt)
{
  // The last 5 mm narrow to this share of the radius: the end has 0.44 and 0.57 of the mean section of 10 mm.
  for (const double share : { 0.6, 0.7 })
  {
    MeshArrays mesh = Shaft(false);
    for (Vector3 & p : mesh.points)
    {
      if (p.z() > 59.9)
      {
        p.head<2>() *= share;
      }
    }
    EXPECT_EQ(FindFlatCuts(mesh).size(), share > 0.65 ? 2u : 1u) << share;
  }
}

TEST(FlatCut, DensityFadesTowardsIt)
{
  MeshArrays mesh = Shaft(true);
  // Degree 1 can hold what fades linearly.
  test::SetPowers(mesh, [](std::size_t) { return 1; }, { test::Affine{ 1000.0, Vector3::Zero() } });
  FadeToCuts(mesh, FindFlatCuts(mesh), 20.0);
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
  {
    for (std::size_t v = 0; v < 4; ++v)
    {
      const double z = mesh.points[static_cast<std::size_t>(mesh.tetrahedra[t][v])].z();
      EXPECT_NEAR(mesh.coefficients[4 * t + v], 1000.0 * std::min(1.0, z / 20.0), 1e-9);
    }
  }
}
} // namespace FlatCutTests
