/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneRigidBundle_h
#define boneRigidBundle_h

#include "boneRigidRegistration.h"

namespace bone
{
/** \brief The last part of RegisterRigid: the poses of bodies `which` of the result, how far their surfaces lie outside
 * of the models', and the views' motions where these are estimated, refined together (a bundle adjustment). Sets poses,
 * covariances, judgement and the views' motions. `models` are those of all bodies. */
void
AdjustRigidBundle(const std::vector<MeshArrays> &                        models,
                  const std::vector<std::size_t> &                       which,
                  const std::vector<RadiographView> &                    views,
                  const RigidRadiographParameters &                      parameters,
                  const Execution &                                      execution,
                  const std::function<void(const RigidPose &, double)> & observe,
                  RigidBundleResult &                                    result);
} // namespace bone

#endif
