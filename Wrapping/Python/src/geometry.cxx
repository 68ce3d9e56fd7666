/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "bindings.h"
#include "failure.h"
#include "objects.h"

#include "boneGeometryIO.h"
#include "boneXRayConventions.h"

#include <optional>

namespace bone::python
{
namespace
{
using View3 = XRayGeometry::View;

XRayGeometry::Pointer
MakeGeometry(const View3 & view)
{
  auto geometry = XRayGeometry::New();
  geometry->SetView(view);
  return geometry;
}

XRayGeometry::Pointer
BuildGeometry(const py::object &         source,
              const py::object &         direction,
              const py::object &         origin,
              const py::object &         u,
              const py::object &         v,
              const std::array<int, 2> & size,
              const Vector2 &            spacing)
{
  if (source.is_none() == direction.is_none())
  {
    throw UsageFailure("a view needs either source (a point) or direction (a parallel beam)");
  }
  View3 view;
  view.parallel = source.is_none();
  if (view.parallel)
  {
    view.direction = ToVector(direction, "direction");
  }
  else
  {
    view.source = ToVector(source, "source");
  }
  view.detectorOrigin = ToVector(origin, "detector_origin");
  view.detectorU = ToVector(u, "detector_u");
  view.detectorV = ToVector(v, "detector_v");
  view.size = size;
  view.spacing = spacing;
  return MakeGeometry(view);
}

XRayGeometry::Pointer
FrameBox(const py::object &    lower,
         const py::object &    upper,
         const py::object &    beam,
         const py::object &    up,
         std::optional<double> sourceToCentre,
         std::optional<double> sourceToDetector,
         int                   pixels)
{
  const Vector3 low = ToVector(lower, "lower"), high = ToVector(upper, "upper");
  const Vector3 along = ToVector(beam, "beam").normalized(), upwards = ToVector(up, "up").normalized();
  if (!sourceToCentre && !sourceToDetector)
  {
    return MakeGeometry(XRayGeometry::Framing(low, high, along, upwards, pixels));
  }
  return MakeGeometry(XRayGeometry::Framing(
    low, high, along, upwards, sourceToCentre.value_or(1000.0), sourceToDetector.value_or(1200.0), pixels));
}

XRayGeometry::Pointer
BuildCArm(double                     primary,
          double                     secondary,
          const std::array<int, 2> & size,
          const Vector2 &            spacing,
          const py::object &         isocenter,
          double                     sourceToIsocenter,
          double                     sourceToDetector)
{
  CArmView arm;
  arm.primary = primary;
  arm.secondary = secondary;
  arm.size = size;
  arm.spacing = spacing;
  arm.isocenter = ToVector(isocenter, "isocenter");
  arm.sourceToIsocenter = sourceToIsocenter;
  arm.sourceToDetector = sourceToDetector;
  return MakeGeometry(FromCArm(arm));
}

py::dict
GeometryToDict(const XRayGeometry & self)
{
  const View3 & view = self.GetView();
  py::dict      dict;
  dict[view.parallel ? "direction" : "source"] = FromVector(view.parallel ? view.direction : view.source);
  dict["detectorOrigin"] = FromVector(view.detectorOrigin);
  dict["detectorU"] = FromVector(view.detectorU);
  dict["detectorV"] = FromVector(view.detectorV);
  dict["size"] = py::make_tuple(view.size[0], view.size[1]);
  dict["spacing"] = py::make_tuple(view.spacing[0], view.spacing[1]);
  return dict;
}

XRayGeometry::Pointer
GeometryFromMatrix(const Eigen::MatrixXd & matrix, const std::array<int, 2> & size, double columnSpacing)
{
  if (matrix.rows() != 3 || matrix.cols() != 4)
  {
    throw UsageFailure("a projection matrix must be 3 x 4 numbers");
  }
  return MakeGeometry(FromProjectionMatrix(matrix, size, columnSpacing));
}

XRayGeometry::Pointer
GeometryFromDict(const py::dict & dict)
{
  if (dict.contains("matrix"))
  {
    return GeometryFromMatrix(dict["matrix"].cast<Eigen::MatrixXd>(),
                              dict["size"].cast<std::array<int, 2>>(),
                              dict["columnSpacing"].cast<double>());
  }
  const auto member = [&dict](const char * name) { return dict.contains(name) ? py::object(dict[name]) : py::none(); };
  for (const char * name : { "detectorOrigin", "detectorU", "detectorV", "size", "spacing" })
  {
    if (!dict.contains(name))
    {
      throw UsageFailure(std::string("a view's \"") + name + "\" is missing");
    }
  }
  return BuildGeometry(member("source"),
                       member("direction"),
                       member("detectorOrigin"),
                       member("detectorU"),
                       member("detectorV"),
                       member("size").cast<std::array<int, 2>>(),
                       member("spacing").cast<Vector2>());
}

py::array_t<double>
ProjectPoints(const XRayGeometry & self, const Array<double> & places)
{
  const auto          points = ToPoints(places, "points");
  py::array_t<double> result(std::vector<py::ssize_t>{ static_cast<py::ssize_t>(points.size()), 2 });
  auto *              pixels = reinterpret_cast<Vector2 *>(result.mutable_data());
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    pixels[i] = self.ProjectPoint(points[i]);
  }
  return result;
}
} // namespace

