/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneContourIO.h"

#include "boneTestFiles.h"
#include "boneTestStructures.h"

namespace bone
{
using testing::HasSubstr;

namespace StructureSetTests
{
std::vector<Vector3>
Square(double x, double half, double z)
{
  return { { x - half, -half, z }, { x + half, -half, z }, { x + half, half, z }, { x - half, half, z } };
}

class StructureSetTest : public FileTest
{
};

TEST_F(StructureSetTest, TheContoursOfAStructureAreReadWithTheirHoles)
{
  const Structure body{ "body", { Square(0, 90, 5) } };
  const Structure femur{ "Femur L",
                         { Square(1.5, 10, 5), Square(1.5, 4, 5), Square(0, 9, 8.25), Square(30, 2, 8.25) } };
  WriteStructures(Path("rs.dcm"), { body, femur, { "isocentre", { { { 0, 0, 0 } } }, "POINT " } }, "RTSTRUCT");
  const auto stack = ReadContours(Path("rs.dcm"), { "Femur L" });
  ASSERT_EQ(stack->GetSlices().size(), 2u);
  EXPECT_NEAR(stack->GetHeight(0), 5.0, 1e-9);
  EXPECT_NEAR(stack->GetHeight(1), 8.25, 1e-9);
  const auto & slice = stack->GetSlices()[0].contours;
  ASSERT_EQ(slice.size(), 2u);
  EXPECT_EQ(slice[0].points, Square(1.5, 10, 5));
  EXPECT_EQ(slice[0].region, Cortical);
  EXPECT_EQ(slice[1].region, Outside);
  EXPECT_EQ(stack->GetSlices()[1].contours.size(), 2u);
  // Named otherwise, it is told by its content.
  std::filesystem::rename(Path("rs.dcm"), Path("structures"));
  EXPECT_EQ(ReadContours(Path("structures"), { "Femur L" })->GetNumberOfContours(), 4u);
}

TEST_F(StructureSetTest, AKeyholeIsTakenApart)
{
  // Around the outside, in along (10, 0) .. (4, 0) by way of (7, 0), around the hole, and back.
  const std::vector<Vector3> walk = { { 10, 0, 1 }, { 10, 10, 1 }, { -10, 10, 1 }, { -10, -10, 1 }, { 10, -10, 1 },
                                      { 10, 0, 1 }, { 7, 0, 1 },   { 4, 0, 1 },    { 4, -4, 1 },    { -4, -4, 1 },
                                      { -4, 4, 1 }, { 4, 4, 1 },   { 4, 0, 1 },    { 7, 0, 1 } };
  WriteStructures(Path("rs.dcm"), { { "hip", { walk } } }, "RTSTRUCT");
  const auto stack = ReadContours(Path("rs.dcm"));
  ASSERT_EQ(stack->GetNumberOfContours(), 2u);
  double area = 0.0;
  for (const Contour & contour : stack->GetSlices()[0].contours)
  {
    std::vector<Vector2> polygon;
    for (const Vector3 & p : contour.points)
    {
      polygon.push_back(stack->ToPlane(p));
    }
    area += SignedArea(polygon);
    EXPECT_EQ(SignedArea(polygon) < 0.0, contour.region == Outside);
  }
  EXPECT_NEAR(area, 400.0 - 64.0, 1e-9);
}

TEST_F(StructureSetTest, SaysWhichStructuresThereAre)
{
  const Structure left{ "left", { Square(0, 9, 5) } };
  const Structure right{ "right", { Square(40, 9, 5) } };
  WriteStructures(Path("rs.dcm"), { left, right }, "RTSTRUCT");
  EXPECT_THAT(ErrorOf([&] { ReadContours(Path("rs.dcm")); }),
              testing::AllOf(HasSubstr("rs.dcm"), HasSubstr("several"), HasSubstr("'left', 'right'")));
  EXPECT_THAT(ErrorOf([&] { ReadContours(Path("rs.dcm"), { "middle" }); }), HasSubstr("'middle'"));
  EXPECT_EQ(ReadContours(Path("rs.dcm"), { "right" })->GetNumberOfContours(), 1u);
}

TEST_F(StructureSetTest, RefusesOtherDicomFiles)
{
  WriteStructures(Path("ct.dcm"), { { "a", { Square(0, 9, 5) } } }, "CT");
  EXPECT_THAT(ErrorOf([&] { ReadContours(Path("ct.dcm")); }), HasSubstr("modality 'CT'"));
  WriteStructures(Path("empty.dcm"), {}, "RTSTRUCT");
  EXPECT_THAT(ErrorOf([&] { ReadContours(Path("empty.dcm")); }), HasSubstr("no closed planar contours"));
  WriteText("text.dcm", "text");
  EXPECT_THAT(ErrorOf([&] { ReadContours(Path("text.dcm")); }), HasSubstr("text.dcm"));
}
} // namespace StructureSetTests
} // namespace bone
