/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneDeformableRadiographRegistration_h
#define boneDeformableRadiographRegistration_h

#include "boneRadiographRegistrationBase.h"

#include "boneDeformableRegistration.h"
#include "boneDensityMesh.h"
#include "boneStatisticalModel.h"

namespace bone
{
/** \class DeformableRadiographRegistration
 * \brief Finds pose, shape and density of a bone in one or more X-rays, by an atlas (paper 7).
 *
 * Inputs:
 * - "Model": a StatisticalModel with a density (HU: what they exceed water by is what shows);
 * - views "Radiograph<v>", "Geometry<v>" and "Weights<v>", and "InitialTransform", from the space of the atlas to the
 *   geometry's: \ref RadiographRegistrationBase.
 *
 * Outputs:
 * - the bone found, a \ref DensityMesh of the atlas' topology in the geometry's space, mm: GetOutput(). Tetrahedra that
 *   the shape inverts are repaired, with a warning (UntangleMesh), which moves some points a little;
 * - an itk::Euler3DTransform from the space of the atlas to the geometry's, decorated, its centre the middle
 *   of what the views show of the atlas' mean at the start: GetTransformOutput(), GetTransform().
 * GetResult() has coefficients in standard deviations, covariance and the deviations of the points.
 *
 * Parameters: \ref DeformableRadiographParameters. Each step invokes an itk::IterationEvent, at which
 * GetCurrentCoefficients() and GetCurrentCost() are the step's. The same result for any number of threads. Method:
 * RegisterDeformable.
 *
 * Refused, beside what RadiographRegistrationBase refuses: an atlas without density, one view without a prior of the
 * pose (TranslationDeviation and RotationDeviation), views in which no pixel counts or that are constant, a shape whose
 * inverted tetrahedra cannot be repaired.
 *
 * \tparam TMesh a \ref DensityMesh \tparam TImage a three-dimensional image of a scalar pixel type */
template <typename TMesh = DensityMesh<double>, typename TImage = itk::Image<float, 3>>
class DeformableRadiographRegistration : public RadiographRegistrationBase<TImage>
{
public:
  ITK_DISALLOW_COPY_AND_MOVE(DeformableRadiographRegistration);
  using Self = DeformableRadiographRegistration;
  using Superclass = RadiographRegistrationBase<TImage>;
  using Pointer = itk::SmartPointer<Self>;
  using ConstPointer = itk::SmartPointer<const Self>;
  itkNewMacro(Self);
  itkTypeMacro(DeformableRadiographRegistration, RadiographRegistrationBase);

  using MeshType = TMesh;
  using typename Superclass::DecoratedTransformType;
  using typename Superclass::TransformType;

  itkSetInputMacro(Model, StatisticalModel);
  itkGetInputMacro(Model, StatisticalModel);

  BONE_FILTER_PARAMETERS(DeformableRadiographParameters, BONE_DEFORMABLE_RADIOGRAPH_PARAMETERS)

  using Superclass::MakeOutput;
  itk::DataObject::Pointer
  MakeOutput(itk::ProcessObject::DataObjectPointerArraySizeType index) override
  {
    if (index == 0)
    {
      return MeshType::New().GetPointer();
    }
    return DecoratedTransformType::New().GetPointer();
  }
  MeshType *
  GetOutput()
  {
    return static_cast<MeshType *>(this->GetPrimaryOutput());
  }
  DecoratedTransformType *
  GetTransformOutput()
  {
    return static_cast<DecoratedTransformType *>(this->itk::ProcessObject::GetOutput(1));
  }
  /** What the last update found. */
  const TransformType *
  GetTransform() const
  {
    return static_cast<const DecoratedTransformType *>(this->itk::ProcessObject::GetOutput(1))->Get();
  }
  itkGetConstReferenceMacro(Result, DeformableRegistrationResult);

  itkGetConstReferenceMacro(CurrentCoefficients, Eigen::VectorXd);

protected:
  DeformableRadiographRegistration();
  ~DeformableRadiographRegistration() override = default;

  void
  VerifyPreconditions() const override;
  void
  GenerateData() override;
  void
  PrintSelf(std::ostream & os, itk::Indent indent) const override;

private:
  /** Makes the inverted tetrahedra of the bone found positive. */
  void
  RepairMesh(const MeshArrays & mean);

  DeformableRegistrationResult m_Result;
  Eigen::VectorXd              m_CurrentCoefficients;
};
} // namespace bone

#ifndef ITK_MANUAL_INSTANTIATION
#include "boneDeformableRadiographRegistration.hxx"
#endif

#endif
