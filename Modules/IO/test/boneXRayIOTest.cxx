/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneXRayIO.h"

#include "boneTestDicom.h"
#include "boneTestFiles.h"
#include "boneXRayConventions.h"

#include <dcmtk/config/osconfig.h>

#include <dcmtk/dcmdata/dctk.h>

#include <map>

namespace bone
{
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

namespace XRayIOTests
{
constexpr int Columns = 6, Rows = 4;

/** Attributes by group and element; an empty text takes one out. */
using Attributes = std::map<std::pair<int, int>, std::string>;

class XRayIO : public FileTest
{
protected:
  /** A fluoroscopic image of a C-arm, with these changes; pixel (c, r) is 100 + 10 r + c. */
  std::string
  Write(const Attributes & changes = {}, int bits = 16, bool damaged = false) const
  {
    Attributes all = { { { 0x0008, 0x0016 }, "1.2.840.10008.5.1.4.1.1.12.2" },
                       { { 0x0008, 0x0018 }, "1.2.3.4.5" },
                       { { 0x0008, 0x0060 }, "RF" },
                       { { 0x0018, 0x1110 }, "1000.0" },
                       { { 0x0018, 0x1111 }, "700" },
                       { { 0x0018, 0x1164 }, "0.25\\0.5" },
                       { { 0x0018, 0x1508 }, "CARM" },
                       { { 0x0018, 0x1510 }, "30" },
                       { { 0x0018, 0x1511 }, "-10.5" },
                       { { 0x0018, 0x5100 }, "HFS" },
                       { { 0x0028, 0x0004 }, "MONOCHROME2" },
                       { { 0x0028, 0x1040 }, "LIN" } };
    for (const auto & [tag, text] : changes)
    {
      all[tag] = text;
    }
    DcmFileFormat file;
    DcmDataset &  data = *file.getDataset();
    for (const auto & [tag, text] : all)
    {
      if (!text.empty())
      {
        const DcmTagKey key(static_cast<Uint16>(tag.first), static_cast<Uint16>(tag.second));
        EXPECT_TRUE(data.putAndInsertString(key, text.c_str()).good()) << text;
      }
    }
    const auto whole = [&](const DcmTagKey & key, Uint16 value) { data.putAndInsertUint16(key, value); };
    whole(DCM_Rows, Rows);
    whole(DCM_Columns, Columns);
    whole(DCM_SamplesPerPixel, 1);
    whole(DCM_BitsAllocated, static_cast<Uint16>(bits));
    whole(DCM_BitsStored, static_cast<Uint16>(bits == 16 ? 12 : 8));
    whole(DCM_HighBit, static_cast<Uint16>(bits == 16 ? 11 : 7));
    whole(DCM_PixelRepresentation, 0);
    std::vector<Uint16> words;
    std::vector<Uint8>  bytes;
    for (int r = 0; r < Rows; ++r)
    {
      for (int c = 0; c < Columns; ++c)
      {
        words.push_back(static_cast<Uint16>(100 + 10 * r + c));
        bytes.push_back(static_cast<Uint8>(100 + 10 * r + c));
      }
    }
    const unsigned long count = damaged ? 10 : Columns * Rows;
    if (bits == 16)
    {
      data.putAndInsertUint16Array(DCM_PixelData, words.data(), count);
    }
    else
    {
      data.putAndInsertUint8Array(DCM_PixelData, bytes.data(), count);
    }
    EXPECT_TRUE(file.saveFile(Path("x.dcm").c_str(), EXS_LittleEndianExplicit).good());
    return Path("x.dcm");
  }
};

float
Pixel(const XRayFile & file, int column, int row)
{
  return file.image->GetPixel({ { column, row, 0 } });
}

TEST_F(XRayIO, AFluoroscopicImageHasItsViewAndLiesOnItsDetector)
{
  const XRayFile file = ReadXRay(Write());
  EXPECT_THAT(file.obstacles, IsEmpty());
  EXPECT_THAT(file.notes, IsEmpty());
  EXPECT_THAT(file.crop, IsEmpty());
  ASSERT_TRUE(file.view.has_value());
  CArmView arm;
  arm.primary = 30;
  arm.secondary = -10.5;
  arm.size = { { Columns, Rows } };
  arm.spacing = { 0.5, 0.25 }; // columns, rows; DICOM has them the other way round
  const auto expected = FromCArm(arm);
  EXPECT_EQ(file.view->size, arm.size);
  EXPECT_EQ(file.view->spacing, arm.spacing);
  EXPECT_NEAR((file.view->source - expected.source).norm(), 0, 1e-9);
  EXPECT_NEAR((file.view->detectorOrigin - expected.detectorOrigin).norm(), 0, 1e-9);
  const auto geometry = XRayGeometry::New();
  geometry->SetView(*file.view);
  CTImage::PointType point;
  file.image->TransformIndexToPhysicalPoint(CTImage::IndexType{ { 4, 3, 0 } }, point);
  EXPECT_NEAR((Vector3(point[0], point[1], point[2]) - geometry->GetPixelPoint(4, 3)).norm(), 0, 1e-9);
  EXPECT_EQ(file.image->GetLargestPossibleRegion().GetSize(), (CTImage::SizeType{ { Columns, Rows, 1 } }));
  EXPECT_EQ(Pixel(file, 4, 3), 134);
  EXPECT_EQ(Pixel(file, 0, 1), 110);
}

TEST_F(XRayIO, LinearValuesAreIntensities)
{
  EXPECT_EQ(ReadXRay(Write()).values, RadiographValues::Intensity);
  const auto scaled = ReadXRay(Write({ { { 0x0028, 0x1053 }, "2" }, { { 0x0028, 0x1052 }, "-50" } }));
  EXPECT_EQ(Pixel(scaled, 1, 0), 2 * 101 - 50);
  const auto inverse = ReadXRay(Write({ { { 0x0028, 0x1041 }, "-1" } }));
  EXPECT_EQ(inverse.values, RadiographValues::Intensity);
  EXPECT_EQ(Pixel(inverse, 1, 0), 4095 - 101) << "of 12 bits";
  ASSERT_EQ(inverse.notes.size(), 1u);
}

TEST_F(XRayIO, OtherValuesAreMadeToBeLookedAt)
{
  for (const char * relationship : { "LOG", "DISP", "" })
  {
    const auto file = ReadXRay(Write({ { { 0x0028, 0x1040 }, relationship }, { { 0x0028, 0x1041 }, "1" } }));
    EXPECT_EQ(file.values, RadiographValues::Display) << relationship;
    EXPECT_FALSE(file.largerAttenuates) << "larger values are more beam";
    EXPECT_EQ(Pixel(file, 1, 0), 101);
  }
  EXPECT_TRUE(ReadXRay(Write({ { { 0x0028, 0x1040 }, "LOG" }, { { 0x0028, 0x1041 }, "-1" } })).largerAttenuates);
}

TEST_F(XRayIO, WithoutASignTheModalityAndThePhotometricInterpretationDecide)
{
  for (const bool bright : { true, false })
  {
    for (const bool inverted : { true, false })
    {
      const auto file = ReadXRay(Write({ { { 0x0028, 0x1040 }, "DISP" },
                                         { { 0x0008, 0x0060 }, bright ? "DX" : "XA" },
                                         { { 0x0028, 0x0004 }, inverted ? "MONOCHROME1" : "MONOCHROME2" } },
                                       8));
      EXPECT_EQ(file.largerAttenuates, bright != inverted);
      EXPECT_THAT(file.notes, ElementsAre(HasSubstr(bright ? "bright" : "dark")));
      EXPECT_EQ(Pixel(file, 5, 3), 135) << "8 bits";
    }
  }
}

TEST_F(XRayIO, SaysWhatAViewLacks)
{
  const auto missing = [&](const Attributes & changes) {
    const XRayFile file = ReadXRay(Write(changes));
    EXPECT_FALSE(file.view.has_value());
    EXPECT_EQ(Pixel(file, 4, 3), 134) << "the image is read all the same";
    return file.obstacles;
  };
  EXPECT_THAT(missing({ { { 0x0018, 0x1110 }, "" } }), ElementsAre("DistanceSourceToDetector (0018,1110) is missing"));
  EXPECT_THAT(missing({ { { 0x0018, 0x1164 }, "" }, { { 0x0018, 0x1111 }, "" } }),
              ElementsAre(HasSubstr("DistanceSourceToPatient"), HasSubstr("ImagerPixelSpacing (0018,1164)")));
  EXPECT_THAT(missing({ { { 0x0008, 0x0060 }, "DX" },
                        { { 0x0018, 0x1510 }, "" },
                        { { 0x0018, 0x1511 }, "" },
                        { { 0x0018, 0x5101 }, "AP" } }),
              ElementsAre(HasSubstr("PositionerPrimaryAngle"),
                          HasSubstr("PositionerSecondaryAngle"),
                          HasSubstr("ViewPosition (0018,5101) is AP, which is not enough")));
  EXPECT_THAT(missing({ { { 0x0018, 0x1508 }, "COLUMN" } }), ElementsAre(HasSubstr("COLUMN, not CARM")));
  EXPECT_THAT(missing({ { { 0x0018, 0x5100 }, "FFP" } }), ElementsAre(HasSubstr("FFP, not HFS")));
  EXPECT_THAT(missing({ { { 0x0018, 0x7032 }, "90" } }), ElementsAre(HasSubstr("turned")));
  EXPECT_THAT(missing({ { { 0x0018, 0x7034 }, "YES" } }), ElementsAre(HasSubstr("flipped")));
  EXPECT_THAT(missing({ { { 0x0018, 0x1110 }, "500" } }), ElementsAre(HasSubstr("isocentre must lie before")));
  EXPECT_THAT(missing({ { { 0x0018, 0x1164 }, "0\\0.5" } }), ElementsAre(HasSubstr("pixel spacing")));
  EXPECT_THAT(missing({ { { 0x0020, 0x0020 }, "R\\F" } }), ElementsAre(HasSubstr("R for the rows")));
}

TEST_F(XRayIO, WhatAgreesWithTheAnglesIsNoObstacle)
{
  EXPECT_TRUE(
    ReadXRay(Write({ { { 0x0020, 0x0020 }, "LP\\F" }, { { 0x0018, 0x7032 }, "0.0" }, { { 0x0018, 0x7034 }, "NO" } }))
      .view.has_value());
  EXPECT_TRUE(ReadXRay(Write({ { { 0x0018, 0x1508 }, "" }, { { 0x0018, 0x5100 }, "" } })).view.has_value());
}

TEST_F(XRayIO, WithoutAViewTheImageHasTheDetectorsSpacing)
{
  const auto file = ReadXRay(Write({ { { 0x0018, 0x1510 }, "" } }));
  EXPECT_EQ(file.image->GetSpacing()[0], 0.5);
  EXPECT_EQ(file.image->GetSpacing()[1], 0.25);
  EXPECT_EQ(file.image->GetOrigin()[1], 0);
}

TEST_F(XRayIO, CollimatorAndShutterLeaveARectangle)
{
  const Attributes collimator = { { { 0x0018, 0x1700 }, "RECTANGULAR" },
                                  { { 0x0018, 0x1702 }, "1" },
                                  { { 0x0018, 0x1704 }, "7" },
                                  { { 0x0018, 0x1706 }, "0" },
                                  { { 0x0018, 0x1708 }, "4" } };
  // Columns 2 to 6 and rows 1 to 3 of those counted from 1.
  EXPECT_THAT(ReadXRay(Write(collimator)).crop, ElementsAre(1, 0, 5, 3));
  Attributes both = collimator;
  both[{ 0x0018, 0x1600 }] = "RECTANGULAR";
  both[{ 0x0018, 0x1602 }] = "3";
  both[{ 0x0018, 0x1604 }] = "6";
  EXPECT_THAT(ReadXRay(Write(both)).crop, ElementsAre(3, 0, 2, 3));
  both[{ 0x0018, 0x1602 }] = "5";
  const auto nothing = ReadXRay(Write(both));
  EXPECT_THAT(nothing.crop, IsEmpty());
  EXPECT_THAT(nothing.notes, ElementsAre(HasSubstr("leave nothing free")));
  const auto round = ReadXRay(Write({ { { 0x0018, 0x1700 }, "CIRCULAR" } }));
  EXPECT_THAT(round.crop, IsEmpty());
  EXPECT_THAT(round.notes, ElementsAre(HasSubstr("CIRCULAR")));
}

TEST_F(XRayIO, OtherImagesAreReadWithoutAView)
{
  auto                image = CTImage::New();
  CTImage::RegionType region;
  region.SetSize({ { 5, 4, 1 } });
  image->SetRegions(region);
  image->Allocate();
  image->FillBuffer(2.5f);
  bone::WriteImage(image.GetPointer(), Path("r.mha"));
  const auto file = ReadXRay(Path("r.mha"));
  EXPECT_FALSE(file.view.has_value());
  EXPECT_EQ(file.values, RadiographValues::Integral);
  EXPECT_EQ(Pixel(file, 2, 2), 2.5f);
  EXPECT_THAT(file.obstacles, ElementsAre("it is no DICOM file"));
}

TEST_F(XRayIO, RefusesWhatIsNoRadiograph)
{
  const auto error = [](const std::string & path) { return ErrorOf([&] { ReadXRay(path); }); };
  EXPECT_THAT(error(Path("none.dcm")), HasSubstr("none.dcm"));
  EXPECT_THAT(error(Write({ { { 0x0008, 0x0060 }, "CT" } })), HasSubstr("modality 'CT'"));
  EXPECT_THAT(error(Write({ { { 0x0028, 0x0008 }, "7" } }, 16, true)), HasSubstr("not all there"));
  EXPECT_THAT(error(Write({}, 16, true)), HasSubstr("not all there"));
  const std::string whole = Write();
  const std::string text = ReadText("x.dcm");
  WriteText("x.dcm", text.substr(0, text.size() / 2));
  EXPECT_THAT(error(whole), HasSubstr("x.dcm"));
}

TEST_F(XRayIO, RefusesSeveralFrames)
{
  DcmFileFormat file;
  ASSERT_TRUE(file.loadFile(Write().c_str()).good());
  std::vector<Uint16> pixels(2 * Columns * Rows, 7);
  file.getDataset()->putAndInsertString(DCM_NumberOfFrames, "2");
  file.getDataset()->putAndInsertUint16Array(DCM_PixelData, pixels.data(), pixels.size());
  ASSERT_TRUE(file.saveFile(Path("m.dcm").c_str(), EXS_LittleEndianExplicit).good());
  EXPECT_THAT(ErrorOf([&] { ReadXRay(Path("m.dcm")); }), HasSubstr("2 frames where one is needed"));
}

TEST_F(XRayIO, CompressedImagesAreReadUnlessTheirSizeIsAnother)
{
  const std::string plain = Write();
  const auto        image = ReadXRay(plain).image;
  using Syntax = gdcm::TransferSyntax;
  for (const auto syntax : { Syntax::RLELossless, Syntax::JPEGLosslessProcess14_1 })
  {
    TransferDicom(plain, syntax, Path("c.dcm"));
    const auto read = ReadXRay(Path("c.dcm")).image;
    EXPECT_TRUE(
      std::equal(image->GetBufferPointer(), image->GetBufferPointer() + Columns * Rows, read->GetBufferPointer()));
    DcmFileFormat file;
    ASSERT_TRUE(file.loadFile(Path("c.dcm").c_str()).good());
    // Without colours RLE's segments tell the bytes of a pixel alone.
    const auto & key = syntax == Syntax::RLELossless ? DCM_SamplesPerPixel : DCM_Rows;
    file.getDataset()->putAndInsertUint16(key, syntax == Syntax::RLELossless ? 3 : Rows - 1);
    ASSERT_TRUE(file.saveFile(Path("d.dcm").c_str()).good());
    EXPECT_THAT(ErrorOf([&] { ReadXRay(Path("d.dcm")); }), HasSubstr("pixels are damaged"));
  }
}

TEST_F(XRayIO, CompressedImagesHaveToHaveTheirPixels)
{
  TransferDicom(Write(), gdcm::TransferSyntax::JPEGLosslessProcess14_1, Path("cut.dcm"));
  std::string text = ReadText("cut.dcm");
  text.resize(text.find("\xFF\xD8") - 16); // before the table of offsets
  WriteText("cut.dcm", text);
  EXPECT_THAT(ErrorOf([&] { ReadXRay(Path("cut.dcm")); }), HasSubstr("cut.dcm"));
}
} // namespace XRayIOTests
} // namespace bone
