/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneSnakeContourFilter_h
#define boneSnakeContourFilter_h

#include "boneContourExtraction.h"
#include "boneContourStack.h"

#include <itkImage.h>
#include <itkProcessObject.h>

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
 *   the bone is followed from them to all other slices (\ref BoneFollower): its contours may split, join, appear and
 *   end, and bones in contact are parted along the dark line between them. With a label they replace its outline on
 *   their slices; with FollowLabel too the bone is followed from both.
 *
 * At least one of the optional inputs must be there. The output is a \ref ContourStack with layers 0 (periosteal, holes
 * have region Outside), 1 (endosteal) and 2 (medullary). A periosteal contour may have several endosteal ones beside
 * each other, none of them around a hole, and these several medullary ones; nested contours keep MinimumLayerDistance.
 * Where the bone meets the first or last image slice the stack is open there and a warning says so.
 *
 * Inner layers: \ref FindInnerLayers. Snakes: \ref EvolveSnake. Results do not depend on the number of threads.
 *
 * Errors (itk::ExceptionObject): no start given; a parameter out of range; an image of one slice; axes not at right
 * angles; the label does not occur; initial contours off the image or not parallel to its slices; no voxel inside the
 * contours reaches BoneThreshold.
 *
 * \tparam TInputImage a scalar itk::Image of dimension 3. \tparam TContourStack \ref ContourStack. */
template <typename TInputImage, typename TContourStack = ContourStack>
class SnakeContourFilter : public itk::ProcessObject
{
public:
  ITK_DISALLOW_COPY_AND_MOVE(SnakeContourFilter);
  using Self = SnakeContourFilter;
  using Superclass = itk::ProcessObject;
  using Pointer = itk::SmartPointer<Self>;
  using ConstPointer = itk::SmartPointer<const Self>;
  itkNewMacro(Self);
  itkTypeMacro(SnakeContourFilter, itk::ProcessObject);

  using InputImageType = TInputImage;
  using ContourStackType = TContourStack;
  using LabelImageType = itk::Image<short, 3>;
  static_assert(TInputImage::ImageDimension == 3, "SnakeContourFilter needs a three-dimensional image");

  using Superclass::SetInput;
  void
  SetInput(const TInputImage * image);
  const TInputImage *
  GetInput() const;
  void
  SetLabelImage(const LabelImageType * image);
  const LabelImageType *
  GetLabelImage() const;
  void
  SetInitialContours(const TContourStack * contours);
  const TContourStack *
  GetInitialContours() const;
  TContourStack *
  GetOutput();
  const TContourStack *
  GetOutput() const;

  /** Image axis (0, 1, 2) that the slices follow one another along. Default 2. */
  itkSetMacro(Axis, unsigned int);
  itkGetConstMacro(Axis, unsigned int);
  /** Distance between slices, mm; 0 (default): every slice of the image. Other planes are interpolated; with a label
   * the distance is made smaller as needed for the first and last plane to fall on the label's first and last slice. */
  itkSetMacro(SliceStep, double);
  itkGetConstMacro(SliceStep, double);
  /** Value in the label image; 0 (default): every voxel that is not 0. */
  itkSetMacro(Label, int);
  itkGetConstMacro(Label, int);

  /** Whether a label's outline is moved to the CT's edges. Default off: the contours keep the label's area. */
  itkSetMacro(RefineLabelOutline, bool);
  itkGetConstMacro(RefineLabelOutline, bool);
  itkBooleanMacro(RefineLabelOutline);
  /** Bound on that motion, mm; 0 (default): half a pixel, as far as a label is off at its best. */
  itkSetMacro(RefineDistance, double);
  itkGetConstMacro(RefineDistance, double);
  /** Whether the bone is followed from the slices that the label marks to the others (a label painted on a few slices):
   * these are then settled on the CT as initial contours are. Default off: the bone ends where its label does. */
  itkSetMacro(FollowLabel, bool);
  itkGetConstMacro(FollowLabel, bool);
  itkBooleanMacro(FollowLabel);

  /** Snake: weight of |x'|^2 (mm^2, default 0.02), of |x''|^2 (mm^4, default 0.3) and of the image's force (default 1).
   */
  itkSetMacro(Elasticity, double);
  itkGetConstMacro(Elasticity, double);
  itkSetMacro(Rigidity, double);
  itkGetConstMacro(Rigidity, double);
  itkSetMacro(ExternalWeight, double);
  itkGetConstMacro(ExternalWeight, double);
  /** Snake: iterations at most (default 200); converged when the root mean square motion of the points is less (mm,
   * default 0.01). */
  itkSetMacro(MaximumNumberOfIterations, int);
  itkGetConstMacro(MaximumNumberOfIterations, int);
  itkSetMacro(ConvergenceTolerance, double);
  itkGetConstMacro(ConvergenceTolerance, double);
  /** Least slope of an edge, HU/mm. Default 40. */
  itkSetMacro(MinimumEdgeSlope, double);
  itkGetConstMacro(MinimumEdgeSlope, double);

