/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneOwnOrientation.h"

#include "boneBuildPlan.h"
#include "boneFemurPhantom.h"
#include "boneMeshValidator.h"
#include "bonePhantomImageSource.h"
#include "bonePlacement.h"

#include <itkImageRegionIteratorWithIndex.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

namespace OwnOrientationTests
{
using namespace bone;

/** Whether bit d of k is set. */
std::array<bool, 3>
Axes(unsigned int k)
{
  return { { (k & 1U) != 0, (k & 2U) != 0, (k & 4U) != 0 } };
}

/** The image with its voxels in the other order along some axes, and the same header: its mirror image. */
template <typename TImage>
typename TImage::Pointer
Mirrored(const TImage * image, const std::array<bool, 3> & axes)
{
  auto mirrored = TImage::New();
  mirrored->CopyInformation(image);
  mirrored->SetMetaDataDictionary(image->GetMetaDataDictionary());
  mirrored->SetRegions(image->GetLargestPossibleRegion());
  mirrored->Allocate();
  const auto size = image->GetLargestPossibleRegion().GetSize();
  for (itk::ImageRegionIteratorWithIndex<TImage> it(mirrored, mirrored->GetLargestPossibleRegion()); !it.IsAtEnd();
       ++it)
  {
    auto index = it.GetIndex();
    for (unsigned int d = 0; d < 3; ++d)
    {
      index[d] = axes[d] ? static_cast<itk::IndexValueType>(size[d]) - 1 - index[d] : index[d];
    }
    it.Set(image->GetPixel(index));
  }
  return mirrored;
}

template <typename TImage>
std::vector<typename TImage::PixelType>
Voxels(const TImage * image)
{
  const auto * first = image->GetBufferPointer();
  return { first, first + image->GetLargestPossibleRegion().GetNumberOfPixels() };
}

/** A box, the same from all sides where `corner` is false; the CT in it is noise. */
struct Box
{
  CTImage::Pointer    ct{ CTImage::New() };
  LabelImage::Pointer mask{ LabelImage::New() };

