/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneVectorProduct_h
#define boneVectorProduct_h

#include <Eigen/Core>

namespace bone
{
/** \class VectorProduct
 * \brief The inner product of \ref PrincipalModes, by vectors turned to ones whose plain product it is.
 *
 * `weights`, `block`: as there, empty for the plain product. Throws std::invalid_argument for a block that is not
 * positive definite. */
class VectorProduct
{
public:
  VectorProduct() = default;
  VectorProduct(const Eigen::VectorXd & weights, const Eigen::MatrixXd & block);

  /** Turns the columns, in place. */
  void
  ToPlain(Eigen::Ref<Eigen::MatrixXd> vectors) const;

  /** Turns them back. */
  void
  FromPlain(Eigen::Ref<Eigen::MatrixXd> vectors) const;

private:
  Eigen::VectorXd m_Scale;  ///< roots of the weights
  Eigen::MatrixXd m_Factor; ///< U of block = U^T U
};
} // namespace bone

#endif
