/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneMeshValidator_h
#define boneMeshValidator_h

#include "boneMeshArrays.h"

#include <string>
#include <vector>

namespace bone
{
/** One check of the validator: how many places fail it and the first few of them in words. */
struct MeshCheck
{
  std::string              name;
  std::size_t              failures{ 0 };
  std::vector<std::string> examples;
};

/** What ValidateMesh found; checks stand in the order they are made. */
struct MeshValidation
{
  std::vector<MeshCheck> checks;
  int                    components{ 0 };
  int                    boundaryEuler{ 0 };

  bool
  IsValid() const;
  /** One line that names the first failed check, or "valid". */
  std::string
  Summary() const;
};

/** \brief Lists what is wrong with a tetrahedral mesh, without changing it.
 *
 * Checks, in this order (a later one is still made where an earlier one fails, unless ids are out of range):
 *  1. "ids": point ids in range, four distinct vertices, coordinates finite, no two tetrahedra on the same vertices
 *  2. "positive orientation": exact sign of every tetrahedron
 *  3. "face manifold": a face belongs to one or two tetrahedra, from opposite sides
 *  4. "closed 2-manifold boundary": each boundary edge has two boundary faces, each boundary vertex a single fan
 *  5. "face neighbours": symmetric and those of the faces (where present)
 *  6. "interfaces": for each region k > 1 the union of the tetrahedra of region >= k has a boundary that is a closed
 *     2-manifold within the body (where regions are present)
 *  7. "points": no unused and no coincident points
 *  8. "voids": no cavity enclosed in the body
 * Cost O(n log n). */
MeshValidation
ValidateMesh(const MeshArrays & mesh);
/** What no algorithm on meshes can work with, in one line: the first failure of check 1 or 3 of ValidateMesh. Empty
 * where there is none. */
std::string
FindTopologyObstacle(const MeshArrays & mesh);
} // namespace bone

#endif
