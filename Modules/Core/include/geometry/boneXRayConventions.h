/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneXRayConventions_h
#define boneXRayConventions_h

#include "boneXRayGeometry.h"

#include <limits>

namespace bone
{
/** \defgroup XRayConventions Views in the conventions of other programs
 *
 * All to and from XRayGeometry::View, in the same physical space (LPS, mm). What cannot be said in a convention throws
 * itk::ExceptionObject with the reason. Documentation/geometry.md tells the conventions and how each was checked.
 * \{ */

using ProjectionMatrix = Eigen::Matrix<double, 3, 4>;

/** P = K [R | t] with (column w, row w, w) = P (x, y, z, 1); w > 0 before a point source and grows from 0 there to the
 * distance of source and detector (mm); parallel beam: w = 1. */
ProjectionMatrix
ToProjectionMatrix(const XRayGeometry::View & view);

/** The view of a point source with a given matrix, of any scale with w > 0 before the source. The matrix says nothing
 * of the detector's distance: `columnSpacing` (mm) does. Refused: a parallel beam, skewed pixel axes (beyond 1e-6). */
XRayGeometry::View
FromProjectionMatrix(const ProjectionMatrix & matrix, const std::array<int, 2> & size, double columnSpacing);

/** `plastimatch drr`. The detector is perpendicular to the line from source to isocentre. */
struct PlastimatchView
{
  Vector3            nrm{ 1, 0, 0 }; ///< from the isocentre to the source; any length
  Vector3            vup{ 0, 0, 1 }; ///< towards the top row; any length
  double             sad{ 1000 };    ///< source to isocentre, mm
  double             sid{ 1500 };    ///< source to detector, mm
  Vector3            isocenter{ 0, 0, 0 };
  std::array<int, 2> dim{ { 128, 128 } };       ///< columns, rows
  Vector2            detectorSize{ 600, 600 };  ///< width, height, mm
  Vector2            imageCenter{ 63.5, 63.5 }; ///< pixel (column, row) that the isocentre projects to
};
XRayGeometry::View
FromPlastimatch(const PlastimatchView & view);
/** The isocentre lies at `sad` mm on the ray perpendicular to the detector. */
PlastimatchView
ToPlastimatch(const XRayGeometry::View & view, double sad);

/** One projection of RTK's ThreeDCircularProjectionGeometry: mm and degrees, its meaning of each name. */
struct RtkProjection
{
  double sourceToIsocenter{ 0 };
  double sourceToDetector{ 0 }; ///< 0: parallel beam
  double gantryAngle{ 0 };
  double outOfPlaneAngle{ 0 };
  double inPlaneAngle{ 0 };
  double sourceOffsetX{ 0 };
  double sourceOffsetY{ 0 };
  double projectionOffsetX{ 0 };
  double projectionOffsetY{ 0 };
};

/** The pixels of an RTK projection image, which RTK's geometry does not hold: pixel (c, r) lies at origin + (c spacing
 * x, +-r spacing y) on the detector, with the lower sign for `rowsDown` (an image whose second direction is -y). */
struct RtkGrid
{
  std::array<int, 2> size{ { 512, 512 } };
  Vector2            spacing{ 1, 1 };
  Vector2            origin{ 0, 0 };
  bool               rowsDown{ false };
};

/** RTK's 3 x 4 matrix, from physical space to mm on the projection image. */
ProjectionMatrix
RtkMatrix(const RtkProjection & projection);
/** A parallel beam's detector is put at the source's distance beyond the isocentre. */
XRayGeometry::View
FromRtk(const RtkProjection & projection, const RtkGrid & grid);
/** With pixel (0, 0) at the origin of the projection image: views of one size then make one stack of images. */
void
ToRtk(const XRayGeometry::View & view, RtkProjection & projection, RtkGrid & grid);

/** An isocentric C-arm as DICOM describes it (PS3.3 C.8.7.5, XA Positioner). Angles are the detector's position about
 * the patient, seen from the isocentre: (0, 0) is before the chest, with the source at the back (a PA beam); positive
 * primary angles turn it to the patient's left (LAO, 90: at the left), negative ones to the right (RAO); positive
 * secondary angles turn it to the head (cranial, CRA), negative ones to the feet (caudal, CAU). The patient's axes are
 * those of physical space (LPS), as for a patient who lies head first and supine (HFS).
 *
 * Columns increase to the viewer's right and rows downwards, for a viewer at the detector who looks at the patient: at
 * (0, 0) to the patient's left and to the feet. The ray through the isocentre is perpendicular to the detector and
 * meets it at `centre`. */
struct CArmView
{
  double             primary{ 0 };             ///< degrees, -180 to 180, LAO positive (0018,1510)
  double             secondary{ 0 };           ///< degrees, -90 to 90, CRA positive (0018,1511)
  double             sourceToIsocenter{ 700 }; ///< mm, DistanceSourceToPatient (0018,1111)
  double             sourceToDetector{ 1000 }; ///< mm, DistanceSourceToDetector (0018,1110)
  std::array<int, 2> size{ { 512, 512 } };     ///< columns, rows
  Vector2            spacing{ 1, 1 };          ///< mm from column to column and row to row, at the detector
  Vector3            isocenter{ 0, 0, 0 };
  /** Pixel (column, row) that the isocentre projects to; NaN: the middle of the detector. */
  Vector2 centre{ Vector2::Constant(std::numeric_limits<double>::quiet_NaN()) };
};
/** Refused: an angle out of its range, a distance that is not positive, a detector nearer to the source than the
 * isocentre. */
XRayGeometry::View
FromCArm(const CArmView & view);
/** \} */
} // namespace bone

#endif
