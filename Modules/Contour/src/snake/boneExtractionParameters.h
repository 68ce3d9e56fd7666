/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneExtractionParameters_h
#define boneExtractionParameters_h

#include "boneContourExtraction.h"

#include <algorithm>

namespace bone
{
/** The filter's parameters with the values that 0 stands for, and what is fixed; lengths in mm, densities in HU. */
struct ExtractionParameters : SnakeContourParameters
{
  explicit ExtractionParameters(const SnakeContourParameters & parameters = {}, double pixel = 0.0, double step = 1.0)
    : SnakeContourParameters(parameters)
    , followStep(step)
  {
    refineDistance = refineDistance > 0.0 ? refineDistance : 0.5 * pixel;
    minimumLayerDistance = minimumLayerDistance > 0.0 ? minimumLayerDistance : std::max(LeastLayerDistance, pixel);
  }

  double followStep;                ///< slices further apart are followed on planes between them too
  double edgeSmoothing{ 0.0 };      ///< Gaussian on the CT before edges are sought; 0: 0.5 pixel
  double minimumVolume{ 60.0 };     ///< of a body apart from the rest
  double thicknessSmoothing{ 3.0 }; ///< of the cortex's thickness along the surface (standard deviation)
  double smallestArea{ 30.0 };      ///< an inner contour must once reach it (mm^2)
  double smallestRadius{ 1.5 };     ///< radius of the disk that must fit everywhere in an inner contour
  double smallestCavity{ 60.0 };    ///< area that a medullary cavity must once reach (mm^2)
  double minimumLength{ 8.0 };      ///< height over which an endosteal contour must last
  double cavityLength{ 20.0 };      ///< height over which a medullary contour must last
};
} // namespace bone

#endif
