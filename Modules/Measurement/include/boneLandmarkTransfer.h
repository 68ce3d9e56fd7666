/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneLandmarkTransfer_h
#define boneLandmarkTransfer_h

#include "boneLandmarkIO.h"
#include "boneTetraLocator.h"

#include <string>
#include <vector>

namespace bone
{
/** A landmark in a mesh: the tetrahedron that holds it and its barycentric coordinates there, which hold in every mesh
 * of the same topology. */
struct LandmarkPlace
{
  std::string  name;
  CellLocation place; ///< `distance`: mm from the landmark to the mesh, 0 inside; the place is then the nearest one
};

/** \brief Places of landmarks in a mesh; one outside of it is placed on the nearest boundary triangle.
 *
 * Throws std::invalid_argument where the mesh has no tetrahedra. */
std::vector<LandmarkPlace>
LocateLandmarks(const MeshArrays & mesh, const std::vector<Landmark> & landmarks);

/** \brief The points of places in a mesh, mm.
 *
 * Throws std::invalid_argument where the mesh has fewer tetrahedra than a place needs. */
std::vector<Landmark>
PlaceLandmarks(const MeshArrays & mesh, const std::vector<LandmarkPlace> & places);

/** Throws std::invalid_argument, which says what differs, where two meshes have other points or tetrahedra by number.
 */
void
RequireSameTopology(const MeshArrays & standard, const MeshArrays & subject);

/** \brief Landmarks of a standard model on a subject of the same topology.
 *
 * One inside, or within 2 mm of the surface, keeps its tetrahedron and barycentric coordinates (of the nearest place).
 * One further out, as the centre of an acetabulum is, goes with the standard's points around it, up to twice as far as
 * the surface: by the similarity that fits their motion best (S. Umeyama, doi:10.1109/34.88573).
 *
 * Throws std::invalid_argument as RequireSameTopology and LocateLandmarks, and where a landmark lies further than
 * `farthest` (mm) from the standard model, as one of another space does. */
std::vector<Landmark>
CarryLandmarks(const MeshArrays &            standard,
               const std::vector<Landmark> & landmarks,
               const MeshArrays &            subject,
               double                        farthest = FarthestLandmark);
} // namespace bone

#endif
