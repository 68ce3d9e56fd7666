/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneFemurMeasures.h"

#include "boneSurfaceSection.h"
#include "boneTriangleTree.h"

#include <cmath>
#include <stdexcept>

namespace bone
{
namespace
{
constexpr double TowardHead = 5.0;   // mm from the narrowest section, of the first section of the cortex
constexpr double TowardShaft = 10.0; // mm, of the last
constexpr int    CortexSections = 7;
constexpr int    OutlinePoints = 90;

double
DegreesBetween(const Vector3 & a, const Vector3 & b)
{
  return std::atan2(a.cross(b).norm(), a.dot(b)) * 180.0 / M_PI;
}

/** The angle of the neck forward of the line of the condyles, seen along the long axis; degrees. */
double
Anteversion(const FemurCondyles & condyles, const Vector3 & neck)
{
  const Vector3 medial = condyles.medial - condyles.lateral;
  const Vector3 across = (medial - medial.dot(condyles.longAxis) * condyles.longAxis).normalized();
  return std::atan2(neck.dot(condyles.anterior), neck.dot(across)) * 180.0 / M_PI;
}

std::vector<double>
Coordinates(const Vector3 & x)
{
  return { x.x(), x.y(), x.z() };
}

/** Points evenly along a closed curve. */
std::vector<Vector3>
EvenPoints(const std::vector<Vector3> & loop, int count)
{
  double length = 0.0;
  for (std::size_t i = 0; i < loop.size(); ++i)
  {
    length += (loop[(i + 1) % loop.size()] - loop[i]).norm();
  }
  std::vector<Vector3> points;
  double               passed = 0.0;
  for (std::size_t i = 0; i < loop.size(); ++i)
  {
    const Vector3 step = loop[(i + 1) % loop.size()] - loop[i];
    const double  end = passed + step.norm();
    for (double at = length * static_cast<double>(points.size()) / count;
         at < end && points.size() < std::size_t(count);
         at = length * static_cast<double>(points.size()) / count)
    {
      points.push_back(loop[i] + (at - passed) / (end - passed) * step);
    }
    passed = end;
  }
  return points;
}
} // namespace

MeasureList
MeasureFemur(const FemurGeometry & femur)
{
  MeasureList list;
  const auto  need = [&list](bool there, const std::string & reason, std::initializer_list<const char *> names) {
    for (const char * name : names)
    {
      if (!there)
      {
        list.missing.push_back({ name, reason });
      }
    }
    return there;
  };
  auto & measures = list.measures;
  if (need(femur.head.has_value(), femur.headReason, { "headCentre", "headRadius", "headDeviation" }))
  {
    measures.push_back(
      { "headCentre",
        Coordinates(femur.head->centre),
        "mm",
        "Centre of the sphere fitted robustly to the half of the femoral head that looks away from the neck, "
        "in the model's space (LPS)" });
    measures.push_back({ "headRadius", { femur.head->radius }, "mm", "Radius of that sphere" });
    measures.push_back({ "headDeviation",
                         { femur.head->deviation },
                         "mm",
                         "Root mean square distance of the head's surface to that sphere" });
  }
  const std::string both = femur.neck ? femur.shaftReason : femur.neckReason;
  if (need(femur.neck && femur.shaft, both, { "neckShaftAngle", "neckHeight", "neckDepth" }))
  {
    measures.push_back(
      { "neckShaftAngle",
        { DegreesBetween(femur.neck->axis, -femur.shaft->direction) },
        "degree",
        "Angle in space between the neck's axis, from the centroids of its narrowest cross-sections to the "
        "centre of the head, and the shaft's axis, the line of its cross-sections' centroids between "
        "shaft_proximal and shaft_distal, downward (after Boese et al., doi:10.1007/s00256-015-2236-z)" });
    measures.push_back({ "neckHeight",
                         { femur.neck->height },
                         "mm",
                         "Extent of the neck's narrowest cross-section in the plane of the axes of neck and shaft" });
    measures.push_back(
      { "neckDepth", { femur.neck->depth }, "mm", "Extent of the neck's narrowest cross-section across that plane" });
  }
  if (need(femur.neck.has_value(), femur.neckReason, { "neckSectionArea" }))
  {
    measures.push_back({ "neckSectionArea",
                         { femur.neck->area },
                         "mm^2",
                         "Area of the narrowest cross-section at right angles to the neck's axis" });
  }
  if (need(femur.head && femur.shaft, femur.head ? femur.shaftReason : femur.headReason, { "femoralOffset" }))
  {
    measures.push_back({ "femoralOffset",
                         { femur.shaft->Distance(femur.head->centre) },
                         "mm",
                         "Distance of the head's centre to the shaft's axis (Noble et al., Clin Orthop Relat Res "
                         "235:148-165, 1988)" });
  }
  if (need(femur.condyles.has_value(), femur.condylesReason, { "side" }))
  {
    measures.push_back({ "side",
                         {},
                         "",
                         "Of the body, by where the medial condyle and the back of the condyles lie",
                         femur.condyles->right ? "right" : "left" });
  }
  if (need(femur.neck && femur.condyles, femur.neck ? femur.condylesReason : femur.neckReason, { "anteversion" }))
  {
    measures.push_back(
      { "anteversion",
        { Anteversion(*femur.condyles, femur.neck->axis) },
        "degree",
        "Angle of the neck's axis forward of the line of the hindmost points of the condyles, both projected "
        "along the long axis, from the knee's centre (centroid of the cross-section at these points) to the shaft's "
        "axis at shaft_proximal (after "
        "Murphy et al., doi:10.2106/00004623-198769080-00011)" });
  }
  return list;
}

MeasureList
MeasureNeckCortex(const MeshArrays & mesh, const FemurGeometry & femur)
{
  const char * const names[] = { "neckCorticalThickness",
                                 "neckCorticalThicknessProfile",
                                 "neckCorticalThicknessPlaces" };
  MeasureList        list;
  const auto         lack = [&](const std::string & reason) {
    for (const char * name : names)
    {
      list.missing.push_back({ name, reason });
    }
    return list;
  };
  if (!femur.neck)
  {
    return lack(femur.neckReason);
  }
  std::vector<TriangleTree::Triangle> endosteum;
  const bool                          layered = !mesh.region.empty();
  for (const auto & face : layered ? BoundaryFaces(mesh, Trabecular) : std::vector<std::array<IdType, 3>>())
  {
    endosteum.push_back({ mesh.points[face[0]], mesh.points[face[1]], mesh.points[face[2]] });
  }
  if (endosteum.empty())
  {
    return lack("the model has no region within the cortical one");
  }
  const TriangleTree    tree(std::move(endosteum));
  std::vector<IdType>   ids;
  const TriangleSurface surface = ExteriorSurface(mesh, ids);
  std::vector<double>   places, profile;
  const auto            thickness = [&](double along) {
    const Vector3     at = femur.head->centre - along * femur.neck->axis;
    const SectionLoop section = FindSection(surface, at, femur.neck->axis);
    double            sum = 0.0;
    for (const Vector3 & x : EvenPoints(section.points, OutlinePoints))
    {
      sum += std::sqrt(tree.FindNearest(x).squaredDistance) / OutlinePoints;
    }
    return sum;
  };
  try
  {
    for (int i = 0; i < CortexSections; ++i)
    {
      places.push_back(femur.neck->narrowest - TowardHead + (TowardHead + TowardShaft) * i / (CortexSections - 1));
      profile.push_back(thickness(places.back()));
    }
    list.measures.push_back(
      { names[0],
        { thickness(femur.neck->narrowest) },
        "mm",
        "Mean distance of the outline of the neck's narrowest cross-section to the endosteal surface, the "
        "boundary of all regions but the cortical one" });
  }
  catch (const std::exception & error)
  {
    return lack(error.what());
  }
  list.measures.push_back({ names[1], profile, "mm", "The same on cross-sections along the neck" });
  list.measures.push_back(
    { names[2], places, "mm", "Where these cross-sections lie, from the centre of the head along the neck's axis" });
  return list;
}
} // namespace bone
