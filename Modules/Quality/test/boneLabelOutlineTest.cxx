/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneLabelOutline.h"

#include <gtest/gtest.h>

#include <cmath>

using namespace bone;

namespace LabelOutlineTests
{
using Image = itk::Image<short, 3>;

/** Two blocks in an oblique image of 12 x 10 x 8 voxels: label 3 of 4 x 3 x 2 voxels, and label 5 at the image's end.
 */
Image::Pointer
Blocks()
{
  auto image = Image::New();
  image->SetRegions(Image::SizeType{ { 12, 10, 8 } });
  image->Allocate(true);
  const double         spacing[3] = { 0.5, 1.0, 4.0 }, origin[3] = { 10, -20, 30 };
  const double         c = std::cos(0.3), s = std::sin(0.3);
  Image::DirectionType direction;
  direction(0, 0) = c;
  direction(0, 1) = -s;
  direction(1, 0) = s;
  direction(1, 1) = c;
  direction(2, 2) = 1.0;
  image->SetSpacing(spacing);
  image->SetOrigin(origin);
  image->SetDirection(direction);
  for (int k = 0; k < 8; ++k)
  {
    for (int j = 0; j < 10; ++j)
    {
      for (int i = 0; i < 12; ++i)
      {
        const bool block = i >= 2 && i < 6 && j >= 3 && j < 6 && k >= 4 && k < 6;
        image->SetPixel({ { i, j, k } }, block ? 3 : k == 0 ? 5 : 0);
      }
    }
  }
  return image;
}

TEST(LabelOutline, HasTheFacesOfABlockAndTheVoxelsBesideThem)
{
  const auto         image = Blocks();
  const LabelOutline outline = FindOutline(*image, 3);
  EXPECT_NEAR(outline.spacing, std::cbrt(2.0), 1e-12);
  EXPECT_EQ(outline.faces.size(), 2u * (4 * 3 + 3 * 2 + 4 * 2));
  double  area = 0.0;
  Vector3 sum = Vector3::Zero(), moment = Vector3::Zero();
  for (const auto & face : outline.faces)
  {
    EXPECT_NEAR(face.outward.norm(), 1.0, 1e-12);
    area += face.area;
    sum += face.area * face.outward;
    moment += face.area * face.outward.dot(face.centre) * Vector3(1, 0, 0);
  }
  // A closed surface: its normals cancel, and the divergence theorem gives its volume.
  EXPECT_NEAR(area, 2.0 * (2.0 * 3.0 + 3.0 * 8.0 + 2.0 * 8.0), 1e-9);
  EXPECT_NEAR(sum.norm(), 0.0, 1e-9);
  EXPECT_NEAR(moment.x() / 3.0, 2.0 * 3.0 * 8.0, 1e-9);

  std::size_t inside = 0;
  for (const auto & voxel : outline.voxels)
  {
    const double     place[3] = { voxel.centre.x(), voxel.centre.y(), voxel.centre.z() };
    Image::IndexType index;
    ASSERT_TRUE(image->TransformPhysicalPointToIndex(Image::PointType(place), index));
    EXPECT_EQ(voxel.inside, image->GetPixel(index) == 3);
    inside += voxel.inside;
  }
  EXPECT_EQ(inside, 4u * 3 * 2);
  EXPECT_EQ(outline.voxels.size() - inside, outline.faces.size());
}

TEST(LabelOutline, IsOfAllLabelsButZeroAndNotWhereTheImageEnds)
{
  const auto image = Blocks();
  EXPECT_EQ(FindOutline(*image, 5).faces.size(), 12u * 10);
  EXPECT_EQ(FindOutline(*image, 0).faces.size(), FindOutline(*image, 3).faces.size() + 12u * 10);
  EXPECT_TRUE(FindOutline(*image, 9).faces.empty());
  EXPECT_TRUE(FindOutline(*image, 9).voxels.empty());
}
} // namespace LabelOutlineTests
