/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneMeshQualityFilter.h"

#include "../../Core/test/boneTestBodies.h"
#include "boneMeshValidator.h"
#include "boneQualityMeasures.h"
#include "boneTetraSwapFilter.h"
#include "boneTriangleDistance.h"

#include <gtest/gtest.h>
#include <itkImageRegionIteratorWithIndex.h>

#include <algorithm>
#include <map>
#include <set>

using namespace bone;

namespace MeshQualityFilterTests
{
using MeshType = DensityMesh<double>;

MeshType::Pointer
AsMesh(MeshArrays arrays)
{
  auto mesh = MeshType::New();
  mesh->SetArrays(std::move(arrays));
  return mesh;
}

MeshArrays
Body(unsigned seed)
{
  test::TubeShape shape;
  shape.seed = seed;
  shape.bumps = 0.3;
  return seed % 2 == 0 ? test::MakeBall(4, { 1, 1, 2 }, 12, 0.18, seed) : test::MakeTube(shape);
}

std::map<int, double>
Volumes(const MeshArrays & mesh)
{
  std::map<int, double> volumes;
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
  {
    const Id4 & c = mesh.tetrahedra[t];
    volumes[mesh.region[t]] += SignedVolume(mesh.points[c[0]], mesh.points[c[1]], mesh.points[c[2]], mesh.points[c[3]]);
  }
  return volumes;
}

std::vector<TriangleTree::Triangle>
Boundary(const MeshArrays & mesh)
{
  std::vector<TriangleTree::Triangle> triangles;
  for (const auto & f : BoundaryFaces(mesh))
  {
    triangles.push_back({ { mesh.points[f[0]], mesh.points[f[1]], mesh.points[f[2]] } });
  }
  return triangles;
}

ContourStack::SliceContainer
CirclesOfBall(const Vector3 & centre, double radius)
{
  constexpr int                around = 64;
  const double                 turn = 2.0 * std::acos(-1.0) / around;
  ContourStack::SliceContainer slices;
  for (double z = -std::floor(radius) + 1.0; z < radius; z += 1.0)
  {
    slices.emplace_back();
    slices.back().origin = centre + Vector3(0, 0, z);
    slices.back().contours.emplace_back();
    const double r = std::sqrt(radius * radius - z * z);
    for (int i = 0; i < around; ++i)
    {
      slices.back().contours.back().points.push_back(slices.back().origin +
                                                     r * Vector3(std::cos(i * turn), std::sin(i * turn), 0));
    }
  }
  return slices;
}

/** Puts a point on edge a -> b, next to a. */
void
SplitNextTo(IdType a, IdType b, double distance, MeshArrays & mesh)
{
  const IdType  m = static_cast<IdType>(mesh.points.size());
  const Vector3 way = (mesh.points[b] - mesh.points[a]).normalized();
  mesh.points.push_back(mesh.points[a] + distance * way);
  mesh.layer.push_back(std::min(mesh.layer[a], mesh.layer[b]));
  if (!mesh.slice.empty())
  {
    mesh.slice.push_back(mesh.slice[a]);
  }
  const std::size_t count = mesh.tetrahedra.size();
  for (std::size_t t = 0; t < count; ++t)
  {
    Id4 &      c = mesh.tetrahedra[t];
    const auto i = std::find(c.begin(), c.end(), a), j = std::find(c.begin(), c.end(), b);
    if (i != c.end() && j != c.end())
    {
      Id4 far = c;
      *j = m;
      far[static_cast<std::size_t>(i - c.begin())] = m;
      mesh.tetrahedra.push_back(far);
      mesh.region.push_back(mesh.region[t]);
    }
  }
}

/** Both ends of some surface edges get others nearly on top of them, towards all their neighbors. */
MeshArrays
WithKnots(MeshArrays mesh)
{
  const auto faces = BoundaryFaces(mesh);
  for (std::size_t f = 0; f < faces.size(); f += faces.size() / 5)
  {
    for (const IdType end : { faces[f][0], faces[f][1] })
    {
      std::set<IdType> neighbors;
      for (const Id4 & c : mesh.tetrahedra)
      {
        if (std::find(c.begin(), c.end(), end) != c.end())
        {
          neighbors.insert(c.begin(), c.end());
        }
      }
      neighbors.erase(end);
      double distance = 1e-5;
      for (const IdType other : neighbors)
      {
        SplitNextTo(end, other, distance, mesh);
        distance *= 1.3;
      }
    }
  }
  mesh.neighbors = ComputeFaceNeighbors(mesh.tetrahedra);
  return mesh;
}

double
SmallestAngle(const MeshArrays & mesh)
{
  return SummarizeQuality(mesh, QualityMeasure::MinimumDihedralAngle).minimum;
}

TEST(MeshQualityFilter, KeepsMeshesValidAndRaisesTheirQuality)
{
  for (unsigned seed = 1; seed <= 6; ++seed)
  {
    const auto mesh = Body(seed);
    auto       filter = MeshQualityFilter<MeshType>::New();
    filter->SetInput(AsMesh(mesh));
    filter->SetRounds(2);
    filter->Update();
    const auto made = filter->GetOutput()->GetArrays();
    const auto validation = ValidateMesh(made);
    EXPECT_TRUE(validation.IsValid()) << "seed " << seed << ": " << validation.Summary();
    EXPECT_GT(SmallestAngle(made), 1.2 * SmallestAngle(mesh)) << "seed " << seed;
    EXPECT_GT(SmallestAngle(made), 10.0 / 57.3);
    EXPECT_EQ(made.layer.size(), made.points.size());
    EXPECT_EQ(made.slice.size(), mesh.slice.empty() ? 0u : made.points.size());
    EXPECT_GT(filter->GetReport().flips, 0u);
    EXPECT_FALSE(made.HasDensity());
  }
}

TEST(MeshQualityFilter, KnotsOfNearlyCoincidentPointsAreUndone)
{
  for (unsigned seed = 1; seed <= 6; ++seed)
  {
    const auto mesh = WithKnots(Body(seed));
    ASSERT_TRUE(ValidateMesh(mesh).IsValid()) << "seed " << seed;
    ASSERT_LT(SmallestAngle(mesh), 1e-3);
    auto filter = MeshQualityFilter<MeshType>::New();
    filter->SetInput(AsMesh(mesh));
    filter->SetRounds(2);
    filter->Update();
    const auto made = filter->GetOutput()->GetArrays();
    EXPECT_TRUE(ValidateMesh(made).IsValid()) << "seed " << seed;
    EXPECT_GT(SmallestAngle(made), 10.0 / 57.3) << "seed " << seed;
  }
}

TEST(MeshQualityFilter, RegionsKeepTheirVolumes)
{
  for (unsigned seed = 1; seed <= 2; ++seed)
  {
    const auto mesh = Body(seed);
    auto       filter = MeshQualityFilter<MeshType>::New();
    filter->SetInput(AsMesh(mesh));
    filter->Update();
    const auto before = Volumes(mesh), after = Volumes(filter->GetOutput()->GetArrays());
    ASSERT_EQ(before.size(), after.size());
    for (const auto & [region, volume] : before)
    {
      EXPECT_NEAR(after.at(region), volume, 2e-3 * volume) << "seed " << seed << ", region " << region;
    }
  }
}

TEST(MeshQualityFilter, SurfacesStayWithinTheBoundBothWays)
{
  constexpr double bound = 0.1;
  auto             filter = MeshQualityFilter<MeshType>::New();
  const auto       mesh = Body(1);
  filter->SetInput(AsMesh(mesh));
  filter->SetDistanceBound(bound);
  filter->SetSliverFactor(1.0);
  filter->Update();
  const auto         first = Boundary(mesh), made = Boundary(filter->GetOutput()->GetArrays());
  const TriangleTree firstTree(first), madeTree(made);
  const auto         farthest = [](const auto & from, const TriangleTree & to, bool corners) {
    double squared = 0.0;
    for (const auto & t : from)
    {
      const Vector3 sum = t[0] + t[1] + t[2];
      squared = std::max(squared, to.FindNearest(sum / 3.0).squaredDistance);
      for (const Vector3 & x : t)
      {
        squared = std::max(squared, to.FindNearest(corners ? x : Vector3((sum + 3.0 * x) / 6.0)).squaredDistance);
      }
    }
    return std::sqrt(squared);
  };
  EXPECT_LE(farthest(first, madeTree, true), bound * (1 + 1e-9));
  EXPECT_LE(farthest(first, madeTree, false), bound * (1 + 1e-9));
  EXPECT_LE(farthest(made, firstTree, true), 1.5 * bound);
}

/** Centroid of the boundary's area. */
Vector3
MiddleOfBoundary(const MeshArrays & arrays)
{
  Vector3 sum = Vector3::Zero();
  double  area = 0.0;
  for (const auto & t : Boundary(arrays))
  {
    const double weight = (t[1] - t[0]).cross(t[2] - t[0]).norm();
    sum += weight * (t[0] + t[1] + t[2]) / 3.0;
    area += weight;
  }
  return sum / area;
}

TEST(MeshQualityFilter, SurfacesAreFittedToContours)
{
  // A ball, and the contours of one beside it.
  constexpr double shift = 0.15, radius = 12.0;
  const auto       mesh = test::MakeBall(4, { 1, 1, 2 }, radius, 0.1, 2);
  auto             stack = ContourStack::New();
  stack->SetSlices(CirclesOfBall({ shift, 0, 0 }, radius));
  for (const bool with : { false, true })
  {
    auto filter = MeshQualityFilter<MeshType>::New();
    filter->SetInput(AsMesh(mesh));
    filter->SetContours(with ? stack.GetPointer() : nullptr);
    filter->SetRounds(1);
    filter->Update();
    const auto made = filter->GetOutput()->GetArrays();
    EXPECT_TRUE(ValidateMesh(made).IsValid()) << ValidateMesh(made).Summary();
    EXPECT_NEAR((MiddleOfBoundary(made) - MiddleOfBoundary(mesh)).x(), with ? shift : 0.0, 0.05);
  }
}

/** Voxels of a ball, labelled 4. */
itk::Image<short, 3>::Pointer
LabelOfBall(const Vector3 & centre, double radius, double spacing)
{
  using Image = itk::Image<short, 3>;
  const auto    count = static_cast<itk::SizeValueType>(std::ceil(34.0 / spacing));
  const Vector3 origin = Vector3::Constant(-17.0);
  auto          image = Image::New();
  image->SetRegions(Image::SizeType{ { count, count, count } });
  image->SetSpacing(Vector3::Constant(spacing).eval().data());
  image->SetOrigin(origin.data());
  image->Allocate();
  for (itk::ImageRegionIteratorWithIndex<Image> it(image, image->GetBufferedRegion()); !it.IsAtEnd(); ++it)
  {
    const auto place = image->TransformIndexToPhysicalPoint<double>(it.GetIndex());
    it.Set((Vector3(place[0], place[1], place[2]) - centre).norm() < radius ? 4 : 0);
  }
  return image;
}

TEST(MeshQualityFilter, SurfacesAreFittedToLabelsBetweenSlices)
{
  // A ball, contours of it, and voxels of one higher: contours know nothing of that, and of it alone.
  constexpr double shift = 0.8, radius = 12.0;
  const auto       mesh = test::MakeBall(4, { 1, 1, 2 }, radius, 0.1, 2);
  auto             stack = ContourStack::New();
  stack->SetSlices(CirclesOfBall(Vector3::Zero(), radius));
  const auto top = [](const MeshArrays & arrays) {
    double sum = 0.0, area = 0.0;
    for (const auto & t : Boundary(arrays))
    {
      const Vector3 normal = (t[1] - t[0]).cross(t[2] - t[0]);
      const double  weight = std::max(0.0, normal.z()) * std::max(0.0, normal.normalized().z() - 0.9);
      sum += weight * (t[0] + t[1] + t[2]).z() / 3.0;
      area += weight;
    }
    return sum / area;
  };
  double heights[3];
  for (int way = 0; way < 3; ++way)
  {
    auto filter = MeshQualityFilter<MeshType>::New();
    filter->SetInput(AsMesh(mesh));
    filter->SetContours(stack);
    filter->SetRounds(1);
    filter->SetLabelImage(way == 0 ? nullptr : LabelOfBall({ 0, 0, way == 1 ? 0.0 : shift }, radius, 2.0).GetPointer());
    filter->SetLabel(4);
    filter->Update();
    const auto made = filter->GetOutput()->GetArrays();
    EXPECT_TRUE(ValidateMesh(made).IsValid()) << ValidateMesh(made).Summary();
    heights[way] = top(made);
  }
  EXPECT_NEAR(heights[1], heights[0], 0.15);
  EXPECT_GT(heights[2], heights[1] + 0.1);
}

TEST(MeshQualityFilter, WithinSlicesContoursCountMoreThanLabels)
{
  // A ball and contours of it; voxels of one beside it draw its sides there, but by less than they draw its top.
  constexpr double shift = 0.8, radius = 12.0;
  const auto       mesh = test::MakeBall(4, { 1, 1, 2 }, radius, 0.1, 2);
  auto             stack = ContourStack::New();
  stack->SetSlices(CirclesOfBall(Vector3::Zero(), radius));
  Vector3 moved[2];
  for (const bool up : { false, true })
  {
    Vector3 middles[2];
    for (const bool shifted : { false, true })
    {
      const Vector3 centre = !shifted ? Vector3::Zero() : up ? Vector3(0, 0, shift) : Vector3(shift, 0, 0);
      auto          filter = MeshQualityFilter<MeshType>::New();
      filter->SetInput(AsMesh(mesh));
      filter->SetContours(stack);
      filter->SetRounds(1);
      filter->SetLabelImage(LabelOfBall(centre, radius, 1.0));
      filter->SetLabel(4);
      filter->Update();
      middles[shifted] = MiddleOfBoundary(filter->GetOutput()->GetArrays());
    }
    moved[up] = middles[1] - middles[0];
  }
  EXPECT_GT(moved[0].x(), 0.106 * shift); // 0.093 of it by faces along the normal alone
  EXPECT_GT(moved[1].z(), 1.4 * moved[0].x());
}

TEST(MeshQualityFilter, TheBoundaryIsPutOnItsSideOfVoxels)
{
  // The boundary passes some centres by little: with the labels it has fewer of them on the wrong side.
  const auto  mesh = test::MakeBall(4, { 1, 1, 2 }, 12.0, 0.1, 4);
  const auto  labels = LabelOfBall({ 0.3, 0.2, 0.1 }, 12.0, 1.0);
  const auto  outline = FindOutline(*labels, 4);
  std::size_t wrong[2];
  for (const bool with : { false, true })
  {
    auto filter = MeshQualityFilter<MeshType>::New();
    filter->SetInput(AsMesh(mesh));
    filter->SetLabelImage(with ? labels.GetPointer() : nullptr);
    filter->Update();
    const auto             made = filter->GetOutput()->GetArrays();
    const TriangleDistance distance(made.points, BoundaryFaces(made));
    wrong[with] = 0;
    for (const auto & voxel : outline.voxels)
    {
      wrong[with] += (distance.FindNearest(voxel.centre).distance < 0) != voxel.inside;
    }
    EXPECT_TRUE(ValidateMesh(made).IsValid()) << ValidateMesh(made).Summary();
  }
  EXPECT_LT(wrong[1], wrong[0]);
}

TEST(MeshQualityFilter, LongCellsInsideARegionAreHalvedUnlessNotWanted)
{
  // A thick body whose surface is sampled finely.
  test::TubeShape shape;
  shape.slices = 8;
  shape.around = 32;
  const auto mesh = test::MakeTube(shape);
  auto       with = MeshQualityFilter<MeshType>::New(), without = MeshQualityFilter<MeshType>::New();
  with->SetInput(AsMesh(mesh));
  with->SetGradation(0.3);
  without->SetInput(AsMesh(mesh));
  without->SetGradation(0.0);
  with->Update();
  without->Update();
  EXPECT_GT(with->GetReport().splits, 0u);
  EXPECT_EQ(without->GetReport().splits, 0u);
  EXPECT_LE(without->GetOutput()->GetArrays().points.size(), mesh.points.size());
  const auto made = with->GetOutput()->GetArrays();
  EXPECT_TRUE(ValidateMesh(made).IsValid()) << ValidateMesh(made).Summary();
}

TEST(MeshQualityFilter, IsDeterministicAndLazy)
{
  auto       a = MeshQualityFilter<MeshType>::New(), b = MeshQualityFilter<MeshType>::New();
  const auto mesh = AsMesh(Body(3));
  for (auto * filter : { a.GetPointer(), b.GetPointer() })
  {
    filter->SetInput(mesh);
    filter->SetRounds(1);
    filter->Update();
  }
  EXPECT_EQ(a->GetOutput()->GetArrays().points, b->GetOutput()->GetArrays().points);
  EXPECT_EQ(a->GetOutput()->GetTetrahedra(), b->GetOutput()->GetTetrahedra());
  const auto time = a->GetOutput()->GetUpdateMTime();
  a->Update();
  EXPECT_EQ(a->GetOutput()->GetUpdateMTime(), time);
}

TEST(MeshQualityFilter, RefusesBadParameters)
{
  const auto mesh = AsMesh(test::MakeBall(2, { 2 }, 10, 0.1, 1));
  const auto refuses = [&](auto set) {
    auto bad = MeshQualityFilter<MeshType>::New();
    bad->SetInput(mesh);
    set(bad.GetPointer());
    EXPECT_THROW(bad->Update(), itk::ExceptionObject);
  };
  refuses([](auto * f) { f->SetRounds(-1); });
  refuses([](auto * f) { f->SetTargetAngle(std::nan("")); });
  refuses([](auto * f) { f->SetTargetAngle(0.0); });
  refuses([](auto * f) { f->SetDistanceBound(-1.0); });
  refuses([](auto * f) { f->SetGradation(-0.1); });
  refuses([](auto * f) { f->SetSliverFactor(0.9); });
  refuses([](auto * f) { f->SetStiffness(-0.1); });
  refuses([](auto * f) { f->SetInput(nullptr); });
  refuses([](auto * f) {
    f->SetLabelImage(LabelOfBall(Vector3::Zero(), 10.0, 2.0));
    f->SetLabel(5);
  });
}

TEST(TetraSwapFilter, MovesNoPointAndNeverLowersTheWorstAngle)
{
  for (unsigned seed = 1; seed <= 4; ++seed)
  {
    const auto mesh = Body(seed);
    auto       filter = TetraSwapFilter<MeshType>::New();
    filter->SetInput(AsMesh(mesh));
    filter->SetTargetAngle(0.5);
    filter->Update();
    const auto made = filter->GetOutput()->GetArrays();
    EXPECT_EQ(made.points, mesh.points);
    EXPECT_EQ(made.layer, mesh.layer);
    EXPECT_GE(SmallestAngle(made), SmallestAngle(mesh));
    EXPECT_TRUE(ValidateMesh(made).IsValid()) << ValidateMesh(made).Summary();
    EXPECT_GT(filter->GetReport().done, 0u);
    EXPECT_GT(filter->GetReport().refused[static_cast<int>(MeshOperation::Surface)], 0u);
  }
}

TEST(TetraSwapFilter, RefusesBadParameters)
{
  auto filter = TetraSwapFilter<MeshType>::New();
  filter->SetInput(AsMesh(test::MakeBall(2, { 2 }, 10, 0.1, 1)));
  filter->SetTargetAngle(-1);
  EXPECT_THROW(filter->Update(), itk::ExceptionObject);
  filter->SetTargetAngle(0.3);
  filter->SetMaximumPasses(-1);
  EXPECT_THROW(filter->Update(), itk::ExceptionObject);
}
} // namespace MeshQualityFilterTests
