/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneRadiographPreprocess_h
#define boneRadiographPreprocess_h

#include "boneRadiographPreprocessParameters.h"
#include "boneScatter.h"

#include <cstdint>

namespace bone
{
/** A straight border of the exposed field: what lies beyond normal . (column, row) = offset is in the collimator's
 * shadow. */
struct CollimatorEdge
{
  Vector2 normal{ 1, 0 };
  double  offset{ 0.0 };
};

/** What was found in a radiograph and done to it. */
struct RadiographPreprocessReport
{
  double openBeam{ 0.0 };            ///< I0; 0 for display values
  bool   openBeamEstimated{ false }; ///< from the image, not given
  /** Of the field's pixels that lie within 5 % of I0. Where it is small and I0 was estimated, the image shows no air:
   * line integrals are then too small by that of the thinnest place. */
  double                      airShare{ 0.0 };
  std::vector<CollimatorEdge> collimator;
  std::size_t                 notFinite{ 0 };
  std::size_t                 deadPixels{ 0 };
  std::size_t                 saturated{ 0 };          ///< at or above I0, at zero, or at an end of the display's range
  double                      usedShare{ 0.0 };        ///< of all pixels, those with a weight above 0
  double                      scatterToPrimary{ 0.0 }; ///< median over pixels with a weight
  int                         scatterIterations{ 0 };
  bool                        monotoneOnly{ false }; ///< values rise with attenuation and mean no more
};

struct PreprocessedRadiograph
{
  std::vector<float>         integrals;
  std::vector<float>         weights;
  RadiographPreprocessReport report;
};

/** The kernel of RadiographPreprocessFilter: pixels row by row; `mask` is empty or has a byte a pixel, 0 where it is
 * not used. Throws std::invalid_argument with the reason where the radiograph is of no use. */
PreprocessedRadiograph
PreprocessRadiograph(std::vector<double>                    pixels,
                     const std::vector<std::uint8_t> &      mask,
                     const DetectorGrid &                   grid,
                     const RadiographPreprocessParameters & parameters,
                     const Execution &                      execution);
} // namespace bone

#endif
