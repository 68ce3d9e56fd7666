/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneRigidSearch_h
#define boneRigidSearch_h

#include "boneRigidRegistration.h"

namespace bone
{
/** Of the translations that are to be searched: farther poses are beyond them. */
constexpr double BeyondTranslations = 1.02;

/** \brief The first part of RegisterRigid, for one body whose levels have faded where they are cut: searches, each
 * refined and judged, until a pose is Ok. Without covariance. */
RigidRegistrationResult
SearchRigid(const std::vector<MeshArrays> &                        levels,
            const std::vector<RadiographView> &                    views,
            const RigidPose &                                      initial,
            const RigidRadiographParameters &                      parameters,
            const Execution &                                      execution,
            const std::function<void(const RigidPose &, double)> & observe);

/** The costs of the result's pose alone, as JudgePose sets them. */
void
SetCosts(const MeshArrays &                  model,
         const std::vector<RadiographView> & views,
         const RigidRadiographParameters &   parameters,
         const Execution &                   execution,
         RigidRegistrationResult &           result);
} // namespace bone

#endif
