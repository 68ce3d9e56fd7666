/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "analysis.h"

#include "filters.h"

#include "boneAtlasReport.h"
#include "boneMeasureReport.h"
#include "bonePathPlan.h"
#include "bonePopulation.h"
#include "boneResectionPlan.h"
#include "boneStatisticalModel.h"

namespace bone::python
{
std::vector<Landmark>
ToLandmarks(const py::dict & points)
{
  std::vector<Landmark> landmarks;
  for (const auto & item : points)
  {
    const auto name = item.first.cast<std::string>();
    landmarks.push_back({ name, ToVector(py::reinterpret_borrow<py::object>(item.second), name.c_str()) });
  }
  return landmarks;
}

namespace
{
/** What the program writes as JSON, as dicts and lists. */
py::object
FromJson(const nlohmann::json & json)
{
  if (json.is_object())
  {
    py::dict dict;
    for (const auto & item : json.items())
    {
      dict[py::str(item.key())] = FromJson(item.value());
    }
    return std::move(dict);
  }
  if (json.is_array())
  {
    py::list list;
    for (const auto & element : json)
    {
      list.append(FromJson(element));
    }
    return std::move(list);
  }
  if (json.is_number_float())
  {
    return py::float_(json.get<double>());
  }
  if (json.is_number())
  {
    return py::int_(json.get<std::int64_t>());
  }
  if (json.is_boolean())
  {
    return py::bool_(json.get<bool>());
  }
  return json.is_string() ? py::object(py::str(json.get<std::string>())) : py::object(py::none());
}

/** Rows of so many numbers, one beside the other. */
std::vector<double>
ToRows(const Array<double> & rows, std::size_t width, const char * name)
{
  if (rows.size() != 0 && (rows.ndim() != 2 || rows.shape(1) != static_cast<py::ssize_t>(width)))
  {
    throw UsageFailure(std::string(name) + " must be rows of " + std::to_string(width) + " numbers");
  }
  return { rows.data(), rows.data() + rows.size() };
}

py::object
MeasureMesh(const Mesh &          mesh,
            const py::dict &      points,
            const Mesh *          standard,
            const Array<double> & balls,
            const Array<double> & cylinders,
            const Array<double> & capsules,
            const Array<double> & halfSpaces,
            const py::kwargs &    keywords)
{
  const auto              parameters = ReadParameters<MeasureParameters>(keywords, "a measurement");
  auto                    landmarks = ToLandmarks(points);
  std::vector<NamedSolid> solids;
  const auto              add = [&solids](SolidShape shape, const Array<double> & rows, const char * name) {
    const auto named = NameSolids(shape, ToRows(rows, NumbersOfSolid(shape), name));
    solids.insert(solids.end(), named.begin(), named.end());
  };
  add(SolidShape::Ball, balls, "balls");
  add(SolidShape::Cylinder, cylinders, "cylinders");
  add(SolidShape::Capsule, capsules, "capsules");
  add(SolidShape::HalfSpace, halfSpaces, "half_spaces");
  nlohmann::json json;
  {
    const py::gil_scoped_release release;
    const MeshArrays             model = mesh.GetArrays();
    if (standard != nullptr)
    {
      landmarks = CarryLandmarks(standard->GetArrays(), landmarks, model);
    }
    json = ReportMeasures(MeasureModel(model, landmarks, solids, parameters));
  }
  return FromJson(json);
}

py::object
Plan(const Mesh &          mesh,
     const Array<double> & resections,
     const Array<double> & paths,
     double                radius,
     bool                  search,
     const py::kwargs &    keywords)
{
  const auto parameters = ReadParameters<PathPlanParameters>(keywords, "a plan");
  const auto planes = ToRows(resections, 6, "resections");
  const auto axes = ToRows(paths, 6, "paths");
  if (planes.empty() && axes.empty())
  {
    throw UsageFailure("nothing to plan: give resections or paths");
  }
  if (!axes.empty() && !(radius > 0.0))
  {
    throw UsageFailure("paths need a radius above 0 mm");
  }
  nlohmann::json json;
  {
    const py::gil_scoped_release release;
    const MeshArrays             model = mesh.GetArrays();
    const auto                   point = [](const double * x) { return Vector3(x[0], x[1], x[2]); };
    MeasureReport                report;
    for (std::size_t i = 0; i < planes.size(); i += 6)
    {
      const std::string name = "resection" + std::to_string(i / 6 + 1);
      report.list.Append(PlanResection(model, point(&planes[i]), point(&planes[i + 3]), name));
    }
    for (std::size_t i = 0; i < axes.size(); i += 6)
    {
      const std::string name = "path" + std::to_string(i / 6 + 1);
      report.list.Append(PlanPath(model, { point(&axes[i]), point(&axes[i + 3]), radius }, search, parameters, name));
    }
    json = ReportMeasures(report);
    json.erase("landmarks");
  }
  return FromJson(json);
}

py::object
Evaluate(const Mesh &             mesh,
         const StatisticalModel & atlas,
         const py::object &       image,
         const py::object &       progress,
         const py::kwargs &       keywords)
{
  const StatisticalModelContent & content = atlas.GetContent();
  PopulationRegistration          population(MakeMesh(content.mean), std::max(content.mean.maximumDegree, 0));
  AtlasRegistrationFilter<> &     filter = *population.GetFilter();
  filter.SetParameters(ReadParameters<AtlasRegistrationParameters>(keywords, "an evaluation"));
  const CTImage::Pointer ct = image.is_none() ? nullptr : ToCT(ToImage(image));
  PrepareFilter(&filter);
  nlohmann::json json;
  RunFilter(filter, progress, [&] {
    const MeshArrays subject = population.Bring(mesh.GetArrays(), ct);
    json = ReportSubject(EvaluateSubject(content, subject), population.WasRegistered() ? &filter.GetReport() : nullptr);
  });
  return FromJson(json);
}

py::dict
ReadLandmarkPoints(const std::string & path)
{
  std::vector<Landmark> landmarks;
  {
    const py::gil_scoped_release release;
    landmarks = ReadLandmarks(path);
  }
  py::dict dict;
  for (const Landmark & landmark : landmarks)
  {
    dict[py::str(landmark.name)] = FromVector(landmark.point);
  }
  return dict;
}
} // namespace

void
BindAnalysis(py::module_ & m)
{
  m.def("_measure",
        &MeasureMesh,
        py::arg("mesh"),
        py::arg("landmarks"),
        py::arg("standard"),
        py::arg("balls"),
        py::arg("cylinders"),
        py::arg("capsules"),
        py::arg("half_spaces"));
  m.def("_plan", &Plan, py::arg("mesh"), py::arg("resections"), py::arg("paths"), py::arg("radius"), py::arg("search"));
  m.def("_evaluate", &Evaluate, py::arg("mesh"), py::arg("atlas"), py::arg("ct"), py::arg("progress"));
  m.def("read_landmarks",
        &ReadLandmarkPoints,
        py::arg("path"),
        "Reads landmarks (.mrk.json of 3D Slicer, or JSON): a dict of name and point, mm in LPS.");
  m.def(
    "write_landmarks",
    [](const py::dict & landmarks, const std::string & path) { WriteLandmarks(ToLandmarks(landmarks), path); },
    py::arg("landmarks"),
    py::arg("path"),
    "Writes landmarks, a dict of name and point (mm, LPS), as .mrk.json, the whole file or none.");
}
} // namespace bone::python
