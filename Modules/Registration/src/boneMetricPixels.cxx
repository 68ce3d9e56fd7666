/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneMetricPixels.h"

#include <algorithm>
#include <stdexcept>

namespace bone
{
std::vector<float>
CountedWeights(const RadiographView & target, int radius)
{
  const auto        size = target.view.size;
  const std::size_t pixels = size[0] > 0 && size[1] > 0 ? target.GetNumberOfPixels() : 0;
  if (target.values.size() != pixels || (!target.weights.empty() && target.weights.size() != pixels))
  {
    throw std::invalid_argument("an X-ray of " + std::to_string(size[0]) + " by " + std::to_string(size[1]) +
                                " pixels has " + std::to_string(target.values.size()) + " values and " +
                                std::to_string(target.weights.size()) + " weights");
  }
  std::vector<float> counted(pixels, 0.0f);
  for (int r = radius; r < size[1] - radius; ++r)
  {
    for (int c = radius; c < size[0] - radius; ++c)
    {
      float least = 1.0f;
      for (int y = r - radius; y <= r + radius && !target.weights.empty(); ++y)
      {
        const float * row = &target.weights[static_cast<std::size_t>(y) * size[0]];
        for (int x = c - radius; x <= c + radius; ++x)
        {
          least = std::min(least, row[x] > 0.0f ? row[x] : 0.0f);
        }
      }
      counted[static_cast<std::size_t>(r) * size[0] + c] = least;
    }
  }
  if (std::none_of(counted.begin(), counted.end(), [](float w) { return w > 0.0f; }))
  {
    throw std::invalid_argument("no pixel of the X-ray counts: the mask leaves nothing, or the image has less than " +
                                std::to_string(2 * radius + 1) + " columns or rows");
  }
  return counted;
}

CountedGradient::CountedGradient(const RadiographView & target, double sigma)
  : m_Gradient(target.view.size[0], target.view.size[1], sigma)
  , m_Weights(CountedWeights(target, m_Gradient.Radius()))
{}

GradientComponents
CountedGradient::Apply(const float * image) const
{
  GradientComponents result{ std::vector<float>(m_Weights.size()), std::vector<float>(m_Weights.size()) };
  m_Gradient.Apply(image, result[0].data(), result[1].data());
  for (auto & component : result)
  {
    std::transform(component.begin(), component.end(), m_Weights.begin(), component.begin(), [](float d, float w) {
      return w > 0.0f ? d : 0.0f;
    });
  }
  return result;
}

GramSum::GramSum(Eigen::Index columns)
  : m_Product(columns, columns)
  , m_Sum(Eigen::MatrixXd::Zero(columns, columns))
{}

void
GramSum::Add(const Eigen::MatrixXf & part, Eigen::Index rows)
{
  m_Product.setZero();
  m_Product.selfadjointView<Eigen::Lower>().rankUpdate(part.topRows(rows).transpose());
  m_Sum += m_Product.cast<double>();
}

Eigen::MatrixXd
GramSum::Get() const
{
  return m_Sum.selfadjointView<Eigen::Lower>();
}
} // namespace bone
