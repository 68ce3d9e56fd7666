/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneHemipelvisMeasures_h
#define boneHemipelvisMeasures_h

#include "boneLandmarkIO.h"
#include "boneMeasure.h"
#include "bonePrimitiveFit.h"
#include "boneTriangleSurface.h"

#include <optional>

namespace bone
{
/** Axes of the pelvis, unit vectors at right angles, by the anterior pelvic plane. */
struct PelvicFrame
{
  Vector3 left{ Vector3::UnitX() };      ///< transverse axis, to the patient's left
  Vector3 up{ Vector3::UnitZ() };        ///< longitudinal axis, in the anterior pelvic plane
  Vector3 anterior{ -Vector3::UnitY() }; ///< normal of the anterior pelvic plane
  bool    byLandmarks{ false }; ///< the transverse axis is that of landmarks; else it is the x axis of LPS space
};

/** \struct HemipelvisGeometry
 * \brief Primitives fitted to a hemipelvis, in its own space; what could not be fitted is left empty and has its
 * reason. */
struct HemipelvisGeometry
{
  std::optional<FittedSphere> acetabulum;
  std::optional<FittedPlane>  rim; ///< normal: out of the acetabulum
  std::optional<PelvicFrame>  frame;
  std::string                 acetabulumReason;
  std::string                 rimReason;
  std::string                 frameReason;
};

/** Names of the landmarks that a hemipelvis' measures start from. */
const std::vector<std::string> &
HemipelvisLandmarkNames();

/** \brief Fits a hemipelvis' primitives from landmarks.
 *
 * | landmark | where |
 * |---|---|
 * | `acetabulum` | near the centre of the acetabulum's sphere, within a third of its radius: a seed |
 * | `asis` | anterior superior iliac spine |
 * | `pubic_tubercle` | pubic tubercle |
 * | `asis_left`, `asis_right` | those of both sides, for the transverse axis: one of them lies on the other hemipelvis
 * |
 *
 * - Acetabulum: the sphere of the surface that faces the seed, robust (the fossa does not count).
 * - Rim: the plane, robust (the notch does not count), of the points, one for each 5 degrees around the axis, that lie
 *   furthest out among those from 3 mm within to 2 mm beyond the sphere.
 * - Frame: the anterior pelvic plane holds the transverse axis and the line from `pubic_tubercle` to `asis`. The
 * transverse axis is the line of `asis_right` to `asis_left`, or where these are not given the x axis, as of a patient
 * who lies straight in the scanner. G. E. Lewinnek et al., J Bone Joint Surg Am 60:217-220, 1978.
 *
 * A landmark of the bone further than `farthest` (mm) from it is one of a part that is not there.
 *
 * \param surface  closed, mm. */
HemipelvisGeometry
FitHemipelvis(const TriangleSurface & surface, const std::vector<Landmark> & landmarks, double farthest = 20.0);

/** \brief The measures of a fitted hemipelvis, with their definitions; those that lack a primitive say so.
 *
 * acetabularCentre, acetabularRadius; radiographicInclination, radiographicAnteversion, anatomicInclination,
 * anatomicAnteversion (D. W. Murray, doi:10.1302/0301-620X.75B2.8444942); side. */
MeasureList
MeasureHemipelvis(const HemipelvisGeometry & hemipelvis);
} // namespace bone

#endif
