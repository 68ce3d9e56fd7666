/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneSurfaceFit_h
#define boneSurfaceFit_h

#include "boneContourShape.h"
#include "bonePointMover.h"

namespace bone
{
struct SurfaceFitParameters
{
  int    steps{ 5 };
  double stiffness{ 0.0 };     ///< weight of bending, next to distance; 0: none
  double cosineFloor{ 0.985 }; ///< of the dihedral angle that no move may go below, unless it was below
};

/** \brief Moves points of boundary and interfaces along their normals until the surfaces lie on a target in the mean.
 *
 * Points on a curved surface leave the triangles between them inside it. Here each point goes by the mean, weighted by
 * its shape function, of the distances from the triangles at it to the target along their normals, less the stiffness
 * times the umbrella's umbrella there: the fixed point is the least-squares fit of the triangles to the target with a
 * thin plate's resistance to bending (Richardson iteration with the lumped mass matrix). The target is the contours on
 * their slices, where they are given, and with a small weight their shape between slices; without them, and where they
 * are not near by, the first surfaces. Contours beside an edge also draw its points along the surface. Points of
 * curves, corners and flat cuts stay, and each move is one of the mover. Returns the number of moves. */
std::size_t
FitSurfaces(TetraComplex &               complex,
            PointMover &                 mover,
            const SurfaceTarget &        first,
            const ContourShape *         shape,
            const SurfaceFitParameters & parameters);
} // namespace bone

#endif
