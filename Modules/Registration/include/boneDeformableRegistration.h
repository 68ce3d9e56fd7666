/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneDeformableRegistration_h
#define boneDeformableRegistration_h

#include "boneDeformableRadiographParameters.h"
#include "boneExecution.h"
#include "boneRadiographView.h"
#include "boneRigidRegistration.h"
#include "boneStatisticalModel.h"

#include <functional>

namespace bone
{
/** \struct RegionEstimate
 * \brief What a registration says of one region of the bone, with standard deviations. */
struct RegionEstimate
{
  int    region{ 0 };
  double volume{ 0.0 }; ///< mm^3
  double volumeDeviation{ 0.0 };
  double density{ 0.0 }; ///< mean over the volume, HU
  double densityDeviation{ 0.0 };
  double mass{ 0.0 }; ///< density times volume, HU mm^3
  double massDeviation{ 0.0 };
};

/** \struct DeformableRegistrationResult
 * \brief What comes of a deformable registration: the most probable bone, and how sure it is. */
struct DeformableRegistrationResult
{
  RigidPose       pose; ///< of the atlas, about the mean of those of its points that the views show at the start
  Eigen::VectorXd coefficients; ///< standard deviations: modes of shape, smooth modes, modes of density
  Eigen::Index    shapeModes{ 0 };
  Eigen::Index    smoothModes{ 0 };
  Eigen::Index    densityModes{ 0 };
  MeshArrays      mesh; ///< in the geometry's space

  /** Posterior covariance: of the six steps of RigidPose::Moved from `pose`, then of the coefficients. */
  Eigen::MatrixXd      covariance;
  std::vector<Vector3> pointDeviations; ///< of each point along the geometry's axes, mm

  std::vector<RegionEstimate> regions; ///< and last, as region -1, the whole bone

  double              cost{ 0.0 }; ///< of the gradients
  std::vector<double> costs;       ///< of each view
  bool                converged{ false };
  RegistrationQuality quality{ RegistrationQuality::Failed };
  double              distinctness{ 0.0 };
  double              precision{ 0.0 };          ///< by which the gradients' cost counts against the prior
  double              intensityPrecision{ 0.0 }; ///< by which that of the line integrals does; 0: not used
};

/** \brief Finds the bone that X-rays show: pose, shape and density of an atlas (paper 7).
 *
 * The bone is the atlas' mean, moved by a pose, by its modes of shape and by smooth displacements of what a few
 * subjects' modes leave out (ResidualModes), with its modes of density and one density for each region as a whole. From
 * `initial`, an evolution strategy searches the pose and the first modes of shape, about the middle of what the views
 * show of the mean there: X-rays of a part of a long bone say little of the rest. Then Levenberg-Marquardt steps over
 * all parameters, from coarse to fine images, find the maximum of the posterior. The prior is a standard normal
 * distribution of all coefficients, the likelihood exp(-precision * cost) with the cost of PatchGradientCorrelation, on
 * the finest images times that of IntensityDifference near the bone, where the X-rays are line integrals of
 * attenuation. A precision is that at which the curvature of the cost agrees with how much the gradient's shares of
 * separate blocks of the images scatter: it needs no model of the noise, and counts noise that correlates over a block
 * once.
 *
 * The quality is that of RegisterRigid for the bone found, but Suspect where the distinctness is below 1.5.
 * Throws std::invalid_argument where a view cannot be used, where its values are no line integrals of attenuation and
 * Intensities is on, where the atlas has fewer than four subjects and SmoothDeviation is 0, and where one view alone is
 * given without a prior of the pose: size and depth could not be told apart. */
DeformableRegistrationResult
RegisterDeformable(const StatisticalModelContent &                              atlas,
                   const std::vector<RadiographView> &                          views,
                   const RigidPose &                                            initial,
                   const DeformableRadiographParameters &                       parameters,
                   const Execution &                                            execution,
                   const std::function<void(const Eigen::VectorXd &, double)> & observe = {});
} // namespace bone

#endif
