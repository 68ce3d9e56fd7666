/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef bonePhantomImageSource_h
#define bonePhantomImageSource_h

#include "boneExecution.h"
#include "bonePhantomImageParameters.h"
#include "bonePhantomModel.h"
#include "bonePhantomSampler.h"

#include <itkImage.h>
#include <itkImageSource.h>

namespace bone
{
/** \class PhantomImageSource
 * \brief CT (HU) and label map of a phantom.
 *
 * Outputs, on the same grid:
 *  - 0, GetOutput(): the model's density, blurred by the point spread, with noise. Integer pixels are rounded and
 *    clamped to their range.
 *  - 1, GetLabelOutput(): the region of each voxel's centre: 0 outside, 1 cortical, 2 trabecular, 3 medullary cavity.
 *
 * Grid: `Direction` and `Spacing` as set. With FitToBone size and origin are such that the model lies inside
 * with `Margin` around it; at an open end the image ends at the cut, without margin, so the bone leaves the image
 * there. With FitToBoneOff() the image has `Origin`, `Size` and `StartIndex` as set.
 *
 * Point spread: a Gaussian of full width at half maximum `PointSpread` along the image's axes, which stands for
 * detector and slice aperture too; the CT's value is the blurred density at the voxel's centre. A width of 0 samples
 * the ideal density, a negative one (default) means the larger of 0.7 mm and the spacing along that axis. See
 * PhantomSampler for how it is computed and how exactly.
 *
 * Noise: independent Gaussian of standard deviation `Noise` (HU), a hash of `NoiseSeed` and the voxel's place in the
 * image, thus the same for any number of threads and for streamed pieces.
 *
 * Parameters: \ref PhantomImageParameters.
 *
 * \tparam TOutputImage a 3D itk::Image of scalars. */
template <typename TOutputImage>
class PhantomImageSource : public itk::ImageSource<TOutputImage>
{
public:
  ITK_DISALLOW_COPY_AND_MOVE(PhantomImageSource);
  using Self = PhantomImageSource;
  using Superclass = itk::ImageSource<TOutputImage>;
  using Pointer = itk::SmartPointer<Self>;
  using ConstPointer = itk::SmartPointer<const Self>;
  itkNewMacro(Self);
  itkTypeMacro(PhantomImageSource, itk::ImageSource);

  static_assert(TOutputImage::ImageDimension == 3, "A phantom's image is three-dimensional.");

  using OutputImageType = TOutputImage;
  using RegionType = typename TOutputImage::RegionType;
  using PixelType = typename TOutputImage::PixelType;
  using PointType = typename TOutputImage::PointType;
  using SpacingType = typename TOutputImage::SpacingType;
  using DirectionType = typename TOutputImage::DirectionType;
  using SizeType = typename TOutputImage::SizeType;
  using IndexType = typename TOutputImage::IndexType;
  using LabelImageType = itk::Image<short, 3>;

  /** The bone; required. It cannot change once made, so that another model means another result. */
  void
  SetModel(PhantomModel::Pointer model)
  {
    if (m_Model != model)
    {
      m_Model = std::move(model);
      this->Modified();
    }
  }
  itkGetConstMacro(Model, PhantomModel::Pointer);

  /** mm between voxel centres; default 1. */
  itkSetMacro(Spacing, SpacingType);
  itkGetConstReferenceMacro(Spacing, SpacingType);
  /** Columns are the image's axes; a rotation, or with a reflection. Default identity. */
  itkSetMacro(Direction, DirectionType);
  itkGetConstReferenceMacro(Direction, DirectionType);
  BONE_FILTER_PARAMETERS(PhantomImageParameters, BONE_PHANTOM_IMAGE_PARAMETERS)

  /** Without FitToBone: physical point of index 0, voxels along each axis, and first index; default 0. */
  itkSetMacro(Origin, PointType);
  itkGetConstReferenceMacro(Origin, PointType);
  itkSetMacro(Size, SizeType);
  itkGetConstReferenceMacro(Size, SizeType);
  itkSetMacro(StartIndex, IndexType);
  itkGetConstReferenceMacro(StartIndex, IndexType);

  /** Full width at half maximum (mm) along the image's axes; negative: automatic. */
  itkSetMacro(PointSpread, SpacingType);
  itkGetConstReferenceMacro(PointSpread, SpacingType);

  LabelImageType *
  GetLabelOutput()
  {
    return itkDynamicCastInDebugMode<LabelImageType *>(this->itk::ProcessObject::GetOutput(1));
  }
  const LabelImageType *
  GetLabelOutput() const
  {
    return itkDynamicCastInDebugMode<const LabelImageType *>(this->itk::ProcessObject::GetOutput(1));
  }

  using Superclass::MakeOutput;
  itk::ProcessObject::DataObjectPointer
  MakeOutput(itk::ProcessObject::DataObjectPointerArraySizeType index) override;

protected:
  PhantomImageSource();
  ~PhantomImageSource() override = default;

  void
  VerifyPreconditions() const override;
  void
  GenerateOutputInformation() override;
  void
  GenerateData() override;
  void
  PrintSelf(std::ostream & os, itk::Indent indent) const override;

private:
  /** Origin and size along each axis that hold the bone. */
  void
  FitGrid(PointType & origin, SizeType & size) const;
  PhantomSampler
  MakeSampler() const;
  /** Writes both outputs in a part of the requested region. */
  void
  FillPiece(const PhantomSampler & sampler, const RegionType & piece);

  PhantomModel::Pointer m_Model;
  SpacingType           m_Spacing;
  DirectionType         m_Direction;
  PointType             m_Origin;
  SizeType              m_Size;
  IndexType             m_StartIndex;
  SpacingType           m_PointSpread;
};
} // namespace bone

#ifndef ITK_MANUAL_INSTANTIATION
#include "bonePhantomImageSource.hxx"
#endif

#endif
