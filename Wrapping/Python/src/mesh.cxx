/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "bindings.h"
#include "evaluator.h"
#include "failure.h"
#include "objects.h"

#include "boneBernstein.h"
#include "boneDensityQuantityChoices.h"
#include "boneMeshIO.h"
#include "boneMeshValidator.h"

#include <cmath>

namespace bone::python
{
namespace
{
DensityQuantity
ToQuantity(const std::string & name)
{
  try
  {
    return ParseChoice<DensityQuantity>(name);
  }
  catch (const std::invalid_argument & error)
  {
    throw UsageFailure(std::string("quantity ") + error.what());
  }
}

const char *
QuantityOf(const Mesh & mesh)
{
  return ParameterChoices<DensityQuantity>::names[static_cast<std::size_t>(mesh.GetCells().quantity)];
}

/** A number for each of `count` elements, or none. */
std::vector<int>
ToNumbers(const py::object & object, std::size_t count, const char * name)
{
  if (object.is_none())
  {
    return {};
  }
  const auto array = Array<int>::ensure(object);
  if (!array || (array.ndim() != 0 && (array.ndim() != 1 || array.size() != static_cast<py::ssize_t>(count))))
  {
    PyErr_Clear();
    throw UsageFailure(std::string(name) + " must be one whole number, or an array of " + std::to_string(count));
  }
  return array.ndim() == 0 ? std::vector<int>(count, *array.data())
                           : std::vector<int>(array.data(), array.data() + array.size());
}

void
SetDensity(MeshArrays & mesh, const py::object & coefficients, const py::object & degree)
{
  if (coefficients.is_none())
  {
    return;
  }
  const auto        array = Array<double>::ensure(coefficients);
  const std::size_t count = mesh.tetrahedra.size();
  int               maximum = 0;
  while (array && array.ndim() == 2 && maximum <= 8 && BernsteinCount(maximum) != array.shape(1))
  {
    ++maximum;
  }
  if (!array || array.ndim() != 2 || array.shape(0) != static_cast<py::ssize_t>(count) || maximum > 8)
  {
    PyErr_Clear();
    throw UsageFailure("coefficients must be an array of " + std::to_string(count) +
                       " x k numbers, k = 1, 4, 10, 20, 35, ... for degree 0, 1, 2, 3, 4, ...");
  }
  mesh.maximumDegree = maximum;
  mesh.coefficients.assign(array.data(), array.data() + array.size());
  mesh.degree = degree.is_none() ? std::vector<int>(count, maximum) : ToNumbers(degree, count, "degree");
  for (const int d : mesh.degree)
  {
    if (d < 0 || d > maximum)
    {
      throw UsageFailure("a degree is " + std::to_string(d) + ", but the coefficients are of degree 0 to " +
                         std::to_string(maximum));
    }
  }
}

Mesh::Pointer
BuildMesh(const Array<double> & points,
          const Array<IdType> & tetrahedra,
          const py::object &    region,
          const py::object &    layer,
          const py::object &    slice,
          const py::object &    coefficients,
          const py::object &    degree,
          const std::string &   quantity)
{
  MeshArrays arrays;
  arrays.points = ToPoints(points, "points");
  if (tetrahedra.ndim() != 2 || tetrahedra.shape(1) != 4)
  {
    throw UsageFailure("tetrahedra must be an array of m x 4 ids of points");
  }
  const auto * first = reinterpret_cast<const Id4 *>(tetrahedra.data());
  arrays.tetrahedra.assign(first, first + tetrahedra.shape(0));
  arrays.region = ToNumbers(region, arrays.tetrahedra.size(), "region");
  arrays.layer = ToNumbers(layer, arrays.points.size(), "layer");
  arrays.slice = ToNumbers(slice, arrays.points.size(), "slice");
  arrays.quantity = ToQuantity(quantity);
  SetDensity(arrays, coefficients, degree);
  return MakeMesh(std::move(arrays));
}

template <typename T>
py::object
ViewCells(const Mesh & mesh, const std::vector<T> & values, py::ssize_t width)
{
  if (values.empty())
  {
    return py::none();
  }
  using Number = std::conditional_t<std::is_same_v<T, Id4>, IdType, T>;
  const auto * first = reinterpret_cast<const Number *>(values.data());
  const auto   rows = static_cast<py::ssize_t>(values.size() * sizeof(T) / sizeof(Number)) / width;
  return View<Number>(
    first, width == 1 ? std::vector<py::ssize_t>{ rows } : std::vector<py::ssize_t>{ rows, width }, ArrayOwner(&mesh));
}

py::object
ViewPoints(const Mesh & mesh)
{
  const auto count = static_cast<py::ssize_t>(mesh.GetNumberOfPoints());
  if (count == 0)
  {
    return py::array_t<double>(std::vector<py::ssize_t>{ 0, 3 });
  }
  static_assert(sizeof(Mesh::PointType) == 3 * sizeof(double), "points are numbers one beside the other");
  return View<double>(
    mesh.GetPoints()->CastToSTLConstContainer().front().GetDataPointer(), { count, 3 }, ArrayOwner(&mesh));
}

py::object
ViewCoefficients(const Mesh & mesh)
{
  const MeshCells & cells = mesh.GetCells();
  return cells.HasDensity() ? ViewCells(mesh, cells.coefficients, BernsteinCount(cells.maximumDegree))
                            : py::object(py::none());
}

Mesh::Pointer
Replace(const Mesh &       mesh,
        const py::object & points,
        const py::object & coefficients,
        const py::object & degree,
        const py::object & region,
        const py::object & quantity)
{
  MeshArrays arrays = mesh.GetArrays();
  if (!points.is_none())
  {
    auto moved = ToPoints(points.cast<Array<double>>(), "points");
    if (moved.size() != arrays.points.size())
    {
      throw UsageFailure("points must be as many as the mesh has, " + std::to_string(arrays.points.size()));
    }
    arrays.points = std::move(moved);
  }
  if (!region.is_none())
  {
    arrays.region = ToNumbers(region, arrays.tetrahedra.size(), "region");
  }
  if (!quantity.is_none())
  {
    arrays.quantity = ToQuantity(quantity.cast<std::string>());
  }
  SetDensity(arrays, coefficients, degree);
  return MakeMesh(std::move(arrays));
}

py::dict
Validate(const Mesh & mesh)
{
  MeshValidation result;
  {
    const py::gil_scoped_release release;
    result = ValidateMesh(mesh.GetArrays());
  }
  py::dict checks;
  for (const MeshCheck & check : result.checks)
  {
    py::dict entry;
    entry["failures"] = check.failures;
    entry["examples"] = check.examples;
    checks[py::str(check.name)] = entry;
  }
  py::dict dict;
  dict["valid"] = result.IsValid();
  dict["summary"] = result.Summary();
  dict["components"] = result.components;
  dict["boundary_euler"] = result.boundaryEuler;
  dict["checks"] = checks;
  return dict;
}

double
VolumeOf(const Mesh & mesh)
{
  const MeshArrays arrays = mesh.GetArrays();
  double           volume = 0.0;
  for (const Id4 & t : arrays.tetrahedra)
  {
    volume += SignedVolume(arrays.points[t[0]], arrays.points[t[1]], arrays.points[t[2]], arrays.points[t[3]]);
  }
  return volume;
}

std::vector<RegionDensity>
RegionsOf(const Mesh & mesh)
{
  if (!mesh.GetCells().HasDensity())
  {
    throw DataFailure("the mesh holds no density: fit one first (fit_density)");
  }
  return MeasureRegions(mesh.GetArrays());
}

py::list
MeasureDensity(const Mesh & mesh)
{
  py::list list;
  for (const RegionDensity & region : RegionsOf(mesh))
  {
    py::dict entry;
    entry["region"] = region.region;
    entry["name"] = RegionName(region.region);
    entry["tetrahedra"] = region.tetrahedra;
    entry["volume"] = region.volume;
    entry["mass"] = region.mass;
    entry["mean"] = region.mean;
    entry["standard_deviation"] = region.standardDeviation;
    list.append(entry);
  }
  return list;
}

double
MassOf(const Mesh & mesh)
{
  double mass = 0.0;
  for (const RegionDensity & region : RegionsOf(mesh))
  {
    mass += region.mass;
  }
  return mass;
}

py::tuple
MeshState(const Mesh & mesh)
{
  const MeshCells & cells = mesh.GetCells();
  return py::make_tuple(ViewPoints(mesh),
                        ViewCells(mesh, cells.tetrahedra, 4),
                        ViewCells(mesh, cells.region, 1),
                        ViewCells(mesh, cells.layer, 1),
                        ViewCells(mesh, cells.slice, 1),
                        ViewCoefficients(mesh),
                        ViewCells(mesh, cells.degree, 1),
                        QuantityOf(mesh));
}

Mesh::Pointer
MeshOfState(const py::tuple & state)
{
  if (state[1].is_none())
  {
    return Mesh::New();
  }
  return BuildMesh(state[0].cast<Array<double>>(),
                   state[1].cast<Array<IdType>>(),
                   state[2],
                   state[3],
                   state[4],
                   state[5],
                   state[6],
                   state[7].cast<std::string>());
}

std::string
DescribeMesh(const Mesh & mesh)
{
  const MeshCells &  cells = mesh.GetCells();
  std::ostringstream text;
  text << "<bonetk.DensityMesh: " << mesh.GetNumberOfPoints() << " points, " << cells.tetrahedra.size()
       << " tetrahedra, ";
  if (cells.HasDensity())
  {
    text << "density of degree " << cells.maximumDegree << " in " << DensityUnitName(cells.quantity) << '>';
  }
  else
  {
    text << "no density>";
  }
  return text.str();
}

void
BindMeshArrays(py::class_<Mesh, itk::SmartPointer<Mesh>, itk::DataObject> & mesh)
{
  const auto cells = [&mesh](const char * name, auto member, py::ssize_t width, const char * doc) {
    mesh.def_property_readonly(
      name, [member, width](const Mesh & self) { return ViewCells(self, self.GetCells().*member, width); }, doc);
  };
  mesh.def_property_readonly("points", &ViewPoints, "n x 3, mm (LPS); a read-only view.");
  cells("tetrahedra", &MeshCells::tetrahedra, 4, "m x 4 ids of points, of positive orientation; a read-only view.");
  cells("neighbors",
        &MeshCells::neighbors,
        4,
        "m x 4; neighbour i lies across the face opposite vertex i, -1: none; a read-only view.");
  cells("region",
        &MeshCells::region,
        1,
        "m; 1 cortical, 2 trabecular, 3 medullary cavity; a read-only view. None: no regions.");
  cells("layer", &MeshCells::layer, 1, "n; 0 on the exterior surface, counting inward; a read-only view, or None.");
  cells("slice", &MeshCells::slice, 1, "n; index of the slice the point was tiled on; a read-only view, or None.");
  cells("degree",
        &MeshCells::degree,
        1,
        "m; degree of each tetrahedron's Bernstein polynomial; a read-only view. None: no density.");
  mesh.def_property_readonly("coefficients",
                             &ViewCoefficients,
                             "m x k Bernstein coefficients in density units, k those of maximum_degree; a tetrahedron "
                             "of lower degree uses the first ones; a read-only view. None: no density.");
}
} // namespace
} // namespace bone::python

