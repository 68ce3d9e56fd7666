/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneBuildEvaluation_h
#define boneBuildEvaluation_h

#include "boneBuildReport.h"
#include "bonePictures.h"

namespace bone
{
/** What a model is compared with. */
struct Evidence
{
  CTImage::ConstPointer    ct;
  LabelImage::ConstPointer mask; ///< not 0 in the bone; null: the voxels inside the model's finest level
  /** The CT as it is in its file, where `ct` is a part of it: the pictures tell its slices; null: `ct` is all. */
  itk::ImageBase<3>::ConstPointer whole;
};

/** The measurements of a built model and the pictures made on the way. */
struct Evaluation
{
  std::vector<LevelReport> levels;
  LabelImage::ConstPointer mask;        ///< the evidence's, or what stands for it
  Window                   window;      ///< of the CT in pictures
  Canvas                   slices;      ///< of the CT with contours
  Canvas                   cutPlane;    ///< the CT and the levels in the plane of the bone's largest extent
  Canvas                   radiographs; ///< of the CT and the levels, in the pipeline's view and from the side
};

/** Compares each level of an up-to-date pipeline with the CT, by volume, surface, density and radiograph. The
 * radiograph of the CT counts the mask's voxels only. */
Evaluation
Evaluate(BuildPipeline & pipeline, const Evidence & evidence);
} // namespace bone

#endif
