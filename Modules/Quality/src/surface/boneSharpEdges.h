/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneSharpEdges_h
#define boneSharpEdges_h

#include "boneMeshRepair.h"
#include "boneSurfaceEnergy.h"

namespace bone
{
struct SharpEdgeParameters
{
  double angle{ 0.7 };        ///< rad; edges of more dihedral deviation are looked at
  double cosineFloor{ 0.98 }; ///< of the dihedral angle that cells may have afterwards, though they were better
};

/** \brief Collapses edges of boundary and interfaces of large dihedral deviation where contours do not ask for it.
 *
 * Where contours join, part or end, tilings have folds: pockets and fins between two sheets of a surface, which no
 * motion of points takes out, as both sheets lie on the same contours. Ends of a sharp edge are collapsed onto a
 * neighbour where \ref SurfaceEnergy falls by it, the sharpest edges and the best neighbours first. The repair's rules
 * on topology, cells and bounds hold; points of curves, corners and flat cuts stay. Returns the number of collapses. */
std::size_t
CollapseSharpEdges(TetraComplex &              complex,
                   const PointMover &          mover,
                   MeshRepair &                repair,
                   SurfaceEnergy &             energy,
                   const SharpEdgeParameters & parameters);
} // namespace bone

#endif
