/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "evaluator.h"

#include "failure.h"

#include "boneModelPictures.h"

#include <limits>
#include <memory>

namespace bone::python
{
namespace
{
/** What places are looked up in: of a mesh as it was at a modified time. */
struct Evaluator
{
  explicit Evaluator(const Mesh & mesh)
    : arrays(mesh.GetArrays())
    , locator(arrays)
    , time(mesh.GetMTime())
  {}
  MeshArrays            arrays;
  TetraLocator          locator;
  itk::ModifiedTimeType time;
};
using EvaluatorPointer = std::shared_ptr<const Evaluator>;

/** That of the mesh, kept with the object of Python. */
EvaluatorPointer
GetEvaluator(const py::object & self)
{
  const auto & mesh = self.cast<const Mesh &>();
  if (py::hasattr(self, "_evaluator"))
  {
    auto kept = self.attr("_evaluator").cast<EvaluatorPointer>();
    if (kept->time == mesh.GetMTime())
    {
      return kept;
    }
  }
  EvaluatorPointer made;
  {
    const py::gil_scoped_release release;
    made = std::make_shared<Evaluator>(mesh);
  }
  self.attr("_evaluator") = std::const_pointer_cast<Evaluator>(made);
  return made;
}

EvaluatorPointer
GetDensityEvaluator(const py::object & self)
{
  if (!self.cast<const Mesh &>().GetCells().HasDensity())
  {
    throw DataFailure("the mesh holds no density: fit one first (fit_density)");
  }
  return GetEvaluator(self);
}

/** Calls body(i, place) for each point, in parallel, without the GIL. */
template <typename TBody>
void
ForPlaces(const Evaluator & evaluator, const std::vector<Vector3> & points, const TBody & body)
{
  const py::gil_scoped_release release;
  Execution().For(
    points.size(),
    [&](std::size_t i) { body(i, points[i].allFinite() ? evaluator.locator.Find(points[i]) : CellLocation()); },
    256);
}

std::vector<py::ssize_t>
Rows(const std::vector<Vector3> & points, py::ssize_t width)
{
  return { static_cast<py::ssize_t>(points.size()), width };
}

constexpr double NoDensity = std::numeric_limits<double>::quiet_NaN();

py::object
EvaluateAt(const py::object & self, const Array<double> & places)
{
  const auto evaluator = GetDensityEvaluator(self);
  const bool one = places.ndim() == 1 && places.size() == 3;
  const auto points = one ? ToPoints(Array<double>({ 1, 3 }, places.data()), "points") : ToPoints(places, "points");
  py::array_t<double> result(static_cast<py::ssize_t>(points.size()));
  double *            values = result.mutable_data();
  ForPlaces(*evaluator, points, [&](std::size_t i, const CellLocation & place) {
    values[i] = place.Found() ? DensityAt(evaluator->arrays, place) : NoDensity;
  });
  return one ? py::object(py::float_(values[0])) : py::object(result);
}

py::array_t<double>
Gradient(const py::object & self, const Array<double> & places)
{
  const auto          evaluator = GetDensityEvaluator(self);
  const auto          points = ToPoints(places, "points");
  py::array_t<double> result(Rows(points, 3));
  auto *              values = reinterpret_cast<Vector3 *>(result.mutable_data());
  ForPlaces(*evaluator, points, [&](std::size_t i, const CellLocation & place) {
    values[i] = place.Found() ? DensityGradientAt(evaluator->arrays, place) : Vector3(Vector3::Constant(NoDensity));
  });
  return result;
}

py::tuple
Locate(const py::object & self, const Array<double> & places)
{
  const auto          evaluator = GetEvaluator(self);
  const auto          points = ToPoints(places, "points");
  py::array_t<IdType> cells(static_cast<py::ssize_t>(points.size()));
  py::array_t<double> barycentric(Rows(points, 4));
  IdType *            cell = cells.mutable_data();
  double *            mu = barycentric.mutable_data();
  ForPlaces(*evaluator, points, [&](std::size_t i, const CellLocation & place) {
    cell[i] = place.cell;
    for (int k = 0; k < 4; ++k)
    {
      mu[4 * i + static_cast<std::size_t>(k)] = place.Found() ? place.mu[k] : NoDensity;
    }
  });
  return py::make_tuple(cells, barycentric);
}

/** The exterior surface seen from the patient's front, as PNG. */
std::string
ShadeToPng(const Mesh & mesh, int pixels)
{
  const MeshArrays      arrays = mesh.GetArrays();
  std::vector<IdType>   ids;
  const TriangleSurface surface = ExteriorSurface(arrays, ids);
  if (surface.points.empty())
  {
    return {};
  }
  Vector3 lower = surface.points.front();
  Vector3 upper = lower;
  for (const Vector3 & x : surface.points)
  {
    lower = lower.cwiseMin(x);
    upper = upper.cwiseMax(x);
  }
  const Vector3 size = upper - lower;
  const double  pixel = std::max(1.05 * std::max(size.x(), size.z()) / pixels, 1e-6);
  const int     columns = std::max(1, static_cast<int>(std::ceil(1.05 * size.x() / pixel)));
  const int     rows = std::max(1, static_cast<int>(std::ceil(1.05 * size.z() / pixel)));
  Canvas        canvas(columns, rows);
  canvas.DrawPanel(0.0,
                   0.0,
                   ShadeSurface(surface, (lower + upper) / 2, Vector3::UnitY(), Vector3::UnitZ(), pixel, columns, rows),
                   Window{ 0.0, 1.0 });
  return canvas.GetPng();
}
} // namespace

void
BindEvaluation(py::class_<Mesh, itk::SmartPointer<Mesh>, itk::DataObject> & mesh)
{
  py::class_<Evaluator, std::shared_ptr<Evaluator>>(mesh, "_Evaluator", py::module_local());
  mesh
    .def("evaluate",
         &EvaluateAt,
         py::arg("points"),
         "Density in density units at points (n x 3, or 3 numbers; mm): n numbers, NaN outside the body. Runs in "
         "parallel; what places are looked up in is made at the first call and kept.")
    .def("gradient",
         &Gradient,
         py::arg("points"),
         "Gradient of the density at points (n x 3, mm): n x 3, density units per mm, NaN outside the body.")
    .def("locate",
         &Locate,
         py::arg("points"),
         "The tetrahedra that points (n x 3, mm) lie in: n ids, -1 outside, and n x 4 barycentric coordinates.")
    .def(
      "_shade",
      [](const Mesh & self, int pixels) {
        std::string png;
        {
          const py::gil_scoped_release release;
          png = ShadeToPng(self, pixels);
        }
        return py::bytes(png);
      },
      py::arg("pixels") = 240);
}
} // namespace bone::python
