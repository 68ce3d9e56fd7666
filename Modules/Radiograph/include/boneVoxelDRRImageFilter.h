/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneVoxelDRRImageFilter_h
#define boneVoxelDRRImageFilter_h

#include "boneRadiographSource.h"
#include "boneVoxelDRRParameters.h"
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
 * Parameters: \ref VoxelDRRParameters and \ref RadiographParameters. HU are converted voxel by voxel before
 * interpolation; values below -1000 HU (padding) then count as air. Without a conversion the values themselves are
 * integrated: a CT's air then counts -1000 HU along its whole way. With AboveAir (default off) a voxel counts max(0, HU
 * + 1000) instead, so that air is 0, and the integral of a homogeneous object is its chord times HU + 1000.
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
  itkSetInputMacro(Mask, TMaskImage);
  itkGetInputMacro(Mask, TMaskImage);

  using Superclass::SetParameters;
  BONE_PLAIN_FILTER_PARAMETERS(VoxelDRRParameters, BONE_VOXEL_DRR_PARAMETERS)

protected:
  VoxelDRRImageFilter();
  ~VoxelDRRImageFilter() override = default;

  void
  VerifyInputInformation() const override;
  void
  ComputeIntegrals(const std::vector<XRayGeometry::View> & views,
                   const Execution &                       execution,
                   const std::vector<float *> &            integrals) override;

private:
  using RegionType = typename TInputImage::RegionType;

  bool
  IsMasked(MaskPixelType label) const
  {
    const int counted = m_Parameters.maskLabel;
    return counted == 0 ? label != 0 : static_cast<int>(label) == counted;
  }
  /** The voxels that count and one more on each side within the image; all without a mask. */
  RegionType
  FindRegion() const;
  /** Converted values of a region, 0 where the mask does not count. */
  VoxelVolume
  CopyGrid(const RegionType & region, const Execution & execution) const;
};
} // namespace bone

#ifndef ITK_MANUAL_INSTANTIATION
#include "boneVoxelDRRImageFilter.hxx"
#endif

#endif
