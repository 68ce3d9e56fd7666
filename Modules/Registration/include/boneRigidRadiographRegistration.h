/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneRigidRadiographRegistration_h
#define boneRigidRadiographRegistration_h

#include "boneRadiographRegistrationBase.h"

#include "boneDensityHierarchy.h"
#include "boneRigidRegistration.h"

namespace bone
{
/** \class RigidRadiographRegistration
 * \brief Finds the pose of a density model in one or more X-rays (paper 7).
 *
 * Inputs:
 * - "Model": a DensityHierarchy, all of whose levels have a density (HU: what they exceed water by is what shows);
 * - views "Radiograph<v>", "Geometry<v>" and "Weights<v>", and "InitialTransform": \ref RadiographRegistrationBase.
 *
 * Output: an itk::Euler3DTransform from the model's space to the geometry's, decorated, its centre the mean of the
 * points of the first level: GetTransform(). GetResult() says how far it is to be trusted. One view tells depth poorly,
 * which the covariance shows.
 *
 * Parameters: \ref RigidRadiographParameters. Each step of the refinement invokes an itk::IterationEvent, at which
 * GetCurrentPose() and GetCurrentCost() are the step's. The same result for any number of threads. Method, quality and
 * covariance: RegisterRigid.
 *
 * Refused, beside what RadiographRegistrationBase refuses: views in which no pixel counts or that are constant, models
 * without density.
 *
 * \tparam TMesh a \ref DensityMesh \tparam TImage a three-dimensional image of a scalar pixel type */
template <typename TMesh = DensityMesh<double>, typename TImage = itk::Image<float, 3>>
class RigidRadiographRegistration : public RadiographRegistrationBase<TImage>
{
public:
  ITK_DISALLOW_COPY_AND_MOVE(RigidRadiographRegistration);
  using Self = RigidRadiographRegistration;
  using Superclass = RadiographRegistrationBase<TImage>;
  using Pointer = itk::SmartPointer<Self>;
  using ConstPointer = itk::SmartPointer<const Self>;
  itkNewMacro(Self);
  itkTypeMacro(RigidRadiographRegistration, RadiographRegistrationBase);

  using HierarchyType = DensityHierarchy<TMesh>;
  using typename Superclass::DecoratedTransformType;
  using typename Superclass::TransformType;

  itkSetInputMacro(Model, HierarchyType);
  itkGetInputMacro(Model, HierarchyType);

  BONE_FILTER_PARAMETERS(RigidRadiographParameters, BONE_RIGID_RADIOGRAPH_PARAMETERS)

  using Superclass::MakeOutput;
  itk::DataObject::Pointer
  MakeOutput(itk::ProcessObject::DataObjectPointerArraySizeType) override
  {
    return DecoratedTransformType::New().GetPointer();
  }
  DecoratedTransformType *
  GetOutput()
  {
    return static_cast<DecoratedTransformType *>(this->GetPrimaryOutput());
  }
  /** What the last update found. */
  const TransformType *
  GetTransform() const
  {
    return static_cast<const DecoratedTransformType *>(this->GetPrimaryOutput())->Get();
  }
  itkGetConstReferenceMacro(Result, RigidRegistrationResult);

  itkGetConstReferenceMacro(CurrentPose, RigidPose);

protected:
  RigidRadiographRegistration();
  ~RigidRadiographRegistration() override = default;

  void
  VerifyPreconditions() const override;
  void
  GenerateData() override;
  void
  PrintSelf(std::ostream & os, itk::Indent indent) const override;

private:
  RigidRegistrationResult m_Result;
  RigidPose               m_CurrentPose;
};
} // namespace bone

#ifndef ITK_MANUAL_INSTANTIATION
#include "boneRigidRadiographRegistration.hxx"
#endif

#endif
