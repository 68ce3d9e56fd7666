/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneContourTilingMeshSource.h"

#include "boneEllipseStack.h"
#include "boneMeshValidator.h"
#include "boneRandomStack.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <itkCastImageFilter.h>
#include <itkImageRegionIteratorWithIndex.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

namespace ContourTilingMeshSourceTests
{
using bone::ContourStack;
using bone::Loop;
using bone::MakeStack;
using bone::MeshArrays;
using bone::Pi;
using bone::Vector2;
using bone::Vector3;
using Source = bone::ContourTilingMeshSource<>;

MeshArrays
Tile(const ContourStack * stack, bone::TilingReport * report = nullptr)
{
  auto source = Source::New();
  source->SetInput(stack);
  source->Update();
  if (report != nullptr)
  {
    *report = source->GetReport();
  }
  return source->GetOutput()->GetArrays();
}

double
Volume(const MeshArrays & mesh, int region)
{
  double volume = 0.0;
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
  {
    const auto & v = mesh.tetrahedra[t];
    volume += region == 0 || mesh.region[t] == region
                ? bone::SignedVolume(mesh.points[v[0]], mesh.points[v[1]], mesh.points[v[2]], mesh.points[v[3]])
                : 0.0;
  }
  return volume;
}

/** Area of the inscribed regular polygon over that of its ellipse. */
double
PolygonShare(int points)
{
  return points * std::sin(2 * Pi / points) / (2 * Pi);
}

const std::vector<Loop> Shaft = { { { 0, 0 }, 12, 10, 0, 1 }, { { 0, 0 }, 9, 7, 1, 2 }, { { 0, 0 }, 6, 4, 2, 3 } };

TEST(ContourTilingMeshSource, FillsAFlatCutCylinderExactly)
{
  auto stack = MakeStack(std::vector<std::vector<Loop>>(6, Shaft), 2.0);
  stack->SetOpenStart(true);
  stack->SetOpenEnd(true);
  const MeshArrays mesh = Tile(stack);
  EXPECT_TRUE(bone::ValidateMesh(mesh).IsValid()) << bone::ValidateMesh(mesh).Summary();
  const double share = PolygonShare(24);
  EXPECT_NEAR(Volume(mesh, 0), 10 * Pi * 120 * share, 1e-6);
  EXPECT_NEAR(Volume(mesh, 1), 10 * Pi * (120 - 63) * share, 1e-6);
  EXPECT_NEAR(Volume(mesh, 2), 10 * Pi * (63 - 24) * share, 1e-6);
  EXPECT_NEAR(Volume(mesh, 3), 10 * Pi * 24 * share, 1e-6);
}

TEST(ContourTilingMeshSource, KeepsContourPointsLayersAndSlices)
{
  auto               stack = MakeStack(std::vector<std::vector<Loop>>(3, Shaft), 2.0);
  const MeshArrays   mesh = Tile(stack);
  std::array<int, 3> count{ { 0, 0, 0 } };
  for (std::size_t p = 0; p < mesh.points.size(); ++p)
  {
    const double z = mesh.points[p].z();
    if (z >= 0 && z <= 4 && mesh.layer[p] < 3)
    {
      EXPECT_DOUBLE_EQ(z, 2.0 * mesh.slice[p]);
      ++count[mesh.layer[p]];
    }
  }
  EXPECT_THAT((std::vector<int>(count.begin(), count.end())), ::testing::Each(3 * 24));
}

TEST(ContourTilingMeshSource, ClosesEndsThatStayInTheImage)
{
  std::vector<std::vector<Loop>> ball;
  for (double z = -9; z <= 9; z += 2)
  {
    const double r = std::sqrt(100 - z * z);
    ball.push_back({ { { 0, 0 }, r, r, 0, 1 } });
  }
  bone::TilingReport report;
  const MeshArrays   mesh = Tile(MakeStack(ball, 2.0, 32), &report);
  EXPECT_EQ(report.caps, 2);
  EXPECT_EQ(bone::ValidateMesh(mesh).boundaryEuler, 2);
  EXPECT_NEAR(Volume(mesh, 0), 4.0 / 3.0 * Pi * 1000, 0.03 * 4200);
}

TEST(ContourTilingMeshSource, JoinsContoursThatSplit)
{
  std::vector<std::vector<Loop>> slices(3, { { { 0, 0 }, 16, 8, 0, 1 }, { { 0, 0 }, 13, 5, 1, 2 } });
  const std::vector<Loop>        two = {
           { { -9, 0 }, 7, 7, 0, 1 }, { { -9, 0 }, 4, 4, 1, 2 }, { { 9, 0 }, 7, 7, 0, 1 }, { { 9, 0 }, 4, 4, 1, 2 }
  };
  slices.insert(slices.end(), 3, two);
  bone::TilingReport report;
  const MeshArrays   mesh = Tile(MakeStack(slices, 2.0), &report);
  const auto         validation = bone::ValidateMesh(mesh);
  EXPECT_TRUE(validation.IsValid()) << validation.Summary();
  EXPECT_EQ(validation.components, 1);
  EXPECT_EQ(validation.boundaryEuler, 2);
  EXPECT_EQ(report.branchings, 1);
}

TEST(ContourTilingMeshSource, JoinsSeveralPiecesWithSeveral)
{
  // Each main piece lies over the other one and over the other side's small piece.
  const std::vector<Loop>        below = { { { 0, 0 }, 16, 8, 0, 1 }, { { 24, 0 }, 4, 4, 0, 1 } };
  const std::vector<Loop>        above = { { { 8, 0 }, 20, 8, 0, 1 }, { { -15, 0 }, 2.5, 2.5, 0, 1 } };
  std::vector<std::vector<Loop>> slices(2, below);
  slices.insert(slices.end(), 2, above);
  auto stack = MakeStack(slices, 2.0);
  stack->SetOpenStart(true);
  stack->SetOpenEnd(true);
  const MeshArrays mesh = Tile(stack);
  const auto       validation = bone::ValidateMesh(mesh);
  EXPECT_TRUE(validation.IsValid()) << validation.Summary();
  EXPECT_EQ(validation.components, 1);
  EXPECT_EQ(validation.boundaryEuler, 2);
  const double lower = 16 * 8 + 4 * 4, upper = 20 * 8 + 2.5 * 2.5;
  EXPECT_NEAR(Volume(mesh, 0) / (3 * (lower + upper) * Pi * PolygonShare(24)), 1.0, 0.02);
}

TEST(ContourTilingMeshSource, ACorrespondenceOverridesOverlap)
{
  // Two columns that overlap each other's next slice: joined by overlap, apart by what is given.
  const std::vector<Loop>        below = { { { -6, 0 }, 7, 6, 0, 1 }, { { 9, 0 }, 6, 6, 0, 1 } };
  const std::vector<Loop>        above = { { { -11, 0 }, 6, 6, 0, 1 }, { { 4, 0 }, 8, 6, 0, 1 } };
  std::vector<std::vector<Loop>> slices(2, below);
  slices.insert(slices.end(), 2, above);
  auto source = Source::New();
  source->SetInput(MakeStack(slices, 2.0));
  source->Update();
  EXPECT_EQ(bone::ValidateMesh(source->GetOutput()->GetArrays()).components, 1);
  const auto found = source->GetReport().correspondence;
  ASSERT_EQ(found.slabs.size(), 3U);
  EXPECT_EQ(found.slabs.at(1).size(), 1U);
  EXPECT_EQ(found.slabs.at(0).size(), 2U);

  auto given = std::make_shared<bone::ContourCorrespondence>();
  given->slabs[1] = { { { 0 }, { 0 } }, { { 1 }, { 1 } } };
  source->SetCorrespondence(given);
  source->Update();
  const auto validation = bone::ValidateMesh(source->GetOutput()->GetArrays());
  EXPECT_TRUE(validation.IsValid()) << validation.Summary();
  EXPECT_EQ(validation.components, 2);
  EXPECT_EQ(source->GetReport().correspondence.slabs.at(1), given->slabs.at(1));
  EXPECT_EQ(source->GetReport().correspondence.slabs.at(0), found.slabs.at(0));

  // What was found, given, changes nothing.
  source->SetCorrespondence(std::make_shared<bone::ContourCorrespondence>(found));
  source->Update();
  EXPECT_EQ(bone::ValidateMesh(source->GetOutput()->GetArrays()).components, 1);

  auto wrong = std::make_shared<bone::ContourCorrespondence>();
  wrong->slabs[1] = { { { 7 }, { 0 } } };
  source->SetCorrespondence(wrong);
  EXPECT_THAT([&] { source->Update(); },
              testing::ThrowsMessage<itk::ExceptionObject>(testing::HasSubstr("slice 1, contour 7")));
}

TEST(ContourTilingMeshSource, CorrespondingPiecesThatCannotBeJoinedEndAndAreReported)
{
  // Two pieces against two have their slab filled; the other two pairs lean far, each its own way: only one of them can
  // be made to overlap by moving the slices.
  const std::vector<Loop> below = {
    { { -12, 0 }, 7, 6, 0, 1 }, { { 3, 0 }, 6, 6, 0, 1 }, { { 0, 20 }, 3, 3, 0, 1 }, { { 0, -20 }, 3, 3, 0, 1 }
  };
  const std::vector<Loop> above = {
    { { -17, 0 }, 6, 6, 0, 1 }, { { -2, 0 }, 8, 6, 0, 1 }, { { 7.2, 20 }, 3, 3, 0, 1 }, { { -7.2, -20 }, 3, 3, 0, 1 }
  };
  std::vector<std::vector<Loop>> slices(2, below);
  slices.insert(slices.end(), 2, above);
  auto source = Source::New();
  source->SetInput(MakeStack(slices, 2.0));
  source->Update();
  const auto validation = bone::ValidateMesh(source->GetOutput()->GetArrays());
  EXPECT_TRUE(validation.IsValid()) << validation.Summary();
  EXPECT_EQ(validation.components, 4);
  EXPECT_EQ(source->GetReport().separatedGroups, 1);
  EXPECT_THAT(source->GetReport().notes, testing::Contains(testing::HasSubstr("does not overlap all of it")));

  source->SetCorrespondence(
    std::make_shared<bone::ContourCorrespondence>(bone::ContourCorrespondence(source->GetReport().correspondence)));
  EXPECT_THAT([&] { source->Update(); },
              testing::ThrowsMessage<itk::ExceptionObject>(testing::HasSubstr("cannot be joined to it")));
}

TEST(ContourTilingMeshSource, ABranchThatBeginsBesideTheBodyIsNoHandle)
{
  // It begins on the second slice, within reach of the body below but over none of it, and runs into the body above.
  const Loop body{ { 0, 0 }, 8, 8, 0, 1 }, branch{ { 12, 0 }, 3, 3, 0, 1 }, both{ { 3, 0 }, 14, 9, 0, 1 };
  const std::vector<std::vector<Loop>> slices = { { body }, { body, branch }, { both }, { both } };
  const auto                           validation = bone::ValidateMesh(Tile(MakeStack(slices, 3.0)));
  EXPECT_TRUE(validation.IsValid()) << validation.Summary();
  EXPECT_EQ(validation.components, 1);
  EXPECT_EQ(validation.boundaryEuler, 2);
}

TEST(ContourTilingMeshSource, DanglingEndsWithinReachAreJoined)
{
  // A ring whose left limb leans so far that it overlaps nothing in the middle slab: one handle, as of a ring.
  const Loop                           top{ { 0, 0 }, 22, 6, 0, 1 }, right{ { 14, 0 }, 4, 4, 0, 1 };
  const Loop                           low{ { -12, 0 }, 2, 4, 0, 1 }, high{ { -17, 0 }, 2, 4, 0, 1 };
  const std::vector<std::vector<Loop>> slices = { { top }, { low, right }, { high, right }, { top } };
  const auto                           validation = bone::ValidateMesh(Tile(MakeStack(slices, 3.0)));
  EXPECT_TRUE(validation.IsValid()) << validation.Summary();
  EXPECT_EQ(validation.components, 1);
  EXPECT_EQ(validation.boundaryEuler, 0);
}

TEST(ContourTilingMeshSource, FansAboutNearlyTheSamePointLeaveNoKnot)
{
  // A round column whose slices' axes are points a hundredth of a millimetre apart, in a slab that is filled because of
  // the two pieces against two beside it.
  const std::vector<Loop> below = { { { -12, 0 }, 7, 6, 0, 1 }, { { 3, 0 }, 6, 6, 0, 1 }, { { 0, 30 }, 12, 12, 0, 1 } };
  const std::vector<Loop> above = { { { -17, 0 }, 6, 6, 0, 1 },
                                    { { -2, 0 }, 8, 6, 0, 1 },
                                    { { 0.01, 30 }, 12, 12, 0, 1 } };
  std::vector<std::vector<Loop>> slices(2, below);
  slices.insert(slices.end(), 2, above);
  const MeshArrays mesh = Tile(MakeStack(slices, 2.0));
  EXPECT_TRUE(bone::ValidateMesh(mesh).IsValid());
  int close = 0;
  for (std::size_t i = 0; i < mesh.points.size(); ++i)
  {
    for (std::size_t j = 0; j < i; ++j)
    {
      close += (mesh.points[i] - mesh.points[j]).norm() < 0.05;
    }
  }
  EXPECT_LE(close, 2);
}

TEST(ContourTilingMeshSource, ASocketEndsInADome)
{
  // Solid below, a hole above: its floor is neither on the lower slice nor on the upper one.
  for (const bool layered : { false, true })
  {
    std::vector<Loop> solid = { { { 0, 0 }, 20, 18, 0, 1 } }, pit = { solid[0], { { 1, 0 }, 8, 7, 0, 0 } };
    if (layered)
    {
      solid.push_back({ { 0, 0 }, 18, 16, 1, 2 });
    }
    std::vector<std::vector<Loop>> slices(2, solid);
    slices.insert(slices.end(), 3, pit);
    auto stack = MakeStack(slices, 3.0, 40);
    stack->SetOpenStart(true);
    stack->SetOpenEnd(true);
    const MeshArrays mesh = Tile(stack);
    const auto       validation = bone::ValidateMesh(mesh);
    EXPECT_TRUE(validation.IsValid()) << validation.Summary();
    EXPECT_EQ(validation.boundaryEuler, 2);
    const double pitVolume = 12 * Pi * 20 * 18 * PolygonShare(40) - Volume(mesh, 0);
    const double depth = pitVolume / (Pi * 8 * 7 * PolygonShare(40)) - 6.0;
    EXPECT_GT(depth, 0.12 * 3.0) << layered;
    EXPECT_LT(depth, 0.50 * 3.0) << layered;
  }
}

TEST(ContourTilingMeshSource, LetsLayersBeginAndEnd)
{
  std::vector<std::vector<Loop>> slices;
  for (int k = 0; k < 9; ++k)
  {
    slices.push_back({ Shaft[0] });
    if (k >= 2 && k < 7)
    {
      slices.back().push_back(Shaft[1]);
    }
    if (k >= 3 && k < 5)
    {
      slices.back().push_back(Shaft[2]);
    }
  }
  bone::TilingReport report;
  const MeshArrays   mesh = Tile(MakeStack(slices, 2.0), &report);
  const auto         validation = bone::ValidateMesh(mesh);
  EXPECT_TRUE(validation.IsValid()) << validation.Summary();
  EXPECT_EQ(report.layerBranchings, 4);
  EXPECT_GT(Volume(mesh, 3), 0.0);
}

TEST(ContourTilingMeshSource, KeepsAHoleThroughTheBone)
{
  const std::vector<Loop> ring = { { { 0, 0 }, 12, 10, 0, 1 }, { { 1, 0 }, 5, 4, 0, 0 } };
  auto                    stack = MakeStack(std::vector<std::vector<Loop>>(4, ring), 2.0);
  stack->SetOpenStart(true);
  stack->SetOpenEnd(true);
  const MeshArrays mesh = Tile(stack);
  const auto       validation = bone::ValidateMesh(mesh);
  EXPECT_TRUE(validation.IsValid()) << validation.Summary();
  EXPECT_EQ(validation.boundaryEuler, 0);
  EXPECT_NEAR(Volume(mesh, 0), 6 * Pi * (120 - 20) * PolygonShare(24), 1e-6);
}

TEST(ContourTilingMeshSource, IsValidOnRandomStacks)
{
  for (unsigned seed = 0; seed < 12; ++seed)
  {
    std::mt19937                           engine(seed);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    const double                           bow = 0.6 * uniform(engine), twist = 0.1 * uniform(engine);
    std::vector<std::vector<Loop>>         slices;
    for (int k = 0; k < 12; ++k)
    {
      const Vector2 c(bow * k, 2 * std::sin(twist * k));
      const double  rx = 10 + 3 * std::sin(0.4 * k + seed), ry = 7 + 2 * std::cos(0.5 * k);
      slices.push_back({ { c, rx, ry, 0, 1 } });
      if (k > 1 && k < 10)
      {
        slices.back().push_back({ c, rx - 2, ry - 2, 1, 2 });
      }
    }
    const auto validation = bone::ValidateMesh(Tile(MakeStack(slices, 2.0, 16 + static_cast<int>(seed))));
    EXPECT_TRUE(validation.IsValid()) << "seed " << seed << ": " << validation.Summary();
    EXPECT_EQ(validation.boundaryEuler, 2) << "seed " << seed;
  }
}

TEST(ContourTilingMeshSource, GivesTheSameMeshAgain)
{
  auto             stack = MakeStack(std::vector<std::vector<Loop>>(4, Shaft), 2.0);
  const MeshArrays a = Tile(stack), b = Tile(stack);
  EXPECT_EQ(a.tetrahedra, b.tetrahedra);
  EXPECT_EQ(a.points, b.points);
}

TEST(ContourTilingMeshSource, RunsAgainOnlyWhenSomethingChanged)
{
  auto source = Source::New();
  source->SetInput(MakeStack(std::vector<std::vector<Loop>>(3, Shaft), 2.0));
  int runs = 0;
  source->AddObserver(itk::StartEvent(), [&runs](const itk::EventObject &) { ++runs; });
  source->Update();
  source->Update();
  EXPECT_EQ(runs, 1);
  source->SetMetric(bone::TilingMetricKind::Area);
  source->Update();
  EXPECT_EQ(runs, 2);
}

TEST(ContourTilingMeshSource, ReportsProgressThatNeverGoesBack)
{
  auto source = Source::New();
  source->SetInput(bone::RandomStack(50).Make());
  std::vector<float> steps;
  source->AddObserver(itk::ProgressEvent(), [&](const itk::EventObject &) { steps.push_back(source->GetProgress()); });
  source->Update();
  EXPECT_TRUE(std::is_sorted(steps.begin(), steps.end()));
  EXPECT_GE(steps.size(), 10U);
  EXPECT_EQ(steps.back(), 1.0F);
}

TEST(ContourTilingMeshSource, AnAbortIsNoticedSoonAndLeavesTheFilterReusable)
{
  const auto stack = bone::RandomStack(50).Make();
  auto       source = Source::New();
  source->SetInput(stack);
  for (const float when : { 0.02F, 0.2F, 0.4F, 0.6F, 0.8F })
  {
    float      asked = 0.0F;
    float      last = 0.0F;
    const auto observer = source->AddObserver(itk::ProgressEvent(), [&](const itk::EventObject &) {
      last = source->GetProgress();
      if (last >= when && !source->GetAbortGenerateData())
      {
        asked = last;
        source->AbortGenerateDataOn();
      }
    });
    EXPECT_THROW(source->Update(), itk::ProcessAborted) << when;
    EXPECT_LT(last, asked + 0.1F) << when;
    source->RemoveObserver(observer);
  }
  source->Update();
  const MeshArrays expected = Tile(stack);
  EXPECT_EQ(source->GetOutput()->GetArrays().tetrahedra, expected.tetrahedra);
  EXPECT_EQ(source->GetOutput()->GetArrays().points, expected.points);
}

TEST(ContourTilingMeshSource, EveryMetricTilesTheSameBody)
{
  auto stack = MakeStack(std::vector<std::vector<Loop>>(4, Shaft), 2.0);
  stack->SetOpenStart(true);
  stack->SetOpenEnd(true);
  using Kind = bone::TilingMetricKind;
  for (const Kind metric : { Kind::Span, Kind::Area, Kind::Volume, Kind::Combined })
  {
    auto source = Source::New();
    source->SetInput(stack);
    source->SetMetric(metric);
    source->Update();
    EXPECT_NEAR(Volume(source->GetOutput()->GetArrays(), 0), 6 * Pi * 120 * PolygonShare(24), 1e-6)
      << bone::ParameterText(metric);
  }
}

TEST(ContourTilingMeshSource, SaysWhatIsWrong)
{
  auto       source = Source::New();
  const auto throws = [&source](const char * words) {
    EXPECT_THAT([&] { source->Update(); }, testing::ThrowsMessage<itk::ExceptionObject>(testing::HasSubstr(words)));
  };
  throws("Contours");
  source->SetInput(MakeStack({ Shaft }, 2.0));
  throws("at least two slices");
  source->SetInput(MakeStack(std::vector<std::vector<Loop>>(3, Shaft), 2.0));
  source->SetMetric(bone::TilingMetricKind::Density);
  throws("DensityImage");
}

/** Types of the CT and of the mesh's coordinates. */
template <typename TPixel, typename TCoordinate>
struct Types
{
  using Image = itk::Image<TPixel, 3>;
  using Mesh = bone::DensityMesh<TCoordinate>;
};

template <typename TTypes>
class ContourTilingMeshSourceOfTypes : public testing::Test
{
};

using AllTypes = testing::Types<Types<short, double>,
                                Types<float, double>,
                                Types<double, double>,
                                Types<short, float>,
                                Types<float, float>,
                                Types<double, float>>;
TYPED_TEST_SUITE(ContourTilingMeshSourceOfTypes, AllTypes);

TYPED_TEST(ContourTilingMeshSourceOfTypes, FollowsTheDensityAlike)
{
  using Image = typename TypeParam::Image;
  using Mesh = typename TypeParam::Mesh;
  auto                       image = Image::New();
  typename Image::RegionType region;
  region.SetIndex({ { -15, -13, -2 } });
  region.SetSize({ { 31, 27, 12 } });
  image->SetRegions(region);
  image->Allocate();
  for (itk::ImageRegionIteratorWithIndex<Image> it(image, region); !it.IsAtEnd(); ++it)
  {
    const auto & i = it.GetIndex(); // whole numbers, which all pixel types hold
    it.Set(static_cast<typename Image::PixelType>(40 * i[0] * (i[2] % 3) + 7 * i[1] * i[1]));
  }
  auto       stack = MakeStack(std::vector<std::vector<Loop>>(4, Shaft), 2.0);
  const auto tile = [&stack, &image](auto source) {
    source->SetInput(stack);
    source->SetMetric(bone::TilingMetricKind::Density);
    if constexpr (std::is_same_v<decltype(source), Source::Pointer>)
    {
      using Cast = itk::CastImageFilter<Image, Source::DensityImageType>;
      auto cast = Cast::New();
      cast->SetInput(image);
      cast->Update();
      source->SetDensityImage(cast->GetOutput());
    }
    else
    {
      source->SetDensityImage(image);
    }
    source->Update();
    return source->GetOutput()->GetArrays();
  };
  const MeshArrays expected = tile(Source::New());
  const MeshArrays mesh = tile(bone::ContourTilingMeshSource<Mesh, Image>::New());
  EXPECT_NE(expected.tetrahedra, Tile(stack).tetrahedra);
  EXPECT_EQ(mesh.tetrahedra, expected.tetrahedra);
  EXPECT_EQ(mesh.region, expected.region);
  ASSERT_EQ(mesh.points.size(), expected.points.size());
  for (std::size_t p = 0; p < mesh.points.size(); ++p)
  {
    EXPECT_NEAR((mesh.points[p] - expected.points[p]).norm(), 0.0, 1e-5);
  }
}
} // namespace ContourTilingMeshSourceTests
