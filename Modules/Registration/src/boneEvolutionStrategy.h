/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneEvolutionStrategy_h
#define boneEvolutionStrategy_h

#include <Eigen/Core>

#include <cstdint>

namespace bone
{
/** \class EvolutionStrategy
 * \brief Minimises a function over the box [-1, 1]^#n by covariance matrix adaptation (CMA-ES).
 *
 * N. Hansen, "The CMA evolution strategy: a tutorial", arXiv:1604.00772, with its default weights and rates. Asks for
 * the costs of a population and is told them, so that the population may be evaluated in parallel:
 *
 * \code
 * while (!strategy.IsConverged()) { strategy.Tell(costs of the columns of strategy.Ask()); }
 * \endcode
 *
 * Candidates beyond the box are moved onto it before they are given out, and their distance is added to the cost they
 * are told with, squared. The same seed gives the same candidates on every machine. */
class EvolutionStrategy
{
public:
  /** The mean to start from, #n, and the standard deviation of its first population. */
  EvolutionStrategy(const Eigen::VectorXd & mean, double deviation, Eigen::Index population, std::uint64_t seed);

  /** The next population, #n by #population. */
  const Eigen::MatrixXd &
  Ask();

  /** The costs of the population given last, in its order; NaN counts as infinite. */
  void
  Tell(const Eigen::VectorXd & costs);

  /** Whether the deviations along all axes have become smaller than this. */
  bool
  IsConverged(double deviation) const;

  const Eigen::VectorXd &
  BestCandidate() const
  {
    return m_Best;
  }
  double
  BestCost() const
  {
    return m_BestCost;
  }
  int
  GetGeneration() const
  {
    return m_Generation;
  }

private:
  Eigen::VectorXd m_Mean;
  double          m_Sigma;
  std::uint64_t   m_Seed;
  int             m_Generation{ 0 };
  Eigen::VectorXd m_Weights; ///< of the better half, sum 1
  double          m_Effective;
  Eigen::MatrixXd m_Axes;    ///< columns: principal axes of the covariance
  Eigen::VectorXd m_Lengths; ///< their standard deviations
  Eigen::MatrixXd m_Covariance;
  Eigen::VectorXd m_PathOfSigma;
  Eigen::VectorXd m_PathOfCovariance;
  Eigen::MatrixXd m_Steps;      ///< of the population, in units of sigma
  Eigen::MatrixXd m_Candidates; ///< in the box
  Eigen::VectorXd m_Penalties;
  Eigen::VectorXd m_Best;
  double          m_BestCost;
};
} // namespace bone

#endif
