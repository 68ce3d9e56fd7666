/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneAngleImprovement.h"

#include "boneCollapseProperty.h"
#include "boneDensitySamples.h"
#include "boneMeshValidator.h"
#include "boneQualityMeasures.h"
#include "boneSurfaceGrid.h"
#include "boneSurfaceSamples.h"
#include "boneTetraCollapseFilter.h"
#include "boneTriangleTree.h"

#include <itkMultiThreaderBase.h>

#include <gtest/gtest.h>

using namespace bone;

namespace
{
using MeshType = DensityMesh<double>;
using FilterType = TetraCollapseFilter<MeshType>;

double
Wavy(const Vector3 & x)
{
  return 500 + 300 * std::sin(x.x() / 9) * std::cos(x.y() / 7) * std::sin(x.z() / 11);
}

MeshArrays
Body(unsigned seed)
{
  test::TubeShape shape;
  shape.seed = seed;
  shape.bumps = 0.2;
  shape.slices = 20;
  shape.around = 20;
  shape.spacing = 1.5;
  shape.rings = seed % 2 == 0 ? std::vector<int>{ 1, 1, 2 } : std::vector<int>{ 2, 2, 1 };
  MeshArrays mesh = test::MakeTube(shape);
  test::SetDensity(mesh, 1, Wavy);
  return mesh;
}

FilterType::Pointer
Simplified(const MeshArrays & mesh, bool improve, double volumeChange = 0.03, unsigned threads = 2)
{
  auto input = MeshType::New();
  input->SetArrays(mesh);
  const auto n = static_cast<IdType>(mesh.tetrahedra.size());
  auto       filter = FilterType::New();
  filter->SetInput(input);
  filter->SetLevels({ n / 5, n / 13 });
  filter->SetMaximumVolumeChange(volumeChange);
  filter->SetImproveAngles(improve);
  filter->SetNumberOfWorkUnits(threads);
  filter->GetMultiThreader()->SetMaximumNumberOfThreads(threads);
  filter->Update();
  return filter;
}

std::size_t
CountBelow(const MeshArrays & mesh, const AngleFloors & floors)
{
  return floors.CountBelow(TetraComplex(mesh));
}

AngleFloors
Wanted()
{
  const TetraCollapseParameters parameters;
  return { parameters.wantedCorticalDihedralAngle, parameters.wantedDihedralAngle };
}
} // namespace

TEST(AngleImprovement, LevelsHaveTheWantedAnglesAndStayValid)
{
  std::size_t before = 0, after = 0;
  for (unsigned seed = 1; seed <= 3; ++seed)
  {
    const MeshArrays mesh = Body(seed);
    const auto       plain = Simplified(mesh, false), improved = Simplified(mesh, true);
    for (int i = 1; i <= 2; ++i)
    {
      const auto & built = improved->GetOutput()->GetLevels()[i];
      const auto   level = built.mesh->GetArrays();
      const auto   validation = ValidateMesh(level);
      EXPECT_TRUE(validation.IsValid()) << "seed " << seed << ": " << validation.Summary();
      EXPECT_EQ(validation.boundaryEuler, ValidateMesh(mesh).boundaryEuler);
      EXPECT_TRUE(FindCrossingTriangles(BoundaryFaces(level), level.points).empty());
      for (int region = 1; region <= 3; ++region)
      {
        EXPECT_NEAR(test::RegionVolume(level, region) / test::RegionVolume(mesh, region), 1.0, 0.03 + 1e-12);
      }
      before += CountBelow(plain->GetOutput()->GetMesh(i)->GetArrays(), Wanted());
      after += CountBelow(level, Wanted());
    }
  }
  EXPECT_GT(before, 20u);
  EXPECT_LT(10 * after, before) << before;
}

TEST(AngleImprovement, PointsMoveAndStayNearTheFinestSurface)
{
  std::size_t moved = 0, count = 0;
  double      sum = 0.0;
  for (unsigned seed = 1; seed <= 3; ++seed)
  {
    const MeshArrays mesh = Body(seed), level = Simplified(mesh, true)->GetOutput()->GetMesh(2)->GetArrays();
    std::vector<TriangleTree::Triangle> triangles;
    std::set<std::array<double, 3>>     places;
    for (const auto & f : BoundaryFaces(mesh))
    {
      triangles.push_back({ mesh.points[f[0]], mesh.points[f[1]], mesh.points[f[2]] });
    }
    for (const Vector3 & x : mesh.points)
    {
      places.insert({ x[0], x[1], x[2] });
    }
    const TriangleTree tree(triangles);
    for (const auto & f : BoundaryFaces(level))
    {
      const Vector3 & x = level.points[f[0]];
      moved += places.count({ x[0], x[1], x[2] }) == 0 ? 1 : 0;
      sum += std::sqrt(tree.FindNearest(x).squaredDistance);
      ++count;
    }
  }
  EXPECT_GT(moved, 0u);
  EXPECT_LT(sum / static_cast<double>(count), 0.05); // edges are some 5 mm long
}