void
BindMesh(pybind11::module_ & m)
{
  using namespace bone::python;
  py::class_<Mesh, itk::SmartPointer<Mesh>, itk::DataObject> mesh(
    m,
    "DensityMesh",
    py::dynamic_attr(),
    "A layered tetrahedral mesh with a Bernstein polynomial density in every tetrahedron.\n\n"
    "points: n x 3, mm (LPS). tetrahedra: m x 4. region, layer, slice: see the properties. coefficients: m x k. "
    "degree: a number or m of them. quantity: unknown, hu, k2hpo4, ha, ash or apparent.\n"
    "A mesh does not change: replace() gives another one. Its arrays are read-only views of its own memory, which they "
    "keep alive; those of a filter's output, which the filter may make anew, are copies.");
  mesh.def(py::init(&BuildMesh),
           py::arg("points"),
           py::arg("tetrahedra"),
           py::kw_only(),
           py::arg("region") = py::none(),
           py::arg("layer") = py::none(),
           py::arg("slice") = py::none(),
           py::arg("coefficients") = py::none(),
           py::arg("degree") = py::none(),
           py::arg("quantity") = "unknown");
  BindMeshArrays(mesh);
  mesh
    .def_property_readonly(
      "maximum_degree",
      [](const Mesh & self) { return self.GetCells().maximumDegree; },
      "Largest degree of the density; -1: no density.")
    .def_property_readonly("quantity",
                           &QuantityOf,
                           "What density values mean: unknown, hu, k2hpo4 and ha (mg/cm3), ash and apparent (g/cm3).")
    .def("replace",
         &Replace,
         py::kw_only(),
         py::arg("points") = py::none(),
         py::arg("coefficients") = py::none(),
         py::arg("degree") = py::none(),
         py::arg("region") = py::none(),
         py::arg("quantity") = py::none(),
         "A mesh with other points, density, regions or quantity and all else the same.")
    .def_property_readonly("volume", &VolumeOf, "mm^3.")
    .def_property_readonly("mass", &MassOf, "Integral of the density, density units times mm^3, exact.")
    .def("measure_regions",
         &MeasureDensity,
         "For each region a dict of region, name, tetrahedra, volume (mm^3), mass (density units times mm^3), mean and "
         "standard_deviation (density units).")
    .def("validate",
         &Validate,
         "What is wrong with the mesh: a dict of valid, summary, components, boundary_euler and checks.")
    .def("__repr__", &DescribeMesh)
    .def("__copy__", [](const Mesh & self) { return MakeMesh(self.GetArrays()); })
    .def("__deepcopy__", [](const Mesh & self, const py::dict &) { return MakeMesh(self.GetArrays()); })
    .def(py::pickle(&MeshState, &MeshOfState));
  BindEvaluation(mesh);

  m.def(
    "read_mesh",
    [](const std::string & path) {
      const py::gil_scoped_release release;
      return bone::ReadDensityMesh(path);
    },
    py::arg("path"),
    "Reads a mesh, with or without density (.vtu).");
  m.def(
    "write_mesh",
    [](const Mesh & self, const std::string & path) {
      const py::gil_scoped_release release;
      bone::WriteDensityMesh(&self, path);
    },
    py::arg("mesh"),
    py::arg("path"),
    "Writes a mesh (.vtu), the whole file or none.");
}
