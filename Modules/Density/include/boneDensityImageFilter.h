/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneDensityImageFilter_h
#define boneDensityImageFilter_h

#include "boneDensityImageParameters.h"
#include "boneDensityMesh.h"
#include "boneExecution.h"

#include <itkImage.h>
#include <itkImageSource.h>

namespace bone
{
/** \class DensityImageFilter
 * \brief Samples a density model at the voxel centres of an image grid (model to voxels; paper 3, Figure 9).
 *
 * Inputs: the mesh (primary, "Mesh"), with a density; "ReferenceImage", optional, any 3D image. Output: an image whose
 * geometry is the reference image's if one is set, else Size, Origin, Spacing and Direction (mm, LPS; start index 0). A
 * voxel whose centre lies in no tetrahedron has OutsideValue (NaN too, for real pixels); on shared faces the
 * tetrahedron of lowest id counts. Values are in the units of the density; for an integer pixel type they are rounded
 * and clipped to it.
 *
 * Tetrahedra are drawn into the voxel rows they meet (\ref DensityRaster), over the requested region only, so
 * that the output can be streamed.
 *
 * Throws itk::ExceptionObject where the mesh is missing or has no density, or where the grid is not given. */
template <typename TMesh = DensityMesh<double>, typename TOutputImage = itk::Image<float, 3>>
class DensityImageFilter : public itk::ImageSource<TOutputImage>
{
public:
  ITK_DISALLOW_COPY_AND_MOVE(DensityImageFilter);
  using Self = DensityImageFilter;
  using Superclass = itk::ImageSource<TOutputImage>;
  using Pointer = itk::SmartPointer<Self>;
  using ConstPointer = itk::SmartPointer<const Self>;
  itkNewMacro(Self);
  itkTypeMacro(DensityImageFilter, itk::ImageSource);

  using MeshType = TMesh;
  using OutputImageType = TOutputImage;
  using PixelType = typename TOutputImage::PixelType;
  using SizeType = typename TOutputImage::SizeType;
  using PointType = typename TOutputImage::PointType;
  using SpacingType = typename TOutputImage::SpacingType;
  using DirectionType = typename TOutputImage::DirectionType;
  using ReferenceImageType = itk::ImageBase<3>;
  static_assert(TOutputImage::ImageDimension == 3, "The image must be three-dimensional.");

  using Superclass::SetInput;
  virtual void
  SetInput(const TMesh * mesh)
  {
    this->SetPrimaryInput(const_cast<TMesh *>(mesh));
  }
  const TMesh *
  GetInput() const
  {
    return itkDynamicCastInDebugMode<const TMesh *>(this->GetPrimaryInput());
  }
  itkSetInputMacro(ReferenceImage, ReferenceImageType);
  itkGetInputMacro(ReferenceImage, ReferenceImageType);

  itkSetMacro(Size, SizeType);
  itkGetConstReferenceMacro(Size, SizeType);
  itkSetMacro(Origin, PointType);
  itkGetConstReferenceMacro(Origin, PointType);
  itkSetMacro(Spacing, SpacingType);
  itkGetConstReferenceMacro(Spacing, SpacingType);
  itkSetMacro(Direction, DirectionType);
  itkGetConstReferenceMacro(Direction, DirectionType);

  BONE_FILTER_PARAMETERS(DensityImageParameters, BONE_DENSITY_IMAGE_PARAMETERS)

protected:
  DensityImageFilter();
  ~DensityImageFilter() override = default;

  void
  VerifyPreconditions() const override;
  void
  GenerateOutputInformation() override;
  void
  GenerateInputRequestedRegion() override;
  void
  GenerateData() override;
  void
  PrintSelf(std::ostream & os, itk::Indent indent) const override;

private:
  SizeType      m_Size;
  PointType     m_Origin;
  SpacingType   m_Spacing;
  DirectionType m_Direction;
};

extern template class DensityImageFilter<DensityMesh<double>, itk::Image<float, 3>>;
} // namespace bone

#ifndef ITK_MANUAL_INSTANTIATION
#include "boneDensityImageFilter.hxx"
#endif

#endif
