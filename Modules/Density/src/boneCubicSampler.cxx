/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCubicSampler.h"

#include <algorithm>
#include <stdexcept>

namespace bone
{
namespace
{
/** Values of a line to cubic B-spline coefficients, mirrored at both ends. */
void
FilterLine(std::vector<double> & line)
{
  const double pole = std::sqrt(3.0) - 2;
  const auto   size = static_cast<std::ptrdiff_t>(line.size());
  if (size == 1)
  {
    return;
  }
  for (double & x : line)
  {
    x *= (1 - pole) * (1 - 1 / pole);
  }
  // The sum over the mirrored line to the left of its start, to rounding.
  const std::ptrdiff_t period = 2 * size - 2;
  double               sum = 0, power = 1;
  for (std::ptrdiff_t i = 0; i < std::min<std::ptrdiff_t>(period, 32); ++i)
  {
    sum += power * line[i < size ? i : period - i];
    power *= pole;
  }
  line[0] = sum / (period < 32 ? 1 - power : 1.0);
  for (std::ptrdiff_t i = 1; i < size; ++i)
  {
    line[i] += pole * line[i - 1];
  }
  line[size - 1] = pole / (pole * pole - 1) * (line[size - 1] + pole * line[size - 2]);
  for (std::ptrdiff_t i = size - 2; i >= 0; --i)
  {
    line[i] = pole * (line[i + 1] - line[i]);
  }
}

int
Mirror(int i, int size)
{
  if (size == 1)
  {
    return 0;
  }
  const int period = 2 * size - 2;
  i = std::abs(i) % period;
  return i < size ? i : period - i;
}
} // namespace

CubicSampler::CubicSampler(std::vector<float> values, const std::array<int, 3> & size, const Execution & execution)
  : m_Coefficients(std::move(values))
  , m_Size(size)
{
  const std::array<std::size_t, 3> n = {
    { static_cast<std::size_t>(size[0]), static_cast<std::size_t>(size[1]), static_cast<std::size_t>(size[2]) }
  };
  if (m_Coefficients.size() != n[0] * n[1] * n[2])
  {
    throw std::invalid_argument("The number of voxels is not that of the size.");
  }
  const std::array<std::size_t, 3> stride = { { 1, n[0], n[0] * n[1] } };
  for (int axis = 0; axis < 3; ++axis)
  {
    const int u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2;
    execution.Part(axis / 3.0, (axis + 1) / 3.0).For(n[v], [&](std::size_t j) {
      std::vector<double> line(n[axis]);
      for (std::size_t i = 0; i < n[u]; ++i)
      {
        float * start = &m_Coefficients[i * stride[u] + j * stride[v]];
        for (std::size_t k = 0; k < n[axis]; ++k)
        {
          line[k] = start[k * stride[axis]];
        }
        FilterLine(line);
        for (std::size_t k = 0; k < n[axis]; ++k)
        {
          start[k * stride[axis]] = static_cast<float>(line[k]);
        }
      }
    });
  }
}

double
CubicSampler::operator()(const Vector3 & index) const
{
  std::array<std::array<double, 4>, 3>         weight;
  std::array<std::array<std::ptrdiff_t, 4>, 3> offset;
  std::ptrdiff_t                               stride = 1;
  for (int axis = 0; axis < 3; ++axis)
  {
    const double x = std::min(std::max(index[axis], 0.0), m_Size[axis] - 1.0);
    const double whole = std::floor(x), f = x - whole, g = 1 - f;
    weight[axis] = {
      { g * g * g / 6, (4 - 6 * f * f + 3 * f * f * f) / 6, (4 - 6 * g * g + 3 * g * g * g) / 6, f * f * f / 6 }
    };
    for (int m = 0; m < 4; ++m)
    {
      offset[axis][m] = stride * Mirror(static_cast<int>(whole) - 1 + m, m_Size[axis]);
    }
    stride *= m_Size[axis];
  }
  double value = 0;
  for (int k = 0; k < 4; ++k)
  {
    for (int j = 0; j < 4; ++j)
    {
      const float * row = m_Coefficients.data() + offset[2][k] + offset[1][j];
      double        sum = 0;
      for (int i = 0; i < 4; ++i)
      {
        sum += weight[0][i] * row[offset[0][i]];
      }
      value += weight[2][k] * weight[1][j] * sum;
    }
  }
  return value;
}
} // namespace bone
