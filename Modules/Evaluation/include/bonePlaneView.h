/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef bonePlaneView_h
#define bonePlaneView_h

#include "boneCanvas.h"

#include <vector>

namespace bone
{
/** \class PlaneView
 * \brief A rectangle in space that is looked at: pixel (c, r) is centred at corner + pixel (c right + r down), mm.
 *
 * It is turned as radiologists do: head or, on an axial plane, front up; the patient's left, or on a sagittal plane the
 * back, to the right. */
struct PlaneView
{
  Vector3 corner{ Vector3::Zero() };
  Vector3 right{ Vector3::UnitX() };
  Vector3 down{ Vector3::UnitY() };
  double  pixel{ 1.0 };
  int     columns{ 1 };
  int     rows{ 1 };

  /** In pixels. */
  Vector2
  Project(const Vector3 & point) const
  {
    return { (point - corner).dot(right) / pixel, (point - corner).dot(down) / pixel };
  }
};

/** The view of the plane with the given unit normal through `point` that just holds the points' projections and a
 * margin (mm), its longer side of `pixels` pixels. */
PlaneView
FramePlane(const Vector3 &              normal,
           const Vector3 &              point,
           const std::vector<Vector3> & points,
           double                       margin,
           int                          pixels);

/** The plane through the points' mean along which they extend most (their principal axes 1 and 2). */
PlaneView
FrameLargestCut(const std::vector<Vector3> & points, double margin, int pixels);

/** An empty image of one slice whose voxels are the view's pixels. */
CTImage::Pointer
MakePlaneImage(const PlaneView & view);

/** Linear interpolation of an image at the view's pixels; NaN outside. */
Panel
SamplePlane(const CTImage * image, const PlaneView & view);

/** The values of an image of one slice. */
Panel
ToPanel(const CTImage * image);
} // namespace bone

#endif
