/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneRadiographMetric_h
#define boneRadiographMetric_h

#include "boneRadiographView.h"

#include <memory>
#include <vector>

namespace bone
{
/** \struct MetricValue
 * \brief What a metric says of an image and of its change by #m parameters. */
struct MetricValue
{
  double          cost{ 0.0 };
  Eigen::VectorXd gradient; ///< #m, of the cost
  Eigen::MatrixXd hessian;  ///< #m by #m, the Gauss-Newton matrix, positive semidefinite
  /** #m by #b: the gradient's share of each of #b blocks of the image, whose sum it is. What the shares vary by, over
   * blocks larger than the correlation of the errors, tells the gradient's own error. */
  Eigen::MatrixXd shares;
  /** Blocks in a row of blocks; shares.cols() is a multiple of it. */
  Eigen::Index blocksInRow{ 1 };
};

/** \class RadiographMetric
 * \brief How badly a radiograph of the model agrees with one X-ray; the lower the better.
 *
 * Made of the X-ray once, and asked for many radiographs of the same view. Thread-safe: nothing changes but in the
 * constructor. */
class RadiographMetric
{
public:
  virtual ~RadiographMetric() = default;

  /** The cost of a radiograph (columns x rows, row by row). */
  virtual double
  Evaluate(const float * image) const = 0;

  /** The cost, its gradient and its Gauss-Newton matrix, given the radiograph (images[0]) and its derivatives by the
   * parameters (images[1], images[2], ...). */
  virtual MetricValue
  EvaluateDerivatives(const std::vector<float *> & images) const = 0;
};
} // namespace bone

#endif
