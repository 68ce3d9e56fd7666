/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneConversions.h"

#include "boneBernstein.h"
#include "boneCompactGrid.h"
#include "boneVtkArrays.h"

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCellTypes.h>
#include <vtkDoubleArray.h>
#include <vtkFloatArray.h>
#include <vtkIntArray.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkTypeInt64Array.h>
#include <vtkUnsignedCharArray.h>

#include <itkTetrahedronCell.h>

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>

namespace bone
{
namespace
{
constexpr long long IntLowest = std::numeric_limits<int>::min();
constexpr long long IntHighest = std::numeric_limits<int>::max();

void
RequireFullLength(std::size_t size, std::size_t expected, const char * name)
{
  if (size != 0 && size != expected)
  {
    Refuse("the array '", name, "' has ", size, " entries where ", expected, " are needed");
  }
}

void
RequireConsistentDensity(const MeshArrays & mesh)
{
  if (mesh.maximumDegree > MaximumBernsteinDegree)
  {
    Refuse("the density has degree ", mesh.maximumDegree, "; ", MaximumBernsteinDegree, " is the highest");
  }
  const std::size_t nt = mesh.tetrahedra.size();
  const std::size_t width = static_cast<std::size_t>(BernsteinCount(mesh.maximumDegree));
  if (mesh.degree.size() != nt || mesh.coefficients.size() != nt * width)
  {
    Refuse("a density of degree ", mesh.maximumDegree, " needs ", nt, " degrees and ", nt * width, " coefficients");
  }
  for (int degree : mesh.degree)
  {
    if (degree < 0 || degree > mesh.maximumDegree)
    {
      Refuse("a tetrahedron has degree ", degree, " where 0 to ", mesh.maximumDegree, " are possible");
    }
  }
  if (!std::all_of(mesh.coefficients.begin(), mesh.coefficients.end(), [](double c) { return std::isfinite(c); }))
  {
    Refuse("a coefficient is not finite");
  }
}

} // namespace

void
RequireConsistent(const MeshArrays & mesh)
{
  const std::size_t np = mesh.points.size(), nt = mesh.tetrahedra.size();
  RequireFullLength(mesh.layer.size(), np, ArrayNames::Layer);
  RequireFullLength(mesh.slice.size(), np, ArrayNames::Slice);
  RequireFullLength(mesh.region.size(), nt, ArrayNames::Region);
  RequireFullLength(mesh.neighbors.size(), nt, ArrayNames::FaceNeighbors);
  for (const Id4 & tetra : mesh.tetrahedra)
  {
    for (IdType v : tetra)
    {
      if (v < 0 || static_cast<std::size_t>(v) >= np)
      {
        Refuse("a tetrahedron names point ", v, " where there are ", np, " points");
      }
    }
  }
  for (std::size_t p = 0; p < np; ++p)
  {
    if (!mesh.points[p].allFinite())
    {
      Refuse("point ", p, " has a coordinate that is not finite");
    }
  }
  if (mesh.HasDensity())
  {
    RequireConsistentDensity(mesh);
  }
}

namespace
{
// The mean over each tetrahedron: that of its coefficients, as all Bernstein polynomials of a degree have one integral.
std::vector<float>
MeanDensity(const MeshArrays & mesh)
{
  const int          width = BernsteinCount(mesh.maximumDegree);
  std::vector<float> mean(mesh.tetrahedra.size());
  for (std::size_t t = 0; t < mean.size(); ++t)
  {
    const double * const c = mesh.coefficients.data() + t * width;
    const int            count = BernsteinCount(mesh.degree[t]);
    mean[t] = static_cast<float>(std::accumulate(c, c + count, 0.0) / count);
  }
  return mean;
}

// Mean over those of a point's tetrahedra that belong to the innermost region there, of their values at the point,
// which are single coefficients: a mean across regions would be no density of either.
std::vector<float>
PointDensity(const MeshArrays & mesh)
{
  const int           width = BernsteinCount(mesh.maximumDegree);
  const auto          regionOf = [&mesh](std::size_t t) { return mesh.region.empty() ? 0 : mesh.region[t]; };
  std::vector<int>    innermost(mesh.points.size(), std::numeric_limits<int>::min());
  std::vector<double> sum(mesh.points.size(), 0.0);
  std::vector<int>    count(mesh.points.size(), 0);
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
  {
    for (const IdType p : mesh.tetrahedra[t])
    {
      innermost[p] = std::max<int>(innermost[p], regionOf(t));
    }
  }
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
  {
    const int                n = mesh.degree[t];
    const std::array<int, 4> corner = {
      { 0, BernsteinCount(n) - (n + 1) * (n + 2) / 2, BernsteinCount(n) - (n + 1), BernsteinCount(n) - 1 }
    };
    for (int i = 0; i < 4; ++i)
    {
      const IdType p = mesh.tetrahedra[t][i];
      if (regionOf(t) == innermost[p])
      {
        sum[p] += mesh.coefficients[t * width + corner[i]];
        ++count[p];
      }
    }
  }
  std::vector<float> density(sum.size());
  for (std::size_t p = 0; p < sum.size(); ++p)
  {
    density[p] = count[p] > 0 ? static_cast<float>(sum[p] / count[p]) : 0.0f;
  }
  return density;
}

void
AddDensity(const MeshArrays & mesh, vtkUnstructuredGrid * grid)
{
  const auto nt = static_cast<vtkIdType>(mesh.tetrahedra.size());
  const int  width = BernsteinCount(mesh.maximumDegree);
  auto *     cells = grid->GetCellData();
  cells->AddArray(MakeArray<vtkIntArray>(ArrayNames::Degree, nt, 1, [&](vtkIdType t, int) { return mesh.degree[t]; }));
  cells->AddArray(MakeArray<vtkDoubleArray>(ArrayNames::DensityCoefficients, nt, width, [&](vtkIdType t, int k) {
    return k < BernsteinCount(mesh.degree[t]) ? mesh.coefficients[t * width + k] : 0.0;
  }));
  const auto mean = MeanDensity(mesh);
  cells->SetScalars(
    MakeArray<vtkFloatArray>(ArrayNames::MeanDensity, nt, 1, [&](vtkIdType t, int) { return mean[t]; }));
  const auto density = PointDensity(mesh);
  grid->GetPointData()->AddArray(MakeArray<vtkFloatArray>(
    ArrayNames::Density, static_cast<vtkIdType>(density.size()), 1, [&](vtkIdType p, int) { return density[p]; }));
}

// Says which cells are no linear tetrahedra, by type.
void
RequireTetrahedra(vtkUnstructuredGrid * grid)
{
  if (grid->GetNumberOfCells() == 0)
  {
    Refuse("there are no tetrahedra");
  }
  std::map<int, vtkIdType> others;
  for (vtkIdType c = 0; c < grid->GetNumberOfCells(); ++c)
  {
    if (grid->GetCellType(c) != VTK_TETRA)
    {
      ++others[grid->GetCellType(c)];
    }
  }
  std::string list;
  for (const auto & [type, count] : others)
  {
    const char * name = vtkCellTypes::GetClassNameFromTypeId(type);
    list += Say(list.empty() ? "" : ", ", count, " ", name != nullptr ? name : "unknown", " (VTK type ", type, ")");
  }
  if (!list.empty())
  {
    Refuse("holds cells that are no linear tetrahedra (VTK type 10): ", list);
  }
}

void
ReadPoints(vtkUnstructuredGrid * grid, MeshArrays & mesh)
{
  const vtkIdType np = grid->GetNumberOfPoints();
  if (np > std::numeric_limits<IdType>::max() || grid->GetNumberOfCells() > std::numeric_limits<IdType>::max())
  {
    Refuse("has more points or cells than 32-bit ids can name");
  }
  mesh.points.resize(static_cast<std::size_t>(np));
  for (vtkIdType p = 0; p < np; ++p)
  {
    grid->GetPoint(p, mesh.points[p].data());
    RequireSensible(mesh.points[p], static_cast<std::size_t>(p));
  }
  RequireExtent(mesh.points);
}

void
ReadCells(vtkUnstructuredGrid * grid, MeshArrays & mesh)
{
  vtkCellArray *  cells = grid->GetCells();
  const vtkIdType np = grid->GetNumberOfPoints();
  mesh.tetrahedra.resize(static_cast<std::size_t>(grid->GetNumberOfCells()));
  for (vtkIdType c = 0; c < grid->GetNumberOfCells(); ++c)
  {
    vtkIdType         size = 0;
    const vtkIdType * ids = nullptr;
    cells->GetCellAtId(c, size, ids);
    if (size != 4)
    {
      Refuse("tetrahedron ", c, " has ", size, " points");
    }
    for (int i = 0; i < 4; ++i)
    {
      if (ids[i] < 0 || ids[i] >= np)
      {
        Refuse("tetrahedron ", c, " names point ", ids[i], " where there are ", np, " points");
      }
      mesh.tetrahedra[c][i] = static_cast<IdType>(ids[i]);
    }
  }
}

int
DegreeOfWidth(int width)
{
  std::string widths;
  for (int degree = 0; degree <= MaximumBernsteinDegree; ++degree)
  {
    if (BernsteinCount(degree) == width)
    {
      return degree;
    }
    widths += Say(degree > 0 ? ", " : "", BernsteinCount(degree));
  }
  Refuse(
    "the array '", ArrayNames::DensityCoefficients, "' has ", width, " components where one of ", widths, " is needed");
}

void
ReadDensity(vtkUnstructuredGrid * grid, MeshArrays & mesh)
{
  const vtkIdType nt = grid->GetNumberOfCells();
  auto *          coefficients = FindArray(grid->GetCellData(), ArrayNames::DensityCoefficients, nt, 0);
  if (coefficients == nullptr)
  {
    return;
  }
  const int width = coefficients->GetNumberOfComponents();
  mesh.maximumDegree = DegreeOfWidth(width);
  auto * degree = FindArray(grid->GetCellData(), ArrayNames::Degree, nt, 1);
  mesh.degree = degree != nullptr ? WholeNumbers(degree, 0, mesh.maximumDegree)
                                  : std::vector<int>(static_cast<std::size_t>(nt), mesh.maximumDegree);
  mesh.coefficients.assign(static_cast<std::size_t>(nt) * width, 0.0);
  for (vtkIdType t = 0; t < nt; ++t)
  {
    for (int k = 0; k < BernsteinCount(mesh.degree[t]); ++k)
    {
      const double value = coefficients->GetComponent(t, k);
      if (!std::isfinite(value))
      {
        Refuse("coefficient ", k, " of tetrahedron ", t, " is not finite");
      }
      mesh.coefficients[t * width + k] = value;
    }
  }
}

void
ReadAttributes(vtkUnstructuredGrid * grid, MeshArrays & mesh)
{
  const vtkIdType np = grid->GetNumberOfPoints(), nt = grid->GetNumberOfCells();
  const auto      ints = [](vtkFieldData * data, const char * name, vtkIdType tuples) {
    vtkDataArray * array = FindArray(data, name, tuples, 1);
    return array != nullptr ? WholeNumbers(array, IntLowest, IntHighest) : std::vector<int>();
  };
  mesh.region = ints(grid->GetCellData(), ArrayNames::Region, nt);
  mesh.layer = ints(grid->GetPointData(), ArrayNames::Layer, np);
  mesh.slice = ints(grid->GetPointData(), ArrayNames::Slice, np);
  if (auto * quantity = FindArray(grid->GetFieldData(), ArrayNames::DensityQuantity, 1, 1))
  {
    const auto highest = static_cast<long long>(DensityQuantity::ApparentGramPerCubicCentimetre);
    mesh.quantity = static_cast<DensityQuantity>(WholeNumber(quantity, 0, 0, 0, highest));
  }
  mesh.neighbors = ComputeFaceNeighbors(mesh.tetrahedra);
  if (auto * neighbors = FindArray(grid->GetCellData(), ArrayNames::FaceNeighbors, nt, 4))
  {
    for (vtkIdType i = 0; i < 4 * nt; ++i)
    {
      if (WholeNumber(neighbors, i / 4, static_cast<int>(i % 4), -1, nt - 1) != mesh.neighbors[i / 4][i % 4])
      {
        Refuse("the array '",
               ArrayNames::FaceNeighbors,
               "' is not that of these tetrahedra (see ",
               i / 4,
               "): remove it, as it is made anew where it is missing");
      }
    }
  }
}
} // namespace

vtkSmartPointer<vtkUnstructuredGrid>
ToVtkUnstructuredGrid(const MeshArrays & mesh)
{
  RequireConsistent(mesh);
  const auto np = static_cast<vtkIdType>(mesh.points.size()), nt = static_cast<vtkIdType>(mesh.tetrahedra.size());
  auto       grid = vtkSmartPointer<vtkUnstructuredGrid>::New();
  auto       points = vtkSmartPointer<vtkPoints>::New();
  points->SetData(MakeArray<vtkDoubleArray>("Points", np, 3, [&](vtkIdType p, int k) { return mesh.points[p][k]; }));
  grid->SetPoints(points);
  auto cells = vtkSmartPointer<vtkCellArray>::New();
  cells->SetData(MakeArray<vtkTypeInt64Array>("offsets", nt + 1, 1, [](vtkIdType t, int) { return 4 * t; }),
                 MakeArray<vtkTypeInt64Array>(
                   "connectivity", 4 * nt, 1, [&](vtkIdType i, int) { return mesh.tetrahedra[i / 4][i % 4]; }));
  grid->SetCells(VTK_TETRA, cells);

  const auto addInts = [](vtkFieldData * data, const char * name, const std::vector<int> & values) {
    if (!values.empty())
    {
      data->AddArray(MakeArray<vtkIntArray>(
        name, static_cast<vtkIdType>(values.size()), 1, [&](vtkIdType i, int) { return values[i]; }));
    }
  };
  addInts(grid->GetPointData(), ArrayNames::Layer, mesh.layer);
  addInts(grid->GetPointData(), ArrayNames::Slice, mesh.slice);
  addInts(grid->GetCellData(), ArrayNames::Region, mesh.region);
  if (!mesh.neighbors.empty())
  {
    grid->GetCellData()->AddArray(MakeArray<vtkTypeInt64Array>(
      ArrayNames::FaceNeighbors, nt, 4, [&](vtkIdType t, int i) { return mesh.neighbors[t][i]; }));
  }
  addInts(grid->GetFieldData(), ArrayNames::DensityQuantity, { static_cast<int>(mesh.quantity) });
  if (mesh.HasDensity())
  {
    AddDensity(mesh, grid);
  }
  return grid;
}

MeshArrays
ToMeshArrays(vtkUnstructuredGrid * grid)
{
  RequireTetrahedra(grid);
  MeshArrays mesh;
  ReadPoints(grid, mesh);
  ReadCells(grid, mesh);
  ReadAttributes(grid, mesh);
  ReadDensity(grid, mesh);
  ReadCompactDensity(grid, mesh);
  return mesh;
}

ItkMesh::Pointer
ToItkMesh(const MeshArrays & mesh)
{
  RequireConsistent(mesh);
  using Tetrahedron = itk::TetrahedronCell<ItkMesh::CellType>;
  auto result = ItkMesh::New();
  for (std::size_t p = 0; p < mesh.points.size(); ++p)
  {
    ItkMesh::PointType point;
    std::copy_n(mesh.points[p].data(), 3, point.Begin());
    result->SetPoint(p, point);
    if (!mesh.layer.empty())
    {
      result->SetPointData(p, mesh.layer[p]);
    }
  }
  result->SetCellsAllocationMethod(itk::MeshEnums::MeshClassCellsAllocationMethod::CellsAllocatedDynamicallyCellByCell);
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
  {
    ItkMesh::CellAutoPointer cell;
    cell.TakeOwnership(new Tetrahedron);
    for (int i = 0; i < 4; ++i)
    {
      cell->SetPointId(i, static_cast<ItkMesh::PointIdentifier>(mesh.tetrahedra[t][i]));
    }
    result->SetCell(t, cell);
    result->SetCellData(t, mesh.region.empty() ? 0.0 : mesh.region[t]);
  }
  return result;
}

MeshArrays
ToMeshArrays(const ItkMesh * input)
{
  MeshArrays                                 mesh;
  std::map<ItkMesh::PointIdentifier, IdType> newId;
  if (input->GetNumberOfPoints() > 0)
  {
    for (auto it = input->GetPoints()->Begin(); it != input->GetPoints()->End(); ++it)
    {
      newId.emplace(it.Index(), static_cast<IdType>(mesh.points.size()));
      mesh.points.emplace_back(it.Value()[0], it.Value()[1], it.Value()[2]);
      ItkMesh::PixelType layer = 0;
      if (input->GetPointData(it.Index(), &layer))
      {
        mesh.layer.push_back(static_cast<int>(std::lround(layer)));
      }
    }
  }
  if (input->GetNumberOfCells() == 0)
  {
    Refuse("there are no tetrahedra");
  }
  for (auto it = input->GetCells()->Begin(); it != input->GetCells()->End(); ++it)
  {
    const ItkMesh::CellType * cell = it.Value();
    if (cell->GetType() != itk::CommonEnums::CellGeometry::TETRAHEDRON_CELL)
    {
      Refuse("cell ", it.Index(), " is no tetrahedron");
    }
    Id4 tetra;
    for (int i = 0; i < 4; ++i)
    {
      const auto found = newId.find(cell->GetPointIds()[i]);
      if (found == newId.end())
      {
        Refuse("cell ", it.Index(), " names point ", cell->GetPointIds()[i], ", which there is not");
      }
      tetra[i] = found->second;
    }
    mesh.tetrahedra.push_back(tetra);
    ItkMesh::CellPixelType region = 0;
    if (input->GetCellData(it.Index(), &region))
    {
      mesh.region.push_back(static_cast<int>(std::lround(region)));
    }
  }
  if (mesh.layer.size() != mesh.points.size())
  {
    mesh.layer.clear();
  }
  if (mesh.region.size() != mesh.tetrahedra.size())
  {
    mesh.region.clear();
  }
  mesh.neighbors = ComputeFaceNeighbors(mesh.tetrahedra);
  return mesh;
}
} // namespace bone
