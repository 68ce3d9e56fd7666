/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSymmetricEigen.h"

#include <Eigen/Eigenvalues>

namespace bone
{
SymmetricEigen
EigenOf(const Eigen::MatrixXd & symmetric)
{
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(symmetric);
  return { eigen.eigenvalues(), eigen.eigenvectors() };
}
} // namespace bone
