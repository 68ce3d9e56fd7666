/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneAngleImprovement.h"

#include "boneCollapseProperty.h"
#include "boneDensitySamples.h"
#include "boneMeshValidator.h"
#include "bonePointMover.h"
#include "boneQualityMeasures.h"
#include "boneSurfaceGrid.h"
#include "boneSurfaceSamples.h"
#include "boneTetraCollapseFilter.h"

#include <itkMultiThreaderBase.h>

#include <gtest/gtest.h>

using namespace bone;

namespace AngleImprovementTests
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

/** The same with a cortical layer of a fifth of its thickness: thin under its triangles. */
MeshArrays
ThinBody(unsigned seed)
{
  MeshArrays           mesh = Body(seed);
  const TetraComplex   complex(mesh);
  std::vector<Vector3> points = mesh.points;
  for (IdType p = 0; p < static_cast<IdType>(points.size()); ++p)
  {
    Vector3 sum = Vector3::Zero();
    int     count = 0;
    for (const IdType q : complex.PointNeighbors(p))
    {
      if (mesh.layer[q] == 0)
      {
        sum += mesh.points[q];
        ++count;
      }
    }
    if (mesh.layer[p] == 1 && complex.Dimension(p) == 2 && count > 0)
    {
      points[p] = 0.2 * mesh.points[p] + 0.8 * sum / count;
    }
  }
  mesh.points = points;
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
  return floors.FindBelow(TetraComplex(mesh)).size();
}

AngleFloors
Wanted()
{
  const TetraCollapseParameters parameters;
  return { parameters.wantedCorticalDihedralAngle, parameters.wantedDihedralAngle };
}

AngleGoal
GoalOf(const AngleFloors & floors, IdType minimumCells)
{
  AngleGoal goal;
  goal.floors = floors;
  goal.volumeChange = 0.03;
  goal.minimumCells = minimumCells;
  return goal;
}

TEST(AngleImprovement, LevelsHaveTheWantedAnglesAndStayValid)
{
  std::size_t before = 0, after = 0;
  for (unsigned seed = 1; seed <= 3; seed += 2)
  {
    const MeshArrays mesh = ThinBody(seed);
    ASSERT_EQ(CountInverted(mesh), 0u);
    const auto plain = Simplified(mesh, false), improved = Simplified(mesh, true);
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
      const IdType asked = static_cast<IdType>(mesh.tetrahedra.size()) / (i == 1 ? 5 : 13);
      EXPECT_LE(built.mesh->GetNumberOfTetrahedra(), asked);
      EXPECT_GE(built.mesh->GetNumberOfTetrahedra(), asked - 12);
      before += CountBelow(plain->GetOutput()->GetMesh(i)->GetArrays(), Wanted());
      const auto mean = [](const MeshArrays & m) {
        return SummarizeQuality(m, QualityMeasure::MinimumDihedralAngle).mean;
      };
      EXPECT_GT(mean(level), 1.05 * mean(plain->GetOutput()->GetMesh(i)->GetArrays()));
      after += CountBelow(level, Wanted());
    }
  }
  EXPECT_GT(before, 20u);
  EXPECT_LT(10 * after, before) << before;
}

/** The longest edge, in edges of equilateral tetrahedra that fill the mesh in its number. */
double
LongestEdge(const MeshArrays & mesh)
{
  double volume = 0.0, longest = 0.0;
  for (const Id4 & c : mesh.tetrahedra)
  {
    volume += SignedVolume(mesh.points[c[0]], mesh.points[c[1]], mesh.points[c[2]], mesh.points[c[3]]);
    for (const auto & edge : TetraEdges)
    {
      longest = std::max(longest, (mesh.points[c[edge[0]]] - mesh.points[c[edge[1]]]).norm());
    }
  }
  return longest / std::cbrt(6.0 * std::sqrt(2.0) * volume / static_cast<double>(mesh.tetrahedra.size()));
}

TEST(AngleImprovement, LongCellsAreAvoidedWhereNothingElseHoldsThemBack)
{
  test::TubeShape shape; // a straight shaft of one density
  shape.slices = 60;
  shape.around = 16;
  shape.rings = { 1, 1, 1 };
  MeshArrays mesh = test::MakeTube(shape);
  test::SetDensity(mesh, 0, [](const Vector3 &) { return 700.0; });
  const auto plain = Simplified(mesh, false), improved = Simplified(mesh, true);
  for (int i = 1; i <= 2; ++i)
  {
    const double before = LongestEdge(plain->GetOutput()->GetMesh(i)->GetArrays());
    const double after = LongestEdge(improved->GetOutput()->GetMesh(i)->GetArrays());
    EXPECT_GT(before, 1.15 * after) << after << " at level " << i + 1;
  }
}

