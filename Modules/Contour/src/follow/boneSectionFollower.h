/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneSectionFollower_h
#define boneSectionFollower_h

#include "boneBodyLabels.h"
#include "boneContourExtraction.h"
#include "boneSection.h"

#include <string>
#include <vector>

namespace bone
{
/** Parameters of \ref SectionFollower; lengths in mm, densities in the CT's units (HU). */
struct FollowParameters : BodyRules
{
  double smoothing{ 0.0 };    ///< Gaussian on the CT, standard deviation; 0: 0.55 pixel
  double valleyDepth{ 0.2 };  ///< a contact of less mean depth, as a share of its sides' height, is bone throughout
  double contactWidth{ 4.0 }; ///< and joins two pieces where it is at least so long
  double contactArea{ 8.0 };  ///< and such contact exceeds that with a valley, along the bone so far, by that area
  double suddenArea{ 150.0 }; ///< changes of a slice's area above it and by half are reported, mm^2
  double lookAhead{ 6.0 };    ///< how far beyond an end bone is looked for, to report a gap
};

/** \class SectionFollower
 * \brief The region term of the following: which part of each slice belongs to the bone that was drawn on some of them
 * (paper 2.1: each slice starts from the one before).
 *
 * Every piece of bone on a slice (above the threshold, with what its cortex encloses) that lies over a body of the
 * slice before continues that body; one over none begins a new body; one over several is parted between them by
 * flooding from the bodies' places on the slice before, brightest first (marker watershed, S. Beucher, F. Meyer, 1993),
 * which draws the border along a joint's dark line. So bones in contact stay apart, a section may widen by many pixels
 * from one slice to the next, and pieces split by themselves. Two bodies become one where their contact is bone
 * throughout, without a valley, over some width and height, and over more than it was not; what then belongs to the
 * drawn bone does so on all slices, also where it had not yet joined it. Enclosed regions are bone's where they were
 * inside on the slice before, else holes.
 *
 * Bones of slices that were drawn are as drawn. Runs go from each drawn slice half-way to the next and to the bone's
 * ends. */
class SectionFollower
{
public:
  SectionFollower(const PlaneSource & planes, const Vector2 & pixel, const FollowParameters & parameters);

  /** Replaces the pieces of all sections but the drawn ones (those with pieces) by the outlines of the bone there,
   * which are accurate to about a pixel. `spacing`: slices further apart than that (mm) are followed on planes between
   * them too. Returns what happened at each section, events separated by
   * semicolons. */
  std::vector<std::string>
  Follow(std::vector<Section> & sections, double spacing, const Execution & execution) const;

private:
  const PlaneSource & m_Planes;
  Vector2             m_Pixel;
  FollowParameters    m_Parameters;
};
} // namespace bone

#endif
