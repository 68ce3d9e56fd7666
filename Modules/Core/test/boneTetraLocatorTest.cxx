/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneTetraLocator.h"

#include "boneTestBodies.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>

namespace TetraLocatorTests
{
using namespace bone;

MeshArrays
Tube()
{
  test::TubeShape shape;
  shape.seed = 7;
  return test::MakeTube(shape);
}

Vector3
Place(const MeshArrays & mesh, IdType t, const Barycentric & mu)
{
  Vector3 x = Vector3::Zero();
  for (int i = 0; i < 4; ++i)
  {
    x += mu[i] * mesh.points[mesh.tetrahedra[t][i]];
  }
  return x;
}

/** The closed tetrahedron contains x, exactly. */
bool
ContainsExactly(const MeshArrays & mesh, IdType t, const Vector3 & x)
{
  const Id4 & v = mesh.tetrahedra[t];
  for (const auto & f : TetraFaces)
  {
    if (Orient3D(mesh.points[v[f[0]]], mesh.points[v[f[1]]], mesh.points[v[f[2]]], x) > 0)
    {
      return false;
    }
  }
  return true;
}

IdType
LowestContaining(const MeshArrays & mesh, const Vector3 & x)
{
  for (IdType t = 0; t < static_cast<IdType>(mesh.tetrahedra.size()); ++t)
  {
    if (ContainsExactly(mesh, t, x))
    {
      return t;
    }
  }
  return -1;
}

TEST(TetraLocator, AgreesWithAnExactSearchOfAllCellsWithAndWithoutAHint)
{
  const MeshArrays                       mesh = Tube();
  const TetraLocator                     locator(mesh);
  std::mt19937_64                        random(3);
  std::uniform_real_distribution<double> uniform(-0.05, 1.05);
  Vector3                                lower = mesh.points[0], upper = mesh.points[0];
  for (const Vector3 & p : mesh.points)
  {
    lower = lower.cwiseMin(p);
    upper = upper.cwiseMax(p);
  }
  int    inside = 0;
  IdType hint = 0;
  for (int trial = 0; trial < 1000; ++trial)
  {
    const Vector3 x = lower + Vector3(uniform(random), uniform(random), uniform(random)).cwiseProduct(upper - lower);
    const IdType  expected = LowestContaining(mesh, x);
    const CellLocation found = locator.Find(x);
    ASSERT_EQ(found.cell, expected);
    ASSERT_EQ(locator.Find(x, hint).cell, expected);
    if (expected >= 0)
    {
      ++inside;
      EXPECT_LT((Place(mesh, found.cell, found.mu) - x).norm(), 1e-11);
      hint = static_cast<IdType>((expected + 100) % mesh.tetrahedra.size());
    }
  }
  EXPECT_GT(inside, 200);
}

TEST(TetraLocator, GivesVerticesEdgesAndFacesToTheLowestCellWhateverTheHint)
{
  const MeshArrays    mesh = Tube();
  const TetraLocator  locator(mesh);
  std::vector<IdType> lowest(mesh.points.size(), -1);
  for (IdType t = static_cast<IdType>(mesh.tetrahedra.size()) - 1; t >= 0; --t)
  {
    for (IdType v : mesh.tetrahedra[t])
    {
      lowest[v] = t;
    }
  }
  for (std::size_t p = 0; p < mesh.points.size(); ++p)
  {
    ASSERT_EQ(locator.Find(mesh.points[p]).cell, lowest[p]);
  }
  for (IdType t = 0; t < static_cast<IdType>(mesh.tetrahedra.size()); t += 29)
  {
    for (const Barycentric & mu : { Barycentric(0.5, 0.5, 0, 0), Barycentric(0, 0.25, 0.25, 0.5) })
    {
      const Vector3      x = Place(mesh, t, mu);
      const CellLocation found = locator.FindNearest(x);
      ASSERT_EQ(locator.Find(x).cell, LowestContaining(mesh, x));
      ASSERT_EQ(locator.Find(x, t).cell, locator.Find(x).cell);
      EXPECT_LT(found.distance, 1e-11);
    }
  }
}

TEST(TetraLocator, FindsEveryPointOfAnIntegerGridThatIsFullOfTies)
{
  MeshArrays mesh;
  const int  n = 3;
  const auto id = [n](int i, int j, int k) { return static_cast<IdType>((k * (n + 1) + j) * (n + 1) + i); };
  for (int k = 0; k <= n; ++k)
  {
    for (int j = 0; j <= n; ++j)
    {
      for (int i = 0; i <= n; ++i)
      {
        mesh.points.emplace_back(i, j, k);
      }
    }
  }
  constexpr std::array<std::array<int, 3>, 6> orders = {
    { { 0, 1, 2 }, { 0, 2, 1 }, { 1, 0, 2 }, { 1, 2, 0 }, { 2, 0, 1 }, { 2, 1, 0 } }
  };
  for (int cube = 0; cube < n * n * n; ++cube)
  {
    for (const auto & order : orders)
    {
      std::array<int, 3> at = { cube % n, cube / n % n, cube / n / n };
      Id4                tetra;
      tetra[0] = id(at[0], at[1], at[2]);
      for (int step = 0; step < 3; ++step)
      {
        ++at[order[step]];
        tetra[step + 1] = id(at[0], at[1], at[2]);
      }
      mesh.tetrahedra.push_back(tetra);
    }
  }
  test::MakePositive(mesh);
  const TetraLocator locator(mesh);
  for (int k = 0; k <= 4 * n; ++k)
  {
    for (int j = 0; j <= 4 * n; ++j)
    {
      for (int i = 0; i <= 4 * n; ++i)
      {
        const Vector3 x = Vector3(i, j, k) / 4;
        ASSERT_EQ(locator.Find(x).cell, LowestContaining(mesh, x));
        ASSERT_GE(locator.Find(x, 5).cell, 0);
      }
    }
  }
}

TEST(TetraLocator, GivesTheNearestPlaceOnTheBoundaryOutside)
{
  const MeshArrays                 mesh = Tube();
  const TetraLocator               locator(mesh);
  std::mt19937_64                  random(5);
  std::normal_distribution<double> normal(0, 15);
  for (int trial = 0; trial < 200; ++trial)
  {
    const Vector3      x(normal(random), normal(random), normal(random) + 40);
    const CellLocation found = locator.FindNearest(x);
    ASSERT_TRUE(found.Found());
    EXPECT_NEAR(found.mu.sum(), 1, 1e-12);
    EXPECT_GE(found.mu.minCoeff(), 0);
    EXPECT_NEAR((Place(mesh, found.cell, found.mu) - x).norm(), found.distance, 1e-9);
    double least = std::numeric_limits<double>::max();
    for (const auto & f : BoundaryFaces(mesh))
    {
      const Vector3 nearest = ClosestPointOnTriangle(x, mesh.points[f[0]], mesh.points[f[1]], mesh.points[f[2]]);
      least = std::min(least, (nearest - x).norm());
    }
    EXPECT_NEAR(found.distance, locator.Find(x).Found() ? 0.0 : least, 1e-9);
  }
}

TEST(TetraLocator, SkipsFlatCellsAndFindsThinOnes)
{
  MeshArrays mesh;
  mesh.points = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0.3, 0.3, 1e-14 }, { 0.5, 0.5, 0 } };
  mesh.tetrahedra = { { 0, 1, 2, 4 }, { 0, 1, 2, 3 } };
  const TetraLocator locator(mesh);
  EXPECT_EQ(locator.Find({ 0.3, 0.3, 5e-15 }).cell, 1);
  EXPECT_EQ(locator.Find({ 0.3, 0.3, 2e-14 }).cell, -1);
  EXPECT_EQ(locator.Find({ 0.3, 0.3, -1e-14 }).cell, -1);
}

TEST(TetraLocator, TakesAnEmptyMeshAndRefusesPointsThatAreNotFinite)
{
  const TetraLocator empty{ MeshArrays() };
  EXPECT_FALSE(empty.Find({ 0, 0, 0 }).Found());
  EXPECT_FALSE(empty.FindNearest({ 0, 0, 0 }).Found());
  MeshArrays mesh = Tube();
  EXPECT_FALSE(TetraLocator(mesh).Find({ std::nan(""), 0, 0 }).Found());
  EXPECT_FALSE(TetraLocator(mesh).FindNearest({ std::nan(""), 0, 0 }).Found());
  mesh.points[3][1] = std::nan("");
  EXPECT_THROW(TetraLocator{ mesh }, std::invalid_argument);
}
} // namespace TetraLocatorTests
