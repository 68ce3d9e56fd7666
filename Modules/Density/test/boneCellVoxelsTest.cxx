/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCellVoxels.h"

#include "boneDensityTestMeshes.h"

#include <gtest/gtest.h>

namespace CellVoxelsTests
{
using namespace bone;

TEST(CellVoxels, TetrahedraOfABlockShareItsVoxelsOut)
{
  const MeshArrays         mesh = test::MakeBlock({ { 3, 3, 3 } }, Vector3(0.31, 0.27, 0.41), 3.0, 0.2);
  const std::array<int, 3> size = { { 10, 10, 10 } };
  std::vector<int>         owners(1000, 0);
  std::vector<CellVoxel>   voxels;
  for (const Id4 & t : mesh.tetrahedra)
  {
    Eigen::Matrix<double, 3, 4> vertices;
    for (int i = 0; i < 4; ++i)
    {
      vertices.col(i) = mesh.points[t[i]];
    }
    FindCellVoxels(vertices, size, voxels);
    for (const CellVoxel & v : voxels)
    {
      ++owners[(v.index[2] * 10 + v.index[1]) * 10 + v.index[0]];
      EXPECT_LT((vertices * v.mu - Vector3(v.index[0], v.index[1], v.index[2])).norm(), 1e-12);
      EXPECT_NEAR(v.mu.sum(), 1, 1e-12);
    }
  }
  for (int v = 0; v < 1000; ++v)
  {
    const bool inside = v % 10 > 0 && v / 10 % 10 > 0 && v / 100 > 0; // the block ends at 9.3
    EXPECT_EQ(owners[v], inside ? 1 : 0) << v;
  }
}

TEST(CellVoxels, SharedFacesBelongToBothSidesAndFlatTetrahedraHaveNone)
{
  Eigen::Matrix<double, 3, 4> vertices;
  vertices << 0, 2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2;
  std::vector<CellVoxel> voxels;
  FindCellVoxels(vertices, { { 4, 4, 4 } }, voxels);
  EXPECT_EQ(voxels.size(), 10u);
  vertices.col(3) = vertices.col(0);
  FindCellVoxels(vertices, { { 4, 4, 4 } }, voxels);
  EXPECT_TRUE(voxels.empty());
}
} // namespace CellVoxelsTests
