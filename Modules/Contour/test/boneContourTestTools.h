/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneContourTestTools_h
#define boneContourTestTools_h

#include "boneContourStack.h"
#include "bonePlaneField.h"

#include <itkImage.h>
#include <itkImageRegionIteratorWithIndex.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace bone
{
using TestCT = itk::Image<float, 3>;
using TestLabels = itk::Image<short, 3>;

inline Polygon
Ellipse(double a, double b, int n, const Vector2 & centre = Vector2::Zero())
{
  Polygon points;
  for (int i = 0; i < n; ++i)
  {
    const double t = 2.0 * M_PI * i / n;
    points.push_back(centre + Vector2(a * std::cos(t), b * std::sin(t)));
  }
  return points;
}

inline double
DistanceTo(const Vector2 & q, const Polygon & polygon)
{
  double best = std::numeric_limits<double>::max();
  for (std::size_t i = 0; i < polygon.size(); ++i)
  {
    const Vector2 & a = polygon[i];
    const Vector2   d = polygon[(i + 1) % polygon.size()] - a;
    const double    t = std::clamp((q - a).dot(d) / d.squaredNorm(), 0.0, 1.0);
    best = std::min(best, (q - a - t * d).norm());
  }
  return best;
}

inline Polygon
PlanePoints(const ContourStack & stack, const Contour & contour)
{
  Polygon polygon;
  for (const Vector3 & p : contour.points)
  {
    polygon.push_back(stack.ToPlane(p));
  }
  return polygon;
}

/** A stack of one slice at height 0 in the plane z = 0. */
inline ContourStack::Pointer
OneSlice(const std::vector<Polygon> & polygons, const std::vector<int> & layers)
{
  auto         stack = ContourStack::New();
  ContourSlice slice;
  for (std::size_t c = 0; c < polygons.size(); ++c)
  {
    Contour contour;
    contour.layer = layers[c];
    contour.id = static_cast<int>(c);
    contour.region = SignedArea(polygons[c]) < 0.0 ? 0 : layers[c] + 1;
    for (const Vector2 & q : polygons[c])
    {
      contour.points.push_back(stack->FromPlane(q, 0.0));
    }
    slice.contours.push_back(contour);
  }
  stack->SetSlices({ slice });
  return stack;
}

/** Where an image lies: size, voxels and pose. */
struct TestGrid
{
  itk::Size<3>    size{ { 60, 56, 12 } };
  Vector3         spacing{ 0.7, 0.9, 2.0 };
  Eigen::Matrix3d rotation{ Eigen::Matrix3d::Identity() };
  Vector3         origin{ -20.0, -24.0, 5.0 };
  itk::Index<3>   start{ { 0, 0, 0 } };
};

/** An image of f(x, y, z), the coordinates those of the grid before its pose: origin + spacing * index. */
template <typename TImage, typename TFunction>
typename TImage::Pointer
MakeImage(const TestGrid & grid, TFunction && f)
{
  auto                           image = TImage::New();
  typename TImage::DirectionType direction;
  typename TImage::PointType     origin;
  typename TImage::SpacingType   spacing;
  const Vector3                  shift = grid.spacing.cwiseProduct(Vector3(
    static_cast<double>(grid.start[0]), static_cast<double>(grid.start[1]), static_cast<double>(grid.start[2])));
  const Vector3                  posed = grid.rotation * (grid.origin - shift);
  for (unsigned int a = 0; a < 3; ++a)
  {
    origin[a] = posed[a];
    spacing[a] = grid.spacing[a];
    for (unsigned int b = 0; b < 3; ++b)
    {
      direction[a][b] = grid.rotation(a, b);
    }
  }
  image->SetRegions(typename TImage::RegionType(grid.start, grid.size));
  image->SetOrigin(origin);
  image->SetSpacing(spacing);
  image->SetDirection(direction);
  image->Allocate();
  for (itk::ImageRegionIteratorWithIndex<TImage> it(image, image->GetBufferedRegion()); !it.IsAtEnd(); ++it)
  {
    Vector3 x = grid.origin;
    for (int a = 0; a < 3; ++a)
    {
      x[a] += grid.spacing[a] * static_cast<double>(it.GetIndex()[static_cast<unsigned int>(a)] -
                                                    grid.start[static_cast<unsigned int>(a)]);
    }
    it.Set(static_cast<typename TImage::PixelType>(f(x.x(), x.y(), x.z())));
  }
  return image;
}

/** 1 well inside, 0 well outside of a surface at signed distance 0 (positive inside), blurred by a Gaussian. */
inline double
Blurred(double inside, double sigma)
{
  return 0.5 * (1.0 + std::erf(inside / (sigma * std::sqrt(2.0))));
}

/** A tube along z: soft tissue at 50 HU, cortex of 1200 HU from radius `outer` to `inner`, inside at `core` HU. */
inline double
TubeDensity(double x, double y, double outer, double inner, double core, double sigma = 0.6)
{
  const double r = std::hypot(x, y);
  return 50.0 + (1200.0 - 50.0) * Blurred(outer - r, sigma) + (core - 1200.0) * Blurred(inner - r, sigma);
}

/** What an exception says, or "" where none is thrown. */
template <typename TFunction>
std::string
MessageOf(TFunction && f)
{
  try
  {
    f();
  }
  catch (const itk::ExceptionObject & error)
  {
    return error.GetDescription();
  }
  return {};
}
} // namespace bone

#endif
