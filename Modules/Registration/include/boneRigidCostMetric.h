/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneRigidCostMetric_h
#define boneRigidCostMetric_h

// ITK's transforms bring an older Eigen of their own, whose eigenvalues these stand for.
#include <Eigen/Eigenvalues>
#include <itkObjectToObjectMetricBase.h>

#include "boneRigidCost.h"

namespace bone
{
/** \class RigidCostMetric
 * \brief A RigidCost as ITK's v4 optimisers take it.
 *
 * Its six parameters are the step of RigidPose::Moved from a start: translation (mm) and rotation vector (radians) of
 * the model in its own axes about its centre. As optimisers of ITK have it, the derivative points downhill. */
class RigidCostMetric : public itk::ObjectToObjectMetricBaseTemplate<double>
{
public:
  ITK_DISALLOW_COPY_AND_MOVE(RigidCostMetric);
  using Self = RigidCostMetric;
  using Superclass = itk::ObjectToObjectMetricBaseTemplate<double>;
  using Pointer = itk::SmartPointer<Self>;
  using ConstPointer = itk::SmartPointer<const Self>;
  itkNewMacro(Self);
  itkTypeMacro(RigidCostMetric, itk::ObjectToObjectMetricBaseTemplate);

  /** The cost, which must outlive this, and the pose at which all parameters are 0. */
  void
  SetCost(const RigidCost * cost, const RigidPose & start);
  /** The pose of the parameters as they are. */
  RigidPose
  GetPose() const;

  void
  Initialize() override;
  NumberOfParametersType
  GetNumberOfParameters() const override
  {
    return 6;
  }
  NumberOfParametersType
  GetNumberOfLocalParameters() const override
  {
    return 6;
  }
  bool
  HasLocalSupport() const override
  {
    return false;
  }
  void
  SetParameters(ParametersType & parameters) override;
  const ParametersType &
  GetParameters() const override
  {
    return m_Parameters;
  }
  void
  UpdateTransformParameters(const DerivativeType & derivative, ParametersValueType factor = 1.0) override;

  MeasureType
  GetValue() const override;
  void
  GetDerivative(DerivativeType & derivative) const override;
  void
  GetValueAndDerivative(MeasureType & value, DerivativeType & derivative) const override;

protected:
  RigidCostMetric();
  ~RigidCostMetric() override = default;
  void
  PrintSelf(std::ostream & os, itk::Indent indent) const override;

private:
  const RigidCost * m_Cost{ nullptr };
  RigidPose         m_Start;
  ParametersType    m_Parameters;
};
} // namespace bone

#endif
