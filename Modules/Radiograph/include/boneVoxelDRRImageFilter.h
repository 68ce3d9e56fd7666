/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneVoxelDRRImageFilter_h
#define boneVoxelDRRImageFilter_h

#include "boneRadiographSource.h"
#include "boneVoxelRadiograph.h"

#include <itkImage.h>

namespace bone
{
/** \class VoxelDRRImageFilter
 * \brief Digitally reconstructed radiograph of a CT, to compare with that of its model.
 *
 * Joseph's method with exact ends, see ProjectVoxels. Inputs: the image (primary), any origin, spacing, direction and
 * region; "Geometry" and output, see RadiographSource; "Mask" (optional), a label image on the same grid. With a mask a
 * voxel counts where its label is MaskLabel; others are 0, and between a voxel that counts and one that does not the
 * value falls linearly.
 *
 * Parameters: MaskLabel (default 0: any label but 0); HUToAttenuation and its numbers, taken voxel
 * by voxel before interpolation; values below -1000 HU (padding) count as air.
 *
 * Refused: a mask on another grid, and one without a voxel of the label. */
template <typename TInputImage = itk::Image<float, 3>,
          typename TOutputImage = itk::Image<float, 3>,
          typename TMaskImage = itk::Image<short, 3>>
class VoxelDRRImageFilter : public RadiographSource<TOutputImage>
{
public:
  ITK_DISALLOW_COPY_AND_MOVE(VoxelDRRImageFilter);
  using Self = VoxelDRRImageFilter;
  using Superclass = RadiographSource<TOutputImage>;
  using Pointer = itk::SmartPointer<Self>;
  using ConstPointer = itk::SmartPointer<const Self>;
  itkNewMacro(Self);
  itkTypeMacro(VoxelDRRImageFilter, RadiographSource);

  using InputImageType = TInputImage;
  using MaskImageType = TMaskImage;
  using MaskPixelType = typename TMaskImage::PixelType;
  static_assert(TInputImage::ImageDimension == 3 && TMaskImage::ImageDimension == 3, "The images lie in space.");

  using Superclass::SetInput;
  virtual void
  SetInput(const TInputImage * image)
  {
    this->itk::ProcessObject::SetNthInput(0, const_cast<TInputImage *>(image));
  }
  const TInputImage *
  GetInput() const
  {
    return itkDynamicCastInDebugMode<const TInputImage *>(this->GetPrimaryInput());
  }
  virtual void
  SetMask(const TMaskImage * mask)
  {
    this->itk::ProcessObject::SetInput("Mask", const_cast<TMaskImage *>(mask));
  }
  const TMaskImage *
  GetMask() const
  {
    return itkDynamicCastInDebugMode<const TMaskImage *>(this->itk::ProcessObject::GetInput("Mask"));
  }

  itkSetMacro(MaskLabel, MaskPixelType);
  itkGetConstMacro(MaskLabel, MaskPixelType);

protected:
  VoxelDRRImageFilter();
  ~VoxelDRRImageFilter() override = default;

  void
  VerifyInputInformation() ITKv5_CONST override;
  void
  ComputeIntegrals(const std::vector<XRayGeometry::View> & views, const std::vector<float *> & integrals) override;
  void
  PrintSelf(std::ostream & os, itk::Indent indent) const override;

private:
  using RegionType = typename TInputImage::RegionType;

  bool
  IsMasked(MaskPixelType label) const
  {
    return m_MaskLabel == 0 ? label != 0 : label == m_MaskLabel;
  }
  /** The voxels that count and one more on each side within the image; all without a mask. */
  RegionType
  FindRegion() const;
  /** Converted values of a region, 0 where the mask is not. */
  VoxelVolume
  CopyGrid(const RegionType & region, const ParallelFor & parallelFor) const;

  MaskPixelType m_MaskLabel{ 0 };
};
} // namespace bone

#ifndef ITK_MANUAL_INSTANTIATION
#include "boneVoxelDRRImageFilter.hxx"
#endif

#endif
