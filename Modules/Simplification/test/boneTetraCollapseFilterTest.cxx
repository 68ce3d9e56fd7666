/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneTetraCollapseFilter.h"

#include "boneCollapseProperty.h"
#include "boneMeshValidator.h"
#include "boneQualityMeasures.h"
#include "boneSurfaceEnvelope.h"
#include "boneSurfaceGrid.h"

#include <itkCommand.h>
#include <itkMultiThreaderBase.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

using namespace bone;

namespace TetraCollapseFilterTests
{
using MeshType = DensityMesh<double>;
using FilterType = TetraCollapseFilter<MeshType>;

double
Linear(const Vector3 & x)
{
  return 300 + 7 * x.x() - 3 * x.y() + 2 * x.z();
}

double
Wavy(const Vector3 & x)
{
  return 500 + 300 * std::sin(x.x() / 9) * std::cos(x.y() / 7) * std::sin(x.z() / 11);
}

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
  shape.bumps = 0.2;
  shape.closed = seed % 3 == 0;
  shape.slices = shape.closed ? 28 : 12;
  shape.around = 12;
  shape.spacing = shape.closed ? 5 : 2;
  shape.rings = seed % 2 == 0 ? std::vector<int>{ 1, 1, 2 } : std::vector<int>{ 2, 2, 1 };
  return seed % 4 == 1 ? test::MakeBall(4, { 1, 1, 2 }, 14, 0.15, seed) : test::MakeTube(shape);
}

FilterType::Pointer
Simplified(const MeshArrays & mesh, const std::vector<IdType> & levels)
{
  auto filter = FilterType::New();
  filter->SetInput(AsMesh(mesh));
  filter->SetLevels(levels);
  filter->SetMaximumVolumeChange(1.0);
  filter->Update();
  return filter;
}

void
ExpectSubset(const MeshArrays & before, const MeshArrays & level, const std::vector<IdType> & parent)
{
  ASSERT_EQ(parent.size(), level.points.size());
  EXPECT_EQ(std::set<IdType>(parent.begin(), parent.end()).size(), parent.size());
  for (std::size_t p = 0; p < parent.size(); ++p)
  {
    ASSERT_LT(static_cast<std::size_t>(parent[p]), before.points.size());
    EXPECT_EQ(level.points[p], before.points[parent[p]]);
    EXPECT_EQ(level.layer[p], before.layer[parent[p]]);
    EXPECT_TRUE(before.slice.empty() || level.slice[p] == before.slice[parent[p]]);
  }
}

TEST(TetraCollapseFilter, EveryLevelIsValidWithItsLayersAndASubsetOfThePoints)
{
  for (unsigned seed = 1; seed <= 6; ++seed)
  {
    auto mesh = Body(seed);
    test::SetDensity(mesh, 1, Wavy);
    const auto   n = static_cast<IdType>(mesh.tetrahedra.size());
    const auto   filter = Simplified(mesh, { n / 3, n / 6 });
    const auto & levels = filter->GetOutput()->GetLevels();
    ASSERT_EQ(levels.size(), 3u);
    const auto first = ValidateMesh(mesh);
    for (std::size_t i = 0; i < levels.size(); ++i)
    {
      const auto level = levels[i].mesh->GetArrays();
      const auto validation = ValidateMesh(level);
      EXPECT_TRUE(validation.IsValid()) << "seed " << seed << ", level " << i + 1 << ": " << validation.Summary();
      EXPECT_EQ(validation.boundaryEuler, first.boundaryEuler);
      EXPECT_EQ(level.neighbors, ComputeFaceNeighbors(level.tetrahedra));
      for (int region = 1; region <= 3; ++region)
      {
        EXPECT_NEAR(test::RegionVolume(level, region) / test::RegionVolume(mesh, region), 1.0, i == 1 ? 0.02 : 0.15)
          << "seed " << seed << ", level " << i + 1 << ", region " << region;
        EXPECT_TRUE(FindCrossingTriangles(BoundaryFaces(level, region), level.points).empty());
      }
      if (i > 0)
      {
        ExpectSubset(levels[i - 1].mesh->GetArrays(), level, levels[i].parentPoint);
        EXPECT_LE(level.tetrahedra.size(), static_cast<std::size_t>(i == 1 ? n / 3 : n / 6)) << "seed " << seed;
        EXPECT_GE(level.tetrahedra.size(), static_cast<std::size_t>(i == 1 ? n / 3 : n / 6) - 20) << "seed " << seed;
        EXPECT_EQ(levels[i].stopReason, "tetrahedra reached");
      }
    }
  }
}

