/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneMeshValidator.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <limits>
#include <numeric>
#include <random>
#include <set>

namespace bone
{
namespace MeshValidatorTests
{
using testing::HasSubstr;

// n x n x n cubes of six tetrahedra each (Kuhn's subdivision, which fits together across cubes), of those cubes that
// keep(i, j, k) says. Point (i, j, k) has the id (k (n+1) + j) (n+1) + i until unused points are removed.
template <typename TKeep>
MeshArrays
Cubes(int n, TKeep && keep)
{
  MeshArrays mesh;
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
  for (int c = 0; c < n * n * n; ++c)
  {
    const int i = c % n, j = c / n % n, k = c / (n * n);
    if (!keep(i, j, k))
    {
      continue;
    }
    std::array<int, 3> axes = { { 0, 1, 2 } };
    do
    {
      std::array<int, 3> at = { { i, j, k } };
      Id4                tetra;
      tetra[0] = id(at[0], at[1], at[2]);
      for (int step = 0; step < 3; ++step)
      {
        ++at[axes[step]];
        tetra[step + 1] = id(at[0], at[1], at[2]);
      }
      const bool even = (axes[0] < axes[1]) == ((axes[0] < axes[2]) == (axes[1] < axes[2]));
      if (!even)
      {
        std::swap(tetra[1], tetra[2]);
      }
      mesh.tetrahedra.push_back(tetra);
    } while (std::next_permutation(axes.begin(), axes.end()));
  }
  RemoveUnusedPoints(mesh);
  mesh.neighbors = ComputeFaceNeighbors(mesh.tetrahedra);
  return mesh;
}

MeshArrays
FullCubes(int n)
{
  return Cubes(n, [](int, int, int) { return true; });
}

std::set<std::string>
FailedChecks(const MeshArrays & mesh)
{
  std::set<std::string> names;
  for (const auto & check : ValidateMesh(mesh).checks)
  {
    if (check.failures > 0)
    {
      names.insert(check.name);
      EXPECT_FALSE(check.examples.empty());
    }
  }
  return names;
}

const MeshCheck &
Find(const MeshValidation & validation, const std::string & name)
{
  return *std::find_if(
    validation.checks.begin(), validation.checks.end(), [&](const MeshCheck & check) { return check.name == name; });
}

// Region 2 for the cubes that inner(centroid) accepts.
template <typename TInner>
void
SetRegions(MeshArrays & mesh, TInner && inner)
{
  mesh.region.clear();
  for (const Id4 & t : mesh.tetrahedra)
  {
    const Vector3 centre = (mesh.points[t[0]] + mesh.points[t[1]] + mesh.points[t[2]] + mesh.points[t[3]]) / 4;
    mesh.region.push_back(inner(centre) ? 2 : 1);
  }
}

using Names = std::set<std::string>;

TEST(MeshValidator, AcceptsAMeshOfCubesAndListsItsChecksInOrder)
{
  const auto               result = ValidateMesh(FullCubes(3));
  std::vector<std::string> names;
  for (const auto & check : result.checks)
  {
    names.push_back(check.name);
  }
  EXPECT_THAT(names,
              testing::ElementsAre("ids",
                                   "positive orientation",
                                   "face manifold",
                                   "closed 2-manifold boundary",
                                   "face neighbours",
                                   "interfaces",
                                   "points",
                                   "voids"));
  EXPECT_TRUE(result.IsValid());
  EXPECT_EQ(result.Summary(), "valid");
  EXPECT_EQ(result.components, 1);
  EXPECT_EQ(result.boundaryEuler, 2);
}

TEST(MeshValidator, AcceptsASolidTorusWithEulerCharacteristicZero)
{
  const auto result = ValidateMesh(Cubes(3, [](int i, int j, int k) { return k == 0 && !(i == 1 && j == 1); }));
  EXPECT_TRUE(result.IsValid()) << result.Summary();
  EXPECT_EQ(result.boundaryEuler, 0);
}

TEST(MeshValidator, AcceptsTwoSeparateBodies)
{
  const auto result = ValidateMesh(Cubes(3, [](int i, int j, int k) { return j == 0 && k == 0 && i != 1; }));
  EXPECT_TRUE(result.IsValid()) << result.Summary();
  EXPECT_EQ(result.components, 2);
  EXPECT_EQ(result.boundaryEuler, 4);
}

TEST(MeshValidator, NeedsNoAttributes)
{
  auto mesh = FullCubes(2);
  mesh.neighbors.clear();
  EXPECT_TRUE(ValidateMesh(mesh).IsValid());
}

TEST(MeshValidator, RefusesAnEmptyMesh)
{
  EXPECT_THAT(ValidateMesh({}).Summary(), HasSubstr("no tetrahedra"));
}

TEST(MeshValidator, IdsOutOfRangeEndTheChecks)
{
  auto mesh = FullCubes(1);
  mesh.tetrahedra[2][1] = 8;
  const auto result = ValidateMesh(mesh);
  EXPECT_EQ(result.checks.size(), 1u);
  EXPECT_THAT(result.Summary(), HasSubstr("tetrahedron 2 names point 8 where there are 8 points"));
  mesh.tetrahedra[2][1] = -1;
  EXPECT_FALSE(ValidateMesh(mesh).IsValid());
}

TEST(MeshValidator, NamesCoordinatesThatAreNotFinite)
{
  for (const double bad : { std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity() })
  {
    auto mesh = FullCubes(1);
    mesh.points[3].y() = bad;
    EXPECT_EQ(FailedChecks(mesh), Names{ "ids" });
    EXPECT_THAT(ValidateMesh(mesh).Summary(), HasSubstr("point 3 has a coordinate that is not finite"));
  }
}

TEST(MeshValidator, NamesARepeatedVertex)
{
  auto mesh = FullCubes(1);
  mesh.tetrahedra[4][2] = mesh.tetrahedra[4][0];
  EXPECT_THAT(Find(ValidateMesh(mesh), "ids").examples, testing::Contains(HasSubstr("tetrahedron 4 repeats a vertex")));
}

TEST(MeshValidator, NamesADuplicatedTetrahedron)
{
  auto mesh = FullCubes(1);
  Id4  copy = mesh.tetrahedra[1];
  std::rotate(copy.begin(), copy.begin() + 1, copy.begin() + 3); // an even permutation of the same vertices
  mesh.tetrahedra.push_back(copy);
  mesh.neighbors.clear();
  EXPECT_THAT(Find(ValidateMesh(mesh), "ids").examples,
              testing::ElementsAre("tetrahedra 1 and 6 have the same vertices"));
}

TEST(MeshValidator, NamesAnInvertedTetrahedron)
{
  // One tetrahedron alone: all its faces stay boundary faces.
  MeshArrays mesh;
  mesh.points = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };
  mesh.tetrahedra = { Id4{ 0, 1, 2, 3 } };
  EXPECT_TRUE(ValidateMesh(mesh).IsValid());
  std::swap(mesh.tetrahedra[0][0], mesh.tetrahedra[0][1]);
  EXPECT_EQ(FailedChecks(mesh), Names{ "positive orientation" });
  EXPECT_THAT(ValidateMesh(mesh).Summary(), HasSubstr("tetrahedron 0 is inverted"));
}

TEST(MeshValidator, NamesAFlatTetrahedronExactly)
{
  MeshArrays mesh;
  mesh.points = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0.3, 0.3, 0 } };
  mesh.tetrahedra = { Id4{ 0, 1, 2, 3 } };
  EXPECT_EQ(FailedChecks(mesh), Names{ "positive orientation" });
  mesh.points[3].z() = std::numeric_limits<double>::denorm_min();
  EXPECT_TRUE(ValidateMesh(mesh).IsValid());
}

