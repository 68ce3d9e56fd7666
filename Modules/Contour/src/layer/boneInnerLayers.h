/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneInnerLayers_h
#define boneInnerLayers_h

#include "boneExtractionParameters.h"
#include "boneSection.h"

namespace bone
{
/** \brief Finds the endosteal contours of each piece of bone, and the boundaries of medullary cavities in them.
 *
 * From each point of a periosteal contour, and of the holes in it, a profile of the CT runs inward; the cortex ends
 * where the density falls half-way from its maximum to the level inside. Thickness is filtered along the surface and
 * across slices (median, then Gaussian), and the endosteal contours are where the depth below the periosteal contour
 * equals the thickness of the nearest point: they cannot come nearer than the minimum distance. What they bound is
 * closed and opened with a disk; where opposite cortices meet it falls into several parts, each with a contour. Around
 * a hole it is cut at its narrowest place. Contours stay the minimum distance apart and are kept only in chains of
 * slices that last. Medullary boundaries are levels of the smoothed CT inside, treated alike. Returns lines for the
 * report. */
std::vector<std::string>
FindInnerLayers(std::vector<Section> &       sections,
                const PlaneSource &          planes,
                const Vector2 &              pixel,
                const ExtractionParameters & parameters,
                const Execution &            execution);
} // namespace bone

#endif
