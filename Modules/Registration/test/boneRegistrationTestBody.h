/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneRegistrationTestBody_h
#define boneRegistrationTestBody_h

#include "boneMeshRadiograph.h"
#include "boneRadiographTestMeshes.h"
#include "boneRadiographView.h"
#include "boneRigidPose.h"

#include <algorithm>
#include <array>
#include <random>
#include <vector>

namespace bone
{
namespace test
{
/** A body of no symmetry about (10, 20, 30), some 70 mm long, denser to one side, with `cells` cubes along each axis.
 */
inline MeshArrays
Body(int cells)
{
  const Vector3                centre(10, 20, 30);
  const std::array<Vector3, 3> horns{
    { Vector3(1, 0.2, 0.5).normalized(), Vector3(-0.3, 0.5, -1).normalized(), Vector3(-0.8, -1, 0.4).normalized() }
  };
  const std::array<double, 3> heights{ { 18, 26, 14 } };
  MeshArrays                  mesh = BallMesh(cells, Vector3::Zero(), 1.0);
  for (Vector3 & p : mesh.points)
  {
    double radius = 14.0;
    for (std::size_t h = 0; h < horns.size(); ++h)
    {
      radius += heights[h] * std::exp(-(p.normalized() - horns[h]).squaredNorm() / 0.25);
    }
    p = centre + (p.norm() > 0.0 ? radius : 0.0) * p;
  }
  mesh.maximumDegree = 1;
  mesh.degree.assign(mesh.tetrahedra.size(), 1);
  for (const Id4 & tetrahedron : mesh.tetrahedra)
  {
    for (const IdType p : tetrahedron)
    {
      mesh.coefficients.push_back(600.0 + 8.0 * mesh.points[static_cast<std::size_t>(p)].x());
    }
  }
  return mesh;
}

/** With a tail of some 400 mm below the middle, nearly all of it beyond the views. */
inline MeshArrays
WithTail(MeshArrays body)
{
  for (Vector3 & p : body.points)
  {
    const double below = std::max(0.0, 30.0 - p.z());
    p.z() -= 0.4 * below * below;
  }
  return body;
}

/** A view from 700 mm along `beam` onto 1.6 mm pixels at 1000 mm. */
inline XRayGeometry::View
ViewOf(const Vector3 & beam, int pixels = 96)
{
  XRayGeometry::View view;
  const Vector3      centre(10, 20, 30);
  view.source = centre - 700.0 * beam;
  view.detectorU = Vector3::UnitZ().cross(beam).normalized();
  view.detectorV = beam.cross(view.detectorU);
  view.size = { { pixels, pixels } };
  view.spacing = Vector2::Constant(1.6 * 96 / pixels);
  view.detectorOrigin =
    centre + 300.0 * beam - 0.5 * (pixels - 1) * view.spacing[0] * (view.detectorU + view.detectorV);
  return view;
}

/** An X-ray of the body in a pose. */
inline RadiographView
XRayOf(const MeshArrays & mesh, const XRayGeometry::View & view, const RigidPose & pose)
{
  RadiographView xray;
  xray.view = view;
  xray.values.resize(xray.GetNumberOfPixels());
  ProjectMesh(mesh.points, mesh, pose.ToModelSpace(view), {}, Execution(), xray.values.data());
  return xray;
}

/** Front and side. */
inline std::vector<RadiographView>
TwoXRays(const MeshArrays & mesh, const RigidPose & pose, int pixels = 96)
{
  return { XRayOf(mesh, ViewOf({ 0, 1, 0 }, pixels), pose), XRayOf(mesh, ViewOf({ 1, 0, 0 }, pixels), pose) };
}

/** Adds normal noise, its deviation as a share of the first X-ray's largest value. */
inline void
AddNoise(std::vector<RadiographView> & xrays, float share)
{
  std::mt19937                    random(3);
  std::normal_distribution<float> normal(0.0f,
                                         share * *std::max_element(xrays[0].values.begin(), xrays[0].values.end()));
  for (RadiographView & xray : xrays)
  {
    for (float & x : xray.values)
    {
      x += normal(random);
    }
  }
}

/** A pose about the body's middle: mm, radians. */
inline RigidPose
PoseOf(double x, double y, double z, double a, double b, double c)
{
  RigidPose pose;
  pose.centre = Vector3(10, 20, 30);
  Eigen::Matrix<double, 6, 1> step;
  step << x, y, z, a, b, c;
  return pose.Moved(step);
}

/** How far two poses move the body's points apart at most, mm. */
inline double
LargestDistance(const MeshArrays & mesh, const RigidPose & a, const RigidPose & b)
{
  double largest = 0.0;
  for (const Vector3 & x : mesh.points)
  {
    largest = std::max(largest, (a.Apply(x) - b.Apply(x)).norm());
  }
  return largest;
}
} // namespace test
} // namespace bone

#endif
