/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneBuildPlan_h
#define boneBuildPlan_h

#include "boneLabelChoice.h"
#include "boneResolution.h"

namespace bone
{
/** What a build is made from: CT, and where the bone is. The order of voxels is the bone's own (\ref OwnOrientation).
 */
struct BuildInput
{
  CTImage::Pointer      ct;
  LabelImage::Pointer   labels;         ///< of the bone, 0 elsewhere; null without a label map
  ContourStack::Pointer contours;       ///< initial ones; may be null
  double                surface{ 0.0 }; ///< of the label, mm^2; 0 without a label map
};

/** CT and label map cut down to the bone and the plan's margin, in the bone's own orientation; the CT as it is where
 * `labels` is null. Throws itk::ExceptionObject where the two have not the same grid, the label does not occur, or none
 * of several labels is chosen (\ref VerifyOneBone). */
BuildInput
CropToBone(const CTImage *             ct,
           const LabelImage *          labels,
           const ContourStack *        contours,
           const BuildPlanParameters & plan);

/** The same of a bone of a label map. Where its box is known, CT and labels are read within it and the plan's margin
 * alone, if they are read by regions (\ref OpenCT, \ref OpenLabelFile). The bone's label is the plan's. */
BuildInput
CropToBone(const CTImage *             ct,
           const LabelledBone &        bone,
           const ContourStack *        contours,
           const BuildPlanParameters & plan);

/** The same in the CT's order of voxels. */
BuildInput
CropInOrder(const CTImage * ct, const LabelledBone & bone, const ContourStack * contours, BuildPlanParameters plan);

/** How far the quality stage may move surfaces, mm: half a pixel of the slices, but no more than keeps the overlap with
 * a label map of large voxels. */
double
FindDistanceBound(const itk::ImageBase<3> & ct, const BuildPlanParameters & plan);

/** The outline that an atlas found in `ct` is drawn to the CT's edges by the snakes, within 1.5 mm or two voxels:
 * nobody drew it. */
void
DrawOutlineToEdges(const itk::ImageBase<3> & ct, SnakeContourParameters & contours);

/** Numbers of tetrahedra of the coarser levels; what is below 1 is a share of the first. Throws std::invalid_argument
 * where they do not descend from `finest`. */
std::vector<IdType>
CountTetrahedraOfLevels(const std::vector<double> & levels, IdType finest);

/** Sets input and parameters on the pipeline, label, axis and distance bound of the stages as the plan has them. The
 * stages work on the image's own grid (\ref OnOwnGrid). */
void
SetBuild(const BuildInput & input, const BuildParameters & parameters, BuildPipeline & pipeline);

/** \brief Sets input and parameters on the pipeline and finds the resolution.
 *
 * Slice step and contour spacing are those of the plan where it has them, else such that the mesh has about the number
 * of tetrahedra asked for after the quality stage, which is then up to date (\ref AdjustResolution). `tried`, where it
 * is not empty, is told of each tiling. */
Resolution
PlanBuild(const BuildInput &                                      input,
          const BuildParameters &                                 parameters,
          BuildPipeline &                                         pipeline,
          const std::function<void(const Resolution &, IdType)> & tried = {});

/** A view from the front (AP) that holds the model and its margin: 400 pixels on the longer side, source at 1000 mm,
 * detector 200 mm behind the bone's centre. */
XRayGeometry::Pointer
FrontView(const BuildPipeline::MeshType * mesh);

/** The same from the patient's left: the back is at the right of its image, as on a sagittal plane. */
XRayGeometry::Pointer
LateralView(const BuildPipeline::MeshType * mesh);

/** Sets the numbers of tetrahedra of the coarser levels on the collapse, as the plan says, and brings the pipeline up
 * to date. A null geometry is the front view of the finest level. */
void
FinishBuild(const BuildPlanParameters & plan, const XRayGeometry * geometry, BuildPipeline & pipeline);
} // namespace bone

#endif
