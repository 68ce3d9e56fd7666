/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneBuildPlan.h"
#include "boneBuildReport.h"
#include "boneLabelCrop.h"
#include "boneFemurPhantom.h"
#include "boneLabelValue.h"
#include "boneMeshImageMetrics.h"
#include "bonePhantomImageSource.h"
#include "boneResolution.h"
#include "boneVoxelFaces.h"

#include <Eigen/Geometry>

#include <itkImageRegionIteratorWithIndex.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <random>
#include <vector>

namespace PipelinePartsTests
{
/** Label 3 in the voxels [4, 10) x [5, 9) x [6, 12) of a grid of 0.5 x 1 x 2 mm. */
bone::LabelImage::Pointer
MakeBox()
{
  auto                          labels = bone::LabelImage::New();
  bone::LabelImage::SizeType    size = { { 16, 14, 18 } };
  bone::LabelImage::SpacingType spacing;
  spacing[0] = 0.5;
  spacing[1] = 1.0;
  spacing[2] = 2.0;
  labels->SetRegions(size);
  labels->SetSpacing(spacing);
  labels->Allocate(true);
  for (int z = 6; z < 12; ++z)
  {
    for (int y = 5; y < 9; ++y)
    {
      for (int x = 4; x < 10; ++x)
      {
        labels->SetPixel({ { x, y, z } }, 3);
      }
    }
  }
  return labels;
}

/** The box that the labels of MakeBox fill, moved along x, as six tetrahedra. */
bone::MeshArrays
MakeBoxMesh(double shift)
{
  const bone::Vector3 lower(1.75 + shift, 4.5, 11.0);
  const bone::Vector3 size(3.0, 4.0, 12.0);
  bone::MeshArrays    mesh;
  for (int corner = 0; corner < 8; ++corner)
  {
    mesh.points.push_back(
      lower + bone::Vector3(corner & 1 ? size.x() : 0.0, corner & 2 ? size.y() : 0.0, corner & 4 ? size.z() : 0.0));
  }
  mesh.tetrahedra = { { { 0, 1, 3, 7 } }, { { 0, 3, 2, 7 } }, { { 0, 2, 6, 7 } },
                      { { 0, 6, 4, 7 } }, { { 0, 4, 5, 7 } }, { { 0, 5, 1, 7 } } };
  mesh.neighbors = bone::ComputeFaceNeighbors(mesh.tetrahedra);
  return mesh;
}

TEST(BoneImage, MeasuresABox)
{
  const auto             labels = MakeBox();
  const bone::BoneExtent extent = bone::MeasureLabel(labels, 3);
  EXPECT_EQ(extent.voxels, 6U * 4U * 6U);
  EXPECT_DOUBLE_EQ(extent.volume, 3.0 * 4.0 * 12.0);
  EXPECT_NEAR(extent.surface, 2.0 / 3.0 * 2.0 * (3.0 * 4.0 + 4.0 * 12.0 + 3.0 * 12.0), 1e-9);
  EXPECT_FALSE(extent.leavesImage);
  EXPECT_EQ(extent.region.GetIndex(2), 6);
  EXPECT_EQ(extent.region.GetSize(2), 6U);
  EXPECT_EQ(bone::MeasureLabel(labels, 0).voxels, extent.voxels);
  EXPECT_THROW(bone::MeasureLabel(labels, 2), itk::ExceptionObject);
}

TEST(BoneImage, CroppedImageStaysInPlace)
{
  const auto                        labels = MakeBox();
  const auto                        region = bone::MeasureLabel(labels, 3).region;
  const auto                        cropped = bone::Crop(labels, region);
  bone::LabelImage::PointType       before;
  bone::LabelImage::PointType       after;
  const bone::LabelImage::IndexType first = cropped->GetLargestPossibleRegion().GetIndex();
  labels->TransformIndexToPhysicalPoint(region.GetIndex(), before);
  cropped->TransformIndexToPhysicalPoint(first, after);
  EXPECT_LT(before.EuclideanDistanceTo(after), 1e-12);
  EXPECT_EQ(cropped->GetPixel(first), 3);
}

TEST(BuildViews, HoldABoneThatIsLongAlongTheBeam)
{
  for (const bone::Vector3 & size :
       { bone::Vector3(600, 30, 30), bone::Vector3(30, 600, 30), bone::Vector3(30, 30, 600) })
  {
    bone::MeshArrays box = MakeBoxMesh(0.0);
    for (bone::Vector3 & point : box.points)
    {
      point = (point - box.points.front()).cwiseProduct(size) / 3.0;
    }
    auto mesh = bone::BuildPipeline::MeshType::New();
    mesh->SetArrays(std::move(box));
    for (const auto & geometry : { bone::FrontView(mesh), bone::LateralView(mesh) })
    {
      for (const bone::Vector3 & point : mesh->GetArrays().points)
      {
        const bone::Vector2 pixel = geometry->ProjectPoint(point);
        EXPECT_GT(pixel.minCoeff(), -0.5);
        EXPECT_LT(pixel.x(), geometry->GetView().size[0] - 0.5);
        EXPECT_LT(pixel.y(), geometry->GetView().size[1] - 0.5);
      }
    }
  }
}

bone::CTImage::Pointer
MakeCTOfBox()
{
  auto ct = bone::CTImage::New();
  ct->SetRegions(MakeBox()->GetLargestPossibleRegion());
  ct->CopyInformation(MakeBox());
  ct->Allocate(true);
  return ct;
}

TEST(LabelCrop, AGridIsTheSameWithinAHundredthOfTheSmallestEdge)
{
  const auto ct = MakeCTOfBox();
  const auto labels = MakeBox();
  auto       origin = labels->GetOrigin();
  for (const double shift : { 0.0, 0.004, -0.0049 })
  {
    origin[2] = shift;
    labels->SetOrigin(origin);
    ASSERT_TRUE(bone::IsSameGrid(ct, labels));
    const auto put = bone::PutOnGrid(labels, ct);
    EXPECT_EQ(put->GetOrigin(), ct->GetOrigin());
    EXPECT_EQ(put->GetPixel({ { 4, 5, 6 } }), 3);
    EXPECT_EQ(labels->GetOrigin()[2], shift); // is left as it was
  }
  origin[2] = 0.0051;
  labels->SetOrigin(origin);
  EXPECT_FALSE(bone::IsSameGrid(ct, labels));
  EXPECT_THROW(bone::PutOnGrid(labels, ct), itk::ExceptionObject);
  const auto spaced = MakeBox();
  auto       spacing = spaced->GetSpacing();
  spacing[2] = 2.001; // 0.017 mm at the last of 18 slices
  spaced->SetSpacing(spacing);
  EXPECT_FALSE(bone::IsSameGrid(ct, spaced));
  auto small = bone::CTImage::New();
  small->SetRegions(bone::CTImage::SizeType{ { 16, 14, 17 } });
  small->CopyInformation(labels);
  EXPECT_FALSE(bone::IsSameGrid(small, MakeBox()));
  EXPECT_THROW(bone::PutOnGrid(MakeBox(), small), itk::ExceptionObject);
}

TEST(LabelCrop, ResamplingTakesTheNearestLabelAndKeepsTheStatement)
{
  const auto labels = MakeBox();
  bone::StateOneBone(*labels);
  // Each of its voxels is a third of one of the labels' along x; the first lies a third before the labels' first.
  auto ct = bone::CTImage::New();
  ct->CopyInformation(labels);
  auto spacing = labels->GetSpacing();
  spacing[0] /= 3.0;
  auto origin = labels->GetOrigin();
  origin[0] -= spacing[0];
  ct->SetSpacing(spacing);
  ct->SetOrigin(origin);
  ct->SetRegions(bone::CTImage::SizeType{ { 48, 14, 18 } });
  const auto fine = bone::ResampleToGrid(labels, ct);
  EXPECT_TRUE(bone::StatesOneBone(*fine));
  for (long x = 0; x < 48; ++x)
  {
    ASSERT_EQ(fine->GetPixel({ { x, 6, 7 } }), labels->GetPixel({ { x / 3, 6, 7 } })) << x;
  }
  origin[0] -= 0.55 * spacing[0]; // beyond the labels' edge
  ct->SetOrigin(origin);
  EXPECT_THROW(bone::ResampleToGrid(labels, ct), itk::ExceptionObject);
}

TEST(LabelCrop, BonesAreNotJoinedWithoutBeingToldTo)
{
  const auto labels = MakeBox();
  EXPECT_NO_THROW(bone::VerifyOneBone(labels, 0)); // its only one
  labels->SetPixel({ { 0, 0, 0 } }, 7);
  const auto counts = bone::CountLabels(labels);
  ASSERT_EQ(counts.size(), 2U);
  EXPECT_EQ(counts[0].value, 3);
  EXPECT_EQ(counts[0].voxels, 144U);
  EXPECT_DOUBLE_EQ(counts[0].volume, 144.0);
  EXPECT_EQ(counts[1].value, 7);
  EXPECT_EQ(counts[1].voxels, 1U);
  EXPECT_NO_THROW(bone::VerifyOneBone(labels, 3));
  try
  {
    bone::VerifyOneBone(labels, 0);
    FAIL() << "two bones were taken for one";
  }
  catch (const itk::ExceptionObject & error)
  {
    EXPECT_NE(std::string(error.GetDescription()).find("3 (144 voxels, 0.1 cm^3), 7 (1 voxels"), std::string::npos)
      << error.GetDescription();
  }
  bone::StateOneBone(*labels);
  EXPECT_NO_THROW(bone::VerifyOneBone(labels, 0));
  EXPECT_TRUE(bone::StatesOneBone(*bone::Crop(labels, bone::MeasureLabel(labels, 3).region)));
}

TEST(LabelCrop, ABoneReadByRegionsIsThatOfTheWholeImages)
{
  // Of several slabs, with bones across them and at the border, on an oblique grid.
  auto labels = bone::LabelImage::New();
  labels->SetRegions(bone::LabelImage::SizeType{ { 200, 180, 260 } });
  labels->Allocate(true);
  auto ct = bone::CTImage::New();
  ct->SetRegions(labels->GetLargestPossibleRegion());
  ct->Allocate(true);
  bone::CTImage::DirectionType direction;
  const double                 c = std::cos(0.4), s = std::sin(0.4);
  const double                 rotation[3][3] = { { c, 0, s }, { 0, -1, 0 }, { -s, 0, c } };
  for (unsigned int i = 0; i < 9; ++i)
  {
    direction(i / 3, i % 3) = rotation[i / 3][i % 3];
  }
  labels->SetDirection(direction);
  ct->SetDirection(direction);
  const auto fill = [&](int label, const bone::CTImage::RegionType & region) {
    for (itk::ImageRegionIteratorWithIndex<bone::LabelImage> it(labels, region); !it.IsAtEnd(); ++it)
    {
      const auto & at = it.GetIndex();
      it.Set(static_cast<short>((at[0] + at[1] + at[2]) % 5 == 0 ? 0 : label));
      ct->SetPixel(at, static_cast<float>(at[0] - 3 * at[1] + 7 * at[2]));
    }
  };
  fill(4, { { { 20, 30, 90 } }, { { 40, 50, 60 } } });
  fill(-9, { { { 190, 0, 250 } }, { { 10, 9, 10 } } });
  fill(300, { { { 62, 30, 100 } }, { { 20, 20, 20 } } }); // in the margin of another
  std::string folder = (std::filesystem::temp_directory_path() / "bone-crop-test-XXXXXX").string();
  ASSERT_NE(mkdtemp(folder.data()), nullptr);
  bone::WriteImage(ct, folder + "/ct.nii");
  bone::WriteImage(labels, folder + "/labels.nii.gz");
  const auto                wholeCT = bone::ReadCT(folder + "/ct.nii");
  const auto                whole = bone::ReadLabelFile(folder + "/labels.nii.gz");
  const auto                source = bone::OpenCT(folder + "/ct.nii");
  const auto                opened = bone::OpenLabelFile(folder + "/labels.nii.gz");
  bone::BuildPlanParameters plan;
  for (const char * label : { "4", "-9", "300" })
  {
    SCOPED_TRACE(label);
    const auto bone = bone::ChooseBones(opened, { label }).front();
    plan.label = std::stoi(label);
    const auto extent = bone::MeasureLabel(whole.layers.front(), plan.label);
    EXPECT_EQ(bone.region, extent.region);
    for (const bone::LabelCount & count : bone::CountLabels(opened.layers.front()))
    {
      EXPECT_TRUE(count.value != plan.label || count.voxels == extent.voxels) << count.voxels;
    }
    const auto expected = bone::CropToBone(wholeCT, whole.layers.front(), nullptr, plan);
    const auto input = bone::CropToBone(source->GetOutput(), bone, nullptr, plan);
    EXPECT_LT(source->GetOutput()->GetBufferedRegion().GetNumberOfPixels(), 1000000u);
    EXPECT_EQ(input.surface, expected.surface);
    for (const auto & [a, b] : { std::pair<itk::ImageBase<3> *, itk::ImageBase<3> *>{ input.ct, expected.ct },
                                 { input.labels, expected.labels } })
    {
      EXPECT_EQ(a->GetLargestPossibleRegion(), b->GetLargestPossibleRegion());
      EXPECT_EQ(a->GetOrigin(), b->GetOrigin());
      EXPECT_EQ(a->GetDirection(), b->GetDirection());
    }
    const std::size_t n = input.ct->GetLargestPossibleRegion().GetNumberOfPixels();
    EXPECT_TRUE(
      std::equal(input.ct->GetBufferPointer(), input.ct->GetBufferPointer() + n, expected.ct->GetBufferPointer()));
    EXPECT_TRUE(std::equal(
      input.labels->GetBufferPointer(), input.labels->GetBufferPointer() + n, expected.labels->GetBufferPointer()));
    const short * const voxels = input.labels->GetBufferPointer();
    EXPECT_EQ(std::count(voxels, voxels + n, plan.label), static_cast<std::ptrdiff_t>(extent.voxels));
    EXPECT_EQ(std::count(voxels, voxels + n, 0), static_cast<std::ptrdiff_t>(n - extent.voxels)); // no other label
  }
  std::filesystem::remove_all(folder);
}

TEST(Doubts, TellWhereABuildIsNotWhatWasAskedFor)
{
  bone::BuildPlanParameters plan;
  plan.tetrahedra = 1000;
  plan.levels = { 200 };
  std::vector<bone::LevelReport> levels(2);
  levels[0].tetrahedra = 1080;
  levels[0].dice = 0.91;
  levels[1].tetrahedra = 200;
  EXPECT_TRUE(bone::FindDoubts(plan, levels).empty());
  levels[0].dice = 0.89;
  EXPECT_EQ(bone::FindDoubts(plan, levels).size(), 1U);
  levels[1].tetrahedra = 230;
  EXPECT_EQ(bone::FindDoubts(plan, levels).size(), 2U);
  levels[0].tetrahedra = 1200;
  EXPECT_EQ(bone::FindDoubts(plan, levels).size(), 3U);
  plan.sliceStep = plan.contourSpacing = 2.0; // then the number is not sought
  EXPECT_EQ(bone::FindDoubts(plan, levels).size(), 2U);
}

TEST(MeshImageMetrics, MeshOnTheLabelsFacesIsAtDistanceZero)
{
  const auto distances = bone::SurfaceDistanceMeter(bone::MaskOfLabel(MakeBox(), 3)).Measure(MakeBoxMesh(0.0));
  EXPECT_NEAR(distances.meshToMask.maximum, 0.0, 1e-9);
  EXPECT_NEAR(distances.maskToMesh.maximum, 0.0, 1e-9);
}

TEST(MeshImageMetrics, MovedMeshIsAtTheDistanceItWasMoved)
{
  const auto distances = bone::SurfaceDistanceMeter(bone::MaskOfLabel(MakeBox(), 3)).Measure(MakeBoxMesh(0.4));
  EXPECT_NEAR(distances.meshToMask.maximum, 0.4, 1e-9);
  EXPECT_NEAR(distances.maskToMesh.maximum, 0.4, 1e-9);
  EXPECT_LT(distances.meshToMask.mean, 0.4);
  EXPECT_GT(distances.meshToMask.mean, 0.05);
}

TEST(MeshImageMetrics, DistanceToVoxelFacesIsThatToTheNearestOfThem)
{
  // Noise in an oblique image of long voxels, to its border; the faces are looked at one by one.
  auto                            mask = bone::LabelImage::New();
  const double                    spacing[3] = { 0.5, 0.8, 2.0 }, origin[3] = { -3.0, 20.0, 7.0 };
  bone::LabelImage::DirectionType direction;
  const Eigen::Matrix3d           turn = Eigen::AngleAxisd(0.7, bone::Vector3(1, 2, 3).normalized()).toRotationMatrix();
  for (unsigned int k = 0; k < 9; ++k)
  {
    direction[k / 3][k % 3] = turn(k / 3, k % 3);
  }
  mask->SetRegions(bone::LabelImage::SizeType{ { 6, 5, 4 } });
  mask->SetSpacing(spacing);
  mask->SetOrigin(origin);
  mask->SetDirection(direction);
  mask->Allocate(true);
  EXPECT_EQ(bone::VoxelFaces(mask).Distance({ 1, 2, 3 }), std::numeric_limits<double>::infinity());
  std::mt19937 random(3);
  for (itk::ImageRegionIteratorWithIndex<bone::LabelImage> it(mask, mask->GetLargestPossibleRegion()); !it.IsAtEnd();
       ++it)
  {
    it.Set(random() % 3 == 0 ? 2 : 0);
  }
  const bone::VoxelFaces faces(mask);
  const auto             inside = [&](itk::Index<3> i) {
    return mask->GetLargestPossibleRegion().IsInside(i) && mask->GetPixel(i) != 0;
  };
  for (int n = 0; n < 300; ++n)
  {
    bone::Vector3 q;
    for (int d = 0; d < 3; ++d)
    {
      q[d] = (static_cast<double>(random() % 1000) / 500.0 - 0.5) * 6.0 * spacing[d];
    }
    double      least = std::numeric_limits<double>::infinity();
    std::size_t count = 0;
    for (int cell = 0; cell < 7 * 6 * 5; ++cell)
    {
      const itk::Index<3> i = { { cell % 7 - 1, cell / 7 % 6 - 1, cell / 42 - 1 } };
      for (unsigned int d = 0; d < 3; ++d)
      {
        itk::Index<3> next = i;
        ++next[d];
        if (inside(i) == inside(next))
        {
          continue;
        }
        ++count;
        bone::Vector3 off;
        for (unsigned int e = 0; e < 3; ++e)
        {
          const double from = std::abs(q[e] - (static_cast<double>(i[e]) + (e == d ? 0.5 : 0.0)) * spacing[e]);
          off[e] = e == d ? from : std::max(0.0, from - 0.5 * spacing[e]);
        }
        least = std::min(least, off.norm());
      }
    }
    const bone::Vector3 x = turn * q + bone::Vector3(origin[0], origin[1], origin[2]);
    EXPECT_NEAR(faces.Distance(x), least, 1e-9);
    EXPECT_EQ(faces.GetCentres().size(), count);
    EXPECT_NEAR(faces.Distance(faces.GetCentres()[static_cast<std::size_t>(n) % count]), 0.0, 1e-9);
  }
}

TEST(MeshImageMetrics, OverlapIsThatOfVoxelCentres)
{
  const auto mask = MakeBox();
  for (const auto & [shift, common] : { std::pair<double, double>{ 0.0, 6.0 }, { 0.4, 5.0 }, { 1.6, 3.0 } })
  {
    SCOPED_TRACE(shift);
    bone::MeshArrays mesh = MakeBoxMesh(shift);
    mesh.degree.assign(mesh.tetrahedra.size(), 0);
    mesh.coefficients.assign(mesh.tetrahedra.size(), 1.0);
    mesh.maximumDegree = 0;
    EXPECT_DOUBLE_EQ(bone::DiceOverlap(mesh, mask), common / 6.0);
    const auto        inside = bone::MaskOfMesh(mesh, mask);
    const std::size_t count = mask->GetLargestPossibleRegion().GetNumberOfPixels();
    const auto *const a = inside->GetBufferPointer(), *const b = mask->GetBufferPointer();
    EXPECT_EQ(std::count(a, a + count, 1), 6 * 4 * 6);
    std::ptrdiff_t both = 0;
    for (std::size_t k = 0; k < count; ++k)
    {
      both += a[k] == 1 && b[k] != 0 ? 1 : 0;
    }
    EXPECT_EQ(both, static_cast<std::ptrdiff_t>(common * 4 * 6));
  }
}

TEST(MeshImageMetrics, PercentilesLookAtTheMask)
{
  const auto mask = bone::MaskOfLabel(MakeBox(), 3);
  auto       model = bone::CTImage::New();
  model->CopyInformation(mask);
  model->SetRegions(mask->GetLargestPossibleRegion());
  model->Allocate();
  const std::size_t count = mask->GetLargestPossibleRegion().GetNumberOfPixels();
  std::size_t       inside = 0;
  for (std::size_t k = 0; k < count; ++k)
  {
    model->GetBufferPointer()[k] = mask->GetBufferPointer()[k] != 0 ? static_cast<float>(inside++) : std::nanf("");
  }
  const auto percentiles = bone::PercentileRange(model, mask);
  EXPECT_NEAR(percentiles[0], 0.01 * static_cast<double>(inside), 1.0);
  EXPECT_NEAR(percentiles[1], 0.99 * static_cast<double>(inside), 1.0);
}

TEST(Resolution, PredictionCountsSurfacesOnceAndNeedlesLess)
{
  // Two equilateral tetrahedra, face to face: six triangles of the boundary, and the interface where the regions
  // differ.
  bone::MeshArrays mesh;
  const double     height = std::sqrt(2.0 / 3.0), middle = std::sqrt(3.0) / 6.0;
  mesh.points = {
    { 0, 0, 0 }, { 1, 0, 0 }, { 0.5, std::sqrt(0.75), 0 }, { 0.5, middle, height }, { 0.5, middle, -height }
  };
  mesh.tetrahedra = { { { 0, 1, 2, 3 } }, { { 1, 0, 2, 4 } } };
  mesh.neighbors = bone::ComputeFaceNeighbors(mesh.tetrahedra);
  mesh.region = { 1, 1 };
  EXPECT_EQ(bone::PredictQuality(mesh), std::lround(6 * 1.78));
  mesh.region = { 1, 2 };
  EXPECT_EQ(bone::PredictQuality(mesh), std::lround(6 * 1.78 + 2.41));
  for (bone::Vector3 & p : mesh.points)
  {
    p.z() *= 50.0;
  }
  EXPECT_LT(bone::PredictQuality(mesh), std::lround(0.5 * 6 * 1.78 + 2.41));
}

TEST(Resolution, PredictionHoldsForAPhantomAtTwoResolutions)
{
  const auto source = bone::PhantomImageSource<bone::CTImage>::New();
  source->SetModel(std::make_shared<const bone::FemurPhantom>());
  source->SetSpacing(bone::CTImage::SpacingType(1.5));
  source->Update();
  for (const double spacing : { 6.0, 9.0 })
  {
    bone::BuildParameters parameters;
    parameters.plan.sliceStep = 0.6 * spacing;
    parameters.plan.contourSpacing = spacing;
    bone::BuildPipeline pipeline(1);
    bone::PlanBuild(
      bone::CropToBone(source->GetOutput(), source->GetLabelOutput(), nullptr, parameters.plan), parameters, pipeline);
    const auto predicted = static_cast<double>(bone::PredictQuality(pipeline.GetTiling()->GetOutput()->GetArrays()));
    const auto made = static_cast<double>(pipeline.GetQuality()->GetOutput()->GetNumberOfTetrahedra());
    EXPECT_NEAR(predicted / made, 1.0, 0.15) << predicted << " and " << made;
  }
}

TEST(Resolution, PointsStayATenthOfTheSlicesApartWhereABoneCannotHaveTheNumberAskedFor)
{
  const auto                labels = MakeBox();
  const auto                ct = bone::CTImage::New();
  bone::BuildParameters     parameters;
  std::vector<bone::IdType> counts;
  double                    least = 1.0;
  ct->CopyInformation(labels);
  ct->SetRegions(labels->GetLargestPossibleRegion());
  ct->Allocate();
  for (itk::ImageRegionIteratorWithIndex<bone::CTImage> it(ct, ct->GetLargestPossibleRegion()); !it.IsAtEnd(); ++it)
  {
    it.Set(labels->GetPixel(it.GetIndex()) == 3 ? 900.0F : 40.0F);
  }
  parameters.plan.tetrahedra = 4000;
  bone::BuildPipeline pipeline(2);
  const auto          resolution = bone::PlanBuild(bone::CropToBone(ct, labels, nullptr, parameters.plan),
                                          parameters,
                                          pipeline,
                                          [&](const bone::Resolution & tried, bone::IdType count) {
                                            counts.push_back(count);
                                            least = std::min(least, tried.contourSpacing / tried.sliceStep);
                                          });
  EXPECT_GE(least, 0.1 - 1e-9);
  EXPECT_LE(counts.size(), 8U);
  EXPECT_GE(resolution.contourSpacing, 0.1 * resolution.sliceStep - 1e-9);
  EXPECT_LT(pipeline.GetQuality()->GetOutput()->GetNumberOfTetrahedra(), 3000);
}

TEST(Resolution, ContoursAreOnSlicesOfTheImageWhateverTheStep)
{
  bone::BuildPipeline    pipeline(1);
  bone::ResolutionSearch search;
  search.sliceSpacing = 0.5;
  for (const auto & [step, expected] :
       { std::pair(1.9, 0.0), std::pair(3.9, 0.0), std::pair(4.1, 1.0), std::pair(7.0, 1.5) })
  {
    bone::SetResolution(pipeline, { step, 4.0 }, search);
    EXPECT_DOUBLE_EQ(pipeline.GetSnake()->GetSliceStep(), expected) << step;
    EXPECT_DOUBLE_EQ(pipeline.GetSlices()->GetMeanSpacing(), step);
  }
}

TEST(Resolution, EstimateScalesWithTheSquareRoot)
{
  const auto coarse = bone::EstimateResolution(20000.0, 0.5, 10000);
  const auto fine = bone::EstimateResolution(20000.0, 0.5, 40000);
  EXPECT_NEAR(coarse.sliceStep / fine.sliceStep, 2.0, 1e-9);
  EXPECT_NEAR(coarse.contourSpacing / fine.contourSpacing, 2.0, 1e-9);
  EXPECT_DOUBLE_EQ(bone::EstimateResolution(20000.0, 3.0, 40000).sliceStep, 3.0);
}
} // namespace PipelinePartsTests
