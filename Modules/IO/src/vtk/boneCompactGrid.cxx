/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCompactGrid.h"

#include "boneBernstein.h"
#include "bonePredicates.h"
#include "boneSurfaceGrid.h"
#include "boneVtkArrays.h"

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDoubleArray.h>
#include <vtkFloatArray.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkTypeInt16Array.h>
#include <vtkTypeInt32Array.h>
#include <vtkTypeInt8Array.h>
#include <vtkTypeUInt8Array.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace bone
{
namespace
{
constexpr double MostLevels = 65535.0;

/** The coefficients of one region: code k stands for lowest + k step. */
struct Scale
{
  double lowest{ std::numeric_limits<double>::infinity() };
  double highest{ -std::numeric_limits<double>::infinity() };
  double step{ 0.0 };
};
using Scales = std::map<int, Scale>;

int
RegionOf(const MeshArrays & mesh, std::size_t t)
{
  return mesh.region.empty() ? 0 : mesh.region[t];
}

/** Calls visit(tetrahedron, coefficient) for each coefficient in use, in the order that they are stored in. */
template <typename TMesh, typename TVisit>
void
ForEachCoefficient(TMesh & mesh, TVisit visit)
{
  const std::size_t width = BernsteinCount(mesh.maximumDegree);
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
  {
    for (int k = 0; k < BernsteinCount(mesh.degree[t]); ++k)
    {
      visit(t, mesh.coefficients[t * width + k]);
    }
  }
}

Scales
FindScales(const MeshArrays & mesh, double error)
{
  Scales scales;
  ForEachCoefficient(mesh, [&](std::size_t t, double c) {
    Scale & scale = scales[RegionOf(mesh, t)];
    scale.lowest = std::min(scale.lowest, c);
    scale.highest = std::max(scale.highest, c);
  });
  for (auto & [region, scale] : scales)
  {
    const double least = (scale.highest - scale.lowest) / MostLevels;
    scale.step = error > 0 ? 2.0 * error : least;
    if (scale.step < least)
    {
      Refuse("the compact form has 16 bits, which change the density of region ",
             region,
             " by up to ",
             0.5 * least,
             "; an error of ",
             error,
             " is too small: give a larger one, or 0");
    }
  }
  return scales;
}

/** All low bytes, then all high bytes where there is one that is not 0: the latter compress to little. */
std::vector<unsigned char>
Encode(const MeshArrays & mesh, const Scales & scales)
{
  std::vector<unsigned char> low, high;
  ForEachCoefficient(mesh, [&](std::size_t t, double c) {
    const Scale & scale = scales.at(RegionOf(mesh, t));
    const auto    code = scale.step > 0 ? static_cast<unsigned int>(std::lround((c - scale.lowest) / scale.step)) : 0U;
    low.push_back(static_cast<unsigned char>(code & 0xFF));
    high.push_back(static_cast<unsigned char>(code >> 8));
  });
  if (std::any_of(high.begin(), high.end(), [](unsigned char byte) { return byte != 0; }))
  {
    low.insert(low.end(), high.begin(), high.end());
  }
  return low;
}

std::size_t
CountCrossings(const MeshArrays & mesh)
{
  const auto faces = BoundaryFaces(mesh);
  return FindCrossingTriangles({ faces.begin(), faces.end() }, mesh.points).size();
}

/** The points in single precision, or as they are where a tetrahedron would no longer be positive or the boundary pass
 * through itself. */
vtkSmartPointer<vtkDataArray>
RoundedPoints(const MeshArrays & mesh)
{
  const auto count = static_cast<vtkIdType>(mesh.points.size());
  const auto value = [&mesh](vtkIdType p, int k) { return mesh.points[p][k]; };
  const auto single = MakeArray<vtkFloatArray>("Points", count, 3, value);
  MeshArrays rounded = mesh;
  for (vtkIdType p = 0; p < count; ++p)
  {
    single->GetTuple(p, rounded.points[p].data()); // GCC 12 drops casts to float and back where it vectorises them
  }
  const auto isPositive = [](const MeshArrays & of, const Id4 & c) {
    return Orient3D(of.points[c[0]], of.points[c[1]], of.points[c[2]], of.points[c[3]]) > 0;
  };
  const bool sound = std::all_of(mesh.tetrahedra.begin(), mesh.tetrahedra.end(), [&](const Id4 & c) {
    return isPositive(rounded, c) || !isPositive(mesh, c);
  });
  if (sound && CountCrossings(rounded) <= CountCrossings(mesh))
  {
    return single;
  }
  return MakeArray<vtkDoubleArray>("Points", count, 3, value);
}

/** In the fewest bytes; nothing where there are no values. */
void
AddWholeNumbers(vtkFieldData * data, const char * name, const std::vector<int> & values)
{
  if (values.empty())
  {
    return;
  }
  const auto [lowest, highest] = std::minmax_element(values.begin(), values.end());
  const auto fits = [low = *lowest, high = *highest](auto limits) {
    return low >= limits.min() && high <= limits.max();
  };
  const auto count = static_cast<vtkIdType>(values.size());
  const auto value = [&values](vtkIdType i, int) { return values[i]; };
  if (fits(std::numeric_limits<std::int8_t>()))
  {
    data->AddArray(MakeArray<vtkTypeInt8Array>(name, count, 1, value));
  }
  else if (fits(std::numeric_limits<std::int16_t>()))
  {
    data->AddArray(MakeArray<vtkTypeInt16Array>(name, count, 1, value));
  }
  else
  {
    data->AddArray(MakeArray<vtkTypeInt32Array>(name, count, 1, value));
  }
}

void
AddCodes(const MeshArrays & mesh, double error, vtkUnstructuredGrid * grid)
{
  const Scales                       scales = FindScales(mesh, error);
  const auto                         codes = Encode(mesh, scales);
  std::vector<std::array<double, 3>> rows;
  for (const auto & [region, scale] : scales)
  {
    rows.push_back({ static_cast<double>(region), scale.lowest, scale.step });
  }
  grid->GetFieldData()->AddArray(MakeArray<vtkDoubleArray>(
    ArrayNames::DensityScale, static_cast<vtkIdType>(rows.size()), 3, [&](vtkIdType i, int k) { return rows[i][k]; }));
  grid->GetFieldData()->AddArray(MakeArray<vtkTypeUInt8Array>(
    ArrayNames::DensityCodes, static_cast<vtkIdType>(codes.size()), 1, [&](vtkIdType i, int) { return codes[i]; }));
}

Scales
ReadScales(vtkUnstructuredGrid * grid)
{
  vtkFieldData *         data = grid->GetFieldData();
  vtkAbstractArray *     any = data->GetAbstractArray(ArrayNames::DensityScale);
  constexpr const char * need = "the array 'DensityCodes' needs an array 'DensityScale'";
  if (any == nullptr)
  {
    Refuse(need);
  }
  vtkDataArray * array = FindArray(data, ArrayNames::DensityScale, any->GetNumberOfTuples(), 3);
  Scales         scales;
  for (vtkIdType i = 0; i < array->GetNumberOfTuples(); ++i)
  {
    const auto region =
      static_cast<int>(WholeNumber(array, i, 0, std::numeric_limits<int>::min(), std::numeric_limits<int>::max()));
    Scale & scale = scales[region];
    scale.lowest = array->GetComponent(i, 1);
    scale.step = array->GetComponent(i, 2);
    if (!std::isfinite(scale.lowest) || !(scale.step >= 0.0) || !std::isfinite(scale.lowest + MostLevels * scale.step))
    {
      Refuse("the array '", ArrayNames::DensityScale, "' has a scale that cannot be at entry ", i);
    }
  }
  return scales;
}
} // namespace

vtkSmartPointer<vtkUnstructuredGrid>
ToCompactGrid(const MeshArrays & mesh, double error)
{
  RequireConsistent(mesh);
  if (!mesh.HasDensity())
  {
    Refuse("there is no density, which the compact form is for");
  }
  const auto nt = static_cast<vtkIdType>(mesh.tetrahedra.size());
  auto       grid = vtkSmartPointer<vtkUnstructuredGrid>::New();
  auto       points = vtkSmartPointer<vtkPoints>::New();
  points->SetData(RoundedPoints(mesh));
  grid->SetPoints(points);
  auto cells = vtkSmartPointer<vtkCellArray>::New();
  cells->SetData(MakeArray<vtkTypeInt32Array>("offsets", nt + 1, 1, [](vtkIdType t, int) { return 4 * t; }),
                 MakeArray<vtkTypeInt32Array>(
                   "connectivity", 4 * nt, 1, [&](vtkIdType i, int) { return mesh.tetrahedra[i / 4][i % 4]; }));
  grid->SetCells(VTK_TETRA, cells);
  AddWholeNumbers(grid->GetPointData(), ArrayNames::Layer, mesh.layer);
  AddWholeNumbers(grid->GetPointData(), ArrayNames::Slice, mesh.slice);
  AddWholeNumbers(grid->GetCellData(), ArrayNames::Region, mesh.region);
  AddWholeNumbers(grid->GetCellData(), ArrayNames::Degree, mesh.degree);
  AddWholeNumbers(grid->GetFieldData(), ArrayNames::DensityQuantity, { static_cast<int>(mesh.quantity) });
  AddCodes(mesh, error, grid);
  return grid;
}

void
ReadCompactDensity(vtkUnstructuredGrid * grid, MeshArrays & mesh)
{
  vtkAbstractArray * any = grid->GetFieldData()->GetAbstractArray(ArrayNames::DensityCodes);
  if (any == nullptr)
  {
    return;
  }
  vtkDataArray * codes = FindArray(grid->GetFieldData(), ArrayNames::DensityCodes, any->GetNumberOfTuples(), 1);
  vtkDataArray * degree = FindArray(grid->GetCellData(), ArrayNames::Degree, grid->GetNumberOfCells(), 1);
  if (degree == nullptr || mesh.HasDensity())
  {
    Refuse("the array '", ArrayNames::DensityCodes, "' needs an array 'Degree' and stands for 'DensityCoefficients'");
  }
  mesh.degree = WholeNumbers(degree, 0, MaximumBernsteinDegree);
  mesh.maximumDegree = *std::max_element(mesh.degree.begin(), mesh.degree.end());
  vtkIdType count = 0;
  for (const int n : mesh.degree)
  {
    count += BernsteinCount(n);
  }
  if (codes->GetNumberOfTuples() != count && codes->GetNumberOfTuples() != 2 * count)
  {
    Refuse("the array '",
           ArrayNames::DensityCodes,
           "' has ",
           codes->GetNumberOfTuples(),
           " entries where ",
           count,
           " or twice as many are needed");
  }
  const bool   high = codes->GetNumberOfTuples() > count;
  const Scales scales = ReadScales(grid);
  const auto   byte = [codes](vtkIdType i) { return static_cast<double>(WholeNumber(codes, i, 0, 0, 255)); };
  mesh.coefficients.assign(mesh.tetrahedra.size() * BernsteinCount(mesh.maximumDegree), 0.0);
  vtkIdType i = 0;
  ForEachCoefficient(mesh, [&](std::size_t t, double & c) {
    const auto scale = scales.find(RegionOf(mesh, t));
    if (scale == scales.end())
    {
      Refuse("the array '", ArrayNames::DensityScale, "' has no entry for region ", RegionOf(mesh, t));
    }
    const double code = byte(i) + (high ? 256.0 * byte(count + i) : 0.0);
    c = scale->second.lowest + scale->second.step * code;
    ++i;
  });
}
} // namespace bone
