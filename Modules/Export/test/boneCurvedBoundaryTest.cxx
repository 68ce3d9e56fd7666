/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCurvedBoundary.h"

#include "boneTestBodies.h"
#include "boneTriangleSurface.h"

#include <gtest/gtest.h>

namespace CurvedBoundaryTests
{
using namespace bone;

constexpr double Radius = 20.0;

MeshArrays
Ball()
{
  MeshArrays mesh = test::MakeBall(3, { 2, 1 }, Radius, 0.0, 1);
  test::SetDensity(mesh, 0, [](const Vector3 &) { return 0.5; });
  mesh.quantity = DensityQuantity::AshGramPerCubicCentimetre;
  return mesh;
}

/** A finer ball's surface about the centre of `mesh`. */
TriangleDistance
Sphere(const MeshArrays & like, double radius)
{
  Vector3 centre = Vector3::Zero();
  double  extent = 0.0;
  for (const Vector3 & x : like.points)
  {
    centre += x / static_cast<double>(like.points.size());
  }
  for (const Vector3 & x : like.points)
  {
    extent = std::max(extent, (x - centre).norm());
  }
  const MeshArrays    fine = test::MakeBall(14, { 14 }, extent, 0.0, 1);
  std::vector<IdType> ids;
  TriangleSurface     surface = ExteriorSurface(fine, ids);
  Vector3             middle = Vector3::Zero();
  for (const Vector3 & x : surface.points)
  {
    middle += x / static_cast<double>(surface.points.size());
  }
  for (Vector3 & x : surface.points)
  {
    x = centre + (x - middle).normalized() * extent * radius;
  }
  return { surface.points, surface.triangles };
}

/** By M. Keast's five points, exact for the cubic determinant: not by its Bernstein coefficients, which are what is
 * tested. */
double
VolumeOf(const FiniteElementModel & model)
{
  double volume = 0.0;
  for (const auto & element : model.elements)
  {
    const auto x = [&](std::size_t i) { return model.nodes[static_cast<std::size_t>(element[i])]; };

    for (int point = 0; point < 5; ++point)
    {
      Eigen::Vector4d mu = Eigen::Vector4d::Constant(point == 4 ? 0.25 : 1.0 / 6.0);
      if (point < 4)
      {
        mu[point] = 0.5;
      }
      Eigen::Matrix<double, 3, 4>                 slope; // by barycentric coordinate
      constexpr std::array<std::array<int, 2>, 6> edges = {
        { { 0, 1 }, { 1, 2 }, { 2, 0 }, { 0, 3 }, { 1, 3 }, { 2, 3 } }
      };
      for (int v = 0; v < 4; ++v)
      {
        slope.col(v) = (4.0 * mu[v] - 1.0) * x(static_cast<std::size_t>(v));
      }
      for (std::size_t n = 0; n < 6; ++n)
      {
        slope.col(edges[n][0]) += 4.0 * mu[edges[n][1]] * x(4 + n);
        slope.col(edges[n][1]) += 4.0 * mu[edges[n][0]] * x(4 + n);
      }
      const Vector3 a = slope.col(1) - slope.col(0), b = slope.col(2) - slope.col(0), c = slope.col(3) - slope.col(0);
      volume += (point == 4 ? -0.8 : 0.45) * a.dot(b.cross(c)) / 6.0;
    }
  }
  return volume;
}

FiniteElementModel
ModelOf(const MeshArrays & mesh)
{
  return MakeFiniteElements(mesh, FindElasticityLaw("keyak1998"));
}

TEST(CurvedBoundary, BringsABallsVolumeToThatOfTheSphere)
{
  const MeshArrays mesh = Ball();
  const auto       straight = ModelOf(mesh);
  auto             model = straight;
  const auto       sphere = Sphere(mesh, 1.0);
  const auto       result = CurveBoundary(sphere, model);
  const double     known = sphere.GetVolume();
  EXPECT_LT(VolumeOf(straight) / known, 0.975);
  EXPECT_NEAR(VolumeOf(model) / known, 1.0, 0.006);
  EXPECT_EQ(result.refused, 0);
  EXPECT_GT(result.largestMove, 0.4);
  IdType on = 0, others = 0;
  for (std::size_t n = mesh.points.size(); n < model.nodes.size(); ++n)
  {
    const bool moved = model.nodes[n] != straight.nodes[n];
    on += moved && std::abs(sphere.FindNearest(model.nodes[n]).distance) < 1e-9 ? 1 : 0;
    others += moved ? 1 : 0;
  }
  EXPECT_EQ(on, result.curved);
  EXPECT_EQ(others, result.curved);
  for (std::size_t n = 0; n < mesh.points.size(); ++n)
  {
    ASSERT_EQ(model.nodes[n], straight.nodes[n]) << "corners stay";
  }
}

TEST(CurvedBoundary, TheJacobianOfStraightElementsIsOne)
{
  const auto model = ModelOf(Ball());
  for (std::size_t e = 0; e < model.elements.size(); ++e)
  {
    ASSERT_NEAR(LeastRelativeJacobian(model, e), 1.0, 1e-9);
  }
}

TEST(CurvedBoundary, TheJacobianIsBelowZeroWhereAnElementFolds)
{
  auto model = ModelOf(Ball());
  // The middle of an edge moved along it by a quarter makes the determinant 0 at the end; by more, negative.
  const auto    a = static_cast<std::size_t>(model.elements[0][0]), b = static_cast<std::size_t>(model.elements[0][1]);
  const auto    middle = static_cast<std::size_t>(model.elements[0][4]);
  const Vector3 from = model.nodes[a], along = model.nodes[b] - from;
  model.nodes[middle] = from + 0.30 * along;
  EXPECT_GT(LeastRelativeJacobian(model, 0), 0.0);
  model.nodes[middle] = from + 0.25 * along;
  EXPECT_NEAR(LeastRelativeJacobian(model, 0), 0.0, 1e-9);
  model.nodes[middle] = from + 0.20 * along;
  EXPECT_LT(LeastRelativeJacobian(model, 0), 0.0);
}

TEST(CurvedBoundary, ElementsThatWouldSufferKeepTheirEdges)
{
  const MeshArrays mesh = Ball();
  for (const double radius : { 0.3, 0.8 })
  {
    auto       model = ModelOf(mesh);
    const auto result = CurveBoundary(Sphere(mesh, radius), model);
    EXPECT_GT(result.refused, 0) << radius;
    for (std::size_t e = 0; e < model.elements.size(); ++e)
    {
      ASSERT_GE(LeastRelativeJacobian(model, e), LeastCurvedJacobian);
    }
  }
}

TEST(CurvedBoundary, FlatCutsStayFlat)
{
  MeshArrays mesh = test::MakeTube({});
  test::SetDensity(mesh, 0, [](const Vector3 &) { return 0.5; });
  mesh.quantity = DensityQuantity::AshGramPerCubicCentimetre;
  const auto straight = ModelOf(mesh);
  auto       model = straight;
  CurveBoundary(Sphere(mesh, 1.0), model);
  std::size_t cuts = 0, moved = 0;
  for (const FiniteElementSet & set : model.nodeSets)
  {
    for (const IdType id : set.ids)
    {
      const auto n = static_cast<std::size_t>(id);
      if (set.name.rfind("CUT_", 0) == 0)
      {
        ++cuts;
        ASSERT_EQ(model.nodes[n], straight.nodes[n]) << set.name;
      }
      moved += model.nodes[n] != straight.nodes[n] ? 1 : 0;
    }
  }
  EXPECT_GT(cuts, 0u);
  EXPECT_GT(moved, 0u);
}

TEST(CurvedBoundary, FourNodesAreRefused)
{
  const MeshArrays        mesh = Ball();
  FiniteElementParameters parameters;
  parameters.order = 1;
  auto model = MakeFiniteElements(mesh, FindElasticityLaw("keyak1998"), parameters);
  EXPECT_THROW(CurveBoundary(Sphere(mesh, 1.0), model), std::invalid_argument);
}
} // namespace CurvedBoundaryTests