void
BindGeometry(py::module_ & m)
{
  py::class_<XRayGeometry, itk::SmartPointer<XRayGeometry>, itk::DataObject> geometry(
    m,
    "XRayGeometry",
    "Source and flat detector of a radiographic view, mm in LPS.\n\nsource: a point, or direction: a unit vector from "
    "source to detector of a parallel beam. detector_origin: centre of pixel (0, 0). detector_u, detector_v: unit "
    "vectors "
    "along increasing column and row. size: (columns, rows). spacing: (du, dv), mm.");
  const auto vector = [&geometry](const char * name, Vector3 View3::*member, const char * doc) {
    geometry.def_property_readonly(
      name, [member](const XRayGeometry & self) { return FromVector(self.GetView().*member); }, doc);
  };
  geometry.def(py::init(&BuildGeometry),
               py::kw_only(),
               py::arg("source") = py::none(),
               py::arg("direction") = py::none(),
               py::arg("detector_origin"),
               py::arg("detector_u"),
               py::arg("detector_v"),
               py::arg("size"),
               py::arg("spacing"));
  vector("source", &View3::source, "mm.");
  vector("direction", &View3::direction, "Of a parallel beam.");
  vector("detector_origin", &View3::detectorOrigin, "Centre of pixel (0, 0), mm.");
  vector("detector_u", &View3::detectorU, "Unit vector along increasing column.");
  vector("detector_v", &View3::detectorV, "Unit vector along increasing row.");
  geometry.def_property_readonly("parallel", [](const XRayGeometry & self) { return self.GetView().parallel; })
    .def_property_readonly(
      "size",
      [](const XRayGeometry & self) { return py::make_tuple(self.GetView().size[0], self.GetView().size[1]); },
      "(columns, rows).")
    .def_property_readonly(
      "spacing",
      [](const XRayGeometry & self) { return py::make_tuple(self.GetView().spacing[0], self.GetView().spacing[1]); },
      "(du, dv), mm.")
    .def("project",
         &ProjectPoints,
         py::arg("points"),
         "Where points (n x 3, mm) appear: n x 2, column and row, fractional; NaN behind a point source.")
    .def(
      "pixel_point",
      [](const XRayGeometry & self, double column, double row) { return FromVector(self.GetPixelPoint(column, row)); },
      py::arg("column"),
      py::arg("row"),
      "Centre of a pixel, mm.")
    .def_property_readonly(
      "projection_matrix",
      [](const XRayGeometry & self) { return ToProjectionMatrix(self.GetView()); },
      "3 x 4: (column w, row w, w) = P (x, y, z, 1).")
    .def("to_dict", &GeometryToDict, "The members of the JSON files, see from_dict.")
    .def_static("from_dict",
                &GeometryFromDict,
                py::arg("view"),
                "Of the members of the JSON files: source or direction, detectorOrigin, detectorU, detectorV, size, "
                "spacing; or matrix, size, columnSpacing.")
    .def_static("from_matrix",
                &GeometryFromMatrix,
                py::arg("matrix"),
                py::arg("size"),
                py::arg("column_spacing"),
                "The view of a point source with a 3 x 4 matrix; column_spacing in mm.")
    .def_static(
      "framing",
      &FrameBox,
      py::arg("lower"),
      py::arg("upper"),
      py::arg("beam") = py::make_tuple(0, 1, 0),
      py::arg("up") = py::make_tuple(0, 0, 1),
      py::arg("source_to_centre") = py::none(),
      py::arg("source_to_detector") = py::none(),
      py::arg("pixels") = 512,
      "A view that just holds the box of two corners (mm), along `beam` (0, 1, 0: from the front); the longer "
      "side is `pixels` long. Distances (mm) are 1000 and 1200 where they are not given, or more where neither is and "
      "the box is too deep for them.")
    .def_static("carm",
                &BuildCArm,
                py::arg("primary"),
                py::arg("secondary") = 0.0,
                py::kw_only(),
                py::arg("size") = std::array<int, 2>{ { 512, 512 } },
                py::arg("spacing") = py::make_tuple(1.0, 1.0),
                py::arg("isocenter") = py::make_tuple(0, 0, 0),
                py::arg("source_to_isocenter") = 700.0,
                py::arg("source_to_detector") = 1000.0,
                "A C-arm's view as DICOM has it: degrees, LAO and CRA positive; (0, 0) is a PA beam. mm.")
    .def(py::pickle(&GeometryToDict, &GeometryFromDict))
    .def("__copy__", [](const XRayGeometry & self) { return MakeGeometry(self.GetView()); })
    .def("__deepcopy__", [](const XRayGeometry & self, const py::dict &) { return MakeGeometry(self.GetView()); })
    .def("__repr__", [](const XRayGeometry & self) {
      return "<bonetk.XRayGeometry " + py::str(GeometryToDict(self)).cast<std::string>() + '>';
    });
  m.def(
    "read_geometry",
    [](const std::string & path) {
      const py::gil_scoped_release release;
      return ReadGeometry(path);
    },
    py::arg("path"),
    "Reads the views of a JSON file: a list of XRayGeometry.");
  m.def(
    "write_geometry",
    [](const std::vector<XRayGeometry *> & views, const std::string & path) {
      std::vector<XRayGeometry::Pointer> pointers(views.begin(), views.end());
      const py::gil_scoped_release       release;
      WriteGeometry(pointers, path);
    },
    py::arg("views"),
    py::arg("path"),
    "Writes views as JSON, the whole file or none.");
}
} // namespace bone::python
