/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneRigidPose.h"

#include <Eigen/Eigenvalues> // in place of that of ITK's own, older Eigen
#include <Eigen/Geometry>
#include <itkEuler3DTransform.h>

namespace bone
{
RigidPose
RigidPose::Moved(const Eigen::Matrix<double, 6, 1> & step) const
{
  // Of exp(step): rotation about the centre and then the translation, both in the model's axes.
  const Vector3 turn = step.tail<3>();
  const double  angle = turn.norm();
  RigidPose     moved = *this;
  if (angle > 0.0)
  {
    moved.rotation = rotation * Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix();
  }
  moved.translation += rotation * step.head<3>();
  return moved;
}

Eigen::Matrix<double, 6, 1>
RigidPose::StepTo(const RigidPose & other) const
{
  const Eigen::AngleAxisd     turn(Eigen::Quaterniond(rotation.transpose() * other.rotation).normalized());
  Eigen::Matrix<double, 6, 1> step;
  step << rotation.transpose() * (other.translation - translation), turn.angle() * turn.axis();
  return step;
}

RigidPose
RigidPose::About(const Vector3 & newCentre) const
{
  return { rotation, this->Apply(newCentre) - newCentre, newCentre };
}

XRayGeometry::View
RigidPose::ToModelSpace(const XRayGeometry::View & view) const
{
  XRayGeometry::View seen = view;
  seen.source = this->ApplyInverse(view.source);
  seen.direction = rotation.transpose() * view.direction;
  seen.detectorOrigin = this->ApplyInverse(view.detectorOrigin);
  seen.detectorU = rotation.transpose() * view.detectorU;
  seen.detectorV = rotation.transpose() * view.detectorV;
  return seen;
}

itk::SmartPointer<itk::Euler3DTransform<double>>
RigidPose::ToTransform() const
{
  auto                                      transform = itk::Euler3DTransform<double>::New();
  itk::Euler3DTransform<double>::MatrixType matrix;
  itk::Point<double, 3>                     c;
  itk::Vector<double, 3>                    t;
  for (int i = 0; i < 3; ++i)
  {
    for (int j = 0; j < 3; ++j)
    {
      matrix(i, j) = rotation(i, j);
    }
    c[i] = centre[i];
    t[i] = translation[i];
  }
  transform->SetCenter(c);
  transform->SetMatrix(matrix, 1e-6);
  transform->SetTranslation(t);
  return transform;
}

RigidPose
RigidPose::FromTransform(const itk::Euler3DTransform<double> & transform)
{
  RigidPose pose;
  for (int i = 0; i < 3; ++i)
  {
    for (int j = 0; j < 3; ++j)
    {
      pose.rotation(i, j) = transform.GetMatrix()(i, j);
    }
    pose.centre[i] = transform.GetCenter()[i];
    pose.translation[i] = transform.GetTranslation()[i];
  }
  return pose;
}
} // namespace bone
