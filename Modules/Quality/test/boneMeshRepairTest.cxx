/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneMeshRepair.h"

#include "boneMeshValidator.h"
#include "boneQualityTestBodies.h"

#include <gtest/gtest.h>

#include <limits>

using namespace bone;

namespace MeshRepairTests
{
constexpr double AllCells = -1.0; // of a cosine: every cell is worse

std::size_t
CountPoints(const TetraComplex & complex, int dimension)
{
  std::size_t count = 0;
  for (IdType p = 0; p < static_cast<IdType>(complex.Points().size()); ++p)
  {
    count += !complex.Star(p).empty() && complex.Dimension(p) == dimension ? 1 : 0;
  }
  return count;
}

std::size_t
RepairAll(MeshRepair & repair)
{
  std::size_t done = 0;
  for (std::size_t before = done + 1; before != done;)
  {
    before = done;
    done += repair.Run(AllCells, [](const std::vector<IdType> &) {});
  }
  return done;
}

TEST(MeshRepair, LooksAgainWhereSomethingHasChangedOrAllIsForgotten)
{
  // Surfaces that may not move keep what a wider bound lets go.
  const auto    mesh = test::MakeBall(4, { 1, 1, 2 }, 12, 0.15, 3);
  TetraComplex  complex(mesh);
  SurfaceTarget first(complex, 0.0, 0);
  SurfaceBound  bound(complex, first, 1e-6);
  PointMover    mover(complex, &bound);
  MeshRepair    repair(complex, mover, 1.0);
  RepairAll(repair);
  bound.SetBound(2.0);
  EXPECT_EQ(RepairAll(repair), 0u) << "where nothing could be done";
  TetraComplex same = complex;
  repair.Forget();
  EXPECT_GT(RepairAll(repair), 0u);
  std::vector<IdType> points, cells;
  const auto          made = complex.Compact(mesh, points, cells);
  EXPECT_TRUE(ValidateMesh(made).IsValid()) << ValidateMesh(made).Summary();

  // Where all points move, if only onto themselves, all is tried again.
  PointMover sameMover(same);
  MeshRepair sameRepair(same, sameMover, 1.0);
  RepairAll(sameRepair);
  const auto none = sameRepair.Run(AllCells, [](const std::vector<IdType> &) {});
  EXPECT_EQ(none, 0u);
  IdType p = 0;
  while (same.Dimension(p) < 3 || same.Star(p).empty())
  {
    ++p;
  }
  const Vector3 x = same.Points()[p];
  const auto    neighbors = same.PointNeighbors(p);
  same.MovePoint(p, x + 0.9 * (same.Points()[neighbors.front()] - x));
  EXPECT_GT(RepairAll(sameRepair), 0u);
}

TEST(MeshRepair, CurvesLoseNoMoreThanTheirBound)
{
  test::TubeShape shape;
  shape.slices = 6;
  const auto  mesh = test::MakeTube(shape);
  std::size_t left[2];
  for (const bool wide : { false, true })
  {
    TetraComplex complex(mesh);
    PointMover   mover(complex);
    MeshRepair   repair(complex, mover, wide ? 100.0 : 1e-9);
    repair.CollapseShort(wide ? 3.0 : std::numeric_limits<double>::max());
    left[wide] = CountPoints(complex, 1);
  }
  EXPECT_EQ(left[0], CountPoints(TetraComplex(mesh), 1));
  EXPECT_LT(left[1], left[0]);
}

TEST(SurfaceBound, ManySmallMovesStayWithinIt)
{
  constexpr double limit = 0.4, step = 0.03;
  const auto       mesh = test::MakeBall(4, { 1, 1, 2 }, 12, 0.1, 1);
  TetraComplex     complex(mesh);
  SurfaceTarget    first(complex, 0.0, 0);
  SurfaceBound     bound(complex, first, limit);
  PointMover       mover(complex, &bound);
  std::size_t      moves = 0, refused = 0;
  for (int round = 0; round < 40; ++round)
  {
    for (IdType p = 0; p < static_cast<IdType>(mesh.points.size()); ++p)
    {
      const bool outer = complex.Dimension(p) == 2 && mesh.points[p].norm() > 11.0;
      // Every third outward, the others along the surface.
      const Vector3 x = complex.Points()[p], out = x.normalized();
      const Vector3 way = p % 3 == 0 ? out : Vector3(out.unitOrthogonal());
      if (outer)
      {
        const auto outcome = mover.TryMove(p, x + step * way, 1.0);
        moves += outcome == MeshOperation::Done;
        refused += outcome == MeshOperation::Distance;
      }
    }
  }
  EXPECT_GT(moves, 1000u);
  EXPECT_GT(refused, 100u);
  // What is bounded are places of the first triangles from the triangles now, and centroids now from the first.
  std::vector<TriangleTree::Triangle> now;
  for (const auto & t : BoundaryFaces(complex))
  {
    const auto & x = complex.Points();
    now.push_back({ x[t[0]], x[t[1]], x[t[2]] });
    const Vector3 centroid = (x[t[0]] + x[t[1]] + x[t[2]]) / 3.0;
    double        nearest = std::numeric_limits<double>::max();
    for (const auto & old : BoundaryFaces(mesh))
    {
      const auto & y = mesh.points;
      nearest =
        std::min(nearest, (ClosestPointOnTriangle(centroid, y[old[0]], y[old[1]], y[old[2]]) - centroid).norm());
    }
    EXPECT_LE(nearest, limit * (1 + 1e-9));
  }
  const TriangleTree tree(std::move(now));
  for (const auto & old : BoundaryFaces(mesh))
  {
    for (IdType p : old)
    {
      EXPECT_LE(tree.FindNearest(mesh.points[p]).squaredDistance, limit * limit * (1 + 1e-9));
    }
  }
}
} // namespace MeshRepairTests
