/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneViewPresets.h"

namespace bone
{
namespace
{
/** The view as seen by a viewer at the source. */
XRayGeometry::View
FrameFromSource(const CArmView & arm, const ViewBox & box, int pixels)
{
  const XRayGeometry::View view = FromCArm(arm);
  return XRayGeometry::Framing(
    box.lower, box.upper, view.direction, -view.detectorV, arm.sourceToIsocenter, arm.sourceToDetector, pixels);
}
} // namespace

XRayGeometry::View
FrameCArm(const CArmView & arm, const ViewBox & box, int pixels)
{
  XRayGeometry::View view = FrameFromSource(arm, box, pixels);
  view.detectorOrigin += (view.size[0] - 1) * view.spacing.x() * view.detectorU;
  view.detectorU = -view.detectorU;
  return view;
}

XRayGeometry::View
FramePreset(ViewPreset preset, const CArmView & arm, const ViewBox & box, int pixels)
{
  CArmView turned = arm;
  turned.secondary = 0.0;
  switch (preset)
  {
    case ViewPreset::AP:
      turned.primary = 180.0;
      return FrameFromSource(turned, box, pixels);
    case ViewPreset::PA:
      turned.primary = 0.0;
      break;
    case ViewPreset::LeftLateral:
      turned.primary = 90.0;
      break;
    case ViewPreset::RightLateral:
      turned.primary = -90.0;
      break;
  }
  return FrameCArm(turned, box, pixels);
}
} // namespace bone
