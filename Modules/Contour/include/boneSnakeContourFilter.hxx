/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneSnakeContourFilter_hxx
#define boneSnakeContourFilter_hxx

#include "boneSnakeContourFilter.h"

#include <itkImageRegionConstIteratorWithIndex.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace bone
{
template <typename TInputImage, typename TLabelImage>
SnakeContourFilter<TInputImage, TLabelImage>::SnakeContourFilter()
{
  this->SetPrimaryInputName("Image");
  this->AddOptionalInputName("LabelImage");
  this->AddOptionalInputName("InitialContours");
}

template <typename TInputImage, typename TLabelImage>
void
SnakeContourFilter<TInputImage, TLabelImage>::VerifyPreconditions() const
{
  Superclass::VerifyPreconditions();
  this->VerifyParameters();
  if (this->GetLabelImage() == nullptr && this->GetInitialContours() == nullptr)
  {
    itkExceptionMacro("Nothing to start from: set the input 'LabelImage' or 'InitialContours'.");
  }
}

template <typename TInputImage, typename TLabelImage>
void
SnakeContourFilter<TInputImage, TLabelImage>::VerifyInputInformation() const
{
  Superclass::VerifyInputInformation();
  const auto size = this->GetInput()->GetLargestPossibleRegion().GetSize();
  for (unsigned int a = 0; a < 3; ++a)
  {
    const unsigned int least = a == m_Parameters.axis ? 2 : 4;
    if (size[a] < least)
    {
      itkExceptionMacro("The CT has " << size[a] << " voxels along axis " << a << " and needs at least " << least
                                      << (a == m_Parameters.axis ? " (slices; are they along another axis?)." : "."));
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

template <typename TInputImage, typename TLabelImage>
void
SnakeContourFilter<TInputImage, TLabelImage>::SetPlacement(const Placement & placement)
{
  if (placement != m_Placement)
  {
    m_Placement = placement;
    this->Modified();
  }
}

template <typename TInputImage, typename TLabelImage>
ToldHeight
SnakeContourFilter<TInputImage, TLabelImage>::GetToldHeight(const SliceFrame & frame) const
{
  if (m_Placement == Placement())
  {
    return {};
  }
  const Vector3 normal = m_Placement.direction * frame.normal;
  const double  sign = PointsForward(normal) ? 1.0 : -1.0;
  return { sign, sign * normal.dot(m_Placement.origin) };
}

template <typename TInputImage, typename TLabelImage>
SliceFrame
SnakeContourFilter<TInputImage, TLabelImage>::MakeFrame(std::array<unsigned int, 3> & axes) const
{
  const TInputImage * image = this->GetInput();
  const auto &        matrix = image->GetDirection();
  const auto          column = [&matrix](unsigned int a) {
    return Vector3(matrix[0][a], matrix[1][a], matrix[2][a]).normalized();
  };
  SliceFrame frame;
  axes[0] = (m_Parameters.axis + 1) % 3;
  axes[1] = (m_Parameters.axis + 2) % 3;
  axes[2] = m_Parameters.axis;
  if (column(axes[0]).cross(column(axes[1])).dot(column(m_Parameters.axis)) < 0.0)
  {
    std::swap(axes[0], axes[1]);
  }
  frame.u = column(axes[0]);
  frame.v = column(axes[1]);
  frame.normal = frame.u.cross(frame.v);
  const auto                      region = image->GetBufferedRegion();
  typename TInputImage::PointType corner;
  image->TransformIndexToPhysicalPoint(region.GetIndex(), corner);
  const Vector3 origin(corner[0], corner[1], corner[2]);
  frame.origin = { origin.dot(frame.u), origin.dot(frame.v) };
  frame.slices.first = origin.dot(frame.normal);
  frame.pixel = { image->GetSpacing()[axes[0]], image->GetSpacing()[axes[1]] };
  frame.slices.step = image->GetSpacing()[m_Parameters.axis];
  for (unsigned int a = 0; a < 2; ++a)
  {
    frame.size[a] = static_cast<int>(region.GetSize()[axes[a]]);
  }
  frame.slices.count = static_cast<int>(region.GetSize()[axes[2]]);
  return frame;
}

template <typename TInputImage, typename TLabelImage>
PlaneSource
SnakeContourFilter<TInputImage, TLabelImage>::MakePlaneSource(const SliceFrame &                  frame,
                                                              const std::array<unsigned int, 3> & axes) const
{
  const auto *               buffer = this->GetInput()->GetBufferPointer();
  const auto *               table = this->GetInput()->GetOffsetTable();
  const itk::OffsetValueType stride[3] = { table[axes[0]], table[axes[1]], table[axes[2]] };
  return [frame, buffer, stride0 = stride[0], stride1 = stride[1], stride2 = stride[2]](
           double height, const Vector2 & low, const Vector2 & high) {
    const double z = std::clamp((height - frame.slices.first) / frame.slices.step, 0.0, frame.slices.count - 1.0);
    const int    k = std::min(static_cast<int>(z + 1e-6), frame.slices.count - 2);
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

template <typename TInputImage, typename TLabelImage>
auto
SnakeContourFilter<TInputImage, TLabelImage>::FindLabel(const SliceFrame & frame, LabelVoxels & voxels) const ->
  typename TLabelImage::RegionType
{
  const LabelImageType * labels = this->GetLabelImage();
  itk::Index<3>          first;
  itk::Index<3>          last;
  first.Fill(std::numeric_limits<itk::IndexValueType>::max());
  last.Fill(std::numeric_limits<itk::IndexValueType>::min());
  double low = std::numeric_limits<double>::max();
  double high = -low;
  using Iterator = itk::ImageRegionConstIteratorWithIndex<LabelImageType>;
  for (Iterator it(labels, labels->GetBufferedRegion()); !it.IsAtEnd(); ++it)
  {
    if (!HasLabel(it.Get(), m_Parameters.label))
    {
      continue;
    }
    for (unsigned int a = 0; a < 3; ++a)
    {
      first[a] = std::min(first[a], it.GetIndex()[a]);
      last[a] = std::max(last[a], it.GetIndex()[a]);
    }
    typename TLabelImage::PointType point;
    labels->TransformIndexToPhysicalPoint(it.GetIndex(), point);
    const double height = point[0] * frame.normal[0] + point[1] * frame.normal[1] + point[2] * frame.normal[2];
    low = std::min(low, height);
    high = std::max(high, height);
  }
  if (first[0] > last[0])
  {
    itkExceptionMacro(
      "The input 'LabelImage' has no voxel "
      << (m_Parameters.label != 0 ? "of label " + std::to_string(m_Parameters.label) : std::string("that is not 0"))
      << '.');
  }
  typename TLabelImage::RegionType region;
  for (unsigned int a = 0; a < 3; ++a)
  {
    region.SetIndex(a, first[a]);
    region.SetSize(a, static_cast<itk::SizeValueType>(last[a] - first[a] + 1));
  }
  voxels.low = low;
  voxels.high = high;
  return region;
}

template <typename TInputImage, typename TLabelImage>
LabelVoxels
SnakeContourFilter<TInputImage, TLabelImage>::CropLabel(const SliceFrame & frame) const
{
  LabelVoxels            voxels;
  const LabelImageType * labels = this->GetLabelImage();
  auto                   crop = this->FindLabel(frame, voxels);
  crop.PadByRadius(4);
  crop.Crop(labels->GetBufferedRegion());
  VoxelBox & box = voxels.box;
  for (unsigned int a = 0; a < 3; ++a)
  {
    box.size[a] = static_cast<int>(crop.GetSize(a));
    box.spacing[a] = labels->GetSpacing()[a];
    for (unsigned int r = 0; r < 3; ++r)
    {
      box.direction(r, a) = labels->GetDirection()[r][a];
    }
  }
  typename TLabelImage::PointType corner;
  labels->TransformIndexToPhysicalPoint(crop.GetIndex(), corner);
  box.origin = { corner[0], corner[1], corner[2] };
  voxels.inside.reserve(box.Count());
  for (itk::ImageRegionConstIteratorWithIndex<LabelImageType> it(labels, crop); !it.IsAtEnd(); ++it)
  {
    voxels.inside.push_back(HasLabel(it.Get(), m_Parameters.label));
  }
  return voxels;
}

template <typename TInputImage, typename TLabelImage>
void
SnakeContourFilter<TInputImage, TLabelImage>::GenerateData()
{
  m_Report = {};
  const Execution             execution(this);
  std::array<unsigned int, 3> axes{};
  const SliceFrame            frame = this->MakeFrame(axes);
  m_Report.told = this->GetToldHeight(frame);
  const bool        labelled = this->GetLabelImage() != nullptr;
  const LabelVoxels label = labelled ? this->CropLabel(frame) : LabelVoxels();
  try
  {
    ExtractContours(frame,
                    this->MakePlaneSource(frame, axes),
                    labelled ? &label : nullptr,
                    this->GetInitialContours(),
                    m_Parameters,
                    execution,
                    *this->GetOutput(),
                    m_Report);
  }
  catch (const std::runtime_error & error)
  {
    itkExceptionMacro("" << error.what());
  }
  this->GetOutput()->Verify();
  execution.Report(1.0);
}

template <typename TInputImage, typename TLabelImage>
void
SnakeContourFilter<TInputImage, TLabelImage>::PrintSelf(std::ostream & os, itk::Indent indent) const
{
  Superclass::PrintSelf(os, indent);
  PrintParameters(os, indent, m_Parameters);
  os << indent << "Warnings: " << m_Report.warnings.size() << '\n';
}
} // namespace bone

#endif
