/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneLabelIO.h"

#include "boneTestFiles.h"

#include <itkImageRegionIteratorWithIndex.h>

namespace bone
{
namespace LabelIOTests
{
class LabelIOTest : public FileTest
{
protected:
  /** A .seg.nrrd of 2 x 3 x 4 voxels in so many layers, each voxel with the value 10 * layer + x. */
  void
  WriteSegments(const std::string & name, int layers, const std::string & notes)
  {
    std::string text = "NRRD0004\ntype: unsigned char\nspace: left-posterior-superior\n";
    text += layers == 1
              ? "dimension: 3\nsizes: 2 3 4\nspace directions: (1,0,0) (0,1,0) (0,0,2)\n"
              : "dimension: 4\nsizes: " + std::to_string(layers) +
                  " 2 3 4\nspace directions: none (1,0,0) (0,1,0) (0,0,2)\nkinds: list domain domain domain\n";
    text += "encoding: raw\nspace origin: (5,6,7)\n" + notes + "\n";
    for (int i = 0; i < 2 * 3 * 4; ++i)
    {
      for (int layer = 0; layer < layers; ++layer)
      {
        text += static_cast<char>(10 * layer + i % 2);
      }
    }
    WriteText(name, text);
  }

  std::string
  ErrorOfTable(const std::string & name, const std::string & text)
  {
    WriteText(name, text);
    return ErrorOf([&] { ReadLabelTable(Path(name)); });
  }
};

TEST_F(LabelIOTest, LayersAreLabelMapsOfTheirOwn)
{
  WriteSegments("a.seg.nrrd",
                3,
                "Segment0_Name:=Femur\nSegment0_Layer:=2\nSegment0_LabelValue:=20\nSegment1_ID:=Segment_2\n"
                "Segment1_Layer:=1\nSegment1_LabelValue:=11\n");
  const LabelFile file = ReadLabelFile(Path("a.seg.nrrd"));
  ASSERT_EQ(file.layers.size(), 3u);
  for (int layer = 0; layer < 3; ++layer)
  {
    const LabelImage * labels = file.layers[layer];
    EXPECT_EQ(labels->GetOrigin()[2], 7.0);
    EXPECT_EQ(labels->GetSpacing()[2], 2.0);
    EXPECT_EQ(labels->GetLargestPossibleRegion().GetSize(), (itk::Size<3>{ { 2, 3, 4 } }));
    itk::ImageRegionConstIteratorWithIndex<LabelImage> it(labels, labels->GetLargestPossibleRegion());
    for (; !it.IsAtEnd(); ++it)
    {
      ASSERT_EQ(it.Get(), 10 * layer + it.GetIndex()[0]);
    }
  }
  ASSERT_EQ(file.names.size(), 2u);
  EXPECT_EQ(file.names[0].name, "Femur");
  EXPECT_EQ(file.names[0].layer, 2u);
  EXPECT_EQ(file.names[0].value, 20);
  EXPECT_EQ(file.names[1].name, "Segment_2");
  EXPECT_EQ(file.names[1].layer, 1u);
}

TEST_F(LabelIOTest, SegmentsOfBeforeSlicer411HaveALayerEach)
{
  WriteSegments("a.seg.nrrd", 2, "Segment0_Name:=Femur\nSegment1_Name:=Tibia\n");
  const auto names = ReadLabelFile(Path("a.seg.nrrd")).names;
  ASSERT_EQ(names.size(), 2u);
  EXPECT_EQ(names[1].layer, 1u);
  EXPECT_EQ(names[1].value, 1);
}

TEST_F(LabelIOTest, OneLayerIsALabelMap)
{
  WriteSegments("a.seg.nrrd", 1, "Segment0_Name:=Femur\nSegment0_Layer:=0\nSegment0_LabelValue:=1\n");
  EXPECT_EQ(ReadLabelFile(Path("a.seg.nrrd")).layers.size(), 1u);
  EXPECT_EQ(ReadLabels(Path("a.seg.nrrd"))->GetOrigin()[0], 5.0);
  EXPECT_TRUE(ReadLabelNames(Path("b.nrrd")).empty());
}

TEST_F(LabelIOTest, RefusesLayersWhereOneIsNeededAndSegmentsInNone)
{
  WriteSegments("a.seg.nrrd", 2, "");
  EXPECT_NE(ErrorOf([&] { ReadLabels(Path("a.seg.nrrd")); }).find("2 layers"), std::string::npos);
  WriteSegments("b.seg.nrrd", 2, "Segment0_Name:=Femur\nSegment0_Layer:=2\nSegment0_LabelValue:=1\n");
  EXPECT_NE(ErrorOf([&] { ReadLabelFile(Path("b.seg.nrrd")); }).find("'Femur' in a layer"), std::string::npos);
}

TEST_F(LabelIOTest, TablesAreReadWithoutBackgroundAndHeading)
{
  WriteText("a.txt", "# comment\nIndex Name\n0 air\n\n-3\tleft femur\t1 2 3\n7 \"the last; one\" x\n");
  const auto names = ReadLabelTable(Path("a.txt"));
  ASSERT_EQ(names.size(), 2u);
  EXPECT_EQ(names[0].value, -3);
  EXPECT_EQ(names[0].name, "left femur");
  EXPECT_EQ(names[1].name, "the last; one");
}

TEST_F(LabelIOTest, RefusesWhatIsNoTable)
{
  EXPECT_NE(ErrorOfTable("a.txt", "7 femur\nno number here\n").find("line 2"), std::string::npos);
  EXPECT_NE(ErrorOfTable("b.txt", "0 air\n").find("no table"), std::string::npos);
  EXPECT_NE(ErrorOfTable("c.txt", "99999 femur\n").find("no table"), std::string::npos);
  EXPECT_NE(ErrorOfTable("d.json", "[1]").find("no table"), std::string::npos);
  EXPECT_NE(ErrorOfTable("e.json", R"({"a": 1.5})").find("'a'"), std::string::npos);
  EXPECT_NE(ErrorOfTable("f.json", R"({"99999": "a"})").find("'99999'"), std::string::npos);
}
} // namespace LabelIOTests
} // namespace bone
