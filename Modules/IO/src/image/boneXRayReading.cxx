/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneDicomFile.h"
#include "boneRefuse.h"
#include "boneVtkFile.h"
#include "boneXRayHeader.h"

#include <gdcmImageReader.h>
#include <gdcmTrace.h>

#include <algorithm>
#include <cstdint>
#include <cstring>

namespace bone
{
namespace
{
template <typename TStored>
std::vector<float>
ToFloats(const std::vector<char> & bytes)
{
  std::vector<float> values(bytes.size() / sizeof(TStored));
  for (std::size_t i = 0; i < values.size(); ++i)
  {
    TStored stored;
    std::memcpy(&stored, bytes.data() + i * sizeof(TStored), sizeof(TStored));
    values[i] = static_cast<float>(stored);
  }
  return values;
}

std::vector<float>
ToFloats(const std::vector<char> & bytes, const gdcm::PixelFormat & format, const std::string & path)
{
  switch (format.GetScalarType())
  {
    case gdcm::PixelFormat::UINT8:
      return ToFloats<std::uint8_t>(bytes);
    case gdcm::PixelFormat::INT8:
      return ToFloats<std::int8_t>(bytes);
    case gdcm::PixelFormat::UINT12:
    case gdcm::PixelFormat::UINT16:
      return ToFloats<std::uint16_t>(bytes);
    case gdcm::PixelFormat::INT12:
    case gdcm::PixelFormat::INT16:
      return ToFloats<std::int16_t>(bytes);
    case gdcm::PixelFormat::UINT32:
      return ToFloats<std::uint32_t>(bytes);
    case gdcm::PixelFormat::INT32:
      return ToFloats<std::int32_t>(bytes);
    default:
      throw IOError(path, "has pixels of a type that is not read: convert it to 8 or 16 bits");
  }
}

void
Place(const XRayFile & file, const Vector2 & spacing)
{
  const Vector2          pixels = file.view ? file.view->spacing : spacing;
  CTImage::SpacingType   spacings;
  CTImage::PointType     origin;
  CTImage::DirectionType direction;
  direction.SetIdentity();
  origin.Fill(0.0);
  spacings[0] = pixels.x();
  spacings[1] = pixels.y();
  spacings[2] = 1.0;
  if (file.view)
  {
    const auto &  view = *file.view;
    const Vector3 axes[3] = { view.detectorU, view.detectorV, view.detectorU.cross(view.detectorV) };
    for (unsigned int k = 0; k < 3; ++k)
    {
      origin[k] = view.detectorOrigin[k];
      for (unsigned int row = 0; row < 3; ++row)
      {
        direction(row, k) = axes[k][row];
      }
    }
  }
  file.image->SetSpacing(spacings);
  file.image->SetOrigin(origin);
  file.image->SetDirection(direction);
}
} // namespace

std::vector<float>
ReadStoredPixels(const std::string & path, std::array<int, 2> & size)
{
  gdcm::Trace::WarningOff();
  gdcm::Trace::ErrorOff();
  gdcm::ImageReader reader;
  reader.SetFileName(path.c_str());
  if (!reader.Read())
  {
    throw IOError(path, "is a DICOM image whose pixels cannot be decoded: convert it to an uncompressed one");
  }
  const gdcm::Image & image = reader.GetImage();
  std::vector<char>   bytes(image.GetBufferLength());
  if (bytes.empty() || !image.GetBuffer(bytes.data()))
  {
    throw IOError(path, "is a DICOM image whose pixels cannot be decoded: convert it to an uncompressed one");
  }
  size = { { static_cast<int>(image.GetDimension(0)), static_cast<int>(image.GetDimension(1)) } };
  return ToFloats(bytes, image.GetPixelFormat(), path);
}

XRayFile
ReadXRay(const std::string & path)
{
  RequireReadableFile(path);
  if (!IsDicomFile(path))
  {
    XRayFile file;
    file.image = ReadRadiograph(path);
    file.obstacles.emplace_back("it is no DICOM file");
    return file;
  }
  XRayScale                scale;
  Vector2                  spacing;
  XRayFile                 file = ReadXRayHeader(path, scale, spacing);
  std::array<int, 2>       size{};
  const std::vector<float> stored = ReadStoredPixels(path, size);
  const std::size_t        count = static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]);
  if (stored.size() != count || (file.view && file.view->size != size))
  {
    throw IOError(path, "is a DICOM image whose pixels are not all there; copy it again from where it came");
  }
  file.image = CTImage::New();
  CTImage::RegionType region;
  region.SetSize(0, static_cast<itk::SizeValueType>(size[0]));
  region.SetSize(1, static_cast<itk::SizeValueType>(size[1]));
  region.SetSize(2, 1);
  file.image->SetRegions(region);
  file.image->Allocate();
  std::transform(stored.begin(), stored.end(), file.image->GetBufferPointer(), [&scale](float value) {
    return static_cast<float>(scale.offset + scale.slope * value);
  });
  Place(file, spacing);
  return file;
}
} // namespace bone
