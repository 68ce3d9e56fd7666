/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneDicomFile.h"
#include "boneImageCheck.h"
#include "boneImageFile.h"
#include "boneImageHeader.h"
#include "boneLabelValue.h"
#include "boneParameters.h"
#include "boneRefuse.h"
#include "boneVtkFile.h"

#include <itkImageFileReader.h>
#include <itkImageIOFactory.h>
#include <itkImageRegionConstIteratorWithIndex.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

namespace bone
{
namespace
{
std::string
SizeText(const itk::ImageIOBase * io)
{
  std::string text;
  for (unsigned int d = 0; d < io->GetNumberOfDimensions(); ++d)
  {
    text += Say(d > 0 ? " x " : "", io->GetDimensions(d));
  }
  return text;
}

itk::ImageIOBase::Pointer
OpenImage(const std::string & path)
{
  RequireReadableFile(path);
  if (IsDicomFile(path))
  {
    RequireWholeDicomFile(path);
  }
  RequireSensibleHeader(path);
  auto io = itk::ImageIOFactory::CreateImageIO(path.c_str(), itk::IOFileModeEnum::ReadMode);
  if (io.IsNull())
  {
    throw IOError(path, "is no image in a format that can be read (NIfTI, MetaImage, NRRD, DICOM, ...)");
  }
  io->SetFileName(path);
  try
  {
    io->ReadImageInformation();
  }
  catch (const itk::ExceptionObject & error)
  {
    const std::string text = ErrorLine(error);
    if (text.find("orthonormal") != std::string::npos)
    {
      throw IOError(path,
                    "its axes are not at right angles (a sheared direction in the header): resample it to an "
                    "orthogonal grid, or correct the header's sform and qform");
    }
    throw IOError(path, "is no readable image: " + text);
  }
  if (io->GetNumberOfComponents() != 1)
  {
    throw IOError(path, Say("has ", io->GetNumberOfComponents(), " components per voxel where one value is needed"));
  }
  for (unsigned int d = 3; d < io->GetNumberOfDimensions(); ++d)
  {
    if (io->GetDimensions(d) > 1)
    {
      throw IOError(path,
                    Say("is a ", io->GetNumberOfDimensions(), "D image (", SizeText(io), "): extract one 3D volume"));
    }
  }
  return io;
}

std::string
NotFiniteText(std::size_t count, const CTImage::IndexType & first)
{
  return Say("has ", count, " voxels that are NaN or infinite, the first at ", first, ": fill them first");
}

void
RequireWholeFile(const std::string & path, const itk::ImageIOBase * io)
{
  const ImageFileCheck check = CheckImageFile(path, io);
  if (!check.whole)
  {
    throw IOError(path,
                  "is cut short or damaged: its voxels are not all there, or do not agree with their checksum; copy it "
                  "again from where it came");
  }
  if (check.notFinite > 0)
  {
    CTImage::IndexType first{};
    std::size_t        rest = check.firstNotFinite;
    for (unsigned int d = 0; d < std::min(3u, io->GetNumberOfDimensions()); ++d)
    {
      first[d] = static_cast<itk::IndexValueType>(rest % io->GetDimensions(d));
      rest /= io->GetDimensions(d);
    }
    throw IOError(path, NotFiniteText(check.notFinite, first));
  }
}

CTImage::Pointer
LoadImage(const std::string & path, itk::ImageIOBase * io)
{
  RequireWholeFile(path, io);
  auto reader = itk::ImageFileReader<CTImage>::New();
  reader->SetImageIO(io);
  reader->SetFileName(path);
  try
  {
    reader->Update();
  }
  catch (const itk::ExceptionObject & error)
  {
    throw IOError(path, "is no readable image: " + ErrorLine(error));
  }
  CTImage::Pointer image = reader->GetOutput();
  image->DisconnectPipeline();
  return image;
}

/** A grid in millimetres, near enough to the scanner's origin. */
void
RequireSensibleGrid(const std::string & path, const CTImage * image)
{
  const auto length = ParameterRange::Length();
  for (unsigned int d = 0; d < 3; ++d)
  {
    const double spacing = image->GetSpacing()[d];
    if (!length.Contains(spacing))
    {
      throw IOError(path,
                    Say("has voxels of ",
                        spacing,
                        " mm, where from ",
                        length.lower,
                        " to ",
                        length.upper,
                        " mm are possible: are its units mm?"));
    }
    if (!(std::abs(image->GetOrigin()[d]) <= FarthestCoordinate))
    {
      throw IOError(path,
                    Say("lies ",
                        image->GetOrigin()[d],
                        " mm from the origin, where a kilometre is the most: are its "
                        "units mm?"));
    }
  }
}

CTImage::Pointer
ReadVolume(const std::string & path)
{
  const QuietItk  quiet;
  std::error_code error;
  if (std::filesystem::is_directory(path, error))
  {
    return ReadDicomSeries(path);
  }
  const auto io = OpenImage(path);
  bool       volume = io->GetNumberOfDimensions() >= 3;
  for (unsigned int d = 0; d < 3 && volume; ++d)
  {
    volume = io->GetDimensions(d) > 1;
  }
  if (!volume)
  {
    throw IOError(path,
                  Say("is an image of one slice (",
                      SizeText(io),
                      ") where a volume is needed; for a DICOM series name its folder"));
  }
  return LoadImage(path, io);
}

void
RequireFinite(const CTImage * image, const std::string & path)
{
  std::size_t        count = 0;
  CTImage::IndexType first{};
  for (itk::ImageRegionConstIteratorWithIndex<CTImage> it(image, image->GetBufferedRegion()); !it.IsAtEnd(); ++it)
  {
    if (!std::isfinite(it.Get()) && count++ == 0)
    {
      first = it.GetIndex();
    }
  }
  if (count > 0)
  {
    throw IOError(path, NotFiniteText(count, first));
  }
}
} // namespace

CTImage::Pointer
ReadCT(const std::string & path)
{
  const auto image = ReadVolume(path);
  RequireFinite(image, path);
  RequireSensibleGrid(path, image);
  return image;
}

LabelImage::Pointer
ReadLabels(const std::string & path)
{
  using Limits = std::numeric_limits<LabelImage::PixelType>;
  const auto values = ReadVolume(path);
  RequireFinite(values, path);
  RequireSensibleGrid(path, values);
  auto labels = LabelImage::New();
  labels->CopyInformation(values);
  labels->SetRegions(values->GetBufferedRegion());
  labels->Allocate();
  LabelImage::PixelType *                         label = labels->GetBufferPointer();
  itk::ImageRegionConstIteratorWithIndex<CTImage> it(values, values->GetBufferedRegion());
  for (; !it.IsAtEnd(); ++it, ++label)
  {
    const float value = it.Get();
    if (!(value >= Limits::lowest() && value <= Limits::max()) || value != std::floor(value))
    {
      throw IOError(path,
                    Say("is no label map: its value at ",
                        it.GetIndex(),
                        " is ",
                        value,
                        ", no whole number from ",
                        Limits::lowest(),
                        " to ",
                        Limits::max()));
    }
    *label = static_cast<LabelImage::PixelType>(value);
  }
  if (StatesOneBone(*values))
  {
    StateOneBone(*labels);
  }
  return labels;
}

CTImage::Pointer
ReadRadiograph(const std::string & path)
{
  const QuietItk quiet;
  const auto     io = OpenImage(path);
  if (io->GetNumberOfDimensions() >= 3 && io->GetDimensions(2) != 1)
  {
    throw IOError(path, Say("is no radiograph: it is ", io->GetDimensions(2), " pixels thick (", SizeText(io), ")"));
  }
  const auto image = LoadImage(path, io);
  RequireFinite(image, path);
  return image;
}
} // namespace bone
