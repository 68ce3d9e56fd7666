/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneHemipelvisMeasures.h"

#include "boneSeeds.h"

#include <algorithm>
#include <cmath>

namespace bone
{
namespace
{
constexpr double CupReach = 40.0; // mm, no acetabulum is larger
constexpr double CupShell = 0.15; // of the radius: points so near to the sphere are looked at
constexpr double CupFacing = 0.8; // cosine to the direction of the centre, of surface that faces it
constexpr int    LeastCupPoints = 36;
constexpr double WidestCupDeviation = 0.1; // of the radius
constexpr double RimInside = 3.0;          // mm within the sphere, and
constexpr double RimOutside = 2.0;         // beyond it: where the rim is looked for
constexpr int    RimPoints = 72;
constexpr int    MostCupRounds = 50;

/** The points for integrals over a surface that faces a place: their indices. */
std::vector<std::size_t>
FacingPoints(const SurfaceSeeds & bone, const Vector3 & place, double reach)
{
  std::vector<std::size_t> facing;
  for (std::size_t t = 0; t < bone.surface.triangles.size(); ++t)
  {
    const auto &  ids = bone.surface.triangles[t];
    const auto &  p = bone.surface.points;
    const Vector3 normal = (p[ids[1]] - p[ids[0]]).cross(p[ids[2]] - p[ids[0]]).normalized();
    for (std::size_t i = 3 * t; i < 3 * t + 3; ++i)
    {
      const Vector3 to = place - bone.middles[i];
      const double  distance = to.norm();
      if (distance < reach && normal.dot(to) > CupFacing * distance)
      {
        facing.push_back(i);
      }
    }
  }
  if (facing.size() < static_cast<std::size_t>(LeastCupPoints))
  {
    throw MissingSeed("the surface has too few points that face the landmark acetabulum");
  }
  return facing;
}

/** `inward`: mean direction from the sphere's centre to the surface that was fitted. */
FittedSphere
FitAcetabulum(const SurfaceSeeds & bone, Vector3 & inward)
{
  const Vector3 seed = bone.Find("acetabulum", CupReach);
  FittedSphere  cup{ seed, 0.0, 0.0 };
  {
    std::vector<double> distances;
    for (const std::size_t i : FacingPoints(bone, seed, CupReach))
    {
      distances.push_back((bone.middles[i] - seed).norm());
    }
    std::nth_element(
      distances.begin(), distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2), distances.end());
    cup.radius = distances[distances.size() / 2];
  }
  for (int round = 0; round < MostCupRounds; ++round)
  {
    std::vector<Vector3> points;
    std::vector<double>  weights;
    // Wide at first, as the seed is not the centre.
    const double shell = std::max(CupShell, 0.4 - 0.05 * round) * cup.radius;
    inward.setZero();
    for (const std::size_t i : FacingPoints(bone, cup.centre, CupReach))
    {
      const Vector3 to = bone.middles[i] - cup.centre;
      if (std::abs(to.norm() - cup.radius) < shell)
      {
        points.push_back(bone.middles[i]);
        weights.push_back(bone.areas[i]);
        inward += bone.areas[i] * to;
      }
    }
    const Vector3 before = cup.centre;
    cup = FitSphere(points, weights);
    if (round > 5 && (cup.centre - before).norm() < 1e-6)
    {
      break;
    }
  }
  inward.normalize();
  if (!(cup.deviation < WidestCupDeviation * cup.radius && cup.radius < CupReach &&
        (cup.centre - seed).norm() < cup.radius))
  {
    throw MissingSeed("no sphere fits the surface around the landmark acetabulum: place it nearer to the centre");
  }
  return cup;
}

/** One point for each of 72 directions around the axis, the furthest out along it near the sphere. */
std::vector<Vector3>
FindRim(const SurfaceSeeds & bone, const FittedSphere & cup, const Vector3 & axis)
{
  const Vector3        u = axis.unitOrthogonal(), v = axis.cross(u);
  std::vector<Vector3> rim(RimPoints);
  std::vector<double>  height(RimPoints, -0.5 * cup.radius); // the rim is not deeper
  const auto           look = [&](const Vector3 & p) {
    const Vector3 to = p - cup.centre;
    const double  beyond = to.norm() - cup.radius;
    if (beyond > -RimInside && beyond < RimOutside)
    {
      const double turn = (std::atan2(to.dot(v), to.dot(u)) / (2.0 * M_PI) + 1.0) * RimPoints;
      const auto   bin = static_cast<std::size_t>(turn) % RimPoints;
      if (to.dot(axis) > height[bin])
      {
        height[bin] = to.dot(axis);
        rim[bin] = p;
      }
    }
  };
  std::for_each(bone.middles.begin(), bone.middles.end(), look);
  std::for_each(bone.surface.points.begin(), bone.surface.points.end(), look);
  std::vector<Vector3> found;
  for (int bin = 0; bin < RimPoints; ++bin)
  {
    if (height[bin] > -0.5 * cup.radius)
    {
      found.push_back(rim[bin]);
    }
  }
  return found;
}

FittedPlane
FitRim(const SurfaceSeeds & bone, const FittedSphere & cup, const Vector3 & outward)
{
  Vector3     axis = outward;
  FittedPlane plane;
  for (int round = 0; round < MostCupRounds; ++round)
  {
    const auto points = FindRim(bone, cup, axis);
    if (points.size() < RimPoints / 2)
    {
      throw MissingSeed("less than half of the acetabulum's rim is there");
    }
    plane = FitPlane(points, std::vector<double>(points.size(), 1.0));
    if (plane.normal.dot(outward) < 0.0)
    {
      plane.normal = -plane.normal;
    }
    const double turn = (plane.normal - axis).norm();
    axis = plane.normal;
    if (turn < 1e-6)
    {
      break;
    }
  }
  return plane;
}

PelvicFrame
FitFrame(const SurfaceSeeds & bone, const std::vector<Landmark> & landmarks)
{
  const auto find = [&landmarks](const char * name) {
    return std::find_if(landmarks.begin(), landmarks.end(), [name](const Landmark & l) { return l.name == name; });
  };
  const auto  right = find("asis_right"), left = find("asis_left");
  PelvicFrame frame;
  if (right != landmarks.end() && left != landmarks.end())
  {
    frame.left = (left->point - right->point).normalized();
    frame.byLandmarks = true;
  }
  const Vector3 upward = bone.Find("asis") - bone.Find("pubic_tubercle");
  frame.up = (upward - upward.dot(frame.left) * frame.left).normalized();
  frame.anterior = frame.left.cross(frame.up);
  if (!(std::abs(frame.up.norm() - 1.0) < 1e-9 && std::abs(frame.left.norm() - 1.0) < 1e-9))
  {
    throw MissingSeed("asis, pubic_tubercle, asis_left and asis_right must not be one place, nor lie on one line");
  }
  return frame;
}
} // namespace

