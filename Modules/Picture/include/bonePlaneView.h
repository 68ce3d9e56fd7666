/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef bonePlaneView_h
#define bonePlaneView_h

#include "boneCanvas.h"

#include <vector>

namespace bone
{
/** The patient's directions at the sides of a picture. */
struct SideLetters
{
  std::string left;
  std::string right;
  std::string top;
  std::string bottom;
};

/** The patient's direction that a vector of physical space (LPS) points to: L, R, A, P, S (head) or I (feet); two
 * letters, the greater part first, where it is more than 20 degrees from the nearest axis. Empty for a null vector. */
std::string
DirectionLetters(const Vector3 & direction);

/** The directions at the sides of a picture whose columns increase along `right` and rows along `down`: of a plane or,
 * with `detectorU` and `detectorV`, of an X-ray's view. */
SideLetters
LettersOf(const Vector3 & right, const Vector3 & down);

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

  /** The patient's directions at the four sides. */
  SideLetters
  Letters() const
  {
    return LettersOf(right, down);
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

/** Whether a unit normal is that of an axis within 0.1 degrees, and of which: 0 sagittal, 1 coronal, 2 axial; -1 if of
 * none. */
int
PlaneAxis(const Vector3 & normal);

/** "coronal plane, y = 12.3 mm", or "oblique plane, 12 degrees from coronal, through (1.0, 12.3, -40.0) mm": of the
 * plane with a unit normal through a point. */
std::string
DescribePlane(const Vector3 & normal, const Vector3 & point);

/** "CT slice 37, z = -120.4 mm" of the plane with a unit normal through a point: the index in the CT's file, counted
 * from 0, along that axis of the CT that is the normal; "between CT slices 37 and 38, ..." where the plane lies between
 * two; "z = -120.4 mm" where no axis is the normal or the plane lies outside. Across an axis of the patient the place
 * is its coordinate, else it is along the normal, which is told. */
std::string
DescribeSlice(const itk::ImageBase<3> * ct, const Vector3 & normal, const Vector3 & point);

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
