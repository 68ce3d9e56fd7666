/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneVoxelDRRImageFilter.h"

#include "boneProgressWatch.h"
#include "boneRadiographTestMeshes.h"

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace VoxelDRRImageFilterTests
{
using namespace bone;
using Image = itk::Image<float, 3>;
using Mask = itk::Image<short, 3>;
using Filter = VoxelDRRImageFilter<Image, Image>;

const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.5, Vector3(1, -2, 0.7).normalized()).toRotationMatrix();
const Vector3         origin(7, -12, 100), spacing(0.8, 1.1, 2.5);
constexpr int         size[3] = { 40, 30, 16 };

/** An oblique, anisotropic image whose region starts at an index that is not zero. */
template <typename TImage>
typename TImage::Pointer
MakeImage(const std::function<double(const Vector3 & index)> & value)
{
  auto                        image = TImage::New();
  typename TImage::RegionType region({ { -3, 5, 2 } }, { { size[0], size[1], size[2] } });
  image->SetRegions(region);
  typename TImage::PointType     point;
  typename TImage::SpacingType   step;
  typename TImage::DirectionType direction;
  const Vector3                  first = origin - turn * Vector3(-3, 5, 2).cwiseProduct(spacing);
  for (int k = 0; k < 3; ++k)
  {
    point[k] = first[k];
    step[k] = spacing[k];
    for (int axis = 0; axis < 3; ++axis)
    {
      direction(k, axis) = turn(k, axis);
    }
  }
  image->SetOrigin(point);
  image->SetSpacing(step);
  image->SetDirection(direction);
  image->Allocate();
  auto * voxel = image->GetBufferPointer();
  for (int z = 0; z < size[2]; ++z)
  {
    for (int y = 0; y < size[1]; ++y)
    {
      for (int x = 0; x < size[0]; ++x)
      {
        *voxel++ = static_cast<typename TImage::PixelType>(value(Vector3(x, y, z)));
      }
    }
  }
  return image;
}

/** A point by its (fractional) index, counted from the first voxel. */
Vector3
PointAt(const Vector3 & index)
{
  return origin + turn * index.cwiseProduct(spacing);
}

Vector3
IndexAt(const Vector3 & point)
{
  return (turn.transpose() * (point - origin)).cwiseQuotient(spacing);
}

const Vector3 middle = PointAt(Vector3(19.5, 14.5, 7.5));

/** Looking along the index axis (parallel) or obliquely at the image. */
XRayGeometry::Pointer
Look(const Vector3 & beam, bool parallel = false)
{
  auto geometry = XRayGeometry::New();
  auto view = XRayGeometry::Framing(Vector3(middle - Vector3::Constant(22)),
                                    Vector3(middle + Vector3::Constant(22)),
                                    beam.normalized(),
                                    Vector3(0.1, 0.3, 1),
                                    400,
                                    500,
                                    50);
  view.parallel = parallel;
  geometry->SetView(view);
  return geometry;
}

const float *
Pixels(Filter * filter)
{
  filter->Update();
  return filter->GetOutput()->GetBufferPointer();
}

/** integral(a, b) over the ray's part a..b in the image, for each pixel; 0 where it misses. */
template <typename TIntegral>
std::vector<double>
Expected(const XRayGeometry * geometry, const TIntegral & integral)
{
  const auto &        view = geometry->GetView();
  std::vector<double> image;
  for (int r = 0; r < view.size[1]; ++r)
  {
    for (int c = 0; c < view.size[0]; ++c)
    {
      const Vector3 pixel = geometry->GetPixelPoint(c, r);
      const Vector3 source = view.parallel ? Vector3(pixel - 3000 * view.direction) : view.source;
      const auto    part = test::ClipToBox(IndexAt(source),
                                        IndexAt(pixel),
                                        Vector3::Constant(-0.5),
                                        Vector3(size[0], size[1], size[2]) - Vector3::Constant(0.5));
      const Vector3 ray = pixel - source;
      image.push_back(part[0] < part[1] ? integral(Vector3(source + part[0] * ray), Vector3(source + part[1] * ray))
                                        : 0.0);
    }
  }
  return image;
}

