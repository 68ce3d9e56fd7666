/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneBuildPage_h
#define boneBuildPage_h

#include "boneBuildEvaluation.h"

namespace bone
{
/** The finest level and the CT's slices as a page has them; LowerDegreeErrors is left to the caller. */
BuildPageParts
PackPageParts(const Evidence & evidence, const ContourStack & stack, const MeshArrays & finest, const Window & window);

/** A page of a build: the levels' figures, the model in 3D with its contours, CT slices, cut plane, radiographs,
 * density and quality. Of an evaluation with a page's parts; the pipeline is up to date. The caller adds the
 * provenance.
 */
ReportPage
MakeBuildPage(const BuildReport & report, const Evaluation & evaluation, BuildPipeline & pipeline);
} // namespace bone

#endif
