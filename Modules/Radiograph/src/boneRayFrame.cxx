/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneRayFrame.h"

#include <Eigen/LU>

namespace bone
{
namespace
{
// Far above the rounding of pixel coordinates (1e-12), far below what shows; no simple ratio between the two.
constexpr double columnDisplacement = 1.0e-8;
constexpr double rowDisplacement = 0.618034e-8;
} // namespace

RayFrame::RayFrame(const XRayGeometry::View & view)
  : m_Parallel(view.parallel)
  , m_Columns(view.size[0])
  , m_Rows(view.size[1])
  , m_Origin(view.parallel ? view.detectorOrigin : view.source)
  , m_Direction(view.parallel ? view.direction : Vector3(view.detectorOrigin - view.source))
  , m_StepU(view.spacing.x() * view.detectorU)
  , m_StepV(view.spacing.y() * view.detectorV)
{
  Eigen::Matrix3d axes;
  axes << m_Direction, m_StepU, m_StepV;
  m_ToPixel = axes.inverse();
}

RayFrame
RayFrame::Displaced(const XRayGeometry::View & view)
{
  XRayGeometry::View displaced = view;
  displaced.detectorOrigin +=
    columnDisplacement * view.spacing.x() * view.detectorU + rowDisplacement * view.spacing.y() * view.detectorV;
  return RayFrame(displaced);
}

Vector3
RayFrame::Project(const Vector3 & point) const
{
  const Vector3 q = m_ToPixel * (point - m_Origin);
  return m_Parallel ? Vector3(q[1], q[2], q[0]) : Vector3(q[1] / q[0], q[2] / q[0], q[0]);
}

void
RayFrame::StepLengths(int row, int firstColumn, int endColumn, float * lengths) const
{
  Eigen::Map<Eigen::ArrayXf> out(lengths, endColumn - firstColumn);
  if (m_Parallel)
  {
    out.setOnes();
    return;
  }
  // Along the row and across it: a sum of squares.
  const Vector3 start = m_Direction + row * m_StepV, axis = m_StepU.normalized();
  const double  along = start.dot(axis), step = m_StepU.norm();
  const auto    rest = static_cast<float>((start - along * axis).squaredNorm());
  const auto    first = static_cast<float>(along + step * firstColumn);
  const auto    last = static_cast<float>(along + step * (endColumn - 1));
  out = (Eigen::ArrayXf::LinSpaced(out.size(), first, last).square() + rest).sqrt();
}

RayFrame::DepthLine
RayFrame::Restrict(double a, const Vector3 & g) const
{
  const double atOrigin = a + g.dot(m_Origin), along = g.dot(m_Direction);
  // Point source: mu = atOrigin + s (along + c gu + r gv), times t. Parallel: mu = atOrigin + c gu + r gv - t along.
  return m_Parallel ? DepthLine{ -along, atOrigin, g.dot(m_StepU), g.dot(m_StepV) }
                    : DepthLine{ atOrigin, along, g.dot(m_StepU), g.dot(m_StepV) };
}
} // namespace bone
