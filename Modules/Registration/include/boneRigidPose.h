/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneRigidPose_h
#define boneRigidPose_h

#include "boneXRayGeometry.h"

#include <itkSmartPointer.h>

namespace itk
{
template <typename>
class Euler3DTransform;
}

namespace bone
{
/** \struct RigidPose
 * \brief A rigid motion x -> rotation (x - centre) + centre + translation, from a model's space into that of the
 * X-ray geometry, mm. */
struct RigidPose
{
  static constexpr Eigen::Index Steps = 6; ///< numbers of a small motion

  Eigen::Matrix3d rotation{ Eigen::Matrix3d::Identity() };
  Vector3         translation{ Vector3::Zero() };
  Vector3         centre{ Vector3::Zero() };

  Vector3
  Apply(const Vector3 & x) const
  {
    return rotation * (x - centre) + centre + translation;
  }
  Vector3
  ApplyInverse(const Vector3 & x) const
  {
    return rotation.transpose() * (x - centre - translation) + centre;
  }

  /** This pose after a small motion of the model in its own space: translation along x, y, z (mm), rotation vector
   * about axes through the centre (radians), the order of RadiographModes. */
  RigidPose
  Moved(const Eigen::Matrix<double, 6, 1> & step) const;

  /** The step that leads from this pose to another one of the same centre: Moved(StepTo(other)) is the other. */
  Eigen::Matrix<double, 6, 1>
  StepTo(const RigidPose & other) const;

  /** The same motion about another centre. */
  RigidPose
  About(const Vector3 & newCentre) const;

  /** The view as the model sees it: the model stays, source and detector move. */
  XRayGeometry::View
  ToModelSpace(const XRayGeometry::View & view) const;

  itk::SmartPointer<itk::Euler3DTransform<double>>
  ToTransform() const;
  static RigidPose
  FromTransform(const itk::Euler3DTransform<double> & transform);
};
} // namespace bone

#endif
