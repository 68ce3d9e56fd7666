/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneMeshImprovement_h
#define boneMeshImprovement_h

#include "boneContourShape.h"
#include "boneLabelOutline.h"
#include "boneSmoothingKernel.h"

namespace bone
{
/** Parameters of \ref ImproveMesh. Angles in rad; "cells below" have a smaller dihedral angle. */
struct ImprovementParameters
{
  int    iterations{ 4 };      ///< of smoothing at the start
  double distanceBound{ 0.3 }; ///< mm, how far boundary and interfaces may be faired, and their triangles changed
  int    fairingIterations{ 10 };
  int    rounds{ 4 };             ///< of smoothing, flips, repair and optimisation
  int    optimizationPasses{ 1 }; ///< a round
  double targetAngle{ 0.44 };     ///< cells below are flipped, and their inner points optimised
  double lastAngle{ 0.61 };       ///< cells below are flipped once at the end
  double repairAngle{ 0.29 };     ///< cells below have surface edges flipped and edges collapsed
  double surfaceAngle{ 0.175 };   ///< cells below have their surface points optimised
  double gradation{ 0.65 };       ///< growth of cells inward from the surfaces, mm a mm; 0: no points are added
  double sliverAngle{ 0.0873 };   ///< cells below are mended though surfaces go farther than their bound
  double sliverFactor{ 4.0 };     ///< distance bounds that surfaces may go there
  int    fitPasses{ 4 };          ///< of fitting surfaces, changing their edges and smoothing inside, at the end
  int    morePasses{ 6 };         ///< at most, until the boundary turns by turnShare of what it did; fits grow stiffer
  double turnShare{ 0.494 };      ///< across slices, where contours are given
  double sharpAngle{ 0.7 };       ///< edges that turn by more are collapsed where contours do not ask for them
  double volumeSlack{ 0.0025 };   ///< of the smaller region beside a surface: its volume may follow contours so far
  double flipGain{ 0.1 };         ///< distance bounds, squared, that flips must bring the contours closer on average
  double stiffness{ 0.08 };       ///< of surfaces in the first fit, see SurfaceBending

  const ContourShape * shape{ nullptr };   ///< what surfaces are fitted to; none: the first surfaces
  const LabelOutline * outline{ nullptr }; ///< of the bone in an image, if known: the boundary is fitted to it too
  std::vector<int>     slices; ///< of the mesh's points; empty: turns of all edges count, not those across slices
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
 * 1. Surface points go to their faired place (\ref SurfaceTarget), inner points to the mean of their neighbours.
 * 2. In each round: inner points are smoothed, edges inside regions are halved and collapsed, twice, to the size that
 *    the surfaces ask for (\ref InteriorRefinement; not in the last round), the regions get their volumes back (\ref
 *    VolumeKeeper), then flips, repair (\ref MeshRepair) and optimisation (\ref PointOptimizer) of the worst cells.
 *    Last, cells below surfaceAngle are looked after once more with a wider bound of surfaces (\ref SurfaceBound).
 * 3. In turn: boundary and interfaces are fitted to the contours that the mesh was made of, if they are given, else to
 *    the first surfaces (\ref FitSurfaces); sharp edges that contours do not ask for are collapsed (\ref
 *    CollapseSharpEdges), surface edges flipped where contours lie closer to the other two triangles or these turn less
 *    (\ref FlipToContours); inner points are smoothed, edges there flipped. Where the boundary still turns by more than
 *    turnShare, surfaces get stiffer, and more of these follow. Last the regions get their volumes back once more,
 *    the worst cells' inner points are optimised, and edges there flipped.
 *
 * Sequential; the result depends on the input alone. */
ImprovementReport
ImproveMesh(TetraComplex & complex, const ImprovementParameters & parameters, const ProgressFunction & progress = {});
} // namespace bone

#endif
