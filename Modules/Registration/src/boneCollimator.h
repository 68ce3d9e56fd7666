/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneCollimator_h
#define boneCollimator_h

#include "boneRadiographPreprocess.h"

namespace bone
{
/** The straight borders of the exposed field, which may be turned.
 *
 * `exposure` rises with the photons (their logarithm, or display values), row by row, without NaN. The hull of all that
 * is brighter than the shadow is a polygon. A long edge of it is a border of the field if the exposure drops over a few
 * pixels along most of it, and all beyond it is evenly dark. A body that is dark at the image's border has no such
 * edge.
 *
 * Contrasts below `leastContrast` are none. The offsets are good to a 384th of the image's longer side. */
std::vector<CollimatorEdge>
FindCollimator(const std::vector<double> & exposure, const std::array<int, 2> & size, double leastContrast);
} // namespace bone

#endif
