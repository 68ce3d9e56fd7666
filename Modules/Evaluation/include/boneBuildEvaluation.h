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
  LabelImage::ConstPointer mask; ///< 1 in the bone; null: the voxels inside the model's finest level
};

/** The measurements of a built model and the pictures made on the way. */
struct Evaluation
{
  std::vector<LevelReport> levels;
  PictureImage::Pointer    slices;
  PictureImage::Pointer    cutPlane;
  PictureImage::Pointer    radiographs;
};

/** Compares each level of an up-to-date pipeline with the CT, by volume, surface, density and radiograph. The
 * radiograph of the CT counts the mask's voxels only. */
Evaluation
Evaluate(BuildPipeline & pipeline, const Evidence & evidence);
} // namespace bone

#endif
