/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneVectorAnalysis_h
#define boneVectorAnalysis_h

#include "boneExecution.h"
#include "bonePrincipalModes.h"

#include <cstddef>
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
struct AnalysisParameters
{
  double       proportion{ 1.0 }; ///< of the variance that the kept modes explain, 0..1; 1: full rank
  Eigen::Index maximumModes{ 0 }; ///< 0: no limit
  std::size_t  bytes{ 0 };        ///< for vectors and modes; see \ref ModeAccumulator
};

/** Vectors that went before those of a source, known by their model; none by default. */
struct FormerVectors
{
  const PrincipalModes *  modes{ nullptr };
  const Eigen::MatrixXd * scores{ nullptr }; ///< #vectors by #modes, in standard deviations
};

/** Called with vectors and their mean. */
using VectorVisitor = std::function<void(const Eigen::VectorXd & y, const Eigen::VectorXd & mean)>;

/** \brief Principal modes in two passes over a source, and the coefficients of its vectors.
 *
 * The first pass accumulates (\ref ModeAccumulator). The second projects every vector on what was found and takes the
 * modes, variances and scores that are those of the vectors within its span (Rayleigh-Ritz); where nothing had to be
 * left out of memory that is all, and the result exact. Variances are with count - 1 in the denominator; those below
 * 1e-13 of the largest, or whose root is below 1e-11 of the mean's length, are rounding and left out. A mode's largest
 * entry is positive.
 *
 * `weights`, `block`: of the inner product (\ref PrincipalModes), empty for the plain one. `former`: the source's
 * vectors are added to those; the inner product is theirs. `scores`: #count by #k coefficients in standard deviations,
 * the former vectors' first. `visit`: called with every vector of the second pass, and the mean. Throws
 * std::invalid_argument for fewer than two vectors in all. */
PrincipalModes
AnalyzeVectors(const VectorSource &       source,
               const Eigen::VectorXd &    weights,
               const Eigen::MatrixXd &    block,
               const AnalysisParameters & parameters,
               Eigen::MatrixXd &          scores,
               const Execution &          execution = {},
               const FormerVectors &      former = {},
               const VectorVisitor &      visit = nullptr);
} // namespace bone

#endif
