/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneImageIO.h"
#include "boneLabelIO.h"
#include "boneLabelValue.h"

#include "boneTestFiles.h"

#include <itkImageFileReader.h>
#include <itkRegionOfInterestImageFilter.h>
#include <itk_zlib.h>

#include <cmath>
#include <cstring>
#include <limits>

namespace bone
{
using testing::HasSubstr;

namespace RegionReadingTests
{
using Region = CTImage::RegionType;

/** Values that are hard to compress, on an oblique grid; of a few MB with a hundred slices. */
template <typename TImage>
typename TImage::Pointer
MakeNoise(unsigned int slices)
{
  auto image = TImage::New();
  image->SetRegions(typename TImage::SizeType{ { 96, 80, slices } });
  image->Allocate();
  typename TImage::DirectionType direction;
  const double                   c = std::cos(0.3), s = std::sin(0.3);
  const double rotation[3][3] = { { c, -s, 0 }, { s * 0.6, c * 0.6, -0.8 }, { s * 0.8, c * 0.8, 0.6 } };
  for (unsigned int i = 0; i < 9; ++i)
  {
    direction(i / 3, i % 3) = rotation[i / 3][i % 3];
  }
  image->SetDirection(direction);
  typename TImage::PointType origin;
  origin.Fill(-37.5);
  image->SetOrigin(origin);
  std::uint32_t state = 1;
  for (std::size_t i = 0; i < 96 * 80 * slices; ++i)
  {
    state = 1664525u * state + 1013904223u;
    image->GetBufferPointer()[i] = static_cast<typename TImage::PixelType>(static_cast<int>(state >> 20) - 1024);
  }
  return image;
}

/** A part of an image, by a filter that asks for it. */
template <typename TImage>
typename TImage::Pointer
Part(const TImage * image, const Region & region)
{
  auto filter = itk::RegionOfInterestImageFilter<TImage, TImage>::New();
  filter->SetInput(image);
  filter->SetRegionOfInterest(region);
  filter->Update();
  return filter->GetOutput();
}

template <typename TImage>
void
ExpectSame(const TImage * a, const TImage * b)
{
  ASSERT_EQ(a->GetLargestPossibleRegion(), b->GetLargestPossibleRegion());
  EXPECT_EQ(a->GetOrigin(), b->GetOrigin());
  EXPECT_EQ(a->GetSpacing(), b->GetSpacing());
  EXPECT_EQ(a->GetDirection(), b->GetDirection());
  const std::size_t n = a->GetLargestPossibleRegion().GetNumberOfPixels();
  EXPECT_TRUE(std::equal(a->GetBufferPointer(), a->GetBufferPointer() + n, b->GetBufferPointer()));
}

/** To and fro, at borders and all. */
std::vector<Region>
Regions(const Region & whole)
{
  const auto          size = whole.GetSize();
  const auto          last = static_cast<itk::IndexValueType>(size[2]) - 1;
  std::vector<Region> regions{ { { { 0, 0, last } }, { { size[0], size[1], 1 } } },
                               { { { 3, 2, 0 } }, { { 1, 3, size[2] } } },
                               { { { 0, 1, last / 2 } }, { { size[0], 2, 2 } } },
                               { { { 1, 0, 1 } }, { { size[0] - 1, size[1], 1 } } } };
  regions.push_back(whole);
  return regions;
}

class RegionReadingTest : public FileTest
{
protected:
  /** Compares regions of a file with what ITK's own reader has there. */
  void
  ExpectRegionsOfItk(const std::string & name)
  {
    SCOPED_TRACE(name);
    const auto whole = itk::ReadImage<CTImage>(Path(name));
    const auto source = OpenCT(Path(name));
    EXPECT_EQ(source->GetOutput()->GetBufferedRegion().GetNumberOfPixels(), 0u);
    for (const Region & region : Regions(whole->GetLargestPossibleRegion()))
    {
      ExpectSame<CTImage>(Part(source->GetOutput(), region), Part(whole.GetPointer(), region));
    }
    ExpectSame<CTImage>(ReadCT(Path(name)), whole);
  }
  std::string
  ErrorOfOpening(const std::string & name)
  {
    return ErrorOf([&] { OpenCT(Path(name)); });
  }
  void
  Pack(const std::string & name, const std::string & text, const char * mode = "wb1")
  {
    const gzFile file = gzopen(Path(name).c_str(), mode);
    ASSERT_EQ(gzwrite(file, text.data(), static_cast<unsigned int>(text.size())), static_cast<int>(text.size()));
    ASSERT_EQ(gzclose(file), Z_OK);
  }
  void
  ExpectCutRefused(const std::string & name, const std::string & data)
  {
    SCOPED_TRACE(name);
    const std::string whole = ReadText(data);
    for (const std::size_t length : { whole.size() - 1, 2 * whole.size() / 3 })
    {
      WriteText(data, whole.substr(0, length));
      EXPECT_THAT(ErrorOfOpening(name), HasSubstr(name + ": is cut short or damaged"));
    }
    WriteText(data, whole);
  }
};

/** A NIfTI-1 file of 7 x 5 x 4 voxels of a type, all bytes in the other order where `swapped`. */
template <typename TVoxel>
std::string
Nifti(short type, float slope, float intercept, bool swapped, bool placed)
{
  std::string text(352, '\0');
  const auto  put = [&](std::size_t at, auto value) {
    std::memcpy(&text[at], &value, sizeof(value));
    if (swapped)
    {
      std::reverse(&text[at], &text[at] + sizeof(value));
    }
  };
  const short size[] = { 3, 7, 5, 4, 1, 1, 1, 1 };
  put(0, std::int32_t{ 348 });
  for (std::size_t d = 0; d < 8; ++d)
  {
    put(40 + 2 * d, size[d]);
    put(76 + 4 * d, d == 0 ? 1.0f : 0.5f + static_cast<float>(d));
  }
  put(70, type);
  put(72, static_cast<short>(8 * sizeof(TVoxel)));
  put(108, 352.0f);
  put(112, slope);
  put(116, intercept);
  if (placed)
  {
    put(252, short{ 1 });
    put(256, 0.3f);
    put(268, -12.5f);
  }
  std::memcpy(&text[344], "n+1", 4);
  text.resize(352 + 140 * sizeof(TVoxel));
  for (std::size_t i = 0; i < 140; ++i)
  {
    // Large ones too, of which float has not all digits.
    const double large = 0.9 * static_cast<double>(std::numeric_limits<TVoxel>::max());
    const double value = i % 5 == 0 ? std::min(large, 1.7e15 / 3.0) : static_cast<double>(i) - (i % 2 ? 0.0 : 30.0);
    put(352 + i * sizeof(TVoxel), static_cast<TVoxel>(std::is_signed<TVoxel>::value ? value : std::abs(value)));
  }
  return text;
}

TEST_F(RegionReadingTest, ARegionOfAnyFormatIsThatOfTheWhole)
{
  for (const char * name : { "a.nii", "b.nii.gz", "a.mha", "b.mhd", "a.nrrd", "c.nhdr", "d.hdr", "e.img.gz" })
  {
    bone::WriteImage(MakeNoise<CTImage>(9), Path(name));
    ExpectRegionsOfItk(name);
    bone::WriteImage(MakeNoise<LabelImage>(9), Path(name)); // compressed where the format can
    ExpectRegionsOfItk(name);
  }
}

TEST_F(RegionReadingTest, AFileIsReadAndNotOneOfTheSameNameBesideIt)
{
  // ITK's reader of NIfTI takes a.nii for a.nii.gz where there is one.
  const auto image = MakeNoise<LabelImage>(9);
  bone::WriteImage(image, Path("a.nii.gz"));
  image->FillBuffer(5);
  bone::WriteImage(image, Path("a.nii"));
  EXPECT_EQ(ReadLabels(Path("a.nii.gz"))->GetPixel({ { 0, 0, 0 } }),
            MakeNoise<LabelImage>(9)->GetPixel({ { 0, 0, 0 } }));
  EXPECT_EQ(ReadLabels(Path("a.nii"))->GetPixel({ { 0, 0, 0 } }), 5);
}

TEST_F(RegionReadingTest, ValuesOfEveryTypeAndScaleAndByteOrderAreItks)
{
  for (const auto & [slope, intercept] : { std::pair{ 0.0f, 0.0f },
                                           std::pair{ 1.0f, 0.0f },
                                           std::pair{ 0.37f, -1024.0f },
                                           std::pair{ -3.0f, 0.1f },
                                           std::pair{ 0.0f, 5.0f } })
  {
    for (const int variant : { 0, 1, 2, 3 })
    {
      SCOPED_TRACE(std::to_string(slope) + " " + std::to_string(intercept) + " " + std::to_string(variant));
      const bool swapped = variant % 2 == 1, placed = variant < 2;
      WriteText("a.nii", Nifti<unsigned char>(2, slope, intercept, swapped, placed));
      WriteText("b.nii", Nifti<short>(4, slope, intercept, swapped, placed));
      WriteText("c.nii", Nifti<int>(8, slope, intercept, swapped, placed));
      WriteText("d.nii", Nifti<float>(16, slope, intercept, swapped, placed));
      WriteText("e.nii", Nifti<double>(64, slope, intercept, swapped, placed));
      WriteText("f.nii", Nifti<signed char>(256, slope, intercept, swapped, placed));
      WriteText("g.nii", Nifti<unsigned short>(512, slope, intercept, swapped, placed));
      WriteText("h.nii", Nifti<unsigned int>(768, slope, intercept, swapped, placed));
      WriteText("i.nii", Nifti<long long>(1024, slope, intercept, swapped, placed));
      WriteText("j.nii", Nifti<unsigned long long>(1280, slope, intercept, swapped, placed));
      for (const char * name :
           { "a.nii", "b.nii", "c.nii", "d.nii", "e.nii", "f.nii", "g.nii", "h.nii", "i.nii", "j.nii" })
      {
        const auto whole = itk::ReadImage<CTImage>(Path(name));
        const auto source = OpenCT(Path(name));
        for (const Region & region : Regions(whole->GetLargestPossibleRegion()))
        {
          SCOPED_TRACE(name);
          ExpectSame<CTImage>(Part(source->GetOutput(), region), Part(whole.GetPointer(), region));
        }
      }
    }
  }
}

TEST_F(RegionReadingTest, TheOtherByteOrderOfMetaImagesAndNrrdIsItks)
{
  std::string data;
  for (int i = 0; i < 4 * 5 * 6; ++i)
  {
    data += static_cast<char>(i / 7);
    data += static_cast<char>(i);
  }
  WriteText("a.mha",
            "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = True\nDimSize = 4 5 6\n"
            "ElementType = MET_SHORT\nElementDataFile = LOCAL\n" +
              data);
  WriteText("a.nrrd", "NRRD0004\ntype: short\ndimension: 3\nsizes: 4 5 6\nendian: big\nencoding: raw\n\n" + data);
  ExpectRegionsOfItk("a.mha");
  ExpectRegionsOfItk("a.nrrd");
}

TEST_F(RegionReadingTest, CompressedVoxelsAreEnteredPastTheBeginning)
{
  // Of 6 MB: what was scanned is entered every 2 MB.
  const auto image = MakeNoise<CTImage>(200);
  bone::WriteImage(image, Path("a.nii"));
  const std::string text = ReadText("a.nii");
  Pack("one.nii.gz", text);
  Pack("several.nii.gz", text.substr(0, text.size() / 2));
  Pack("several.nii.gz", text.substr(text.size() / 2), "ab1");
  const Region last({ { 2, 3, 190 } }, { { 50, 40, 10 } });
  for (const char * name : { "one.nii.gz", "several.nii.gz" })
  {
    ExpectRegionsOfItk(name);
    const auto  whole = itk::ReadImage<CTImage>(Path(name));
    const auto  source = OpenCT(Path(name));
    std::string damaged = ReadText(name);
    std::fill_n(damaged.begin() + 1000, 1000, '\0');
    WriteText(name, damaged);
    ExpectSame<CTImage>(Part(source->GetOutput(), last), Part(whole.GetPointer(), last));
    EXPECT_THAT(ErrorOf([&] { Part(source->GetOutput(), whole->GetLargestPossibleRegion()); }),
                HasSubstr(std::string(name) + ": is cut short or damaged"));
  }
}

TEST_F(RegionReadingTest, WhatFollowsTheVoxelsIsPassedOverAsByGzip)
{
  bone::WriteImage(MakeNoise<CTImage>(9), Path("a.nii"));
  const std::string text = ReadText("a.nii");
  Pack("b.nii.gz", text + "more");
  Pack("c.nii.gz", text);
  WriteText("c.nii.gz", ReadText("c.nii.gz") + "no member of gzip");
  WriteText("d.nii", text + "more");
  for (const char * name : { "b.nii.gz", "c.nii.gz", "d.nii" })
  {
    ExpectRegionsOfItk(name);
  }
}

TEST_F(RegionReadingTest, FilesCutShortAreRefusedBeforeARegionIsRead)
{
  for (const char * name : { "a.nii", "a.nii.gz", "a.mha", "a.nrrd" })
  {
    bone::WriteImage(MakeNoise<CTImage>(9), Path(name));
    ExpectCutRefused(name, name);
    bone::WriteImage(MakeNoise<LabelImage>(9), Path(name));
    ExpectCutRefused(name, name);
  }
  bone::WriteImage(MakeNoise<CTImage>(9), Path("b.mhd"));
  ExpectCutRefused("b.mhd", "b.raw");
}

TEST_F(RegionReadingTest, VoxelsThatAreNotFiniteAreRefusedWhereverTheyAre)
{
  const auto ct = MakeNoise<CTImage>(9);
  ct->SetPixel({ { 2, 3, 7 } }, std::numeric_limits<float>::quiet_NaN());
  ct->SetPixel({ { 5, 3, 8 } }, -std::numeric_limits<float>::infinity());
  for (const char * name : { "a.nii", "a.nii.gz", "a.mha", "a.nrrd", "a.hdr" })
  {
    bone::WriteImage(ct, Path(name));
    EXPECT_THAT(ErrorOfOpening(name), HasSubstr("has 2 voxels that are NaN or infinite, the first at [2, 3, 7]"));
  }
}

TEST_F(RegionReadingTest, AVolumeOfFourAxesIsRefusedAndOneOfOneStepIsNot)
{
  std::string text = Nifti<short>(4, 1.0f, 0.0f, false, true);
  const auto  setAxes = [&text](short steps) {
    const short axes[] = { 4, 7, 5, static_cast<short>(4 / steps), steps };
    std::memcpy(&text[40], axes, sizeof(axes));
  };
  setAxes(1);
  WriteText("a.nii", text);
  ExpectRegionsOfItk("a.nii");
  setAxes(2);
  WriteText("a.nii", text);
  EXPECT_THAT(ErrorOfOpening("a.nii"), HasSubstr("is a 4D image (7 x 5 x 2 x 2): extract one 3D volume"));
}

TEST_F(RegionReadingTest, LabelsAreReadByRegionsAndKeepWhatTheirHeaderStates)
{
  auto labels = MakeNoise<LabelImage>(9);
  StateOneBone(*labels);
  bone::WriteImage(labels, Path("l.nii.gz"));
  const LabelFile file = OpenLabelFile(Path("l.nii.gz"));
  ASSERT_EQ(file.layers.size(), 1u);
  EXPECT_EQ(file.layers.front()->GetBufferedRegion().GetNumberOfPixels(), 0u);
  EXPECT_TRUE(StatesOneBone(*file.layers.front()));
  const auto whole = ReadLabels(Path("l.nii.gz"));
  for (const Region & region : Regions(whole->GetLargestPossibleRegion()))
  {
    ExpectSame<LabelImage>(Part(file.layers.front().GetPointer(), region), Part(whole.GetPointer(), region));
  }
}

TEST_F(RegionReadingTest, WhatIsNoLabelIsToldWhereItIsRead)
{
  const auto ct = MakeNoise<CTImage>(9);
  ct->SetPixel({ { 1, 2, 7 } }, 0.5f);
  bone::WriteImage(ct, Path("l.mha"));
  const LabelFile file = OpenLabelFile(Path("l.mha"));
  EXPECT_NO_THROW(Part(file.layers.front().GetPointer(), Region({ { 0, 0, 0 } }, { { 96, 80, 7 } })));
  EXPECT_THAT(ErrorOf([&] {
                Part(file.layers.front().GetPointer(), Region({ { 0, 0, 5 } }, { { 96, 80, 4 } }));
              }),
              HasSubstr("l.mha: is no label map: its value at [1, 2, 7] is 0.5"));
}
} // namespace RegionReadingTests
} // namespace bone
