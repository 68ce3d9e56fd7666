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
 * \brief Finds the poses of one or more density models in one or more X-rays (paper 7).
 *
 * Inputs:
 * - "Model": a DensityHierarchy, all of whose levels have a density (HU: what they exceed water by is what shows);
 * - "Model1", "Model2", ...: further bodies that the same X-rays show, each free to move (SetModel(body, ...));
 * - views "Radiograph<v>", "Geometry<v>" and "Weights<v>", and "InitialTransform": \ref RadiographRegistrationBase.
 *
 * Outputs: for each body an itk::Euler3DTransform from the model's space to the geometry's, decorated, its centre the
 * mean of those points of the first level that the views show, or nearly, at the start: GetTransform(body).
 * GetResult(body) says how far it is to be trusted. One view tells depth poorly, which the covariance shows.
 * GetViewCorrections() has where the views are, where ViewTranslationDeviation or ViewRotationDeviation says that their
 * geometries may be off.
 *
 * Parameters: \ref RigidRadiographParameters. Each step of the refinement invokes an itk::IterationEvent, at which
 * GetCurrentPose() (of the body that is refined; of the first one, where all are) and GetCurrentCost() are the step's.
 * The same result for any number of threads. Method, quality and covariance: RegisterRigidBodies.
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

  /** The model of body 0, 1, ...; those before it must be set too. */
  void
  SetModel(unsigned int body, const HierarchyType * model);
  unsigned int
  GetNumberOfBodies() const;

  BONE_FILTER_PARAMETERS(RigidRadiographParameters, BONE_RIGID_RADIOGRAPH_PARAMETERS)

  using Superclass::MakeOutput;
  itk::DataObject::Pointer
  MakeOutput(itk::ProcessObject::DataObjectPointerArraySizeType) override
  {
    return DecoratedTransformType::New().GetPointer();
  }
  DecoratedTransformType *
  GetOutput(unsigned int body = 0)
  {
    return static_cast<DecoratedTransformType *>(this->itk::ProcessObject::GetOutput(body));
  }
  /** What the last update found. */
  const TransformType *
  GetTransform(unsigned int body = 0) const
  {
    return static_cast<const DecoratedTransformType *>(this->itk::ProcessObject::GetOutput(body))->Get();
  }
  const RigidRegistrationResult &
  GetResult(unsigned int body = 0) const
  {
    return m_Result.bodies.at(body);
  }
  /** Of each view. */
  const std::vector<ViewCorrection> &
  GetViewCorrections() const
  {
    return m_Result.views;
  }

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
  static std::string
  NameOfModel(unsigned int body)
  {
    return body == 0 ? "Model" : "Model" + std::to_string(body);
  }
  const HierarchyType *
  GetModelOf(unsigned int body) const
  {
    return dynamic_cast<const HierarchyType *>(this->itk::ProcessObject::GetInput(NameOfModel(body)));
  }
  std::vector<MeshArrays>
  CopyLevels(unsigned int body) const;

  RigidBundleResult m_Result;
  RigidPose         m_CurrentPose;
};
} // namespace bone

#ifndef ITK_MANUAL_INSTANTIATION
#include "boneRigidRadiographRegistration.hxx"
#endif

#endif
