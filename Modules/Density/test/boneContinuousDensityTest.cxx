/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneContinuousDensity.h"

#include "boneBernstein.h"
#include "boneDensityTestMeshes.h"
#include "boneSharedCoefficients.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace ContinuousDensityTests
{
using namespace bone;

MeshArrays
RandomDensity(int degree, unsigned seed)
{
  MeshArrays                             mesh = test::MakeBlock({ { 4, 2, 2 } }, Vector3(0, 0, 0), 3.0, 0.2);
  std::mt19937                           random(seed);
  std::uniform_real_distribution<double> uniform(0, 1000);
  mesh.maximumDegree = degree;
  mesh.degree.assign(mesh.tetrahedra.size(), degree);
  mesh.coefficients.resize(mesh.tetrahedra.size() * BernsteinCount(degree));
  std::generate(mesh.coefficients.begin(), mesh.coefficients.end(), [&] { return uniform(random); });
  return mesh;
}

double
Volume(const MeshArrays & mesh, std::size_t t)
{
  const Id4 & v = mesh.tetrahedra[t];
  return SignedVolume(mesh.points[v[0]], mesh.points[v[1]], mesh.points[v[2]], mesh.points[v[3]]);
}

/** Integral over region r of (f - g) h. */
double
Moment(const MeshArrays & f, const MeshArrays & g, const std::vector<double> & h)
{
  const int         n = f.maximumDegree;
  const std::size_t count = BernsteinCount(n);
  double            sum = 0;
  for (std::size_t t = 0; t < f.tetrahedra.size(); ++t)
  {
    std::vector<double> difference(count);
    for (std::size_t c = 0; c < count; ++c)
    {
      difference[c] = f.coefficients[t * count + c] - g.coefficients[t * count + c];
    }
    sum += BernsteinInnerProduct(n, difference.data(), n, &h[t * count], Volume(f, t));
  }
  return sum;
}

class ContinuousOfDegree : public testing::TestWithParam<int>
{
};

TEST_P(ContinuousOfDegree, IsContinuousWithinRegionsAndJumpsBetweenThem)
{
  const int         degree = GetParam();
  MeshArrays        mesh = RandomDensity(degree, 3);
  const std::size_t count = BernsteinCount(degree);
  MakeDensityContinuous(mesh, bone::Execution());
  // Values on the points of a lattice that all lie on vertices, edges and faces: the same from every tetrahedron.
  std::map<std::pair<int, std::array<long, 3>>, double> seen;
  std::map<std::array<long, 3>, double>                 anyRegion;
  int                                                   shared = 0, jumps = 0;
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
  {
    for (const auto & e : BernsteinExponents(4))
    {
      if (*std::min_element(e.begin(), e.end()) > 0)
      {
        continue;
      }
      const Barycentric mu = Barycentric(e[0], e[1], e[2], e[3]) / 4;
      Vector3           x = Vector3::Zero();
      for (int i = 0; i < 4; ++i)
      {
        x += mu[i] * mesh.points[mesh.tetrahedra[t][i]];
      }
      const std::array<long, 3> place = { std::lround(1e6 * x[0]), std::lround(1e6 * x[1]), std::lround(1e6 * x[2]) };
      const double              value = BernsteinValue(degree, &mesh.coefficients[t * count], mu);
      const auto [entry, fresh] = seen.insert({ { mesh.region[t], place }, value });
      EXPECT_NEAR(entry->second, value, 1e-6);
      shared += fresh ? 0 : 1;
      const auto [other, alone] = anyRegion.insert({ place, value });
      jumps += !alone && std::abs(other->second - value) > 1 ? 1 : 0;
    }
  }
  EXPECT_GT(shared, 500);
  EXPECT_GT(jumps, 5);
}

TEST_P(ContinuousOfDegree, IsTheNearestContinuousDensity)
{
  const int                     degree = GetParam();
  const MeshArrays              before = RandomDensity(degree, 5);
  MeshArrays                    after = before;
  const ContinuousDensityReport report = MakeDensityContinuous(after, bone::Execution(), 1e-11);
  EXPECT_LE(report.residual, 1e-11);
  // What is left is orthogonal to every continuous spline: here to random ones.
  const SharedCoefficients               shared = ShareCoefficients(before, degree);
  std::mt19937                           random(9);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int trial = 0; trial < 3; ++trial)
  {
    std::vector<double> free(shared.size), h(shared.global.size());
    std::generate(free.begin(), free.end(), [&] { return uniform(random); });
    for (std::size_t use = 0; use < h.size(); ++use)
    {
      h[use] = free[shared.global[use]];
    }
    EXPECT_NEAR(Moment(before, after, h), 0, 1e-4);
  }
  EXPECT_GT(std::abs(Moment(before, after, before.coefficients)), 1e4);
}

TEST_P(ContinuousOfDegree, KeepsADensityThatIsContinuousAlready)
{
  MeshArrays mesh = RandomDensity(GetParam(), 7);
  MakeDensityContinuous(mesh, bone::Execution(), 1e-11);
  MeshArrays again = mesh;
  MakeDensityContinuous(again, bone::Execution(), 1e-11);
  for (std::size_t c = 0; c < mesh.coefficients.size(); ++c)
  {
    ASSERT_NEAR(again.coefficients[c], mesh.coefficients[c], 1e-5);
  }
}

TEST_P(ContinuousOfDegree, SharesAsManyCoefficientsAsTheMeshHasPlacesForThem)
{
  const int        n = GetParam();
  const MeshArrays mesh = RandomDensity(n, 1);
  // Of each region alone: vertices, edges, faces and cells of a block of 2 x 2 x 2 cubes split in six.
  const std::size_t vertices = 27, cells = 48, faces = (4 * cells + 48) / 2, edges = vertices + faces - cells - 1;
  const std::size_t expected = vertices + edges * (n - 1) + faces * ((n - 1) * (n - 2) / 2) +
                               cells * static_cast<std::size_t>((n - 1) * (n - 2) * (n - 3) / 6);
  EXPECT_EQ(ShareCoefficients(mesh, n).size, 2 * expected);
}

INSTANTIATE_TEST_SUITE_P(ContinuousDensity, ContinuousOfDegree, testing::Values(1, 2, 3, 5, 8));

TEST(ContinuousDensity, RefusesMixedDegreesDegreeZeroAndInvertedCells)
{
  MeshArrays mesh = RandomDensity(2, 1);
  mesh.degree[3] = 1;
  EXPECT_THROW(MakeDensityContinuous(mesh, bone::Execution()), std::invalid_argument);
  mesh = RandomDensity(0, 1);
  EXPECT_THROW(MakeDensityContinuous(mesh, bone::Execution()), std::invalid_argument);
  mesh = RandomDensity(1, 1);
  std::swap(mesh.tetrahedra[0][0], mesh.tetrahedra[0][1]);
  EXPECT_THROW(MakeDensityContinuous(mesh, bone::Execution()), std::invalid_argument);
}
} // namespace ContinuousDensityTests