TEST(MeshValidator, AFlippedTetrahedronInsideHasItsNeighboursOnTheSameSide)
{
  auto mesh = FullCubes(2);
  std::swap(mesh.tetrahedra[9][1], mesh.tetrahedra[9][2]);
  mesh.neighbors.clear();
  const auto failed = FailedChecks(mesh);
  EXPECT_TRUE(failed.count("positive orientation"));
  EXPECT_TRUE(failed.count("face manifold"));
}

TEST(MeshValidator, NamesOverlappingTetrahedraOnOneSideOfAFace)
{
  // Both are positive, but both lie above their common face: only the parity of the face tells.
  MeshArrays mesh;
  mesh.points = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 }, { 0.2, 0.2, 2 } };
  mesh.tetrahedra = { Id4{ 0, 1, 2, 3 }, Id4{ 0, 1, 2, 4 } };
  EXPECT_EQ(FailedChecks(mesh), Names{ "face manifold" });
  EXPECT_THAT(ValidateMesh(mesh).Summary(), HasSubstr("face (0, 1, 2) has tetrahedra 0 and 1 on the same side"));
}

TEST(MeshValidator, NamesAFaceOfThreeTetrahedra)
{
  MeshArrays mesh;
  mesh.points = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 }, { 0.2, 0.2, 2 }, { 0, 0, -1 } };
  mesh.tetrahedra = { Id4{ 0, 1, 2, 3 }, Id4{ 0, 1, 2, 4 }, Id4{ 0, 2, 1, 5 } };
  const auto result = ValidateMesh(mesh);
  EXPECT_THAT(Find(result, "face manifold").examples, testing::ElementsAre("face (0, 1, 2) belongs to 3 tetrahedra"));
}