TEST(TetraCollapseFilter, QualityDoesNotFallBelowTheFloorOrTheInput)
{
  auto       mesh = Body(2);
  const auto angle = [](const MeshArrays & m) {
    return SummarizeQuality(m, QualityMeasure::MinimumDihedralAngle).minimum;
  };
  const double before = angle(mesh);
  const auto   filter = Simplified(mesh, { static_cast<IdType>(mesh.tetrahedra.size() / 6) });
  EXPECT_GE(angle(filter->GetOutput()->GetMesh(1)->GetArrays()), std::min(before, std::acos(-1.0) / 120) - 1e-7);
}

TEST(TetraCollapseFilter, CorticalAndOtherCellsHaveFloorsOfTheirOwn)
{
  const auto mesh = Body(2);
  const auto smallestAngle = [](const MeshArrays & m, bool cortical) {
    double cosine = -1.0;
    for (std::size_t t = 0; t < m.tetrahedra.size(); ++t)
    {
      const Id4 &  v = m.tetrahedra[t];
      const auto & p = m.points;
      if ((m.region[t] == Cortical) == cortical)
      {
        cosine = std::max(cosine, LargestDihedralCosine(p[v[0]], p[v[1]], p[v[2]], p[v[3]]));
      }
    }
    return std::acos(cosine);
  };
  for (const bool cortical : { false, true })
  {
    auto filter = FilterType::New();
    filter->SetInput(AsMesh(mesh));
    filter->SetLevels({ static_cast<IdType>(mesh.tetrahedra.size() / 6) });
    filter->SetMaximumVolumeChange(1.0);
    filter->SetMinimumCorticalDihedralAngle(cortical ? 0.2 : 0.0);
    filter->SetMinimumDihedralAngle(cortical ? 0.0 : 0.2);
    filter->Update();
    const auto level = filter->GetOutput()->GetMesh(1)->GetArrays();
    EXPECT_GE(smallestAngle(level, cortical), std::min(0.2, smallestAngle(mesh, cortical)) - 1e-7) << cortical;
    EXPECT_LT(smallestAngle(level, !cortical), std::min(0.2, smallestAngle(mesh, !cortical))) << cortical;
  }
}

TEST(TetraCollapseFilter, LinearDensityIsKeptExactly)
{
  for (int degree : { 1, 2, 3 })
  {
    auto mesh = Body(1);
    test::SetDensity(mesh, degree, Linear);
    const auto   filter = Simplified(mesh, { static_cast<IdType>(mesh.tetrahedra.size() / 4) });
    const auto & level = filter->GetOutput()->GetLevels()[1];
    const auto   arrays = level.mesh->GetArrays();
    EXPECT_EQ(arrays.maximumDegree, degree);
    EXPECT_EQ(arrays.quantity, DensityQuantity::HounsfieldUnit);
    // Cells in the body have it to rounding; outside (at the boundary) the level before has no density to give.
    std::size_t exact = 0;
    for (std::size_t t = 0; t < arrays.tetrahedra.size(); ++t)
    {
      const Id4 &   v = arrays.tetrahedra[t];
      const Vector3 centre =
        (arrays.points[v[0]] + arrays.points[v[1]] + arrays.points[v[2]] + arrays.points[v[3]]) / 4;
      const double value =
        BernsteinValue(degree, &arrays.coefficients[BernsteinCount(degree) * t], Barycentric(0.25, 0.25, 0.25, 0.25));
      exact += std::abs(value - Linear(centre)) < 1e-6;
      EXPECT_NEAR(value, Linear(centre), 10.0);
    }
    EXPECT_GT(exact, arrays.tetrahedra.size() / 2);
    EXPECT_LT(level.densityError, 1.0);
  }
}

