/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCompactGrid.h"

#include "boneHierarchyIO.h"
#include "boneMeshIO.h"
#include "boneQualityMeasures.h"
#include "boneSurfaceGrid.h"
#include "boneTestFiles.h"
#include "boneTestMeshes.h"

#include <vtkCellData.h>
#include <vtkDoubleArray.h>
#include <vtkFieldData.h>
#include <vtkPoints.h>
#include <vtkTypeUInt8Array.h>

#include <algorithm>

namespace bone
{
using testing::HasSubstr;

namespace CompactGridTests
{
MeshStorageParameters
Compact(double error)
{
  MeshStorageParameters storage;
  storage.compact = true;
  storage.compactError = error;
  return storage;
}

double
LargestDifference(const std::vector<double> & a, const std::vector<double> & b)
{
  double largest = a.size() == b.size() ? 0.0 : 1e300;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
  {
    largest = std::max(largest, std::abs(a[i] - b[i]));
  }
  return largest;
}

Vector3
Single(const Vector3 & x)
{
  std::array<volatile float, 3> rounded; // else GCC 12 drops casts to float and back where it vectorises them
  for (int k = 0; k < 3; ++k)
  {
    rounded[k] = static_cast<float>(x[k]);
  }
  return Vector3(rounded[0], rounded[1], rounded[2]);
}

MeshArrays
Single(MeshArrays mesh)
{
  for (Vector3 & x : mesh.points)
  {
    x = Single(x);
  }
  return mesh;
}

vtkIdType
CountCodes(const MeshArrays & mesh, double error)
{
  return ToCompactGrid(mesh, error)->GetFieldData()->GetArray("DensityCodes")->GetNumberOfTuples();
}

std::string
ErrorOfReading(vtkUnstructuredGrid * grid)
{
  try
  {
    ToMeshArrays(grid);
  }
  catch (const itk::ExceptionObject & error)
  {
    return error.GetDescription();
  }
  return "";
}

using CompactGridTest = FileTest;

TEST_F(CompactGridTest, EverythingIsReadWithinTheStatedError)
{
  for (const std::vector<int> & degrees : std::vector<std::vector<int>>{ { 0 }, { 3 }, { 8 }, { 3, 0, 8, 1 } })
  {
    const MeshArrays mesh = DensityBox(degrees);
    for (const double error : { 0.0, 0.1, 3.0, 700.0 })
    {
      WriteMeshArrays(mesh, Path("c.vtu"), Compact(error));
      const MeshArrays back = ReadMeshArrays(Path("c.vtu"));
      EXPECT_EQ(back.tetrahedra, mesh.tetrahedra);
      EXPECT_EQ(back.neighbors, mesh.neighbors);
      EXPECT_EQ(back.region, mesh.region);
      EXPECT_EQ(back.layer, mesh.layer);
      EXPECT_EQ(back.slice, mesh.slice);
      EXPECT_EQ(back.degree, mesh.degree);
      EXPECT_EQ(back.maximumDegree, mesh.maximumDegree);
      EXPECT_EQ(back.quantity, mesh.quantity);
      // Values are from -200 to 1800.
      const double largest = LargestDifference(back.coefficients, mesh.coefficients);
      EXPECT_LE(largest, (error > 0 ? error : 0.5 * 2000.0 / 65535.0) * (1 + 1e-9));
      EXPECT_GT(largest, 0.0);
      for (std::size_t p = 0; p < mesh.points.size(); ++p)
      {
        EXPECT_EQ(back.points[p], Single(mesh.points[p]));
      }
    }
  }
}

TEST_F(CompactGridTest, ASecondRoundChangesNothing)
{
  for (const double error : { 0.0, 3.0 })
  {
    WriteMeshArrays(DensityBox({ 2, 1 }), Path("a.vtu"), Compact(error));
    const MeshArrays once = ReadMeshArrays(Path("a.vtu"));
    WriteMeshArrays(once, Path("b.vtu"), Compact(error));
    EXPECT_LT(LargestDifference(ReadMeshArrays(Path("b.vtu")).coefficients, once.coefficients), 1e-9);
  }
}

TEST_F(CompactGridTest, ACoefficientTakesAByteWhereItCan)
{
  const MeshArrays mesh = DensityBox({ 2 }); // 120 coefficients over some 2,000
  EXPECT_EQ(CountCodes(mesh, 0.0), 240);
  EXPECT_EQ(CountCodes(mesh, 3.0), 240);
  EXPECT_EQ(CountCodes(mesh, 4.0), 120);
}

TEST_F(CompactGridTest, EachRegionHasItsOwnScale)
{
  MeshArrays mesh = DensityBox({ 1 });
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
  {
    for (int k = 0; k < 4; ++k)
    {
      double & c = mesh.coefficients[4 * t + k];
      c = mesh.region[t] == 1 ? c : 1e-3 * c - 5e5;
    }
  }
  WriteMeshArrays(mesh, Path("c.vtu"), Compact(0.0));
  const MeshArrays back = ReadMeshArrays(Path("c.vtu"));
  for (std::size_t i = 0; i < mesh.coefficients.size(); ++i)
  {
    EXPECT_NEAR(back.coefficients[i], mesh.coefficients[i], mesh.region[i / 4] == 1 ? 0.02 : 2e-5);
  }
  mesh.region.clear(); // one scale then
  WriteMeshArrays(mesh, Path("c.vtu"), Compact(0.0));
  EXPECT_NEAR(LargestDifference(ReadMeshArrays(Path("c.vtu")).coefficients, mesh.coefficients), 3.8, 0.4);
}

TEST_F(CompactGridTest, AConstantDensityIsExact)
{
  MeshArrays mesh = DensityBox({ 2 });
  std::fill(mesh.coefficients.begin(), mesh.coefficients.end(), 0.1);
  for (const double error : { 0.0, 5.0 })
  {
    WriteMeshArrays(mesh, Path("c.vtu"), Compact(error));
    EXPECT_EQ(ReadMeshArrays(Path("c.vtu")).coefficients, mesh.coefficients);
  }
}

TEST_F(CompactGridTest, PointsStayExactWhereSinglePrecisionInverts)
{
  // An inner point next to a face of the boundary.
  MeshArrays mesh;
  mesh.tetrahedra = { { 4, 1, 2, 3 }, { 0, 4, 2, 3 }, { 0, 1, 4, 3 }, { 0, 1, 2, 4 } };
  mesh.neighbors = ComputeFaceNeighbors(mesh.tetrahedra);
  mesh.maximumDegree = 0;
  mesh.degree = { 0, 0, 0, 0 };
  mesh.coefficients = { 1.0, 2.0, 3.0, 4.0 };
  int rounded = 0;
  for (int i = 0; i < 20; ++i)
  {
    const Vector3 origin(211.03 + 0.1 * i, 150.7 - 0.07 * i, 97.3 + 0.013 * i);
    mesh.points = { origin,
                    origin + Vector3(1, 0, 0),
                    origin + Vector3(0, 1, 0),
                    origin + Vector3(0, 0, 1),
                    origin + Vector3(1, 1, 1) * (1.0 - 1e-7) / 3.0 };
    ASSERT_EQ(CountInverted(mesh), 0u);
    const MeshArrays single = Single(mesh);
    WriteMeshArrays(mesh, Path("c.vtu"), Compact(0.0));
    const MeshArrays back = ReadMeshArrays(Path("c.vtu"));
    EXPECT_EQ(CountInverted(back), 0u);
    EXPECT_EQ(back.points, CountInverted(single) > 0 ? mesh.points : single.points);
    rounded += CountInverted(single) > 0 ? 0 : 1;
  }
  EXPECT_GT(rounded, 0);
  EXPECT_LT(rounded, 20);
}

TEST_F(CompactGridTest, PointsStayExactWhereTheBoundaryWouldCross)
{
  // A corner of one body comes close to a face of another.
  MeshArrays mesh;
  mesh.tetrahedra = { { 0, 1, 2, 3 }, { 4, 5, 6, 7 } };
  mesh.neighbors = ComputeFaceNeighbors(mesh.tetrahedra);
  mesh.maximumDegree = 0;
  mesh.degree = { 0, 0 };
  mesh.coefficients = { 1.0, 2.0 };
  const auto crossings = [](const MeshArrays & of) {
    const auto faces = BoundaryFaces(of);
    return FindCrossingTriangles({ faces.begin(), faces.end() }, of.points).size();
  };
  int rounded = 0;
  for (int i = 0; i < 20; ++i)
  {
    const Vector3 origin(211.03 + 0.1 * i, 150.7, 97.3), normal = Vector3(1, 1, 1).normalized();
    const Vector3 tip = origin + Vector3(1, 1, 1) / 3.0 + 1e-7 * normal;
    mesh.points = { origin, origin + Vector3(1, 0, 0),  origin + Vector3(0, 1, 0),  origin + Vector3(0, 0, 1),
                    tip,    tip + Vector3(1, 0.9, 0.2), tip + Vector3(0.2, 1, 0.9), tip + Vector3(0.9, 0.2, 1) };
    ASSERT_EQ(CountInverted(mesh), 0u);
    ASSERT_EQ(crossings(mesh), 0u);
    const MeshArrays single = Single(mesh);
    WriteMeshArrays(mesh, Path("c.vtu"), Compact(0.0));
    const MeshArrays back = ReadMeshArrays(Path("c.vtu"));
    EXPECT_EQ(crossings(back), 0u);
    EXPECT_EQ(back.points, crossings(single) > 0 ? mesh.points : single.points);
    rounded += crossings(single) > 0 ? 0 : 1;
  }
  EXPECT_GT(rounded, 0);
  EXPECT_LT(rounded, 20);
}

TEST_F(CompactGridTest, RefusesWhatItCannotWrite)
{
  EXPECT_THAT(ErrorOf([&] { WriteMeshArrays(DensityBox({}), Path("c.vtu"), Compact(0.0)); }),
              HasSubstr("c.vtu: there is no density"));
  EXPECT_THAT(ErrorOf([&] { WriteMeshArrays(DensityBox({ 2 }), Path("c.vtu"), Compact(1e-3)); }),
              HasSubstr("an error of 0.001 is too small"));
  MeshArrays mesh = DensityBox({ 2 });
  mesh.layer.pop_back();
  EXPECT_THAT(ErrorOf([&] { WriteMeshArrays(mesh, Path("c.vtu"), Compact(0.0)); }), HasSubstr("'Layer'"));
  EXPECT_THAT(Files(), testing::IsEmpty());
}

TEST_F(CompactGridTest, RefusesArraysThatCannotBe)
{
  const auto grid = [] { return ToCompactGrid(DensityBox({ 1 }), 0.0); };
  const auto with = [&grid](const auto & change) {
    const auto changed = grid();
    change(changed.Get());
    return ErrorOfReading(changed);
  };
  EXPECT_EQ(ErrorOfReading(grid()), "");
  EXPECT_THAT(with([](vtkUnstructuredGrid * g) { g->GetFieldData()->RemoveArray("DensityScale"); }),
              HasSubstr("needs an array 'DensityScale'"));
  EXPECT_THAT(with([](vtkUnstructuredGrid * g) { g->GetCellData()->RemoveArray("Degree"); }),
              HasSubstr("needs an array 'Degree'"));
  EXPECT_THAT(with([](vtkUnstructuredGrid * g) { g->GetFieldData()->GetArray("DensityCodes")->Resize(95); }),
              HasSubstr("has 95 entries where 48 or twice as many"));
  EXPECT_THAT(with([](vtkUnstructuredGrid * g) { g->GetCellData()->GetArray("Degree")->SetComponent(3, 0, 2); }),
              HasSubstr("has 96 entries where 54 or twice as many"));
  EXPECT_THAT(with([](vtkUnstructuredGrid * g) { g->GetFieldData()->GetArray("DensityScale")->SetComponent(1, 0, 7); }),
              HasSubstr("no entry for region 2"));
  for (const double step : { -1.0, 1e306, std::nan("") })
  {
    EXPECT_THAT(
      with([step](vtkUnstructuredGrid * g) { g->GetFieldData()->GetArray("DensityScale")->SetComponent(1, 2, step); }),
      HasSubstr("a scale that cannot be at entry 1"));
  }
  EXPECT_THAT(with([](vtkUnstructuredGrid * g) {
                auto both = vtkSmartPointer<vtkDoubleArray>::New();
                both->SetName("DensityCoefficients");
                both->SetNumberOfTuples(g->GetNumberOfCells());
                both->Fill(1.0);
                g->GetCellData()->GetArray("Degree")->Fill(0);
                g->GetCellData()->AddArray(both);
              }),
              HasSubstr("stands for 'DensityCoefficients'"));
}

TEST_F(CompactGridTest, AHierarchyTakesLessSpace)
{
  MeshArrays mesh = DensityBox({ 3 });
  auto       level = DensityMesh<double>::New();
  level->SetArrays(mesh);
  std::vector<DensityHierarchy<>::Level> levels(1);
  levels[0].mesh = level;
  auto hierarchy = DensityHierarchy<>::New();
  hierarchy->SetLevels(levels);
  WriteHierarchy(hierarchy, Path("exact"));
  WriteHierarchy(hierarchy, Path("compact"), Compact(1.0));
  EXPECT_LT(ReadText("compact_L1.vtu").size(), ReadText("exact_L1.vtu").size());
  const auto back = ReadHierarchy(Path("compact.hierarchy.json"))->GetLevels()[0].mesh->GetArrays();
  EXPECT_LE(LargestDifference(back.coefficients, mesh.coefficients), 1.0 + 1e-9);
}
} // namespace CompactGridTests
} // namespace bone
