/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneRadiographRegistrationBase_h
#define boneRadiographRegistrationBase_h

// ITK's transforms bring an older Eigen of their own, whose eigenvalues these stand for.
#include <Eigen/Eigenvalues>
#include <itkEuler3DTransform.h>

#include "boneRadiographView.h"
#include "boneRigidPose.h"

#include <itkDataObjectDecorator.h>
#include <itkImage.h>
#include <itkProcessObject.h>

#include <string>
#include <vector>

namespace bone
{
/** \class RadiographRegistrationBase
 * \brief What registrations of a model to X-rays share: views, initial transform, and the cost of the current step.
 *
 * Inputs:
 * - for each view v = 0, 1, ... its X-ray "Radiograph<v>", an image of columns x rows x 1 line integrals in any unit,
 *   its "Geometry<v>" (XRayGeometry), and, if some pixels are not to count, "Weights<v>", an image of that size, 0 to
 *   1. RadiographPreprocessFilter makes line integrals and weights of what a detector gives. Only the image's pixels
 *   are looked at, its place in space is the geometry's;
 * - "InitialTransform": where the model is about, an itk::Euler3DTransform from the model's space to the geometry's;
 *   without it, as it lies.
 *
 * Refused: no view, a view without image or geometry, images of another size than their geometry's, values that are not
 * finite where they count, weights that are not from 0 to 1.
 *
 * \tparam TImage a three-dimensional image of a scalar pixel type */
template <typename TImage>
class RadiographRegistrationBase : public itk::ProcessObject
{
public:
  ITK_DISALLOW_COPY_AND_MOVE(RadiographRegistrationBase);
  using Self = RadiographRegistrationBase;
  using Superclass = itk::ProcessObject;
  using Pointer = itk::SmartPointer<Self>;
  using ConstPointer = itk::SmartPointer<const Self>;
  itkTypeMacro(RadiographRegistrationBase, itk::ProcessObject);

  using TransformType = itk::Euler3DTransform<double>;
  using DecoratedTransformType = itk::DataObjectDecorator<TransformType>;

  // The macro below names it without its namespace.
  template <typename T>
  using DataObjectDecorator = itk::DataObjectDecorator<T>;

  itkSetGetDecoratedObjectInputMacro(InitialTransform, TransformType);

  /** View `view`; those before it must be set too. */
  void
  SetView(unsigned int         view,
          const TImage *       radiograph,
          const XRayGeometry * geometry,
          const TImage *       weights = nullptr);
  unsigned int
  GetNumberOfViews() const;

  /** The cost of the last step, for observers of itk::IterationEvent. */
  itkGetConstMacro(CurrentCost, double);

protected:
  RadiographRegistrationBase() = default;
  ~RadiographRegistrationBase() override = default;

  void
  VerifyPreconditions() const override;
  void
  GenerateOutputInformation() override
  {}
  void
  PrintSelf(std::ostream & os, itk::Indent indent) const override;

  /** The views as plain arrays. Throws itk::ExceptionObject for what is refused. */
  std::vector<RadiographView>
  CopyViews() const;

  /** Of the input "InitialTransform", the identity without it. */
  RigidPose
  GetInitialPose() const;

  /** Invokes an itk::IterationEvent. */
  void
  TellStep(double cost)
  {
    m_CurrentCost = cost;
    this->InvokeEvent(itk::IterationEvent());
  }

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
  void
  VerifyPixels(const RadiographView & xray, unsigned int view) const;

  double m_CurrentCost{ 0.0 };
};
} // namespace bone

#ifndef ITK_MANUAL_INSTANTIATION
#include "boneRadiographRegistrationBase.hxx"
#endif

#endif
