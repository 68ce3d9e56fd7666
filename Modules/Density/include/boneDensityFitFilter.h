/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneDensityFitFilter_h
#define boneDensityFitFilter_h

#include "boneDensityFitPlan.h"
#include "boneDensityMesh.h"

#include <itkImage.h>
#include <itkMultiThreaderBase.h>
#include <itkProcessObject.h>

namespace bone
{
/** \class DensityFitFilter
 * \brief Fits a Bernstein polynomial to an image in every tetrahedron of a mesh (paper 3).
 *
 * Inputs: the mesh (primary, "Mesh"), of any valid shape, and "Image", a 3D image whose geometry (origin, spacing,
 * direction, start index) is honoured. Output: the mesh, its points and attributes as they were, with the density's
 * degree, coefficients and quantity; a density that the input held is replaced.
 *
 * Each tetrahedron samples the image at a fixed pattern of interior points (\ref DensityFitKernel), more than twice as
 * many as there are coefficients and several for each voxel in it (\ref DensityFitPlan), by linear interpolation; the
 * coefficients are the least-squares fit. Only points inside the tetrahedron count, so a bone's surface is as sharp as
 * the mesh. Where a mesh reaches beyond the outermost voxel centres, the nearest value between them is taken.
 *
 * Parameters:
 * - Degree: 0..8, default 3; 1, 4, 10, 20, 35, 56, 84, 120, 165 coefficients for each tetrahedron.
 * - Continuous: one least-squares spline for each region (\ref MakeDensityContinuous) in place of tetrahedra on their
 *   own; needs degree 1 or more. Jumps remain between regions. Default off.
 * - Tikhonov: weight of the term that holds control values near the data in small tetrahedra (\ref DensityFitKernel),
 *   default 1e-4, no unit; 0: plain least squares, which reproduces polynomials of the degree exactly. Linear fields
 * are exact in any case.
 * - Quantity: what the image's values mean, default HounsfieldUnit.
 *
 * Throws itk::ExceptionObject where an input is missing, the image is empty, the mesh has no tetrahedra or points that
 * are not finite, the mesh lies wholly outside the image, a voxel value used is not finite, or a parameter does not
 * suit.
 *
 * \sa DensityImageFilter */
template <typename TImage = itk::Image<float, 3>, typename TMesh = DensityMesh<double>>
class DensityFitFilter : public itk::ProcessObject
{
public:
  ITK_DISALLOW_COPY_AND_MOVE(DensityFitFilter);
  using Self = DensityFitFilter;
  using Superclass = itk::ProcessObject;
  using Pointer = itk::SmartPointer<Self>;
  using ConstPointer = itk::SmartPointer<const Self>;
  itkNewMacro(Self);
  itkTypeMacro(DensityFitFilter, itk::ProcessObject);

  using ImageType = TImage;
  using MeshType = TMesh;
  static_assert(TImage::ImageDimension == 3, "The image must be three-dimensional.");

  using Superclass::SetInput;
  void
  SetInput(const TMesh * mesh);
  void
  SetMesh(const TMesh * mesh)
  {
    this->SetInput(mesh);
  }
  const TMesh *
  GetInput() const;
  const TMesh *
  GetMesh() const
  {
    return this->GetInput();
  }
  itkSetInputMacro(Image, TImage);
  itkGetInputMacro(Image, TImage);

  TMesh *
  GetOutput();
  const TMesh *
  GetOutput() const;

  itkSetMacro(Degree, int);
  itkGetConstMacro(Degree, int);
  itkSetMacro(Continuous, bool);
  itkGetConstMacro(Continuous, bool);
  itkBooleanMacro(Continuous);
  itkSetMacro(Tikhonov, double);
  itkGetConstMacro(Tikhonov, double);
  itkSetEnumMacro(Quantity, DensityQuantity);
  itkGetEnumMacro(Quantity, DensityQuantity);

  /** After an update: share of the sample points that lay beyond the image's border (half a voxel outside its outermost
   * centres) and took the nearest value. */
  itkGetConstMacro(OutsideFraction, double);

  /** After an update: the largest number of coefficients that are free, all of them unless Continuous. */
  itkGetConstMacro(NumberOfFreeCoefficients, std::size_t);

  using Superclass::MakeOutput;
  itk::DataObject::Pointer
  MakeOutput(itk::ProcessObject::DataObjectPointerArraySizeType index) override;

protected:
  DensityFitFilter();
  ~DensityFitFilter() override = default;

  void
  VerifyPreconditions() ITKv5_CONST override;
  void
  GenerateData() override;
  void
  PrintSelf(std::ostream & os, itk::Indent indent) const override;

private:
  void
  VerifyInputs(const MeshArrays & arrays) const;

  /** Fits all batches into arrays.coefficients. */
  void
  FitBatches(const DensityFitPlan & plan, MeshArrays & arrays);

  int             m_Degree{ 3 };
  bool            m_Continuous{ false };
  double          m_Tikhonov{ 1e-4 };
  DensityQuantity m_Quantity{ DensityQuantity::HounsfieldUnit };
  double          m_OutsideFraction{ 0.0 };
  std::size_t     m_NumberOfFreeCoefficients{ 0 };
};

extern template class DensityFitFilter<itk::Image<float, 3>, DensityMesh<double>>;
} // namespace bone

#ifndef ITK_MANUAL_INSTANTIATION
#include "boneDensityFitFilter.hxx"
#endif

#endif
