/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneLandmarkProjection_h
#define boneLandmarkProjection_h

#include "bonePoseInitializer.h"

namespace bone
{
using LandmarkStep = Eigen::Matrix<double, 6, 1>;
using LandmarkMatrix = Eigen::Matrix<double, 6, 6>;

/** The matrix of the cross product: CrossMatrix(a) b = a x b. */
Eigen::Matrix3d
CrossMatrix(const Vector3 & a);

/** Points on the detector of a view, in mm along U and V from the centre of pixel (0, 0), with derivatives. */
class LandmarkProjection
{
public:
  /** Throws itk::ExceptionObject where the view cannot be used. */
  explicit LandmarkProjection(const XRayGeometry::View & view);

  struct Ray
  {
    Vector3 origin;
    Vector3 direction; ///< unit
  };
  Ray
  GetRay(const Vector2 & pixel) const;

  Vector2
  ToMillimetres(const Vector2 & pixel) const
  {
    return pixel.cwiseProduct(m_View.spacing);
  }

  /** Where a point appears, and its derivatives by the point where they are asked for; false for a point that is not
   * before the source. */
  bool
  Project(const Vector3 & point, Vector2 & place, Eigen::Matrix<double, 2, 3> * derivatives = nullptr) const;

private:
  XRayGeometry::View m_View;
  Vector3            m_Normal; ///< from source to detector
};

/** The sum of the squared distances, mm, of moved points from the rays to their pixels, whose minima are found from
 * starts that are far off. */
class RayFit
{
public:
  RayFit(const std::vector<LandmarkProjection> & projections, const std::vector<LandmarkPair> & pairs);

  /** The best translation for the pose's rotation; `wish` is that along directions that the rays do not determine. */
  void
  PlaceBest(const std::vector<std::size_t> & sample, const Vector3 & wish, RigidPose & pose) const;

  /** Moves the pose downhill by at most so many damped Gauss-Newton steps; the sum at its end. */
  double
  Descend(const std::vector<std::size_t> & sample, int steps, RigidPose & pose) const;

private:
  double
  Cost(const std::vector<std::size_t> & sample, const RigidPose & pose) const;

  struct Line
  {
    Vector3         point;   ///< of the model
    Vector3         origin;  ///< of the ray
    Eigen::Matrix3d project; ///< onto the plane perpendicular to the ray
  };
  std::vector<Line> m_Lines;
};

/** The robust distance of landmarks and images of the model's points on the detectors, with the prior: sums of Tukey's
 * function of the distances, over the landmarks' variance. */
class DetectorFit
{
public:
  /** Holds references to the first three. The prior's pose is about the centre of the poses that are asked for. */
  DetectorFit(const std::vector<LandmarkProjection> & projections,
              const std::vector<LandmarkPair> &       pairs,
              const PoseInitializerParameters &       parameters,
              const std::optional<PosePrior> &        prior);

  /** mm at the detector; infinite for a point that is not before the source. */
  double
  GetDistance(const RigidPose & pose, std::size_t pair) const;

  double
  Cost(const RigidPose & pose) const;

  /** Levenberg-Marquardt to a minimum; the cost there. */
  double
  Descend(RigidPose & pose) const;

  /** The inverse covariance of the step by which the pose may be wrong. */
  LandmarkMatrix
  GetInformation(const RigidPose & pose) const;

private:
  /** Gauss-Newton matrix and half of the gradient. */
  void
  Linearize(const RigidPose & pose, LandmarkMatrix & matrix, LandmarkStep & gradient) const;

  const std::vector<LandmarkProjection> & m_Projections;
  const std::vector<LandmarkPair> &       m_Pairs;
  const PoseInitializerParameters &       m_Parameters;
  std::optional<PosePrior>                m_Prior;
};
} // namespace bone

#endif
