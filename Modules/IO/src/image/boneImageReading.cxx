/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneDicomFile.h"
#include "boneDicomSeries.h"
#include "boneImageCheck.h"
#include "boneImageFile.h"
#include "boneImageHeader.h"
#include "boneParameters.h"
#include "boneRefuse.h"
#include "boneRegionImageIO.h"
#include "boneSformImageIO.h"
#include "boneVtkFile.h"

#include <itkImageFileReader.h>
#include <itkImageIOFactory.h>
#include <itkImageRegionConstIteratorWithIndex.h>
#include <vnl/vnl_det.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

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

/** Throws where the axes span no space, or voxels have no size: ITK would speak of matrices. */
void
RequireAxes(const std::string & path, const itk::ImageIOBase * io)
{
  constexpr double       smallest = 1e-6; // of the volume that axes of length 1 span
  const unsigned int     dimensions = std::min(3u, io->GetNumberOfDimensions());
  CTImage::DirectionType axes;
  axes.SetIdentity();
  for (unsigned int d = 0; d < dimensions; ++d)
  {
    for (unsigned int k = 0; k < dimensions; ++k)
    {
      axes(k, d) = io->GetDirection(d)[k];
    }
    if (!(io->GetSpacing(d) > 0.0))
    {
      throw IOError(path, Say("has voxels of ", io->GetSpacing(d), " mm: correct the header"));
    }
  }
  if (!(std::abs(vnl_det(axes.GetVnlMatrix())) > smallest))
  {
    throw IOError(path, "its header's axes (direction) lie in one plane or are empty: correct the header");
  }
}

