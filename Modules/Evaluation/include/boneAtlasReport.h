/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneAtlasReport_h
#define boneAtlasReport_h

#include "boneAtlasRegistration.h"
#include "boneModelEvaluation.h"
#include "boneModelTraining.h"
#include "boneReportPage.h"
#include "boneStatisticalModel.h"
#include "boneSubjectEvaluation.h"

namespace bone
{
/** What is to be known of a trained atlas beside its modes. */
struct AtlasReport
{
  std::vector<SubjectDeviation> subjects;
  std::vector<ModelQuality>     shape;   ///< empty where it was not evaluated
  std::vector<DensityQuality>   density; ///< empty where it was not, or there is none
};

/** Compactness, generalisation by leave-one-out and specificity of the set's subjects, all of which are held in memory:
 * shapes, and densities where `model`, which was trained on them, has one. Sizes are taken out where the model takes
 * them out. Throws std::invalid_argument for fewer than three subjects. */
void
EvaluateAtlas(const TrainingSet & set, const StatisticalModel & model, AtlasReport & report);

/** Subjects with their distances and scores, and the curves of EvaluateAtlas: `subjects`, `shape`, `density`. */
nlohmann::json
ReportAtlas(const AtlasReport & report);

/** A subject against an atlas: `shape`, `density` where there is one, `registered`, and of a registration
 * `surfaceDistanceMm` and `mirrored`. `registration`: none where the subject was on the atlas' topology. */
nlohmann::json
ReportSubject(const SubjectEvaluation & subject, const RegistrationReport * registration);

/** The atlas with sliders for its modes, their pictures, curves and subjects. */
ReportPage
MakeAtlasPage(const StatisticalModel & model, const AtlasReport & report, const std::string & name);
} // namespace bone

#endif
