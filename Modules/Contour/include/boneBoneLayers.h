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

/** \brief Finds the endosteal contours of each piece of bone, and the boundaries of medullary cavities in them.
 *
 * From each point of a periosteal contour, and of the holes in it, a profile of the CT runs inward; the cortex ends
 * where the density falls half-way from its maximum to the level inside. Thickness is filtered along the surface and
 * across slices (median, then Gaussian), and the endosteal contours are where the depth below the periosteal contour
 * equals the thickness of the nearest point: they cannot come nearer than the minimum distance. What they bound is
 * closed and opened with a disk; where opposite cortices meet it falls into several parts, each with a contour. Around
 * a hole it is parted at its narrowest. Contours stay the minimum distance apart and are kept only in chains of slices
 * that last. Medullary boundaries are levels of the smoothed CT inside, treated alike. Returns lines for the report. */
std::vector<std::string>
FindInnerLayers(std::vector<BoneSection> & sections,
                const PlaneSource &        planes,
                const Vector2 &            pixel,
                const LayerParameters &    parameters,
                const ParallelFor &        parallel);
} // namespace bone

#endif
