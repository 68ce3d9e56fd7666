/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneContourImage.h"

#include "boneContourIO.h"
#include "boneTestFiles.h"

#include <itkImageRegionIteratorWithIndex.h>

#include <cmath>

namespace bone
{
namespace ContourImageTests
{
std::vector<Vector3>
Circle(const ContourStack * stack, double radius, double height, bool hole = false)
{
  std::vector<Vector3> points;
  for (int i = 0; i < 90; ++i)
  {
    const double t = (hole ? -1 : 1) * 2 * M_PI * i / 90;
    points.push_back(stack->FromPlane({ radius * std::cos(t), radius * std::sin(t) }, height));
  }
  return points;
}

// Three slices 2 mm apart, in a frame turned by 0.3 about z: a ring of cortex with trabecular bone; on the last with a
// hole.
ContourStack::Pointer
MakeStack()
{
  auto stack = ContourStack::New();
  stack->SetFrame({ std::cos(0.3), std::sin(0.3), 0 }, { -std::sin(0.3), std::cos(0.3), 0 });
  ContourStack::SliceContainer slices(3);
  for (int k = 0; k < 3; ++k)
  {
    slices[k].origin = Vector3(0, 0, 2.0 * k);
    Contour outer, inner;
    outer.points = Circle(stack, 12, 2.0 * k);
    inner.points = Circle(stack, 8, 2.0 * k, k == 2);
    inner.id = 1;
    inner.layer = k == 2 ? 0 : 1;
    inner.region = k == 2 ? Outside : Trabecular;
    slices[k].contours = { outer, inner };
  }
  stack->SetSlices(slices);
  return stack;
}

LabelImage::Pointer
MakeGrid(const LabelImage::DirectionType & direction, double zSpacing)
{
  auto grid = LabelImage::New();
  grid->SetRegions(LabelImage::RegionType({ { 3, -2, 1 } }, { { 60, 56, 12 } }));
  LabelImage::SpacingType spacing;
  spacing[0] = 0.5;
  spacing[1] = 0.6;
  spacing[2] = zSpacing;
  grid->SetSpacing(spacing);
  grid->SetDirection(direction);
  LabelImage::PointType           origin;
  itk::ContinuousIndex<double, 3> index;
  index[0] = 33;
  index[1] = 26;
  index[2] = 7;
  grid->TransformContinuousIndexToPhysicalPoint(index, origin);
  for (unsigned int a = 0; a < 3; ++a)
  {
    origin[a] = (a == 2 ? 2.0 : 0.0) - origin[a];
  }
  grid->SetOrigin(origin);
  grid->Allocate(true);
  return grid;
}

int
Expected(const LabelImage::PointType & p)
{
  const int k = static_cast<int>(std::floor((p[2] + 1.0) / 2.0));
  if (k < 0 || k > 2)
  {
    return 0;
  }
  const double r = std::hypot(p[0], p[1]);
  return r > 12 ? 0 : r > 8 ? Cortical : k == 2 ? Outside : Trabecular;
}

int
CountWrong(const LabelImage * image)
{
  int wrong = 0;
  for (itk::ImageRegionConstIteratorWithIndex<LabelImage> it(image, image->GetLargestPossibleRegion()); !it.IsAtEnd();
       ++it)
  {
    LabelImage::PointType p;
    image->TransformIndexToPhysicalPoint(it.GetIndex(), p);
    const double r = std::hypot(p[0], p[1]);
    const double between = std::abs(std::fmod(p[2] + 101.0, 2.0) - 1.0);
    // What lies on a border may go either way.
    const bool clear = std::abs(r - 12) > 0.02 && std::abs(r - 8) > 0.02 && between < 0.99;
    wrong += clear && it.Get() != Expected(p) ? 1 : 0;
  }
  return wrong;
}

TEST(ContourImage, VoxelsHaveTheRegionOfTheNearestSlice)
{
  LabelImage::DirectionType direction;
  direction.SetIdentity();
  EXPECT_EQ(CountWrong(RasterizeContours(MakeStack(), MakeGrid(direction, 0.7))), 0);
  // Sagittal order of the axes, one of them mirrored.
  direction.Fill(0.0);
  direction[0][1] = -1.0;
  direction[1][2] = 1.0;
  direction[2][0] = 1.0;
  EXPECT_EQ(CountWrong(RasterizeContours(MakeStack(), MakeGrid(direction, 0.9))), 0);
}

TEST(ContourImage, SlicesOfAnyDistanceLeaveNoVoxelOut)
{
  // Narrow gap, then a wide one: a disk on slices at 0, 1 and 7 mm.
  auto                         stack = ContourStack::New();
  ContourStack::SliceContainer slices(3);
  const double                 heights[] = { 0.0, 1.0, 7.0 };
  for (int k = 0; k < 3; ++k)
  {
    slices[k].origin = Vector3(0, 0, heights[k]);
    Contour outer;
    outer.points = Circle(stack, 12, heights[k]);
    slices[k].contours = { outer };
  }
  stack->SetSlices(slices);
  auto grid = LabelImage::New();
  grid->SetRegions(LabelImage::SizeType{ { 1, 1, 24 } }); // from z = -2 in steps of half a millimetre
  LabelImage::SpacingType spacing;
  spacing.Fill(0.5);
  grid->SetSpacing(spacing);
  LabelImage::PointType origin;
  origin.Fill(0.0);
  origin[2] = -2.0;
  grid->SetOrigin(origin);
  const auto labels = RasterizeContours(stack, grid);
  for (int k = 0; k < 24; ++k)
  {
    const double z = -2.0 + 0.5 * k;
    EXPECT_EQ(labels->GetPixel({ { 0, 0, k } }), z >= -0.5 && z <= 10.0 ? Cortical : Outside) << z;
  }
}

TEST(ContourImage, AnObliqueGridCutsAcrossSlices)
{
  LabelImage::DirectionType direction;
  direction.SetIdentity();
  direction[0][0] = direction[2][2] = std::cos(0.5);
  direction[0][2] = std::sin(0.5);
  direction[2][0] = -std::sin(0.5);
  EXPECT_EQ(CountWrong(RasterizeContours(MakeStack(), MakeGrid(direction, 0.7))), 0);
}

TEST(ContourImage, LabelsTraceToContoursThatGiveTheSameLabels)
{
  LabelImage::DirectionType direction;
  direction.SetIdentity();
  direction[0][0] = direction[1][1] = std::cos(0.2);
  direction[1][0] = std::sin(0.2);
  direction[0][1] = -std::sin(0.2);
  const auto labels = RasterizeContours(MakeStack(), MakeGrid(direction, 2.0));
  const auto traced = TraceLabels(labels, 0, 2);
  ASSERT_EQ(traced->GetSlices().size(), 3u);
  EXPECT_EQ(traced->GetSlices()[0].contours.size(), 1u);
  ASSERT_EQ(traced->GetSlices()[2].contours.size(), 2u); // with the hole
  EXPECT_EQ(traced->GetSlices()[2].contours[0].region == Outside, traced->GetSlices()[2].contours[1].region != Outside);
  traced->Verify();
  const auto again = RasterizeContours(traced, labels);
  for (itk::ImageRegionConstIteratorWithIndex<LabelImage> it(labels, labels->GetBufferedRegion()); !it.IsAtEnd(); ++it)
  {
    ASSERT_EQ(again->GetPixel(it.GetIndex()) != 0, it.Get() != 0) << it.GetIndex();
  }
  EXPECT_GT(TraceLabels(labels, Trabecular, 2)->GetNumberOfContours(), 0u);
  EXPECT_THROW(TraceLabels(labels, 9, 2), itk::ExceptionObject);
}

class ContourImageFileTest : public FileTest
{
};

TEST_F(ContourImageFileTest, ContoursAreReadFromALabelMap)
{
  LabelImage::DirectionType direction;
  direction.SetIdentity();
  bone::WriteImage(RasterizeContours(MakeStack(), MakeGrid(direction, 2.0)), Path("labels.nii.gz"));
  EXPECT_EQ(ReadContours(Path("labels.nii.gz"))->GetSlices().size(), 3u);
  EXPECT_THAT(ErrorOf([&] { ReadContours(Path("labels.nii.gz"), { "", 7, 2 }); }), testing::HasSubstr("is 7"));
}
} // namespace ContourImageTests
} // namespace bone
