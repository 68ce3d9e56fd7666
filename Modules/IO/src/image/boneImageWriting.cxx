/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneAtomicFile.h"
#include "boneImageCheck.h"
#include "boneImageFile.h"
#include "boneRefuse.h"

#include <itkImageFileWriter.h>
#include <itkImageIOFactory.h>

#include <filesystem>
#include <vector>

namespace bone
{
namespace
{
// Throws where the written file does not hold a whole image: several of ITK's writers do not look at the state of
// their stream.
void
ReadBack(const std::string & file, std::size_t numberOfPixels)
{
  auto io = itk::ImageIOFactory::CreateImageIO(file.c_str(), itk::IOFileModeEnum::ReadMode);
  if (io.IsNull())
  {
    Refuse("what was written cannot be read back (is the disk full?)");
  }
  io->SetFileName(file);
  io->ReadImageInformation();
  itk::ImageIORegion region(io->GetNumberOfDimensions());
  std::size_t        pixels = 1;
  for (unsigned int d = 0; d < io->GetNumberOfDimensions(); ++d)
  {
    region.SetSize(d, io->GetDimensions(d));
    pixels *= io->GetDimensions(d);
  }
  if (pixels != numberOfPixels)
  {
    Refuse("what was written cannot be read back whole (is the disk full?)");
  }
  const ImageFileCheck check = CheckImageFile(file, io);
  if (!check.whole)
  {
    Refuse("what was written cannot be read back whole (is the disk full?)");
  }
  if (!check.known)
  {
    io->SetIORegion(region);
    std::vector<char> buffer(io->GetImageSizeInBytes());
    io->Read(buffer.data());
  }
}

template <typename TImage>
void
Write(const TImage * image, const std::string & path, bool compress)
{
  const QuietItk quiet;
  AtomicFile     file(path);
  auto io = itk::ImageIOFactory::CreateImageIO(file.GetTemporaryPath().c_str(), itk::IOFileModeEnum::WriteMode);
  if (io.IsNull())
  {
    throw IOError(path, "no image format has this extension; .nii.gz, .mha, .nrrd and .png are some");
  }
  auto writer = itk::ImageFileWriter<TImage>::New();
  writer->SetImageIO(io);
  writer->SetInput(image);
  writer->SetFileName(file.GetTemporaryPath());
  writer->SetUseCompression(compress);
  try
  {
    writer->Update();
    ReadBack(file.GetTemporaryPath(), image->GetLargestPossibleRegion().GetNumberOfPixels());
  }
  catch (const itk::ExceptionObject & error)
  {
    throw IOError(path, "cannot write: " + ErrorLine(error));
  }
  file.Commit();
}
} // namespace

void
WriteImage(const CTImage * image, const std::string & path)
{
  Write(image, path, false);
}

void
WriteImage(const LabelImage * image, const std::string & path)
{
  Write(image, path, true);
}

void
WriteImage(const itk::Image<float, 2> * image, const std::string & path)
{
  Write(image, path, false);
}

void
WriteImage(const itk::Image<unsigned char, 2> * image, const std::string & path)
{
  Write(image, path, true);
}

void
WriteImage(const PictureImage * image, const std::string & path)
{
  Write(image, path, true);
}
} // namespace bone
