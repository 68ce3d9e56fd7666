/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "bindings.h"
#include "failure.h"
#include "objects.h"

#include "boneContourIO.h"
#include "boneHierarchyIO.h"
#include "boneModelIO.h"

namespace bone::python
{
namespace
{
using Hierarchy = DensityHierarchy<>;

/** A level by Python's index, from the end where it is negative. */
const Hierarchy::Level &
LevelOf(const Hierarchy & hierarchy, py::ssize_t index)
{
  const auto count = static_cast<py::ssize_t>(hierarchy.GetNumberOfLevels());
  if (index < -count || index >= count)
  {
    throw py::index_error("the hierarchy has " + std::to_string(count) + " levels");
  }
  return hierarchy.GetLevels()[static_cast<std::size_t>(index < 0 ? index + count : index)];
}

py::dict
DescribeLevel(const Hierarchy & hierarchy, py::ssize_t index)
{
  const auto & level = LevelOf(hierarchy, index);
  py::dict     dict;
  dict["mesh"] = level.mesh;
  dict["parent_point"] =
    py::array_t<IdType>(static_cast<py::ssize_t>(level.parentPoint.size()), level.parentPoint.data());
  dict["density_error_bound"] = level.densityErrorBound;
  dict["density_error"] = level.densityError;
  dict["surface_error"] = level.surfaceError;
  dict["stop_reason"] = level.stopReason;
  return dict;
}

Hierarchy::Pointer
BuildHierarchy(const std::vector<Mesh *> & meshes)
{
  std::vector<Hierarchy::Level> levels;
  for (Mesh * mesh : meshes)
  {
    if (mesh == nullptr)
    {
      throw UsageFailure("a level of a hierarchy must be a DensityMesh");
    }
    levels.emplace_back();
    levels.back().mesh = mesh;
  }
  auto hierarchy = Hierarchy::New();
  hierarchy->SetLevels(std::move(levels));
  return hierarchy;
}

void
BindHierarchy(py::module_ & m)
{
  py::class_<Hierarchy, itk::SmartPointer<Hierarchy>, itk::DataObject>(
    m, "DensityHierarchy", "Levels of one density model from fine to coarse; hierarchy[0] is the finest mesh.")
    .def(py::init(&BuildHierarchy), py::arg("meshes"))
    .def("__len__", &Hierarchy::GetNumberOfLevels)
    .def("__getitem__",
         [](const Hierarchy & self, py::ssize_t index) { return itk::SmartPointer<Mesh>(LevelOf(self, index).mesh); })
    .def("level",
         &DescribeLevel,
         py::arg("index"),
         "A dict of mesh, parent_point (ids in the level before), density_error_bound (negative: none), density_error "
         "(density units, to the first level), surface_error (mm) and stop_reason.")
    .def("pick_by_count",
         &Hierarchy::PickByCount,
         py::arg("tetrahedra"),
         "Index of the finest level of no more than so many tetrahedra.")
    .def("pick_by_error",
         &Hierarchy::PickByError,
         py::arg("density_error"),
         py::arg("surface_error") = std::numeric_limits<double>::infinity(),
         "Index of the coarsest level whose errors are no more than these (density units, mm).")
    .def("__repr__", [](const Hierarchy & self) {
      std::string text = "<bonetk.DensityHierarchy:";
      for (const auto & level : self.GetLevels())
      {
        text += ' ' + std::to_string(level.mesh->GetNumberOfTetrahedra());
      }
      return text + " tetrahedra>";
    });
  m.def(
    "read_hierarchy",
    [](const std::string & path) {
      const py::gil_scoped_release release;
      return ReadHierarchy(path);
    },
    py::arg("path"),
    "Reads the levels of a .hierarchy.json.");
  m.def(
    "write_hierarchy",
    [](const Hierarchy & self, const std::string & prefix) {
      const py::gil_scoped_release release;
      return WriteHierarchy(&self, prefix);
    },
    py::arg("hierarchy"),
    py::arg("prefix"),
    "Writes PREFIX_L1.vtu, ... and PREFIX.hierarchy.json; returns the paths.");
}

ContourStack::Pointer
BuildStack(const std::vector<std::vector<Contour>> & slices,
           const py::object &                        u,
           const py::object &                        v,
           bool                                      openStart,
           bool                                      openEnd)
{
  auto stack = ContourStack::New();
  stack->SetFrame(ToVector(u, "u"), ToVector(v, "v"));
  ContourStack::SliceContainer container;
  for (const auto & contours : slices)
  {
    ContourSlice slice;
    slice.contours = contours;
    if (contours.empty() || contours.front().points.empty())
    {
      throw UsageFailure("slice " + std::to_string(container.size()) + " has no contour with points");
    }
    slice.origin = contours.front().points.front().dot(stack->GetNormal()) * stack->GetNormal();
    container.push_back(std::move(slice));
  }
  stack->SetSlices(std::move(container));
  stack->SetOpenStart(openStart);
  stack->SetOpenEnd(openEnd);
  stack->Verify();
  return stack;
}

void
BindContours(py::module_ & m)
{
  py::class_<Contour>(
    m,
    "Contour",
    "One polyline on a slice.\n\npoints: n x 3, mm. layer: 0 periosteal, 1 endosteal, 2 boundary of the "
    "medullary cavity. region: of the material just inside; 0 for a hole. axis: of a medial axis.")
    .def(py::init([](const Array<double> & points, int layer, int id, int region, bool axis) {
           Contour contour;
           contour.points = ToPoints(points, "points");
           contour.layer = layer;
           contour.id = id;
           contour.region = region;
           contour.axis = axis;
           return contour;
         }),
         py::arg("points"),
         py::kw_only(),
         py::arg("layer") = 0,
         py::arg("id") = 0,
         py::arg("region") = 1,
         py::arg("axis") = false)
    .def_property_readonly(
      "points",
      [](const py::object & self) {
        const auto & points = self.cast<const Contour &>().points;
        return View<double>(
          points.empty() ? nullptr : points.front().data(), { static_cast<py::ssize_t>(points.size()), 3 }, self);
      },
      "n x 3, mm; a read-only view.")
    .def_readonly("layer", &Contour::layer)
    .def_readonly("id", &Contour::id)
    .def_readonly("region", &Contour::region)
    .def_readonly("axis", &Contour::axis)
    .def("__repr__", [](const Contour & self) {
      return "<bonetk.Contour: " + std::to_string(self.points.size()) + " points, layer " + std::to_string(self.layer) +
             '>';
    });

  py::class_<ContourStack, itk::SmartPointer<ContourStack>, itk::DataObject>(
    m,
    "ContourStack",
    "Parallel slices in order, each a list of Contour.\n\nu, v: the in-plane axes; slices ascend along u x v. "
    "open_start, open_end: the bone goes on beyond the first (last) slice. Throws DataError where contours cross.")
    .def(py::init(&BuildStack),
         py::arg("slices"),
         py::kw_only(),
         py::arg("u") = py::make_tuple(1, 0, 0),
         py::arg("v") = py::make_tuple(0, 1, 0),
         py::arg("open_start") = false,
         py::arg("open_end") = false)
    .def("__len__", [](const ContourStack & self) { return self.GetSlices().size(); })
    .def(
      "__getitem__",
      [](const ContourStack & self, std::size_t index) {
        if (index >= self.GetSlices().size())
        {
          throw py::index_error("the stack has " + std::to_string(self.GetSlices().size()) + " slices");
        }
        return self.GetSlices()[index].contours;
      },
      "The contours of a slice, copies.")
    .def_property_readonly("u", [](const ContourStack & self) { return FromVector(self.GetU()); })
    .def_property_readonly("v", [](const ContourStack & self) { return FromVector(self.GetV()); })
    .def_property_readonly("normal", [](const ContourStack & self) { return FromVector(self.GetNormal()); })
    .def_property_readonly("open_start", [](const ContourStack & self) { return self.GetOpenStart(); })
    .def_property_readonly("open_end", [](const ContourStack & self) { return self.GetOpenEnd(); })
    .def("__repr__", [](const ContourStack & self) {
      return "<bonetk.ContourStack: " + std::to_string(self.GetSlices().size()) + " slices, " +
             std::to_string(self.GetNumberOfContours()) + " contours>";
    });
  m.def(
    "read_contours",
    [](const std::string & path, const std::string & structure, int label, unsigned int axis) {
      const py::gil_scoped_release release;
      return ReadContours(path, ContourSelection{ structure, label, axis });
    },
    py::arg("path"),
    py::arg("structure") = "",
    py::arg("label") = 0,
    py::arg("axis") = 2,
    "Reads contours: .vtp, .mrk.json, a DICOM structure set (structure), or a label map (label, axis).");
  m.def(
    "write_contours",
    [](const ContourStack & self, const std::string & path) {
      const py::gil_scoped_release release;
      WriteContours(&self, path);
    },
    py::arg("contours"),
    py::arg("path"),
    "Writes .vtp or .mrk.json, the whole file or none.");
}

/** A matrix of a model, columns one after the other. */
py::object
ViewMatrix(const StatisticalModel & model, const Eigen::MatrixXd & matrix)
{
  const py::object owner = ArrayOwner(&model);
  if (owner.is_none())
  {
    return py::cast(matrix);
  }
  py::array_t<double> array({ matrix.rows(), matrix.cols() },
                            { py::ssize_t{ sizeof(double) }, py::ssize_t{ sizeof(double) } * matrix.rows() },
                            matrix.data(),
                            owner);
  array.attr("flags").attr("writeable") = false;
  return std::move(array);
}

void
BindModel(py::module_ & m)
{
  py::class_<StatisticalModel, itk::SmartPointer<StatisticalModel>, itk::DataObject> model(
    m,
    "StatisticalModel",
    "The atlas: mean shape and density of a bone and their modes of variation on one topology.\n\n"
    "Matrices are read-only views of the model's own memory, copies of an output of a filter.");
  const auto matrix = [&model](const char * name, auto member, const char * doc) {
    model.def_property_readonly(
      name, [member](const StatisticalModel & self) { return ViewMatrix(self, member(self.GetContent())); }, doc);
  };
  using Content = StatisticalModelContent;
  using Matrix = Eigen::MatrixXd;
  matrix(
    "shape_modes",
    [](const Content & c) -> const Matrix & { return c.shape.modes; },
    "3n x #ks; orthonormal columns of (x1, y1, z1, x2, ...).");
  matrix(
    "density_modes",
    [](const Content & c) -> const Matrix & { return c.density.modes; },
    "mk x #kd, of the coefficients in the mesh's order; empty: no density.");
  matrix(
    "shape_scores",
    [](const Content & c) -> const Matrix & { return c.shapeScores; },
    "#subjects x #ks, standard deviations.");
  matrix(
    "density_scores",
    [](const Content & c) -> const Matrix & { return c.densityScores; },
    "#subjects x #kd, standard deviations.");
  model
    .def_property_readonly(
      "mean",
      [](const StatisticalModel & self) { return MakeMesh(self.GetContent().mean); },
      "DensityMesh of the mean shape and density; a copy.")
    .def_property_readonly(
      "shape_variances",
      [](const StatisticalModel & self) { return self.GetContent().shape.variances; },
      "#ks, mm^2, descending; a copy.")
    .def_property_readonly(
      "density_variances",
      [](const StatisticalModel & self) { return self.GetContent().density.variances; },
      "#kd, density units squared, descending; a copy.")
    .def_property_readonly(
      "subjects",
      [](const StatisticalModel & self) { return self.GetContent().subjects; },
      "Names of the training set.")
    .def_property_readonly("has_density", &StatisticalModel::HasDensity)
    .def(
      "synthesize",
      [](const StatisticalModel & self, const Eigen::VectorXd & shape, const Eigen::VectorXd & density) {
        const py::gil_scoped_release release;
        return MakeMesh(self.Synthesize(shape, density));
      },
      py::arg("shape") = py::tuple(),
      py::arg("density") = py::tuple(),
      "The mesh of coefficients in standard deviations; those that are not given are 0.")
    .def("__repr__", [](const StatisticalModel & self) {
      const auto & content = self.GetContent();
      return "<bonetk.StatisticalModel: " + std::to_string(content.mean.points.size()) + " points, " +
             std::to_string(content.shape.GetNumberOfModes()) + " modes of shape, " +
             std::to_string(content.density.GetNumberOfModes()) + " of density>";
    });
  m.def(
    "read_model",
    [](const std::string & path) {
      const py::gil_scoped_release release;
      return ReadStatisticalModel(path);
    },
    py::arg("path"),
    "Reads an atlas (.h5).");
  m.def(
    "write_model",
    [](const StatisticalModel & self, const std::string & path) {
      const py::gil_scoped_release release;
      WriteStatisticalModel(&self, path);
    },
    py::arg("model"),
    py::arg("path"),
    "Writes an atlas (.h5), the whole file or none.");
}
} // namespace
} // namespace bone::python

void
BindModels(pybind11::module_ & m)
{
  bone::python::BindHierarchy(m);
  bone::python::BindContours(m);
  bone::python::BindModel(m);
}