const std::vector<Vector3> beams = { Vector3(0.3, 1, 0.2),
                                     Vector3(1, 0.1, -0.4),
                                     Vector3(0.2, 0.3, -1),
                                     Vector3(-1, -1, -1) };

TEST(VoxelDRRImageFilter, AnImageOfOnesGivesTheExactChordsOfItsBox)
{
  const auto ones = MakeImage<Image>([](const Vector3 &) { return 1.0; });
  for (bool parallel : { false, true })
  {
    for (const Vector3 & beam : beams)
    {
      const auto geometry = Look(beam, parallel);
      auto       filter = Filter::New();
      filter->SetInput(ones);
      filter->SetGeometry(geometry);
      const float * pixels = Pixels(filter);
      const auto    expected = Expected(geometry, [](const Vector3 & a, const Vector3 & b) { return (b - a).norm(); });
      for (std::size_t i = 0; i < expected.size(); ++i)
      {
        ASSERT_NEAR(pixels[i], expected[i], 1e-4) << i << " of " << beam.transpose();
      }
    }
  }
}

TEST(VoxelDRRImageFilter, ALinearFieldInSpaceIsIntegratedInSpace)
{
  const test::Affine field{ -3, Vector3(0.1, 0.07, 0.05) };
  const auto         ramp = MakeImage<Image>([&](const Vector3 & index) { return field.At(PointAt(index)); });
  for (const Vector3 & beam : beams)
  {
    const auto geometry = Look(beam);
    auto       filter = Filter::New();
    filter->SetInput(ramp);
    filter->SetGeometry(geometry);
    const float * pixels = Pixels(filter);
    const auto    expected =
      Expected(geometry, [&](const Vector3 & a, const Vector3 & b) { return test::IntegratePower(field, 1, a, b); });
    const double largest = *std::max_element(expected.begin(), expected.end());
    for (std::size_t i = 0; i < expected.size(); ++i)
    {
      // Half a voxel at each end is constant, not linear.
      ASSERT_NEAR(pixels[i], expected[i], 4e-3 * largest) << i << " of " << beam.transpose();
    }
  }
}

TEST(VoxelDRRImageFilter, OnlyMaskedVoxelsCount)
{
  const auto ones = MakeImage<Image>([](const Vector3 & index) { return index[0] < 20 ? 2.0 : 1.0; });
  const auto mask =
    MakeImage<Mask>([](const Vector3 & i) { return i[0] >= 10 && i[0] < 15 ? 4 : (i[0] >= 25 && i[0] < 32 ? 7 : 0); });
  auto geometry = Look(turn * Vector3::UnitX(), true);
  auto filter = Filter::New();
  filter->SetInput(ones);
  filter->SetMask(mask);
  filter->SetGeometry(geometry);
  const auto & view = geometry->GetView();
  const auto   centre = (view.size[1] / 2) * view.size[0] + view.size[0] / 2;
  EXPECT_NEAR(Pixels(filter)[centre], 0.8 * (5 * 2 + 7), 1e-4);
  filter->SetMaskLabel(4);
  EXPECT_NEAR(Pixels(filter)[centre], 0.8 * 10, 1e-4);
  filter->SetMaskLabel(7);
  EXPECT_NEAR(Pixels(filter)[centre], 0.8 * 7, 1e-4);
  filter->SetMaskLabel(5);
  EXPECT_THROW(filter->Update(), itk::ExceptionObject);
}

