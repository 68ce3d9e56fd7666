/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneSurfaceFit_h
#define boneSurfaceFit_h

#include "boneContourShape.h"
#include "boneLabelOutline.h"
#include "boneMeshQualityParameters.h"
#include "bonePointMover.h"

namespace bone
{
struct SurfaceFitParameters
{
  int    steps{ 1 };
  double stiffness{ MeshQualityParameters().stiffness }; ///< of edges against bending, see SurfaceBending; 0: none
  double cosineFloor{ 0.985 }; ///< of the dihedral angle that no move may go below, unless it was below
};

/** What surfaces are fitted to. */
struct SurfaceFitTarget
{
  const SurfaceTarget & first;              ///< surfaces as they were
  const ContourShape *  shape{ nullptr };   ///< what they were made of
  const LabelOutline *  outline{ nullptr }; ///< of the boundary
};

/** \brief Moves points of boundary and interfaces until the surfaces lie on a target in the mean, and bend little.
 *
 * Points on a curved surface leave the triangles between them inside it. Here springs draw places on the triangles to
 * the target, and the surfaces resist bending (\ref SurfaceBending): the fixed point is a least-squares fit of the
 * triangles to the target by hinged plates. The target is the contours on their slices, where they are given, and with
 * a small weight their shape between slices; without them, and where they are not near by, the first surfaces. Where
 * the outline of a label is given, its faces draw the boundary: next to contours most where they look along the slices'
 * normal, as that is what contours do not know. Points of curves, corners and flat cuts stay, and each move is one of
 * the mover. Returns the number of moves. */
std::size_t
FitSurfaces(TetraComplex &               complex,
            PointMover &                 mover,
            const SurfaceFitTarget &     target,
            const SurfaceFitParameters & parameters,
            const Execution &            execution = {});
} // namespace bone

#endif
