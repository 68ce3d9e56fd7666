/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneIntensityDifference_h
#define boneIntensityDifference_h

#include "boneRadiographMetric.h"

namespace bone
{
/** \struct IntensityDifferenceParameters
 * \brief The noise of the X-ray, and what is fitted to it besides the radiograph. */
struct IntensityDifferenceParameters
{
  double scale{ 0.05 };              ///< standard deviation of a pixel's noise, in the line integrals' unit
  double huberThreshold{ 1.5 };      ///< in scales; infinite: least squares
  double knotSpacing{ 32.0 };        ///< of the background's B-splines, pixels, 4 or more; 0: no background
  double backgroundDeviation{ 1e3 }; ///< prior standard deviation of the background's coefficients about 0, in scales
  double gainDeviation{ 0.0 };       ///< prior standard deviation of the gain about 1; 0: the gain is 1
};

/** \class IntensityDifference
 * \brief Robust difference of line integrals, less a smooth background.
 *
 * With the X-ray's line integrals t, the radiograph g, weights w and scale s the cost is
 * \verbatim
   min over beta, gamma of
   [ sum_i w_i rho((t_i - gamma g_i - (B beta)_i) / s) + sum_k beta_k^2 / (2 (s d)^2) + (gamma - 1)^2 / (2 e^2) ]
   / sum_i w_i
   \endverbatim
 * where rho is Huber's loss (half the square up to the threshold, then linear), B the background's tensor
 * products of cubic B-splines, d and e the prior deviations of background and gain. The minimum is convex in
 * background and gain, and found by Newton's method with iteratively reweighted least squares where that fails. The
 * background takes up soft tissue, scatter and an unknown I0. The gradient is that at the minimum (envelope
 * theorem). The Gauss-Newton matrix is the Schur complement over background and gain, with Huber's weights.
 *
 * The shares of the gradient are of blocks of 16 pixels, with the parameters' images less what background and gain
 * take up of them; the priors' part goes to the blocks by their weights.
 *
 * Pixels of weight 0 are not read. Where the radiograph or a derivative is not finite at other pixels, neither is the
 * result.
 *
 * After P. J. Huber, "Robust estimation of a location parameter", doi:10.1214/aoms/1177703732. */
class IntensityDifference : public RadiographMetric
{
public:
  /** Throws std::invalid_argument where a parameter is out of range, values or weights are not as many as pixels, no
   * pixel has a weight above 0, or a value is not finite where the weight is above 0. */
  explicit IntensityDifference(const RadiographView & target, const IntensityDifferenceParameters & parameters = {});
  ~IntensityDifference() override;

  double
  Evaluate(const float * image) const override;
  MetricValue
  EvaluateDerivatives(const std::vector<float *> & images) const override;

  /** t - gain g - background at the minimum, row by row, in the line integrals' unit; 0 where the weight is 0. */
  std::vector<float>
  Residuals(const float * image) const;
  /** The residuals' robust standard deviation: 1.4826 times the median of their magnitudes, over pixels whose weight
   * is above 0. */
  double
  EstimateScale(const float * image) const;
  /** The gain at the minimum. */
  double
  GetGain(const float * image) const;

private:
  struct Data;
  std::unique_ptr<const Data> m_Data;
};
} // namespace bone

#endif
