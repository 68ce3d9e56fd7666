/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneSnakeContourFilter_h
#define boneSnakeContourFilter_h

#include "boneContourExtraction.h"
#include "boneContourFilter.h"
#include "boneLabelValue.h"
#include "bonePlacement.h"

#include <itkImage.h>

namespace bone
{
/** \class SnakeContourFilter
 * \brief Periosteal, endosteal and medullary contours of a bone on parallel slices of a CT (paper 2.1).
 *
 * Inputs:
 * - the CT (primary), HU; origin, spacing, direction and the region's index are honoured, its axes must be at right
 *   angles;
 * - "LabelImage", optional, on its own grid: the periosteal contours start from the outline of `Label`, smooth and with
 *   the label's area, and are kept so or, with RefineLabelOutline, moved to the CT's edges within RefineDistance;
 * - "InitialContours", optional: closed contours of layer 0 on some slices (parallel to the image's). Without a label
 *   the bone is followed from them to all other slices: its contours may split, join, appear and
 *   end, and bones in contact are separated along the dark line between them. With a label they replace its outline on
 *   their slices; with FollowLabel too the bone is followed from both.
 *
 * At least one of the optional inputs must be there. The output is a \ref ContourStack with layers 0 (periosteal, holes
 * have region Outside), 1 (endosteal) and 2 (medullary). A periosteal contour may have several endosteal ones beside
 * each other, none of them around a hole, and these several medullary ones; nested contours keep MinimumLayerDistance.
 * Where the bone meets the first or last image slice the stack is open there and a warning says so.
 *
 * The snakes are those of M. Kass, A. Witkin, D. Terzopoulos, doi:10.1007/BF00133570, drawn by gradient vector flow (C.
 * Xu, J. L. Prince, doi:10.1109/83.661186). The cortex ends where the CT falls half-way from its maximum to the level
 * inside, along a profile from each point of a periosteal contour, filtered along the surface. Parameters: \ref
 * SnakeContourParameters. Results do not depend on the number of threads.
 *
 * Errors (itk::ExceptionObject): no start given; a parameter out of range; an image of one slice; axes not at right
 * angles; the label does not occur; initial contours off the image or not parallel to its slices; no voxel inside the
 * contours reaches BoneThreshold.
 *
 * \tparam TInputImage the CT, an itk::Image of dimension 3 of any scalar
 * \tparam TLabelImage the label image, an itk::Image of dimension 3 of any scalar; NaN is no label */
template <typename TInputImage, typename TLabelImage = itk::Image<short, 3>>
class SnakeContourFilter : public ContourSource
{
public:
  ITK_DISALLOW_COPY_AND_MOVE(SnakeContourFilter);
  using Self = SnakeContourFilter;
  using Superclass = ContourSource;
  using Pointer = itk::SmartPointer<Self>;
  using ConstPointer = itk::SmartPointer<const Self>;
  itkNewMacro(Self);
  itkTypeMacro(SnakeContourFilter, ContourSource);

  using InputImageType = TInputImage;
  using LabelImageType = TLabelImage;
  static_assert(TInputImage::ImageDimension == 3 && TLabelImage::ImageDimension == 3,
                "SnakeContourFilter needs three-dimensional images");

  using itk::ProcessObject::SetInput;
  void
  SetInput(const TInputImage * image)
  {
    this->SetPrimaryInput(const_cast<TInputImage *>(image));
  }
  const TInputImage *
  GetInput() const
  {
    return itkDynamicCastInDebugMode<const TInputImage *>(this->GetPrimaryInput());
  }
  itkSetInputMacro(LabelImage, TLabelImage);
  itkGetInputMacro(LabelImage, TLabelImage);
  itkSetInputMacro(InitialContours, ContourStack);
  itkGetInputMacro(InitialContours, ContourStack);

  BONE_FILTER_PARAMETERS(SnakeContourParameters, BONE_SNAKE_CONTOUR_PARAMETERS)

  /** Where the image's space lies, where that is not where it says: warnings and errors then tell heights along the
   * slices' normal that points forward (\ref PointsForward). */
  void
  SetPlacement(const Placement & placement);
  itkGetConstReferenceMacro(Placement, Placement);

  /** After an update: what happened slice by slice, and what a person should know. */
  itkGetConstReferenceMacro(Report, ExtractionReport);
  const std::vector<std::string> &
  GetWarnings() const
  {
    return m_Report.warnings;
  }

protected:
  SnakeContourFilter();
  ~SnakeContourFilter() override = default;

  void
  VerifyPreconditions() const override;
  void
  VerifyInputInformation() const override;
  /** Contours take no information from images. */
  void
  GenerateOutputInformation() override
  {}
  void
  GenerateData() override;
  void
  PrintSelf(std::ostream & os, itk::Indent indent) const override;

private:
  /** The frame, and the image axes along its U, V and normal. */
  SliceFrame
  MakeFrame(std::array<unsigned int, 3> & axes) const;
  PlaneSource
  MakePlaneSource(const SliceFrame & frame, const std::array<unsigned int, 3> & axes) const;

  /** The label's bounding box; sets the heights of its lowest and highest voxel. */
  typename TLabelImage::RegionType
  FindLabel(const SliceFrame & frame, LabelVoxels & voxels) const;
  LabelVoxels
  CropLabel(const SliceFrame & frame) const;

  /** How heights along the frame's normal are told. */
  ToldHeight
  GetToldHeight(const SliceFrame & frame) const;

  ExtractionReport m_Report;
  Placement        m_Placement;
};
} // namespace bone

#ifndef ITK_MANUAL_INSTANTIATION
#include "boneSnakeContourFilter.hxx"
#endif

#endif