TEST(VoxelDRRImageFilter, AMaskOfEverythingChangesNothing)
{
  const auto image = MakeImage<Image>([](const Vector3 & i) { return std::sin(i[0]) + i[1] * i[2]; });
  const auto all = MakeImage<Mask>([](const Vector3 &) { return 1; });
  const auto geometry = Look(beams[0]);
  auto       plain = Filter::New(), masked = Filter::New();
  for (auto & filter : { plain, masked })
  {
    filter->SetInput(image);
    filter->SetGeometry(geometry);
  }
  masked->SetMask(all);
  const auto count = geometry->GetView().size[0] * geometry->GetView().size[1];
  EXPECT_EQ(std::vector<float>(Pixels(plain), Pixels(plain) + count),
            std::vector<float>(Pixels(masked), Pixels(masked) + count));
}

TEST(VoxelDRRImageFilter, IntegratesFromTheSourceToThePixelOnly)
{
  const auto ones = MakeImage<Image>([](const Vector3 &) { return 1.0; });
  auto       geometry = XRayGeometry::New();
  auto       view = geometry->GetView();
  view.source = PointAt(Vector3(5, 10, 8));
  view.detectorOrigin = PointAt(Vector3(20, 12, 8));
  view.detectorU = turn.col(1);
  view.detectorV = turn.col(2);
  view.size = { { 3, 3 } };
  geometry->SetView(view);
  auto filter = Filter::New();
  filter->SetInput(ones);
  filter->SetGeometry(geometry);
  EXPECT_NEAR(Pixels(filter)[4], (geometry->GetPixelPoint(1, 1) - view.source).norm(), 1e-5);
}

TEST(VoxelDRRImageFilter, WaterScaledTakesWhatIsLessThanAirAsAir)
{
  const auto image = MakeImage<Image>([](const Vector3 & i) { return i[0] < 20 ? -3000.0 : 0.0; });
  auto       geometry = Look(turn * Vector3::UnitX(), true);
  auto       filter = Filter::New();
  filter->SetInput(image);
  filter->SetGeometry(geometry);
  filter->SetHUToAttenuation(HUToAttenuation::WaterScaled);
  filter->SetWaterAttenuation(0.02);
  const auto & view = geometry->GetView();
  EXPECT_NEAR(Pixels(filter)[(view.size[1] / 2) * view.size[0] + view.size[0] / 2], 0.02 * 20 * 0.8, 1e-5);
}

TEST(VoxelDRRImageFilter, AboveAirTakesAirAsNothing)
{
  // Padding, air, and 20 voxels of 0.8 mm with 300 HU.
  const auto image =
    MakeImage<Image>([](const Vector3 & i) { return i[0] < 5 ? -3000.0 : (i[0] < 20 ? -1000.0 : 300.0); });
  auto geometry = Look(turn * Vector3::UnitX(), true);
  auto filter = Filter::New();
  filter->SetInput(image);
  filter->SetGeometry(geometry);
  const auto & view = geometry->GetView();
  const auto   centre = (view.size[1] / 2) * view.size[0] + view.size[0] / 2;
  EXPECT_NEAR(Pixels(filter)[centre], 0.8 * (5 * -3000 + 15 * -1000 + 20 * 300), 1e-2); // the default: as it is
  filter->AboveAirOn();
  EXPECT_NEAR(Pixels(filter)[centre], 0.8 * 20 * 1300, 1e-2);
  const auto mask = MakeImage<Mask>([](const Vector3 & i) { return i[0] < 30 ? 1 : 0; });
  filter->SetMask(mask);
  EXPECT_NEAR(Pixels(filter)[centre], 0.8 * 10 * 1300, 1e-2); // 0 outside of the mask
  filter->SetMask(nullptr);
  filter->SetHUToAttenuation(HUToAttenuation::WaterScaled);
  filter->SetWaterAttenuation(0.02);
  EXPECT_NEAR(Pixels(filter)[centre], 0.02 * 20 * 0.8 * 1.3, 1e-5); // has no effect then
}

