/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneMarkups.h"

#include "boneJson.h"
#include "boneRefuse.h"

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

Polyline
ReadClosedCurve(const json & markup)
{
  const double sign = SignToLps(markup);
  Polyline     polyline;
  const json & points = Member(markup, "controlPoints");
  if (!points.is_array())
  {
    Refuse("'controlPoints' must be a list");
  }
  for (const json & point : points)
  {
    if (point.is_object() && point.contains("positionStatus") && TextMember(point, "positionStatus") != "defined")
    {
      continue;
    }
    const Vector3 position = NumbersMember(point, "position", 3);
    polyline.contour.points.emplace_back(sign * position.x(), sign * position.y(), position.z());
  }
  auto & curve = polyline.contour.points;
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

std::vector<Polyline>
ReadMarkups(const std::string & path)
{
  const json document = ReadJsonFile(path);
  return NamingFile(path, [&] {
    const json & markups = Member(document, "markups");
    if (!markups.is_array())
    {
      Refuse("'markups' must be a list");
    }
    std::vector<Polyline> polylines;
    for (const json & markup : markups)
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
} // namespace bone
