/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneSmoothModes_h
#define boneSmoothModes_h

#include "bonePrincipalModes.h"
#include "boneTypes.h"

#include <vector>

namespace bone
{
/** \brief Modes of a smooth random displacement field: the leading ones of a Gaussian process.
 *
 * Each component of the displacement of a point is Gaussian with standard deviation `deviation` (mm), independent of
 * the others, and correlates with that of a point d mm away by exp(-d^2 / (2 length^2)). What the principal modes of a
 * few subjects leave out of a new one is about that. The result is of (x1, y1, z1, x2, ...), mean 0, in mm; modes come
 * in threes (x, y, z) of one variance. `modes` of them at the most, fewer where the rest has less than a
 * ten-thousandth of the variance. The field is reduced by a pivoted Cholesky factorisation, which never holds more
 * than a few columns of the covariance.
 *
 * M. Luethi et al., "Gaussian process morphable models", doi:10.1109/TPAMI.2017.2739743. Throws std::invalid_argument
 * where deviation or length are not positive and finite, or modes is negative. */
PrincipalModes
SmoothModes(const std::vector<Vector3> & points, double deviation, double length, int modes);
} // namespace bone

#endif
