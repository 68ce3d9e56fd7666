/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneSymmetricEigen_h
#define boneSymmetricEigen_h

#include <Eigen/Core>

namespace bone
{
/** Eigenvalues of a symmetric matrix, ascending, and its eigenvectors as columns. */
struct SymmetricEigen
{
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};

/** By Eigen's SelfAdjointEigenSolver, which is compiled here alone. */
SymmetricEigen
EigenOf(const Eigen::MatrixXd & symmetric);
} // namespace bone

#endif
