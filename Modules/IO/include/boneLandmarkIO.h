/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneLandmarkIO_h
#define boneLandmarkIO_h

#include "boneXRayGeometry.h"

#include <string>
#include <vector>

namespace bone
{
/** A named point of a bone, mm (LPS). */
struct Landmark
{
  std::string name;
  Vector3     point{ Vector3::Zero() };
};

/** A landmark further from a bone than this, mm, is of another one, or in another space: the centre of an acetabulum,
 * which lies in the open, is nearer. */
constexpr double FarthestLandmark = 45.0;

/** Where a named point of a bone appears on a radiograph: column and row, fractional. */
struct ImageLandmark
{
  std::string name;
  Vector2     pixel{ Vector2::Zero() };
};

/** \defgroup LandmarkIO Landmarks as 3D Slicer markups or plain JSON
 * All throw IOError: one line that names the file, what is wrong and what to do.
 * \{ */

/** Points in space: a 3D Slicer markups file (.mrk.json), LPS or RAS, whose control points have their names as `label`,
 * or {"name": [x, y, z], ...} in LPS. Control points that are not yet placed are passed over. Refused: markups that are
 * no Fiducial, a name that is missing or comes twice, no point at all, coordinates that cannot be mm. */
std::vector<Landmark>
ReadLandmarks(const std::string & path);

/** Points on a radiograph: {"name": [column, row], ...}, or a markups file or {"name": [x, y, z], ...} whose points lie
 * on the detector of `view`, as they do when they are placed on a radiograph that lies in space. A point further from
 * the detector's plane than a millimetre and a pixel is refused: it belongs to another view. */
std::vector<ImageLandmark>
ReadImageLandmarks(const std::string & path, const XRayGeometry::View & view);

/** Writes a markups file of the type Fiducial in LPS; the whole file or none. */
void
WriteLandmarks(const std::vector<Landmark> & landmarks, const std::string & path);
/** \} */
} // namespace bone

#endif
