/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneUntangling_h
#define boneUntangling_h

#include "boneAtlasRegistrationParameters.h"
#include "boneExecution.h"
#include "boneMeshArrays.h"
#include "bonePointAlignment.h"

namespace bone
{
/** Parameters of \ref UntangleMesh. */
struct UntanglingParameters
{
  double exteriorBound{ AtlasRegistrationParameters().exteriorBound }; ///< how far an exterior point may move, mm
  int    iterations{ 200 };                                            ///< passes over the points around bad cells
  double floor{ 0.02 }; ///< volume relative to that of the alignment below which a cell is worked on
};

/** What an untangling did. */
struct UntanglingReport
{
  std::size_t before{ 0 }; ///< flat or inverted cells
  std::size_t after{ 0 };
  std::size_t moved{ 0 };      ///< points
  double      exterior{ 0.0 }; ///< largest move of an exterior point, mm
};

/** \brief Makes inverted tetrahedra positive by moving the points around them, exterior ones by a bounded distance.
 *
 * Minimises the mean-ratio distortion of the cells against those of `rest` under `alignment`, with the volume
 * regularised so that it is finite for inverted cells (J. M. Escobar et al., doi:10.1016/S0045-7825(03)00299-8), point
 * by point by damped Newton steps. Nothing is touched where no cell is flat, inverted or below the floor.
 * Deterministic.
 *
 * `points` are changed; cells and neighbours are those of `rest`. */
UntanglingReport
UntangleMesh(const MeshArrays &           rest,
             const std::vector<IdType> &  exterior,
             const AffineMap &            alignment,
             std::vector<Vector3> &       points,
             const UntanglingParameters & parameters = UntanglingParameters(),
             const Execution &            execution = {});
} // namespace bone

#endif