const std::vector<std::string> &
HemipelvisLandmarkNames()
{
  static const std::vector<std::string> names = { "acetabulum", "asis", "pubic_tubercle", "asis_left", "asis_right" };
  return names;
}

HemipelvisGeometry
FitHemipelvis(const TriangleSurface & surface, const std::vector<Landmark> & landmarks, double farthest)
{
  const SurfaceSeeds bone(surface, landmarks, farthest);
  HemipelvisGeometry hemipelvis;
  try
  {
    Vector3 inward;
    hemipelvis.acetabulum = FitAcetabulum(bone, inward);
    try
    {
      hemipelvis.rim = FitRim(bone, *hemipelvis.acetabulum, -inward);
    }
    catch (const std::exception & error)
    {
      hemipelvis.rimReason = error.what();
    }
  }
  catch (const std::exception & error)
  {
    hemipelvis.acetabulumReason = hemipelvis.rimReason = error.what();
  }
  try
  {
    hemipelvis.frame = FitFrame(bone, landmarks);
  }
  catch (const std::exception & error)
  {
    hemipelvis.frameReason = error.what();
  }
  return hemipelvis;
}

MeasureList
MeasureHemipelvis(const HemipelvisGeometry & hemipelvis)
{
  MeasureList list;
  if (hemipelvis.acetabulum)
  {
    const Vector3 & c = hemipelvis.acetabulum->centre;
    list.measures.push_back(
      { "acetabularCentre",
        { c.x(), c.y(), c.z() },
        "mm",
        "Centre of the sphere fitted robustly to the acetabulum's surface, in the model's space (LPS)" });
    list.measures.push_back({ "acetabularRadius", { hemipelvis.acetabulum->radius }, "mm", "Radius of that sphere" });
  }
  else
  {
    list.missing.push_back({ "acetabularCentre", hemipelvis.acetabulumReason });
    list.missing.push_back({ "acetabularRadius", hemipelvis.acetabulumReason });
  }
  if (!(hemipelvis.rim && hemipelvis.frame))
  {
    for (const char * name :
         { "radiographicInclination", "radiographicAnteversion", "anatomicInclination", "anatomicAnteversion", "side" })
    {
      list.missing.push_back({ name, hemipelvis.rim ? hemipelvis.frameReason : hemipelvis.rimReason });
    }
    return list;
  }
  const PelvicFrame & frame = *hemipelvis.frame;
  const Vector3 &     axis = hemipelvis.rim->normal;
  const double lateral = std::abs(axis.dot(frame.left)), down = -axis.dot(frame.up), forward = axis.dot(frame.anterior);
  const double degree = 180.0 / M_PI;
  const std::string space =
    std::string("; the acetabulum's axis is the normal of the plane fitted robustly to its rim; the coronal plane is "
                "the anterior "
                "pelvic plane (Lewinnek et al., J Bone Joint Surg Am 60:217-220, 1978) of asis, pubic_tubercle and the "
                "transverse axis, which is ") +
    (frame.byLandmarks ? "that of asis_right to asis_left"
                       : "the x axis of the model's space (LPS), as of a patient who lies straight") +
    " (Murray, doi:10.1302/0301-620X.75B2.8444942)";
  list.measures.push_back(
    { "radiographicInclination",
      { std::atan2(lateral, down) * degree },
      "degree",
      "Angle between the longitudinal axis and the acetabulum's axis projected on the coronal plane" + space });
  list.measures.push_back({ "radiographicAnteversion",
                            { std::asin(std::clamp(forward, -1.0, 1.0)) * degree },
                            "degree",
                            "Angle between the acetabulum's axis and the coronal plane" + space });
  list.measures.push_back({ "anatomicInclination",
                            { std::acos(std::clamp(down, -1.0, 1.0)) * degree },
                            "degree",
                            "Angle between the acetabulum's axis and the longitudinal axis" + space });
  list.measures.push_back(
    { "anatomicAnteversion",
      { std::atan2(forward, lateral) * degree },
      "degree",
      "Angle between the transverse axis and the acetabulum's axis projected on the transverse plane" + space });
  list.measures.push_back(
    { "side", {}, "", "Of the body, by where the acetabulum opens", axis.dot(frame.left) < 0.0 ? "right" : "left" });
  return list;
}
} // namespace bone
