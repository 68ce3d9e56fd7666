/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneVolumeSearch_h
#define boneVolumeSearch_h

#include "boneDeformableModel.h"
#include "boneRigidPose.h"
#include "boneVoxelVolume.h"

#include <cstdint>

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

/** \struct VolumeSearchParameters
 * \brief How thoroughly a bone is searched for. */
struct VolumeSearchParameters
{
  int           hypotheses{ 500000 };
  int           refined{ 300 };     ///< of the best hypotheses
  int           kept{ 16 };         ///< candidates that are returned at most
  double        coarse{ 8.0 };      ///< voxels of the first comparison, mm
  double        fine{ 4.0 };        ///< of the last one
  int           modes{ 5 };         ///< of shape, that candidates vary at last
  double        leastShare{ 0.15 }; ///< of the bone that the CT must show
  double        softTissue{ 40.0 }; ///< HU
  std::uint64_t seed{ 1 };
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
SearchVolume(const DeformableModel &        model,
             const VolumeView &             ct,
             const VolumeSearchParameters & parameters,
             const Execution &              execution);
} // namespace bone

#endif
