/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "bonePlacementFilter.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <cmath>

namespace PlacementTests
{
using namespace bone;

/** The eight reflections of an oblique placement. */
std::vector<Placement>
Placements()
{
  std::vector<Placement> placements;
  const Eigen::Matrix3d  turn = Eigen::AngleAxisd(0.4, Vector3(1, 2, 3).normalized()).toRotationMatrix();
  for (int k = 0; k < 8; ++k)
  {
    const Vector3 signs(k & 1 ? -1 : 1, k & 2 ? -1 : 1, k & 4 ? -1 : 1);
    placements.push_back({ turn * signs.asDiagonal(), { 3.0, -20.0, 7.0 } });
  }
  return placements;
}

ContourStack::Pointer
MakeStack()
{
  ContourStack::SliceContainer slices;
  for (int k = 0; k < 3; ++k)
  {
    const double h = 2.0 * k;
    ContourSlice slice;
    slice.origin = { 0, 0, h };
    slice.contours.push_back(
      { { { 0, 0, h }, { 9, 0, h }, { 8, 5, h }, { 1, 4.0 + k, h } }, 0, 0, Region::Cortical, false, {} });
    slice.contours.push_back({ { { 2, 2, h }, { 6, 2, h } }, 1, 1, Region::Cortical, true, { 1.5, 1.0 } });
    slices.push_back(slice);
  }
  auto stack = ContourStack::New();
  stack->SetSlices(slices);
  stack->SetOpenStart(true);
  return stack;
}

TEST(Placement, InverseBringsBack)
{
  const Vector3 x(1.5, -2.0, 30.0);
  for (const Placement & placement : Placements())
  {
    EXPECT_LT((placement.Inverse()(placement(x)) - x).norm(), 1e-12);
    EXPECT_EQ(placement.Inverse().IsReflection(), placement.IsReflection());
  }
  EXPECT_EQ(Placement()(x), x);
}

TEST(Placement, ContoursAreInOrderAndRunRoundTheBoneWhateverThePlacement)
{
  const auto stack = MakeStack();
  for (const Placement & placement : Placements())
  {
    const auto placed = Place(*stack, placement);
    ASSERT_NO_THROW(placed->Verify());
    ASSERT_EQ(placed->GetSlices().size(), 3U);
    EXPECT_GT(placed->GetNormal().z(), 0.0);
    const bool turned = placement.direction(2, 2) < 0.0;
    EXPECT_EQ(placed->GetOpenStart(), !turned);
    EXPECT_EQ(placed->GetOpenEnd(), turned);
    for (std::size_t k = 0; k < 3; ++k)
    {
      const ContourSlice & given = stack->GetSlices()[turned ? 2 - k : k];
      const ContourSlice & slice = placed->GetSlices()[k];
      std::vector<Vector2> polygon;
      for (const Vector3 & p : slice.contours[0].points)
      {
        polygon.push_back(placed->ToPlane(p));
      }
      EXPECT_GT(SignedArea(polygon), 30.0);
      EXPECT_EQ(slice.contours[0].points[0], placement(given.contours[0].points[0]));
      EXPECT_EQ(slice.contours[1].points[1], placement(given.contours[1].points[1]));
      EXPECT_EQ(slice.contours[1].clearance, given.contours[1].clearance);
    }
  }
}

TEST(Placement, AnImagesGridLiesWhereItsVoxelsAre)
{
  auto                             image = itk::ImageBase<3>::New();
  itk::ImageBase<3>::RegionType    region;
  itk::ImageBase<3>::DirectionType direction;
  const double                     spacing[3] = { 0.5, 1.0, 2.0 };
  const Placement                  oblique = Placements()[5];
  for (unsigned int r = 0; r < 3; ++r)
  {
    for (unsigned int c = 0; c < 3; ++c)
    {
      direction[r][c] = oblique.direction(r, c);
    }
  }
  region.SetIndex({ { 4, -3, 2 } });
  region.SetSize({ { 5, 5, 5 } });
  image->SetRegions(region);
  image->SetSpacing(spacing);
  image->SetOrigin(oblique.origin.data());
  image->SetDirection(direction);
  itk::ImageBase<3>::PointType voxel;
  image->TransformIndexToPhysicalPoint({ { 6, 0, 3 } }, voxel);
  const Vector3 x = PlacementOf(*image)({ 2 * 0.5, 3 * 1.0, 1 * 2.0 });
  EXPECT_LT((x - Vector3(voxel[0], voxel[1], voxel[2])).norm(), 1e-12);
}

TEST(Placement, TheFilterRunsAgainWhereThePlacementChangesOnly)
{
  auto filter = PlacementFilter<ContourStack>::New();
  filter->SetInput(MakeStack());
  filter->Update();
  const auto time = filter->GetOutput()->GetUpdateMTime();
  filter->SetPlacement({});
  filter->Update();
  EXPECT_EQ(filter->GetOutput()->GetUpdateMTime(), time);
  filter->SetPlacement(Placements()[1]);
  filter->Update();
  EXPECT_GT(filter->GetOutput()->GetUpdateMTime(), time);
  EXPECT_EQ(filter->GetOutput()->GetSlices()[0].contours[0].points[0], Placements()[1].origin);
}
} // namespace PlacementTests
