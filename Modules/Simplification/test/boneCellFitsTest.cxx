/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCellFits.h"

#include "boneCollapseProperty.h"
#include "boneTetraCollapseFilter.h"

#include <gtest/gtest.h>

using namespace bone;

namespace CellFitsTests
{
using MeshType = DensityMesh<double>;
using FilterType = TetraCollapseFilter<MeshType>;

double
Wavy(const Vector3 & x)
{
  return 500 + 300 * std::sin(x.x() / 9) * std::cos(x.y() / 7) * std::sin(x.z() / 11);
}

MeshArrays
Body(int degree)
{
  test::TubeShape shape;
  shape.around = 12;
  shape.rings = { 2, 2, 1 };
  MeshArrays mesh = test::MakeTube(shape);
  test::SetDensity(mesh, degree, Wavy);
  return mesh;
}

FilterType::Pointer
MakeFilter(const MeshArrays & mesh)
{
  auto input = MeshType::New();
  input->SetArrays(mesh);
  auto filter = FilterType::New();
  filter->SetInput(input);
  filter->SetMaximumVolumeChange(1.0);
  return filter;
}

/** Root mean square difference to the finest level in the worst cell that is none of its own, at 200 points a cell. */
double
LargestCellError(const MeshArrays & finest, const MeshArrays & level)
{
  const TetraLocator locator(finest);
  const std::size_t  row = BernsteinCount(level.maximumDegree), from = BernsteinCount(finest.maximumDegree);
  std::mt19937       random(5);
  std::uniform_real_distribution<double> uniform(1e-9, 1.0);
  double                                 largest = 0.0;
  for (std::size_t t = 0; t < level.tetrahedra.size(); ++t)
  {
    double       square = 0.0;
    const Id4 &  v = level.tetrahedra[t];
    const auto & p = level.points;
    for (int k = 0; k < 200; ++k)
    {
      Barycentric mu(
        -std::log(uniform(random)), -std::log(uniform(random)), -std::log(uniform(random)), -std::log(uniform(random)));
      mu /= mu.sum();
      const auto   place = locator.FindNearest(mu[0] * p[v[0]] + mu[1] * p[v[1]] + mu[2] * p[v[2]] + mu[3] * p[v[3]]);
      const double error = BernsteinValue(level.degree[t], &level.coefficients[row * t], mu) -
                           BernsteinValue(finest.degree[place.cell], &finest.coefficients[from * place.cell], place.mu);
      square += error * error / 200;
    }
    largest = std::max(largest, std::sqrt(square));
  }
  return largest;
}

TEST(CellFits, AFitReproducesWhatItCanAndRaisesItsDegreeForTheRest)
{
  MeshArrays mesh = Body(2);
  test::SetDensity(mesh, 2, [](const Vector3 & x) { return x.x() * x.y() - 0.3 * x.z() * x.z(); });
  const Id4 &                  v = mesh.tetrahedra[7];
  const std::array<Vector3, 4> corners = { mesh.points[v[0]], mesh.points[v[1]], mesh.points[v[2]], mesh.points[v[3]] };
  const CellFits               linear(mesh, 1, -1), raised(mesh, 1, 4);
  const auto                   low = linear.FitCell(corners, 1e-6, -1), high = raised.FitCell(corners, 1e-6, 7);
  EXPECT_EQ(low.degree, 1);
  EXPECT_GT(low.error, 1e-3);
  EXPECT_EQ(high.degree, 2);
  EXPECT_LT(high.error, 1e-9);
  EXPECT_EQ(raised.FitCell(corners, low.error, -1).degree, 1);
}

TEST(CellFits, NoNewCellIsBeyondItsBound)
{
  const MeshArrays mesh = Body(2);
  auto             filter = MakeFilter(mesh);
  filter->SetMaximumCellErrors({ 1.0, 2.0 });
  filter->Update();
  for (int i = 1; i <= 2; ++i)
  {
    const auto & level = filter->GetOutput()->GetLevels()[i];
    EXPECT_EQ(level.stopReason, "cell error bound");
    EXPECT_LE(filter->GetReport()[i - 1].cellError, i);
    EXPECT_GT(filter->GetReport()[i - 1].cellError, 0.8 * i);
    EXPECT_GT(filter->GetReport()[i - 1].refused[static_cast<int>(MeshOperation::Density)], 0u);
    EXPECT_LT(LargestCellError(mesh, level.mesh->GetArrays()), 1.4 * i); // at points of its own
  }
  auto equal = MakeFilter(mesh);
  equal->SetLevels({ filter->GetOutput()->GetMesh(1)->GetNumberOfTetrahedra() });
  equal->Update();
  EXPECT_GT(LargestCellError(mesh, equal->GetOutput()->GetMesh(1)->GetArrays()), 1.4);
}

TEST(CellFits, AWiderBoundLetsGoWhatTheOneBeforeRefused)
{
  const MeshArrays mesh = Body(2);
  auto             filter = MakeFilter(mesh);
  filter->SetMaximumCellErrors({ 0.0, 2.0 });
  filter->Update();
  EXPECT_EQ(filter->GetOutput()->GetMesh(1)->GetNumberOfTetrahedra(), static_cast<IdType>(mesh.tetrahedra.size()));
  EXPECT_LT(filter->GetOutput()->GetMesh(2)->GetNumberOfTetrahedra(), 0.5 * mesh.tetrahedra.size());
}

TEST(CellFits, RaisedDegreesLetMoreCellsGo)
{
  const MeshArrays mesh = Body(1);
  auto             filter = MakeFilter(mesh);
  filter->SetMaximumCellErrors({ 6.0 });
  filter->Update();
  const IdType count = filter->GetOutput()->GetMesh(1)->GetNumberOfTetrahedra();
  filter->SetMaximumDegree(4);
  filter->Update();
  const MeshArrays level = filter->GetOutput()->GetMesh(1)->GetArrays();
  EXPECT_LT(level.tetrahedra.size(), 0.9 * count);
  EXPECT_GT(level.maximumDegree, 1);
  EXPECT_LE(filter->GetReport()[0].cellError, 6.0);
  EXPECT_LT(LargestCellError(mesh, level), 9.0);
}
} // namespace CellFitsTests
