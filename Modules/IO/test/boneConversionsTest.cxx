/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneConversions.h"

#include "boneTestMeshes.h"

#include <itkTriangleCell.h>

#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkFieldData.h>
#include <vtkPointData.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace bone
{
namespace ConversionsTests
{
using testing::HasSubstr;

template <typename TAction>
std::string
ErrorOf(TAction && action)
{
  try
  {
    action();
  }
  catch (const itk::ExceptionObject & error)
  {
    return error.GetDescription();
  }
  return "no exception was thrown";
}

TEST(Conversions, GridHasTheNamedArraysWithTheirTypes)
{
  const auto grid = ToVtkUnstructuredGrid(DensityBox({ 2 }));
  const auto expect = [&](vtkFieldData * data, const char * name, int type, int components) {
    auto * array = data->GetArray(name);
    ASSERT_NE(array, nullptr) << name;
    EXPECT_EQ(array->GetDataType(), type) << name;
    EXPECT_EQ(array->GetNumberOfComponents(), components) << name;
  };
  expect(grid->GetCellData(), "Region", VTK_INT, 1);
  expect(grid->GetPointData(), "Layer", VTK_INT, 1);
  expect(grid->GetPointData(), "Slice", VTK_INT, 1);
  expect(grid->GetCellData(), "Degree", VTK_INT, 1);
  expect(grid->GetCellData(), "DensityCoefficients", VTK_DOUBLE, 10);
  expect(grid->GetFieldData(), "DensityQuantity", VTK_INT, 1);
  expect(grid->GetPointData(), "Density", VTK_FLOAT, 1);
  EXPECT_EQ(grid->GetCellData()->GetArray("FaceNeighbors")->GetDataTypeSize(), 8);
  EXPECT_EQ(grid->GetCellData()->GetArray("FaceNeighbors")->GetNumberOfComponents(), 4);
  EXPECT_EQ(grid->GetPoints()->GetDataType(), VTK_DOUBLE);
}

TEST(Conversions, PointDensityIsTheMeanOfTheValuesAtTheCorners)
{
  // Every tetrahedron holds the same field, x, by its values at the control points: the mean must be x itself.
  auto mesh = DensityBox({ 3 });
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
  {
    std::size_t k = 0;
    for (int i = 3; i >= 0; --i)
    {
      for (int j = 3 - i; j >= 0; --j)
      {
        for (int m = 3 - i - j; m >= 0; --m, ++k)
        {
          const Id4 &   v = mesh.tetrahedra[t];
          const Vector3 x = (i * mesh.points[v[0]] + j * mesh.points[v[1]] + m * mesh.points[v[2]] +
                             (3 - i - j - m) * mesh.points[v[3]]) /
                            3;
          mesh.coefficients[20 * t + k] = x.x();
        }
      }
    }
  }
  const auto grid = ToVtkUnstructuredGrid(mesh);
  for (std::size_t p = 0; p < mesh.points.size(); ++p)
  {
    EXPECT_NEAR(grid->GetPointData()->GetArray("Density")->GetComponent(p, 0), mesh.points[p].x(), 1e-5);
  }
  vtkDataArray * const mean = grid->GetCellData()->GetScalars();
  ASSERT_STREQ(mean->GetName(), "MeanDensity");
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
  {
    double centre = 0.0;
    for (const IdType v : mesh.tetrahedra[t])
    {
      centre += 0.25 * mesh.points[v].x();
    }
    EXPECT_NEAR(mean->GetComponent(static_cast<vtkIdType>(t), 0), centre, 1e-5);
  }
}

TEST(Conversions, PointDensityIsOfOneRegion)
{
  MeshArrays mesh = DensityBox({ 1 });
  mesh.region.assign(mesh.tetrahedra.size(), 1);
  mesh.region.back() = 2;
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
  {
    std::fill_n(
      mesh.coefficients.begin() + static_cast<std::ptrdiff_t>(4 * t), 4, mesh.region[t] == 2 ? 100.0 : 1000.0);
  }
  const auto grid = ToVtkUnstructuredGrid(mesh);
  const Id4  inner = mesh.tetrahedra.back();
  for (std::size_t p = 0; p < mesh.points.size(); ++p)
  {
    const bool inside = std::find(inner.begin(), inner.end(), static_cast<IdType>(p)) != inner.end();
    EXPECT_EQ(grid->GetPointData()->GetArray("Density")->GetComponent(static_cast<vtkIdType>(p), 0),
              inside ? 100 : 1000);
  }
}

TEST(Conversions, GridAndBack)
{
  for (const auto & degrees : { std::vector<int>{}, { 0 }, { 4, 2 } })
  {
    const auto mesh = DensityBox(degrees);
    const auto back = ToMeshArrays(ToVtkUnstructuredGrid(mesh));
    EXPECT_EQ(back.points, mesh.points);
    EXPECT_EQ(back.tetrahedra, mesh.tetrahedra);
    EXPECT_EQ(back.coefficients, mesh.coefficients);
    EXPECT_EQ(back.degree, mesh.degree);
    EXPECT_EQ(back.region, mesh.region);
    EXPECT_EQ(back.quantity, mesh.quantity);
  }
}

TEST(Conversions, GridWithNumbersThatAreNotFiniteIsRefused)
{
  auto grid = ToVtkUnstructuredGrid(DensityBox({ 1 }));
  grid->GetCellData()->GetArray("DensityCoefficients")->SetComponent(5, 2, std::numeric_limits<double>::quiet_NaN());
  EXPECT_THAT(ErrorOf([&] { ToMeshArrays(grid); }), HasSubstr("coefficient 2 of tetrahedron 5 is not finite"));
  grid = ToVtkUnstructuredGrid(DensityBox({}));
  grid->GetPoints()->SetPoint(4, 0, 0, std::numeric_limits<double>::infinity());
  EXPECT_THAT(ErrorOf([&] { ToMeshArrays(grid); }), HasSubstr("point 4 has a coordinate that is not finite"));
  grid = ToVtkUnstructuredGrid(DensityBox({}));
  grid->GetCellData()->GetArray("Region")->SetNumberOfTuples(3);
  EXPECT_THAT(ErrorOf([&] { ToMeshArrays(grid); }), HasSubstr("'Region' has 3 entries where 12"));
}

TEST(Conversions, ItkMeshAndBack)
{
  const auto arrays = DensityBox({ 2 });
  auto       mesh = DensityMesh<float>::New();
  mesh->SetArrays(arrays);
  const auto itkMesh = ToItkMesh(mesh.GetPointer());
  EXPECT_EQ(itkMesh->GetNumberOfPoints(), arrays.points.size());
  EXPECT_EQ(itkMesh->GetNumberOfCells(), arrays.tetrahedra.size());
  const auto back = ToMeshArrays(itkMesh.GetPointer());
  EXPECT_EQ(back.points, mesh->GetArrays().points);
  EXPECT_EQ(back.tetrahedra, arrays.tetrahedra);
  EXPECT_EQ(back.neighbors, arrays.neighbors);
  EXPECT_EQ(back.region, arrays.region);
  EXPECT_EQ(back.layer, arrays.layer);
}

TEST(Conversions, ItkMeshWithTrianglesOrWithoutCellsIsRefused)
{
  auto mesh = ItkMesh::New();
  EXPECT_THAT(ErrorOf([&] { ToMeshArrays(mesh.GetPointer()); }), HasSubstr("no tetrahedra"));
  for (int p = 0; p < 3; ++p)
  {
    ItkMesh::PointType point;
    point.Fill(p);
    mesh->SetPoint(p, point);
  }
  ItkMesh::CellAutoPointer cell;
  cell.TakeOwnership(new itk::TriangleCell<ItkMesh::CellType>);
  for (int i = 0; i < 3; ++i)
  {
    cell->SetPointId(i, i);
  }
  mesh->SetCell(0, cell);
  EXPECT_THAT(ErrorOf([&] { ToMeshArrays(mesh.GetPointer()); }), HasSubstr("cell 0 is no tetrahedron"));
}
} // namespace ConversionsTests
} // namespace bone
