/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneLinearSampler_h
#define boneLinearSampler_h

#include "boneVoxelGrid.h"

#include <algorithm>

namespace bone
{
/** \class LinearSampler
 * \brief Trilinear interpolation in a buffer of voxels, as itk::LinearInterpolateImageFunction.
 *
 * Takes index coordinates counted from the buffer's first voxel. Beyond the outermost voxel centres the value is that
 * of the nearest point between them. */
template <typename TPixel>
class LinearSampler
{
public:
  LinearSampler(const TPixel * buffer, const std::array<int, 3> & size)
    : m_Buffer(buffer)
    , m_RowStride(size[0])
    , m_SliceStride(static_cast<std::ptrdiff_t>(size[0]) * size[1])
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      m_Last[axis] = size[axis] - 1.0;
      m_LastCell[axis] = std::max(size[axis] - 2, 0);
      m_Step[axis] = size[axis] > 1 ? (axis == 0 ? 1 : axis == 1 ? m_RowStride : m_SliceStride) : 0;
    }
  }

  double
  operator()(const Vector3 & index) const
  {
    std::ptrdiff_t offset = 0;
    Vector3        f;
    for (int axis = 0; axis < 3; ++axis)
    {
      const double x = std::min(std::max(index[axis], 0.0), m_Last[axis]);
      const int    cell = std::min(static_cast<int>(x), m_LastCell[axis]);
      f[axis] = x - cell;
      offset += cell * (axis == 0 ? 1 : axis == 1 ? m_RowStride : m_SliceStride);
    }
    const TPixel * p = m_Buffer + offset;
    const double   v00 = Between(p, f[0]), v10 = Between(p + m_Step[1], f[0]);
    const double   v01 = Between(p + m_Step[2], f[0]), v11 = Between(p + m_Step[1] + m_Step[2], f[0]);
    const double   v0 = v00 + f[1] * (v10 - v00), v1 = v01 + f[1] * (v11 - v01);
    return v0 + f[2] * (v1 - v0);
  }

private:
  double
  Between(const TPixel * p, double f) const
  {
    const auto a = static_cast<double>(p[0]), b = static_cast<double>(p[m_Step[0]]);
    return a + f * (b - a);
  }

  const TPixel *                m_Buffer;
  std::ptrdiff_t                m_RowStride;
  std::ptrdiff_t                m_SliceStride;
  std::array<std::ptrdiff_t, 3> m_Step;
  std::array<int, 3>            m_LastCell;
  Vector3                       m_Last;
};
} // namespace bone

#endif
