/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneRigidCostMetric.h"

#include <Eigen/Geometry>

namespace bone
{
namespace
{
Eigen::Matrix3d
Skew(const Vector3 & v)
{
  Eigen::Matrix3d skew;
  skew << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return skew;
}

/** What a change of the rotation vector `turn` turns by in the turned axes: the right Jacobian of the exponential. */
Eigen::Matrix3d
RightJacobian(const Vector3 & turn)
{
  const double          angle = turn.norm();
  const Eigen::Matrix3d skew = Skew(turn);
  if (angle < 1e-6)
  {
    return Eigen::Matrix3d::Identity() - 0.5 * skew;
  }
  return Eigen::Matrix3d::Identity() - (1.0 - std::cos(angle)) / (angle * angle) * skew +
         (angle - std::sin(angle)) / (angle * angle * angle) * skew * skew;
}
} // namespace

RigidCostMetric::RigidCostMetric()
{
  m_Parameters.SetSize(6);
  m_Parameters.Fill(0.0);
}

void
RigidCostMetric::SetCost(const RigidCost * cost, const RigidPose & start)
{
  m_Cost = cost;
  m_Start = start;
  m_Parameters.Fill(0.0);
  this->Modified();
}

RigidPose
RigidCostMetric::GetPose() const
{
  Eigen::Matrix<double, 6, 1> step;
  std::copy(m_Parameters.begin(), m_Parameters.end(), step.data());
  return m_Start.Moved(step);
}

void
RigidCostMetric::Initialize()
{
  if (m_Cost == nullptr)
  {
    itkExceptionMacro("The cost is missing: give it by SetCost.");
  }
}

void
RigidCostMetric::SetParameters(ParametersType & parameters)
{
  if (parameters.GetSize() != 6)
  {
    itkExceptionMacro("A pose has 6 parameters, not " << parameters.GetSize() << '.');
  }
  m_Parameters = parameters;
}

void
RigidCostMetric::UpdateTransformParameters(const DerivativeType & derivative, ParametersValueType factor)
{
  for (unsigned int i = 0; i < 6; ++i)
  {
    m_Parameters[i] += factor * derivative[i];
  }
}

RigidCostMetric::MeasureType
RigidCostMetric::GetValue() const
{
  m_Value = m_Cost->Evaluate(this->GetPose(), Execution());
  return m_Value;
}

void
RigidCostMetric::GetDerivative(DerivativeType & derivative) const
{
  MeasureType value;
  this->GetValueAndDerivative(value, derivative);
}

void
RigidCostMetric::GetValueAndDerivative(MeasureType & value, DerivativeType & derivative) const
{
  const RigidPose   pose = this->GetPose();
  const MetricValue there = m_Cost->EvaluateDerivatives(pose, Execution());
  value = m_Value = there.cost;
  // The cost's steps begin at the pose, the parameters' at the start.
  const Vector3         turn(m_Parameters[3], m_Parameters[4], m_Parameters[5]);
  const Eigen::Matrix3d rotation = m_Start.rotation.transpose() * pose.rotation;
  const Vector3         shift = rotation * there.gradient.head<3>();
  const Vector3         turned = RightJacobian(turn).transpose() * there.gradient.tail<3>();
  derivative.SetSize(6);
  for (unsigned int i = 0; i < 3; ++i)
  {
    derivative[i] = -shift[i];
    derivative[i + 3] = -turned[i];
  }
}

void
RigidCostMetric::PrintSelf(std::ostream & os, itk::Indent indent) const
{
  Superclass::PrintSelf(os, indent);
  os << indent << "Parameters: " << m_Parameters << '\n';
}
} // namespace bone
