/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef bonePoseInitializer_h
#define bonePoseInitializer_h

#include "boneLandmarkIO.h"
#include "boneParameters.h"
#include "boneRigidPose.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace bone
{
/** \defgroup PoseInitializer A first pose from landmarks
 *
 * Where a model lies, from a few of its points that were found on radiographs: of point sources or parallel beams, one
 * view or several.
 *
 * The pose is sought by random samples (RANSAC, Fischler and Bolles 1981) of four pairs each, or by all samples where
 * they are few, until one without outliers is all but sure to be among them. A sample's poses are the minima of the
 * distance of its points to their rays, from 24 rotations that cover all (the object-space error of Lu, Hager and
 * Mjolsness 2000, for the rays of several views). The samples' poses are compared by the squared distances of all pairs
 * on the detector, each counted up to InlierDistance. The best ones are refined by Levenberg-Marquardt with Tukey's
 * weights, which are 0 from InlierDistance on.
 * \{ */

/** A point of the model and where it appears. */
struct LandmarkPair
{
  std::string  name;
  Vector3      point{ Vector3::Zero() }; ///< in the model's space, mm
  Vector2      pixel{ Vector2::Zero() }; ///< column and row, fractional
  unsigned int view{ 0 };                ///< number of the view, from 0 on
};

/** Pairs of the same name, view after view. Throws itk::ExceptionObject where a view has a landmark that the model has
 * not, or nothing can be paired. */
std::vector<LandmarkPair>
MatchLandmarks(const std::vector<Landmark> & model, const std::vector<std::vector<ImageLandmark>> & views);

// clang-format off
#define BONE_POSE_INITIALIZER_PARAMETERS(value, flag) \
  value(double, inlierDistance, InlierDistance, 5.0, ParameterRange::Length(), "mm at the detector", \
    "landmark-tolerance", "Landmarks that the pose leaves further off than this are outliers") \
  value(double, landmarkDeviation, LandmarkDeviation, 1.0, ParameterRange::Length(), "mm at the detector", \
    "landmark-deviation", "Standard deviation of a landmark's place, along columns and along rows") \
  value(int, samples, Samples, 300, ParameterRange::Between(1, 100000), "", "landmark-samples", \
    "Most samples of four landmarks that are tried") \
  value(std::uint64_t, seed, Seed, 1, ParameterRange::Any(), "", "", "Seed of the samples")
// clang-format on

/** Parameters of EstimatePose. */
BONE_PARAMETER_STRUCT(PoseInitializerParameters, BONE_POSE_INITIALIZER_PARAMETERS);

/** A pose that is known roughly, for example the identity for a CT of a patient who lies as the views' angles say. */
struct PosePrior
{
  RigidPose pose;
  double    translationDeviation{ 50.0 }; ///< mm along each axis, of the landmarks' centroid
  double    rotationDeviation{ 0.3 };     ///< radians about each axis
};

struct PoseEstimate
{
  /** Its centre is the landmarks' centroid, or that of the prior's pose. */
  RigidPose           pose;
  double              rms{ 0.0 }; ///< root mean square of the inliers' distances, mm at the detector
  std::vector<bool>   inlier;     ///< of each pair
  std::vector<double> distance; ///< of each pair: between the landmark and its model point's image, mm at the detector
  /** Of the step (mm, radians; see RigidPose::Moved) by which the pose may be wrong, for landmarks of
   * LandmarkDeviation. What they do not determine, as the depth in parallel beams, has a deviation of 10 m. */
  Eigen::Matrix<double, 6, 6> covariance{ Eigen::Matrix<double, 6, 6>::Zero() };
  /** Another pose explains the landmarks about as well (as with four coplanar points seen from afar): look for more
   * landmarks, or give a prior. */
  bool ambiguous{ false };
};

/** The pose that brings the model's points to their pixels.
 *
 * Four landmarks at least, six or more for outliers to be told. Three are enough with a prior, or where two views that
 * differ in direction show all three. A single parallel beam leaves the depth: that of the prior, or of the model where
 * it is.
 *
 * Throws itk::ExceptionObject where there are fewer, the points lie on a line, a number is not finite, a pair's view
 * does not exist, or fewer than half of the pairs (or too few points) agree on a pose. */
PoseEstimate
EstimatePose(const std::vector<XRayGeometry::View> & views,
             const std::vector<LandmarkPair> &       pairs,
             const PoseInitializerParameters &       parameters = {},
             const std::optional<PosePrior> &        prior = {});
/** \} */
} // namespace bone

#endif
