/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef bonePhantomImageSource_hxx
#define bonePhantomImageSource_hxx

#include "bonePhantomImageSource.h"
#include "boneLabelValue.h"
#include "boneVoxelGrid.h"

#include <itkImageScanlineIterator.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

namespace bone
{
template <typename TOutputImage>
PhantomImageSource<TOutputImage>::PhantomImageSource()
{
  m_Spacing.Fill(1.0);
  m_Direction.SetIdentity();
  m_Origin.Fill(0.0);
  m_Size.Fill(0);
  m_StartIndex.Fill(0);
  m_PointSpread.Fill(-1.0);
  this->SetNumberOfRequiredOutputs(2);
  this->SetNthOutput(1, this->MakeOutput(1));
}

template <typename TOutputImage>
itk::ProcessObject::DataObjectPointer
PhantomImageSource<TOutputImage>::MakeOutput(itk::ProcessObject::DataObjectPointerArraySizeType index)
{
  if (index == 1)
  {
    return LabelImageType::New().GetPointer();
  }
  return Superclass::MakeOutput(index);
}

template <typename TOutputImage>
void
PhantomImageSource<TOutputImage>::VerifyPreconditions() const
{
  Superclass::VerifyPreconditions();
  this->VerifyParameters();
  if (m_Model == nullptr)
  {
    itkExceptionMacro("No model is set; give one with SetModel, for instance MakePhantom(\"femur\").");
  }
  Eigen::Matrix3d axes;
  for (unsigned int a = 0; a < 3; ++a)
  {
    if (!(m_Spacing[a] > 0.0 && m_Spacing[a] < 1e4))
    {
      itkExceptionMacro("Spacing must be positive and below 10000 mm along every axis, but is " << m_Spacing << ".");
    }
    if (!(m_PointSpread[a] < 1e3))
    {
      itkExceptionMacro("PointSpread must be below 1000 mm (negative: automatic), but is " << m_PointSpread << ".");
    }
    for (unsigned int b = 0; b < 3; ++b)
    {
      axes(a, b) = m_Direction[a][b];
    }
  }
  if (!((axes.transpose() * axes - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() < 1e-4))
  {
    itkExceptionMacro("Direction must be a rotation (columns of length 1 at right angles), but is\n" << m_Direction);
  }
  if (!m_Parameters.fitToBone && (m_Size[0] == 0 || m_Size[1] == 0 || m_Size[2] == 0))
  {
    itkExceptionMacro("Size must be positive along every axis, but is " << m_Size << "; set it, or use FitToBoneOn().");
  }
}

template <typename TOutputImage>
void
PhantomImageSource<TOutputImage>::FitGrid(PointType & origin, SizeType & size) const
{
  const PhantomModel::Axis axis = m_Model->GetLongitudinalAxis();
  Eigen::Matrix3d          axes;
  for (unsigned int a = 0; a < 9; ++a)
  {
    axes(a / 3, a % 3) = m_Direction[a / 3][a % 3];
  }
  int along = 0;
  (axes.transpose() * axis.direction).cwiseAbs().maxCoeff(&along);
  const bool flipped = axes.col(along).dot(axis.direction) < 0.0;
  Vector3    first;
  for (int a = 0; a < 3; ++a)
  {
    const PhantomModel::Interval extent = m_Model->GetExtent(axes.col(a));
    const bool                   openLower = a == along && (flipped ? m_Model->GetOpenEnd() : m_Model->GetOpenStart());
    const bool                   openUpper = a == along && (flipped ? m_Model->GetOpenStart() : m_Model->GetOpenEnd());
    // An open end lies on the outer face of the last voxel; a closed one is a margin away from a voxel's centre.
    const double lower = openLower ? extent.lower + 0.5 * m_Spacing[a] : extent.lower - m_Parameters.margin;
    const double upper = openUpper ? extent.upper - 0.5 * m_Spacing[a] : extent.upper + m_Parameters.margin;
    const double steps = std::max(0.0, (upper - lower) / m_Spacing[a]);
    if (!(steps < 1e5))
    {
      itkExceptionMacro("The image would have " << steps << " voxels along axis " << a << "; use a larger spacing than "
                                                << m_Spacing[a] << " mm.");
    }
    const double whole = openLower || openUpper ? std::floor(steps + 1e-9) : std::ceil(steps - 1e-9);
    size[a] = static_cast<itk::SizeValueType>(whole) + 1;
    if (openLower)
    {
      first[a] = lower;
      // The other end is closed: it keeps its margin.
      size[a] += !openUpper && steps > whole ? 1 : 0;
    }
    else if (openUpper)
    {
      size[a] += steps > whole ? 1 : 0;
      first[a] = upper - (static_cast<double>(size[a]) - 1.0) * m_Spacing[a];
    }
    else
    {
      first[a] = 0.5 * (lower + upper - whole * m_Spacing[a]);
    }
  }
  const double voxels = static_cast<double>(size[0]) * static_cast<double>(size[1]) * static_cast<double>(size[2]);
  if (!(voxels <= LargestNumberOfVoxels))
  {
    itkExceptionMacro("The image would have " << voxels << " voxels, where " << LargestNumberOfVoxels
                                              << " are the most; use a larger spacing than " << m_Spacing << " mm.");
  }
  const Vector3 point = axes * first;
  std::copy(point.data(), point.data() + 3, origin.Begin());
}

template <typename TOutputImage>
void
PhantomImageSource<TOutputImage>::GenerateOutputInformation()
{
  PointType origin = m_Origin;
  SizeType  size = m_Size;
  IndexType start = m_StartIndex;
  if (m_Parameters.fitToBone)
  {
    this->FitGrid(origin, size);
    start.Fill(0);
  }
  const double voxels = static_cast<double>(size[0]) * static_cast<double>(size[1]) * static_cast<double>(size[2]);
  if (!(voxels < 4e9))
  {
    itkExceptionMacro("The image would have " << voxels << " voxels, more than 4e9; use a larger spacing.");
  }
  const auto describe = [&](auto * image) {
    image->SetLargestPossibleRegion({ start, size });
    image->SetOrigin(origin);
    image->SetSpacing(m_Spacing);
    image->SetDirection(m_Direction);
  };
  describe(this->GetOutput());
  describe(this->GetLabelOutput());
  StateOneBone(*this->GetLabelOutput());
}

template <typename TOutputImage>
PhantomSampler
PhantomImageSource<TOutputImage>::MakeSampler() const
{
  PhantomGrid grid;
  Vector3     sigma;
  for (unsigned int a = 0; a < 3; ++a)
  {
    grid.origin[a] = this->GetOutput()->GetOrigin()[a];
    grid.spacing[a] = m_Spacing[a];
    for (unsigned int b = 0; b < 3; ++b)
    {
      grid.axes(a, b) = m_Direction[a][b];
    }
    const double width = m_PointSpread[a] < 0.0 ? std::max(0.7, m_Spacing[a]) : m_PointSpread[a];
    sigma[a] = width / (2.0 * std::sqrt(2.0 * std::log(2.0)));
  }
  return PhantomSampler(m_Model, grid, sigma);
}

template <typename TOutputImage>
void
PhantomImageSource<TOutputImage>::FillPiece(const PhantomSampler & sampler, const RegionType & piece)
{
  TOutputImage *   image = this->GetOutput();
  LabelImageType * labels = this->GetLabelOutput();
  const RegionType whole = image->GetLargestPossibleRegion();
  PhantomBlock     block;
  for (unsigned int a = 0; a < 3; ++a)
  {
    block.start[a] = piece.GetIndex(a);
    block.size[a] = piece.GetSize(a);
  }
  std::vector<float> density(piece.GetNumberOfPixels());
  std::vector<short> regions(piece.GetNumberOfPixels());
  sampler.SampleDensity(block, density.data());
  sampler.SampleRegions(block, regions.data());

  std::size_t                                n = 0;
  itk::ImageScanlineIterator<TOutputImage>   it(image, piece);
  itk::ImageScanlineIterator<LabelImageType> labelIt(labels, piece);
  while (!it.IsAtEnd())
  {
    const IndexType     index = it.GetIndex();
    const std::uint64_t line =
      (static_cast<std::uint64_t>(index[2] - whole.GetIndex(2)) * whole.GetSize(1) + (index[1] - whole.GetIndex(1))) *
        whole.GetSize(0) +
      (index[0] - whole.GetIndex(0));
    for (std::uint64_t i = 0; !it.IsAtEndOfLine(); ++it, ++labelIt, ++i, ++n)
    {
      double value = density[n];
      if (m_Parameters.noise > 0.0)
      {
        value += m_Parameters.noise * PhantomNoise(m_Parameters.noiseSeed, line + i);
      }
      if constexpr (std::is_integral<PixelType>::value)
      {
        value = std::clamp(std::round(value),
                           static_cast<double>(std::numeric_limits<PixelType>::lowest()),
                           static_cast<double>(std::numeric_limits<PixelType>::max()));
      }
      it.Set(static_cast<PixelType>(value));
      labelIt.Set(regions[n]);
    }
    it.NextLine();
    labelIt.NextLine();
  }
}

template <typename TOutputImage>
void
PhantomImageSource<TOutputImage>::GenerateData()
{
  // Slabs share work at their common faces, so they are some slices thick; but an abort waits for those being filled.
  constexpr itk::SizeValueType thickest = 16, mostVoxels = 1 << 17, leastPieces = 32;

  const Execution execution(this);
  this->AllocateOutputs();
  const PhantomSampler     sampler = this->MakeSampler();
  const RegionType         region = this->GetOutput()->GetBufferedRegion();
  const itk::SizeValueType slices = region.GetSize(2), sliceSize = region.GetSize(0) * region.GetSize(1);
  const itk::SizeValueType pieces = std::max<itk::SizeValueType>(leastPieces, 4 * execution.GetNumberOfWorkUnits());
  const itk::SizeValueType slab =
    std::clamp<itk::SizeValueType>(std::min(mostVoxels / sliceSize, slices / pieces), 1, thickest);
  execution.For((slices + slab - 1) / slab, [&](std::size_t s) {
    RegionType piece = region;
    piece.SetIndex(2, region.GetIndex(2) + static_cast<itk::IndexValueType>(s * slab));
    piece.SetSize(2, std::min(slab, slices - s * slab));
    this->FillPiece(sampler, piece);
  });
}

template <typename TOutputImage>
void
PhantomImageSource<TOutputImage>::PrintSelf(std::ostream & os, itk::Indent indent) const
{
  Superclass::PrintSelf(os, indent);
  PrintParameters(os, indent, m_Parameters);
  os << indent << "Model: " << (m_Model == nullptr ? "none" : "set") << '\n'
     << indent << "Spacing: " << m_Spacing << '\n'
     << indent << "Direction:\n"
     << m_Direction << indent << "Origin: " << m_Origin << '\n'
     << indent << "Size: " << m_Size << '\n'
     << indent << "StartIndex: " << m_StartIndex << '\n'
     << indent << "PointSpread: " << m_PointSpread << '\n';
}
} // namespace bone

#endif
