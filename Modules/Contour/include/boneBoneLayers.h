/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneBoneLayers_h
#define boneBoneLayers_h

#include "boneBoneSection.h"
#include "boneLabelField.h"

namespace bone
{
/** The CT in the plane at a height (mm along the normal), at least over the box from `low` to `high` (plane
 * coordinates, mm) as far as the image goes. Safe to call from many threads. */
using PlaneSource = std::function<PlaneField(double height, const Vector2 & low, const Vector2 & high)>;

/** Parameters of \ref FindInnerLayers; lengths in mm, densities in the CT's units (HU). */
struct LayerParameters
{
  int    numberOfLayers{ 3 };        ///< 1 periosteal only, 2 with endosteal, 3 with medullary contours
  double minimumDistance{ 0.8 };     ///< between a contour and the next inside it
  double maximumThickness{ 12.0 };   ///< of the cortex
  double endostealThreshold{ 0.0 };  ///< 0: half-way between the cortical maximum and the level inside, point by point
  double minimumContrast{ 100.0 };   ///< between the two, else the cortex is as thin as may be
  double solidLevel{ 600.0 };        ///< a profile that stays above has no spongy bone at its inner end
  double medullaryThreshold{ 40.0 }; ///< below: medullary cavity
  double smoothing{ 3.0 };           ///< of the cortex's thickness along the surface (standard deviation)
  double smallestArea{ 30.0 };       ///< an inner contour must once reach it (mm^2)
  double smallestRadius{ 1.5 };      ///< radius of the disk that must fit everywhere in an inner contour
  double smallestCavity{ 60.0 };     ///< area that a medullary cavity must once reach (mm^2)
  double minimumLength{ 8.0 };       ///< height over which an endosteal contour must last
  double cavityLength{ 20.0 };       ///< height over which a medullary contour must last
};

/** \brief Finds the endosteal contour of each piece of bone without holes, and the boundary of its medullary cavity.
 *
 * From each point of a periosteal contour a profile of the CT runs inward; the cortex ends where the density falls
 * half-way from its maximum to the level inside. Thickness is filtered along the surface and across slices (median,
 * then Gaussian), and the endosteal contour is where the depth below the periosteal contour equals the thickness of the
 * nearest point: it cannot come nearer than the minimum distance. It is opened and closed with a disk, its largest part
 * kept, and kept only in chains of slices that last. The medullary boundary is a level of the smoothed CT inside it,
 * treated alike. Returns lines for the report. */
std::vector<std::string>
FindInnerLayers(std::vector<BoneSection> & sections,
                const PlaneSource &        planes,
                const Vector2 &            pixel,
                const LayerParameters &    parameters,
                const ParallelFor &        parallel);
} // namespace bone

#endif
