/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneContinuousDensity.h"

#include "boneBernstein.h"
#include "boneDensityTestMeshes.h"
#include "boneMeshValidator.h"
#include "boneWorseyFarinSplit.h"

#include <itkMultiThreaderBase.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace ContinuousGradientTests
{
using namespace bone;

constexpr std::size_t Cubic = BernsteinCount(3);

MeshArrays
RandomBlock(unsigned seed)
{
  MeshArrays mesh = test::MakeBlock({ { 4, 3, 2 } }, Vector3(5, -3, 40), 3.0, 0.3, seed);
  mesh.neighbors = ComputeFaceNeighbors(mesh.tetrahedra);
  return mesh;
}

/** A cubic in each tetrahedron, by the values of f(region, x) at its control points' places. */
template <typename TFunction>
void
Interpolate(const TFunction & f, MeshArrays & mesh)
{
  const auto &    exponents = BernsteinExponents(3);
  Eigen::MatrixXd values(Cubic, Cubic);
  for (std::size_t r = 0; r < Cubic; ++r)
  {
    const auto &    e = exponents[r];
    Eigen::VectorXd basis(Cubic);
    BernsteinBasis(3, Barycentric(e[0], e[1], e[2], e[3]) / 3, basis.data());
    values.row(r) = basis.transpose();
  }
  const Eigen::PartialPivLU<Eigen::MatrixXd> solver(values);
  mesh.maximumDegree = 3;
  mesh.degree.assign(mesh.tetrahedra.size(), 3);
  mesh.coefficients.resize(mesh.tetrahedra.size() * Cubic);
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
  {
    Eigen::VectorXd at(Cubic);
    for (std::size_t r = 0; r < Cubic; ++r)
    {
      Vector3 x = Vector3::Zero();
      for (int i = 0; i < 4; ++i)
      {
        x += exponents[r][i] / 3.0 * mesh.points[mesh.tetrahedra[t][i]];
      }
      at[r] = f(mesh.region[t], x);
    }
    Eigen::Map<Eigen::VectorXd>(&mesh.coefficients[t * Cubic], Cubic) = solver.solve(at);
  }
}

/** Random cubics, of the order of 1000. */
void
FillRandomly(unsigned seed, MeshArrays & mesh)
{
  std::mt19937                           random(seed);
  std::uniform_real_distribution<double> uniform(0, 2000);
  mesh.maximumDegree = 3;
  mesh.degree.assign(mesh.tetrahedra.size(), 3);
  mesh.coefficients.resize(mesh.tetrahedra.size() * Cubic);
  std::generate(mesh.coefficients.begin(), mesh.coefficients.end(), [&] { return uniform(random); });
}

MeshArrays
RandomSpline(const MeshArrays & mesh, unsigned seed)
{
  MeshArrays split = SplitWorseyFarin(mesh);
  FillRandomly(seed, split);
  MakeGradientContinuous(mesh, split, Execution(), 1e-11);
  return split;
}

Vector3
GradientAt(const MeshArrays & mesh, std::size_t t, const Barycentric & mu)
{
  const Id4 &  v = mesh.tetrahedra[t];
  const auto & p = mesh.points;
  return BernsteinGradient(3, &mesh.coefficients[t * Cubic], mu, p[v[0]], p[v[1]], p[v[2]], p[v[3]]);
}

/** Largest jumps of value and gradient across faces, within regions and between them, at 15 places of each face. */
struct Jumps
{
  explicit Jumps(const MeshArrays & mesh)
  {
    const auto neighbors = ComputeFaceNeighbors(mesh.tetrahedra);
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
    {
      for (int face = 0; face < 4; ++face)
      {
        const IdType other = neighbors[t][face];
        if (other > static_cast<IdType>(t))
        {
          this->Add(mesh, t, other, face);
        }
      }
    }
  }

  void
  Add(const MeshArrays & mesh, std::size_t t, std::size_t other, int face)
  {
    const Id4 &v = mesh.tetrahedra[t], &w = mesh.tetrahedra[other];
    double &   value = mesh.region[t] == mesh.region[other] ? valueWithin : valueBetween;
    double &   gradient = mesh.region[t] == mesh.region[other] ? gradientWithin : gradientBetween;
    for (const auto & e : BernsteinExponents(4))
    {
      if (e[face] > 0)
      {
        continue;
      }
      const Barycentric here = Barycentric(e[0], e[1], e[2], e[3]) / 4;
      Barycentric       there = Barycentric::Zero();
      for (int i = 0; i < 4; ++i)
      {
        if (i != face)
        {
          there[std::find(w.begin(), w.end(), v[i]) - w.begin()] = here[i];
        }
      }
      value = std::max(value,
                       std::abs(BernsteinValue(3, &mesh.coefficients[t * Cubic], here) -
                                BernsteinValue(3, &mesh.coefficients[other * Cubic], there)));
      gradient = std::max(gradient, (GradientAt(mesh, t, here) - GradientAt(mesh, other, there)).norm());
    }
  }

  double valueWithin{ 0.0 }, gradientWithin{ 0.0 }, valueBetween{ 0.0 }, gradientBetween{ 0.0 };
};

double
LargestDifference(const MeshArrays & a, const MeshArrays & b)
{
  double largest = 0;
  for (std::size_t c = 0; c < a.coefficients.size(); ++c)
  {
    largest = std::max(largest, std::abs(a.coefficients[c] - b.coefficients[c]));
  }
  return largest;
}

class ContinuousGradientOfMesh : public testing::TestWithParam<unsigned>
{
};

TEST_P(ContinuousGradientOfMesh, HasNoJumpsWithinRegionsAndKeepsThemBetween)
{
  const Jumps jumps(RandomSpline(RandomBlock(GetParam()), GetParam()));
  std::cout << "jumps within regions: " << jumps.valueWithin << " HU, " << jumps.gradientWithin << " HU/mm\n";
  EXPECT_LE(jumps.valueWithin, 1e-9);
  EXPECT_LE(jumps.gradientWithin, 1e-9);
  EXPECT_GT(jumps.valueBetween, 100);
  EXPECT_GT(jumps.gradientBetween, 100);
}

TEST_P(ContinuousGradientOfMesh, ReproducesQuadraticsAndCubicsOfEachRegion)
{
  const MeshArrays mesh = RandomBlock(GetParam());
  const auto       quadratic = [](int region, const Vector3 & x) {
    const Vector3 y = x - Vector3(10, 0, 42);
    return region * 300 + region * 10 * y[0] - 12 * y[1] + 3 * y[0] * y[1] + (region - 3) * 5 * y[2] * y[2] +
           y[1] * y[2];
  };
  const auto cubic = [&](int region, const Vector3 & x) {
    return quadratic(region, x) + 0.1 * std::pow(x[0] - x[1], 3);
  };
  for (const std::function<double(int, const Vector3 &)> & f :
       { std::function<double(int, const Vector3 &)>(quadratic), std::function<double(int, const Vector3 &)>(cubic) })
  {
    MeshArrays given = SplitWorseyFarin(mesh);
    Interpolate(f, given);
    MeshArrays fitted = given;
    MakeGradientContinuous(mesh, fitted, Execution(), 1e-13);
    std::cout << "largest difference of coefficients: " << LargestDifference(given, fitted) << " HU\n";
    EXPECT_LE(LargestDifference(given, fitted), 1e-9);
  }
}

TEST_P(ContinuousGradientOfMesh, SplitIsAValidMeshOfTheSameBody)
{
  const MeshArrays mesh = RandomBlock(GetParam()), split = SplitWorseyFarin(mesh);
  EXPECT_TRUE(ValidateMesh(split).IsValid()) << ValidateMesh(split).Summary();
  ASSERT_EQ(split.tetrahedra.size(), 12 * mesh.tetrahedra.size());
  EXPECT_TRUE(std::equal(mesh.points.begin(), mesh.points.end(), split.points.begin()));
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
  {
    const auto volume = [](const MeshArrays & of, std::size_t cell) {
      const Id4 & v = of.tetrahedra[cell];
      return SignedVolume(of.points[v[0]], of.points[v[1]], of.points[v[2]], of.points[v[3]]);
    };
    double sum = 0;
    for (std::size_t k = 0; k < 12; ++k)
    {
      sum += volume(split, 12 * t + k);
      EXPECT_EQ(split.region[12 * t + k], mesh.region[t]);
    }
    EXPECT_NEAR(sum, volume(mesh, t), 1e-12);
  }
}

INSTANTIATE_TEST_SUITE_P(ContinuousGradient, ContinuousGradientOfMesh, testing::Values(1, 2, 3));

TEST(ContinuousGradient, NeedsFacePointsOnTheLineBetweenTheIncentres)
{
  // Were they the faces' centroids, as at a boundary they might be, values would still meet but gradients would not.
  const MeshArrays mesh = RandomBlock(1);
  MeshArrays       split = SplitWorseyFarin(mesh);
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
  {
    for (int face = 0; face < 4; ++face)
    {
      Vector3 & point = split.points[split.tetrahedra[12 * t + 3 * face][2]];
      point.setZero();
      for (const int v : TetraFaces[face])
      {
        point += mesh.points[mesh.tetrahedra[t][v]] / 3;
      }
    }
  }
  FillRandomly(1, split);
  MakeGradientContinuous(mesh, split, Execution());
  const Jumps jumps(split);
  EXPECT_LE(jumps.valueWithin, 1e-9);
  EXPECT_GT(jumps.gradientWithin, 1);
}

TEST(ContinuousGradient, IsTheNearestSplineWithAContinuousGradient)
{
  const MeshArrays mesh = RandomBlock(4);
  MeshArrays       before = SplitWorseyFarin(mesh);
  FillRandomly(4, before);
  MeshArrays after = before;
  const auto report = MakeGradientContinuous(mesh, after, Execution(), 1e-11);
  EXPECT_LE(report.residual, 1e-11);
  EXPECT_LT(report.iterations, 150);
  // What is left is orthogonal to every such spline, here to another.
  const auto moment = [&](const MeshArrays & with) {
    double sum = 0;
    for (std::size_t t = 0; t < before.tetrahedra.size(); ++t)
    {
      const Id4 &         v = before.tetrahedra[t];
      const auto &        p = before.points;
      std::vector<double> rest(Cubic);
      for (std::size_t c = 0; c < Cubic; ++c)
      {
        rest[c] = before.coefficients[t * Cubic + c] - after.coefficients[t * Cubic + c];
      }
      sum += BernsteinInnerProduct(
        3, rest.data(), 3, &with.coefficients[t * Cubic], SignedVolume(p[v[0]], p[v[1]], p[v[2]], p[v[3]]));
    }
    return sum;
  };
  EXPECT_NEAR(moment(RandomSpline(mesh, 5)), 0, 1e-2);
  EXPECT_GT(moment(before), 1e6);
}

TEST(ContinuousGradient, HasFourFreeCoefficientsAVertexAndTwoAnEdge)
{
  const MeshArrays mesh = test::MakeBlock({ { 4, 2, 2 } }, Vector3(0, 0, 0), 3.0, 0.2);
  MeshArrays       split = SplitWorseyFarin(mesh);
  FillRandomly(1, split);
  // Of each region alone: a block of 2 x 2 x 2 cubes split in six.
  const std::size_t vertices = 27, cells = 48, faces = (4 * cells + 48) / 2, edges = vertices + faces - cells - 1;
  EXPECT_EQ(MakeGradientContinuous(mesh, split, Execution()).freeCoefficients, 2 * (4 * vertices + 2 * edges));
}

TEST(ContinuousGradient, IsTheSameForAnyNumberOfThreads)
{
  const MeshArrays mesh = RandomBlock(2);
  const auto       threads = itk::MultiThreaderBase::GetGlobalDefaultNumberOfThreads();
  const MeshArrays many = RandomSpline(mesh, 3);
  itk::MultiThreaderBase::SetGlobalDefaultNumberOfThreads(1);
  const MeshArrays one = RandomSpline(mesh, 3);
  itk::MultiThreaderBase::SetGlobalDefaultNumberOfThreads(threads);
  EXPECT_EQ(one.coefficients, many.coefficients);
}

TEST(ContinuousGradient, GivesNewPointsTheInnermostLayerAroundThem)
{
  MeshArrays mesh = RandomBlock(1);
  mesh.layer.assign(mesh.points.size(), 0);
  mesh.slice.assign(mesh.points.size(), 7);
  mesh.layer[mesh.tetrahedra[5][2]] = 2;
  const MeshArrays split = SplitWorseyFarin(mesh);
  EXPECT_EQ(split.layer[mesh.points.size() + 5], 2);
  EXPECT_EQ(split.layer[split.tetrahedra[12 * 5 + 3 * 2][2]], 0);
  EXPECT_EQ(split.layer[split.tetrahedra[12 * 5][2]], 2);
  EXPECT_EQ(split.slice.size(), split.points.size());
  EXPECT_EQ(split.slice.back(), 7);
}

TEST(ContinuousGradient, RefusesFlatCellsAndOtherMeshesAndDegrees)
{
  const MeshArrays mesh = RandomBlock(1);
  MeshArrays       flipped = mesh;
  std::swap(flipped.tetrahedra[0][0], flipped.tetrahedra[0][1]);
  EXPECT_THROW(SplitWorseyFarin(flipped), std::invalid_argument);
  MeshArrays split = SplitWorseyFarin(mesh);
  EXPECT_THROW(MakeGradientContinuous(mesh, split, Execution()), std::invalid_argument);
  FillRandomly(1, split);
  EXPECT_THROW(MakeGradientContinuous(split, split, Execution()), std::invalid_argument);
  split.degree[7] = 2;
  EXPECT_THROW(MakeGradientContinuous(mesh, split, Execution()), std::invalid_argument);
}
} // namespace ContinuousGradientTests