  /** How many layers: 1 periosteal, 2 with endosteal, 3 (default) with medullary contours. */
  itkSetMacro(NumberOfLayers, int);
  itkGetConstMacro(NumberOfLayers, int);
  /** Least distance between a contour and the next inside it, mm; 0 (default): 0.8 mm or a pixel, whichever is more. */
  itkSetMacro(MinimumLayerDistance, double);
  itkGetConstMacro(MinimumLayerDistance, double);
  /** Contours and holes of less area are left out, mm^2. Default 4. */
  itkSetMacro(MinimumContourArea, double);
  itkGetConstMacro(MinimumContourArea, double);
  /** Whether pieces and holes of a single slice, and bodies of few slices or little volume, are kept. Default off: they
   * are left out, and a warning counts them. */
  itkSetMacro(KeepSmallPieces, bool);
  itkGetConstMacro(KeepSmallPieces, bool);
  itkBooleanMacro(KeepSmallPieces);
  /** What never reaches it is no bone, HU. Default 150. */
  itkSetMacro(BoneThreshold, double);
  itkGetConstMacro(BoneThreshold, double);
  /** End of the cortex, HU; 0 (default): half-way from the local maximum to the level inside. */
  itkSetMacro(EndostealThreshold, double);
  itkGetConstMacro(EndostealThreshold, double);
  /** The medullary cavity lies below, HU. Default 40. */
  itkSetMacro(MedullaryThreshold, double);
  itkGetConstMacro(MedullaryThreshold, double);
  /** Depth to which the end of the cortex is sought, mm. Default 12. */
  itkSetMacro(MaximumCorticalThickness, double);
  itkGetConstMacro(MaximumCorticalThickness, double);

  /** After an update: what happened slice by slice, and what a person should know. */
  const ExtractionReport &
  GetReport() const
  {
    return m_Report;
  }
  const std::vector<std::string> &
  GetWarnings() const
  {
    return m_Report.warnings;
  }

  using Superclass::MakeOutput;
  itk::DataObject::Pointer
  MakeOutput(itk::ProcessObject::DataObjectPointerArraySizeType index) override;

protected:
  SnakeContourFilter();
  ~SnakeContourFilter() override = default;

  void
  VerifyPreconditions() ITKv5_CONST override;
  void
  VerifyInputInformation() ITKv5_CONST override;
  void
  GenerateData() override;
  void
  PrintSelf(std::ostream & os, itk::Indent indent) const override;

private:
  /** The image's slices in the stack's frame. */
  struct Frame
  {
    unsigned int axes[3]; ///< image axes along U, V, N
    Vector3      u;
    Vector3      v;
    Vector3      normal;
    Vector2      origin; ///< of the buffer's first voxel, plane coordinates
    Vector2      pixel;  ///< mm
    SliceRange   slices;
    int          size[3];
  };

  Frame
  MakeFrame() const;
  PlaneSource
  MakePlaneSource(const Frame & frame) const;
  ParallelFor
  MakeParallelFor();
  ExtractionParameters
  MakeParameters(const Frame & frame) const;

  bool
  HasLabel(short value) const
  {
    return m_Label != 0 ? value == m_Label : value != 0;
  }
  /** The label's bounding box, and the heights of its lowest and highest voxel. */
  typename LabelImageType::RegionType
  FindLabel(const Frame & frame, double & low, double & high) const;
  /** The label's bounding box with a margin, and which of its voxels have the label. */
  VoxelBox
  CropLabel(std::vector<unsigned char> & inside, const Frame & frame, double & low, double & high) const;
  std::vector<BoneSection>
  SectionsFromLabel(const Frame & frame, const ExtractionParameters & parameters, const ParallelFor & parallel);
  std::vector<BoneSection>
  SectionsFromContours(const Frame & frame) const;
  void
  InsertInitialContours(const Frame & frame, std::vector<BoneSection> & sections) const;
  void
  SetOpenEnds(const Frame & frame, const std::vector<BoneSection> & sections);
  void
  ReportProgress(float progress);

  unsigned int     m_Axis{ 2 };
  double           m_SliceStep{ 0.0 };
  int              m_Label{ 0 };
  bool             m_RefineLabelOutline{ false };
  bool             m_FollowLabel{ false };
  double           m_RefineDistance{ 0.0 };
  double           m_Elasticity{ 0.02 };
  double           m_Rigidity{ 0.3 };
  double           m_ExternalWeight{ 1.0 };
  int              m_MaximumNumberOfIterations{ 200 };
  double           m_ConvergenceTolerance{ 0.01 };
  double           m_MinimumEdgeSlope{ 40.0 };
  int              m_NumberOfLayers{ 3 };
  double           m_MinimumLayerDistance{ 0.0 };
  double           m_MinimumContourArea{ 4.0 };
  bool             m_KeepSmallPieces{ false };
  double           m_BoneThreshold{ 150.0 };
  double           m_EndostealThreshold{ 0.0 };
  double           m_MedullaryThreshold{ 40.0 };
  double           m_MaximumCorticalThickness{ 12.0 };
  ExtractionReport m_Report;
};
} // namespace bone

#ifndef ITK_MANUAL_INSTANTIATION
#include "boneSnakeContourFilter.hxx"
#endif

#endif
