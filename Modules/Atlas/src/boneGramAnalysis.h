/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneGramAnalysis_h
#define boneGramAnalysis_h

#include "boneExecution.h"
#include "bonePrincipalModes.h"
#include "boneStatisticalModelParameters.h"

#include <functional>

namespace bone
{
/** Many vectors of one length that need not be in memory at once. */
struct VectorSource
{
  Eigen::Index count{ 0 };
  Eigen::Index dimension{ 0 };
  /** Writes vector i to y[0..dimension). Called in ascending order within a pass, from one thread. */
  std::function<void(Eigen::Index i, double * y)> load;
};

/** How many modes are kept, and the memory for it. */
struct GramParameters
{
  double       proportion{ 1.0 }; ///< of the variance that the kept modes explain, 0..1; 1: full rank
  Eigen::Index maximumModes{ 0 }; ///< 0: no limit
  std::size_t  blockBytes{
    StatisticalModelParameters().blockBytes
  }; ///< for vectors held at once; twice as little reads them more often
};

/** \brief Principal modes by the eigenvectors of the #count by #count matrix of inner products (Gram matrix), in
 * double.
 *
 * Reads the source once for the mean, (1 + blocks) / 2 times for the inner products and once for the modes; vectors in
 * memory: blockBytes, then the modes. Eigenvalues are with count - 1 in the denominator; those below 1e-13 of the
 * largest, or whose root is below 1e-11 of the mean's length, are rounding and left out. A mode's largest entry is positive. The modes are made orthonormal to rounding by
 * one Cholesky-QR step. The result is the same for any number of threads.
 *
 * `weights`, `block`: of the inner product (\ref PrincipalModes), empty for the plain one. `scores`: #count by #k
 * coefficients in standard deviations. Throws std::invalid_argument for fewer than two vectors. */
PrincipalModes
AnalyzeVectors(const VectorSource &    source,
               const Eigen::VectorXd & weights,
               const Eigen::MatrixXd & block,
               const GramParameters &  parameters,
               Eigen::MatrixXd *       scores = nullptr,
               const Execution &       execution = {});
} // namespace bone

#endif
