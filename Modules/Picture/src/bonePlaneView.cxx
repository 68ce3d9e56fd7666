/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "bonePlaneView.h"

#include "boneSymmetricEigen.h"

#include <Eigen/Geometry>

#include <itkLinearInterpolateImageFunction.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace bone
{
PlaneView
FramePlane(const Vector3 &              normal,
           const Vector3 &              point,
           const std::vector<Vector3> & points,
           double                       margin,
           int                          pixels)
{
  const auto inPlane = [&normal](const Vector3 & v) { return Vector3(v - v.dot(normal) * normal); };
  Vector3    up = inPlane(Vector3::UnitZ());
  if (up.norm() < 0.5)
  {
    up = inPlane(-Vector3::UnitY());
  }
  up.normalize();
  Vector3 right = up.cross(normal);
  if (std::abs(right.x()) > 0.3 ? right.x() < 0.0 : right.y() < 0.0)
  {
    right = -right;
  }

  PlaneView view;
  view.right = right;
  view.down = -up;
  Vector2 lower = Vector2::Constant(std::numeric_limits<double>::max());
  Vector2 upper = -lower;
  for (const Vector3 & p : points)
  {
    const Vector2 q(p.dot(view.right), p.dot(view.down));
    lower = lower.cwiseMin(q);
    upper = upper.cwiseMax(q);
  }
  lower.array() -= margin;
  upper.array() += margin;
  const Vector2 size = upper - lower;
  view.pixel = size.maxCoeff() / pixels;
  view.columns = std::max(1, static_cast<int>(size.x() / view.pixel));
  view.rows = std::max(1, static_cast<int>(size.y() / view.pixel));
  view.corner = lower.x() * view.right + lower.y() * view.down + point.dot(normal) * normal;
  return view;
}

PlaneView
FrameLargestCut(const std::vector<Vector3> & points, double margin, int pixels)
{
  Vector3 mean = Vector3::Zero();
  for (const Vector3 & p : points)
  {
    mean += p / static_cast<double>(points.size());
  }
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const Vector3 & p : points)
  {
    covariance += (p - mean) * (p - mean).transpose();
  }
  return FramePlane(EigenOf(covariance).vectors.col(0), mean, points, margin, pixels);
}

CTImage::Pointer
MakePlaneImage(const PlaneView & view)
{
  auto              image = CTImage::New();
  CTImage::SizeType size = {
    { static_cast<itk::SizeValueType>(view.columns), static_cast<itk::SizeValueType>(view.rows), 1 }
  };
  CTImage::DirectionType direction;
  CTImage::PointType     origin;
  CTImage::SpacingType   spacing;
  const Vector3          normal = view.right.cross(view.down);
  for (unsigned int d = 0; d < 3; ++d)
  {
    direction(d, 0) = view.right[d];
    direction(d, 1) = view.down[d];
    direction(d, 2) = normal[d];
    origin[d] = view.corner[d];
    spacing[d] = view.pixel;
  }
  image->SetRegions(size);
  image->SetDirection(direction);
  image->SetOrigin(origin);
  image->SetSpacing(spacing);
  image->Allocate();
  return image;
}

Panel
SamplePlane(const CTImage * image, const PlaneView & view)
{
  auto interpolator = itk::LinearInterpolateImageFunction<CTImage, double>::New();
  interpolator->SetInputImage(image);
  Panel panel;
  panel.columns = view.columns;
  panel.rows = view.rows;
  panel.values.assign(static_cast<std::size_t>(view.columns) * static_cast<std::size_t>(view.rows), std::nanf(""));
  for (int r = 0; r < view.rows; ++r)
  {
    for (int c = 0; c < view.columns; ++c)
    {
      const Vector3      p = view.corner + view.pixel * (c * view.right + r * view.down);
      CTImage::PointType point;
      std::copy(p.data(), p.data() + 3, point.Begin());
      if (interpolator->IsInsideBuffer(point))
      {
        panel.At(c, r) = static_cast<float>(interpolator->Evaluate(point));
      }
    }
  }
  return panel;
}

Panel
ToPanel(const CTImage * image)
{
  const auto    size = image->GetLargestPossibleRegion().GetSize();
  const auto    count = size[0] * size[1];
  const float * values = image->GetBufferPointer();
  Panel         panel;
  panel.columns = static_cast<int>(size[0]);
  panel.rows = static_cast<int>(size[1]);
  panel.values.assign(values, values + count);
  return panel;
}
} // namespace bone
