/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneSteinerCollapse_h
#define boneSteinerCollapse_h

#include "boneExecution.h"
#include "boneMeshArrays.h"

namespace bone
{
namespace tiling
{
/** Where the points in between belong. */
struct SteinerPlaces
{
  std::vector<Vector3>               ideal; ///< of each point from the first Steiner point on
  std::vector<std::array<IdType, 3>> faces; ///< of the surfaces between regions, by point, at the ideal places
  double                             tolerance{ 0.0 }; ///< mm that a surface may move from them, as a mean
};

/** \brief Collapses the points from `firstSteiner` on onto their neighbours.
 *
 * As long as every tetrahedron stays positive (exact), the topology of all regions and of the surfaces between them
 * stays, and surfaces stay within the tolerance of the ideal ones (quadric error, M. Garland & P. Heckbert,
 * doi:10.1145/258734.258849). Cheapest first: error of the surface, way to go, shape of the cells left. Points that
 * stay are moved to their ideal places, or as far as cells stay positive. Regions are those of the mesh, 0 meaning
 * outside of the bone, of whose cells no more is asked. Returns the cells left and all points, which keep their ids.
 * Deterministic. */
MeshArrays
CollapseSteinerPoints(const MeshArrays &    mesh,
                      IdType                firstSteiner,
                      const SteinerPlaces & places,
                      const Execution &     execution);
} // namespace tiling
} // namespace bone

#endif
