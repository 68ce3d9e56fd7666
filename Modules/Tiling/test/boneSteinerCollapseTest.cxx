/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSteinerCollapse.h"

#include "../../Core/test/boneTestBodies.h"

#include <gtest/gtest.h>

namespace SteinerCollapseTests
{
using namespace bone;

constexpr IdType Below = 0, Above = 1, Top = 2, Rim = 3;

/** Cells left of twelve around a hill of six faces, 4 mm wide, between bone and what is outside, whose top and rim are
 * Steiner points at their ideal places. */
std::size_t
CellsLeft(double height, double tolerance)
{
  MeshArrays            mesh;
  tiling::SteinerPlaces places;
  mesh.points = { { 0, 0, -3 }, { 0, 0, height + 3 }, { 0, 0, height } };
  for (IdType i = 0; i < 6; ++i)
  {
    const double angle = i * std::acos(-1.0) / 3;
    const IdType a = Rim + i, b = Rim + (i + 1) % 6;
    mesh.points.push_back({ 2 * std::cos(angle), 2 * std::sin(angle), 0 });
    places.faces.push_back({ { Top, a, b } });
    mesh.tetrahedra.push_back({ Top, Below, a, b });
    mesh.region.push_back(1);
    mesh.tetrahedra.push_back({ Top, Above, a, b });
    mesh.region.push_back(0);
  }
  test::MakePositive(mesh);
  places.ideal.assign(mesh.points.begin() + Top, mesh.points.end());
  places.tolerance = tolerance;
  return tiling::CollapseSteinerPoints(mesh, Top, places, Execution()).tetrahedra.size();
}

TEST(CollapseSteinerPoints, SurfacesThatBendMoreThanTheToleranceStay)
{
  EXPECT_EQ(CellsLeft(2.0, 0.05), 12u);
  EXPECT_LT(CellsLeft(2.0, 10.0), 12u);
}

TEST(CollapseSteinerPoints, PointsOfAFlatSurfaceAreTakenAway)
{
  EXPECT_LT(CellsLeft(0.0, 0.05), 12u);
}
} // namespace SteinerCollapseTests
