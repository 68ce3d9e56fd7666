/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneGeometryIO_h
#define boneGeometryIO_h

#include "boneXRayConventions.h"

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
 * XRayGeometry. Views in other conventions (see XRayConventions) are objects with the members
 * \code{.json}
 * {"matrix": [[4 numbers], [4], [4]], "size": [columns, rows], "columnSpacing": du}
 * {"nrm": [x, y, z], "vup": [x, y, z], "sad": mm, "sid": mm, "isocenter": [x, y, z], "dim": [columns, rows],
 *  "detectorSize": [width, height], "imageCenter": [column, row]}
 * {"rtk": "geometry.xml", "size": [columns, rows], "spacing": [du, dv], "origin": [u, v], "rowsDown": false}
 * \endcode
 * The last stands for all projections of the file, which lies beside the JSON; "origin" and "rowsDown" may be left out.
 * \{ */

/** One or more views. Throws IOError where the file is missing or no JSON, or a member is missing, unknown or not
 * usable; it says which view and which member. */
std::vector<XRayGeometry::Pointer>
ReadGeometry(const std::string & path);

/** How WriteGeometry says a view. */
enum class GeometryConvention : int
{
  View = 0,
  Matrix = 1,      ///< point sources only
  Plastimatch = 2, ///< point sources only; the isocentre lies nearest to the origin of physical space
};

/** Writes one view as an object, several as a list; the whole file or none. Throws IOError, also where the convention
 * cannot say a view. */
void
WriteGeometry(const std::vector<XRayGeometry::Pointer> & views,
              const std::string &                        path,
              GeometryConvention                         convention = GeometryConvention::View);

/** RTK's XML file (RTKThreeDCircularGeometry, version 3). Cylindrical detectors are refused. */
std::vector<RtkProjection>
ReadRtkGeometry(const std::string & path);

/** Writes RTK's XML file and returns the grid of the projection images. Views must have one size and spacing and be all
 * of a point source or all parallel. Throws IOError. */
RtkGrid
WriteRtkGeometry(const std::vector<XRayGeometry::Pointer> & views, const std::string & path);
/** \} */
} // namespace bone

#endif