TEST(MeshValidator, NamesAPinchedVertex)
{
  const auto mesh = Cubes(2, [](int i, int j, int k) { return i == j && j == k; });
  EXPECT_EQ(FailedChecks(mesh), Names{ "closed 2-manifold boundary" });
  const auto result = ValidateMesh(mesh);
  EXPECT_EQ(Find(result, "closed 2-manifold boundary").failures, 1u);
  EXPECT_THAT(result.Summary(), HasSubstr("point 7 of the boundary is shared by 2 sheets"));
}

TEST(MeshValidator, NamesAPinchedEdge)
{
  const auto mesh = Cubes(2, [](int i, int j, int k) { return i == j && k == 0; });
  EXPECT_EQ(FailedChecks(mesh), Names{ "closed 2-manifold boundary" });
  const auto result = ValidateMesh(mesh);
  EXPECT_EQ(Find(result, "closed 2-manifold boundary").failures, 1u);
  EXPECT_THAT(result.Summary(), HasSubstr("of the boundary has 4 faces"));
}

TEST(MeshValidator, NamesWrongNeighbours)
{
  auto       mesh = FullCubes(2);
  const auto right = mesh.neighbors;
  const auto inner = std::find_if(right.begin(), right.end(), [](const Id4 & n) { return n[0] >= 0; }) - right.begin();
  const auto fail = [&] { return Find(ValidateMesh(mesh), "face neighbours").failures; };
  mesh.neighbors[inner][0] = -1; // not symmetric
  EXPECT_EQ(fail(), 1u);
  EXPECT_EQ(FailedChecks(mesh), Names{ "face neighbours" });
  mesh.neighbors = right;
  mesh.neighbors[inner][0] = 1000000;
  EXPECT_EQ(fail(), 1u);
  mesh.neighbors = right;
  std::rotate(mesh.neighbors[inner].begin(), mesh.neighbors[inner].begin() + 1, mesh.neighbors[inner].end());
  EXPECT_GE(fail(), 2u);
  mesh.neighbors = right;
  mesh.neighbors.pop_back();
  EXPECT_EQ(fail(), 1u);
}

TEST(MeshValidator, AcceptsAClosedInterfaceInsideAndOneThatReachesTheBoundary)
{
  auto mesh = FullCubes(4);
  SetRegions(mesh, [](const Vector3 & c) { return (c - Vector3(2, 2, 2)).cwiseAbs().maxCoeff() < 1; });
  EXPECT_TRUE(ValidateMesh(mesh).IsValid());
  SetRegions(mesh, [](const Vector3 & c) { return (c.head<2>() - Vector2(2, 2)).cwiseAbs().maxCoeff() < 1; });
  EXPECT_TRUE(ValidateMesh(mesh).IsValid());
}

TEST(MeshValidator, NamesAPinchedInterface)
{
  auto mesh = FullCubes(4);
  // Two inner cubes that meet at an edge, then at a point: the body's own boundary is good.
  const auto cube = [](const Vector3 & c, const Vector3 & corner) {
    return (c - corner - Vector3(0.5, 0.5, 0.5)).cwiseAbs().maxCoeff() < 0.5;
  };
  SetRegions(mesh, [&](const Vector3 & c) { return cube(c, { 1, 1, 1 }) || cube(c, { 2, 2, 1 }); });
  EXPECT_EQ(FailedChecks(mesh), Names{ "interfaces" });
  EXPECT_THAT(ValidateMesh(mesh).Summary(), HasSubstr("of the interface around region 2 has 4 faces"));
  SetRegions(mesh, [&](const Vector3 & c) { return cube(c, { 1, 1, 1 }) || cube(c, { 2, 2, 2 }); });
  EXPECT_EQ(FailedChecks(mesh), Names{ "interfaces" });
  EXPECT_THAT(ValidateMesh(mesh).Summary(), HasSubstr("of the interface around region 2 is shared by 2 sheets"));
}

