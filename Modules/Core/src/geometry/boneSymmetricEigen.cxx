/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSymmetricEigen.h"

#include <Eigen/Eigenvalues>

namespace bone
{
template <int VSize>
SymmetricEigenOf<VSize>
EigenOf(const Eigen::Matrix<double, VSize, VSize> & symmetric)
{
  if (symmetric.size() == 0)
  {
    return {}; // Eigen's solver reads beyond it
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, VSize, VSize>> eigen(symmetric);
  return { eigen.eigenvalues(), eigen.eigenvectors() };
}

template SymmetricEigenOf<2>
EigenOf(const Eigen::Matrix2d & symmetric);
template SymmetricEigenOf<3>
EigenOf(const Eigen::Matrix3d & symmetric);
template SymmetricEigen
EigenOf(const Eigen::MatrixXd & symmetric);
} // namespace bone
