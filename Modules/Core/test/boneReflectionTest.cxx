/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneReflection.h"

#include "boneBernstein.h"

#include <gtest/gtest.h>

namespace ReflectionTests
{
using namespace bone;

MeshArrays
TwoCells()
{
  MeshArrays mesh;
  mesh.points = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 2, 0 }, { 0, 0, 3 }, { 0, 0, -6 } };
  mesh.tetrahedra = { { { 0, 1, 2, 3 } }, { { 1, 0, 2, 4 } } };
  mesh.neighbors = ComputeFaceNeighbors(mesh.tetrahedra);
  mesh.maximumDegree = 3;
  mesh.degree = { 3, 2 };
  for (int i = 0; i < 2 * BernsteinCount(3); ++i)
  {
    mesh.coefficients.push_back(i < BernsteinCount(3) + BernsteinCount(2) ? i * i % 17 : 0);
  }
  return mesh;
}

TEST(Reflection, TwiceIsTheMeshItself)
{
  const MeshArrays mesh = TwoCells(), twice = ReflectMesh(ReflectMesh(mesh));
  EXPECT_EQ(twice.points, mesh.points);
  EXPECT_EQ(twice.tetrahedra, mesh.tetrahedra);
  EXPECT_EQ(twice.neighbors, mesh.neighbors);
  EXPECT_EQ(twice.coefficients, mesh.coefficients);
}

TEST(Reflection, CellsStayPositiveAndNeighboursRight)
{
  const MeshArrays mirror = ReflectMesh(TwoCells());
  for (const Id4 & ids : mirror.tetrahedra)
  {
    EXPECT_GT(SignedVolume(mirror.points[ids[0]], mirror.points[ids[1]], mirror.points[ids[2]], mirror.points[ids[3]]),
              0.0);
  }
  EXPECT_EQ(mirror.neighbors, ComputeFaceNeighbors(mirror.tetrahedra));
}

TEST(Reflection, TheDensityIsReflectedToo)
{
  const MeshArrays mesh = TwoCells(), mirror = ReflectMesh(mesh);
  const auto       value = [](const MeshArrays & of, std::size_t t, const Vector3 & x) {
    const Id4 & ids = of.tetrahedra[t];
    return BernsteinValue(
      of.degree[t],
      &of.coefficients[t * static_cast<std::size_t>(BernsteinCount(3))],
      BarycentricCoordinates(x, of.points[ids[0]], of.points[ids[1]], of.points[ids[2]], of.points[ids[3]]));
  };
  for (const Vector3 & x : { Vector3(0.1, 0.2, 0.3), Vector3(0.4, 0.3, 0.6) })
  {
    EXPECT_NEAR(value(mirror, 0, Vector3(-x[0], x[1], x[2])), value(mesh, 0, x), 1e-12);
    EXPECT_NEAR(value(mirror, 1, Vector3(-x[0], x[1], -x[2])), value(mesh, 1, Vector3(x[0], x[1], -x[2])), 1e-12);
  }
}
} // namespace ReflectionTests
