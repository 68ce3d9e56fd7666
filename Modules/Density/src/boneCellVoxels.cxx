/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCellVoxels.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace bone
{
void
FindCellVoxels(const Eigen::Matrix<double, 3, 4> & vertices,
               const std::array<int, 3> &          size,
               std::vector<CellVoxel> &            voxels)
{
  constexpr double hair = 1e-10; // of barycentric coordinates: a centre on a face belongs to both sides
  voxels.clear();
  const Vector3         lower = vertices.rowwise().minCoeff(), upper = vertices.rowwise().maxCoeff();
  const Eigen::Matrix3d edges = vertices.rightCols<3>().colwise() - vertices.col(0);
  if (edges.determinant() == 0)
  {
    return;
  }
  const Eigen::Matrix3d inverse = edges.inverse();
  const auto            first = [&](int axis) { return std::max(static_cast<int>(std::ceil(lower[axis] - 1e-9)), 0); };
  const auto            last = [&](int axis) {
    return std::min(static_cast<int>(std::floor(upper[axis] + 1e-9)), size[axis] - 1);
  };
  for (int k = first(2); k <= last(2); ++k)
  {
    for (int j = first(1); j <= last(1); ++j)
    {
      const Vector3     at = inverse * (Vector3(0, j, k) - vertices.col(0));
      const Barycentric start(1 - at.sum(), at[0], at[1], at[2]);
      const Barycentric step(-inverse.col(0).sum(), inverse(0, 0), inverse(1, 0), inverse(2, 0));
      for (int i = first(0); i <= last(0); ++i)
      {
        const Barycentric mu = start + i * step;
        if (mu.minCoeff() >= -hair)
        {
          voxels.push_back({ { { i, j, k } }, mu });
        }
      }
    }
  }
}
} // namespace bone
