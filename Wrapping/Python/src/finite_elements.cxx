/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "analysis.h"
#include "failure.h"
#include "parameter_table.h"

#include "boneCurvedBoundary.h"
#include "boneDensityCalibration.h"
#include "boneDensityQuantityChoices.h"
#include "boneFiniteElementIO.h"
#include "boneTriangleSurface.h"

namespace bone::python
{
namespace
{
py::dict
DescribeElasticity(const ElasticityLaw & law)
{
  return py::dict(py::arg("name") = law.name,
                  py::arg("relation") = law.DescribeRelation(),
                  py::arg("density") = ParameterText(law.density),
                  py::arg("low") = law.low,
                  py::arg("high") = law.high,
                  py::arg("bone") = law.bone,
                  py::arg("source") = law.source);
}

py::dict
DescribeSets(const std::vector<FiniteElementSet> & sets)
{
  py::dict dict;
  for (const FiniteElementSet & set : sets)
  {
    dict[py::str(set.name)] = Copy(set.ids);
  }
  return dict;
}

/** Rows of ids of nodes. */
template <typename TRows>
py::array_t<IdType>
CopyRows(const TRows & rows, std::size_t width)
{
  py::array_t<IdType> array({ static_cast<py::ssize_t>(rows.size()), static_cast<py::ssize_t>(width) });
  IdType *            next = array.mutable_data();
  for (const auto & row : rows)
  {
    next = std::copy_n(row.begin(), width, next);
  }
  return array;
}

py::dict
DescribeElements(const FiniteElementModel & model)
{
  std::vector<std::vector<IdType>> exterior;
  for (const FiniteElementFace & face : model.exterior)
  {
    exterior.push_back(FiniteElementFaceNodes(model, face));
  }
  std::vector<double> moduli, densities;
  for (const FiniteElementMaterial & material : model.materials)
  {
    moduli.push_back(material.modulus);
    densities.push_back(material.massDensity);
  }
  py::dict dict;
  dict["nodes"] = FromPoints(model.nodes);
  dict["elements"] = CopyRows(model.elements, static_cast<std::size_t>(model.NodesEach()));
  dict["region"] = Copy(model.region);
  dict["modulus"] = Copy(model.modulus);
  dict["mass_density"] = Copy(model.massDensity);
  dict["node_modulus"] = Copy(model.nodeModulus);
  dict["material"] = Copy(model.material);
  dict["materials"] = py::dict(py::arg("modulus") = Copy(moduli), py::arg("mass_density") = Copy(densities));
  dict["node_sets"] = DescribeSets(model.nodeSets);
  dict["element_sets"] = DescribeSets(model.elementSets);
  dict["exterior"] = CopyRows(exterior, model.order == 2 ? 6 : 3);
  dict["law"] = DescribeElasticity(model.law);
  dict["soft_elements"] = model.softElements;
  dict["share_outside"] = model.shareOutside;
  dict["bin_error_mean"] = model.binErrorMean;
  dict["bin_error_largest"] = model.binErrorLargest;
  return dict;
}

/** The exterior of a finer model, or points and triangles. */
TriangleSurface
ToSurface(const py::object & object)
{
  std::vector<IdType> ids;
  if (py::isinstance<Mesh>(object))
  {
    return ExteriorSurface(object.cast<const Mesh &>().GetArrays(), ids);
  }
  const auto      pair = object.cast<std::pair<Array<double>, Array<IdType>>>();
  TriangleSurface surface;
  surface.points = ToPoints(pair.first, "the surface's points");
  surface.triangles = ToTriangles(pair.second);
  return surface;
}

py::dict
Export(const Mesh &                                     mesh,
       const std::string &                              name,
       const py::dict &                                 points,
       const std::optional<std::pair<double, double>> & line,
       const py::object &                               surface,
       const std::string &                              path,
       const std::string &                              format,
       const py::kwargs &                               keywords)
{
  const auto            parameters = ReadParameters<FiniteElementParameters>(keywords, "a finite-element model");
  const ElasticityLaw & law = FindElasticityLaw(name);
  const auto            landmarks = ToLandmarks(points);
  const auto            kind = path.empty() ? FiniteElementFormat::Abaqus : ParseChoice<FiniteElementFormat>(format);
  FiniteElementModel    model;
  {
    const py::gil_scoped_release release;
    MeshArrays                   arrays = mesh.GetArrays();
    if (line)
    {
      DensityLaw calibration;
      calibration.to = law.density;
      calibration.intercept = line->first;
      calibration.slope = line->second;
      ConvertDensity(arrays, calibration);
    }
    model = MakeFiniteElements(arrays, law, parameters, landmarks);
  }
  py::object curved = py::none();
  if (!surface.is_none())
  {
    const TriangleSurface target = ToSurface(surface);
    const CurvedBoundary  result = CurveBoundary(TriangleDistance(target.points, target.triangles), model);
    curved = py::dict(py::arg("curved") = result.curved,
                      py::arg("refused") = result.refused,
                      py::arg("largest_move") = result.largestMove);
  }
  if (!path.empty())
  {
    const py::gil_scoped_release release;
    WriteFiniteElements(model, kind, path);
  }
  py::dict dict = DescribeElements(model);
  dict["curved"] = curved;
  return dict;
}
} // namespace

void
BindFiniteElements(py::module_ & m)
{
  m.def("_export",
        &Export,
        py::arg("mesh"),
        py::arg("law"),
        py::arg("landmarks"),
        py::arg("line"),
        py::arg("surface"),
        py::arg("path"),
        py::arg("format"));
  m.def(
    "elasticity_laws",
    [] {
      py::list laws;
      for (const ElasticityLaw & law : PublishedElasticityLaws())
      {
        laws.append(DescribeElasticity(law));
      }
      return laws;
    },
    "Published laws of Young's modulus (MPa) by density (g/cm3): dicts of name, relation, density (ash or apparent), "
    "low "
    "and high of what was measured, bone and source.");
}
} // namespace bone::python
