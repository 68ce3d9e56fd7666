/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneMeshIO.h"

#include "boneAtomicFile.h"
#include "boneCompactGrid.h"
#include "boneConversions.h"
#include "boneFileName.h"
#include "boneMeshValidator.h"
#include "boneRefuse.h"
#include "boneVtkArrays.h"
#include "boneVtkFile.h"

#include <vtkCellArray.h>
#include <vtkDoubleArray.h>
#include <vtkIntArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkTriangleFilter.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <fstream>
#include <type_traits>

namespace bone
{
namespace
{
vtkSmartPointer<vtkPolyData>
ReadPolygons(const std::string & path)
{
  RequireExtension(path, { ".ply", ".vtp", ".stl" });
  if (HasExtension(path, ".ply"))
  {
    return ReadPlyFile(path);
  }
  return HasExtension(path, ".vtp") ? ReadVtpFile(path) : ReadStlFile(path);
}

TriangleSurface
ToTriangles(vtkPolyData * polygons)
{
  vtkNew<vtkTriangleFilter> triangulate;
  triangulate->SetInputData(polygons);
  triangulate->PassVertsOff();
  triangulate->PassLinesOff();
  triangulate->Update();
  vtkPolyData *   data = triangulate->GetOutput();
  TriangleSurface surface;
  surface.points.resize(static_cast<std::size_t>(data->GetNumberOfPoints()));
  for (vtkIdType p = 0; p < data->GetNumberOfPoints(); ++p)
  {
    data->GetPoint(p, surface.points[p].data());
    RequireSensible(surface.points[p], static_cast<std::size_t>(p));
  }
  RequireExtent(surface.points);
  vtkCellArray * cells = data->GetPolys();
  for (vtkIdType c = 0; c < cells->GetNumberOfCells(); ++c)
  {
    vtkIdType         size = 0;
    const vtkIdType * ids = nullptr;
    cells->GetCellAtId(c, size, ids);
    surface.triangles.push_back(
      { static_cast<IdType>(ids[0]), static_cast<IdType>(ids[1]), static_cast<IdType>(ids[2]) });
  }
  if (surface.triangles.empty())
  {
    Refuse("holds no surface: there are no triangles");
  }
  return surface;
}

void
RequireIdsInRange(vtkPolyData * polygons)
{
  for (vtkCellArray * cells : { polygons->GetPolys(), polygons->GetStrips() })
  {
    for (vtkIdType c = 0; c < cells->GetNumberOfCells(); ++c)
    {
      vtkIdType         size = 0;
      const vtkIdType * ids = nullptr;
      cells->GetCellAtId(c, size, ids);
      for (vtkIdType i = 0; i < size; ++i)
      {
        if (ids[i] < 0 || ids[i] >= polygons->GetNumberOfPoints())
        {
          Refuse("polygon ", c, " names point ", ids[i], " where there are ", polygons->GetNumberOfPoints(), " points");
        }
      }
    }
  }
}

void
RequireClosed(const TriangleSurface & surface)
{
  std::vector<std::pair<IdType, IdType>> edges, reversed;
  for (const auto & triangle : surface.triangles)
  {
    for (int i = 0; i < 3; ++i)
    {
      edges.emplace_back(triangle[i], triangle[(i + 1) % 3]);
      reversed.emplace_back(triangle[(i + 1) % 3], triangle[i]);
    }
  }
  std::sort(edges.begin(), edges.end());
  std::sort(reversed.begin(), reversed.end());
  if (const auto twice = std::adjacent_find(edges.begin(), edges.end()); twice != edges.end())
  {
    Refuse("the surface is no manifold: two triangles run the same way along the edge from point ",
           twice->first,
           " to ",
           twice->second);
  }
  std::vector<std::pair<IdType, IdType>> open;
  std::set_difference(edges.begin(), edges.end(), reversed.begin(), reversed.end(), std::back_inserter(open));
  if (!open.empty())
  {
    Refuse("the surface is not closed: ", open.size(), " edges have one triangle; close its holes");
  }
}
} // namespace

void
WriteMeshFile(const MeshArrays & mesh, const MeshStorageParameters & storage, AtomicFile & file)
{
  if (storage.compact)
  {
    WriteVtuFile(ToCompactGrid(mesh, storage.compactError), file, FileSize::Small);
  }
  else
  {
    WriteVtuFile(ToVtkUnstructuredGrid(mesh), file);
  }
}

MeshArrays
ReadMeshArrays(const std::string & path)
{
  RequireReadableFile(path);
  RequireExtension(path, { ".vtu" });
  return NamingFile(path, [&] { return ToMeshArrays(ReadVtuFile(path)); });
}

void
WriteMeshArrays(const MeshArrays & mesh, const std::string & path, const MeshStorageParameters & storage)
{
  RequireExtension(path, { ".vtu" });
  AtomicFile file(path);
  NamingFile(path, [&] { WriteMeshFile(mesh, storage, file); });
  file.Commit();
}

void
WriteUnstructuredGrid(vtkUnstructuredGrid * grid, const std::string & path)
{
  RequireExtension(path, { ".vtu" });
  AtomicFile file(path);
  WriteVtuFile(grid, file);
  file.Commit();
}

DensityMesh<double>::Pointer
ReadDensityMesh(const std::string & path)
{
  MeshArrays        arrays = ReadMeshArrays(path);
  const std::string obstacle = FindTopologyObstacle(arrays);
  if (!obstacle.empty())
  {
    throw IOError(path, "is no mesh to work with: " + obstacle + "; bonetk validate lists all that is wrong");
  }
  auto mesh = DensityMesh<double>::New();
  mesh->SetArrays(std::move(arrays));
  return mesh;
}

namespace
{
/** 3D Slicer says in the comment at the start of .stl and .ply files which of the two patient spaces they are in. */
bool
IsInRas(const std::string & path)
{
  std::ifstream stream(path, std::ios::binary);
  std::string   start(1000, '\0');
  stream.read(start.data(), static_cast<std::streamsize>(start.size()));
  return !HasExtension(path, ".vtp") && start.find("SPACE=RAS") != std::string::npos;
}
} // namespace

TriangleSurface
ReadTriangleSurface(const std::string & path)
{
  RequireReadableFile(path);
  return NamingFile(path, [&] {
    const auto polygons = ReadPolygons(path);
    RequireIdsInRange(polygons);
    TriangleSurface surface = ToTriangles(polygons);
    RequireClosed(surface);
    const double sign = IsInRas(path) ? -1.0 : 1.0;
    for (Vector3 & point : surface.points)
    {
      point.head<2>() *= sign;
    }
    if (EnclosedVolume(surface) < 0)
    {
      for (auto & triangle : surface.triangles)
      {
        std::swap(triangle[1], triangle[2]);
      }
    }
    return surface;
  });
}

namespace
{
vtkSmartPointer<vtkDataArray>
MakePointArray(const PointArray & array, std::size_t points)
{
  return std::visit(
    [&](const auto & values) -> vtkSmartPointer<vtkDataArray> {
      using Value = typename std::decay_t<decltype(values)>::value_type;
      using Array = std::conditional_t<std::is_same_v<Value, int>, vtkIntArray, vtkDoubleArray>;
      if (values.size() != points)
      {
        Refuse("the array '", array.name, "' has ", values.size(), " values for ", points, " points");
      }
      return MakeArray<Array>(
        array.name.c_str(), static_cast<vtkIdType>(points), 1, [&](vtkIdType p, int) { return values[p]; });
    },
    array.values);
}

vtkSmartPointer<vtkPolyData>
ToPolyData(const TriangleSurface & surface, const std::vector<PointArray> & arrays)
{
  const auto        points = static_cast<vtkIdType>(surface.points.size());
  const auto        triangles = static_cast<vtkIdType>(surface.triangles.size());
  auto              data = vtkSmartPointer<vtkPolyData>::New();
  vtkNew<vtkPoints> places;
  places->SetData(
    MakeArray<vtkDoubleArray>("Points", points, 3, [&](vtkIdType p, int k) { return surface.points[p][k]; }));
  data->SetPoints(places);
  vtkNew<vtkCellArray> cells;
  cells->SetData(MakeArray<vtkTypeInt64Array>("offsets", triangles + 1, 1, [](vtkIdType t, int) { return 3 * t; }),
                 MakeArray<vtkTypeInt64Array>("connectivity", 3 * triangles, 1, [&](vtkIdType i, int) {
                   return surface.triangles[i / 3][i % 3];
                 }));
  data->SetPolys(cells);
  for (const PointArray & array : arrays)
  {
    data->GetPointData()->AddArray(MakePointArray(array, surface.points.size()));
  }
  if (!arrays.empty())
  {
    data->GetPointData()->SetActiveScalars(arrays.front().name.c_str());
  }
  return data;
}
} // namespace

void
WriteTriangleSurface(const TriangleSurface & surface, const std::vector<PointArray> & arrays, const std::string & path)
{
  RequireExtension(path, { ".vtp" });
  AtomicFile file(path);
  NamingFile(path, [&] { WriteVtpFile(ToPolyData(surface, arrays), file); });
  file.Commit();
}
} // namespace bone