itk::ImageIOBase::Pointer
OpenImage(const std::string & path)
{
  RequireReadableFile(path);
  if (IsDicomFile(path))
  {
    ReadWholeDicomFile(path);
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
    const bool isSkewed = ErrorLine(error).find("orthonormal") != std::string::npos;
    const auto bySform = isSkewed ? OpenBySform(path) : nullptr;
    if (isSkewed && bySform.IsNull())
    {
      throw IOError(path,
                    "its axes are not at right angles (a sheared, empty or tiny direction in the header: are its units "
                    "mm?): resample it to an orthogonal grid, or correct the header's sform and qform");
    }
    if (bySform.IsNull())
    {
      throw IOError(path, "is no readable image: its header is damaged, or of a form that is not known");
    }
    io = bySform;
  }
  if (io->GetComponentType() == itk::IOComponentEnum::UNKNOWNCOMPONENTTYPE)
  {
    throw IOError(path, "is no readable image: its header names no known kind of number for the voxels");
  }
  RequireAxes(path, io);
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

void
RequireOneComponent(const std::string & path, const itk::ImageIOBase * io)
{
  if (io->GetNumberOfComponents() != 1)
  {
    throw IOError(path, Say("has ", io->GetNumberOfComponents(), " components per voxel where one value is needed"));
  }
}

std::string
NotFiniteText(std::size_t count, const CTImage::IndexType & first)
{
  return Say("has ", count, " voxels that are NaN or infinite, the first at ", first, ": fill them first");
}

void
RequireSound(const std::string & path, const itk::ImageIOBase * io, const VoxelCheck & check)
{
  if (!check.whole)
  {
    ThrowNotWhole(path);
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

template <typename TReader>
void
UpdateReader(TReader * reader, const std::string & path, const itk::ImageIOBase * io)
{
  try
  {
    reader->Update();
  }
  catch (const IOError &)
  {
    throw;
  }
  catch (const itk::MemoryAllocationError &)
  {
    throw MachineError(path, "is damaged, or needs more memory than there is (" + SizeText(io) + " voxels)");
  }
  catch (const itk::ExceptionObject &)
  {
    throw IOError(path, "is no readable image: its voxels are damaged, or compressed in a way that is not known");
  }
}

/** A reader of the image, up to date but where it is to read by regions and can: it has looked at the file as a whole
 * then, and its output has no voxels yet. */
template <typename TImage>
typename itk::ImageFileReader<TImage>::Pointer
OpenVoxels(const std::string & path, itk::ImageIOBase * io, Reading reading)
{
  const ImageVoxels          voxels = FindVoxels(path, io);
  std::shared_ptr<VoxelFile> file;
  if (!voxels.whole)
  {
    ThrowNotWhole(path);
  }
  if (voxels.place)
  {
    file = std::make_shared<VoxelFile>(*voxels.place);
    if (!file->IsLongEnough())
    {
      ThrowNotWhole(path);
    }
    // Plain voxels that are all read are looked at as they come.
    if (!voxels.plain || reading == Reading::ByRegion)
    {
      RequireSound(path, io, CheckVoxels(voxels, *file));
    }
  }
  auto reader = itk::ImageFileReader<TImage>::New();
  reader->SetFileName(path);
  if (voxels.plain)
  {
    reader->SetImageIO(ReadByRegion(io, voxels, file));
  }
  else
  {
    reader->SetImageIO(io);
  }
  if (voxels.plain && reading == Reading::ByRegion)
  {
    reader->GetOutput()->ReleaseDataFlagOn();
    reader->UpdateOutputInformation();
  }
  else
  {
    UpdateReader(reader.GetPointer(), path, io);
  }
  return reader;
}

template <typename TImage>
typename TImage::Pointer
LoadImage(const std::string & path, itk::ImageIOBase * io)
{
  const auto               reader = OpenVoxels<TImage>(path, io, Reading::Whole);
  typename TImage::Pointer image = reader->GetOutput();
  image->DisconnectPipeline();
  return image;
}

void
RequireVolume(const std::string & path, const itk::ImageIOBase * io)
{
  bool volume = io->GetNumberOfDimensions() >= 3;
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
}
} // namespace

void
ThrowNotWhole(const std::string & path)
{
  throw IOError(path,
                "is cut short or damaged: its voxels are not all there, or do not agree with their checksum; copy it "
                "again from where it came");
}

void
RequireSensibleGrid(const CTImage * image, const std::string & path)
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

VolumeSource::Pointer
OpenVolume(const std::string & path, const std::string & series, std::vector<std::string> & notes, Reading reading)
{
  const QuietItk  quiet;
  std::error_code error;
  if (std::filesystem::is_directory(path, error))
  {
    return OpenDicomFolder(path, series, notes, reading);
  }
  if (!series.empty())
  {
    throw IOError(path, "is no folder, of whose DICOM series one could be chosen");
  }
  const auto io = OpenImage(path);
  RequireOneComponent(path, io);
  RequireVolume(path, io);
  return OpenVoxels<CTImage>(path, io, reading).GetPointer();
}

itk::VectorImage<float, 3>::Pointer
ReadComponents(const std::string & path)
{
  const QuietItk quiet;
  const auto     io = OpenImage(path);
  RequireVolume(path, io);
  return io->GetNumberOfComponents() == 1 ? nullptr : LoadImage<itk::VectorImage<float, 3>>(path, io);
}

void
RequireFinite(const CTImage * image, const std::string & path)
{
  if (image->GetBufferedRegion().GetNumberOfPixels() == 0)
  {
    return; // an iterator needs a buffer
  }
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

CTImage::Pointer
ReadCT(const std::string & path, const std::string & series, std::vector<std::string> * notes)
{
  std::vector<std::string> unread;
  const auto               source = OpenVolume(path, series, notes == nullptr ? unread : *notes, Reading::Whole);
  CTImage::Pointer         image = source->GetOutput();
  image->DisconnectPipeline();
  RequireFinite(image, path);
  RequireSensibleGrid(image, path);
  return image;
}

VolumeSource::Pointer
OpenCT(const std::string & path, const std::string & series, std::vector<std::string> * notes)
{
  std::vector<std::string> unread;
  VolumeSource::Pointer    source = OpenVolume(path, series, notes == nullptr ? unread : *notes, Reading::ByRegion);
  RequireFinite(source->GetOutput(), path); // of what is read by now
  RequireSensibleGrid(source->GetOutput(), path);
  return source;
}

CTImage::SizeType
ReadVolumeSize(const std::string & path, const std::string & series)
{
  const QuietItk    quiet;
  CTImage::SizeType size{};
  if (std::filesystem::is_directory(path))
  {
    std::vector<std::string> notes;
    const DicomSeries        slices = FindDicomSeries(path, series, notes);
    const DicomHeader &      first = slices.front();
    size[0] = static_cast<itk::SizeValueType>(first.columns);
    size[1] = static_cast<itk::SizeValueType>(first.rows);
    size[2] = slices.size() * static_cast<itk::SizeValueType>(first.frames);
    return size;
  }
  const auto io = OpenImage(path);
  RequireOneComponent(path, io);
  RequireVolume(path, io);
  for (unsigned int d = 0; d < 3; ++d)
  {
    size[d] = io->GetDimensions(d);
  }
  return size;
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
  RequireOneComponent(path, io);
  const auto image = LoadImage<CTImage>(path, io);
  RequireFinite(image, path);
  return image;
}
} // namespace bone
