/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneXRayIO_h
#define boneXRayIO_h

#include "boneImageIO.h"
#include "boneRadiographValues.h"
#include "boneXRayGeometry.h"

#include <optional>
#include <string>
#include <vector>

namespace bone
{
/** An X-ray image with what its file says of it. */
struct XRayFile
{
  /** Columns x rows x 1. With a view it lies on the view's detector, as the images of RadiographSource do; without one
   * at the origin, with the detector's pixel spacing where the file has it. */
  CTImage::Pointer image;
  /** Source and detector, where the file has all that is needed. */
  std::optional<XRayGeometry::View> view;
  /** Why there is no view: each attribute that is missing or cannot be used. */
  std::vector<std::string> obstacles;
  RadiographValues         values{ RadiographValues::Integral };
  /** Of display values: whether larger ones mean more attenuation. */
  bool largerAttenuates{ true };
  /** What the collimator and the shutter leave free, where they are rectangles: first column, first row, columns,
   * rows. Empty: the file does not say. */
  std::vector<int> crop;
  /** What was assumed or not used, a sentence each. */
  std::vector<std::string> notes;
};

/** \brief Reads an X-ray image: a DICOM file of one frame (modalities RF, XA, DX, CR, RG, OT), or any other image that
 * ReadRadiograph reads, which has no view and whose values are taken for line integrals.
 *
 * **View.** Of a C-arm (\ref CArmView) with PositionerPrimaryAngle (0018,1510) and PositionerSecondaryAngle
 * (0018,1511), DistanceSourceToPatient (0018,1111), DistanceSourceToDetector (0018,1110) and ImagerPixelSpacing
 * (0018,1164), isocentre at the origin, seen in the middle of the image. There is none where one is missing (a
 * ViewPosition as AP is not enough), or PositionerType is not CARM, PatientPosition not HFS, the field of view is
 * turned or flipped, or PatientOrientation says other directions of columns and rows.
 *
 * **Values**, after RescaleSlope and RescaleIntercept. PixelIntensityRelationship LIN: intensities. A sign of -1 there
 * means that less beam is a larger value: the values are subtracted from the largest that can be stored. LOG: display
 * values, as their scale is not known. DISP or nothing: display values. Larger ones attenuate more if the sign says so;
 * without it, bone is taken to be bright for DX, CR, RG and OT and dark for RF and XA, with MONOCHROME2, and the other
 * way round with MONOCHROME1.
 *
 * Throws IOError where the file is no image, of another modality, of several frames or colours, or damaged. */
XRayFile
ReadXRay(const std::string & path);
} // namespace bone

#endif
