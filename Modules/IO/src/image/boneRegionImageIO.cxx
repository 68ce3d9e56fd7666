/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneRegionImageIO.h"

#include "boneIOError.h"
#include "boneImageFile.h"

#include <itkByteSwapper.h>

#include <algorithm>
#include <cstdint>
#include <cstring>

namespace bone
{
namespace
{
/** From big-endian. */
void
SwapBytes(char * bytes, std::size_t count, std::size_t size)
{
  switch (size)
  {
    case 2:
      return itk::ByteSwapper<std::uint16_t>::SwapRangeFromSystemToBigEndian(reinterpret_cast<std::uint16_t *>(bytes),
                                                                             count);
    case 4:
      return itk::ByteSwapper<std::uint32_t>::SwapRangeFromSystemToBigEndian(reinterpret_cast<std::uint32_t *>(bytes),
                                                                             count);
    case 8:
      return itk::ByteSwapper<std::uint64_t>::SwapRangeFromSystemToBigEndian(reinterpret_cast<std::uint64_t *>(bytes),
                                                                             count);
    default:
      return;
  }
}

/** Whole numbers become float first, as in ITK. */
template <typename TVoxel, typename TValue>
void
Rescale(const char * from, std::size_t count, const ImageVoxels & voxels, char * to)
{
  for (std::size_t i = 0; i < count; ++i)
  {
    TVoxel voxel;
    std::memcpy(&voxel, from + i * sizeof(TVoxel), sizeof(TVoxel));
    const double scaled = static_cast<double>(static_cast<TValue>(voxel)) * voxels.slope;
    const auto   value = static_cast<TValue>(scaled + voxels.intercept);
    std::memcpy(to + i * sizeof(TValue), &value, sizeof(TValue));
  }
}

void
Rescale(const char * from, std::size_t count, const ImageVoxels & voxels, char * to)
{
  using Type = itk::IOComponentEnum;
  switch (voxels.component)
  {
    case Type::UCHAR:
      return Rescale<unsigned char, float>(from, count, voxels, to);
    case Type::CHAR:
      return Rescale<signed char, float>(from, count, voxels, to);
    case Type::USHORT:
      return Rescale<unsigned short, float>(from, count, voxels, to);
    case Type::SHORT:
      return Rescale<short, float>(from, count, voxels, to);
    case Type::UINT:
      return Rescale<unsigned int, float>(from, count, voxels, to);
    case Type::INT:
      return Rescale<int, float>(from, count, voxels, to);
    case Type::ULONGLONG:
      return Rescale<unsigned long long, float>(from, count, voxels, to);
    case Type::LONGLONG:
      return Rescale<long long, float>(from, count, voxels, to);
    case Type::FLOAT:
      return Rescale<float, float>(from, count, voxels, to);
    default:
      return Rescale<double, double>(from, count, voxels, to);
  }
}

class RegionImageIO : public itk::ImageIOBase
{
public:
  using Self = RegionImageIO;
  using Superclass = itk::ImageIOBase;
  using Pointer = itk::SmartPointer<Self>;

  itkFactorylessNewMacro(Self);
  itkTypeMacro(RegionImageIO, itk::ImageIOBase);

  void
  Initialize(const itk::ImageIOBase * io, const ImageVoxels & voxels, std::shared_ptr<VoxelFile> file)
  {
    m_Voxels = voxels;
    m_File = std::move(file);
    this->SetFileName(io->GetFileName());
    this->SetNumberOfDimensions(io->GetNumberOfDimensions());
    for (unsigned int d = 0; d < io->GetNumberOfDimensions(); ++d)
    {
      this->SetDimensions(d, io->GetDimensions(d));
      this->SetSpacing(d, io->GetSpacing(d));
      this->SetOrigin(d, io->GetOrigin(d));
      this->SetDirection(d, io->GetDirection(d));
      m_DefaultDirections.push_back(io->GetDefaultDirection(d));
    }
    this->SetPixelType(itk::IOPixelEnum::SCALAR);
    this->SetNumberOfComponents(1);
    this->SetComponentType(io->GetComponentType());
    this->SetMetaDataDictionary(io->GetMetaDataDictionary());
  }

