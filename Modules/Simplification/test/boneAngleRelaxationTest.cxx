/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneAngleRelaxation.h"

#include "boneMeshValidator.h"
#include "boneQualityMeasures.h"
#include "boneSurfaceGrid.h"
#include "../../Core/test/boneTestBodies.h"
#include "boneTetraFlips.h"

#include <gtest/gtest.h>

#include <algorithm>

using namespace bone;

namespace AngleRelaxationTests
{
constexpr double Degree = 0.017453292519943295;

MeshArrays
Body(unsigned seed)
{
  test::TubeShape shape;
  shape.seed = seed;
  shape.bumps = 0.2;
  shape.slices = 10;
  shape.around = 14;
  shape.rings = { 1, 2 };
  return test::MakeTube(shape);
}

AngleGoal
Goal()
{
  AngleGoal goal;
  goal.floors = { 5 * Degree, 8 * Degree };
  goal.volumeChange = 0.03;
  return goal;
}

/** A body, some of whose surface points were drawn to others, and what judges it. */
struct Drawn
{
  explicit Drawn(unsigned seed)
    : mesh(Body(seed))
    , complex(mesh)
    , surfaces(complex, 0.0, 0)
    , volumes(complex)
  {
    PointMover                             mover(complex);
    std::vector<TetraComplex::SurfaceFace> faces;
    for (IdType p = seed; p < static_cast<IdType>(complex.Points().size()); p += 5)
    {
      complex.SurfaceStar(p, faces);
      if (complex.Dimension(p) == 2)
      {
        mover.TryMove(p, 0.2 * complex.Points()[p] + 0.8 * complex.Points()[faces[0].a], 1.0);
      }
    }
  }

  /** Of all cells, triangles and volumes, each counted once. */
  double
  Total(const AngleMerit & merit) const
  {
    const auto & p = complex.Points();
    double       total = 0.0;
    for (IdType t = 0; t < complex.Size(); ++t)
    {
      if (!complex.IsAlive(t))
      {
        continue;
      }
      const Id4 & c = complex.Cell(t);
      total += merit.OfCell(CellCosine(complex, t), complex.Region(t));
      for (int i = 0; i < 4; ++i)
      {
        if (complex.Carries(t, i))
        {
          const auto & f = TetraFaces[i];
          total += merit.OfTriangle(complex.FaceSurfaces(t)[i], { p[c[f[0]]], p[c[f[1]]], p[c[f[2]]] });
        }
      }
    }
    const auto changes = volumes.ChangesTo(complex);
    for (std::size_t r = 0; r < changes.size(); ++r)
    {
      const double share = changes[r] / (0.03 * volumes[r]);
      total -= 100.0 * share * share;
    }
    return total;
  }

