/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef bonePrincipalModes_h
#define bonePrincipalModes_h

#include <Eigen/Core>

#include <cstdint>
#include <vector>

namespace bone
{
/** \struct PrincipalModes
 * \brief A linear Gaussian model of a vector: y = mean + sum over k of b_k sqrt(variance_k) mode_k, b ~ N(0, 1).
 *
 * #d entries, #k modes. Coefficients b are in standard deviations everywhere. The inner product of two vectors is the
 * sum of weight * x * y where weights are given, and the plain one elsewhere; with a block, #b by #b, the sum over runs
 * of #b entries, whose weights are alike, of weight * x^T block y. Modes are orthonormal in it.
 *
 * Functions throw std::invalid_argument where a length does not suit. */
struct PrincipalModes
{
  Eigen::VectorXd mean;                 ///< #d
  Eigen::MatrixXd modes;                ///< #d by #k, orthonormal columns
  Eigen::VectorXd variances;            ///< #k, descending, positive
  Eigen::VectorXd weights;              ///< #d, positive; empty: all 1
  Eigen::MatrixXd block;                ///< #b by #b, symmetric, positive definite; empty: identity. #b divides #d
  double          totalVariance{ 0.0 }; ///< of the training set, kept modes or not

  Eigen::Index
  GetDimension() const
  {
    return mean.size();
  }
  Eigen::Index
  GetNumberOfModes() const
  {
    return variances.size();
  }

  /** The vector of the coefficients; fewer than #k: the rest are 0. */
  Eigen::VectorXd
  Synthesize(const Eigen::VectorXd & coefficients) const;

  /** The vector whose plain inner product with another one is the model's own. */
  Eigen::VectorXd
  Dual(Eigen::VectorXd y) const;

  /** Coefficients of the nearest vector of the model. */
  Eigen::VectorXd
  Project(const Eigen::VectorXd & y) const;

  /** \brief The model given some of the vector's entries: mean, modes and variances of what is left open.
   *
   * Entry entries[i] was observed as values[i] with independent Gaussian errors of standard deviation `noise` > 0, in
   * the vector's units. T. Albrecht et al., "Posterior shape models", doi:10.1016/j.media.2013.05.010. */
  PrincipalModes
  Posterior(const std::vector<Eigen::Index> & entries, const Eigen::VectorXd & values, double noise) const;

  /** Standard deviation of every entry. */
  Eigen::VectorXd
  StandardDeviations() const;
};

/** Each coefficient cut to +-limit: the paper's box, 3 by default (paper 6.2). */
Eigen::VectorXd
ClampToBox(const Eigen::VectorXd & coefficients, double limit = 3.0);

/** Coefficients scaled down, where they are longer, to the radius that holds the given probability of the chi-squared
 * distribution with as many degrees of freedom. 0 < probability < 1, else std::invalid_argument. */
Eigen::VectorXd
ClampToBall(const Eigen::VectorXd & coefficients, double probability = 0.997);

/** The radius of that ball. */
double
ChiRadius(Eigen::Index degreesOfFreedom, double probability);

/** Independent standard normal coefficients, the same for a seed on every machine. */
Eigen::VectorXd
SampleCoefficients(Eigen::Index count, std::uint64_t seed);
} // namespace bone

#endif