TEST(VoxelDRRImageFilter, AboveAirOfAHomogeneousBoxIsItsChords)
{
  const auto box = MakeImage<Image>([](const Vector3 &) { return 250.0; });
  for (const Vector3 & beam : beams)
  {
    const auto geometry = Look(beam);
    auto       filter = Filter::New();
    filter->SetInput(box);
    filter->SetGeometry(geometry);
    filter->AboveAirOn();
    const float * pixels = Pixels(filter);
    const auto    chords = Expected(geometry, [](const Vector3 & a, const Vector3 & b) { return (b - a).norm(); });
    for (std::size_t i = 0; i < chords.size(); ++i)
    {
      ASSERT_NEAR(pixels[i], 1250.0 * chords[i], 0.1) << i << " of " << beam.transpose();
    }
  }
}

TEST(VoxelDRRImageFilter, HasTheSameOutputForAnyNumberOfThreads)
{
  const auto image =
    MakeImage<itk::Image<short, 3>>([](const Vector3 & i) { return 100 * std::sin(i[0]) + i[1] * i[2]; });
  using ShortFilter = VoxelDRRImageFilter<itk::Image<short, 3>, Image>;
  std::vector<float> pixels[2];
  for (int k = 0; k < 2; ++k)
  {
    auto filter = ShortFilter::New();
    filter->SetInput(image);
    filter->SetGeometry(Look(beams[1]));
    filter->SetNumberOfWorkUnits(k == 0 ? 1 : 5);
    filter->Update();
    const float * first = filter->GetOutput()->GetBufferPointer();
    pixels[k].assign(first, first + filter->GetOutput()->GetBufferedRegion().GetNumberOfPixels());
  }
  EXPECT_EQ(pixels[0], pixels[1]);
}

TEST(VoxelDRRImageFilter, RunsAgainOnlyAfterAChange)
{
  int  runs = 0;
  auto geometry = Look(beams[0]);
  auto filter = Filter::New();
  filter->AddObserver(itk::StartEvent(), [&](const itk::EventObject &) { ++runs; });
  filter->SetInput(MakeImage<Image>([](const Vector3 &) { return 1.0; }));
  filter->SetGeometry(geometry);
  filter->Update();
  filter->Update();
  EXPECT_EQ(runs, 1);
  auto view = geometry->GetView();
  view.source.x() += 1;
  geometry->SetView(view);
  filter->Update();
  EXPECT_EQ(runs, 2);
}

TEST(VoxelDRRImageFilter, RefusesAMaskOnAnotherGrid)
{
  auto filter = Filter::New();
  filter->SetInput(MakeImage<Image>([](const Vector3 &) { return 1.0; }));
  filter->SetGeometry(Look(beams[0]));
  auto mask = MakeImage<Mask>([](const Vector3 &) { return 1; });
  auto shifted = mask->GetOrigin();
  shifted[1] += 0.3;
  mask->SetOrigin(shifted);
  filter->SetMask(mask);
  try
  {
    filter->Update();
    ADD_FAILURE() << "not refused";
  }
  catch (const itk::ExceptionObject & error)
  {
    EXPECT_THAT(error.what(), testing::HasSubstr("different grids"));
  }
}

TEST(VoxelDRRImageFilter, ReportsProgressOfTwoViewsThatDoesNotFallAndStopsOnAbort)
{
  auto filter = Filter::New();
  filter->SetInput(MakeImage<Image>([](const Vector3 & i) { return std::sin(i[0]) + i[1] * i[2]; }));
  filter->SetGeometry(Look(beams[0]));
  filter->SetGeometry(1, Look(beams[1]));
  filter->SetNumberOfWorkUnits(1);
  const test::ProgressWatch watch(filter);
  filter->Update();
  EXPECT_FALSE(watch.falls);
  EXPECT_EQ(watch.last, 1.0f);
  EXPECT_GE(watch.steps, 10);
  const auto               count = filter->GetOutput()->GetBufferedRegion().GetNumberOfPixels();
  const std::vector<float> before(Pixels(filter), Pixels(filter) + count);
  filter->Modified();
  test::ExpectUsableAfterAbort(filter);
  EXPECT_EQ(std::vector<float>(Pixels(filter), Pixels(filter) + count), before);
}
} // namespace VoxelDRRImageFilterTests