TEST(AngleImprovement, ATightBoundOnVolumesComesFirst)
{
  for (unsigned seed = 1; seed <= 2; ++seed)
  {
    const MeshArrays mesh = Body(seed), level = Simplified(mesh, true, 0.004)->GetOutput()->GetMesh(2)->GetArrays();
    for (int region = 1; region <= 3; ++region)
    {
      EXPECT_NEAR(test::RegionVolume(level, region) / test::RegionVolume(mesh, region), 1.0, 0.004 + 1e-12);
    }
  }
}

TEST(AngleImprovement, DoesNothingWhereAllIsWell)
{
  const MeshArrays       mesh = Body(1);
  TetraComplex           complex(mesh);
  const AngleImprovement improvement(complex);
  const auto             clock = complex.Clock();
  EXPECT_FALSE(improvement.Run(complex, { { 0.0, 0.0 }, 0.03, 0 }, Execution()));
  EXPECT_EQ(complex.Clock(), clock);
}

TEST(AngleImprovement, TheSameForAnyNumberOfThreads)
{
  const MeshArrays mesh = Body(2);
  const auto       one = Simplified(mesh, true, 0.03, 1), four = Simplified(mesh, true, 0.03, 4);
  for (int i = 1; i <= 2; ++i)
  {
    const auto a = one->GetOutput()->GetMesh(i)->GetArrays(), b = four->GetOutput()->GetMesh(i)->GetArrays();
    EXPECT_EQ(a.points, b.points);
    EXPECT_EQ(a.tetrahedra, b.tetrahedra);
    EXPECT_EQ(a.coefficients, b.coefficients);
  }
}

TEST(AngleImprovement, SamplesAreGivenToTheCellsThatCoverThem)
{
  const MeshArrays mesh = Body(3);
  TetraComplex     complex(mesh);
  DensitySamples   samples(mesh);
  for (IdType p = 0; p < static_cast<IdType>(complex.Points().size()); ++p)
  {
    if (complex.Dimension(p) == 3)
    {
      const IdType q = complex.PointNeighbors(p).front();
      complex.MovePoint(p, 0.9 * complex.Points()[p] + 0.1 * complex.Points()[q]);
    }
  }
  samples.Distribute(complex, Execution());
  std::size_t count = 0;
  for (IdType t = 0; t < complex.Size(); ++t)
  {
    const Id4 &  c = complex.Cell(t);
    const auto & p = complex.Points();
    for (const int s : samples.InCell(t))
    {
      const Barycentric mu = BarycentricCoordinates(samples.All()[s].x, p[c[0]], p[c[1]], p[c[2]], p[c[3]]);
      EXPECT_GT(mu.minCoeff(), -1e-9);
      ++count;
    }
  }
  EXPECT_EQ(count, samples.All().size());
  EXPECT_EQ(count, DensitySamples::SamplesPerCell * mesh.tetrahedra.size());
}

TEST(AngleImprovement, RemovedSurfacePointsKeepTheirDistances)
{
  const MeshArrays mesh = Body(2);
  TetraComplex     complex(mesh);
  SurfaceSamples   samples(complex);
  IdType           v = 0;
  while (complex.Dimension(v) != 2)
  {
    ++v;
  }
  std::vector<TetraComplex::SurfaceFace> faces;
  complex.SurfaceStar(v, faces);
  IdType w = -1;
  for (const auto & face : faces)
  {
    w = w < 0 && complex.CanCollapse(v, face.a) == MeshOperation::Done ? face.a : w;
  }
  ASSERT_GE(w, 0);
  const auto taken = samples.TakeFrom(complex, complex.Star(v), v);
  complex.Collapse(v, w);
  samples.GiveTo(complex, taken, complex.Star(w));
  const auto costs = [&] {
    std::vector<double> all;
    for (const IdType u : complex.PointNeighbors(w))
    {
      all.push_back(samples.CollapseCost(complex, u, w).integral);
    }
    return all;
  };
  const auto before = costs();
  samples.Distribute(complex);
  const auto after = costs();
  double     largest = 0.0;
  for (std::size_t i = 0; i < before.size(); ++i)
  {
    EXPECT_NEAR(after[i], before[i], 1e-9 * (1.0 + std::abs(before[i])));
    largest = std::max(largest, std::abs(before[i]));
  }
  EXPECT_GT(largest, 0.0);
  complex.MovePoint(w, complex.Points()[w] + Vector3(0.0, 0.0, 0.5));
  samples.Distribute(complex);
  EXPECT_NE(costs(), after);
}
