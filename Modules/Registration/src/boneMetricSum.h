/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneMetricSum_h
#define boneMetricSum_h

#include "boneRadiographMetric.h"

#include <array>

namespace bone
{
/** \struct MetricSum
 * \brief A metric's cost over all views, and how far its gradient may be off. */
struct MetricSum
{
  double          cost{ 0.0 };
  Eigen::VectorXd gradient;
  Eigen::MatrixXd hessian;
  /** Covariance of the gradient from the scatter of its shares, of blocks alone, of two by two and of four by four. */
  std::array<Eigen::MatrixXd, 3> scatters;

  /** Nothing yet, of so many parameters. */
  explicit MetricSum(Eigen::Index parameters);

  /** Adds what a metric says of one view, times `share`. */
  void
  Add(const MetricValue & value, double share);

  /** The same without one of the parameters. */
  MetricSum
  Without(Eigen::Index parameter) const;

  /** By how much the cost has to count for its curvature to agree with the scatter: the least of those that the three
   * sizes of blocks give, as errors may correlate over more than one. 0 where no parameter changes the cost. */
  double
  EstimatePrecision() const;
};
} // namespace bone

#endif