TEST(TetraCollapseFilter, ConstantDensityIsKeptEverywhere)
{
  auto mesh = Body(4);
  test::SetDensity(mesh, 2, [](const Vector3 &) { return 123.0; });
  const auto filter = Simplified(mesh, { static_cast<IdType>(mesh.tetrahedra.size() / 5) });
  for (double c : filter->GetOutput()->GetMesh(1)->GetArrays().coefficients)
  {
    EXPECT_NEAR(c, 123.0, 1e-8);
  }
  EXPECT_LT(filter->GetOutput()->GetLevels()[1].densityError, 1e-8);
}

TEST(TetraCollapseFilter, RandomBodiesKeepToRandomBounds)
{
  for (unsigned seed : { 7, 9, 11 })
  {
    EXPECT_EQ(test::CollapseProperty(test::RandomBody(seed), seed).Check(), "") << "seed " << seed;
  }
}

TEST(TetraCollapseFilter, RaisesDegreesWithinTheBoundOnTheDensityError)
{
  auto mesh = Body(4);
  test::SetDensity(mesh, 1, Wavy);
  const auto run = [&](int degree) {
    auto filter = FilterType::New();
    filter->SetInput(AsMesh(mesh));
    filter->SetMaximumDensityErrors({ 3.0 });
    filter->SetMaximumVolumeChange(1.0);
    filter->SetMaximumDegree(degree);
    filter->Update();
    return filter->GetOutput()->GetLevels()[1];
  };
  const auto plain = run(-1), raised = run(3);
  EXPECT_EQ(plain.mesh->GetArrays().maximumDegree, 1);
  const auto level = raised.mesh->GetArrays();
  EXPECT_GT(*std::max_element(level.degree.begin(), level.degree.end()), 1);
  EXPECT_LE(*std::max_element(level.degree.begin(), level.degree.end()), 3);
  EXPECT_EQ(level.coefficients.size(), level.tetrahedra.size() * BernsteinCount(level.maximumDegree));
  EXPECT_LE(raised.densityError, 3.0);
  EXPECT_LT(level.tetrahedra.size(), plain.mesh->GetArrays().tetrahedra.size());
  EXPECT_EQ(plain.stopReason, "density error bound");
}

TEST(TetraCollapseFilter, DensityWeightKeepsPointsWhereTheDensityIsRough)
{
  auto mesh = test::MakeBall(4, { 4 }, 14, 0.15, 3);
  test::SetDensity(mesh, 1, [](const Vector3 & x) {
    return x.x() < 0 ? 0.0 : 300 * std::sin(x.x()) * std::sin(2 * x.y()) * std::sin(3 * x.z());
  });
  const auto run = [&](double weight) {
    auto filter = FilterType::New();
    filter->SetInput(AsMesh(mesh));
    filter->SetLevels({ static_cast<IdType>(mesh.tetrahedra.size() / 4) });
    filter->SetMaximumVolumeChange(1.0);
    filter->SetDensityWeight(weight);
    filter->Update();
    return filter->GetOutput()->GetLevels()[1];
  };
  const auto roughShare = [](const MeshArrays & level) {
    const auto rough =
      std::count_if(level.points.begin(), level.points.end(), [](const Vector3 & x) { return x.x() > 0; });
    return static_cast<double>(rough) / static_cast<double>(level.points.size());
  };
  const auto with = run(30.0), without = run(0.0);
  EXPECT_NEAR(roughShare(without.mesh->GetArrays()), 0.5, 0.1);
  EXPECT_GT(roughShare(with.mesh->GetArrays()), 0.6);
  EXPECT_LT(with.densityError, 0.9 * without.densityError);
}

