/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneBackgroundSpline_h
#define boneBackgroundSpline_h

#include <Eigen/Core>
#include <array>
#include <vector>

namespace bone
{
/** \class BackgroundSpline
 * \brief Tensor products of uniform cubic B-splines over an image, row by row of its pixels.
 *
 * Knots are `length` pixels apart, the first at pixel 0. Sixteen B-splines differ from 0 at a pixel; they sum to 1. */
class BackgroundSpline
{
public:
  /** The image's columns and rows; `length` > 0, or 0 for no B-splines. */
  BackgroundSpline(const std::array<int, 2> & size, double length);

  Eigen::Index
  GetNumberOfCoefficients() const
  {
    return static_cast<Eigen::Index>(m_Count[0]) * m_Count[1];
  }
  /** Writes a row of the spline: #columns values. Only the first coefficients, one a B-spline, are read. */
  void
  Evaluate(int row, const Eigen::Ref<const Eigen::VectorXd> & coefficients, double * values) const;
  /** Adds the products of a row of values with each B-spline to the first entries of `sums`. */
  void
  AddProducts(int row, const double * values, Eigen::Ref<Eigen::VectorXd> sums) const;
  /** Adds the products of each two B-splines, weighted by a row of weights, to the top left of `sums`, of which only
   * the lower triangle is complete. */
  void
  AddNormalMatrix(int row, const double * weights, Eigen::MatrixXd & sums) const;

private:
  /** The four B-splines that differ from 0 at a pixel, along one axis. */
  struct Support
  {
    int                   first;
    std::array<double, 4> values;
  };
  std::array<std::vector<Support>, 2> m_Supports; ///< of each column, of each row
  std::array<int, 2>                  m_Count{ { 0, 0 } };
};
} // namespace bone

#endif
