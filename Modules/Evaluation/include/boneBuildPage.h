/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneBuildPage_h
#define boneBuildPage_h

#include "boneBuildEvaluation.h"

namespace bone
{
/** A page of a build: the levels' figures, the model in 3D with its contours, CT slices, cut plane, radiographs,
 * density and quality. `ct` as it was given to Evaluate; the pipeline is up to date. The caller adds the provenance. */
ReportPage
MakeBuildPage(const BuildReport & report,
              const Evaluation &  evaluation,
              const Evidence &    evidence,
              BuildPipeline &     pipeline);
} // namespace bone

#endif