TEST(TetraCollapseFilter, VolumeWeightKeepsTheVolumesOfRegions)
{
  const auto mesh = Body(2);
  const auto change = [&](double weight) {
    auto filter = FilterType::New();
    filter->SetInput(AsMesh(mesh));
    filter->SetLevels({ static_cast<IdType>(mesh.tetrahedra.size() / 6) });
    filter->SetMaximumVolumeChange(1.0);
    filter->SetVolumeWeight(weight);
    filter->Update();
    const auto level = filter->GetOutput()->GetMesh(1)->GetArrays();
    double     sum = 0.0;
    for (int region = 1; region <= 3; ++region)
    {
      sum += std::abs(test::RegionVolume(level, region) / test::RegionVolume(mesh, region) - 1.0);
    }
    return sum;
  };
  EXPECT_LT(change(200.0), 0.5 * change(0.0));
}

TEST(SurfaceEnvelope, LargestDistanceOfAShiftedBodyIsTheShift)
{
  const auto mesh = test::MakeBall(3, { 1, 2 }, 10, 0.0, 1);
  auto       shifted = mesh;
  for (Vector3 & x : shifted.points)
  {
    x += Vector3(0, 0.7, 0);
  }
  EXPECT_EQ(LargestSurfaceDistance(mesh, mesh, 0.01), 0.0);
  EXPECT_NEAR(LargestSurfaceDistance(mesh, shifted, 0.01), 0.7, 0.011);
  EXPECT_NEAR(LargestSurfaceDistance(shifted, mesh, 0.001), 0.7, 0.0011);
}

TEST(TetraCollapseFilter, SaysWhenNothingMoreIsAllowed)
{
  const auto   filter = Simplified(Body(1), { 1 });
  const auto & level = filter->GetOutput()->GetLevels()[1];
  EXPECT_EQ(level.stopReason, "nothing more allowed");
  EXPECT_TRUE(ValidateMesh(level.mesh->GetArrays()).IsValid());
  std::size_t refused = 0;
  for (std::size_t count : filter->GetReport()[0].refused)
  {
    refused += count;
  }
  EXPECT_GT(refused, 0u);
  EXPECT_GT(filter->GetReport()[0].collapses, 0u);
  auto bounded = FilterType::New();
  bounded->SetInput(AsMesh(Body(1)));
  bounded->SetLevels({ 1 });
  bounded->SetMaximumSurfaceDistances({ 0.05 });
  bounded->Update();
  EXPECT_EQ(bounded->GetOutput()->GetLevels()[1].stopReason, "surface distance bound");
  EXPECT_GT(bounded->GetReport()[0].refused[static_cast<int>(MeshOperation::Distance)], 0u);
}

TEST(TetraCollapseFilter, FlatEndsKeepTheirPlane)
{
  const auto mesh = Body(2);
  const auto filter = Simplified(mesh, { static_cast<IdType>(mesh.tetrahedra.size() / 8) });
  const auto level = filter->GetOutput()->GetMesh(1)->GetArrays();
  const auto area = [](const MeshArrays & m, double z) {
    double sum = 0;
    for (const auto & f : BoundaryFaces(m))
    {
      const Vector3 &a = m.points[f[0]], &b = m.points[f[1]], &c = m.points[f[2]];
      sum += a.z() == z && b.z() == z && c.z() == z ? 0.5 * (b - a).cross(c - a).norm() : 0.0;
    }
    return sum;
  };
  EXPECT_GT(area(mesh, 0.0), 100.0);
  EXPECT_NEAR(area(level, 0.0) / area(mesh, 0.0), 1.0, 0.1);
  EXPECT_NEAR(area(level, 22.0) / area(mesh, 22.0), 1.0, 0.1);
}