  explicit Box(bool corner)
  {
    const CTImage::SizeType size = { { 8, 9, 10 } };
    ct->SetRegions(size);
    mask->SetRegions(size);
    ct->Allocate();
    mask->Allocate(true);
    std::mt19937 random(7);
    for (itk::ImageRegionIteratorWithIndex<CTImage> it(ct, ct->GetLargestPossibleRegion()); !it.IsAtEnd(); ++it)
    {
      const auto index = it.GetIndex();
      it.Set(static_cast<float>(random() % 1000));
      bool inside = true;
      for (unsigned int d = 0; d < 3; ++d)
      {
        inside = inside && index[d] >= 2 && index[d] < static_cast<int>(size[d]) - 2;
      }
      const bool in = inside || (corner && index[0] == 6 && index[1] == 7 && index[2] == 8);
      mask->SetPixel(index, in ? 1 : 0);
    }
  }
};

struct Built
{
  DensityHierarchy<>::ConstPointer hierarchy;
  ContourStack::ConstPointer       contours;
  std::vector<std::string>         warnings;
};

Built
Build(const CTImage * ct, const LabelImage * labels)
{
  BuildParameters parameters;
  parameters.plan.sliceStep = 12.0;
  parameters.plan.contourSpacing = 14.0;
  parameters.plan.levels = { 0.7 };
  parameters.fit.degree = 1;
  BuildPipeline pipeline(2);
  PlanBuild(CropToBone(ct, labels, nullptr, parameters.plan), parameters, pipeline);
  FinishBuild(parameters.plan, nullptr, pipeline);
  return { pipeline.GetHierarchy(), pipeline.GetContours(), pipeline.GetWarnings() };
}

Vector3
Mirror(Vector3 x, const itk::ImageBase<3> & grid, const std::array<bool, 3> & axes)
{
  const auto         last = grid.GetLargestPossibleRegion().GetUpperIndex();
  CTImage::PointType end;
  grid.TransformIndexToPhysicalPoint(last, end);
  for (unsigned int d = 0; d < 3; ++d)
  {
    x[d] = axes[d] ? grid.GetOrigin()[d] + end[d] - x[d] : x[d];
  }
  return x;
}

TEST(OwnOrientation, IsTheSameForAllOrdersOfVoxels)
{
  const Box  box(true);
  const auto own = FindFlips(box.ct, box.mask);
  for (unsigned int k = 1; k < 8; ++k)
  {
    const auto ct = Mirrored<CTImage>(box.ct, Axes(k));
    const auto mask = Mirrored<LabelImage>(box.mask, Axes(k));
    const auto flips = FindFlips(ct, mask);
    for (unsigned int d = 0; d < 3; ++d)
    {
      EXPECT_EQ(flips[d], own[d] != Axes(k)[d]);
    }
    EXPECT_EQ(Voxels<CTImage>(Flip(ct, flips)), Voxels<CTImage>(Flip(box.ct, own)));
    EXPECT_EQ(Voxels<LabelImage>(Flip(mask, flips)), Voxels<LabelImage>(Flip(box.mask, own)));
  }
}

TEST(OwnOrientation, TheTailIsAtTheEnd)
{
  const Box box(true);
  EXPECT_EQ(FindFlips(box.ct, box.mask), Axes(0));
  EXPECT_EQ(FindFlips(Mirrored<CTImage>(box.ct, Axes(5)), Mirrored<LabelImage>(box.mask, Axes(5))), Axes(5));
}

TEST(OwnOrientation, TheCTDecidesWhereTheMaskIsSymmetric)
{
  const Box  box(false);
  const auto own = FindFlips(box.ct, box.mask);
  for (unsigned int k = 1; k < 8; ++k)
  {
    const auto flips = FindFlips(Mirrored<CTImage>(box.ct, Axes(k)), box.mask);
    for (unsigned int d = 0; d < 3; ++d)
    {
      EXPECT_EQ(flips[d], own[d] != Axes(k)[d]);
    }
  }
  box.ct->FillBuffer(100.0F);
  EXPECT_EQ(FindFlips(box.ct, box.mask), Axes(0));
}

TEST(OwnOrientation, FlippedVoxelsStayWhereTheyAre)
{
  const Box box(true);
  box.ct->SetOrigin(CTImage::PointType(3.5));
  const auto               flipped = Flip(box.ct, Axes(5));
  const CTImage::IndexType here = { { 1, 2, 3 } }, there = { { 6, 2, 6 } };
  CTImage::PointType       a, b;
  box.ct->TransformIndexToPhysicalPoint(here, a);
  flipped->TransformIndexToPhysicalPoint(there, b);
  EXPECT_EQ(a, b);
  EXPECT_EQ(box.ct->GetPixel(here), flipped->GetPixel(there));
  EXPECT_EQ(Flip(box.ct, Axes(0)), box.ct);
}

TEST(OwnOrientation, TheOwnGridSharesVoxelsThatASourceMakes)
{
  auto                 source = PhantomImageSource<CTImage>::New();
  CTImage::SpacingType spacing(8.0);
  source->SetModel(std::make_shared<const FemurPhantom>());
  source->SetSpacing(spacing);
  const auto own = OnOwnGrid(source->GetOutput());
  EXPECT_EQ(own->GetBufferPointer(), source->GetOutput()->GetBufferPointer());
  EXPECT_GT(own->GetLargestPossibleRegion().GetNumberOfPixels(), 100U);
  EXPECT_EQ(own->GetOrigin(), CTImage::PointType(0.0));
  EXPECT_EQ(own->GetSpacing(), spacing);
  EXPECT_NE(source->GetOutput()->GetOrigin(), own->GetOrigin());
  EXPECT_EQ(OnOwnGrid(static_cast<const LabelImage *>(nullptr)), nullptr);
}

TEST(OwnOrientation, AMirroredBoneGivesTheMirroredModel)
{
  using Source = PhantomImageSource<CTImage>;
  auto                source = Source::New();
  Source::SpacingType spacing;
  spacing.Fill(2.0);
  source->SetModel(std::make_shared<const FemurPhantom>());
  source->SetSpacing(spacing);
  source->SetNoise(20.0);
  source->Update();
  const Built first = Build(source->GetOutput(), source->GetLabelOutput());
  for (const unsigned int k : { 1U, 6U })
  {
    const auto  axes = Axes(k);
    const Built built =
      Build(Mirrored<CTImage>(source->GetOutput(), axes), Mirrored<LabelImage>(source->GetLabelOutput(), axes));
    for (std::size_t level = 0; level < 2; ++level)
    {
      const MeshArrays a = first.hierarchy->GetMesh(level)->GetArrays();
      const MeshArrays b = built.hierarchy->GetMesh(level)->GetArrays();
      ASSERT_EQ(a.points.size(), b.points.size());
      ASSERT_EQ(a.tetrahedra.size(), b.tetrahedra.size());
      for (std::size_t p = 0; p < a.points.size(); ++p)
      {
        ASSERT_LT((Mirror(a.points[p], *source->GetOutput(), axes) - b.points[p]).norm(), 1e-9);
      }
      EXPECT_TRUE(ValidateMesh(b).IsValid());
    }
    ASSERT_NO_THROW(built.contours->Verify());
    ASSERT_EQ(built.contours->GetSlices().size(), first.contours->GetSlices().size());
    EXPECT_GT(built.contours->GetNormal().z(), 0.0);
    // The phantom is cut below: what a person is told is of the CT's space.
    const std::string end = axes[2] ? "last" : "first";
    EXPECT_THAT(built.warnings, testing::Contains(testing::HasSubstr("at its " + end + " slice")));
  }
}
} // namespace OwnOrientationTests
