/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneRigidRegistration_h
#define boneRigidRegistration_h

#include "boneExecution.h"
#include "boneMeshArrays.h"
#include "boneRadiographView.h"
#include "boneRigidPose.h"
#include "boneRigidRadiographParameters.h"

#include <functional>

namespace bone
{
/** Whether a registration is to be believed. */
enum class RegistrationQuality : int
{
  Ok = 0,
  Suspect = 1, ///< to be looked at
  Failed = 2
};

template <>
struct ParameterChoices<RegistrationQuality>
{
  static constexpr std::array<const char *, 3> names = { "ok", "suspect", "failed" };
};

/** \struct RigidRegistrationResult
 * \brief What comes of a rigid registration. */
struct RigidRegistrationResult
{
  RigidPose           pose; ///< about the model's centre, which is the mean of its points
  double              cost{ 1.0 };
  std::vector<double> costs; ///< of each view
  /** Of translation (mm) and rotation vector (radians) about the model's centre, along the geometry's axes. */
  Eigen::Matrix<double, 6, 6> covariance{ Eigen::Matrix<double, 6, 6>::Zero() };
  bool                        converged{ false }; ///< the refinement ended before its steps ran out
  RegistrationQuality         quality{ RegistrationQuality::Failed };
  /** How much the cost rises, on average over the six motions, where the model is moved by 8 mm, over the cost. A wrong
   * minimum is flat: with two views, on four bones, true poses have 0.42 and more, wrong ones 0.43 and less, most
   * 0.28. One view does not always tell: wrong poses of a long bone have up to 1. */
  double distinctness{ 0.0 };
  int    searches{ 0 };
};

/** \brief Finds the pose of a density model in X-rays (paper 7).
 *
 * `levels` are the model from fine to coarse, all with a density; `views` the X-rays. From `initial`, evolution
 * strategies search the box of SearchTranslation and SearchRotation with the coarsest level on small images. The pose
 * found is refined by Levenberg-Marquardt steps on finer and finer levels and images. Where it is not distinct, the
 * search begins again with other random numbers; the best of all is the result. The cost is
 * PatchGradientCorrelation's.
 *
 * A bone that leaves the CT ends in a flat cut, of which X-rays show nothing: the model's density fades towards it over
 * CutLength.
 *
 * The covariance is that of the minimum of a sum of many patches' costs, from what these contribute to its gradient
 * (the "sandwich" of P. J. Huber, 1967), which needs no model of the noise; and that of a surface that lies a little
 * outside of the bone's or within it, which one view cannot tell from depth.
 *
 * The same result for any number of threads. `observe` is called after each step of the refinement with the pose and
 * its cost. Throws std::invalid_argument where a view cannot be used, with its number. */
RigidRegistrationResult
RegisterRigid(const std::vector<MeshArrays> &                        levels,
              const std::vector<RadiographView> &                    views,
              const RigidPose &                                      initial,
              const RigidRadiographParameters &                      parameters,
              const Execution &                                      execution,
              const std::function<void(const RigidPose &, double)> & observe = {});
} // namespace bone

#endif
