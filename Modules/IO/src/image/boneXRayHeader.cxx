/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneXRayHeader.h"

#include "boneDicomFile.h"
#include "boneRefuse.h"
#include "boneXRayConventions.h"

#include <dcmtk/config/osconfig.h>

#include <dcmtk/dcmdata/dctk.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace bone
{
namespace
{
/** An attribute's value as text, without blanks around it; empty where it is missing. */
std::string
TextOf(DcmDataset & data, const DcmTagKey & key, unsigned long position = 0)
{
  OFString text;
  data.findAndGetOFString(key, text, position);
  const std::string whole = text.c_str();
  const auto        first = whole.find_first_not_of(' ');
  return first == std::string::npos ? std::string() : whole.substr(first, whole.find_last_not_of(' ') - first + 1);
}

std::optional<double>
NumberOf(DcmDataset & data, const DcmTagKey & key, unsigned long position = 0)
{
  const std::string text = TextOf(data, key, position);
  char *            end = nullptr;
  const double      number = std::strtod(text.c_str(), &end);
  return !text.empty() && *end == '\0' && std::isfinite(number) ? std::optional<double>(number) : std::nullopt;
}

std::string
NameOf(const DcmTagKey & key)
{
  char number[16];
  std::snprintf(number, sizeof(number), " (%04x,%04x)", key.getGroup(), key.getElement());
  return DcmTag(key).getTagName() + std::string(number);
}

/** The number, or 0 and an obstacle. */
double
NeededNumber(DcmDataset & data, const DcmTagKey & key, unsigned long position, std::vector<std::string> & obstacles)
{
  const auto number = NumberOf(data, key, position);
  if (!number)
  {
    const std::string obstacle = NameOf(key) + " is missing";
    if (std::find(obstacles.begin(), obstacles.end(), obstacle) == obstacles.end())
    {
      obstacles.push_back(obstacle);
    }
  }
  return number.value_or(0.0);
}

/** An attribute that, where it is there, must have this value for a view. */
void
Require(DcmDataset &               data,
        const DcmTagKey &          key,
        const char *               wanted,
        const char *               why,
        std::vector<std::string> & list)
{
  const std::string text = TextOf(data, key);
  const auto        number = NumberOf(data, key);
  if (!text.empty() && text != wanted && !(number && Say(*number) == wanted))
  {
    list.push_back(NameOf(key) + " is " + text + ", not " + wanted + ": " + why);
  }
}

/** Compares PatientOrientation's first letters with the directions of columns and rows. */
void
CompareOrientation(DcmDataset & data, XRayFile & file)
{
  const Vector3 axes[2] = { file.view->detectorU, file.view->detectorV };
  for (unsigned long k = 0; k < 2; ++k)
  {
    const std::string text = TextOf(data, DCM_PatientOrientation, k);
    const std::string letters = "LPHRAF";
    const auto        letter = text.empty() ? std::string::npos : letters.find(text.front());
    if (letter != std::string::npos && (letter < 3 ? 1 : -1) * axes[k][static_cast<int>(letter % 3)] < 0)
    {
      file.obstacles.push_back(NameOf(DCM_PatientOrientation) + " is " + text + " for " +
                               (k == 0 ? "the rows" : "the columns") +
                               ", against the angles: is the image flipped or turned?");
    }
  }
}

void
FindView(DcmDataset & data, const std::array<int, 2> & size, XRayFile & file)
{
  auto &   obstacles = file.obstacles;
  CArmView arm;
  arm.size = size;
  arm.primary = NeededNumber(data, DCM_PositionerPrimaryAngle, 0, obstacles);
  arm.secondary = NeededNumber(data, DCM_PositionerSecondaryAngle, 0, obstacles);
  const std::string position = TextOf(data, DCM_ViewPosition);
  if (!obstacles.empty() && !position.empty())
  {
    obstacles.push_back(NameOf(DCM_ViewPosition) + " is " + position + ", which is not enough: it tells no angles");
  }
  arm.sourceToIsocenter = NeededNumber(data, DCM_DistanceSourceToPatient, 0, obstacles);
  arm.sourceToDetector = NeededNumber(data, DCM_DistanceSourceToDetector, 0, obstacles);
  // The first number is from row to row.
  arm.spacing.y() = NeededNumber(data, DCM_ImagerPixelSpacing, 0, obstacles);
  arm.spacing.x() = NeededNumber(data, DCM_ImagerPixelSpacing, 1, obstacles);
  Require(data, DCM_PositionerType, "CARM", "its angles are not those of a C-arm", obstacles);
  Require(data, DCM_PatientPosition, "HFS", "give the geometry by hand", obstacles);
  Require(data, DCM_FieldOfViewRotation, "0", "the image is turned", obstacles);
  Require(data, DCM_FieldOfViewHorizontalFlip, "NO", "the image is flipped", obstacles);
  if (!obstacles.empty())
  {
    return;
  }
  try
  {
    file.view = FromCArm(arm);
    CompareOrientation(data, file);
  }
  catch (const itk::ExceptionObject & error)
  {
    obstacles.push_back(ErrorLine(error));
  }
  if (!obstacles.empty())
  {
    file.view.reset();
    return;
  }
  if (TextOf(data, DCM_FieldOfViewOrigin).empty())
  {
    return;
  }
  file.notes.push_back(NameOf(DCM_FieldOfViewOrigin) + " is not used: the isocentre is taken to be seen in the middle");
}

/** Narrows the free rectangle (first and last column, first and last row) by a collimator or shutter. */
void
Narrow(DcmDataset &            data,
       const char *            what,
       const DcmTagKey &       shape,
       const DcmTagKey         edges[4],
       std::array<double, 4> & free,
       XRayFile &              file)
{
  for (unsigned long k = 0; !TextOf(data, shape, k).empty(); ++k)
  {
    const std::string text = TextOf(data, shape, k);
    if (text != "RECTANGULAR")
    {
      file.notes.push_back(Say("The ", what, " of the shape ", text, " is not used: give a mask."));
      continue;
    }
    // Numbers of columns and rows, from 1 on, of the edges themselves.
    for (int e = 0; e < 4; ++e)
    {
      const auto at = NumberOf(data, edges[e]);
      if (at)
      {
        free[e] = e % 2 == 0 ? std::max(free[e], *at) : std::min(free[e], *at - 2);
      }
    }
  }
}

void
FindCrop(DcmDataset & data, const std::array<int, 2> & size, XRayFile & file)
{
  const std::array<double, 4> whole{ { 0.0, size[0] - 1.0, 0.0, size[1] - 1.0 } };
  std::array<double, 4>       free = whole;
  const DcmTagKey             collimator[4] = { DCM_CollimatorLeftVerticalEdge,
                                                DCM_CollimatorRightVerticalEdge,
                                                DCM_CollimatorUpperHorizontalEdge,
                                                DCM_CollimatorLowerHorizontalEdge };
  const DcmTagKey             shutter[4] = { DCM_ShutterLeftVerticalEdge,
                                             DCM_ShutterRightVerticalEdge,
                                             DCM_ShutterUpperHorizontalEdge,
                                             DCM_ShutterLowerHorizontalEdge };
  Narrow(data, "collimator", DCM_CollimatorShape, collimator, free, file);
  Narrow(data, "shutter", DCM_ShutterShape, shutter, free, file);
  if (!(free[1] >= free[0] && free[3] >= free[2]))
  {
    file.notes.push_back("The collimator's and shutter's edges leave nothing free and are not used.");
  }
  else if (free != whole)
  {
    for (int axis = 0; axis < 2; ++axis)
    {
      file.crop.push_back(static_cast<int>(free[2 * axis]));
    }
    for (int axis = 0; axis < 2; ++axis)
    {
      file.crop.push_back(static_cast<int>(free[2 * axis + 1] - free[2 * axis]) + 1);
    }
  }
}

/** The largest value that can be stored. */
double
LargestStored(DcmDataset & data)
{
  const double bits = NumberOf(data, DCM_BitsStored).value_or(16);
  const bool   isSigned = NumberOf(data, DCM_PixelRepresentation).value_or(0) != 0;
  return std::exp2(isSigned ? bits - 1 : bits) - 1;
}

void
FindValues(DcmDataset & data, const std::string & modality, XRayFile & file, XRayScale & scale)
{
  scale.slope = NumberOf(data, DCM_RescaleSlope).value_or(1.0);
  scale.offset = NumberOf(data, DCM_RescaleIntercept).value_or(0.0);
  const std::string relationship = TextOf(data, DCM_PixelIntensityRelationship);
  const auto        sign = NumberOf(data, DCM_PixelIntensityRelationshipSign);
  const bool        table = data.tagExistsWithValue(DCM_ModalityLUTSequence);
  if (table)
  {
    file.notes.push_back(NameOf(DCM_ModalityLUTSequence) + " is not applied: the values are taken for display values.");
  }
  if (relationship == "LIN" && !table)
  {
    file.values = RadiographValues::Intensity;
    file.largerAttenuates = false;
    if (sign && *sign < 0)
    {
      file.notes.push_back("Less beam is stored as a larger value: values are subtracted from the largest possible.");
      scale = { -scale.slope, scale.slope * LargestStored(data) };
    }
    return;
  }
  file.values = RadiographValues::Display;
  const bool dark = TextOf(data, DCM_PhotometricInterpretation) == "MONOCHROME1";
  if (sign && *sign != 0)
  {
    file.largerAttenuates = (*sign < 0) != (scale.slope < 0);
    return;
  }
  const bool boneIsDark = modality == "RF" || modality == "XA";
  file.largerAttenuates = (boneIsDark == dark) != (scale.slope < 0);
  file.notes.push_back(NameOf(DCM_PixelIntensityRelationshipSign) + " is missing: bone is taken to be " +
                       (boneIsDark ? "dark, as fluoroscopy shows it." : "bright, as radiographs show it."));
}
} // namespace

XRayFile
ReadXRayHeader(const std::string & path, XRayScale & scale, Vector2 & spacing)
{
  const DicomHeader header = ReadWholeDicomFile(path);
  const auto        known = { "RF", "XA", "DX", "CR", "RG", "OT" };
  if (!header.image)
  {
    throw IOError(path, "is a DICOM file without an image");
  }
  if (std::none_of(known.begin(), known.end(), [&](const char * name) { return header.modality == name; }))
  {
    throw IOError(path,
                  "has the modality '" + header.modality + "', which is no radiograph's (RF, XA, DX, CR, RG or OT)");
  }
  if (header.frames != 1)
  {
    throw IOError(path, Say("has ", header.frames, " frames where one is needed: extract one as a file of its own"));
  }
  DcmFileFormat dicom;
  dicom.loadFile(path.c_str());
  DcmDataset & data = *dicom.getDataset();
  if (NumberOf(data, DCM_SamplesPerPixel).value_or(1) != 1)
  {
    throw IOError(path, "is a colour image, where one value a pixel is needed");
  }
  const std::array<int, 2> size{ { header.columns, header.rows } };
  XRayFile                 file;
  FindView(data, size, file);
  FindCrop(data, size, file);
  FindValues(data, header.modality, file, scale);
  const auto column = NumberOf(data, DCM_ImagerPixelSpacing, 1), row = NumberOf(data, DCM_ImagerPixelSpacing, 0);
  spacing = column && row && *column > 0 && *row > 0 ? Vector2(*column, *row) : Vector2(1, 1);
  return file;
}
} // namespace bone
