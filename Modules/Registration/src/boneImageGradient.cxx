/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneImageGradient.h"

#include <algorithm>
#include <cmath>

namespace bone
{
ImageGradient::ImageGradient(int columns, int rows, double sigma)
  : m_Columns(columns)
  , m_Rows(rows)
{
  const int           radius = std::max(1, static_cast<int>(std::ceil(2.5 * sigma)));
  std::vector<double> smooth;
  double              sum = 0.0;
  double              moment = 0.0;
  for (int i = -radius; i <= radius; ++i)
  {
    smooth.push_back(std::exp(-0.5 * i * i / (sigma * sigma)));
    sum += smooth.back();
    moment += i * i * smooth.back();
  }
  for (int i = -radius; i <= radius; ++i)
  {
    const double weight = smooth[static_cast<std::size_t>(i + radius)];
    m_Smooth.push_back(static_cast<float>(weight / sum));
    m_Derive.push_back(static_cast<float>(i * weight / moment));
  }
}

void
ImageGradient::Apply(const float * image, float * x, float * y) const
{
  const int         radius = this->Radius();
  const std::size_t stride = static_cast<std::size_t>(m_Columns);
  std::fill(x, x + stride * m_Rows, 0.0f);
  std::fill(y, y + stride * m_Rows, 0.0f);
  if (m_Columns <= 2 * radius)
  {
    return;
  }
  // Along columns of the image first, a row of sums at a time.
  std::vector<float> smoothed(stride);
  std::vector<float> derived(stride);
  for (int r = radius; r < m_Rows - radius; ++r)
  {
    std::fill(smoothed.begin(), smoothed.end(), 0.0f);
    std::fill(derived.begin(), derived.end(), 0.0f);
    for (int k = -radius; k <= radius; ++k)
    {
      const float * row = image + static_cast<std::size_t>(r + k) * stride;
      const float   s = m_Smooth[static_cast<std::size_t>(k + radius)];
      const float   d = m_Derive[static_cast<std::size_t>(k + radius)];
      for (std::size_t c = 0; c < stride; ++c)
      {
        smoothed[c] += s * row[c];
        derived[c] += d * row[c];
      }
    }
    float *           alongColumns = x + static_cast<std::size_t>(r) * stride;
    float *           alongRows = y + static_cast<std::size_t>(r) * stride;
    const std::size_t first = static_cast<std::size_t>(radius);
    for (int k = -radius; k <= radius; ++k)
    {
      const float s = m_Smooth[static_cast<std::size_t>(k + radius)];
      const float d = m_Derive[static_cast<std::size_t>(k + radius)];
      for (std::size_t c = first; c < stride - first; ++c)
      {
        alongColumns[c] += d * smoothed[c + static_cast<std::size_t>(k + radius) - first];
        alongRows[c] += s * derived[c + static_cast<std::size_t>(k + radius) - first];
      }
    }
  }
}
} // namespace bone
