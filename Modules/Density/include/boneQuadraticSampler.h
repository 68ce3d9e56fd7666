/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneQuadraticSampler_h
#define boneQuadraticSampler_h

#include "boneVoxelGrid.h"

#include <algorithm>

namespace bone
{
/** \class QuadraticSampler
 * \brief Trilinear interpolation freed of its error by curvature: through the voxels' values, exact for quadratic
 * fields, never beyond the values of the eight voxels around.
 *
 * Between two voxels linear interpolation is off by t (1 - t) / 2 times the second difference, t the place between
 * them: 1/12 of it on average, which along a bone's surface, all curved the same way, adds up to a loss of mass. That
 * is taken off along each axis, the second difference being interpolated like the values:
 *
 *   value(x) = L[v](x) - sum_axes t (1 - t) / 2 L[d2 v](x),  L trilinear,  d2 v = v(i - 1) - 2 v(i) + v(i + 1)
 *
 * and the value drawn in between the least and the largest of the eight voxels around, so that an edge does not ring
 * (an extremum between voxels is cut off at the nearest voxel's value). Along an axis this is the cubic convolution of
 * R. Keys (doi:10.1109/TASSP.1981.1163711, a = -1/2); the products of axes are left out, so 32 voxels do in place
 * of 64. Where a neighbour is missing the second difference is 0: linear fields are exact up to the image's border.
 *
 * Takes index coordinates counted from the buffer's first voxel. Beyond the outermost voxel centres the value is that
 * of the nearest point between them. Const use is safe from many threads. */
template <typename TPixel>
class QuadraticSampler
{
public:
  QuadraticSampler(const TPixel * buffer, const std::array<int, 3> & size)
    : m_Buffer(buffer)
    , m_Size(size)
    , m_Stride{ { 1, size[0], static_cast<std::ptrdiff_t>(size[0]) * size[1] } }
  {}

  double
  operator()(const Vector3 & index) const
  {
    const TPixel * p = m_Buffer; // the lower corner's voxel
    Axis           axes[3];
    for (int axis = 0; axis < 3; ++axis)
    {
      const double x = std::min(std::max(index[axis], 0.0), m_Size[axis] - 1.0);
      const int    cell = std::min(static_cast<int>(x), std::max(m_Size[axis] - 2, 0));
      p += cell * m_Stride[axis];
      axes[axis] = Axis(x - cell, cell, m_Size[axis], m_Stride[axis]);
    }
    const auto & [x, y, z] = axes;
    double sum = 0, corners[8];
    for (int k = 0; k < 2; ++k)
    {
      for (int j = 0; j < 2; ++j)
      {
        const TPixel * row = p + j * y.step + k * z.step;
        double *       corner = corners + 4 * k + 2 * j;
        corner[0] = static_cast<double>(row[0]);
        corner[1] = static_cast<double>(row[x.step]);
        const double yz = y.linear[j] * z.linear[k];
        const double bent = y.inner[j] * z.linear[k] + y.linear[j] * z.inner[k];
        sum += (yz * (x.linear[0] + x.inner[0]) + bent * x.linear[0]) * corner[0] +
               (yz * (x.linear[1] + x.inner[1]) + bent * x.linear[1]) * corner[1] + yz * Beyond(row, x);
      }
      for (int i = 0; i < 2; ++i)
      {
        sum += x.linear[i] * z.linear[k] * Beyond(p + i * x.step + k * z.step, y);
        sum += x.linear[i] * y.linear[k] * Beyond(p + i * x.step + k * y.step, z);
      }
    }
    const Eigen::Map<const Eigen::Array<double, 8, 1>> around(corners);
    return std::min(std::max(sum, around.minCoeff()), around.maxCoeff()); // in this order NaN stays NaN
  }

private:
  /** Weights along an axis, of the two voxels around a place and of the two beyond these. */
  struct Axis
  {
    Axis() = default;
    Axis(double t, int cell, int size, std::ptrdiff_t stride)
      : linear{ 1 - t, t }
      , step(size > 1 ? stride : 0)
      , below(cell > 0 ? -stride : 0)
      , above(cell + 2 < size ? 2 * stride : step)
    {
      const double bend = -0.5 * t * (1 - t);
      const double ofLower = cell > 0 ? bend * (1 - t) : 0.0, ofUpper = cell + 2 < size ? bend * t : 0.0;
      inner[0] = ofUpper - 2 * ofLower;
      inner[1] = ofLower - 2 * ofUpper;
      outer[0] = ofLower;
      outer[1] = ofUpper;
    }

    double         linear[2];
    double         inner[2];
    double         outer[2];
    std::ptrdiff_t step;
    std::ptrdiff_t below;
    std::ptrdiff_t above;
  };

  static double
  Beyond(const TPixel * p, const Axis & axis)
  {
    return axis.outer[0] * static_cast<double>(p[axis.below]) + axis.outer[1] * static_cast<double>(p[axis.above]);
  }

  const TPixel *                m_Buffer;
  std::array<int, 3>            m_Size;
  std::array<std::ptrdiff_t, 3> m_Stride;
};
} // namespace bone

#endif
