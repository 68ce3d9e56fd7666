/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneLevelDensity.h"

#include "../../Core/test/boneTestBodies.h"

#include <gtest/gtest.h>

using namespace bone;

TEST(LevelDensity, RefitOfUnchangedCellsReproducesAndKeptCellsAreCopied)
{
  auto mesh = test::MakeBall(3, { 1, 2 }, 10, 0.1, 1);
  test::SetDensity(mesh, 2, [](const Vector3 & x) { return x.squaredNorm(); });
  const DensitySamples samples(mesh);
  std::vector<IdType>  slots, parents, sampleCell(samples.All().size());
  for (IdType t = 0; t < static_cast<IdType>(mesh.tetrahedra.size()); ++t)
  {
    slots.push_back(t);
    parents.push_back(t % 2 == 0 ? t : -1);
    for (int s : samples.InCell(t))
    {
      sampleCell[s] = t;
    }
  }
  MeshArrays level = mesh;
  level.coefficients.clear();
  const LevelDensity density(mesh, parents, slots, samples, sampleCell, Execution());
  density.Fit(level, 2);
  ASSERT_EQ(level.coefficients.size(), mesh.coefficients.size());
  for (std::size_t i = 0; i < mesh.coefficients.size(); ++i)
  {
    const bool kept = i / BernsteinCount(2) % 2 == 0;
    EXPECT_NEAR(level.coefficients[i], mesh.coefficients[i], kept ? 0.0 : 1e-8);
  }
  EXPECT_EQ(level.quantity, mesh.quantity);
  EXPECT_NEAR(density.Error(level), 0.0, 1e-9);
  for (double & c : level.coefficients)
  {
    c += 5;
  }
  EXPECT_NEAR(density.Error(level), 5.0, 1e-9);
}

TEST(DensitySamples, RemovingAVertexCostsNothingWhereThePolynomialGoesOn)
{
  auto mesh = test::MakeBall(3, { 1, 2 }, 10, 0.1, 1);
  test::SetDensity(mesh, 1, [](const Vector3 & x) { return 3 * x.x() - x.y() + 5; });
  const TetraComplex   complex(mesh);
  const DensitySamples samples(mesh);
  EXPECT_EQ(samples.All().size(), 10 * mesh.tetrahedra.size());
  double volume = 0;
  for (const auto & sample : samples.All())
  {
    volume += sample.weight;
  }
  double expected = 0;
  for (const Id4 & t : mesh.tetrahedra)
  {
    expected += SignedVolume(mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]], mesh.points[t[3]]);
  }
  EXPECT_NEAR(volume, expected, 1e-9 * expected);
  for (IdType v = 0; v < 40; ++v)
  {
    EXPECT_NEAR(samples.RemovalCost(complex, v), 0.0, 1e-5);
  }
  auto rough = mesh;
  rough.coefficients[7] += 100;
  const DensitySamples other(rough);
  EXPECT_GT(other.RemovalCost(complex, rough.tetrahedra[1][3]), 1.0);
}