TEST(MeshValidator, ChecksTheUnionOfAllInnerRegions)
{
  // A medullary core that touches the cortex at nothing: the union of 2 and 3 is one cube, 3 is half of it.
  auto mesh = FullCubes(4);
  SetRegions(mesh, [](const Vector3 & c) { return (c - Vector3(2, 2, 2)).cwiseAbs().maxCoeff() < 1; });
  for (std::size_t t = 0; t < mesh.region.size(); ++t)
  {
    const Id4 & v = mesh.tetrahedra[t];
    double      x = 0;
    for (IdType p : v)
    {
      x += mesh.points[p].x() / 4;
    }
    mesh.region[t] += mesh.region[t] == 2 && x < 2 ? 1 : 0;
  }
  EXPECT_TRUE(ValidateMesh(mesh).IsValid());
  mesh.region.pop_back();
  EXPECT_EQ(FailedChecks(mesh), Names{ "interfaces" });
}

TEST(MeshValidator, NamesUnusedAndCoincidentPoints)
{
  auto mesh = FullCubes(2);
  mesh.points.emplace_back(10, 10, 10);
  EXPECT_EQ(FailedChecks(mesh), Names{ "points" });
  EXPECT_THAT(ValidateMesh(mesh).Summary(), HasSubstr("no tetrahedron uses point 27"));

  // Two tetrahedra that touch with a copy of a point each: 0.0 and -0.0 are the same place.
  MeshArrays apart;
  apart.points = { { 0, 0, 0 },    { 1, 0, 0 },  { 0, 1, 0 },  { 0, 0, 1 },
                   { -0.0, 0, 0 }, { -1, 0, 0 }, { 0, -1, 0 }, { 0, 0, -1 } };
  apart.tetrahedra = { Id4{ 0, 1, 2, 3 }, Id4{ 4, 6, 5, 7 } };
  EXPECT_EQ(FailedChecks(apart), Names{ "points" });
  EXPECT_THAT(ValidateMesh(apart).Summary(), HasSubstr("points 0 and 4 coincide"));
}

TEST(MeshValidator, NamesAnEnclosedVoid)
{
  const auto hollow = Cubes(3, [](int i, int j, int k) { return !(i == 1 && j == 1 && k == 1); });
  EXPECT_EQ(FailedChecks(hollow), Names{ "voids" });
  EXPECT_EQ(ValidateMesh(hollow).boundaryEuler, 4);
  // A body that floats in another's void is no second void.
  const auto nested = Cubes(5, [](int i, int j, int k) {
    const int ring = std::max({ std::abs(i - 2), std::abs(j - 2), std::abs(k - 2) });
    return ring != 1;
  });
  const auto result = ValidateMesh(nested);
  EXPECT_EQ(FailedChecks(nested), Names{ "voids" });
  EXPECT_EQ(Find(result, "voids").failures, 1u);
  EXPECT_EQ(result.components, 2);
}

TEST(MeshValidator, ResultDoesNotDependOnNumbering)
{
  auto mesh = Cubes(4, [](int i, int j, int k) { return (i + 2 * j + 3 * k) % 5 != 0; });
  SetRegions(mesh, [](const Vector3 & c) { return c.norm() < 3; });
  mesh.neighbors.clear();
  const auto before = ValidateMesh(mesh);

  std::mt19937        random(5);
  std::vector<IdType> newId(mesh.points.size());
  std::iota(newId.begin(), newId.end(), 0);
  std::shuffle(newId.begin(), newId.end(), random);
  std::vector<std::size_t> order(mesh.tetrahedra.size());
  std::iota(order.begin(), order.end(), 0u);
  std::shuffle(order.begin(), order.end(), random);
  MeshArrays shuffled;
  shuffled.points.resize(mesh.points.size());
  for (std::size_t p = 0; p < newId.size(); ++p)
  {
    shuffled.points[newId[p]] = mesh.points[p];
  }
  for (std::size_t t : order)
  {
    Id4 v = mesh.tetrahedra[t];
    for (IdType & p : v)
    {
      p = newId[p];
    }
    std::swap(v[0], v[1]);
    std::swap(v[2], v[3]);
    shuffled.tetrahedra.push_back(v);
    shuffled.region.push_back(mesh.region[t]);
  }
  const auto after = ValidateMesh(shuffled);
  ASSERT_EQ(before.checks.size(), after.checks.size());
  for (std::size_t i = 0; i < before.checks.size(); ++i)
  {
    EXPECT_EQ(before.checks[i].failures, after.checks[i].failures) << before.checks[i].name;
  }
  EXPECT_EQ(before.components, after.components);
  EXPECT_EQ(before.boundaryEuler, after.boundaryEuler);
  EXPECT_FALSE(before.IsValid());
}
} // namespace MeshValidatorTests
} // namespace bone
