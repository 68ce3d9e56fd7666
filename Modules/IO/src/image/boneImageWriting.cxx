/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneAtomicFile.h"
#include "boneImageCheck.h"
#include "boneImageFile.h"
#include "boneRefuse.h"
#include "boneVtkFile.h"

#include <itkImageFileWriter.h>
#include <itkImageIOFactory.h>

#include <png.h>

#include <csetjmp>
#include <cstdint>
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
  const ImageVoxels voxels = FindVoxels(file, io);
  bool              whole = voxels.whole;
  if (whole && voxels.place)
  {
    VoxelFile written(*voxels.place);
    whole = CheckVoxels(voxels, written).whole;
  }
  if (!whole)
  {
    Refuse("what was written cannot be read back whole (is the disk full?)");
  }
  if (!voxels.known)
  {
    io->SetIORegion(region);
    std::vector<char> buffer(io->GetImageSizeInBytes());
    io->Read(buffer.data());
  }
}

/** The file of a picture: ITK's writer crashes on a full disk. */
std::string
ToPng(const void * pixels, const itk::ImageRegion<2> & region, png_uint_32 format)
{
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(region.GetSize(0));
  image.height = static_cast<png_uint_32>(region.GetSize(1));
  image.format = format;
  std::string      bytes(PNG_IMAGE_PNG_SIZE_MAX(image), '\0');
  png_alloc_size_t size = bytes.size();
  if (png_image_write_to_memory(&image, bytes.data(), &size, 0, pixels, 0, nullptr) == 0)
  {
    Refuse("cannot be made a PNG file: ", image.message);
  }
  bytes.resize(size);
  return bytes;
}

void
AppendBytes(png_structp png, png_bytep bytes, png_size_t size)
{
  try
  {
    static_cast<std::string *>(png_get_io_ptr(png))->append(reinterpret_cast<const char *>(bytes), size);
  }
  catch (const std::exception &)
  {
    png_error(png, "not enough memory"); // nothing may be thrown through the library
  }
}

/** The file of a picture of 16 bits, which has the meaning that one of 8 bits has. (Those of png_image are linear:
 * viewers show them brighter.) */
std::string
ToPng16(const unsigned short * pixels, const itk::ImageRegion<2> & region)
{
  std::string bytes;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop   info = png == nullptr ? nullptr : png_create_info_struct(png);
  if (info == nullptr || setjmp(png_jmpbuf(png)) != 0)
  {
    png_destroy_write_struct(&png, &info);
    Refuse("cannot be made a PNG file");
  }
  png_set_write_fn(png, &bytes, AppendBytes, nullptr);
  const auto width = static_cast<png_uint_32>(region.GetSize(0)), height = static_cast<png_uint_32>(region.GetSize(1));
  png_set_IHDR(png,
               info,
               width,
               height,
               16,
               PNG_COLOR_TYPE_GRAY,
               PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  png_set_sRGB_gAMA_and_cHRM(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
  png_write_info(png, info);
  const std::uint16_t one = 1;
  if (*reinterpret_cast<const unsigned char *>(&one) == 1)
  {
    png_set_swap(png);
  }
  for (png_uint_32 row = 0; row < height; ++row)
  {
    png_write_row(png, reinterpret_cast<png_const_bytep>(pixels + static_cast<std::size_t>(row) * width));
  }
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  return bytes;
}

template <typename TImage>
void
WritePicture(const TImage * image, const std::string & path, png_uint_32 format)
{
  RequireExtension(path, { ".png" });
  WriteFileAtomically(
    path, NamingFile(path, [&] { return ToPng(image->GetBufferPointer(), image->GetBufferedRegion(), format); }));
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
    throw MachineError(path, "cannot write: " + ErrorLine(error));
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
  WritePicture(image, path, PNG_FORMAT_GRAY);
}

void
WriteImage(const itk::Image<unsigned short, 2> * image, const std::string & path)
{
  RequireExtension(path, { ".png" });
  WriteFileAtomically(path,
                      NamingFile(path, [&] { return ToPng16(image->GetBufferPointer(), image->GetBufferedRegion()); }));
}

void
WriteImage(const PictureImage * image, const std::string & path)
{
  WritePicture(image, path, PNG_FORMAT_RGB);
}
} // namespace bone
