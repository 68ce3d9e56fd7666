/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneMeshImprovement_h
#define boneMeshImprovement_h

#include "boneContourShape.h"
#include "boneLabelOutline.h"
#include "boneMeshQualityParameters.h"
#include "boneSmoothingKernel.h"

namespace bone
{
/** Parameters of \ref ImproveMesh. Angles in rad; "cells below" have a smaller dihedral angle. */
struct ImprovementParameters : MeshQualityParameters
{
  double lastAngle{ 0.61 };       ///< cells below are flipped once at the end
  double repairAngle{ 0.29 };     ///< cells below have surface edges flipped and edges collapsed
  double surfaceAngle{ 0.175 };   ///< cells below have their surface points optimised
  double sliverAngle{ 0.0873 };   ///< cells below are repaired with the wider bound, sliverFactor times distanceBound
  int    fitPasses{ 4 };          ///< of fitting surfaces, changing their edges and smoothing inside, at the end
  int    morePasses{ 6 };         ///< at most, with rising stiffness, until the deviation falls to deviationShare
  double deviationShare{ 0.494 }; ///< of the boundary's first mean dihedral deviation across slices, with contours
  double sharpAngle{ 0.7 };       ///< edges of more dihedral deviation are collapsed unless contours ask for them
  double volumeSlack{ 0.0025 };   ///< share of the smaller region beside a surface that its volume may change by
  double flipGain{ 0.1 };         ///< distance bounds, squared, that flips must bring the contours closer on average

  const ContourShape * shape{ nullptr };   ///< what surfaces are fitted to; none: the first surfaces
  const LabelOutline * outline{ nullptr }; ///< of the bone in an image, if known: the boundary is fitted to it too
  std::vector<int> slices; ///< of the mesh's points; empty: the deviation of all edges counts, not that across slices
};

struct ImprovementReport
{
  SmoothingReport smoothing;
  std::size_t     flips{ 0 };        ///< inside regions
  std::size_t     repairs{ 0 };      ///< surface edges flipped, edges collapsed at bad cells
  std::size_t     splits{ 0 };       ///< edges inside regions halved
  std::size_t     collapses{ 0 };    ///< of short edges inside regions
  std::size_t     contourFlips{ 0 }; ///< of surface edges, towards contours
  std::size_t     sharpEdges{ 0 };   ///< of surfaces, collapsed
  std::size_t     optimized{ 0 };    ///< points moved by optimisation
};

/** \brief Makes a valid layered mesh good to compute with.
 *
 * 1. Surface points go to their faired place, inner points to the mean of their neighbours.
 * 2. In each round: inner points are smoothed, edges inside regions are halved and collapsed, twice, to the size that
 *    the surfaces ask for (not in the last round), the regions get their volumes back, then flips, repair and
 * optimisation of the worst cells. Last, cells below surfaceAngle are improved once more with a wider bound of
 * surfaces.
 * 3. In several passes: boundary and interfaces are fitted to the contours that the mesh was made of, if they are
 * given, else to the first surfaces; sharp edges that contours do not ask for are collapsed; surface edges are flipped
 * where contours lie closer to the other two triangles or the dihedral deviation falls; inner points are smoothed and
 * edges inside flipped. While the boundary's mean dihedral deviation is above deviationShare of its first value, more
 * passes with stiffer surfaces follow. Last the regions get their volumes back once more, the worst cells' inner points
 * are optimised, and edges there flipped.
 *
 * The result depends on the input alone. */
ImprovementReport
ImproveMesh(TetraComplex & complex, const ImprovementParameters & parameters, const Execution & execution = {});
} // namespace bone

#endif
