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
  RigidPose pose; ///< about the model's centre: the mean of those points that the views show, or nearly, at the start
  double    cost{ 1.0 };
  std::vector<double> costs; ///< of each view
  /** Of translation (mm) and rotation vector (radians) about the model's centre, along the geometry's axes. */
  Eigen::Matrix<double, 6, 6> covariance{ Eigen::Matrix<double, 6, 6>::Zero() };
  bool                        converged{ false }; ///< the refinement ended before its steps ran out
  RegistrationQuality         quality{ RegistrationQuality::Failed };
  /** How much the cost rises, on average over the six motions, where the model is moved by 8 mm, over the cost. A wrong
   * minimum is flat: with two views, on four bones, true poses have 0.42 and more, wrong ones that no loose motion
   * gives away (see leastDistinctness) 0.32 and less; 0.38 is Ok, though a search takes a pose below 0.8 for Ok only
   * where it found that twice. One view does not always tell: wrong poses of a long bone have up to 1 (see ambiguous);
   * 0.45 is Ok there. */
  double distinctness{ 0.0 };
  /** The same of the one among twelve motions, each way along and about the model's principal axes, that raises the
   * cost least. A pose that edges of something else hold in place, such as those of a cropped CT, slides along them:
   * with two views, on seven bones, wrong poses with a distinctness of 0.38 and more had at most 0.26 of it, true ones
   * at least 0.30. A wrong one is Suspect by that, whatever its distinctness. One view has no hold on its depth anyway.
   */
  double leastDistinctness{ 0.0 };
  int    searches{ 0 };
  bool   beyondSearch{ false }; ///< the pose lies at the end of what was searched: `quality` is Suspect at best
  bool   ambiguous{ false };    ///< from one view, another tilt fits about as well: `quality` is Suspect at best
};

/** \brief Sets cost, costs of the views, both distinctnesses and quality of the pose that `result` has (and of
 * beyondSearch and ambiguous), for a model whose radiographs are as in the last step of RegisterRigid. */
void
JudgePose(const MeshArrays &                  model,
          const std::vector<RadiographView> & views,
          const RigidRadiographParameters &   parameters,
          const Execution &                   execution,
          RigidRegistrationResult &           result);

/** \struct ViewCorrection
 * \brief Where source and detector of a view are, from where its geometry says they are. */
struct ViewCorrection
{
  /** What bodies have to be moved by, in the geometry's space, to look in the stated view as they do in the true one:
   * motion.ToModelSpace(stated) is the true view. Its centre is the mean of the bodies'. */
  RigidPose motion;
  /** Of translation (mm) and rotation vector (radians) of `motion`, along the geometry's axes. */
  Eigen::Matrix<double, 6, 6> covariance{ Eigen::Matrix<double, 6, 6>::Zero() };
};

/** \struct RigidBundleResult
 * \brief What comes of a rigid registration of several bodies. */
struct RigidBundleResult
{
  std::vector<RigidRegistrationResult> bodies;
  /** Of each view; the first view's is the identity, as are all where geometries are taken to be exact. */
  std::vector<ViewCorrection> views;
};

/** \brief Finds the poses of density models in X-rays that show all of them (paper 7).
 *
 * `bodies` are the levels of each model from fine to coarse, all with a density; `views` the X-rays. A bone that leaves
 * the CT ends in a flat cut, of which X-rays show nothing: the model's density fades towards it over CutLength.
 *
 * 1. Each body by itself: from `initial`, evolution strategies search the box of SearchTranslation and SearchRotation
 *    with the coarsest level on small images. The pose found is refined by Levenberg-Marquardt steps on finer and finer
 *    levels and images. Where it is not distinct, the search begins again with other random numbers, until three
 *    searches found the same pose or Searches are done; the best of all is the result. The cost is
 *    PatchGradientCorrelation's.
 * 2. All bodies that did not fail together, on the finest level and image (a bundle adjustment: B. Triggs et al.,
 * Vision Algorithms, 2000): their poses; how far each body's surface lies outside of its model's as a whole, normal
 * with SurfaceDeviation beforehand, which one view cannot tell from depth; and, where ViewTranslationDeviation or
 *    ViewRotationDeviation is not 0, the motions of all views but the first, normal with these deviations. Poses then
 *    refer to the first view. Radiographs show all bodies: what one casts is no clutter to another. The cost counts
 *    against what is known beforehand by the ratio of its curvature to the scatter of its gradient.
 *
 * The covariance is that of the minimum of a sum of many patches' costs, from what these contribute to its gradient
 * (the "sandwich" of P. J. Huber, 1967), which needs no model of the noise.
 *
 * The same result for any number of threads. `observe` is called after each step of the refinements with the pose (in
 * the second part, that of the first body) and its cost. Throws std::invalid_argument where a view cannot be used, with
 * its number, and where the motion of the only view is asked for. */
RigidBundleResult
RegisterRigidBodies(const std::vector<std::vector<MeshArrays>> &           bodies,
                    const std::vector<RadiographView> &                    views,
                    const RigidPose &                                      initial,
                    const RigidRadiographParameters &                      parameters,
                    const Execution &                                      execution,
                    const std::function<void(const RigidPose &, double)> & observe = {});

/** \brief The same of one body. */
RigidRegistrationResult
RegisterRigid(const std::vector<MeshArrays> &                        levels,
              const std::vector<RadiographView> &                    views,
              const RigidPose &                                      initial,
              const RigidRadiographParameters &                      parameters,
              const Execution &                                      execution,
              const std::function<void(const RigidPose &, double)> & observe = {});
} // namespace bone

#endif
