/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneVolumeSearch_h
#define boneVolumeSearch_h

#include "boneAtlasVolumeParameters.h"
#include "boneDeformableModel.h"
#include "boneRigidPose.h"
#include "boneVoxelVolume.h"

namespace bone
{
/** \struct VolumeCandidate
 * \brief A place and shape that a bone may have in a CT. */
struct VolumeCandidate
{
  RigidPose       pose;
  Eigen::VectorXd coefficients; ///< standard deviations of the model's first modes of shape
  double score{ 0.0 }; ///< more is better: -log(1 - r^2) of the densities' correlation, times the root of `share`
  double correlation{ 0.0 };
  double share{ 0.0 }; ///< of the samples that lie in the CT
};

/** \brief Where a bone may lie in a CT, wherever and however turned: the best candidates first.
 *
 * Model and CT are reduced to coarse maps of \ref BoneLikeness. A hypothesis draws the coefficient of the first mode of
 * shape, which mostly is size, and lays a random edge of the model onto a random edge of the CT, normal on normal,
 * turned about it at random; how the CT's map falls across the model's edges tells the best ones (compare M. A.
 * Fischler & R. C. Bolles, doi:10.1145/358669.358692). These are refined by Gauss-Newton steps of the maps' correlation
 * over pose and modes of shape, first coarse, then finer, and those that have come to the same place count once.
 * Deterministic, the same for any number of threads. */
std::vector<VolumeCandidate>
SearchVolume(const DeformableModel &       model,
             const VolumeView &            ct,
             const AtlasVolumeParameters & parameters,
             const Execution &             execution);
} // namespace bone

#endif
