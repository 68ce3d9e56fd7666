/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneRigidRadiographRegistration_h
#define boneRigidRadiographRegistration_h

// ITK's transforms bring an older Eigen of their own, whose eigenvalues these stand for.
#include <Eigen/Eigenvalues>
#include <itkEuler3DTransform.h>

#include "boneDensityHierarchy.h"
#include "boneRigidRegistration.h"

#include <itkDataObjectDecorator.h>
#include <itkImage.h>
#include <itkProcessObject.h>

namespace bone
{
/** \class RigidRadiographRegistration
 * \brief Finds the pose of a density model in one or more X-rays (paper 7).
 *
 * Inputs:
 * - "Model": a DensityHierarchy, all of whose levels have a density (HU: what they exceed water by is what shows);
 * - for each view v = 0, 1, ... its X-ray "Radiograph<v>", an image of columns x rows x 1 line integrals in any unit,
 * its "Geometry<v>" (XRayGeometry), and, if some pixels are not to count, "Weights<v>", an image of that size, 0 to 1.
 *   RadiographPreprocessFilter makes line integrals and weights of what a detector gives. Only the image's pixels are
 *   looked at, its place in space is the geometry's;
 * - "InitialTransform": where the model is about, an itk::Euler3DTransform from the model's space to the geometry's;
 *   without it, as it lies.
 *
 * Output: an itk::Euler3DTransform from the model's space to the geometry's, decorated, its centre the mean of the
 * points of the first level: GetTransform(). GetResult() says how far it is to be trusted. One view tells depth poorly,
 * which the covariance shows.
 *
 * Parameters: \ref RigidRadiographParameters. Each step of the refinement invokes an itk::IterationEvent, at which
 * GetCurrentPose() and GetCurrentCost() are the step's. The same result for any number of threads. Method, quality and
 * covariance: RegisterRigid.
 *
 * Refused: no view, a view without image or geometry, images of another size than their geometry's, values that are not
 * finite where they count, views in which no pixel counts or that are constant, models without density.
 *
 * \tparam TMesh a \ref DensityMesh \tparam TImage a three-dimensional image of a scalar pixel type */
template <typename TMesh = DensityMesh<double>, typename TImage = itk::Image<float, 3>>
class RigidRadiographRegistration : public itk::ProcessObject
{
public:
  ITK_DISALLOW_COPY_AND_MOVE(RigidRadiographRegistration);
  using Self = RigidRadiographRegistration;
  using Superclass = itk::ProcessObject;
  using Pointer = itk::SmartPointer<Self>;
  using ConstPointer = itk::SmartPointer<const Self>;
  itkNewMacro(Self);
  itkTypeMacro(RigidRadiographRegistration, itk::ProcessObject);

  using HierarchyType = DensityHierarchy<TMesh>;
  using TransformType = itk::Euler3DTransform<double>;
  using DecoratedTransformType = itk::DataObjectDecorator<TransformType>;

  // The macro below names it without its namespace.
  template <typename T>
  using DataObjectDecorator = itk::DataObjectDecorator<T>;

  itkSetInputMacro(Model, HierarchyType);
  itkGetInputMacro(Model, HierarchyType);
  itkSetGetDecoratedObjectInputMacro(InitialTransform, TransformType);

  /** View `view`; those before it must be set too. */
  void
  SetView(unsigned int         view,
          const TImage *       radiograph,
          const XRayGeometry * geometry,
          const TImage *       weights = nullptr);
  unsigned int
  GetNumberOfViews() const;

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
  itkGetConstMacro(CurrentCost, double);

protected:
  RigidRadiographRegistration();
  ~RigidRadiographRegistration() override = default;

  void
  VerifyPreconditions() const override;
  void
  GenerateOutputInformation() override
  {}
  void
  GenerateData() override;
  void
  PrintSelf(std::ostream & os, itk::Indent indent) const override;

private:
  static std::string
  NameOf(const char * what, unsigned int view)
  {
    return what + std::to_string(view);
  }
  template <typename TObject>
  const TObject *
  GetOfView(const char * what, unsigned int view) const
  {
    return dynamic_cast<const TObject *>(this->itk::ProcessObject::GetInput(NameOf(what, view)));
  }
  /** The pixels of an image of a view, row by row. */
  std::vector<float>
  CopyPixels(const char * what, unsigned int view) const;

  RigidRegistrationResult m_Result;
  RigidPose               m_CurrentPose;
  double                  m_CurrentCost{ 0.0 };
};
} // namespace bone

#ifndef ITK_MANUAL_INSTANTIATION
#include "boneRigidRadiographRegistration.hxx"
#endif

#endif
