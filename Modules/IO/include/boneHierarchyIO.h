/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneHierarchyIO_h
#define boneHierarchyIO_h

#include "boneDensityHierarchy.h"
#include "boneMeshStorageParameters.h"

#include <string>
#include <vector>

namespace bone
{
/** \defgroup HierarchyIO Hierarchies: PREFIX_L1.vtu, PREFIX_L2.vtu, ... beside PREFIX.hierarchy.json
 *
 * The JSON has "levels", each with "file" (beside the JSON), "points", "tetrahedra", "densityErrorBound" (null: none),
 * "densityError", "surfaceError" (mm), "stopReason" and "parentPoint", each point's id in the level before (empty for
 * the first). All functions throw IOError.
 * \{ */

/** Writes all files, levels as \ref WriteMeshArrays does; none takes its name before all are whole, and the JSON comes
 * last. Returns their paths in that order. */
std::vector<std::string>
WriteHierarchy(const DensityHierarchy<> *    hierarchy,
               const std::string &           prefix,
               const MeshStorageParameters & storage = {});

/** Reads a hierarchy by its .hierarchy.json. Refuses a level whose counts differ from those of its file or whose parent
 * ids are out of range. */
DensityHierarchy<>::Pointer
ReadHierarchy(const std::string & path);
/** \} */
} // namespace bone

#endif
