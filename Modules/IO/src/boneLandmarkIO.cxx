/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneLandmarkIO.h"

#include "boneAtomicFile.h"
#include "boneJson.h"
#include "boneMarkups.h"
#include "boneRefuse.h"

#include <algorithm>
#include <set>

namespace bone
{
namespace
{
using nlohmann::json;

std::vector<Landmark>
LandmarksOfMarkups(const json & document)
{
  std::vector<Landmark> landmarks;
  for (const json & markup : MarkupsOf(document))
  {
    const std::string type = TextMember(markup, "type");
    if (type != "Fiducial")
    {
      Refuse("holds a markup of type '", type, "'; only the points of a Fiducial are landmarks");
    }
    for (const ControlPoint & point : ReadControlPoints(markup))
    {
      landmarks.push_back({ point.label, point.position });
    }
  }
  return landmarks;
}

/** {"name": [numbers], ...} */
std::vector<std::pair<std::string, Eigen::VectorXd>>
NamedNumbers(const json & document, int count)
{
  if (!document.is_object())
  {
    Refuse("is ", document.type_name(), " where an object of names and coordinates is needed");
  }
  std::vector<std::pair<std::string, Eigen::VectorXd>> named;
  for (const auto & member : document.items())
  {
    named.emplace_back(member.key(), NumbersMember(document, member.key().c_str(), count));
  }
  return named;
}

template <typename TLandmark>
void
RequireNames(const std::vector<TLandmark> & landmarks)
{
  if (landmarks.empty())
  {
    Refuse("holds no landmarks");
  }
  std::set<std::string> names;
  for (const TLandmark & landmark : landmarks)
  {
    if (landmark.name.empty())
    {
      Refuse("has a landmark without a name: give each control point a label");
    }
    if (!names.insert(landmark.name).second)
    {
      Refuse("has two landmarks '", landmark.name, "': give each a name of its own");
    }
  }
}

std::vector<Landmark>
LandmarksOf(const json & document)
{
  std::vector<Landmark> landmarks;
  if (document.is_object() && document.contains("markups"))
  {
    landmarks = LandmarksOfMarkups(document);
  }
  else
  {
    for (const auto & [name, numbers] : NamedNumbers(document, 3))
    {
      landmarks.push_back({ name, numbers });
    }
  }
  RequireNames(landmarks);
  for (std::size_t i = 0; i < landmarks.size(); ++i)
  {
    RequireSensible(landmarks[i].point, i);
  }
  return landmarks;
}

/** Whether the document is {"name": [column, row], ...}. */
bool
HoldsPixels(const json & document)
{
  return document.is_object() && !document.empty() && !document.contains("markups") && document.begin()->is_array() &&
         document.begin()->size() == 2;
}

ImageLandmark
OnDetector(const Landmark & landmark, const XRayGeometry::View & view)
{
  const Vector3 offset = landmark.point - view.detectorOrigin;
  const double  away = std::abs(offset.dot(view.detectorU.cross(view.detectorV)));
  if (!(away <= 1.0 + view.spacing.maxCoeff()))
  {
    Refuse("landmark '",
           landmark.name,
           "' lies ",
           away,
           " mm from the detector of this view: name the file of the view's own landmarks, or give columns and rows");
  }
  return { landmark.name,
           { offset.dot(view.detectorU) / view.spacing.x(), offset.dot(view.detectorV) / view.spacing.y() } };
}
} // namespace

std::vector<Landmark>
ReadLandmarks(const std::string & path)
{
  const json document = ReadJsonFile(path);
  return NamingFile(path, [&] { return LandmarksOf(document); });
}

std::vector<ImageLandmark>
ReadImageLandmarks(const std::string & path, const XRayGeometry::View & view)
{
  const json document = ReadJsonFile(path);
  return NamingFile(path, [&] {
    std::vector<ImageLandmark> landmarks;
    if (HoldsPixels(document))
    {
      for (const auto & [name, numbers] : NamedNumbers(document, 2))
      {
        landmarks.push_back({ name, numbers });
      }
      RequireNames(landmarks);
      return landmarks;
    }
    for (const Landmark & landmark : LandmarksOf(document))
    {
      landmarks.push_back(OnDetector(landmark, view));
    }
    return landmarks;
  });
}

void
WriteLandmarks(const std::vector<Landmark> & landmarks, const std::string & path)
{
  json points = json::array();
  for (const Landmark & landmark : landmarks)
  {
    points.push_back({ { "id", std::to_string(points.size() + 1) },
                       { "label", landmark.name },
                       { "position", ToJson(landmark.point) },
                       { "positionStatus", "defined" } });
  }
  json markups = json::array();
  markups.push_back({ { "type", "Fiducial" },
                      { "coordinateSystem", "LPS" },
                      { "coordinateUnits", "mm" },
                      { "controlPoints", std::move(points) } });
  WriteFileAtomically(path, MarkupsText(std::move(markups)));
}
} // namespace bone
