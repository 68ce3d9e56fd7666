/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneVolumeRegistration_h
#define boneVolumeRegistration_h

#include "boneAtlasVolumeParameters.h"
#include "boneExecution.h"
#include "boneDeformableRegistration.h"
#include "boneStatisticalModel.h"
#include "boneVolumeView.h"

namespace bone
{
/** How well a surface lies on edges of a CT. */
struct BoundarySupport
{
  double visible{ 0.0 };   ///< share of the surface's points that the CT shows
  double supported{ 0.0 }; ///< share of those with an edge within a millimetre
  double residual{ 0.0 };  ///< median distance of points from their edges, mm
};

/** A part of the surface that no edge of the CT supports: where atlas and image disagree. */
struct UnsupportedPatch
{
  Vector3 centre{ Vector3::Zero() };
  double  extent{ 0.0 }; ///< largest distance of a point from the centre, mm
  double  share{ 0.0 };  ///< of the surface's points that the CT shows
};

/** \struct VolumeRegistrationResult
 * \brief What comes of a registration of an atlas to a CT. */
struct VolumeRegistrationResult
{
  bool            mirrored{ false }; ///< the atlas was reflected at x = 0 first (ReflectMesh)
  RigidPose       pose;              ///< of the atlas (reflected, where mirrored), about the mean of its points
  Eigen::VectorXd coefficients;      ///< standard deviations: modes of shape, then smooth modes
  Eigen::Index    shapeModes{ 0 };
  Eigen::Index    smoothModes{ 0 };
  Eigen::VectorXd densityScores; ///< standard deviations of the modes of density; set by TakeVolumeDensity
  /** In the CT's space, with the density of the atlas' mean. The topology is the atlas', or that of ReflectMesh. */
  MeshArrays mesh;
  double     settled{ 0.0 };  ///< mean motion of the surface's points in the last step, mm
  double settledShare{ 0.0 }; ///< of that step that was taken: less than 1 where more would invert tetrahedra for good

  /** Of the six steps of RigidPose::Moved from `pose`, then of the coefficients. */
  Eigen::MatrixXd      covariance;
  std::vector<Vector3> pointDeviations; ///< of each point along the axes of the CT's space, mm

  std::vector<RegionEstimate> regions; ///< volumes; densities are 0 until TakeVolumeDensity; last, as -1, the whole

  BoundarySupport               support;            ///< before the surface settled: what the quality is judged by
  BoundarySupport               settledSupport;     ///< after it
  std::vector<UnsupportedPatch> unsupported;        ///< after it, the largest first
  double                        correlation{ 0.0 }; ///< of bone-likeness of the mean's pose in the search, 0 to 1
  RegistrationQuality           quality{ RegistrationQuality::Failed };
  std::size_t                   repaired{ 0 }; ///< inverted tetrahedra that were made positive
  std::size_t                   inverted{ 0 }; ///< tetrahedra that still are
};

/** \brief Finds an atlas' bone in a CT without a label map, wherever it lies and however it is turned (paper 1, 7).
 *
 * 1. Search: places and poses that lay edges of the mean on edges of the CT, by coarse maps of dense bone.
 * 2. Fit: from the best of them, the surface is drawn to the edges along its normals, over pose, modes of shape and
 * smooth modes (ResidualModes), with the atlas' own variances as prior. An edge beyond another one that leads out of
 * the bone counts less: it is likely a neighbour's. The candidate whose surface has most support is taken.
 * 3. Settling: what the modes leave, a smooth field of offsets across the surface; the interior follows harmonically,
 * and inverted tetrahedra are repaired (UntangleMesh).
 *
 * What the CT does not show follows the atlas. The quality is Ok where 75 % of the visible surface are supported by
 * edges, Suspect from 62 %, else Failed. The same result for any number of threads. Throws std::invalid_argument where
 * the atlas has no density or fewer than four subjects, and where nothing in the CT looks like it. */
VolumeRegistrationResult
RegisterVolume(const StatisticalModelContent & atlas,
               const VolumeView &              ct,
               const AtlasVolumeParameters &   parameters,
               const Execution &               execution);
} // namespace bone

#endif
