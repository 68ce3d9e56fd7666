/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneMeasureReport.h"

#include "boneFemurMeasures.h"
#include "boneHemipelvisMeasures.h"
#include "boneJson.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace bone
{
std::size_t
NumbersOfSolid(SolidShape shape)
{
  return shape == SolidShape::Ball ? 4 : shape == SolidShape::HalfSpace ? 6 : 7;
}

namespace
{
NamedSolid
NameSolid(SolidShape shape, const double * x)
{
  const Vector3      from(x[0], x[1], x[2]);
  std::ostringstream text;
  const auto         point = [&text](const double * p) -> std::ostream & {
    return text << '(' << p[0] << ", " << p[1] << ", " << p[2] << ')';
  };
  if (shape == SolidShape::Ball)
  {
    text << "the ball of radius " << x[3] << " mm about ";
    point(x);
    return { "ball", text.str(), MakeBall(from, x[3]) };
  }
  const Vector3 to(x[3], x[4], x[5]);
  if (shape == SolidShape::HalfSpace)
  {
    text << "the half-space from the plane through ";
    point(x) << " along ";
    point(x + 3);
    return { "halfSpace", text.str(), MakeHalfSpace(from, to) };
  }
  const bool        flat = shape == SolidShape::Cylinder;
  const std::string name = flat ? "cylinder" : "capsule";
  text << "the " << name << " of radius " << x[6] << " mm from ";
  point(x) << " to ";
  point(x + 3);
  return { name, text.str(), flat ? MakeCylinder(from, to, x[6]) : MakeCapsule(from, to, x[6]) };
}
} // namespace

std::vector<NamedSolid>
NameSolids(SolidShape shape, const std::vector<double> & numbers)
{
  const std::size_t       each = NumbersOfSolid(shape);
  std::vector<NamedSolid> solids;
  for (std::size_t i = 0; i + each <= numbers.size(); i += each)
  {
    solids.push_back(NameSolid(shape, numbers.data() + i));
    solids.back().name += std::to_string(i / each + 1);
  }
  return solids;
}

namespace
{
constexpr const char * NoDensity = "the model holds no density: fit one to a CT";

std::string
NameOfRegion(int region)
{
  const char * const names[] = { "outside", "cortical bone", "trabecular bone", "medullary cavity" };
  const std::string  number = "region " + std::to_string(region);
  return region >= Cortical && region <= Medullary ? number + ", " + names[region] + "," : number;
}

/** Volume, mass and mean density of one part, whose names begin with `prefix`. */
void
AppendPart(const PartDensity & part,
           const MeshArrays &  mesh,
           const std::string & prefix,
           const std::string & what,
           MeasureList &       list)
{
  list.measures.push_back({ prefix + ".volume", { part.volume }, "mm^3", "Volume of " + what, "", part.volumeError });
  if (!mesh.HasDensity())
  {
    list.missing.push_back({ prefix + ".mass", NoDensity });
    list.missing.push_back({ prefix + ".meanDensity", NoDensity });
    return;
  }
  double            factor = 1.0;
  const std::string unit = MassUnit(mesh.quantity, factor);
  list.measures.push_back({ prefix + ".mass",
                            { factor * part.mass },
                            unit,
                            "Integral of the density over " + what,
                            "",
                            factor * part.massError });
  if (!(part.volume > 0.0))
  {
    list.missing.push_back({ prefix + ".meanDensity", "there is nothing of the model in it" });
    return;
  }
  // Of a quotient whose terms lie within bounds.
  const double volumeShare = part.volumeError / part.volume;
  const double error = volumeShare < 1.0
                         ? (part.massError / part.volume + std::abs(part.mean) * volumeShare) / (1.0 - volumeShare)
                         : HUGE_VAL;
  list.measures.push_back({ prefix + ".meanDensity",
                            { part.mean },
                            DensityQuantityName(mesh.quantity),
                            "Integral of the density over " + what + ", by its volume",
                            "",
                            error });
}

bool
IsAmong(const std::vector<Landmark> & landmarks, const std::vector<std::string> & names)
{
  return std::any_of(landmarks.begin(), landmarks.end(), [&names](const Landmark & landmark) {
    return std::find(names.begin(), names.end(), landmark.name) != names.end();
  });
}

/** Measures of the bone that the landmarks are of. `mesh`: null for a surface. */
MeasureList
MeasureBone(const TriangleSurface &       surface,
            const MeshArrays *            mesh,
            const std::vector<Landmark> & landmarks,
            const MeasureParameters &     parameters)
{
  MeasureList list;
  const bool  isFemur = IsAmong(landmarks, FemurLandmarkNames());
  const bool  isHemipelvis = IsAmong(landmarks, HemipelvisLandmarkNames());
  if (isFemur)
  {
    const FemurGeometry femur = FitFemur(surface, landmarks, parameters.landmarkReach);
    list.Append(MeasureFemur(femur));
    if (mesh)
    {
      list.Append(MeasureNeckCortex(*mesh, femur));
    }
    else
    {
      list.missing.push_back({ "neckCorticalThickness", "a surface has no layers: measure a density model" });
    }
  }
  if (isHemipelvis)
  {
    list.Append(MeasureHemipelvis(FitHemipelvis(surface, landmarks, parameters.landmarkReach)));
  }
  if (!isFemur && !isHemipelvis)
  {
    list.missing.push_back({ "femur", "no landmark of a femur was given, such as femoral_head" });
    list.missing.push_back({ "hemipelvis", "no landmark of a hemipelvis was given, such as acetabulum" });
  }
  return list;
}
} // namespace

std::string
MassUnit(DensityQuantity quantity, double & factor)
{
  factor = 1.0;
  switch (quantity)
  {
    case DensityQuantity::K2HPO4MilligramPerCubicCentimetre:
    case DensityQuantity::HydroxyapatiteMilligramPerCubicCentimetre:
      factor = 1e-3; // cm^3 in a mm^3
      return "mg";
    case DensityQuantity::AshGramPerCubicCentimetre:
    case DensityQuantity::ApparentGramPerCubicCentimetre:
      return "mg";
    case DensityQuantity::HounsfieldUnit:
      return "HU mm^3";
    case DensityQuantity::Unknown:
      break;
  }
  return "density unit mm^3";
}

MeasureList
MeasurePart(const MeshArrays & mesh, const NamedSolid & part, const MeasureParameters & parameters)
{
  const SolidDensity found = IntegrateSolid(mesh, part.solid, parameters.solidError);
  const std::string  inside = part.description.empty() ? "" : " in " + part.description;
  MeasureList        list;
  AppendPart(found.total, mesh, part.name, "the model" + inside, list);
  for (const PartDensity & region : found.regions)
  {
    AppendPart(region,
               mesh,
               part.name + ".region" + std::to_string(region.region),
               NameOfRegion(region.region) + " of the model" + inside,
               list);
  }
  return list;
}

MeasureReport
MeasureModel(const MeshArrays &              mesh,
             const std::vector<Landmark> &   landmarks,
             const std::vector<NamedSolid> & solids,
             const MeasureParameters &       parameters)
{
  MeasureReport report;
  report.landmarks = landmarks;
  report.places = LocateLandmarks(mesh, landmarks);
  report.list = MeasurePart(mesh, { "model", "", Solid() }, parameters);
  for (const NamedSolid & solid : solids)
  {
    report.list.Append(MeasurePart(mesh, solid, parameters));
  }
  std::vector<IdType> ids;
  report.list.Append(MeasureBone(ExteriorSurface(mesh, ids), &mesh, landmarks, parameters));
  return report;
}

MeasureReport
MeasureSurface(const TriangleSurface &       surface,
               const std::vector<Landmark> & landmarks,
               const MeasureParameters &     parameters)
{
  MeasureReport report;
  report.landmarks = landmarks;
  report.list.measures.push_back(
    { "model.volume", { EnclosedVolume(surface) }, "mm^3", "Volume that the surface encloses" });
  report.list.Append(MeasureBone(surface, nullptr, landmarks, parameters));
  return report;
}

nlohmann::json
ReportMeasures(const MeasureReport & report)
{
  using nlohmann::json;
  json result;
  result["landmarks"] = json::array();
  for (std::size_t i = 0; i < report.landmarks.size(); ++i)
  {
    json entry{ { "name", report.landmarks[i].name },
                { "value", ToJson(report.landmarks[i].point) },
                { "unit", "mm" },
                { "definition", "Landmark in the model's space (LPS)" } };
    if (i < report.places.size())
    {
      entry["distance"] = report.places[i].place.distance;
      entry["cell"] = report.places[i].place.cell;
      entry["barycentric"] = ToJson(report.places[i].place.mu);
    }
    result["landmarks"].push_back(entry);
  }
  result["measures"] = json::array();
  for (const Measure & measure : report.list.measures)
  {
    json entry{ { "name", measure.name }, { "unit", measure.unit }, { "definition", measure.definition } };
    if (!measure.text.empty())
    {
      entry["value"] = measure.text;
    }
    else if (measure.value.size() == 1)
    {
      entry["value"] = measure.value[0];
    }
    else
    {
      entry["value"] = measure.value;
    }
    if (measure.error > 0.0)
    {
      entry["errorBound"] = measure.error;
    }
    result["measures"].push_back(entry);
  }
  result["missing"] = json::array();
  for (const MissingMeasure & missing : report.list.missing)
  {
    result["missing"].push_back({ { "name", missing.name }, { "reason", missing.reason } });
  }
  return result;
}
} // namespace bone
