/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneSubjectPage_h
#define boneSubjectPage_h

#include "boneReportPage.h"
#include "boneSubjectEvaluation.h"

namespace bone
{
/** A page of a subject against an atlas: how unusual shape and density are, the coefficients of the modes in standard
 * deviations, and the subject on the atlas' topology beside the atlas' mean. The caller adds warnings and provenance.
 */
ReportPage
MakeSubjectPage(const std::string &             name,
                const SubjectEvaluation &       evaluation,
                const MeshArrays &              subject,
                const StatisticalModelContent & atlas);
} // namespace bone

#endif
