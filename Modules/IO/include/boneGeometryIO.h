/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneGeometryIO_h
#define boneGeometryIO_h

#include "boneXRayGeometry.h"

#include <string>
#include <vector>

namespace bone
{
/** \defgroup GeometryIO X-ray views as JSON
 *
 * \code{.json}
 * {"source": [x, y, z], "detectorOrigin": [x, y, z], "detectorU": [x, y, z], "detectorV": [x, y, z],
 *  "size": [columns, rows], "spacing": [du, dv]}
 * \endcode
 * A parallel beam has "direction" in place of "source"; a list of such objects is a set of views. Conventions: see
 * XRayGeometry.
 * \{ */

/** One or more views. Throws IOError where the file is missing or no JSON, or a member is missing, unknown or not
 * usable; it says which view and which member. */
std::vector<XRayGeometry::Pointer>
ReadGeometry(const std::string & path);

/** Writes one view as an object, several as a list; the whole file or none. Throws IOError. */
void
WriteGeometry(const std::vector<XRayGeometry::Pointer> & views, const std::string & path);
/** \} */
} // namespace bone

#endif
