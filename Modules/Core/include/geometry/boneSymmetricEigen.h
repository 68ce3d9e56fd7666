/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneSymmetricEigen_h
#define boneSymmetricEigen_h

#include <Eigen/Core>

namespace bone
{
/** Eigenvalues of a symmetric matrix, ascending, and its eigenvectors as columns. */
template <int VSize>
struct SymmetricEigenOf
{
  Eigen::Matrix<double, VSize, 1>     values;
  Eigen::Matrix<double, VSize, VSize> vectors;
};
using SymmetricEigen = SymmetricEigenOf<Eigen::Dynamic>;

/** By Eigen's SelfAdjointEigenSolver, which is compiled here alone; it reads the lower triangle. A matrix without
 * entries has none. */
template <int VSize>
SymmetricEigenOf<VSize>
EigenOf(const Eigen::Matrix<double, VSize, VSize> & symmetric);
} // namespace bone

#endif
