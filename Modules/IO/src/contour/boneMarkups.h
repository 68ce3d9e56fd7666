/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneMarkups_h
#define boneMarkups_h

#include "bonePolylines.h"

#include <nlohmann/json.hpp>

#include <string>

namespace bone
{
/** A control point that is placed, in LPS. */
struct ControlPoint
{
  std::string label;
  std::string description;
  Vector3     position;
};

/** The list of markups of a document, and the control points of a markup. Throw itk::ExceptionObject. */
const nlohmann::json &
MarkupsOf(const nlohmann::json & document);
std::vector<ControlPoint>
ReadControlPoints(const nlohmann::json & markup);

/** A document of these markups. */
std::string
MarkupsText(nlohmann::json markups);

/** The closed curves of a 3D Slicer markups file, in LPS. Throws IOError. */
std::vector<Polyline>
ReadMarkups(const std::string & path);

/** The stack's closed contours as a 3D Slicer markups document, in LPS. */
std::string
ToMarkups(const ContourStack & stack);
} // namespace bone

#endif
