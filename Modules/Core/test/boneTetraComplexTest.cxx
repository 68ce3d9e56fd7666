/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneTetraComplex.h"

#include "boneMeshValidator.h"
#include "boneQualityMeasures.h"
#include "boneTestBodies.h"
#include "boneTetraFlips.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <set>

using namespace bone;

namespace TetraComplexTests
{
std::array<int, 4>
CountDimensions(const SurfaceComplex & complex)
{
  std::array<int, 4> count{};
  for (int d : complex.dimension)
  {
    ++count[d];
  }
  return count;
}

MeshArrays
Compacted(const TetraComplex & complex, const MeshArrays & source)
{
  std::vector<IdType> points, cells;
  return complex.Compact(source, points, cells);
}

/** Two tetrahedra on one triangle, the apices on the axis. */
MeshArrays
Bipyramid(double lower, double upper)
{
  MeshArrays mesh;
  mesh.points = { { 1, 0, 0 }, { -0.5, 0.9, 0 }, { -0.5, -0.9, 0 }, { 0, 0, -lower }, { 0, 0, upper } };
  mesh.tetrahedra = { { 0, 1, 2, 4 }, { 0, 2, 1, 3 } };
  mesh.region = { 1, 1 };
  test::MakePositive(mesh);
  return mesh;
}

TEST(TetraComplex, HasTheBoundaryOfItsMesh)
{
  const MeshArrays mesh = test::MakeTube({});
  auto             expected = BoundaryFaces(mesh), found = BoundaryFaces(TetraComplex(mesh));
  for (auto * faces : { &expected, &found })
  {
    for (auto & face : *faces)
    {
      std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
    }
    std::sort(faces->begin(), faces->end());
  }
  EXPECT_EQ(found, expected);
}

TEST(SurfaceComplex, RodHasFlatEndsWithRimsAndLayers)
{
  test::TubeShape shape;
  const auto      mesh = test::MakeTube(shape);
  const auto      complex = FindSurfaces(mesh);
  // Boundary, two interfaces, and each end cut in three.
  EXPECT_EQ(complex.surfaces.size(), 9u);
  const auto count = CountDimensions(complex);
  EXPECT_EQ(count[0], 0);
  EXPECT_EQ(count[1], 2 * 3 * shape.around) << "the rim and two interface curves at each end";
  for (std::size_t p = 0; p < mesh.points.size(); ++p)
  {
    const bool end = mesh.slice[p] == 0 || mesh.slice[p] == shape.slices - 1;
    EXPECT_EQ(complex.curve[p].size(), complex.dimension[p] == 1 ? 2u : 0u);
    EXPECT_TRUE(end || complex.dimension[p] >= 2);
  }
}

TEST(SurfaceComplex, BallAndRingHaveNoCurves)
{
  test::TubeShape ring;
  ring.closed = true;
  ring.slices = 40;
  ring.spacing = 4;
  for (const auto & mesh : { test::MakeBall(4, { 1, 2 }, 12, 0.1, 2), test::MakeTube(ring) })
  {
    const auto count = CountDimensions(FindSurfaces(mesh));
    EXPECT_EQ(count[0], 0);
    EXPECT_EQ(count[1], 0);
    EXPECT_GT(count[2], 0);
    EXPECT_GT(count[3], 0);
  }
}

TEST(SurfaceComplex, NeedsNeighbors)
{
  auto mesh = test::MakeBall(1, { 1 }, 10, 0, 1);
  mesh.neighbors.clear();
  EXPECT_THROW(FindSurfaces(mesh), std::invalid_argument);
}

TEST(TetraFlips, TwoThreeFlipIsMadeWhereItHelpsAndNotElsewhere)
{
  const auto flipAt = [](TetraComplex & complex) {
    std::vector<MeshOperation> outcomes;
    for (int i = 0; i < 4; ++i)
    {
      const bool inner = complex.Neighbors(0)[i] >= 0;
      const auto outcome = RemoveFace(complex, 0, i).outcome;
      if (inner)
      {
        outcomes.push_back(outcome);
        break;
      }
      EXPECT_EQ(outcome, MeshOperation::Surface);
    }
    return outcomes;
  };
  TetraComplex tall(Bipyramid(6.0, 6.0));
  EXPECT_THAT(flipAt(tall), testing::ElementsAre(MeshOperation::Quality)) << "three cells would be worse";
  EXPECT_EQ(tall.AliveCells(), 2);

  const auto   flat = Bipyramid(0.2, 0.2);
  TetraComplex complex(flat);
  const double volume = test::RegionVolume(flat, 1);
  EXPECT_THAT(flipAt(complex), testing::ElementsAre(MeshOperation::Done));
  EXPECT_EQ(complex.AliveCells(), 3);
  const auto made = Compacted(complex, flat);
  EXPECT_NEAR(test::RegionVolume(made, 1), volume, 1e-12);
  EXPECT_TRUE(ValidateMesh(made).IsValid()) << ValidateMesh(made).Summary();
}

TEST(TetraFlips, ThreeTwoFlipUndoesAThinFan)
{
  // Three cells around a long axis: two on the triangle are better.
  MeshArrays fan = Bipyramid(6.0, 6.0);
  fan.tetrahedra = { { 0, 1, 3, 4 }, { 1, 2, 3, 4 }, { 2, 0, 3, 4 } };
  fan.region = { 1, 1, 1 };
  test::MakePositive(fan);
  TetraComplex complex(fan);
  const double volume = test::RegionVolume(fan, 1);
  const auto   result = RemoveEdge(complex, 3, 4);
  ASSERT_EQ(result.outcome, MeshOperation::Done);
  EXPECT_EQ(complex.AliveCells(), 2);
  const auto made = Compacted(complex, fan);
  EXPECT_NEAR(test::RegionVolume(made, 1), volume, 1e-12);
  EXPECT_TRUE(ValidateMesh(made).IsValid()) << ValidateMesh(made).Summary();
  EXPECT_EQ(RemoveEdge(complex, 0, 1).outcome, MeshOperation::Surface) << "an edge of the boundary";
}

TEST(TetraFlips, NoFlipCrossesAnInterface)
{
  MeshArrays fan = Bipyramid(6.0, 6.0);
  fan.tetrahedra = { { 0, 1, 3, 4 }, { 1, 2, 3, 4 }, { 2, 0, 3, 4 } };
  fan.region = { 1, 1, 2 };
  test::MakePositive(fan);
  TetraComplex complex(fan);
  EXPECT_EQ(RemoveEdge(complex, 3, 4).outcome, MeshOperation::Surface);
  EXPECT_EQ(complex.AliveCells(), 3);
}

TEST(TetraFlips, KeepMeshValidRegionsAndRaiseTheWorstAngle)
{
  for (unsigned seed = 1; seed <= 6; ++seed)
  {
    test::TubeShape shape;
    shape.seed = seed;
    shape.closed = seed % 2 == 0;
    shape.slices = shape.closed ? 30 : 10;
    shape.spacing = shape.closed ? 5 : 2;
    const auto        mesh = test::MakeTube(shape);
    TetraComplex      complex(mesh);
    std::vector<char> changed(complex.Size(), 0);
    double            before = -1, after = -1;
    for (IdType t = 0; t < complex.Size(); ++t)
    {
      before = std::max(before, CellCosine(complex, t));
    }
    const auto count = seed == 3 ? FlipCellCount::NotMore : seed == 5 ? FlipCellCount::Same : FlipCellCount::Any;
    const auto report = ImproveByFlips(complex, { 0.5, 4, count }, [&](const FlipResult & flip) {
      changed.resize(complex.Size(), 0);
      for (IdType t : flip.created)
      {
        changed[t] = 1;
      }
    });
    EXPECT_GT(report.done, 0u);
    const auto made = Compacted(complex, mesh);
    const auto validation = ValidateMesh(made);
    EXPECT_TRUE(validation.IsValid()) << "seed " << seed << ": " << validation.Summary();
    EXPECT_EQ(made.neighbors, ComputeFaceNeighbors(made.tetrahedra));
    for (IdType t = 0; t < complex.Size(); ++t)
    {
      after = complex.IsAlive(t) ? std::max(after, CellCosine(complex, t)) : after;
      if (t < static_cast<IdType>(mesh.tetrahedra.size()) && complex.IsAlive(t) && !changed[t])
      {
        EXPECT_EQ(complex.Cell(t), mesh.tetrahedra[t]);
      }
    }
    EXPECT_LE(after, before);
    EXPECT_TRUE(seed != 3 || made.tetrahedra.size() <= mesh.tetrahedra.size());
    EXPECT_TRUE(seed != 5 || made.tetrahedra.size() == mesh.tetrahedra.size());
    for (int region = 1; region <= 3; ++region)
    {
      EXPECT_NEAR(
        test::RegionVolume(made, region), test::RegionVolume(mesh, region), 1e-9 * test::RegionVolume(mesh, region));
    }
    EXPECT_EQ(BoundaryFaces(made).size(), BoundaryFaces(mesh).size());
    EXPECT_EQ(BoundaryFaces(made, 2).size(), BoundaryFaces(mesh, 2).size());
  }
}

TEST(TetraFlips, MemoryOmitsWhatWouldBeRefusedAgainAndNothingElse)
{
  for (unsigned seed = 1; seed <= 4; ++seed)
  {
    const auto   mesh = test::MakeBall(4, { 1, 1, 2 }, 12, 0.2, seed);
    TetraComplex complex(mesh);
    FlipMemory   memory;
    const auto   tries = [](const FlipReport & report) {
      return report.done + std::accumulate(std::begin(report.refused), std::end(report.refused), std::size_t(0));
    };
    FlipParameters flips;
    flips.targetAngle = 0.6;
    flips.maximumPasses = 100;
    EXPECT_GT(ImproveByFlips(complex, flips, {}, &memory).done, 0u);
    EXPECT_EQ(tries(ImproveByFlips(complex, flips, {}, &memory)), 0u) << "nothing has changed";

    // Points that move change what flips can do around them, and there alone.
    for (IdType p = 0; p < static_cast<IdType>(mesh.points.size()); p += 7)
    {
      const Vector3 x = complex.Points()[p];
      const auto &  star = complex.Star(p);
      complex.TryPoint(p, x + Vector3(0.6, -0.4, 0.5));
      const bool valid =
        complex.Dimension(p) == 3 && std::all_of(star.begin(), star.end(), [&](IdType t) {
          const Id4 & c = complex.Cell(t);
          return SignedVolume(
                   complex.Points()[c[0]], complex.Points()[c[1]], complex.Points()[c[2]], complex.Points()[c[3]]) > 0;
        });
      complex.MovePoint(p, valid ? complex.Points()[p] : x);
    }
    TetraComplex other = complex;
    const auto   known = ImproveByFlips(complex, flips, {}, &memory), fresh = ImproveByFlips(other, flips);
    EXPECT_GT(known.done, 0u);
    EXPECT_LT(tries(known), tries(fresh));
    EXPECT_EQ(ImproveByFlips(complex, flips).done, 0u) << "seed " << seed << ": some flips were forgotten";
  }
}

TEST(TetraFlips, SurfaceFlipsMayLowerAnglesThatStayLargeEnough)
{
  const TetraComplex complex(test::MakeBall(3, { 1, 1, 2 }, 10, 0.1, 1));
  const double       enough = std::cos(0.2);
  std::size_t        better = 0, good = 0;
  for (IdType a = 0; a < static_cast<IdType>(complex.Points().size()); ++a)
  {
    for (IdType b : complex.PointNeighbors(a))
    {
      better += PlanSurfaceFlip(complex, a, b).outcome == MeshOperation::Done;
      const SurfaceFlip plan = PlanSurfaceFlip(complex, a, b, enough);
      good += plan.outcome == MeshOperation::Done;
      double before = -1.0;
      for (IdType t : plan.removed)
      {
        before = std::max(before, CellCosine(complex, t));
      }
      for (std::size_t i = 0; plan.outcome == MeshOperation::Done && i < plan.created.size(); ++i)
      {
        const auto & p = complex.Points();
        const Id4 &  c = plan.created[i];
        EXPECT_LT(LargestDihedralCosine(p[c[0]], p[c[1]], p[c[2]], p[c[3]]), std::max(enough, before));
      }
    }
  }
  EXPECT_GT(good, better + 10);
}

TEST(TetraFlips, SurfaceFlipsKeepMeshValidAndNeverLowerTheWorstAngle)
{
  std::size_t boundary = 0, interfaces = 0;
  for (unsigned seed = 1; seed <= 3; ++seed)
  {
    const auto   mesh = test::MakeBall(3, { 1, 1, 2 }, 10, 0.15, seed);
    TetraComplex complex(mesh);
    for (IdType a = 0; a < static_cast<IdType>(mesh.points.size()); ++a)
    {
      for (IdType b : complex.PointNeighbors(a))
      {
        const SurfaceFlip plan = a < b ? PlanSurfaceFlip(complex, a, b) : SurfaceFlip();
        if (plan.outcome != MeshOperation::Done)
        {
          continue;
        }
        double before = -1.0, after = -1.0;
        for (IdType t : plan.removed)
        {
          before = std::max(before, CellCosine(complex, t));
        }
        for (IdType t : complex.ReplaceAcross(plan.removed, plan.created, plan.regions, plan.surface))
        {
          after = std::max(after, CellCosine(complex, t));
        }
        EXPECT_LT(after, before);
        EXPECT_TRUE(complex.EdgeStar(a, b).empty());
        EXPECT_FALSE(complex.EdgeStar(plan.corners[0], plan.corners[1]).empty());
        (complex.Surfaces().surfaces[plan.surface].IsBoundary() ? boundary : interfaces) += 1;
      }
    }
    const auto made = Compacted(complex, mesh);
    EXPECT_TRUE(ValidateMesh(made).IsValid()) << ValidateMesh(made).Summary();
    EXPECT_EQ(made.neighbors, ComputeFaceNeighbors(made.tetrahedra));
    for (int region = 0; region <= 2; ++region)
    {
      EXPECT_EQ(BoundaryFaces(made, region).size(), BoundaryFaces(mesh, region).size());
    }
  }
  EXPECT_GT(boundary, 0u);
  EXPECT_GT(interfaces, 0u);
}

TEST(TetraComplex, KnowsWhereCellsHaveChanged)
{
  TetraComplex complex(test::MakeBall(3, { 1, 1, 2 }, 10, 0.1, 1));
  const auto   changed = [&complex](std::uint32_t time) {
    std::set<IdType> points;
    for (IdType p = 0; p < static_cast<IdType>(complex.Points().size()); ++p)
    {
      if (complex.HasChanged(p, time))
      {
        points.insert(p);
      }
    }
    return points;
  };
  const auto around = [&complex](const std::vector<IdType> & cells) {
    std::set<IdType> points;
    for (IdType t : cells)
    {
      points.insert(complex.Cell(t).begin(), complex.Cell(t).end());
    }
    return points;
  };
  EXPECT_TRUE(changed(0).empty());
  IdType inner = 0;
  while (complex.Dimension(inner) < 3)
  {
    ++inner;
  }
  auto time = complex.Clock();
  complex.TryPoint(inner, complex.Points()[inner]);
  EXPECT_TRUE(changed(time).empty());
  complex.MovePoint(inner, complex.Points()[inner]);
  EXPECT_EQ(changed(time), around(complex.Star(inner)));

  time = complex.Clock();
  const IdType next = complex.PointNeighbors(inner).front();
  auto         expected = around(complex.EdgeStar(inner, next));
  const IdType middle = complex.SplitEdge(inner, next, 0.5 * (complex.Points()[inner] + complex.Points()[next]));
  expected.insert(middle);
  EXPECT_EQ(changed(time), expected);

  time = complex.Clock();
  expected = around(complex.Star(middle));
  ASSERT_EQ(complex.CanCollapse(middle, inner), MeshOperation::Done);
  complex.Collapse(middle, inner);
  EXPECT_EQ(changed(time), expected);
}

TEST(TetraComplex, SplitEdgesKeepVolumeAndTopologyAndCanBeCollapsed)
{
  auto mesh = test::MakeBall(3, { 1, 1, 2 }, 10, 0.1, 1);
  mesh.layer.assign(mesh.points.size(), 0);
  TetraComplex complex(mesh);
  const IdType count = static_cast<IdType>(mesh.points.size());
  for (IdType a = 0; a < count; ++a)
  {
    for (IdType b : complex.PointNeighbors(a))
    {
      if (a < b && b < count && complex.Dimension(a) == 3)
      {
        const auto star = complex.EdgeStar(a, b);
        const auto before = complex.AliveCells();
        complex.SplitEdge(a, b, 0.5 * (mesh.points[a] + mesh.points[b]));
        EXPECT_EQ(complex.AliveCells(), before + static_cast<IdType>(star.size()));
      }
    }
  }
  const auto made = Compacted(complex, mesh);
  EXPECT_GT(made.points.size(), mesh.points.size());
  ASSERT_EQ(made.layer.size(), made.points.size());
  for (std::size_t t = 0; t < made.tetrahedra.size(); ++t)
  {
    for (IdType p : made.tetrahedra[t])
    {
      EXPECT_TRUE(p < count || made.layer[p] == made.region[t]) << "as a medial axis there";
    }
  }
  EXPECT_TRUE(ValidateMesh(made).IsValid()) << ValidateMesh(made).Summary();
  for (int region = 1; region <= 2; ++region)
  {
    EXPECT_NEAR(
      test::RegionVolume(made, region), test::RegionVolume(mesh, region), 1e-9 * test::RegionVolume(mesh, region));
  }
  for (IdType p = count; p < static_cast<IdType>(complex.Points().size()); ++p)
  {
    for (IdType q : complex.PointNeighbors(p))
    {
      if (complex.CanCollapse(p, q) == MeshOperation::Done)
      {
        complex.Collapse(p, q);
        break;
      }
    }
  }
  EXPECT_EQ(Compacted(complex, mesh).points.size(), mesh.points.size());
}

TEST(TetraComplex, CollapseKeepsTopologyWhereTheLinkConditionHolds)
{
  // Topology alone: cells may invert here, so that orientation is left out of the comparison.
  for (unsigned seed = 1; seed <= 4; ++seed)
  {
    test::TubeShape shape;
    shape.seed = seed;
    shape.closed = seed % 2 == 0;
    shape.slices = shape.closed ? 12 : 8;
    shape.around = 9;
    shape.rings = { 1, 1, 1 };
    const auto   mesh = test::MakeTube(shape);
    TetraComplex complex(mesh);
    std::mt19937 random(seed);
    int          collapsed = 0;
    for (int trial = 0; trial < 3000; ++trial)
    {
      const auto v = static_cast<IdType>(random() % mesh.points.size());
      if (complex.Star(v).empty())
      {
        continue;
      }
      const auto   neighbors = complex.PointNeighbors(v);
      const IdType w = neighbors[random() % neighbors.size()];
      if (complex.CanCollapse(v, w) == MeshOperation::Done)
      {
        complex.Collapse(v, w);
        ++collapsed;
      }
    }
    EXPECT_GT(collapsed, 50);
    const auto made = Compacted(complex, mesh);
    EXPECT_EQ(made.tetrahedra.size(), static_cast<std::size_t>(complex.AliveCells()));
    EXPECT_EQ(made.neighbors, ComputeFaceNeighbors(made.tetrahedra));
    const auto before = ValidateMesh(mesh), after = ValidateMesh(made);
    EXPECT_EQ(after.components, before.components);
    EXPECT_EQ(after.boundaryEuler, before.boundaryEuler);
    for (const auto & check : after.checks)
    {
      const bool geometric = check.name == "positive orientation" || check.name == "face manifold";
      EXPECT_TRUE(geometric || check.failures == 0)
        << "seed " << seed << ", " << check.name << ": " << (check.examples.empty() ? "" : check.examples.front());
    }
  }
}

TEST(TetraComplex, NoCollapseLeavesAStratum)
{
  test::TubeShape    shape;
  const auto         mesh = test::MakeTube(shape);
  const TetraComplex complex(mesh);
  const auto         onEnd = [&](IdType v) { return mesh.slice[v] == 0 || mesh.slice[v] == shape.slices - 1; };
  for (IdType v = 0; v < static_cast<IdType>(mesh.points.size()); ++v)
  {
    for (IdType w : complex.PointNeighbors(v))
    {
      if (complex.Dimension(v) < complex.Dimension(w))
      {
        EXPECT_EQ(complex.CanCollapse(v, w), MeshOperation::Surface);
      }
      else if (complex.Dimension(v) == 2 && complex.Dimension(w) == 2 && mesh.layer[v] != mesh.layer[w] && !onEnd(v))
      {
        EXPECT_NE(complex.CanCollapse(v, w), MeshOperation::Done) << "from one layer's surface to another's";
      }
    }
  }
}
} // namespace TetraComplexTests
