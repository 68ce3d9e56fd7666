/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneMeshArrays.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

namespace bone
{
namespace MeshArraysTests
{
using Triangle = std::array<IdType, 3>;
using testing::ElementsAre;

// Two tetrahedra on the face (1, 2, 3), regions 1 and 2, and a point that neither uses.
MeshArrays
Pair()
{
  MeshArrays mesh;
  mesh.points = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 }, { 9, 9, 9 }, { 1, 1, 1 } };
  mesh.tetrahedra = { Id4{ 0, 1, 2, 3 }, Id4{ 1, 2, 3, 5 } };
  mesh.region = { 1, 2 };
  mesh.layer = { 0, 1, 2, 3, 4, 5 };
  mesh.slice = { 10, 11, 12, 13, 14, 15 };
  mesh.neighbors = ComputeFaceNeighbors(mesh.tetrahedra);
  return mesh;
}

double
EnclosedVolume(const std::vector<Vector3> & points, const std::vector<Triangle> & faces)
{
  double volume = 0;
  for (const auto & f : faces)
  {
    volume += SignedVolume(Vector3::Zero(), points[f[0]], points[f[1]], points[f[2]]);
  }
  return volume;
}

TEST(MeshArrays, TetraFacesLookOutward)
{
  const std::array<Vector3, 4> p = { Vector3(0, 0, 0), Vector3(1, 0, 0), Vector3(0, 1, 0), Vector3(0, 0, 1) };
  ASSERT_GT(SignedVolume(p[0], p[1], p[2], p[3]), 0);
  for (int i = 0; i < 4; ++i)
  {
    const auto & f = TetraFaces[i];
    EXPECT_EQ(std::count(f.begin(), f.end(), i), 0);
    EXPECT_LT(SignedVolume(p[f[0]], p[f[1]], p[f[2]], p[i]), 0) << i;
  }
}

TEST(MeshArrays, OppositeEdgesShareNoVertex)
{
  for (int e = 0; e < 6; ++e)
  {
    std::vector<int> vertices(TetraEdges[e].begin(), TetraEdges[e].end());
    vertices.insert(vertices.end(), TetraEdges[5 - e].begin(), TetraEdges[5 - e].end());
    EXPECT_THAT(vertices, testing::UnorderedElementsAre(0, 1, 2, 3));
  }
}

TEST(MeshArrays, FaceNeighborsLieOppositeTheirVertex)
{
  const auto mesh = Pair();
  EXPECT_THAT(mesh.neighbors, ElementsAre(Id4{ 1, -1, -1, -1 }, Id4{ -1, -1, -1, 0 }));
  EXPECT_TRUE(ComputeFaceNeighbors({}).empty());
}

TEST(MeshArrays, AFaceOfThreeTetrahedraHasNoNeighbours)
{
  const auto neighbors = ComputeFaceNeighbors({ Id4{ 0, 1, 2, 3 }, Id4{ 1, 2, 3, 4 }, Id4{ 1, 2, 3, 5 } });
  for (const Id4 & n : neighbors)
  {
    EXPECT_EQ(n, (Id4{ -1, -1, -1, -1 }));
  }
}

TEST(MeshArrays, UnusedPointsAreRemovedWithTheirAttributes)
{
  auto       mesh = Pair();
  const auto oldId = RemoveUnusedPoints(mesh);
  EXPECT_THAT(oldId, ElementsAre(0, 1, 2, 3, 5));
  EXPECT_EQ(mesh.points.size(), 5u);
  EXPECT_EQ(mesh.points[4], Vector3(1, 1, 1));
  EXPECT_THAT(mesh.layer, ElementsAre(0, 1, 2, 3, 5));
  EXPECT_THAT(mesh.slice, ElementsAre(10, 11, 12, 13, 15));
  EXPECT_EQ(mesh.tetrahedra[1], (Id4{ 1, 2, 3, 4 }));
  EXPECT_THAT(RemoveUnusedPoints(mesh), ElementsAre(0, 1, 2, 3, 4));
}

TEST(MeshArrays, BoundaryFacesEncloseTheVolumeOfTheirRegions)
{
  const auto   mesh = Pair();
  const auto & p = mesh.points;
  const double first = SignedVolume(p[0], p[1], p[2], p[3]), second = SignedVolume(p[1], p[2], p[3], p[5]);
  EXPECT_EQ(BoundaryFaces(mesh).size(), 6u);
  EXPECT_NEAR(EnclosedVolume(p, BoundaryFaces(mesh)), first + second, 1e-14);
  EXPECT_EQ(BoundaryFaces(mesh, 2).size(), 4u);
  EXPECT_NEAR(EnclosedVolume(p, BoundaryFaces(mesh, 2)), second, 1e-14);
  EXPECT_TRUE(BoundaryFaces(mesh, 3).empty());
}

TEST(MeshArrays, BoundaryFacesNeedNeighborsAndRegions)
{
  auto mesh = Pair();
  mesh.region.clear();
  EXPECT_EQ(BoundaryFaces(mesh).size(), 6u);
  EXPECT_THROW(BoundaryFaces(mesh, 1), std::invalid_argument);
  mesh.neighbors.clear();
  EXPECT_THROW(BoundaryFaces(mesh), std::invalid_argument);
}

TEST(MeshArrays, DensityQuantitiesHaveNames)
{
  EXPECT_EQ(DensityQuantityName(DensityQuantity::HounsfieldUnit), "HU");
  EXPECT_EQ(DensityQuantityName(DensityQuantity::AshGramPerCubicCentimetre), "ash g/cm3");
  EXPECT_EQ(DensityQuantityName(static_cast<DensityQuantity>(99)), "unknown");
}
} // namespace MeshArraysTests
} // namespace bone
