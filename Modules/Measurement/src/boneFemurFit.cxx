/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneFemurMeasures.h"

#include "boneSeeds.h"
#include "boneSurfaceSection.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace bone
{
namespace
{
constexpr double HeadReach = 45.0; // mm, no head is larger
constexpr double HeadShell = 0.3;  // of the radius: points so near to the sphere are looked at
constexpr int    LeastHeadPoints = 36;
constexpr double LargestDeviation = 0.1; // of the radius: beyond, it is no sphere
constexpr int    ShaftSections = 21;
constexpr double NeckStep = 0.5;      // mm between sections
constexpr double NeckNearest = 0.5;   // of the head's radius from its centre: from there the neck is looked for,
constexpr double NeckFarthest = 2.6;  // to there
constexpr double NeckWaist = 1.1;     // of the least area: sections that are the waist
constexpr double NeckEnd = 1.5;       // of the least area: beyond there is no neck
constexpr double CondyleReach = 30.0; // mm
constexpr int    MostRounds = 50;
constexpr double StillMove = 1e-7; // mm, or radians

/** Median distance to the seed of the surface that looks away from the neck: a first radius. */
double
FirstHeadRadius(const SurfaceSeeds & bone, const Vector3 & centre, const Vector3 & away)
{
  std::vector<std::pair<double, double>> distances; // with area
  double                                 area = 0.0;
  for (std::size_t i = 0; i < bone.middles.size(); ++i)
  {
    const Vector3 x = bone.middles[i] - centre;
    const double  distance = x.norm();
    if (distance < HeadReach && x.dot(away) > 0.3 * distance)
    {
      distances.emplace_back(distance, bone.areas[i]);
      area += bone.areas[i];
    }
  }
  std::sort(distances.begin(), distances.end());
  double sum = 0.0;
  for (const auto & [distance, weight] : distances)
  {
    sum += weight;
    if (sum >= 0.5 * area)
    {
      return distance;
    }
  }
  throw MissingSeed("there is no bone around femoral_head on the side away from femoral_neck");
}

/** The sphere of the half of the head on the side `away` of its centre. */
FittedSphere
FitHead(const SurfaceSeeds & bone, const Vector3 & seed, const Vector3 & away)
{
  FittedSphere head{ seed, FirstHeadRadius(bone, seed, away), 0.0 };
  for (int round = 0; round < MostRounds; ++round)
  {
    std::vector<Vector3> points;
    std::vector<double>  weights;
    for (std::size_t i = 0; i < bone.middles.size(); ++i)
    {
      const Vector3 x = bone.middles[i] - head.centre;
      if (x.dot(away) > 0.0 && std::abs(x.norm() - head.radius) < HeadShell * head.radius)
      {
        points.push_back(bone.middles[i]);
        weights.push_back(bone.areas[i]);
      }
    }
    if (points.size() < static_cast<std::size_t>(LeastHeadPoints))
    {
      throw MissingSeed("the surface has too few points around femoral_head");
    }
    const Vector3 before = head.centre;
    head = FitSphere(points, weights);
    if ((head.centre - before).norm() < StillMove)
    {
      break;
    }
  }
  if (!(head.deviation < LargestDeviation * head.radius && head.radius < HeadReach &&
        (head.centre - seed).norm() < head.radius))
  {
    throw MissingSeed("no sphere fits the surface around femoral_head: place it nearer to the head's centre");
  }
  return head;
}

/** The line of the sections' centroids between two seeds, toward the first. */
FittedLine
FitShaft(const SurfaceSeeds & bone)
{
  const Vector3 &top = bone.Find("shaft_proximal"), bottom = bone.Find("shaft_distal");
  FittedLine     shaft{ 0.5 * (top + bottom), (top - bottom).normalized(), 0.0 };
  const double   length = (top - bottom).norm();
  if (!(length > 10.0))
  {
    throw MissingSeed("shaft_proximal and shaft_distal must lie more than 10 mm apart");
  }
  for (int round = 0; round < MostRounds; ++round)
  {
    const double lower = shaft.direction.dot(bottom - shaft.point), upper = shaft.direction.dot(top - shaft.point);
    std::vector<Vector3> centroids;
    for (int i = 0; i < ShaftSections; ++i)
    {
      const double along = lower + (upper - lower) * i / (ShaftSections - 1);
      centroids.push_back(FindSection(bone.surface, shaft.point + along * shaft.direction, shaft.direction).centroid);
    }
    FittedLine next = FitLine(centroids, std::vector<double>(centroids.size(), 1.0));
    if (next.direction.dot(top - bottom) < 0.0)
    {
      next.direction = -next.direction;
    }
    const double move = (next.direction - shaft.direction).norm() * length + shaft.Distance(next.point);
    shaft = next;
    if (move < 1e-4)
    {
      break;
    }
  }
  return shaft;
}

/** The narrowest sections of the neck from the head's centre along `axis`, which points to the head. */
FemurNeck
FindWaist(const SurfaceSeeds & bone, const FittedSphere & head, const Vector3 & axis)
{
  std::vector<SectionLoop> sections;
  std::vector<double>      places;
  std::size_t              narrowest = 0;
  for (double along = NeckNearest * head.radius; along < NeckFarthest * head.radius; along += NeckStep)
  {
    sections.push_back(FindSection(bone.surface, head.centre - along * axis, axis));
    places.push_back(along);
    if (sections.back().area < sections[narrowest].area)
    {
      narrowest = sections.size() - 1;
    }
    if (sections.back().area > NeckEnd * sections[narrowest].area)
    {
      break;
    }
  }
  if (narrowest == 0 || narrowest + 1 == sections.size())
  {
    throw MissingSeed("no narrowest cross-section lies between head and shaft: is the neck whole?");
  }
  FemurNeck neck;
  neck.axis = axis;
  neck.narrowest = places[narrowest];
  neck.area = sections[narrowest].area;
  // The waist: on both sides of the narrowest section.
  const auto wide = [&](const SectionLoop & section) { return section.area > NeckWaist * neck.area; };
  const auto here = sections.begin() + static_cast<std::ptrdiff_t>(narrowest);
  const auto end = std::find_if(here, sections.end(), wide);
  const auto begin = std::find_if(std::make_reverse_iterator(here), sections.rend(), wide).base();
  for (auto section = begin; section != end; ++section)
  {
    neck.centre += section->centroid / static_cast<double>(end - begin);
  }
  return neck;
}

FemurNeck
FitNeck(const SurfaceSeeds & bone, const FittedSphere & head)
{
  Vector3   axis = (head.centre - bone.Find("femoral_neck")).normalized();
  FemurNeck neck;
  for (int round = 0; round < MostRounds; ++round)
  {
    neck = FindWaist(bone, head, axis);
    const Vector3 next = (head.centre - neck.centre).normalized();
    const double  turn = (next - axis).norm();
    axis = next;
    if (turn < 1e-5)
    {
      break;
    }
  }
  neck.axis = axis;
  return neck;
}

/** Head and neck, each with the other's axis. */
void
FitHeadAndNeck(const SurfaceSeeds & bone, FemurGeometry & femur)
{
  try
  {
    const Vector3 seed = bone.Find("femoral_head");
    Vector3       away = (seed - bone.Find("femoral_neck")).normalized();
    for (int round = 0; round < 3; ++round)
    {
      femur.head = FitHead(bone, seed, away);
      try
      {
        femur.neck = FitNeck(bone, *femur.head);
        away = femur.neck->axis;
      }
      catch (const std::exception & error)
      {
        femur.neck.reset();
        femur.neckReason = error.what();
        return;
      }
    }
  }
  catch (const std::exception & error)
  {
    femur.head.reset();
    femur.neck.reset();
    femur.headReason = femur.neckReason = error.what();
  }
}

/** Extents of the narrowest section in the plane of neck and shaft, and across. */
void
MeasureWaist(const SurfaceSeeds & bone, FemurGeometry & femur)
{
  if (femur.neck && femur.shaft)
  {
    FemurNeck &       neck = *femur.neck;
    const Vector3     across = neck.axis.cross(femur.shaft->direction).normalized();
    const SectionLoop waist = FindSection(bone.surface, femur.head->centre - neck.narrowest * neck.axis, neck.axis);
    neck.height = waist.Width(neck.axis.cross(across));
    neck.depth = waist.Width(across);
  }
}

/** The point of the surface near a seed, and nearer to it than to the other one, that lies farthest along a direction.
 */
Vector3
FarthestNear(const SurfaceSeeds & bone, const Vector3 & seed, const Vector3 & other, const Vector3 & direction)
{
  const Vector3 * farthest = nullptr;
  for (const Vector3 & p : bone.surface.points)
  {
    const double squared = (p - seed).squaredNorm();
    if (squared < CondyleReach * CondyleReach && squared < (p - other).squaredNorm() &&
        (!farthest || direction.dot(p - *farthest) > 0.0))
    {
      farthest = &p;
    }
  }
  if (!farthest)
  {
    throw MissingSeed("there is no bone around a condyle's landmark");
  }
  return *farthest;
}

/** Centroid of all of the bone's cross-section. */
Vector3
WholeCentroid(const SurfaceSeeds & bone, const Vector3 & point, const Vector3 & normal)
{
  double  area = 0.0;
  Vector3 moment = Vector3::Zero();
  for (const SectionLoop & loop : CutSurface(bone.surface, point, normal))
  {
    area += loop.area;
    moment += loop.area * loop.centroid;
  }
  if (!(area > 0.0))
  {
    throw MissingSeed("the bone has no cross-section at the condyles' landmarks");
  }
  return moment / area;
}

FemurCondyles
FitCondyles(const SurfaceSeeds & bone, const FemurGeometry & femur)
{
  const Vector3 medial = bone.Find("medial_condyle"), lateral = bone.Find("lateral_condyle");
  if (!femur.shaft)
  {
    throw MissingSeed("the shaft has no axis: " + femur.shaftReason);
  }
  const FittedLine & shaft = *femur.shaft;
  const Vector3 top = shaft.point + shaft.direction.dot(bone.Find("shaft_proximal") - shaft.point) * shaft.direction;
  FemurCondyles condyles;
  condyles.medial = medial;
  condyles.lateral = lateral;
  condyles.longAxis = shaft.direction;
  for (int round = 0; round < MostRounds; ++round)
  {
    const Vector3 hind = 0.5 * (condyles.medial + condyles.lateral);
    condyles.centre = WholeCentroid(bone, hind, condyles.longAxis);
    condyles.longAxis = (top - condyles.centre).normalized();
    condyles.anterior = condyles.longAxis.cross(condyles.medial - condyles.lateral).normalized();
    condyles.right = condyles.anterior.dot(condyles.centre - hind) < 0.0;
    if (condyles.right)
    {
      condyles.anterior = -condyles.anterior;
    }
    const FemurCondyles before = condyles;
    condyles.medial = FarthestNear(bone, medial, lateral, -condyles.anterior);
    condyles.lateral = FarthestNear(bone, lateral, medial, -condyles.anterior);
    if (round > 2 && before.medial == condyles.medial && before.lateral == condyles.lateral)
    {
      break;
    }
  }
  return condyles;
}
} // namespace

const std::vector<std::string> &
FemurLandmarkNames()
{
  static const std::vector<std::string> names = { "femoral_head", "femoral_neck",   "shaft_proximal",
                                                  "shaft_distal", "medial_condyle", "lateral_condyle" };
  return names;
}

FemurGeometry
FitFemur(const TriangleSurface & surface, const std::vector<Landmark> & landmarks, double farthest)
{
  const SurfaceSeeds bone(surface, landmarks, farthest);
  FemurGeometry      femur;
  FitHeadAndNeck(bone, femur);
  try
  {
    femur.shaft = FitShaft(bone);
  }
  catch (const std::exception & error)
  {
    femur.shaftReason = error.what();
  }
  MeasureWaist(bone, femur);
  try
  {
    femur.condyles = FitCondyles(bone, femur);
  }
  catch (const std::exception & error)
  {
    femur.condylesReason = error.what();
  }
  if (femur.condyles && femur.head)
  {
    const Vector3 foot =
      femur.shaft->point + femur.shaft->direction.dot(femur.head->centre - femur.shaft->point) * femur.shaft->direction;
    if ((femur.condyles->medial - femur.condyles->lateral).dot(femur.head->centre - foot) < 0.0)
    {
      throw std::invalid_argument("medial_condyle lies on the side away from the femoral head: medial_condyle and "
                                  "lateral_condyle are interchanged.");
    }
  }
  return femur;
}
} // namespace bone
