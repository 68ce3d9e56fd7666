/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneGradientOrientation_h
#define boneGradientOrientation_h

#include "boneRadiographMetric.h"

namespace bone
{
/** \class GradientOrientation
 * \brief Agreement of the gradients' directions, whatever their magnitudes.
 *
 * The gradients f of the X-ray and g of the radiograph (two components a pixel) are divided by their magnitudes, with
 * soft thresholds below which they fade to 0:
 * \verbatim
   u_f = f / sqrt(|f|^2 + e_f^2),   e_f^2 = kappa^2 mean(|f|^2)
   u_g = g / sqrt(|g|^2 + e_g^2),   e_g^2 = kappa^2 mean(|g|^2)
   \endverbatim
 * with weighted means over the pixels that count, and the relative threshold kappa. The cost is
 * \verbatim
   1 - (sum_i w_i u_f,i . u_g,i) / sqrt(sum_i w_i |u_f,i|^2 sum_i w_i |u_g,i|^2)
   \endverbatim
 * 0 for equal images, about 1 for images that have nothing to do with each other and for a constant radiograph, 2 for
 * opposite ones. A pixel whose gradients are both far above the thresholds contributes the cosine of the angle between
 * them. So strong edges of one image alone (implants, instruments) count no more than others. The cost does not change
 * when either image is multiplied by a positive factor or shifted by a constant; a rising function of the X-ray's
 * values keeps the directions and changes only which pixels are above the threshold.
 *
 * The Gauss-Newton matrix is that of the difference of the two unit vectors (all pixels' u, weighted and normalised),
 * times their likeness 1 - cost, 0.1 at the least. The shares of the gradient are of blocks of 16 pixels.
 *
 * Pixels of weight 0 are not read. After T. De Silva et al., "3D-2D image registration for target localization in
 * spine surgery: investigation of similarity metrics providing robustness to content mismatch",
 * doi:10.1088/0031-9155/61/8/3009 (gradient orientation), with soft thresholds and cosines in place of hard thresholds
 * and logarithms of angles. */
class GradientOrientation : public RadiographMetric
{
public:
  /** `sigma`: of the Gaussian of which derivatives are taken, pixels. `threshold`: of gradients, relative to the root
   * mean square of their magnitudes. A pixel counts where all that its derivative needs has a weight above 0. Throws
   * std::invalid_argument where sigma or threshold is not positive and finite, values or weights are not as many as
   * pixels, no pixel counts, or the X-ray is constant or not finite where they count. */
  GradientOrientation(const RadiographView & target, double sigma, double threshold = 0.5);
  ~GradientOrientation() override;

  double
  Evaluate(const float * image) const override;
  MetricValue
  EvaluateDerivatives(const std::vector<float *> & images) const override;

private:
  struct Data;
  std::unique_ptr<const Data> m_Data;
};
} // namespace bone

#endif