TEST(AngleImprovement, PointsThatWereDrawnTogetherMoveApartAlongTheFinestSurface)
{
  const MeshArrays                       mesh = Body(1);
  TetraComplex                           complex(mesh);
  const AngleImprovement                 improvement(complex);
  const SurfaceTarget                    first(complex, 0.0, 0);
  PointMover                             mover(complex);
  std::vector<IdType>                    drawn;
  std::vector<TetraComplex::SurfaceFace> faces;
  for (IdType p = 0; p < static_cast<IdType>(complex.Points().size()); p += 7)
  {
    complex.SurfaceStar(p, faces);
    if (complex.Dimension(p) == 2 &&
        mover.TryMove(p, 0.1 * complex.Points()[p] + 0.9 * complex.Points()[faces[0].a], 1.0) == MeshOperation::Done)
    {
      drawn.push_back(p);
    }
  }
  ASSERT_GT(drawn.size(), 20u);
  const std::size_t          below = Wanted().FindBelow(complex).size();
  const std::vector<Vector3> before = complex.Points();
  EXPECT_GT(below, 50u);
  EXPECT_TRUE(improvement.Run(complex, GoalOf(Wanted(), complex.AliveCells()), Execution()));
  EXPECT_LT(5 * Wanted().FindBelow(complex).size(), below);
  std::size_t moved = 0;
  double      farthest = 0.0;
  for (const IdType p : drawn)
  {
    const Vector3 & x = complex.Points()[p];
    if (!complex.Star(p).empty() && x != before[p])
    {
      ++moved;
      farthest = std::max(farthest, (first.Project(complex, p, x) - x).norm());
    }
  }
  EXPECT_GT(moved, 5u);
  EXPECT_LT(farthest, 0.6); // chords of an edge are some 3 mm long
}

TEST(AngleImprovement, BoundsOnVolumesComeFirst)
{
  const MeshArrays mesh = ThinBody(2);
  for (const double bound : { 0.03, 0.006 })
  {
    const auto filter = Simplified(mesh, true, bound);
    for (int i = 1; i <= 2; ++i)
    {
      const MeshArrays level = filter->GetOutput()->GetMesh(i)->GetArrays();
      // The bound ends collapses at first, until regions have their volumes again.
      EXPECT_EQ(filter->GetOutput()->GetLevels()[i].stopReason, "tetrahedra reached") << level.tetrahedra.size();
      for (int region = 1; region <= 3; ++region)
      {
        EXPECT_NEAR(test::RegionVolume(level, region) / test::RegionVolume(mesh, region), 1.0, bound + 1e-12);
      }
    }
  }
}

TEST(AngleImprovement, ARunThatTakesVolumesBeyondTheirBoundIsTakenBack)
{
  const MeshArrays       mesh = ThinBody(1);
  TetraComplex           complex(mesh);
  const AngleImprovement improvement(complex);
  AngleGoal              goal = GoalOf({ 0.3, 0.3 }, complex.AliveCells());
  goal.volumeChange = 1e-9;
  EXPECT_FALSE(improvement.Run(complex, goal, Execution()));
  EXPECT_EQ(complex.Points(), mesh.points);
  EXPECT_EQ(complex.AliveCells(), static_cast<IdType>(mesh.tetrahedra.size()));
}

TEST(AngleImprovement, VolumesStayFarWithinTheirBound)
{
  const MeshArrays       mesh = ThinBody(1);
  TetraComplex           complex(mesh);
  const AngleImprovement improvement(complex);
  const RegionVolumes    volumes(complex);
  const AngleFloors      floors{ 0.3, 0.3 };
  const IdType           cells = complex.AliveCells();
  EXPECT_TRUE(improvement.Run(complex, GoalOf(floors, cells), Execution()));
  EXPECT_LT(volumes.LargestChangeTo(complex), 0.0035);
  EXPECT_GE(complex.AliveCells(), cells);
}

TEST(AngleImprovement, FloorsOfCollapsesAreWantedToo)
{
  for (const unsigned seed : { 76, 128, 149 }) // whose floors are higher than the angles wanted
  {
    test::CollapseProperty property(test::RandomBody(seed), seed);
    EXPECT_EQ(property.Check(), "") << "seed " << seed;
  }
}

TEST(AngleImprovement, ALinearDensityIsKept)
{
  MeshArrays mesh = ThinBody(3);
  test::SetDensity(mesh, 1, [](const Vector3 & x) { return 300 + 7 * x.x() - 3 * x.y() + 2 * x.z(); });
  const auto filter = Simplified(mesh, true);
  for (int i = 1; i <= 2; ++i)
  {
    // But beyond the level before, where it ends with its surface.
    EXPECT_LT(filter->GetOutput()->GetLevels()[i].densityError, 0.3) << "of some 200";
  }
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
} // namespace AngleImprovementTests
