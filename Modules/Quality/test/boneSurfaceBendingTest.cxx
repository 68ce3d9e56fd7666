/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSurfaceBending.h"

#include "boneMeshImprovement.h"
#include "boneMeshQualityFilter.h"
#include "boneMeshValidator.h"
#include "boneQualityTestBodies.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

using namespace bone;

namespace SurfaceBendingTests
{
constexpr double Radius = 12.0;

/** A rod of two regions, the points of its outside moved in and out by up to `noise`. */
MeshArrays
RoughRod(double noise, unsigned int seed)
{
  MeshArrays                             mesh = test::StraightRod(Radius);
  std::mt19937                           random(seed);
  std::uniform_real_distribution<double> move(-noise, noise);
  for (Vector3 & x : mesh.points)
  {
    const double radius = std::hypot(x.x(), x.y());
    if (radius > 0.9 * Radius)
    {
      x.head<2>() *= 1.0 + move(random) / radius;
    }
  }
  return mesh;
}

std::vector<char>
PointsWithinSurfaces(const TetraComplex & complex)
{
  std::vector<char> within;
  for (std::size_t p = 0; p < complex.Points().size(); ++p)
  {
    within.push_back(complex.Dimension(static_cast<IdType>(p)) == 2);
  }
  return within;
}

/** A spring for each corner of each triangle of the boundary, to where the corner is and `move`. */
std::vector<SurfaceBending::Spring>
CornerSprings(const TetraComplex & complex, const Vector3 & move = Vector3::Zero())
{
  std::vector<SurfaceBending::Spring> springs;
  for (IdType t = 0; t < complex.Size(); ++t)
  {
    for (int i = 0; i < 4; ++i)
    {
      for (int k = 0; k < 3 && complex.Carries(t, i); ++k)
      {
        const Id4 &           c = complex.Cell(t);
        const TriangleIds     f = { c[TetraFaces[i][0]], c[TetraFaces[i][1]], c[TetraFaces[i][2]] };
        std::array<double, 3> shares{};
        shares[k] = 1.0;
        springs.push_back({ f, shares, 0.2, complex.Points()[f[k]] + move });
      }
    }
  }
  return springs;
}

TEST(SurfaceBending, TheEnergyIsThatOfTheTurn)
{
  const TetraComplex   complex(RoughRod(0.3, 1));
  const SurfaceBending bending(complex, 0.1);
  const Vector3        a(0, 0, 0), b(0, 2, 0), c(1, 1, 0);
  const auto           at = [&](double turn, double size) {
    return bending.Energy(size * a, size * b, size * c, size * Vector3(-std::cos(turn), 1, std::sin(turn)));
  };
  EXPECT_NEAR(at(0.0, 1.0), 0.0, 1e-12);
  EXPECT_NEAR(at(0.3, 1.0), at(-0.3, 1.0), 1e-9 * at(0.3, 1.0));
  EXPECT_NEAR(at(0.3, 1.0), at(0.3, 5.0), 1e-9 * at(0.3, 1.0));
  // Small turns by their squares, large ones by themselves.
  EXPECT_NEAR(at(2e-5, 1.0) / at(1e-5, 1.0), 4.0, 0.01);
  EXPECT_LT(at(2.0, 1.0) / at(1.0, 1.0), 2.2);
  EXPECT_EQ(SurfaceBending(complex, 0.0).Energy(a, b, c, Vector3(0, 1, 1)), 0.0);
}

TEST(SurfaceBending, PointsGoToTheirSpringsWithoutStiffnessAndStayWithoutFreedom)
{
  const TetraComplex complex(RoughRod(0.3, 2));
  std::vector<char>  isFree = PointsWithinSurfaces(complex);
  for (std::size_t p = 0; p < isFree.size(); p += 3)
  {
    isFree[p] = 0;
  }
  const Vector3 move(0.1, -0.2, 0.05);
  const auto    springs = CornerSprings(complex, move);
  const auto    limp = SurfaceBending(complex, 0.0).Solve(complex.Points(), isFree, springs);
  const auto    stiff = SurfaceBending(complex, 1.0).Solve(complex.Points(), isFree, springs);
  const auto    alone = SurfaceBending(complex, 1.0).Solve(complex.Points(), isFree, {});
  for (std::size_t p = 0; p < limp.size(); ++p)
  {
    // A tenth of the weight holds each point.
    const Vector3 & x = complex.Points()[p];
    EXPECT_LT((limp[p] - x - (isFree[p] ? move / 1.1 : Vector3(0, 0, 0))).norm(), 1e-9);
    EXPECT_TRUE(isFree[p] || stiff[p] == x);
    EXPECT_EQ(alone[p], x);
  }
}

TEST(SurfaceBending, ASpringWithinATriangleBringsItsPlaceThere)
{
  const TetraComplex complex(RoughRod(0.3, 4));
  auto               springs = CornerSprings(complex);
  springs.resize(1);
  springs[0].shares = { { 0.2, 0.3, 0.5 } };
  const auto place = [&](const std::vector<Vector3> & x) {
    Vector3 sum = Vector3::Zero();
    for (int k = 0; k < 3; ++k)
    {
      sum += springs[0].shares[k] * x[springs[0].points[k]];
    }
    return sum;
  };
  const Vector3           before = place(complex.Points()), move(0.3, 0.1, -0.2);
  const std::vector<char> all(complex.Points().size(), 1);
  springs[0].target = before + move;
  std::vector<Vector3> x = complex.Points();
  for (int step = 0; step < 20; ++step)
  {
    x = SurfaceBending(complex, 0.0).Solve(x, all, springs);
  }
  EXPECT_LT((place(x) - before - move).norm(), 1e-6);
}

TEST(SurfaceBending, SmoothsWhatIsRoughWithoutShrinkingIt)
{
  for (unsigned int seed = 1; seed <= 5; ++seed)
  {
    MeshArrays           mesh = RoughRod(0.4, seed);
    const TetraComplex   rough(mesh);
    const SurfaceBending bending(rough, 1.0);
    const auto           made = bending.Solve(rough.Points(), PointsWithinSurfaces(rough), CornerSprings(rough));
    double               before = 0.0, after = 0.0, mean = 0.0;
    int                  count = 0;
    for (std::size_t p = 0; p < made.size(); ++p)
    {
      if (rough.Dimension(static_cast<IdType>(p)) == 2 && mesh.points[p].head<2>().norm() > 0.9 * Radius)
      {
        before += std::abs(mesh.points[p].head<2>().norm() - Radius);
        after += std::abs(made[p].head<2>().norm() - Radius);
        mean += made[p].head<2>().norm();
        ++count;
      }
    }
    mesh.points = made;
    EXPECT_LT(test::MeanTurn(TetraComplex(mesh)), 0.7 * test::MeanTurn(rough)) << seed;
    EXPECT_LT(after, 0.7 * before) << seed;
    EXPECT_NEAR(mean / count, Radius, 0.1) << seed;
  }
}

TEST(SurfaceBending, TheMeanTurnIsOfEdgesWithinSlicesWhereThereAreSlices)
{
  const TetraComplex complex(RoughRod(0.4, 6));
  EXPECT_NEAR(MeanBoundaryDeviation(complex, {}), test::MeanTurn(complex), 1e-9);
  // A smooth rod turns by nothing where slices meet, and around itself between them.
  const MeshArrays   smooth = RoughRod(0.0, 6);
  const TetraComplex rod(smooth);
  std::vector<int>   slices;
  for (const Vector3 & x : smooth.points)
  {
    slices.push_back(static_cast<int>(std::lround(x.z() / 2.0)));
  }
  EXPECT_LT(MeanBoundaryDeviation(rod, slices), 1e-6);
  EXPECT_GT(MeanBoundaryDeviation(rod, {}), 0.1);
}

TEST(SurfaceBending, FitsGoOnUntilTheBoundaryTurnsByTheShareWanted)
{
  const ContourShape shape(*test::RodContours(Radius));
  double             turn[2];
  for (const bool more : { false, true })
  {
    TetraComplex          complex(RoughRod(0.4, 7));
    ImprovementParameters parameters;
    parameters.shape = &shape;
    parameters.stiffness = 1e-3;
    parameters.morePasses = more ? 6 : 0;
    parameters.deviationShare = 0.1;
    ImproveMesh(complex, parameters);
    turn[more] = MeanBoundaryDeviation(complex, {});
  }
  EXPECT_LT(turn[1], turn[0]);
}

TEST(SurfaceBending, AStifferSurfaceTurnsLessAndStaysOnTheContours)
{
  double turn[2], distance[2];
  for (const bool stiff : { false, true })
  {
    const auto mesh = DensityMesh<double>::New();
    mesh->SetArrays(RoughRod(0.4, 3));
    auto filter = MeshQualityFilter<DensityMesh<double>>::New();
    filter->SetInput(mesh);
    filter->SetContours(test::RodContours(Radius));
    filter->SetStiffness(stiff ? 0.1 : 0.0);
    filter->Update();
    const MeshArrays & made = filter->GetOutput()->GetArrays();
    EXPECT_TRUE(ValidateMesh(made).IsValid());
    const TetraComplex complex(made);
    turn[stiff] = test::MeanTurn(complex);
    distance[stiff] = 0.0;
    for (std::size_t p = 0; p < made.points.size(); ++p)
    {
      const double radius = made.points[p].head<2>().norm();
      if (complex.Dimension(static_cast<IdType>(p)) == 2 && radius > 0.9 * Radius)
      {
        distance[stiff] = std::max(distance[stiff], std::abs(radius - Radius));
      }
    }
  }
  EXPECT_LT(turn[1], 0.97 * turn[0]);
  EXPECT_LT(distance[1], 0.5);
}
} // namespace SurfaceBendingTests
