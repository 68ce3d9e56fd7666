/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSideKeeper.h"

#include "boneMeshValidator.h"
#include "boneQualityTestBodies.h"
#include "boneTriangleDistance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

using namespace bone;

namespace SideKeeperTests
{
constexpr double Radius = 12.0;

TriangleDistance
DistanceTo(const MeshArrays & mesh)
{
  return { mesh.points, BoundaryFaces(mesh) };
}

/** Centres at triangles of a rod's side, up to `depth` off them, each said to be where it is not. */
LabelOutline
WrongVoxels(const MeshArrays & mesh, double depth, unsigned int seed)
{
  std::mt19937                           random(seed);
  std::uniform_real_distribution<double> share(0.2, 0.4), offset(-depth, depth);
  LabelOutline                           outline;
  outline.spacing = 1.0;
  int skip = 0;
  for (const auto & f : BoundaryFaces(mesh))
  {
    const Vector3 &a = mesh.points[f[0]], &b = mesh.points[f[1]], &c = mesh.points[f[2]];
    const Vector3  normal = (b - a).cross(c - a).normalized();
    // Few, so that no two ask for the same points.
    if (std::abs(normal.z()) < 0.5 && ++skip % 23 == 0)
    {
      const double u = share(random), v = share(random), d = offset(random);
      outline.voxels.push_back({ a + u * (b - a) + v * (c - a) + d * normal, d > 0 });
    }
  }
  return outline;
}

std::size_t
CountWrong(const MeshArrays & mesh, const LabelOutline & outline)
{
  const auto  distance = DistanceTo(mesh);
  std::size_t wrong = 0;
  for (const auto & voxel : outline.voxels)
  {
    wrong += (distance.FindNearest(voxel.centre).distance < 0) != voxel.inside;
  }
  return wrong;
}

MeshArrays
Restored(const MeshArrays & mesh, const LabelOutline & outline)
{
  TetraComplex           complex(mesh);
  PointMover             mover(complex);
  SideKeeper::Parameters parameters;
  std::vector<IdType>    points, cells;
  SideKeeper(outline).Restore(complex, mover, parameters);
  return complex.Compact(mesh, points, cells);
}

TEST(SideKeeper, PutsCentresOnTheirSideWhereLittleIsMissing)
{
  const MeshArrays mesh = test::StraightRod(Radius);
  for (unsigned int seed = 1; seed <= 5; ++seed)
  {
    const LabelOutline outline = WrongVoxels(mesh, 0.059, seed);
    ASSERT_GT(outline.voxels.size(), 10u);
    EXPECT_EQ(CountWrong(mesh, outline), outline.voxels.size());
    const MeshArrays made = Restored(mesh, outline);
    EXPECT_EQ(CountWrong(made, outline), 0u) << seed;
    EXPECT_TRUE(ValidateMesh(made).IsValid()) << ValidateMesh(made).Summary();
    for (std::size_t p = 0; p < mesh.points.size(); ++p)
    {
      EXPECT_LT((made.points[p] - mesh.points[p]).norm(), 0.2);
      EXPECT_TRUE(std::abs(mesh.points[p].z() - 11.0) < 10.9 || made.points[p] == mesh.points[p]) << "of a flat end";
    }
  }
}

TEST(SideKeeper, LeavesWhatIsRightAndWhatIsFarOff)
{
  const MeshArrays mesh = test::StraightRod(Radius);
  LabelOutline     right = WrongVoxels(mesh, 0.059, 7), far = WrongVoxels(mesh, 1.0, 7);
  for (auto & voxel : right.voxels)
  {
    voxel.inside = !voxel.inside;
  }
  const auto   distance = DistanceTo(mesh);
  LabelOutline kept = far;
  kept.voxels.clear();
  for (const auto & voxel : far.voxels)
  {
    if (std::abs(distance.FindNearest(voxel.centre).distance) > 0.061)
    {
      kept.voxels.push_back(voxel);
    }
  }
  ASSERT_GT(kept.voxels.size(), 10u);
  EXPECT_EQ(Restored(mesh, right).points, mesh.points);
  EXPECT_EQ(Restored(mesh, kept).points, mesh.points);
  EXPECT_EQ(Restored(mesh, LabelOutline()).points, mesh.points);
}
} // namespace SideKeeperTests
