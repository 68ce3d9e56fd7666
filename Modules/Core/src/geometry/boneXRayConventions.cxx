/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneXRayConventions.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace bone
{
namespace
{
constexpr double pi = 3.14159265358979323846;
constexpr double perRadian = 180.0 / pi;
constexpr double tolerance = 1e-6;

/** Refuses what XRayGeometry refuses. */
XRayGeometry::View
Checked(const XRayGeometry::View & view)
{
  XRayGeometry::New()->SetView(view);
  return view;
}

void
RequirePositive(const char * name, double value)
{
  if (!(value > 0) || !std::isfinite(value))
  {
    itkGenericExceptionMacro(<< name << " is " << value << "; it must be positive.");
  }
}

/** U x V, turned to point from the source to the detector. */
Vector3
Forward(const XRayGeometry::View & view)
{
  const Vector3 normal = view.detectorU.cross(view.detectorV);
  const Vector3 ray = view.parallel ? view.direction : Vector3(view.detectorOrigin - view.source);
  return ray.dot(normal) < 0 ? Vector3(-normal) : normal;
}

/** Turns physical space into RTK's rotated frame. */
Eigen::Matrix3d
RtkRotation(const RtkProjection & p)
{
  const auto turn = [](double degrees, const Vector3 & axis) { return Eigen::AngleAxisd(-degrees / perRadian, axis); };
  return (turn(p.inPlaneAngle, Vector3::UnitZ()) * turn(p.outOfPlaneAngle, Vector3::UnitX()) *
          turn(p.gantryAngle, Vector3::UnitY()))
    .toRotationMatrix();
}
} // namespace

ProjectionMatrix
ToProjectionMatrix(const XRayGeometry::View & view)
{
  const Vector3 normal = Forward(view);
  // Along a ray the detector's coordinates do not change: those of x shifted along the beam into the detector's plane.
  const auto affine = [&](const Vector3 & gradient, const Vector3 & zero) {
    return Eigen::RowVector4d(gradient.x(), gradient.y(), gradient.z(), -gradient.dot(zero));
  };
  ProjectionMatrix matrix;
  const Vector3    axes[2] = { view.detectorU / view.spacing.x(), view.detectorV / view.spacing.y() };
  if (view.parallel)
  {
    for (int k = 0; k < 2; ++k)
    {
      const double slope = axes[k].dot(view.direction) / normal.dot(view.direction);
      matrix.row(k) = affine(axes[k] - slope * normal, view.detectorOrigin);
    }
    matrix.row(2) << 0, 0, 0, 1;
    return matrix;
  }
  const double distance = normal.dot(view.detectorOrigin - view.source);
  const auto   depth = affine(normal, view.source);
  for (int k = 0; k < 2; ++k)
  {
    const double ofFoot = axes[k].dot(view.source - view.detectorOrigin);
    matrix.row(k) = distance * affine(axes[k], view.source) + ofFoot * depth;
  }
  matrix.row(2) = depth;
  return matrix;
}

XRayGeometry::View
FromProjectionMatrix(const ProjectionMatrix & matrix, const std::array<int, 2> & size, double columnSpacing)
{
  RequirePositive("The column spacing", columnSpacing);
  const Eigen::Matrix3d left = matrix.leftCols<3>();
  if (!matrix.allFinite() || !(std::abs(left.determinant()) > 1e-12 * std::pow(left.norm(), 3)))
  {
    itkGenericExceptionMacro(
      "The projection matrix's first three columns are singular: it is that of no point source (a parallel beam's "
      "matrix does not tell where the detector is).");
  }
  const Eigen::Matrix3d toRay = left.inverse();
  const double          scale = columnSpacing / toRay.col(0).norm();
  XRayGeometry::View    view;
  view.source = -toRay * matrix.col(3);
  view.size = size;
  view.spacing = scale * Vector2(toRay.col(0).norm(), toRay.col(1).norm());
  view.detectorU = toRay.col(0).normalized();
  view.detectorV = toRay.col(1).normalized();
  view.detectorOrigin = view.source + scale * toRay.col(2);
  const double skew = view.detectorU.dot(view.detectorV);
  if (!(std::abs(skew) <= tolerance))
  {
    itkGenericExceptionMacro("The projection matrix has skewed pixels (the cosine of the angle of its axes is "
                             << skew << "): resample the image to right angles.");
  }
  return Checked(view);
}

XRayGeometry::View
FromPlastimatch(const PlastimatchView & from)
{
  RequirePositive("sad", from.sad);
  RequirePositive("sid", from.sid);
  const Vector3 right = from.vup.cross(from.nrm);
  if (!(right.norm() > tolerance * from.vup.norm() * from.nrm.norm()))
  {
    itkGenericExceptionMacro("nrm and vup are parallel or zero: the detector's rows have no direction.");
  }
  if (from.dim[0] < 1 || from.dim[1] < 1)
  {
    itkGenericExceptionMacro("dim is " << from.dim[0] << " by " << from.dim[1] << "; both must be at least 1.");
  }
  const Vector3      normal = from.nrm.normalized();
  XRayGeometry::View view;
  view.source = from.isocenter + from.sad * normal;
  view.detectorU = right.normalized();
  view.detectorV = view.detectorU.cross(normal);
  view.size = from.dim;
  view.spacing = from.detectorSize.cwiseQuotient(Vector2(from.dim[0], from.dim[1]));
  view.detectorOrigin = view.source - from.sid * normal - from.imageCenter.x() * view.spacing.x() * view.detectorU -
                        from.imageCenter.y() * view.spacing.y() * view.detectorV;
  return Checked(view);
}

PlastimatchView
ToPlastimatch(const XRayGeometry::View & view, double sad)
{
  RequirePositive("sad", sad);
  const Vector3 normal = -Forward(view);
  if (view.parallel || view.detectorU.cross(view.detectorV).dot(normal) > 0)
  {
    itkGenericExceptionMacro(<< (view.parallel ? "plastimatch knows no parallel beam."
                                               : "Seen from the source this view's columns and rows run the other way "
                                                 "round than plastimatch's: turn detectorV and the image round."));
  }
  PlastimatchView to;
  const Vector3   toOrigin = view.detectorOrigin - view.source;
  to.nrm = normal;
  to.vup = -view.detectorV;
  to.sad = sad;
  to.sid = -toOrigin.dot(normal);
  to.isocenter = view.source - sad * normal;
  to.dim = view.size;
  to.detectorSize = view.spacing.cwiseProduct(Vector2(view.size[0], view.size[1]));
  to.imageCenter = { -toOrigin.dot(view.detectorU) / view.spacing.x(),
                     -toOrigin.dot(view.detectorV) / view.spacing.y() };
  return to;
}

ProjectionMatrix
RtkMatrix(const RtkProjection & p)
{
  Eigen::Matrix4d frame = Eigen::Matrix4d::Identity();
  frame.topLeftCorner<3, 3>() = RtkRotation(p);
  ProjectionMatrix project;
  if (p.sourceToDetector == 0)
  {
    project << 1, 0, 0, -p.projectionOffsetX, 0, 1, 0, -p.projectionOffsetY, 0, 0, 0, 1;
    return project * frame;
  }
  const double x = p.sourceOffsetX - p.projectionOffsetX, y = p.sourceOffsetY - p.projectionOffsetY;
  const double d = p.sourceToDetector;
  project << -d, 0, x, d * p.sourceOffsetX - x * p.sourceToIsocenter, 0, -d, y,
    d * p.sourceOffsetY - y * p.sourceToIsocenter, 0, 0, 1, -p.sourceToIsocenter;
  return project * frame;
}

XRayGeometry::View
FromRtk(const RtkProjection & p, const RtkGrid & grid)
{
  const Eigen::Matrix3d back = RtkRotation(p).transpose();
  const double          down = grid.rowsDown ? -1 : 1;
  XRayGeometry::View    view;
  view.parallel = p.sourceToDetector == 0;
  if (!view.parallel)
  {
    RequirePositive("SourceToDetectorDistance", p.sourceToDetector);
  }
  const double depth = view.parallel ? -std::abs(p.sourceToIsocenter) : p.sourceToIsocenter - p.sourceToDetector;
  view.source = back * Vector3(p.sourceOffsetX, p.sourceOffsetY, p.sourceToIsocenter);
  view.direction = -back.col(2);
  view.detectorU = back.col(0);
  view.detectorV = down * back.col(1);
  view.size = grid.size;
  view.spacing = grid.spacing;
  view.detectorOrigin =
    back * Vector3(grid.origin.x() + p.projectionOffsetX, grid.origin.y() + p.projectionOffsetY, depth);
  return Checked(view);
}

void
ToRtk(const XRayGeometry::View & view, RtkProjection & p, RtkGrid & grid)
{
  const Vector3 back = -Forward(view);
  if (view.parallel && !(view.direction.dot(back) < -1 + tolerance * tolerance))
  {
    itkGenericExceptionMacro("RTK knows parallel beams perpendicular to the detector only.");
  }
  grid.size = view.size;
  grid.spacing = view.spacing;
  grid.rowsDown = view.detectorU.cross(view.detectorV).dot(back) < 0;
  Eigen::Matrix3d frame;
  frame.row(0) = view.detectorU.transpose();
  frame.row(1) = (grid.rowsDown ? -1.0 : 1.0) * view.detectorV.transpose();
  frame.row(2) = back.transpose();

  // frame = Rz(-in) Rx(-out) Ry(-gantry): its last row and its middle column tell the angles.
  p = RtkProjection();
  p.outOfPlaneAngle = -perRadian * std::asin(std::clamp(frame(2, 1), -1.0, 1.0));
  if (std::abs(frame(2, 1)) < 1 - 1e-12)
  {
    p.gantryAngle = -perRadian * std::atan2(-frame(2, 0), frame(2, 2));
    p.inPlaneAngle = -perRadian * std::atan2(-frame(0, 1), frame(1, 1));
  }
  else
  {
    p.inPlaneAngle = -perRadian * std::atan2(frame(1, 0), frame(0, 0));
  }
  const Vector3 origin = frame * view.detectorOrigin;
  grid.origin = Vector2::Zero();
  p.projectionOffsetX = origin.x();
  p.projectionOffsetY = origin.y();
  if (view.parallel)
  {
    p.sourceToIsocenter = std::abs(origin.z());
    return;
  }
  const Vector3 source = frame * view.source;
  p.sourceToIsocenter = source.z();
  p.sourceToDetector = source.z() - origin.z();
  p.sourceOffsetX = source.x();
  p.sourceOffsetY = source.y();
}

XRayGeometry::View
FromCArm(const CArmView & arm)
{
  RequirePositive("The distance from source to isocentre", arm.sourceToIsocenter);
  RequirePositive("The distance from source to detector", arm.sourceToDetector);
  if (!(arm.sourceToDetector >= arm.sourceToIsocenter))
  {
    itkGenericExceptionMacro("The detector is " << arm.sourceToDetector << " mm from the source and the isocentre "
                                                << arm.sourceToIsocenter
                                                << " mm: the isocentre must lie before the detector.");
  }
  if (!(std::abs(arm.primary) <= 180) || !(std::abs(arm.secondary) <= 90))
  {
    itkGenericExceptionMacro("The C-arm's angles are "
                             << arm.primary << " and " << arm.secondary
                             << " degrees; the primary must be from -180 to 180, the secondary from -90 to 90.");
  }
  const double p = arm.primary / perRadian, s = arm.secondary / perRadian;
  // The detector's direction (sin p cos s, -cos p cos s, sin s), and its derivatives by the two angles.
  const Vector3      toDetector(std::sin(p) * std::cos(s), -std::cos(p) * std::cos(s), std::sin(s));
  XRayGeometry::View view;
  view.detectorU = { std::cos(p), std::sin(p), 0 };
  view.detectorV = { std::sin(p) * std::sin(s), -std::cos(p) * std::sin(s), -std::cos(s) };
  view.source = arm.isocenter - arm.sourceToIsocenter * toDetector;
  view.direction = toDetector;
  view.size = arm.size;
  view.spacing = arm.spacing;
  const Vector2 centre =
    arm.centre.array().isNaN().any() ? Vector2(0.5 * (arm.size[0] - 1), 0.5 * (arm.size[1] - 1)) : arm.centre;
  view.detectorOrigin = view.source + arm.sourceToDetector * toDetector -
                        centre.x() * view.spacing.x() * view.detectorU - centre.y() * view.spacing.y() * view.detectorV;
  return Checked(view);
}
} // namespace bone
