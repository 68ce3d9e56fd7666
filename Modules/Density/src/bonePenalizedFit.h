/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef bonePenalizedFit_h
#define bonePenalizedFit_h

#include "boneOrthonormalBasis.h"

#include <vector>

namespace bone
{
/** \class PenalizedFit
 * \brief Least-squares polynomial through values at any points of a tetrahedron, few or many, held by a penalty.
 *
 * Minimises  sum_v w_v (p(mu_v) - y_v)^2 / total  +  sum_k penalty_k |part of p of degree k|^2  (mean square over the
 * tetrahedron), in the orthonormal basis, where the penalty is diagonal. As each penalty is above 0 the answer is
 * unique for any points, and does not depend on the order of the vertices. Solved by a Cholesky factorisation of as
 * many unknowns as there are points or coefficients, whichever is fewer. Const use is safe from many threads. */
class PenalizedFit
{
public:
  /** One penalty for each degree 0..degree, above 0, else std::invalid_argument. */
  PenalizedFit(int degree, const std::vector<double> & penalties);

  /** `weights` may be null (all 1). Writes the orthonormal coefficients, BernsteinCount(degree). */
  void
  Solve(std::size_t         count,
        const Barycentric * points,
        const double *      values,
        const double *      weights,
        double              total,
        double *            orthonormal) const;

  int
  GetDegree() const
  {
    return m_Degree;
  }

private:
  int            m_Degree;
  Eigen::ArrayXd m_Scale; // 1 / sqrt(penalty) of each coefficient
};
} // namespace bone

#endif
