/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneMetricPixels_h
#define boneMetricPixels_h

#include "boneImageGradient.h"
#include "boneRadiographView.h"

#include <array>

namespace bone
{
/** The weights of a metric's pixels: the least weight within `radius` pixels along columns and rows, 0 nearer to the
 * border than that, 0 where a weight is negative or NaN. Throws std::invalid_argument where values or weights are not
 * as many as the view's pixels, or no pixel has a weight above 0. */
std::vector<float>
CountedWeights(const RadiographView & target, int radius);

/** The least box that holds every pixel at which an image is not 0. */
PixelBox
BoxOf(const std::vector<const float *> & images, const std::array<int, 2> & size);

/** Derivatives of one image along columns and rows. */
using GradientComponents = std::array<std::vector<float>, 2>;

/** \class CountedGradient
 * \brief Gradients of images, 0 at pixels of weight 0 even where an image is not finite there. */
class CountedGradient
{
public:
  /** `sigma`: of the Gaussian of which derivatives are taken, pixels. Throws as CountedWeights does. */
  CountedGradient(const RadiographView & target, double sigma);

  /** #pixels, 0 for those whose derivative needs a pixel without weight. */
  const std::vector<float> &
  GetWeights() const
  {
    return m_Weights;
  }
  int
  Radius() const
  {
    return m_Gradient.Radius();
  }
  /** Of the whole image, or of the pixels of a box. */
  GradientComponents
  Apply(const float * image) const;
  GradientComponents
  Apply(const float * image, const PixelBox & box) const;

private:
  std::array<int, 2> m_Size;
  ImageGradient      m_Gradient;
  std::vector<float> m_Weights;
};

/** \class GramSum
 * \brief Sums the products of the columns of tall matrices, a part of their rows at a time. */
class GramSum
{
public:
  explicit GramSum(Eigen::Index columns);

  /** Adds part^T part of the first `rows` rows, summed in single precision. */
  void
  Add(const Eigen::MatrixXf & part, Eigen::Index rows);
  /** #columns by #columns. */
  Eigen::MatrixXd
  Get() const;

private:
  Eigen::MatrixXf m_Product;
  Eigen::MatrixXd m_Sum;
};

/** \struct ShareBlocks
 * \brief The square blocks of pixels to which a metric's gradient is attributed. */
struct ShareBlocks
{
  static constexpr int side = 16; ///< pixels
  int                  columns;
  int                  rows;

  explicit ShareBlocks(const std::array<int, 2> & size)
    : columns((size[0] + side - 1) / side)
    , rows((size[1] + side - 1) / side)
  {}
  Eigen::Index
  GetNumberOfBlocks() const
  {
    return static_cast<Eigen::Index>(columns) * rows;
  }
  Eigen::Index
  BlockOf(int column, int row) const
  {
    return static_cast<Eigen::Index>(row / side) * columns + column / side;
  }
};
} // namespace bone

#endif
