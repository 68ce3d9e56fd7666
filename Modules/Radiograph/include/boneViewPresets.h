/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneViewPresets_h
#define boneViewPresets_h

#include "boneXRayConventions.h"

namespace bone
{
/** \defgroup ViewPresets Views by name, framed around a box
 *
 * The isocentre is the box's centre and the detector just large enough that the box projects inside, with square
 * pixels, the longer side `pixels` long. The patient's axes are those of physical space (LPS), see CArmView. Throws
 * itk::ExceptionObject where the box does not lie between source and detector.
 * \{ */

/** A standing patient's radiographs, named by the beam's way or by the side that the detector is at. The head is up. */
enum class ViewPreset : int
{
  AP = 0,          ///< source before the patient; the patient's left is at the viewer's right
  PA = 1,          ///< source behind the patient; the same side of the patient at the viewer's right
  LeftLateral = 2, ///< detector at the patient's left; the front is at the viewer's left
  RightLateral = 3 ///< detector at the patient's right; the front is at the viewer's right
};

/** A box along the axes of physical space, mm. */
struct ViewBox
{
  Vector3 lower;
  Vector3 upper;
};

/** The view of a C-arm with these angles and distances, shown as FromCArm shows it; `arm`'s isocentre, size, spacing
 * and centre are not used. */
XRayGeometry::View
FrameCArm(const CArmView & arm, const ViewBox & box, int pixels);

/** A preset's view with the distances of `arm`; its angles are not used. Seen by a viewer at the detector who looks at
 * the patient, but for AP, which a viewer sees who faces the patient. */
XRayGeometry::View
FramePreset(ViewPreset preset, const CArmView & arm, const ViewBox & box, int pixels);
/** \} */
} // namespace bone

#endif
