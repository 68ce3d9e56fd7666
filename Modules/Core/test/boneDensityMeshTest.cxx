/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneDensityMesh.h"

#include "boneDensityHierarchy.h"
#include "boneTestBodies.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

namespace bone
{
namespace DensityMeshTests
{
using testing::HasSubstr;

MeshArrays
OneTetrahedron()
{
  MeshArrays mesh;
  mesh.points = { { 0.1, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1.0 / 3 } };
  mesh.tetrahedra = { Id4{ 0, 1, 2, 3 } };
  mesh.layer = { 0, 0, 0, 1 };
  mesh.slice = { 0, 0, 0, 1 };
  mesh.region = { 1 };
  mesh.degree = { 1 };
  mesh.maximumDegree = 1;
  mesh.coefficients = { 1, 2, 3, 4 };
  mesh.quantity = DensityQuantity::HounsfieldUnit;
  return mesh;
}

template <typename TChange>
std::string
ErrorOf(TChange && change)
{
  auto arrays = OneTetrahedron();
  change(arrays);
  try
  {
    DensityMesh<>::New()->SetArrays(arrays);
  }
  catch (const itk::ExceptionObject & error)
  {
    return error.GetDescription();
  }
  return "no exception was thrown";
}

template <typename TCoordinate>
class DensityMeshTest : public testing::Test
{
};
using Coordinates = testing::Types<double, float>;
TYPED_TEST_SUITE(DensityMeshTest, Coordinates);

TYPED_TEST(DensityMeshTest, HoldsWhatItWasGiven)
{
  auto       mesh = DensityMesh<TypeParam>::New();
  const auto arrays = OneTetrahedron();
  mesh->SetArrays(arrays);
  EXPECT_EQ(mesh->GetNumberOfPoints(), 4u);
  EXPECT_EQ(mesh->GetNumberOfTetrahedra(), 1);
  const auto back = mesh->GetArrays();
  for (int p = 0; p < 4; ++p)
  {
    for (int k = 0; k < 3; ++k)
    {
      EXPECT_EQ(back.points[p][k], static_cast<double>(static_cast<TypeParam>(arrays.points[p][k])));
    }
  }
  EXPECT_EQ(back.tetrahedra, arrays.tetrahedra);
  EXPECT_EQ(back.layer, arrays.layer);
  EXPECT_EQ(back.slice, arrays.slice);
  EXPECT_EQ(back.region, arrays.region);
  EXPECT_EQ(back.degree, arrays.degree);
  EXPECT_EQ(back.coefficients, arrays.coefficients);
  EXPECT_EQ(back.maximumDegree, 1);
  EXPECT_EQ(back.quantity, DensityQuantity::HounsfieldUnit);
}

TYPED_TEST(DensityMeshTest, ComputesMissingNeighbours)
{
  auto mesh = DensityMesh<TypeParam>::New();
  mesh->SetArrays(OneTetrahedron());
  EXPECT_EQ(mesh->GetFaceNeighbors(), std::vector<Id4>(1, Id4{ -1, -1, -1, -1 }));
}

TYPED_TEST(DensityMeshTest, GraftSharesTheContentAndNothingElse)
{
  auto mesh = DensityMesh<TypeParam>::New();
  mesh->SetArrays(OneTetrahedron());
  auto other = DensityMesh<TypeParam>::New();
  other->Graft(mesh);
  EXPECT_EQ(other->GetArrays().points, mesh->GetArrays().points);
  EXPECT_EQ(other->GetTetrahedra(), mesh->GetTetrahedra());
  mesh->Initialize();
  EXPECT_EQ(mesh->GetNumberOfTetrahedra(), 0);
  EXPECT_EQ(mesh->GetNumberOfPoints(), 0u);
  EXPECT_EQ(other->GetNumberOfTetrahedra(), 1);
  EXPECT_EQ(other->GetNumberOfPoints(), 4u);
  EXPECT_THROW(other->Graft(DensityHierarchy<>::New()), itk::ExceptionObject);
}

TYPED_TEST(DensityMeshTest, SetArraysIsAModification)
{
  auto       mesh = DensityMesh<TypeParam>::New();
  const auto before = mesh->GetMTime();
  mesh->SetArrays(OneTetrahedron());
  EXPECT_GT(mesh->GetMTime(), before);
}

TEST(DensityMesh, AnEmptyMeshIsEmpty)
{
  auto mesh = DensityMesh<>::New();
  EXPECT_EQ(mesh->GetNumberOfTetrahedra(), 0);
  EXPECT_TRUE(mesh->GetArrays().points.empty());
  mesh->SetArrays({});
  EXPECT_EQ(mesh->GetNumberOfPoints(), 0u);
}

TEST(DensityMesh, RefusesIdsOutOfRangeAndWrongLengths)
{
  EXPECT_THAT(ErrorOf([](auto & m) { m.tetrahedra[0][2] = 4; }), HasSubstr("names point 4, but there are 4 points"));
  EXPECT_THAT(ErrorOf([](auto & m) { m.tetrahedra[0][2] = -1; }), HasSubstr("names point -1"));
  EXPECT_THAT(ErrorOf([](auto & m) { m.layer.pop_back(); }), HasSubstr("'layer' has 3 entries where 4"));
  EXPECT_THAT(ErrorOf([](auto & m) { m.slice.push_back(1); }), HasSubstr("'slice' has 5 entries where 4"));
  EXPECT_THAT(ErrorOf([](auto & m) { m.region.push_back(1); }), HasSubstr("'region' has 2 entries where 1"));
  EXPECT_THAT(ErrorOf([](auto & m) { m.neighbors.resize(2); }), HasSubstr("'neighbors' has 2 entries where 1"));
  EXPECT_THAT(ErrorOf([](auto & m) { m.coefficients.pop_back(); }), HasSubstr("needs 4 coefficients"));
  EXPECT_THAT(ErrorOf([](auto & m) { m.degree.clear(); }), HasSubstr("degree"));
}

TEST(DensityMesh, PrintsItsCounts)
{
  auto mesh = DensityMesh<>::New();
  mesh->SetArrays(OneTetrahedron());
  std::ostringstream text;
  mesh->Print(text);
  EXPECT_THAT(text.str(), testing::AllOf(HasSubstr("Tetrahedra: 1"), HasSubstr("DensityQuantity: HU")));
}

TEST(DensityHierarchy, HoldsItsLevels)
{
  auto                                   mesh = DensityMesh<>::New();
  auto                                   hierarchy = DensityHierarchy<>::New();
  std::vector<DensityHierarchy<>::Level> levels(2);
  mesh->SetArrays(OneTetrahedron());
  levels[0].mesh = mesh;
  levels[1].mesh = DensityMesh<>::New();
  hierarchy->SetLevels(levels);
  EXPECT_EQ(hierarchy->GetNumberOfLevels(), 2u);
  EXPECT_EQ(hierarchy->GetMesh(0), mesh.GetPointer());
  auto other = DensityHierarchy<>::New();
  other->Graft(hierarchy);
  EXPECT_EQ(other->GetMesh(0), mesh.GetPointer());
  std::ostringstream text;
  hierarchy->Print(text);
  EXPECT_THAT(text.str(), HasSubstr("Level 1: 1 tetrahedra"));
  hierarchy->Initialize();
  EXPECT_EQ(hierarchy->GetNumberOfLevels(), 0u);
  EXPECT_THROW(hierarchy->Graft(mesh), itk::ExceptionObject);
}

TEST(DensityHierarchy, PicksTheLevelThatIsJustGoodEnough)
{
  auto                                   hierarchy = DensityHierarchy<>::New();
  std::vector<DensityHierarchy<>::Level> levels(3);
  for (int k = 0; k < 3; ++k)
  {
    levels[k].mesh = DensityMesh<>::New();
    levels[k].mesh->SetArrays(test::MakeBall(4 - k, { 1, 1 }, 10, 0.0, 1));
    levels[k].densityError = 10.0 * k;
    levels[k].surfaceError = 0.5 * k;
  }
  hierarchy->SetLevels(levels);
  const auto count = [&](int k) { return levels[k].mesh->GetNumberOfTetrahedra(); };
  EXPECT_EQ(hierarchy->PickByCount(count(0)), 0u);
  EXPECT_EQ(hierarchy->PickByCount(count(0) - 1), 1u);
  EXPECT_EQ(hierarchy->PickByCount(1), 2u);
  EXPECT_EQ(hierarchy->PickByError(9.0), 0u);
  EXPECT_EQ(hierarchy->PickByError(10.0), 1u);
  EXPECT_EQ(hierarchy->PickByError(100.0), 2u);
  EXPECT_EQ(hierarchy->PickByError(100.0, 0.7), 1u);
  // Twice as large on the detector at the body's near side: 1 mm is 0.5 mm there.
  XRayGeometry::View view;
  view.source = { 0, -110, 0 };
  view.detectorOrigin = { -100, 90, 100 };
  auto geometry = XRayGeometry::New();
  geometry->SetView(view);
  EXPECT_EQ(hierarchy->PickByPixelSize(*geometry), 1u);
  EXPECT_EQ(hierarchy->PickByPixelSize(*geometry, 0.9), 0u);
  EXPECT_EQ(hierarchy->PickByPixelSize(*geometry, 2.01), 2u);
  view.parallel = true;
  geometry->SetView(view);
  EXPECT_EQ(hierarchy->PickByPixelSize(*geometry), 2u);
}
} // namespace DensityMeshTests
} // namespace bone