TEST(TetraCollapseFilter, HasSameOutputForAnyNumberOfThreads)
{
  auto mesh = Body(2);
  test::SetDensity(mesh, 2, Wavy);
  const auto run = [&](unsigned threads) {
    auto filter = FilterType::New();
    filter->SetInput(AsMesh(mesh));
    filter->SetNumberOfWorkUnits(threads);
    filter->GetMultiThreader()->SetMaximumNumberOfThreads(threads);
    filter->SetLevels({ 800, 300 });
    filter->Update();
    return filter;
  };
  const auto one = run(1), four = run(4);
  for (std::size_t i = 0; i < 3; ++i)
  {
    const auto a = one->GetOutput()->GetMesh(i)->GetArrays(), b = four->GetOutput()->GetMesh(i)->GetArrays();
    EXPECT_EQ(a.points, b.points);
    EXPECT_EQ(a.tetrahedra, b.tetrahedra);
    EXPECT_EQ(a.region, b.region);
    EXPECT_EQ(a.coefficients, b.coefficients);
    EXPECT_EQ(one->GetOutput()->GetLevels()[i].densityError, four->GetOutput()->GetLevels()[i].densityError);
  }
}

TEST(TetraCollapseFilter, RunsAgainOnlyAfterAChange)
{
  auto filter = FilterType::New();
  filter->SetInput(AsMesh(test::MakeBall(3, { 1, 2 }, 10, 0.1, 1)));
  filter->SetLevels({ 500 });
  int  runs = 0;
  auto command = itk::CStyleCommand::New();
  command->SetClientData(&runs);
  command->SetCallback([](itk::Object *, const itk::EventObject &, void * n) { ++*static_cast<int *>(n); });
  filter->AddObserver(itk::StartEvent(), command);
  filter->Update();
  filter->Update();
  filter->GetOutput()->Update();
  EXPECT_EQ(runs, 1);
  filter->SetLevels({ 500 });
  filter->Update();
  EXPECT_EQ(runs, 1);
  filter->SetLevels({ 400 });
  filter->Update();
  EXPECT_EQ(runs, 2);
  filter->SetMinimumDihedralAngle(0.03);
  filter->Update();
  EXPECT_EQ(runs, 3);
}

TEST(TetraCollapseFilter, ProgressRisesAndAnAbortAnywhereLeavesTheFilterReusable)
{
  auto mesh = Body(2);
  test::SetDensity(mesh, 2, Wavy);
  auto filter = FilterType::New();
  filter->SetInput(AsMesh(mesh));
  filter->SetLevels({ 800, 300 });
  filter->SetMaximumDensityErrors({ 20.0 });
  std::vector<float> seen;
  float              stop = 2.0f;
  filter->AddObserver(itk::ProgressEvent(), [&](const itk::EventObject &) {
    seen.push_back(filter->GetProgress());
    filter->SetAbortGenerateData(seen.back() >= stop);
  });
  filter->Update();
  EXPECT_TRUE(std::is_sorted(seen.begin(), seen.end()));
  EXPECT_GT(seen.size(), 20u);
  EXPECT_EQ(seen.back(), 1.0f);
  const auto whole = filter->GetOutput()->GetMesh(2)->GetArrays();
  for (const float at : { 0.01f, 0.2f, 0.5f, 0.9f })
  {
    filter->Modified();
    stop = at;
    EXPECT_THROW(filter->Update(), itk::ProcessAborted) << "at " << at;
    stop = 2.0f;
    filter->Update();
    const auto again = filter->GetOutput()->GetMesh(2)->GetArrays();
    EXPECT_EQ(again.tetrahedra, whole.tetrahedra);
    EXPECT_EQ(again.coefficients, whole.coefficients);
  }
}

