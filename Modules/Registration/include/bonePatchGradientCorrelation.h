/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef bonePatchGradientCorrelation_h
#define bonePatchGradientCorrelation_h

#include "boneRadiographMetric.h"

namespace bone
{
/** \class PatchGradientCorrelation
 * \brief Correlation of image gradients, patch by patch.
 *
 * f and g are the gradients (two components a pixel) of X-ray and radiograph in a patch, less their means there. The
 * cost is
 * \verbatim
   1 - (sum_p f_p . g_p / |f_p|) / sum_p |g_p|
   \endverbatim
 * 0 where they agree up to a factor of each patch, 1 where they have nothing in common, 2 at the most. A patch counts
 * by what the model shows there, whatever the X-ray's contrast: soft tissue and scatter change slowly over a patch and
 * so change the cost little, where correlation over the whole image has its minimum elsewhere. Patches overlap by half.
 *
 * After G. P. Penney et al., "A comparison of similarity measures for use in 2-D-3-D medical image registration",
 * doi:10.1109/42.730403 (gradient correlation), and R. B. Grupp et al., doi:10.1007/s11548-020-02162-7 (by patches). */
class PatchGradientCorrelation : public RadiographMetric
{
public:
  /** `patch`: side in pixels, 4 or more. `sigma`: of the Gaussian of which derivatives are taken, pixels. A pixel
   * counts where all that its derivative needs has a weight above 0. Throws std::invalid_argument where no pixel
   * counts, or the X-ray is constant where they count. */
  PatchGradientCorrelation(const RadiographView & target, int patch, double sigma);
  ~PatchGradientCorrelation() override;

  double
  Evaluate(const float * image) const override;
  MetricValue
  EvaluateDerivatives(const std::vector<float *> & images) const override;

  /** Each pixel's share of 1 - cost, for pictures: the patches' correlations f . g / |f| |g|, spread over their pixels
   * by |g|. */
  std::vector<float>
  Correlations(const float * image) const;

private:
  struct Data;
  std::unique_ptr<const Data> m_Data;
};
} // namespace bone

#endif
