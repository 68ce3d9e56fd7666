/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneDensityTestMeshes_h
#define boneDensityTestMeshes_h

#include "boneDensityMesh.h"

#include <itkImage.h>
#include <itkImageRegionIteratorWithIndex.h>

#include <functional>
#include <random>

namespace bone::test
{
/** A block of nx x ny x nz cubes of a side, split into six tetrahedra each; inner points jittered by a share of the
 * side. Region 1 is the half of lower x, region 2 the other. */
inline MeshArrays
MakeBlock(std::array<int, 3> cubes, const Vector3 & lower, double side, double jitter, unsigned seed = 1)
{
  std::mt19937                           random(seed);
  std::uniform_real_distribution<double> uniform(-jitter, jitter);
  const auto                             id = [&](const std::array<int, 3> & at) {
    return static_cast<IdType>((at[2] * (cubes[1] + 1) + at[1]) * (cubes[0] + 1) + at[0]);
  };
  MeshArrays mesh;
  for (int k = 0; k <= cubes[2]; ++k)
  {
    for (int j = 0; j <= cubes[1]; ++j)
    {
      for (int i = 0; i <= cubes[0]; ++i)
      {
        const Vector3 shift(uniform(random), uniform(random), uniform(random));
        const bool inner = i > 0 && j > 0 && k > 0 && i < cubes[0] && j < cubes[1] && k < cubes[2] && i != cubes[0] / 2;
        mesh.points.push_back(lower + side * (Vector3(i, j, k) + (inner ? shift : Vector3(Vector3::Zero()))));
      }
    }
  }
  constexpr std::array<std::array<int, 3>, 6> orders = {
    { { 0, 1, 2 }, { 0, 2, 1 }, { 1, 0, 2 }, { 1, 2, 0 }, { 2, 0, 1 }, { 2, 1, 0 } }
  };
  for (int cube = 0; cube < cubes[0] * cubes[1] * cubes[2]; ++cube)
  {
    const std::array<int, 3> first = { cube % cubes[0], cube / cubes[0] % cubes[1], cube / cubes[0] / cubes[1] };
    for (const auto & order : orders)
    {
      std::array<int, 3> at = first;
      Id4                tetra;
      tetra[0] = id(at);
      for (int step = 0; step < 3; ++step)
      {
        ++at[order[step]];
        tetra[step + 1] = id(at);
      }
      const auto & p = mesh.points;
      if (SignedVolume(p[tetra[0]], p[tetra[1]], p[tetra[2]], p[tetra[3]]) < 0)
      {
        std::swap(tetra[2], tetra[3]);
      }
      mesh.tetrahedra.push_back(tetra);
      mesh.region.push_back(first[0] < cubes[0] / 2 ? 1 : 2);
    }
  }
  return mesh;
}

template <typename TMesh = DensityMesh<double>>
typename TMesh::Pointer
ToMesh(const MeshArrays & arrays)
{
  auto mesh = TMesh::New();
  mesh->SetArrays(arrays);
  return mesh;
}

using Image = itk::Image<float, 3>;
using DoubleImage = itk::Image<double, 3>;

/** An oblique, anisotropic image whose region starts at an index other than 0, filled with f at its voxel centres. It
 * covers the ball of radius 20 mm about (10, -5, 30). */
template <typename TImage>
typename TImage::Pointer
ObliqueImage(const std::function<double(const Vector3 &)> & f)
{
  auto                           image = TImage::New();
  typename TImage::RegionType    region;
  typename TImage::SpacingType   spacing;
  typename TImage::IndexType     start = { { -7, 4, 11 } };
  const std::array<double, 3>    step = { { 0.8, 1.1, 1.7 } };
  const Eigen::Matrix3d          rotation = Eigen::AngleAxisd(0.5, Vector3(1, -2, 0.5).normalized()).toRotationMatrix();
  typename TImage::DirectionType direction;
  Vector3                        half;
  for (unsigned int axis = 0; axis < 3; ++axis)
  {
    spacing[axis] = step[axis];
    region.SetSize(axis, static_cast<itk::SizeValueType>(42 / step[axis]));
    half[axis] = step[axis] * (start[axis] + 0.5 * static_cast<double>(region.GetSize(axis)));
    for (unsigned int row = 0; row < 3; ++row)
    {
      direction[row][axis] = rotation(row, axis);
    }
  }
  region.SetIndex(start);
  const Vector3              origin = Vector3(10, -5, 30) - rotation * half;
  typename TImage::PointType point;
  for (unsigned int axis = 0; axis < 3; ++axis)
  {
    point[axis] = origin[axis];
  }
  image->SetRegions(region);
  image->SetSpacing(spacing);
  image->SetDirection(direction);
  image->SetOrigin(point);
  image->Allocate();
  for (itk::ImageRegionIteratorWithIndex<TImage> it(image, region); !it.IsAtEnd(); ++it)
  {
    image->TransformIndexToPhysicalPoint(it.GetIndex(), point);
    it.Set(static_cast<typename TImage::PixelType>(f(Vector3(point[0], point[1], point[2]))));
  }
  return image;
}

inline double
Linear(const Vector3 & x)
{
  return 300 + 7 * x[0] - 4 * x[1] + 2.5 * x[2];
}

inline double
Smooth(const Vector3 & x)
{
  return 500 + 300 * std::sin(0.3 * x[0]) * std::cos(0.25 * x[1]) + 10 * x[2];
}
} // namespace bone::test

#endif
