/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneSnakeContourFilter_hxx
#define boneSnakeContourFilter_hxx

#include "boneSnakeContourFilter.h"

#include "boneLabelContours.h"

#include <itkImageRegionConstIteratorWithIndex.h>
#include <itkMultiThreaderBase.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>

namespace bone
{
template <typename TInputImage, typename TContourStack>
SnakeContourFilter<TInputImage, TContourStack>::SnakeContourFilter()
{
  this->AddOptionalInputName("LabelImage");
  this->AddOptionalInputName("InitialContours");
  this->SetNumberOfRequiredInputs(1);
  this->SetNumberOfRequiredOutputs(1);
  this->SetNthOutput(0, this->MakeOutput(0));
}

template <typename TInputImage, typename TContourStack>
itk::DataObject::Pointer
SnakeContourFilter<TInputImage, TContourStack>::MakeOutput(itk::ProcessObject::DataObjectPointerArraySizeType)
{
  return TContourStack::New().GetPointer();
}

template <typename TInputImage, typename TContourStack>
void
SnakeContourFilter<TInputImage, TContourStack>::SetInput(const TInputImage * image)
{
  this->SetNthInput(0, const_cast<TInputImage *>(image));
}

template <typename TInputImage, typename TContourStack>
const TInputImage *
SnakeContourFilter<TInputImage, TContourStack>::GetInput() const
{
  return itkDynamicCastInDebugMode<const TInputImage *>(this->GetPrimaryInput());
}

template <typename TInputImage, typename TContourStack>
void
SnakeContourFilter<TInputImage, TContourStack>::SetLabelImage(const LabelImageType * image)
{
  this->itk::ProcessObject::SetInput("LabelImage", const_cast<LabelImageType *>(image));
}

template <typename TInputImage, typename TContourStack>
auto
SnakeContourFilter<TInputImage, TContourStack>::GetLabelImage() const -> const LabelImageType *
{
  return itkDynamicCastInDebugMode<const LabelImageType *>(this->itk::ProcessObject::GetInput("LabelImage"));
}

template <typename TInputImage, typename TContourStack>
void
SnakeContourFilter<TInputImage, TContourStack>::SetInitialContours(const TContourStack * contours)
{
  this->itk::ProcessObject::SetInput("InitialContours", const_cast<TContourStack *>(contours));
}

template <typename TInputImage, typename TContourStack>
const TContourStack *
SnakeContourFilter<TInputImage, TContourStack>::GetInitialContours() const
{
  return itkDynamicCastInDebugMode<const TContourStack *>(this->itk::ProcessObject::GetInput("InitialContours"));
}

template <typename TInputImage, typename TContourStack>
TContourStack *
SnakeContourFilter<TInputImage, TContourStack>::GetOutput()
{
  return itkDynamicCastInDebugMode<TContourStack *>(this->GetPrimaryOutput());
}

template <typename TInputImage, typename TContourStack>
const TContourStack *
SnakeContourFilter<TInputImage, TContourStack>::GetOutput() const
{
  return itkDynamicCastInDebugMode<const TContourStack *>(this->GetPrimaryOutput());
}

template <typename TInputImage, typename TContourStack>
void
SnakeContourFilter<TInputImage, TContourStack>::VerifyPreconditions() ITKv5_CONST
{
  Superclass::VerifyPreconditions();
  if (this->GetLabelImage() == nullptr && this->GetInitialContours() == nullptr)
  {
    itkExceptionMacro("Nothing to start from: set the input LabelImage or InitialContours.");
  }
  if (m_Axis > 2)
  {
    itkExceptionMacro("Axis is " << m_Axis << "; it must be 0, 1 or 2.");
  }
  if (m_NumberOfLayers < 1 || m_NumberOfLayers > 3)
  {
    itkExceptionMacro("NumberOfLayers is " << m_NumberOfLayers << "; it must be 1, 2 or 3.");
  }
  const auto check = [this](const char * name, double value, bool zeroAllowed) {
    if (!(zeroAllowed ? value >= 0.0 : value > 0.0) || !std::isfinite(value))
    {
      itkExceptionMacro("" << name << " is " << value << "; it must be " << (zeroAllowed ? "0 or more." : "positive."));
    }
  };
  check("SliceStep", m_SliceStep, true);
  check("RefineDistance", m_RefineDistance, true);
  check("Elasticity", m_Elasticity, true);
  check("Rigidity", m_Rigidity, true);
  check("ExternalWeight", m_ExternalWeight, false);
  check("MaximumNumberOfIterations", m_MaximumNumberOfIterations, false);
  check("ConvergenceTolerance", m_ConvergenceTolerance, false);
  check("MinimumEdgeSlope", m_MinimumEdgeSlope, false);
  check("MinimumLayerDistance", m_MinimumLayerDistance, true);
  check("MinimumContourArea", m_MinimumContourArea, true);
  check("EndostealThreshold", m_EndostealThreshold, true);
  check("MaximumCorticalThickness", m_MaximumCorticalThickness, false);
}

template <typename TInputImage, typename TContourStack>
void
SnakeContourFilter<TInputImage, TContourStack>::VerifyInputInformation() ITKv5_CONST
{
  Superclass::VerifyInputInformation();
  const auto size = this->GetInput()->GetLargestPossibleRegion().GetSize();
  for (unsigned int a = 0; a < 3; ++a)
  {
    const unsigned int least = a == m_Axis ? 2 : 4;
    if (size[a] < least)
    {
      itkExceptionMacro("The CT has " << size[a] << " voxels along axis " << a << " and needs at least " << least
                                      << (a == m_Axis ? " (slices; choose another Axis?)." : "."));
    }
  }
  const auto & direction = this->GetInput()->GetDirection();
  for (unsigned int a = 0; a < 3; ++a)
  {
    double dot = 0.0;
    for (unsigned int r = 0; r < 3; ++r)
    {
      dot += direction[r][a] * direction[r][(a + 1) % 3];
    }
    if (!(std::abs(dot) < 1e-3))
    {
      itkExceptionMacro("The CT's axes " << a << " and " << (a + 1) % 3
                                         << " are not at right angles (gantry tilt?); resample it to a regular grid.");
    }
  }
}

template <typename TInputImage, typename TContourStack>
auto
SnakeContourFilter<TInputImage, TContourStack>::MakeFrame() const -> Frame
{
  const TInputImage * image = this->GetInput();
  const auto &        matrix = image->GetDirection();
  const auto          column = [&matrix](unsigned int a) {
    return Vector3(matrix[0][a], matrix[1][a], matrix[2][a]).normalized();
  };
  Frame frame;
  frame.axes[0] = (m_Axis + 1) % 3;
  frame.axes[1] = (m_Axis + 2) % 3;
  frame.axes[2] = m_Axis;
  if (column(frame.axes[0]).cross(column(frame.axes[1])).dot(column(m_Axis)) < 0.0)
  {
    std::swap(frame.axes[0], frame.axes[1]);
  }
  frame.u = column(frame.axes[0]);
  frame.v = column(frame.axes[1]);
  frame.normal = frame.u.cross(frame.v);
  const auto                      region = image->GetBufferedRegion();
  typename TInputImage::PointType corner;
  image->TransformIndexToPhysicalPoint(region.GetIndex(), corner);
  const Vector3 origin(corner[0], corner[1], corner[2]);
  frame.origin = { origin.dot(frame.u), origin.dot(frame.v) };
  frame.slices.first = origin.dot(frame.normal);
  frame.pixel = { image->GetSpacing()[frame.axes[0]], image->GetSpacing()[frame.axes[1]] };
  frame.slices.step = image->GetSpacing()[m_Axis];
  for (unsigned int a = 0; a < 3; ++a)
  {
    frame.size[a] = static_cast<int>(region.GetSize()[frame.axes[a]]);
  }
  frame.slices.count = frame.size[2];
  return frame;
}

template <typename TInputImage, typename TContourStack>
PlaneSource
SnakeContourFilter<TInputImage, TContourStack>::MakePlaneSource(const Frame & frame) const
{
  const auto *               buffer = this->GetInput()->GetBufferPointer();
  const auto *               table = this->GetInput()->GetOffsetTable();
  const itk::OffsetValueType stride[3] = { table[frame.axes[0]], table[frame.axes[1]], table[frame.axes[2]] };
  return [frame, buffer, stride0 = stride[0], stride1 = stride[1], stride2 = stride[2]](
           double height, const Vector2 & low, const Vector2 & high) {
    const double z = std::clamp((height - frame.slices.first) / frame.slices.step, 0.0, frame.size[2] - 1.0);
    const int    k = std::min(static_cast<int>(z + 1e-6), frame.size[2] - 2);
    const double t = std::abs(z - k) < 1e-6 ? 0.0 : z - k;
    int          begin[2];
    PlaneField   plane;
    plane.grid.spacing = frame.pixel;
    for (int a = 0; a < 2; ++a)
    {
      const double first = std::floor((low[a] - frame.origin[a]) / frame.pixel[a]);
      const double last = std::ceil((high[a] - frame.origin[a]) / frame.pixel[a]);
      begin[a] = static_cast<int>(std::clamp(first, 0.0, frame.size[a] - 2.0));
      const int end = static_cast<int>(std::clamp(last, begin[a] + 1.0, frame.size[a] - 1.0));
      plane.grid.size[static_cast<std::size_t>(a)] = end - begin[a] + 1;
      plane.grid.origin[a] = frame.origin[a] + begin[a] * frame.pixel[a];
    }
    plane.values.resize(plane.grid.Count());
    const auto * corner = buffer + begin[0] * stride0 + begin[1] * stride1 + k * stride2;
    for (int j = 0; j < plane.grid.size[1]; ++j)
    {
      for (int i = 0; i < plane.grid.size[0]; ++i)
      {
        const auto * voxel = corner + i * stride0 + j * stride1;
        plane.values[plane.grid.Offset(i, j)] = static_cast<float>((1.0 - t) * voxel[0] + t * voxel[stride2]);
      }
    }
    return plane;
  };
}

template <typename TInputImage, typename TContourStack>
ParallelFor
SnakeContourFilter<TInputImage, TContourStack>::MakeParallelFor()
{
  return [this](std::size_t count, const std::function<void(std::size_t)> & body) {
    if (this->GetAbortGenerateData())
    {
      throw itk::ProcessAborted(__FILE__, __LINE__);
    }
    this->GetMultiThreader()->SetNumberOfWorkUnits(this->GetNumberOfWorkUnits());
    this->GetMultiThreader()->ParallelizeArray(
      0, count, [&body](itk::SizeValueType i) { body(i); }, nullptr);
  };
}

template <typename TInputImage, typename TContourStack>
ExtractionParameters
SnakeContourFilter<TInputImage, TContourStack>::MakeParameters(const Frame & frame) const
{
  const double         pixel = frame.pixel.maxCoeff();
  ExtractionParameters parameters;
  parameters.snake.elasticity = m_Elasticity;
  parameters.snake.rigidity = m_Rigidity;
  parameters.snake.externalWeight = m_ExternalWeight;
  parameters.snake.maximumIterations = m_MaximumNumberOfIterations;
  parameters.snake.tolerance = m_ConvergenceTolerance;
  parameters.minimumSlope = m_MinimumEdgeSlope;
  parameters.minimumArea = m_MinimumContourArea;
  parameters.keepSmallPieces = m_KeepSmallPieces;
  parameters.boneThreshold = m_BoneThreshold;
  parameters.followStep = frame.slices.step;
  parameters.refineDistance = m_RefineDistance > 0.0 ? m_RefineDistance : 0.5 * pixel;
  parameters.layers.numberOfLayers = m_NumberOfLayers;
  parameters.layers.minimumDistance = m_MinimumLayerDistance > 0.0 ? m_MinimumLayerDistance : std::max(0.8, pixel);
  parameters.layers.endostealThreshold = m_EndostealThreshold;
  parameters.layers.medullaryThreshold = m_MedullaryThreshold;
  parameters.layers.maximumThickness = m_MaximumCorticalThickness;
  return parameters;
}

template <typename TInputImage, typename TContourStack>
auto
SnakeContourFilter<TInputImage, TContourStack>::FindLabel(const Frame & frame, double & low, double & high) const ->
  typename LabelImageType::RegionType
{
  const LabelImageType * labels = this->GetLabelImage();
  itk::Index<3>          first;
  itk::Index<3>          last;
  first.Fill(std::numeric_limits<itk::IndexValueType>::max());
  last.Fill(std::numeric_limits<itk::IndexValueType>::min());
  low = std::numeric_limits<double>::max();
  high = -low;
  using Iterator = itk::ImageRegionConstIteratorWithIndex<LabelImageType>;
  for (Iterator it(labels, labels->GetBufferedRegion()); !it.IsAtEnd(); ++it)
  {
    if (!this->HasLabel(it.Get()))
    {
      continue;
    }
    for (unsigned int a = 0; a < 3; ++a)
    {
      first[a] = std::min(first[a], it.GetIndex()[a]);
      last[a] = std::max(last[a], it.GetIndex()[a]);
    }
    LabelImageType::PointType point;
    labels->TransformIndexToPhysicalPoint(it.GetIndex(), point);
    const double height = point[0] * frame.normal[0] + point[1] * frame.normal[1] + point[2] * frame.normal[2];
    low = std::min(low, height);
    high = std::max(high, height);
  }
  if (first[0] > last[0])
  {
    itkExceptionMacro("The label image has no voxel "
                      << (m_Label != 0 ? "of label " + std::to_string(m_Label) : std::string("that is not 0")) << '.');
  }
  LabelImageType::RegionType region;
  for (unsigned int a = 0; a < 3; ++a)
  {
    region.SetIndex(a, first[a]);
    region.SetSize(a, static_cast<itk::SizeValueType>(last[a] - first[a] + 1));
  }
  return region;
}

template <typename TInputImage, typename TContourStack>
VoxelBox
SnakeContourFilter<TInputImage, TContourStack>::CropLabel(std::vector<unsigned char> & inside,
                                                          const Frame &                frame,
                                                          double &                     low,
                                                          double &                     high) const
{
  const LabelImageType * labels = this->GetLabelImage();
  auto                   crop = this->FindLabel(frame, low, high);
  crop.PadByRadius(4);
  crop.Crop(labels->GetBufferedRegion());
  VoxelBox box;
  for (unsigned int a = 0; a < 3; ++a)
  {
    box.size[a] = static_cast<int>(crop.GetSize(a));
    box.spacing[a] = labels->GetSpacing()[a];
    for (unsigned int r = 0; r < 3; ++r)
    {
      box.direction(r, a) = labels->GetDirection()[r][a];
    }
  }
  LabelImageType::PointType corner;
  labels->TransformIndexToPhysicalPoint(crop.GetIndex(), corner);
  box.origin = { corner[0], corner[1], corner[2] };
  inside.clear();
  inside.reserve(box.Count());
  for (itk::ImageRegionConstIteratorWithIndex<LabelImageType> it(labels, crop); !it.IsAtEnd(); ++it)
  {
    inside.push_back(this->HasLabel(it.Get()));
  }
  return box;
}

template <typename TInputImage, typename TContourStack>
std::vector<BoneSection>
SnakeContourFilter<TInputImage, TContourStack>::SectionsFromLabel(const Frame &                frame,
                                                                  const ExtractionParameters & parameters,
                                                                  const ParallelFor &          parallel)
{
  std::vector<unsigned char> inside;
  double                     low = 0.0;
  double                     high = 0.0;
  const VoxelBox             box = this->CropLabel(inside, frame, low, high);
  const LabelField           field(box, inside, 0.8, parallel);
  this->ReportProgress(0.2F);
  std::vector<Polygon> corners(1);
  for (int c = 0; c < 8; ++c)
  {
    const Vector3 index((c & 1) * (box.size[0] - 1), (c >> 1 & 1) * (box.size[1] - 1), (c >> 2) * (box.size[2] - 1));
    const Vector3 corner = box.origin + box.direction * index.cwiseProduct(box.spacing);
    corners[0].push_back({ corner.dot(frame.u), corner.dot(frame.v) });
  }
  const PlaneGrid grid = CoveringGrid(corners, 0.0, frame.origin, frame.pixel);
  auto            sections = m_FollowLabel ? PlaceSectionsThrough(frame.slices, low, m_SliceStep)
                                           : PlaceSections(frame.slices, low, high, m_SliceStep);
  if (sections.empty())
  {
    itkExceptionMacro("The label lies beyond the CT's slices; are both images of the same space?");
  }
  std::vector<int> dropped(sections.size(), 0);
  const double     slack = 0.5 * frame.slices.step;
  parallel(sections.size(), [&](std::size_t k) {
    if (m_FollowLabel && !(sections[k].height > low - slack && sections[k].height < high + slack))
    {
      return;
    }
    sections[k].pieces =
      ContoursOfLabel(field, grid, frame.u, frame.v, sections[k].height, parameters.minimumArea, dropped[k]);
  });
  const int sum = std::accumulate(dropped.begin(), dropped.end(), 0);
  if (sum > 0)
  {
    m_Report.warnings.push_back("Left out " + std::to_string(sum) + " contours or holes smaller than " +
                                std::to_string(parameters.minimumArea) + " mm^2.");
  }
  return sections;
}

template <typename TInputImage, typename TContourStack>
std::vector<BoneSection>
SnakeContourFilter<TInputImage, TContourStack>::SectionsFromContours(const Frame & frame) const
{
  const TContourStack * initial = this->GetInitialContours();
  double                anchor = std::numeric_limits<double>::quiet_NaN();
  for (const ContourSlice & slice : initial->GetSlices())
  {
    if (!slice.contours.empty() && !std::isfinite(anchor))
    {
      anchor = slice.origin.dot(frame.normal);
    }
  }
  if (!std::isfinite(anchor))
  {
    itkExceptionMacro("The initial contours are empty.");
  }
  return PlaceSectionsThrough(frame.slices, anchor, m_SliceStep);
}

// Gives each drawn contour to the section nearest to it.
template <typename TInputImage, typename TContourStack>
void
SnakeContourFilter<TInputImage, TContourStack>::InsertInitialContours(const Frame &              frame,
                                                                      std::vector<BoneSection> & sections) const
{
  const TContourStack * initial = this->GetInitialContours();
  if (!(std::abs(initial->GetNormal().dot(frame.normal)) > 1.0 - 1e-4))
  {
    itkExceptionMacro("The initial contours' planes are not parallel to the image's slices along axis "
                      << m_Axis << "; set another Axis or redraw them.");
  }
  std::vector<double> nearest(sections.size(), std::numeric_limits<double>::max());
  for (const ContourSlice & slice : initial->GetSlices())
  {
    const double height = slice.origin.dot(frame.normal);
    const auto   section = std::min_element(sections.begin(), sections.end(), [height](const auto & a, const auto & b) {
      return std::abs(a.height - height) < std::abs(b.height - height);
    });
    std::vector<Polygon> loops;
    for (const Contour & contour : slice.contours)
    {
      if (contour.axis || contour.layer != 0)
      {
        continue;
      }
      Polygon loop;
      for (const Vector3 & point : contour.points)
      {
        loop.push_back({ point.dot(frame.u), point.dot(frame.v) });
      }
      if ((SignedArea(loop) < 0.0) != (contour.region == Region::Outside))
      {
        std::reverse(loop.begin(), loop.end());
      }
      loops.push_back(std::move(loop));
    }
    const double step = m_SliceStep > 0.0 ? m_SliceStep : frame.slices.step;
    if (!loops.empty() && !(std::abs(section->height - height) <= step))
    {
      itkExceptionMacro("An initial contour at " << height << " mm along axis " << m_Axis
                                                 << " lies beyond the CT's slices.");
    }
    const auto k = static_cast<std::size_t>(section - sections.begin());
    if (!loops.empty() && std::abs(section->height - height) < nearest[k])
    {
      nearest[k] = std::abs(section->height - height);
      int dropped = 0;
      section->pieces = GroupPieces(std::move(loops), 0.0, dropped);
    }
  }
}

template <typename TInputImage, typename TContourStack>
void
SnakeContourFilter<TInputImage, TContourStack>::SetOpenEnds(const Frame &                    frame,
                                                            const std::vector<BoneSection> & sections)
{
  const double top = frame.slices.Top();
  const double slack = 0.5 * frame.slices.step;
  const bool   start = sections.front().height < frame.slices.first + slack;
  const bool   end = sections.back().height > top - slack;
  this->GetOutput()->SetOpenStart(start);
  this->GetOutput()->SetOpenEnd(end);
  if (start || end)
  {
    m_Report.warnings.push_back(std::string("The bone leaves the image at its ") +
                                (start && end ? "first and last"
                                 : start      ? "first"
                                              : "last") +
                                " slice; it is cut flat there.");
  }
  const Vector2 last =
    frame.origin + Vector2((frame.size[0] - 1) * frame.pixel.x(), (frame.size[1] - 1) * frame.pixel.y());
  const bool aside = std::any_of(sections.begin(), sections.end(), [&](const BoneSection & section) {
    return std::any_of(section.pieces.begin(), section.pieces.end(), [&](const BonePiece & piece) {
      return std::any_of(piece.outer.begin(), piece.outer.end(), [&](const Vector2 & q) {
        return (q - frame.origin).minCoeff() < 0.0 || (last - q).minCoeff() < 0.0;
      });
    });
  });
  if (aside)
  {
    m_Report.warnings.push_back("The bone leaves the image at the border of its slices; it is cut there.");
  }
}

template <typename TInputImage, typename TContourStack>
void
SnakeContourFilter<TInputImage, TContourStack>::ReportProgress(float progress)
{
  this->UpdateProgress(progress);
  if (this->GetAbortGenerateData())
  {
    throw itk::ProcessAborted(__FILE__, __LINE__);
  }
}

template <typename TInputImage, typename TContourStack>
void
SnakeContourFilter<TInputImage, TContourStack>::GenerateData()
{
  m_Report = {};
  const Frame                frame = this->MakeFrame();
  const PlaneSource          planes = this->MakePlaneSource(frame);
  const ParallelFor          parallel = this->MakeParallelFor();
  const ExtractionParameters parameters = this->MakeParameters(frame);
  const bool                 labelled = this->GetLabelImage() != nullptr;
  std::vector<BoneSection>   sections =
    labelled ? this->SectionsFromLabel(frame, parameters, parallel) : this->SectionsFromContours(frame);
  if (labelled && m_RefineLabelOutline && !m_FollowLabel)
  {
    RefineSections(sections, planes, frame.pixel, parameters, parallel, m_Report);
  }
  if (this->GetInitialContours() != nullptr)
  {
    this->InsertInitialContours(frame, sections);
  }
  this->ReportProgress(0.4F);
  const double brightest = BrightestWithin(sections, planes, m_BoneThreshold);
  if (!(brightest >= m_BoneThreshold))
  {
    itkExceptionMacro("The CT holds no bone: within the contours its highest value is "
                      << brightest << ", below BoneThreshold (" << m_BoneThreshold
                      << "). Do the CT and its start belong together?");
  }
  if (!labelled || m_FollowLabel)
  {
    PropagateSections(sections, planes, frame.pixel, parameters, parallel, m_Report);
    this->ReportProgress(0.6F);
  }
  FinishSections(sections, planes, frame.pixel, parameters, parallel, m_Report);
  this->ReportProgress(0.9F);
  if (sections.empty())
  {
    itkExceptionMacro("No contour is left: " << (labelled
                                                   ? "the label has too few voxels, or they do not hang together."
                                                   : "the initial contours found no edge of bone to rest on."));
  }
  TContourStack * output = this->GetOutput();
  output->SetFrame(frame.u, frame.v);
  output->SetSlices(ToSlices(sections, *output));
  this->SetOpenEnds(frame, sections);
  output->Verify();
  this->UpdateProgress(1.0F);
}

template <typename TInputImage, typename TContourStack>
void
SnakeContourFilter<TInputImage, TContourStack>::PrintSelf(std::ostream & os, itk::Indent indent) const
{
  Superclass::PrintSelf(os, indent);
  os << indent << "Axis: " << m_Axis << '\n';
  os << indent << "SliceStep: " << m_SliceStep << '\n';
  os << indent << "Label: " << m_Label << '\n';
  os << indent << "RefineLabelOutline: " << m_RefineLabelOutline << '\n';
  os << indent << "FollowLabel: " << m_FollowLabel << '\n';
  os << indent << "RefineDistance: " << m_RefineDistance << '\n';
  os << indent << "Elasticity: " << m_Elasticity << '\n';
  os << indent << "Rigidity: " << m_Rigidity << '\n';
  os << indent << "ExternalWeight: " << m_ExternalWeight << '\n';
  os << indent << "MaximumNumberOfIterations: " << m_MaximumNumberOfIterations << '\n';
  os << indent << "ConvergenceTolerance: " << m_ConvergenceTolerance << '\n';
  os << indent << "MinimumEdgeSlope: " << m_MinimumEdgeSlope << '\n';
  os << indent << "NumberOfLayers: " << m_NumberOfLayers << '\n';
  os << indent << "MinimumLayerDistance: " << m_MinimumLayerDistance << '\n';
  os << indent << "MinimumContourArea: " << m_MinimumContourArea << '\n';
  os << indent << "KeepSmallPieces: " << m_KeepSmallPieces << '\n';
  os << indent << "BoneThreshold: " << m_BoneThreshold << '\n';
  os << indent << "EndostealThreshold: " << m_EndostealThreshold << '\n';
  os << indent << "MedullaryThreshold: " << m_MedullaryThreshold << '\n';
  os << indent << "MaximumCorticalThickness: " << m_MaximumCorticalThickness << '\n';
  os << indent << "Warnings: " << m_Report.warnings.size() << '\n';
}
} // namespace bone

#endif
