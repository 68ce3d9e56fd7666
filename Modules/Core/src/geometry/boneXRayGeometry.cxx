/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneXRayGeometry.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>

namespace bone
{
namespace
{
constexpr double unitTolerance = 1e-6;

Eigen::RowVector3d
Row(const Vector3 & v)
{
  return v.transpose();
}

/** Why a view cannot be used, or an empty string. */
std::string
ReasonAgainst(const XRayGeometry::View & view)
{
  const Vector3 & ray = view.parallel ? view.direction : view.source;
  if (!ray.allFinite() || !view.detectorOrigin.allFinite() || !view.detectorU.allFinite() ||
      !view.detectorV.allFinite() || !view.spacing.allFinite())
  {
    return "a number of the source, the detector or the spacing is not finite";
  }
  if (view.size[0] < 1 || view.size[1] < 1)
  {
    return "the detector has " + std::to_string(view.size[0]) + " columns and " + std::to_string(view.size[1]) +
           " rows; both must be at least 1";
  }
  if (!(view.spacing.x() > 0) || !(view.spacing.y() > 0))
  {
    return "the pixel spacing is " + std::to_string(view.spacing.x()) + " by " + std::to_string(view.spacing.y()) +
           " mm; both must be positive";
  }
  if (!(std::abs(view.detectorU.norm() - 1) <= unitTolerance) ||
      !(std::abs(view.detectorV.norm() - 1) <= unitTolerance) ||
      !(std::abs(view.detectorU.dot(view.detectorV)) <= unitTolerance))
  {
    return "the detector's axes U and V must be unit vectors at right angles";
  }
  const Vector3 normal = view.detectorU.cross(view.detectorV);
  if (view.parallel)
  {
    if (!(std::abs(view.direction.norm() - 1) <= unitTolerance))
    {
      return "the beam's direction must be a unit vector";
    }
    return std::abs(view.direction.dot(normal)) > unitTolerance ? "" : "the beam runs along the detector's plane";
  }
  const Vector3 toDetector = view.detectorOrigin - view.source;
  const bool    apart = std::abs(toDetector.dot(normal)) > unitTolerance * std::max(1.0, toDetector.norm());
  return apart ? "" : "the source lies in the detector's plane";
}
} // namespace

void
XRayGeometry::SetView(const View & view)
{
  const std::string reason = ReasonAgainst(view);
  if (!reason.empty())
  {
    itkExceptionMacro("This X-ray geometry cannot be used: " << reason << '.');
  }
  const View & now = m_View;
  if (view.parallel == now.parallel && view.source == now.source && view.direction == now.direction &&
      view.detectorOrigin == now.detectorOrigin && view.detectorU == now.detectorU && view.detectorV == now.detectorV &&
      view.size == now.size && view.spacing == now.spacing)
  {
    return;
  }
  m_View = view;
  this->Modified();
}

Vector3
XRayGeometry::GetPixelPoint(double column, double row) const
{
  return m_View.detectorOrigin + column * m_View.spacing.x() * m_View.detectorU +
         row * m_View.spacing.y() * m_View.detectorV;
}

Vector2
XRayGeometry::ProjectPoint(const Vector3 & point) const
{
  const Vector3 normal = m_View.detectorU.cross(m_View.detectorV);
  const Vector3 ray = m_View.parallel ? m_View.direction : Vector3(point - m_View.source);
  const double  along = ray.dot(normal), left = (m_View.detectorOrigin - point).dot(normal);
  const double  whole = m_View.parallel ? along : (m_View.detectorOrigin - m_View.source).dot(normal);
  if (!m_View.parallel && !(along * whole > 0))
  {
    return Vector2::Constant(std::numeric_limits<double>::quiet_NaN());
  }
  const Vector3 hit = point + (left / along) * ray - m_View.detectorOrigin;
  return { hit.dot(m_View.detectorU) / m_View.spacing.x(), hit.dot(m_View.detectorV) / m_View.spacing.y() };
}

XRayGeometry::View
XRayGeometry::Framing(const Vector3 & lower,
                      const Vector3 & upper,
                      const Vector3 & beam,
                      const Vector3 & up,
                      double          sourceToCentre,
                      double          sourceToDetector,
                      int             pixels)
{
  const Vector3 direction = beam.normalized();
  const Vector3 side = direction.cross(up);
  if (!(side.norm() > unitTolerance * up.norm()) || !lower.allFinite() || !upper.allFinite() ||
      !((upper - lower).minCoeff() >= 0) || pixels < 1)
  {
    itkGenericExceptionMacro("Cannot frame the box: the beam and `up` must not be parallel, the box's upper corner not "
                             "below the lower, and the number of pixels ("
                             << pixels << ") positive.");
  }
  const Vector3 centre = 0.5 * (lower + upper);
  View          view;
  view.source = centre - sourceToCentre * direction;
  view.direction = direction;
  view.detectorU = side.normalized();
  view.detectorV = direction.cross(view.detectorU);

  Vector2 low = Vector2::Constant(std::numeric_limits<double>::max());
  Vector2 high = -low;
  for (int corner = 0; corner < 8; ++corner)
  {
    const Vector3 p(
      corner & 1 ? upper.x() : lower.x(), corner & 2 ? upper.y() : lower.y(), corner & 4 ? upper.z() : lower.z());
    const Vector3 ray = p - view.source;
    const double  depth = ray.dot(direction);
    if (!(depth > 0) || !(depth <= sourceToDetector))
    {
      itkGenericExceptionMacro("Cannot frame the box: a corner of it lies "
                               << depth
                               << " mm from the source along the beam, not "
                                  "between the source and the detector at "
                               << sourceToDetector << " mm.");
    }
    const Vector2 q = Vector2(ray.dot(view.detectorU), ray.dot(view.detectorV)) * (sourceToDetector / depth);
    low = low.cwiseMin(q);
    high = high.cwiseMax(q);
  }
  const Vector2 extent = high - low;
  const double  spacing = extent.maxCoeff() / pixels;
  if (!(spacing > 0))
  {
    itkGenericExceptionMacro("Cannot frame the box: it projects to a single point.");
  }
  for (int k = 0; k < 2; ++k)
  {
    view.size[k] = std::max(1, static_cast<int>(std::ceil(extent[k] / spacing - unitTolerance)));
  }
  view.spacing = Vector2::Constant(spacing);
  const Vector2 middle = 0.5 * (low + high);
  const Vector2 first = middle - 0.5 * spacing * Vector2(view.size[0] - 1, view.size[1] - 1);
  view.detectorOrigin =
    view.source + sourceToDetector * direction + first.x() * view.detectorU + first.y() * view.detectorV;
  return view;
}

XRayGeometry::View
XRayGeometry::Framing(const Vector3 & lower,
                      const Vector3 & upper,
                      const Vector3 & beam,
                      const Vector3 & up,
                      int             pixels)
{
  const double halfDepth = 0.5 * (upper - lower).dot(beam.normalized().cwiseAbs());
  const double toCentre = std::max(1000.0, 4 * halfDepth);
  const double toDetector = toCentre + std::max(200.0, 1.01 * halfDepth); // some more than needed, for rounding
  return Framing(lower, upper, beam, up, toCentre, toDetector, pixels);
}

void
XRayGeometry::Graft(const itk::DataObject * data)
{
  const auto * other = dynamic_cast<const Self *>(data);
  if (data != nullptr && other == nullptr)
  {
    itkExceptionMacro("Cannot graft a " << data->GetNameOfClass() << " onto an XRayGeometry.");
  }
  Superclass::Graft(data);
  if (other != nullptr)
  {
    m_View = other->m_View;
  }
}

void
XRayGeometry::PrintSelf(std::ostream & os, itk::Indent indent) const
{
  Superclass::PrintSelf(os, indent);
  if (m_View.parallel)
  {
    os << indent << "Direction: " << Row(m_View.direction) << '\n';
  }
  else
  {
    os << indent << "Source: " << Row(m_View.source) << '\n';
  }
  os << indent << "DetectorOrigin: " << Row(m_View.detectorOrigin) << '\n';
  os << indent << "DetectorU: " << Row(m_View.detectorU) << '\n';
  os << indent << "DetectorV: " << Row(m_View.detectorV) << '\n';
  os << indent << "Size: " << m_View.size[0] << " x " << m_View.size[1] << '\n';
  os << indent << "Spacing: " << m_View.spacing.transpose() << '\n';
}
} // namespace bone
