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
  this->Apply(image, { { 0, 0 }, { m_Columns, m_Rows } }, x, y);
}

void
ImageGradient::Apply(const float * image, const PixelBox & box, float * x, float * y) const
{
  const int radius = this->Radius();
  std::fill(x, x + box.GetNumberOfPixels(), 0.0f);
  std::fill(y, y + box.GetNumberOfPixels(), 0.0f);
  const int first = std::max(box.first[0], radius);
  const int count = std::min(box.end[0], m_Columns - radius) - first;
  if (count <= 0)
  {
    return;
  }
  // Along columns of the image first, a row of sums at a time: of the pixels' columns and `radius` more on both sides.
  const auto         used = static_cast<std::size_t>(count) + 2 * static_cast<std::size_t>(radius);
  std::vector<float> smoothed(used);
  std::vector<float> derived(used);
  for (int r = std::max(box.first[1], radius); r < std::min(box.end[1], m_Rows - radius); ++r)
  {
    std::fill(smoothed.begin(), smoothed.end(), 0.0f);
    std::fill(derived.begin(), derived.end(), 0.0f);
    for (int k = -radius; k <= radius; ++k)
    {
      const float * row =
        image + static_cast<std::size_t>(r + k) * static_cast<std::size_t>(m_Columns) + first - radius;
      const float s = m_Smooth[static_cast<std::size_t>(k + radius)];
      const float d = m_Derive[static_cast<std::size_t>(k + radius)];
      for (std::size_t c = 0; c < used; ++c)
      {
        smoothed[c] += s * row[c];
        derived[c] += d * row[c];
      }
    }
    const auto start = static_cast<std::size_t>(r - box.first[1]) * static_cast<std::size_t>(box.Columns()) +
                       static_cast<std::size_t>(first - box.first[0]);
    for (int k = 0; k <= 2 * radius; ++k)
    {
      const float s = m_Smooth[static_cast<std::size_t>(k)];
      const float d = m_Derive[static_cast<std::size_t>(k)];
      for (int c = 0; c < count; ++c)
      {
        x[start + static_cast<std::size_t>(c)] += d * smoothed[static_cast<std::size_t>(c + k)];
        y[start + static_cast<std::size_t>(c)] += s * derived[static_cast<std::size_t>(c + k)];
      }
    }
  }
}
} // namespace bone