  std::vector<double>
  GetDefaultDirection(unsigned int d) const override
  {
    return m_DefaultDirections[d];
  }
  bool
  CanStreamRead() override
  {
    return true;
  }
  /** Of the axes beyond those of the image there is one step. */
  itk::ImageIORegion
  GenerateStreamableReadRegionFromRequestedRegion(const itk::ImageIORegion & requested) const override
  {
    const unsigned int dimensions = this->GetNumberOfDimensions();
    itk::ImageIORegion region(dimensions);
    for (unsigned int d = 0; d < dimensions; ++d)
    {
      const bool given = d < requested.GetImageDimension();
      region.SetIndex(d, given ? requested.GetIndex(d) : 0);
      region.SetSize(d, given ? requested.GetSize(d) : 1);
    }
    return region;
  }
  bool
  CanReadFile(const char *) override
  {
    return true;
  }
  bool
  CanWriteFile(const char *) override
  {
    return false;
  }
  void
  ReadImageInformation() override
  {}
  void
  WriteImageInformation() override
  {}
  void
  Write(const void *) override
  {}

  void
  Read(void * buffer) override
  {
    Box box;
    for (unsigned int d = 0; d < std::min(3u, this->GetNumberOfDimensions()); ++d)
    {
      box.index[d] = static_cast<std::size_t>(m_IORegion.GetIndex(d));
      box.size[d] = m_IORegion.GetSize(d);
      box.whole[d] = this->GetDimensions(d);
    }
    auto * to = static_cast<char *>(buffer);
    for (std::size_t z = 0; z < box.size[2]; ++z)
    {
      this->ReadSlice(box, z, to);
      to += box.size[0] * box.size[1] * this->GetComponentSize();
    }
    // Where all was read at one go this is the first that is seen of the file's end.
    if (box.size == box.whole && !m_File->EndsWell())
    {
      ThrowNotWhole(this->GetFileName());
    }
  }

private:
  struct Box
  {
    std::array<std::size_t, 3> index{ { 0, 0, 0 } };
    std::array<std::size_t, 3> size{ { 1, 1, 1 } };
    std::array<std::size_t, 3> whole{ { 1, 1, 1 } };
  };

  /** From the box's first row to its last: what lies beside it is passed over. */
  void
  ReadSlice(const Box & box, std::size_t z, char * to)
  {
    const std::size_t voxel = m_Voxels.rescaled ? SizeOf(m_Voxels.component) : this->GetComponentSize();
    const std::size_t row = box.whole[0] * voxel;
    const std::size_t first = ((box.index[2] + z) * box.whole[1] + box.index[1]) * row;
    const std::size_t part = box.size[0] * voxel;
    m_Slice.resize(box.size[1] * row);
    if (!m_File->Read(first, m_Slice.size(), m_Slice.data()))
    {
      ThrowNotWhole(this->GetFileName());
    }
    for (std::size_t y = 0; y < box.size[1]; ++y)
    {
      std::memmove(&m_Slice[y * part], &m_Slice[y * row + box.index[0] * voxel], part);
    }
    const std::size_t count = box.size[0] * box.size[1];
    if (m_Voxels.swapped)
    {
      SwapBytes(m_Slice.data(), count, voxel);
    }
    if (m_Voxels.rescaled)
    {
      Rescale(m_Slice.data(), count, m_Voxels, to);
    }
    else
    {
      std::memcpy(to, m_Slice.data(), count * voxel);
    }
  }

  std::size_t
  SizeOf(itk::IOComponentEnum component) const
  {
    using Type = itk::IOComponentEnum;
    return component == Type::UCHAR || component == Type::CHAR                             ? 1
           : component == Type::USHORT || component == Type::SHORT                         ? 2
           : component == Type::UINT || component == Type::INT || component == Type::FLOAT ? 4
                                                                                           : 8;
  }

  ImageVoxels                      m_Voxels;
  std::shared_ptr<VoxelFile>       m_File;
  std::vector<std::vector<double>> m_DefaultDirections;
  std::vector<char>                m_Slice;
};
} // namespace

itk::ImageIOBase::Pointer
ReadByRegion(const itk::ImageIOBase * io, const ImageVoxels & voxels, std::shared_ptr<VoxelFile> file)
{
  const auto reader = RegionImageIO::New();
  reader->Initialize(io, voxels, std::move(file));
  return reader.GetPointer();
}
} // namespace bone
