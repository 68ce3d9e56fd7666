/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneImageIO.h"
#include "boneTestFiles.h"

#include <itkGDCMImageIO.h>
#include <itkImageFileWriter.h>
#include <itkMetaDataObject.h>

namespace bone
{
using testing::HasSubstr;

namespace DicomSeriesTests
{
// One CT slice of 6 x 5 pixels, 0.5 x 0.5 mm, whose pixels all have the given value.
void
WriteSlice(const std::string & path, double x, double z, short value, const std::string & series)
{
  auto image = LabelImage::New();
  image->SetRegions(LabelImage::SizeType{ { 6, 5, 1 } });
  image->Allocate();
  image->FillBuffer(value);
  LabelImage::SpacingType spacing;
  spacing.Fill(0.5);
  image->SetSpacing(spacing);
  auto       io = itk::GDCMImageIO::New();
  auto &     dictionary = image->GetMetaDataDictionary();
  const auto put = [&](const char * key, const std::string & text) {
    itk::EncapsulateMetaData<std::string>(dictionary, key, text);
  };
  put("0008|0016", "1.2.840.10008.5.1.4.1.1.2");
  put("0008|0060", "CT");
  put("0028|0004", "MONOCHROME2");
  put("0020|000d", "1.2.826.0.1.3680043.2.1125.1");
  put("0020|000e", "1.2.826.0.1.3680043.2.1125.1." + series);
  put("0020|0032", std::to_string(x) + "\\20\\" + std::to_string(z));
  put("0020|0037", "1\\0\\0\\0\\1\\0");
  io->KeepOriginalUIDOn();
  auto writer = itk::ImageFileWriter<LabelImage>::New();
  writer->SetImageIO(io);
  writer->SetInput(image);
  writer->SetFileName(path);
  writer->Update();
}

class DicomSeriesTest : public FileTest
{
protected:
  std::string
  ErrorOfReading()
  {
    return ErrorOf([&] { ReadCT(m_Folder.string()); });
  }
};

TEST_F(DicomSeriesTest, AnEvenSeriesIsReadInTheOrderOfItsPositions)
{
  for (int k = 0; k < 5; ++k)
  {
    WriteSlice(Path(std::to_string(9 - k) + ".dcm"), 10, -30 + 1.25 * k, static_cast<short>(100 * k), "1");
  }
  const auto ct = ReadCT(m_Folder.string());
  EXPECT_EQ(ct->GetLargestPossibleRegion().GetSize(), (CTImage::SizeType{ { 6, 5, 5 } }));
  EXPECT_NEAR(ct->GetSpacing()[2], 1.25, 1e-9);
  EXPECT_NEAR(ct->GetOrigin()[0], 10, 1e-9);
  EXPECT_NEAR(ct->GetOrigin()[2], -30, 1e-9);
  for (int k = 0; k < 5; ++k)
  {
    EXPECT_EQ(ct->GetPixel({ { 3, 2, k } }), 100.0f * k);
  }
}

TEST_F(DicomSeriesTest, SlicesThatAreNotAskedForAreNotRead)
{
  for (int k = 0; k < 5; ++k)
  {
    WriteSlice(Path(std::to_string(k) + ".dcm"), 10, -30 + 1.25 * k, static_cast<short>(100 * k), "1");
  }
  const auto             whole = ReadCT(m_Folder.string());
  const auto             source = OpenCT(m_Folder.string());
  const CTImage::Pointer ct = source->GetOutput();
  EXPECT_EQ(ct->GetLargestPossibleRegion(), whole->GetLargestPossibleRegion());
  EXPECT_EQ(ct->GetOrigin(), whole->GetOrigin());
  EXPECT_EQ(ct->GetSpacing(), whole->GetSpacing());
  std::filesystem::remove(Path("4.dcm"));
  const CTImage::RegionType region({ { 1, 2, 1 } }, { { 3, 2, 2 } });
  ct->SetRequestedRegion(region);
  ct->Update();
  EXPECT_EQ(ct->GetBufferedRegion(), region);
  EXPECT_EQ(ct->GetPixel({ { 1, 2, 1 } }), 100.0f);
  EXPECT_EQ(ct->GetPixel({ { 3, 3, 2 } }), 200.0f);
  ct->SetRequestedRegionToLargestPossibleRegion();
  EXPECT_THAT(ErrorOf([&] { ct->Update(); }), HasSubstr("is no readable DICOM series"));
}

TEST_F(DicomSeriesTest, RefusesAMissingSlice)
{
  for (int k = 0; k < 9; ++k)
  {
    if (k != 5)
    {
      WriteSlice(Path(std::to_string(k) + ".dcm"), 10, 1.25 * k, 0, "1");
    }
  }
  EXPECT_THAT(ErrorOfReading(), HasSubstr("slices are not evenly spaced"));
}

TEST_F(DicomSeriesTest, RefusesASliceThatIsCutShort)
{
  for (int k = 0; k < 4; ++k)
  {
    WriteSlice(Path(std::to_string(k) + ".dcm"), 10, 1.25 * k, 0, "1");
  }
  const std::string whole = ReadText("2.dcm");
  for (const std::size_t bytes : { std::size_t{ 140 }, std::size_t{ 300 }, whole.size() / 2, whole.size() - 2 })
  {
    WriteText("2.dcm", whole.substr(0, bytes));
    EXPECT_THAT(ErrorOfReading(), HasSubstr("2.dcm: is a DICOM file that is cut short")) << bytes;
    EXPECT_THAT(ErrorOf([&] { ReadCT(Path("2.dcm")); }), HasSubstr("cut short")) << bytes;
  }
}

TEST_F(DicomSeriesTest, RefusesAMetaHeaderThatGdcmCannotBear)
{
  WriteSlice(Path("0.dcm"), 10, 0, 0, "1");
  const std::string     whole = ReadText("0.dcm");
  constexpr std::size_t second = 132 + 12; // (0002,0001) OB, after the group's length
  ASSERT_EQ(whole.substr(second + 4, 2), "OB");
  for (const auto & [at, bytes] : { std::pair<std::size_t, std::string>{ second + 4, "SQ" },
                                    { second + 4, "Ob" },
                                    { second + 8, "\xff\xff\xff\xff" },
                                    { second + 8, "\xff\xff\xff\x0f" } })
  {
    std::string damaged = whole;
    WriteText("0.dcm", damaged.replace(at, bytes.size(), bytes));
    EXPECT_THAT(ErrorOf([&] { ReadRadiograph(Path("0.dcm")); }), HasSubstr("0.dcm: is a DICOM file that is cut short"));
  }
}

TEST_F(DicomSeriesTest, RefusesPixelsThatGdcmCannotBear)
{
  WriteSlice(Path("0.dcm"), 10, 0, 0, "1");
  const std::string whole = ReadText("0.dcm");
  for (const char element : { '\x02', '\x00', '\x01' })
  {
    const std::string tag = std::string("\x28\x00", 2) + element + (element == '\x02' ? '\x00' : '\x01');
    ASSERT_NE(whole.find(tag), std::string::npos);
    std::string damaged = whole;
    WriteText("0.dcm", damaged.replace(whole.find(tag) + 8, 2, "\x2d\x01"));
    EXPECT_THAT(ErrorOf([&] { ReadRadiograph(Path("0.dcm")); }), HasSubstr("0.dcm: is a DICOM"));
  }
}

TEST_F(DicomSeriesTest, RefusesATiltedGantry)
{
  for (int k = 0; k < 5; ++k)
  {
    WriteSlice(Path(std::to_string(k) + ".dcm"), 10 + 0.5 * k, 1.25 * k, 0, "1");
  }
  EXPECT_THAT(ErrorOfReading(), HasSubstr("shift sideways"));
}

TEST_F(DicomSeriesTest, RefusesSeveralSeriesOneSliceAndNone)
{
  EXPECT_THAT(ErrorOfReading(), HasSubstr("is a folder without a DICOM series"));
  WriteText("note.txt", "no DICOM");
  EXPECT_THAT(ErrorOfReading(), HasSubstr("is a folder without a DICOM series"));
  WriteSlice(Path("0.dcm"), 0, 0, 0, "1");
  EXPECT_THAT(ErrorOfReading(), HasSubstr("series of one slice"));
  EXPECT_THAT(ErrorOf([&] { ReadCT(Path("0.dcm")); }), HasSubstr("for a DICOM series name its folder"));
  WriteSlice(Path("1.dcm"), 0, 1, 0, "2");
  EXPECT_THAT(ErrorOfReading(), HasSubstr("holds single DICOM images"));
}
} // namespace DicomSeriesTests
} // namespace bone