  MeshArrays    mesh;
  TetraComplex  complex;
  SurfaceTarget surfaces;
  RegionVolumes volumes;
};

TEST(AngleMerit, CellsCountByTheirSmallestAngle)
{
  const Drawn body(1);
  AngleMerit  merit(body.surfaces, body.volumes, Goal(), body.complex);
  merit.SetWeights(0.0, 4.0);
  const auto of = [&merit](double degrees, int region) { return merit.OfCell(std::cos(degrees * Degree), region); };
  EXPECT_NEAR(of(30, Trabecular), 30 * Degree, 1e-12);
  EXPECT_NEAR(of(6, Cortical), 6 * Degree, 1e-12);
  EXPECT_NEAR(of(6, Trabecular), 6 * Degree - 4.0 * (1.03 * 8 - 6) / (1.03 * 8), 1e-12);
  EXPECT_NEAR(of(0, Cortical), -4.0, 1e-7);
  EXPECT_NEAR(of(60, Cortical), 45 * Degree, 1e-12);
  EXPECT_EQ(of(50, Cortical), AngleMerit::LargestOfCell());
  merit.SetWeights(0.0, 8.0);
  EXPECT_NEAR(of(0, Cortical), -8.0, 1e-7);
}

TEST(AngleMerit, SurfacesCountByTheMeanOfTheirSquaredDistances)
{
  const MeshArrays    mesh = Body(2);
  const TetraComplex  complex(mesh);
  const SurfaceTarget surfaces(complex, 0.0, 0);
  const RegionVolumes volumes(complex);
  AngleMerit          merit(surfaces, volumes, Goal(), complex);
  merit.SetWeights(300.0, 4.0);
  const double unit = 0.025 * MeanBoundaryEdge(complex);
  double       near = 0.0, far = 0.0, flat = 0.0;
  for (IdType t = 0; t < complex.Size(); ++t)
  {
    for (int i = 0; i < 4; ++i)
    {
      if (!complex.Carries(t, i))
      {
        continue;
      }
      const auto &           x = complex.Points();
      const Id4 &            c = complex.Cell(t);
      std::array<Vector3, 3> corners = { x[c[TetraFaces[i][0]]], x[c[TetraFaces[i][1]]], x[c[TetraFaces[i][2]]] };
      const int              surface = complex.FaceSurfaces(t)[i];
      near += merit.OfTriangle(surface, corners);
      const Vector3 normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
      for (Vector3 & corner : corners)
      {
        corner += unit * normal.normalized();
      }
      if (complex.Surfaces().surfaces[surface].flat >= 0)
      {
        far += merit.OfTriangle(surface, corners);
        flat += 0.5 * normal.norm();
      }
      else
      {
        // Farther along a normal, something else of the surface may be nearer.
        EXPECT_GE(merit.OfTriangle(surface, corners), merit.OfDistance(0.5 * normal.norm() * unit * unit) - 1e-9);
      }
    }
  }
  ASSERT_GT(flat, 0.0);
  EXPECT_NEAR(near, 0.0, 1e-12);
  EXPECT_NEAR(far, merit.OfDistance(flat * unit * unit), 1e-9 * std::abs(far));
  // All surfaces together at the unit of distance cost their weight.
  double area = 0.0;
  for (IdType t = 0; t < complex.Size(); ++t)
  {
    for (int i = 0; i < 4; ++i)
    {
      const auto & x = complex.Points();
      const Id4 &  c = complex.Cell(t);
      const auto & f = TetraFaces[i];
      area += complex.Carries(t, i) ? 0.5 * (x[c[f[1]]] - x[c[f[0]]]).cross(x[c[f[2]]] - x[c[f[0]]]).norm() : 0.0;
    }
  }
  EXPECT_NEAR(merit.OfDistance(area * unit * unit), -300.0, 1e-9);
}

TEST(AngleMerit, VolumesCountByTheSquaresOfTheirBounds)
{
  const Drawn body(3);
  AngleMerit  merit(body.surfaces, body.volumes, Goal(), body.complex);
  merit.SetWeights(0.0, 4.0);
  const auto changes = body.volumes.ChangesTo(body.complex);
  ASSERT_EQ(changes.size(), 2u);
  std::vector<double> back, none(2, 0.0);
  double              cost = 0.0;
  for (std::size_t r = 0; r < 2; ++r)
  {
    const double share = changes[r] / (0.03 * body.volumes[r]);
    EXPECT_GT(std::abs(share), 1e-3);
    cost += 100.0 * share * share;
    back.push_back(-changes[r]);
  }
  EXPECT_NEAR(merit.OfVolumes(back), cost, 1e-9 * cost);
  EXPECT_EQ(merit.OfVolumes(none), 0.0);
  merit.AddToVolumes(back);
  EXPECT_NEAR(merit.OfVolumes(changes), -cost, 1e-9 * cost);
}

TEST(PointStar, AMoveGainsWhatItSays)
{
  std::size_t count[3] = {}, better = 0;
  for (unsigned seed = 1; seed <= 3; ++seed)
  {
    Drawn      body(seed);
    AngleMerit merit(body.surfaces, body.volumes, Goal(), body.complex);
    merit.SetWeights(500.0, 4.0);
    for (IdType p = 0; p < static_cast<IdType>(body.complex.Points().size()); p += 3)
    {
      const Vector3 before = body.complex.Points()[p];
      const double  start = body.Total(merit);
      const auto    move = PointStar(body.complex, merit, p).FindMove();
      if (move.x == before)
      {
        EXPECT_EQ(move.gain, 0.0);
        continue;
      }
      ASSERT_GT(body.complex.Dimension(p), 0) << "corners stay";
      body.complex.MovePoint(p, move.x);
      const double gain = move.gain + merit.OfVolumes(move.volumeChanges);
      EXPECT_NEAR(body.Total(merit) - start, gain, 1e-7 * (1.0 + std::abs(gain)));
      better += gain > 0 ? 1 : 0;
      if (body.complex.Dimension(p) == 1)
      {
        EXPECT_NEAR((body.surfaces.Project(body.complex, p, move.x) - move.x).norm(), 0.0, 1e-9);
      }
      ++count[body.complex.Dimension(p) - 1];
      body.complex.MovePoint(p, before);
    }
  }
  EXPECT_GT(count[0], 5u);
  EXPECT_GT(count[1], 100u);
  EXPECT_GT(count[2], 20u);
  EXPECT_GT(better, 9 * (count[0] + count[1] + count[2]) / 10); // some planes say too much
}

TEST(AngleRelaxation, EachSweepRaisesTheMeritAndKeepsTheMeshValid)
{
  for (unsigned seed = 1; seed <= 3; ++seed)
  {
    Drawn        body(seed);
    AngleMerit   merit(body.surfaces, body.volumes, Goal(), body.complex);
    SurfaceBound bound(body.complex, body.surfaces, 1.0);
    PointMover   mover(body.complex, &bound);
    merit.SetWeights(500.0, 4.0);
    const IdType    cells = body.complex.AliveCells();
    AngleRelaxation relaxation(body.complex, mover, merit, { cells, cells }, Execution());
    double          before = body.Total(merit);
    const double    first = before;
    std::size_t     changes = 1, sweeps = 0;
    for (; changes > 0 && sweeps < 100; ++sweeps)
    {
      changes = relaxation.Sweep();
      const double after = body.Total(merit);
      EXPECT_GE(after, before - 1e-9) << "seed " << seed << ", sweep " << sweeps;
      EXPECT_EQ(after > before, changes > 0);
      before = after;
    }
    EXPECT_LT(sweeps, 100u) << "a sweep without a change is the last";
    EXPECT_GT(before, first + 10.0);
    EXPECT_EQ(body.complex.AliveCells(), cells);
    std::vector<IdType> points, slots;
    const MeshArrays    mesh = body.complex.Compact(body.mesh, points, slots);
    const auto          validation = ValidateMesh(mesh);
    EXPECT_TRUE(validation.IsValid()) << validation.Summary();
    EXPECT_TRUE(FindCrossingTriangles(BoundaryFaces(body.complex), body.complex.Points()).empty());
    EXPECT_EQ(CountInverted(mesh), 0u);
    EXPECT_LT(body.volumes.LargestChangeTo(body.complex), 0.03);
  }
}

TEST(PointStar, NoAngleFallsBelowTheLeastAndWhatWasThere)
{
  // Surfaces weigh so much that places are better there whose angles are worse.
  for (const double degrees : { 0.0, 12.0 })
  {
    Drawn     body(3);
    AngleGoal goal = Goal();
    goal.least = { degrees * Degree, degrees * Degree };
    AngleMerit       merit(body.surfaces, body.volumes, goal, body.complex);
    const PointMover mover(body.complex);
    merit.SetWeights(1e5, 1.0);
    std::size_t fallen = 0;
    for (IdType p = 0; p < static_cast<IdType>(body.complex.Points().size()); ++p)
    {
      const Vector3 before = body.complex.Points()[p];
      const double  worst = mover.WorstCosine(p);
      body.complex.TryPoint(p, PointStar(body.complex, merit, p).FindMove().x);
      fallen += mover.WorstCosine(p) > std::max(worst, std::cos(12 * Degree)) ? 1 : 0;
      body.complex.TryPoint(p, before);
    }
    EXPECT_EQ(fallen > 0, degrees == 0.0) << fallen;
  }
}

/** Smallest dihedral angle, rad. */
double
LeastAngle(const TetraComplex & complex)
{
  double worst = -1.0;
  for (IdType t = 0; t < complex.Size(); ++t)
  {
    worst = std::max(worst, complex.IsAlive(t) ? CellCosine(complex, t) : -1.0);
  }
  return std::acos(worst);
}

TEST(AngleRelaxation, NoAngleFallsBelowTheLeast)
{
  // Good cells first, then surfaces that weigh so much that worse cells would come.
  for (const bool kept : { false, true })
  {
    Drawn      body(3);
    PointMover mover(body.complex);
    AngleMerit merit(body.surfaces, body.volumes, Goal(), body.complex);
    merit.SetWeights(1.0, 64.0);
    AngleRelaxation relaxation(body.complex, mover, merit, { 0, 1 << 20 }, Execution());
    for (int i = 0; i < 6; ++i)
    {
      relaxation.Sweep();
    }
    const double least = LeastAngle(body.complex);
    ASSERT_GT(least, 5 * Degree);
    AngleGoal goal = Goal();
    goal.least = kept ? AngleFloors{ least, least } : AngleFloors();
    AngleMerit surfaces(body.surfaces, body.volumes, goal, body.complex);
    surfaces.SetWeights(1e5, 1.0);
    AngleRelaxation back(body.complex, mover, surfaces, { 0, 1 << 20 }, Execution());
    for (int i = 0; i < 3; ++i)
    {
      back.Sweep();
    }
    EXPECT_EQ(LeastAngle(body.complex) > least - 1e-9, kept) << LeastAngle(body.complex) << " of " << least;
  }
}

TEST(AngleRelaxation, FlatCutsStayFlat)
{
  Drawn      body(2);
  AngleMerit merit(body.surfaces, body.volumes, Goal(), body.complex);
  PointMover mover(body.complex);
  merit.SetWeights(1.0, 4.0); // surfaces are all but free
  AngleRelaxation            relaxation(body.complex, mover, merit, { 0, 1 << 20 }, Execution());
  const std::vector<Vector3> before = body.complex.Points();
  relaxation.Sweep();
  relaxation.Sweep();
  std::vector<TetraComplex::SurfaceFace> faces;
  std::size_t                            moved = 0, off = 0;
  for (IdType p = 0; p < static_cast<IdType>(before.size()); ++p)
  {
    if (body.complex.Dimension(p) == 2)
    {
      body.complex.SurfaceStar(p, faces);
      const bool    flat = body.complex.Surfaces().surfaces[faces.front().surface].flat >= 0;
      const Vector3 distance =
        body.surfaces.Project(body.complex, p, body.complex.Points()[p]) - body.complex.Points()[p];
      moved += flat && body.complex.Points()[p] != before[p] ? 1 : 0;
      off += !flat && distance.norm() > 0.05 ? 1 : 0;
      if (flat)
      {
        EXPECT_NEAR(distance.norm(), 0.0, 1e-9);
      }
    }
  }
  EXPECT_GT(moved, 3u);
  EXPECT_GT(off, 20u);
}
} // namespace AngleRelaxationTests
