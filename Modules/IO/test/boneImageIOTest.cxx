/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneImageIO.h"
#include "boneLabelValue.h"

#include "boneTestFiles.h"

#include <itkImageFileReader.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#ifdef __SANITIZE_ADDRESS__
// ITK's NRRD library forgets what it holds where a file is cut short or the disk is full.
extern "C" const char *
__lsan_default_suppressions()
{
  return "leak:itk_nrrd\nleak:itk_biff\n";
}
#endif

namespace bone
{
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

namespace ImageIOTests
{
template <typename TImage>
typename TImage::Pointer
MakeImage(typename TImage::SizeType size)
{
  auto image = TImage::New();
  image->SetRegions(size);
  image->Allocate(true);
  return image;
}

// A ramp on an oblique, anisotropic grid.
template <typename TImage>
typename TImage::Pointer
ObliqueRamp()
{
  auto                           image = MakeImage<TImage>({ { 7, 6, 5 } });
  typename TImage::PointType     origin;
  typename TImage::SpacingType   spacing;
  typename TImage::DirectionType direction;
  const double                   c = std::cos(0.3), s = std::sin(0.3);
  const double rotation[3][3] = { { c, -s, 0 }, { s * 0.6, c * 0.6, -0.8 }, { s * 0.8, c * 0.8, 0.6 } };
  for (int i = 0; i < 3; ++i)
  {
    origin[i] = -100.5 + 37 * i;
    spacing[i] = 0.5 + 0.25 * i;
    for (int j = 0; j < 3; ++j)
    {
      direction[i][j] = rotation[i][j];
    }
  }
  image->SetOrigin(origin);
  image->SetSpacing(spacing);
  image->SetDirection(direction);
  auto * pixel = image->GetBufferPointer();
  for (int i = 0; i < 7 * 6 * 5; ++i)
  {
    pixel[i] = static_cast<typename TImage::PixelType>(i - 100);
  }
  return image;
}

template <typename TImage>
void
ExpectSame(const TImage * a, const TImage * b)
{
  ASSERT_EQ(a->GetLargestPossibleRegion(), b->GetLargestPossibleRegion());
  for (int i = 0; i < 3; ++i)
  {
    EXPECT_NEAR(a->GetOrigin()[i], b->GetOrigin()[i], 1e-4);
    EXPECT_NEAR(a->GetSpacing()[i], b->GetSpacing()[i], 1e-6);
    for (int j = 0; j < 3; ++j)
    {
      EXPECT_NEAR(a->GetDirection()[i][j], b->GetDirection()[i][j], 1e-6);
    }
  }
  const std::size_t n = a->GetLargestPossibleRegion().GetNumberOfPixels();
  EXPECT_TRUE(std::equal(a->GetBufferPointer(), a->GetBufferPointer() + n, b->GetBufferPointer()));
}

// A NIfTI-1 file of float voxels, all 1, with an sform of unit spacing, sheared by `shear`; type 16 float, 128 RGB.
std::string
Nifti(const std::vector<short> & size, float shear = 0, short type = 16)
{
  std::string header(352, '\0');
  const auto  put = [&](std::size_t at, auto value) { std::memcpy(&header[at], &value, sizeof(value)); };
  put(0, std::int32_t{ 348 });
  put(40, static_cast<std::int16_t>(size.size()));
  std::size_t voxels = 1;
  for (std::size_t d = 0; d < 7; ++d)
  {
    put(42 + 2 * d, static_cast<std::int16_t>(d < size.size() ? size[d] : 1));
    put(80 + 4 * d, 1.0f);
    voxels *= d < size.size() ? static_cast<std::size_t>(size[d]) : 1;
  }
  put(70, static_cast<std::int16_t>(type));
  put(72, static_cast<std::int16_t>(type == 16 ? 32 : 24));
  put(76, 1.0f);
  put(108, 352.0f);
  put(254, std::int16_t{ 1 }); // sform
  const float affine[3][4] = { { 1, shear, 0, 0 }, { 0, 1, 0, 0 }, { 0, 0, 1, 0 } };
  std::memcpy(&header[280], affine, sizeof(affine));
  std::memcpy(&header[344], "n+1", 4);
  std::vector<float> data(voxels, 1.0f);
  return header + std::string(reinterpret_cast<const char *>(data.data()), type == 16 ? 4 * voxels : 3 * voxels);
}

class ImageIOTest : public FileTest
{
protected:
  std::string
  ErrorOfReading(const std::string & name)
  {
    return ErrorOf([&] { ReadCT(Path(name)); });
  }
};

TEST_F(ImageIOTest, AnObliqueVolumeIsReadAsWrittenInEveryFormat)
{
  const auto ct = ObliqueRamp<CTImage>();
  const auto labels = ObliqueRamp<LabelImage>();
  for (const char * name : { "a.nii.gz", "a.nii", "a.mha", "a.mhd", "a.nrrd", "a.nhdr", "a.hdr", "a.img.gz" })
  {
    SCOPED_TRACE(name);
    bone::WriteImage(ct, Path(name));
    ExpectSame<CTImage>(ReadCT(Path(name)), ct);
    bone::WriteImage(labels, Path(name));
    ExpectSame<LabelImage>(ReadLabels(Path(name)), labels);
  }
  for (const auto & file : Files())
  {
    EXPECT_EQ(file.find("tmp"), std::string::npos) << file;
  }
}

TEST_F(ImageIOTest, VoxelsInAnotherFileAreTold)
{
  const auto ct = ObliqueRamp<CTImage>();
  for (const char * name : { "a.nii.gz", "a.nii", "a.mha", "a.nrrd" })
  {
    bone::WriteImage(ct, Path(name));
    EXPECT_FALSE(HasDetachedVoxels(Path(name))) << name;
  }
  for (const char * name : { "b.mhd", "b.nhdr", "b.hdr", "b.img.gz" })
  {
    bone::WriteImage(ct, Path(name));
    EXPECT_TRUE(HasDetachedVoxels(Path(name))) << name;
  }
  // Headers of other names, which ITK reads as well.
  std::filesystem::rename(Path("b.mhd"), Path("c.mha"));
  std::filesystem::rename(Path("b.nhdr"), Path("c.nrrd"));
  EXPECT_TRUE(HasDetachedVoxels(Path("c.mha")));
  EXPECT_TRUE(HasDetachedVoxels(Path("c.nrrd")));
}

TEST_F(ImageIOTest, PicturesAreWritten)
{
  auto grey = MakeImage<itk::Image<unsigned char, 2>>({ { 4, 3 } });
  auto colours = MakeImage<PictureImage>({ { 4, 3 } });
  for (unsigned char i = 0; i < 12; ++i)
  {
    grey->GetBufferPointer()[i] = 20 * i;
    const unsigned char rgb[3] = { i, static_cast<unsigned char>(100 + i), static_cast<unsigned char>(255 - 9 * i) };
    colours->GetBufferPointer()[i] = PictureImage::PixelType(rgb);
  }
  bone::WriteImage(grey, Path("g.png"));
  bone::WriteImage(colours, Path("p.png"));
  const auto greyRead = itk::ReadImage<itk::Image<unsigned char, 2>>(Path("g.png"));
  const auto coloursRead = itk::ReadImage<PictureImage>(Path("p.png"));
  ASSERT_EQ(coloursRead->GetBufferedRegion().GetSize(), colours->GetBufferedRegion().GetSize());
  EXPECT_TRUE(std::equal(grey->GetBufferPointer(), grey->GetBufferPointer() + 12, greyRead->GetBufferPointer()));
  EXPECT_TRUE(
    std::equal(colours->GetBufferPointer(), colours->GetBufferPointer() + 12, coloursRead->GetBufferPointer()));
  bone::WriteImage(MakeImage<itk::Image<float, 2>>({ { 4, 3 } }), Path("f.mha"));
  auto deep = MakeImage<itk::Image<unsigned short, 2>>({ { 4, 3 } });
  for (unsigned short i = 0; i < 12; ++i)
  {
    deep->GetBufferPointer()[i] = static_cast<unsigned short>(5000 * i + i);
  }
  bone::WriteImage(deep, Path("d.png"));
  const auto deepRead = itk::ReadImage<itk::Image<unsigned short, 2>>(Path("d.png"));
  ASSERT_EQ(deepRead->GetBufferedRegion().GetSize(), deep->GetBufferedRegion().GetSize());
  EXPECT_TRUE(std::equal(deep->GetBufferPointer(), deep->GetBufferPointer() + 12, deepRead->GetBufferPointer()));
  EXPECT_THAT(Files(), ElementsAre("d.png", "f.mha", "g.png", "p.png"));
}

TEST_F(ImageIOTest, APictureOnAFullDiskIsAnError)
{
  const auto picture = MakeImage<PictureImage>({ { 400, 300 } });
  EXPECT_THAT(ErrorOf([&] {
                const FullDisk full(20);
                bone::WriteImage(picture, Path("p.png"));
              }),
              HasSubstr("p.png: cannot write"));
  EXPECT_THAT(Files(), testing::IsEmpty());
}

TEST_F(ImageIOTest, ARadiographIsReadAsWritten)
{
  auto drr = MakeImage<CTImage>({ { 4, 3, 1 } });
  drr->FillBuffer(2.5f);
  bone::WriteImage(drr, Path("d.mha"));
  ExpectSame<CTImage>(ReadRadiograph(Path("d.mha")), drr);
  bone::WriteImage(ObliqueRamp<CTImage>(), Path("v.mha"));
  EXPECT_THAT(ErrorOf([&] { ReadRadiograph(Path("v.mha")); }), HasSubstr("5 pixels thick (7 x 6 x 5)"));
}

TEST_F(ImageIOTest, RefusesMissingFilesAndTexts)
{
  EXPECT_THAT(ErrorOfReading("no.nii.gz"), HasSubstr("no.nii.gz: there is no such file"));
  std::ofstream(Path("empty.nii.gz")).close();
  EXPECT_THAT(ErrorOfReading("empty.nii.gz"), HasSubstr("is empty"));
  for (const char * name : { "t.nii.gz", "t.nii", "t.nrrd", "t.txt", "t.png", "t.dcm" })
  {
    WriteText(name,
              "This is a text, and long enough to be taken for a header of some sort by a reader that looks at "
              "the first bytes of a file only, which none does, one hopes.\n");
    EXPECT_THAT(ErrorOfReading(name), AllOf(HasSubstr(Path(name)), HasSubstr("image")));
  }
  WriteText("t.mha", "This is a text.\n");
  EXPECT_THAT(ErrorOfReading("t.mha"), HasSubstr("t.mha: "));
  EXPECT_THAT(ErrorOfReading(""), HasSubstr("is a folder without a DICOM series"));
}

TEST_F(ImageIOTest, RefusesFilesThatAreCutShort)
{
  const auto expectRefused = [&](const std::string & name, std::size_t length) {
    SCOPED_TRACE(name);
    WriteText(name, ReadText(name).substr(0, length));
    EXPECT_THAT(ErrorOfReading(name), HasSubstr(Path(name) + ": "));
  };
  for (const char * name : { "a.nii.gz", "a.nii", "a.mha", "a.nrrd" })
  {
    for (const double part : { 0.7, 0.99 })
    {
      bone::WriteImage(ObliqueRamp<CTImage>(), Path(name));
      expectRefused(name, static_cast<std::size_t>(part * ReadText(name).size()));
    }
  }
  for (const char * name : { "a.nii.gz", "a.mha" })
  {
    bone::WriteImage(ObliqueRamp<LabelImage>(), Path(name));
    expectRefused(name, ReadText(name).size() - 1);
  }
  bone::WriteImage(ObliqueRamp<CTImage>(), Path("a.mhd"));
  WriteText("a.raw", "short");
  EXPECT_THAT(ErrorOfReading("a.mhd"), HasSubstr("a.mhd: is cut short"));
  std::filesystem::remove(Path("a.raw"));
  EXPECT_THAT(ErrorOfReading("a.mhd"), HasSubstr("a.mhd: "));
}

TEST_F(ImageIOTest, RefusesCompressedFilesWithOneChangedByte)
{
  auto labels = ObliqueRamp<LabelImage>();
  for (const char * name : { "a.nii.gz", "a.mha", "a.nrrd" })
  {
    bone::WriteImage(labels, Path(name));
    ExpectSame<LabelImage>(ReadLabels(Path(name)), labels);
    std::ostringstream whole;
    whole << std::ifstream(Path(name), std::ios::binary).rdbuf();
    int accepted = 0;
    // Data and checksum make at least the last third of these files.
    for (std::size_t i = 2 * whole.str().size() / 3; i < whole.str().size(); ++i)
    {
      std::string changed = whole.str();
      changed[i] = static_cast<char>(changed[i] ^ 0x10);
      std::ofstream(Path(name), std::ios::binary) << changed;
      SCOPED_TRACE(std::string(name) + " byte " + std::to_string(i));
      try
      {
        ExpectSame<LabelImage>(ReadLabels(Path(name)), labels); // a bit that fills up the last byte of the stream
        ++accepted;
      }
      catch (const IOError & error)
      {
        EXPECT_THAT(error.what(), HasSubstr(name));
      }
    }
    EXPECT_LE(accepted, 1) << name;
  }
}

TEST_F(ImageIOTest, RefusesMetaImagesWithoutTheirDataFiles)
{
  for (const char * data : { "LIST\n", "LIST\nno.raw\n", "%d.raw\n", "%d.raw 1 5 0\n" })
  {
    WriteText("m.mhd",
              std::string("ObjectType = Image\nNDims = 3\nBinaryData = True\nDimSize = 4 4 4\n"
                          "ElementType = MET_SHORT\nElementDataFile = ") +
                data);
    EXPECT_THAT(ErrorOfReading("m.mhd"), HasSubstr("m.mhd")) << data;
  }
}

TEST_F(ImageIOTest, RefusesMetaHeadersThatItksReaderCannotBear)
{
  WriteText("x.raw", std::string(128, '\0'));
  const auto error = [&](const std::string & lines, const std::string & last = "ElementDataFile = x.raw\n") {
    WriteText("m.mhd", "ObjectType = Image\nNDims = 3\nBinaryData = True\n" + lines + last);
    return ErrorOfReading("m.mhd");
  };
  const std::string grid = "DimSize = 4 4 4\nElementType = MET_SHORT\n";
  EXPECT_EQ(error(grid), "no IOError was thrown");
  EXPECT_THAT(error(grid, "ElementDateFile = x.raw\n"), HasSubstr("does not say where the voxels are"));
  for (const std::string & line :
       { "Comment = " + std::string(400, 'x'), std::string(400, 'x') + " = 1", std::string("x") })
  {
    EXPECT_THAT(error(line + '\n' + grid), HasSubstr("has a line that is damaged, or too long")) << line;
  }
  EXPECT_THAT(error("DimSize = 4 4 4\nElementType = MET_ODD\n"), HasSubstr("no known kind of number"));
  EXPECT_THAT(error("NDims = -3\n" + grid), HasSubstr("its header's 'NDims' is -3"));
  for (const char * size : { "-1e300", "-1", "1e9" })
  {
    EXPECT_THAT(error("CompressedData = True\nCompressedDataSize = " + std::string(size) + '\n' + grid),
                HasSubstr("m.mhd: is cut short or damaged"))
      << size;
  }
  for (const char * axes : { "0 0 0 0 0 0 0 0 0", "1 0 0 1 0 0 0 0 1" })
  {
    EXPECT_THAT(error("TransformMatrix = " + std::string(axes) + '\n' + grid),
                HasSubstr("m.mhd: its header's axes (direction) lie in one plane or are empty"));
  }
}

TEST_F(ImageIOTest, ALabelMapOfOneBoneSaysSo)
{
  auto labels = ObliqueRamp<LabelImage>();
  EXPECT_FALSE(StatesOneBone(*labels));
  StateOneBone(*labels);
  for (const char * name : { "a.nii.gz", "a.mha", "a.mhd", "a.nrrd", "a.hdr" })
  {
    bone::WriteImage(labels, Path(name));
    EXPECT_TRUE(StatesOneBone(*ReadLabels(Path(name)))) << name;
  }
}

TEST_F(ImageIOTest, RefusesWhatIsNoVolume)
{
  WriteText("v.nii", Nifti({ 4, 3, 2 }));
  EXPECT_EQ(ReadCT(Path("v.nii"))->GetLargestPossibleRegion().GetNumberOfPixels(), 24u);
  WriteText("v1.nii", Nifti({ 4, 3, 2, 1 }));
  EXPECT_EQ(ReadCT(Path("v1.nii"))->GetLargestPossibleRegion().GetNumberOfPixels(), 24u);
  WriteText("4d.nii", Nifti({ 4, 3, 2, 5 }));
  EXPECT_THAT(ErrorOfReading("4d.nii"), HasSubstr("is a 4D image (4 x 3 x 2 x 5): extract one 3D volume"));
  WriteText("slice.nii", Nifti({ 4, 3, 1 }));
  EXPECT_THAT(ErrorOfReading("slice.nii"), HasSubstr("is an image of one slice (4 x 3"));
  WriteText("2d.nii", Nifti({ 4, 3 }));
  EXPECT_THAT(ErrorOfReading("2d.nii"), HasSubstr("is an image of one slice (4 x 3"));
  WriteText("rgb.nii", Nifti({ 4, 3, 2 }, 0, 128));
  EXPECT_THAT(ErrorOfReading("rgb.nii"), HasSubstr("3 components per voxel"));
}

TEST_F(ImageIOTest, ReadsAnSformAloneWithSmallVoxelsOrAFarOriginOrRoundedAxes)
{
  // Each is refused by ITK 5.2 as not orthonormal.
  struct Case
  {
    std::array<float, 3> spacing;
    std::array<float, 3> origin;
    float                skew;
  };
  for (const auto & [spacing, origin, skew] : { Case{ { 0.2f, 0.2f, 1.0f }, { 65.5f, 146.8f, -420.1f }, 0.0f },
                                                Case{ { 0.082f, 0.082f, 0.082f }, { 12.0f, -30.0f, 700.0f }, 0.0f },
                                                Case{ { 0.8f, 0.8f, 1.5f }, { -200.0f, 180.0f, -1400.0f }, 5e-4f } })
  {
    std::string file = Nifti({ 4, 3, 2 });
    const float affine[3][4] = { { -spacing[0], skew, 0, origin[0] },
                                 { 0, 0, spacing[2], origin[1] },
                                 { 0, spacing[1], 0, origin[2] } };
    std::memcpy(&file[280], affine, sizeof(affine));
    std::memcpy(&file[148], "regions of one bone", 19);
    WriteText("s.nii", file);
    const auto ct = ReadCT(Path("s.nii"));
    const auto place = ct->TransformIndexToPhysicalPoint<double>({ { 3, 2, 1 } });
    EXPECT_NEAR(place[0], 3 * spacing[0] - origin[0], 2e-3);
    EXPECT_NEAR(place[1], -spacing[2] - origin[1], 2e-3);
    EXPECT_NEAR(place[2], 2 * spacing[1] + origin[2], 2e-3);
    EXPECT_NEAR(ct->GetSpacing()[2], spacing[2], 1e-6);
    EXPECT_TRUE(StatesOneBone(*ReadLabels(Path("s.nii"))));
  }
}

TEST_F(ImageIOTest, RefusesAnSformWhoseSkewMovesTheImagesEnd)
{
  // A small angle, which over 1000 voxels is a quarter of one.
  const float affine[3][4] = { { 0.2f, 1e-4f, 0, 65.5f }, { 0, 0.2f, 0, 146.8f }, { 0, 0, 1, -420.1f } };
  for (const short columns : { short{ 4 }, short{ 1000 } })
  {
    std::string file = Nifti({ 4, columns, 2 });
    std::memcpy(&file[280], affine, sizeof(affine));
    WriteText("s.nii", file);
    if (columns == 4)
    {
      EXPECT_NO_THROW(ReadCT(Path("s.nii")));
    }
    else
    {
      EXPECT_THAT(ErrorOfReading("s.nii"), HasSubstr("its axes are not at right angles"));
    }
  }
}

TEST_F(ImageIOTest, RefusesAShearedDirection)
{
  WriteText("s.nii", Nifti({ 4, 3, 2 }, 0.01f));
  EXPECT_THAT(ErrorOfReading("s.nii"), HasSubstr("its axes are not at right angles"));
}

TEST_F(ImageIOTest, RefusesVoxelsThatAreNotFinite)
{
  auto ct = ObliqueRamp<CTImage>();
  ct->SetPixel({ { 2, 3, 1 } }, std::numeric_limits<float>::quiet_NaN());
  ct->SetPixel({ { 2, 3, 4 } }, -std::numeric_limits<float>::infinity());
  for (const char * name : { "n.nii.gz", "n.nii", "n.mha", "n.nrrd", "n.hdr" })
  {
    SCOPED_TRACE(name);
    bone::WriteImage(ct, Path(name));
    EXPECT_THAT(ErrorOfReading(name), HasSubstr("has 2 voxels that are NaN or infinite, the first at [2, 3, 1]"));
    EXPECT_THAT(ErrorOf([&] { ReadLabels(Path(name)); }), HasSubstr("NaN"));
  }
}

TEST_F(ImageIOTest, RefusesLabelsThatAreNoWholeNumbers)
{
  auto ct = ObliqueRamp<CTImage>();
  bone::WriteImage(ct, Path("l.mha"));
  ExpectSame<LabelImage>(ReadLabels(Path("l.mha")), ObliqueRamp<LabelImage>());
  for (const float bad : { 0.5f, 40000.0f })
  {
    ct->SetPixel({ { 0, 1, 0 } }, bad);
    bone::WriteImage(ct, Path("l.mha"));
    EXPECT_THAT(ErrorOf([&] { ReadLabels(Path("l.mha")); }), HasSubstr("is no label map: its value at [0, 1, 0] is"));
  }
}

TEST_F(ImageIOTest, AWriteThatFailsLeavesNothing)
{
  const auto ct = ObliqueRamp<CTImage>();
  EXPECT_THAT(ErrorOf([&] { bone::WriteImage(ct, Path("no/a.mha")); }), HasSubstr("there is no folder"));
  EXPECT_THAT(ErrorOf([&] { bone::WriteImage(ct, Path("a.xyz")); }), HasSubstr("no image format has this extension"));
  EXPECT_THAT(ErrorOf([&] { bone::WriteImage(ct, Path("a.png")); }), HasSubstr("a.png: cannot write"));
  EXPECT_THAT(Files(), IsEmpty());
}

TEST_F(ImageIOTest, AFullDiskLeavesNothing)
{
  auto ct = MakeImage<CTImage>({ { 40, 40, 40 } });
  for (int i = 0; i < 40 * 40 * 40; ++i)
  {
    ct->GetBufferPointer()[i] = std::sin(1.7f * i * i); // hard to compress
  }
  for (const char * name : { "a.nii.gz", "a.nii", "a.mha", "a.mhd", "a.nrrd" })
  {
    SCOPED_TRACE(name);
    // The libraries below ITK say on the standard error stream what went wrong: that is not looked at here.
    testing::internal::CaptureStderr();
    EXPECT_THROW(
      {
        const FullDisk full(100000);
        bone::WriteImage(ct, Path(name));
      },
      IOError);
    testing::internal::GetCapturedStderr();
    EXPECT_THAT(Files(), IsEmpty());
  }
}
} // namespace ImageIOTests
} // namespace bone
