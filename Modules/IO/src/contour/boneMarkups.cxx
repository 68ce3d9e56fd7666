/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneMarkups.h"

#include "boneJson.h"
#include "boneRefuse.h"

#include <cstdio>

namespace bone
{
namespace
{
using nlohmann::json;

// +1 for LPS, -1 for RAS: the factor of x and y.
double
SignToLps(const json & markup)
{
  const std::string system = markup.contains("coordinateSystem") ? TextMember(markup, "coordinateSystem") : "LPS";
  if (system != "LPS" && system != "RAS")
  {
    Refuse("'coordinateSystem' is '", system, "'; LPS and RAS are known");
  }
  return system == "LPS" ? 1.0 : -1.0;
}

// What WriteContours notes with each control point, so that a contour can be told from its points.
constexpr const char * NoteFormat = "layer %d, region %d, contour %d, slice %d";

void
ReadNote(const std::string & text, Polyline & polyline)
{
  Contour contour;
  int     slice = -1;
  if (std::sscanf(text.c_str(), NoteFormat, &contour.layer, &contour.region, &contour.id, &slice) == 4 &&
      contour.layer >= 0 && contour.region >= 0 && contour.id >= 0)
  {
    polyline.contour.layer = contour.layer;
    polyline.contour.region = contour.region;
    polyline.contour.id = contour.id;
    polyline.hasRegion = polyline.hasId = true;
  }
}

std::string
OptionalText(const json & object, const char * name)
{
  return object.is_object() && object.contains(name) ? TextMember(object, name) : std::string();
}

Polyline
ReadClosedCurve(const json & markup)
{
  Polyline polyline;
  auto &   curve = polyline.contour.points;
  for (const ControlPoint & point : ReadControlPoints(markup))
  {
    ReadNote(point.description, polyline);
    curve.push_back(point.position);
  }
  if (curve.size() > 1 && curve.front() == curve.back())
  {
    curve.pop_back();
  }
  if (curve.size() < 3)
  {
    Refuse("a closed curve has ", curve.size(), " control points where three or more are needed");
  }
  return polyline;
}
} // namespace

const json &
MarkupsOf(const json & document)
{
  const json & markups = Member(document, "markups");
  if (!markups.is_array())
  {
    Refuse("'markups' must be a list");
  }
  return markups;
}

std::vector<ControlPoint>
ReadControlPoints(const json & markup)
{
  const double sign = SignToLps(markup);
  const json & points = Member(markup, "controlPoints");
  if (!points.is_array())
  {
    Refuse("'controlPoints' must be a list");
  }
  std::vector<ControlPoint> placed;
  for (const json & point : points)
  {
    const std::string status = OptionalText(point, "positionStatus");
    if (status.empty() || status == "defined")
    {
      const Vector3 position = NumbersMember(point, "position", 3);
      placed.push_back({ OptionalText(point, "label"),
                         OptionalText(point, "description"),
                         { sign * position.x(), sign * position.y(), position.z() } });
    }
  }
  return placed;
}

std::string
MarkupsText(json markups)
{
  const json document = { { "@schema",
                            "https://raw.githubusercontent.com/slicer/slicer/master/Modules/Loadable/Markups/"
                            "Resources/Schema/markups-schema-v1.0.3.json#" },
                          { "markups", std::move(markups) } };
  return document.dump(1) + '\n';
}

std::vector<Polyline>
ReadMarkups(const std::string & path)
{
  const json document = ReadJsonFile(path);
  return NamingFile(path, [&] {
    std::vector<Polyline> polylines;
    for (const json & markup : MarkupsOf(document))
    {
      const std::string type = TextMember(markup, "type");
      if (type != "ClosedCurve")
      {
        Refuse("holds a markup of type '", type, "'; only ClosedCurve is a contour");
      }
      polylines.push_back(ReadClosedCurve(markup));
    }
    return polylines;
  });
}

std::string
ToMarkups(const ContourStack & stack)
{
  json markups = json::array();
  for (std::size_t k = 0; k < stack.GetSlices().size(); ++k)
  {
    for (const Contour & contour : stack.GetSlices()[k].contours)
    {
      if (contour.axis)
      {
        continue;
      }
      char note[80];
      std::snprintf(note, sizeof(note), NoteFormat, contour.layer, contour.region, contour.id, static_cast<int>(k));
      json points = json::array();
      for (std::size_t i = 0; i < contour.points.size(); ++i)
      {
        points.push_back({ { "id", std::to_string(i + 1) },
                           { "label", "" },
                           { "description", note },
                           { "position", ToJson(contour.points[i]) },
                           { "positionStatus", "defined" } });
      }
      markups.push_back({ { "type", "ClosedCurve" },
                          { "name", "slice " + std::to_string(k) + " contour " + std::to_string(contour.id) },
                          { "coordinateSystem", "LPS" },
                          { "coordinateUnits", "mm" },
                          { "controlPoints", std::move(points) } });
    }
  }
  return MarkupsText(std::move(markups));
}
} // namespace bone