TEST(TetraCollapseFilter, RefusesBadInputsAndParameters)
{
  const auto good = AsMesh(test::MakeBall(2, { 1, 1 }, 10, 0.1, 1));
  const auto refuses = [&](auto set, const char * word) {
    auto filter = FilterType::New();
    filter->SetInput(good);
    filter->SetLevels({ 50 });
    set(filter.GetPointer());
    try
    {
      filter->Update();
      ADD_FAILURE() << "no exception about " << word;
    }
    catch (const itk::ExceptionObject & error)
    {
      EXPECT_THAT(std::string(error.GetDescription()), testing::HasSubstr(word));
    }
  };
  refuses([](FilterType * f) { f->SetInput(nullptr); }, "Mesh");
  refuses([](FilterType * f) { f->SetInput(MeshType::New()); }, "no tetrahedra");
  refuses([](FilterType * f) { f->SetLevels({}); }, "No levels");
  refuses([](FilterType * f) { f->SetLevels({ 10, 20 }); }, "ascend");
  refuses([](FilterType * f) { f->SetLevels({ 0 }); }, "Levels is 0");
  refuses([](FilterType * f) { f->SetMaximumDensityErrors({ -1.0 }); }, "MaximumDensityErrors is -1");
  refuses([](FilterType * f) { f->SetMaximumDensityErrors({ std::nan("") }); }, "MaximumDensityErrors is nan");
  refuses([](FilterType * f) { f->SetMaximumDensityErrors({ 5.0 }); }, "no density");
  refuses([](FilterType * f) { f->SetMaximumCellErrors({ 5.0 }); }, "no density");
  refuses([](FilterType * f) { f->SetMaximumCellErrors({ 5.0, 4.0 }); }, "MaximumCellErrors are 5 4");
  refuses(
    [](FilterType * f) {
      f->SetImproveAngles(true);
      f->SetMaximumCellErrors({ 1.0 });
    },
    "which MaximumCellErrors bounds");
  refuses([](FilterType * f) { f->SetMaximumSurfaceDistances({ 2.0, 1.0 }); }, "MaximumSurfaceDistances are 2 1");
  refuses(
    [](FilterType * f) {
      f->SetImproveAngles(true);
      f->SetMaximumSurfaceDistances({ 1.0 });
    },
    "ImproveAngles moves surfaces");
  refuses([](FilterType * f) { f->SetWantedDihedralAngle(2); }, "WantedDihedralAngle");
  refuses([](FilterType * f) { f->SetWantedCorticalDihedralAngle(-1); }, "WantedCorticalDihedralAngle");
  refuses([](FilterType * f) { f->SetMaximumVolumeChange(-1); }, "MaximumVolumeChange");
  refuses([](FilterType * f) { f->SetMinimumDihedralAngle(2); }, "MinimumDihedralAngle");
  refuses([](FilterType * f) { f->SetMinimumCorticalDihedralAngle(-1); }, "MinimumCorticalDihedralAngle");
  refuses([](FilterType * f) { f->SetMaximumDegree(9); }, "MaximumDegree");
  refuses([](FilterType * f) { f->SetVolumeWeight(-1); }, "VolumeWeight");
  auto inverted = test::MakeBall(2, { 1, 1 }, 10, 0.1, 1);
  std::swap(inverted.tetrahedra[0][0], inverted.tetrahedra[0][1]);
  inverted.neighbors = ComputeFaceNeighbors(inverted.tetrahedra);
  refuses([&](FilterType * f) { f->SetInput(AsMesh(inverted)); }, "orientation");
}

TEST(TetraCollapseFilter, MeshWithoutRegionsOrDensityWorks)
{
  auto mesh = test::MakeBall(4, { 4 }, 10, 0.15, 2);
  mesh.region.clear();
  mesh.layer.clear();
  mesh.slice.clear();
  const auto filter = Simplified(mesh, { 600 });
  const auto level = filter->GetOutput()->GetMesh(1)->GetArrays();
  EXPECT_TRUE(ValidateMesh(level).IsValid()) << ValidateMesh(level).Summary();
  EXPECT_LE(level.tetrahedra.size(), 600u);
  EXPECT_FALSE(level.HasDensity());
  EXPECT_TRUE(level.region.empty());
}

TEST(TetraCollapseFilter, FloatMeshWorks)
{
  using FloatMesh = DensityMesh<float>;
  auto mesh = FloatMesh::New();
  mesh->SetArrays(test::MakeBall(4, { 1, 3 }, 10, 0.15, 2));
  auto filter = TetraCollapseFilter<FloatMesh>::New();
  filter->SetInput(mesh);
  filter->SetLevels({ 800 });
  filter->Update();
  EXPECT_TRUE(ValidateMesh(filter->GetOutput()->GetMesh(1)->GetArrays()).IsValid());
}
} // namespace TetraCollapseFilterTests
