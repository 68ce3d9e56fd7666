/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneMetricPixels.h"

#include <algorithm>
#include <iterator>
#include <stdexcept>
#include <string>

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

PixelBox
BoxOf(const std::vector<const float *> & images, const std::array<int, 2> & size)
{
  PixelBox   box{ size, { 0, 0 } };
  const auto shows = [](float x) { return x != 0.0f; };
  for (const float * image : images)
  {
    for (int r = 0; r < size[1]; ++r)
    {
      const float * row = image + static_cast<std::size_t>(r) * static_cast<std::size_t>(size[0]);
      const float * end = row + size[0];
      const float * first = std::find_if(row, end, shows);
      if (first != end)
      {
        const auto last = std::find_if(std::make_reverse_iterator(end), std::make_reverse_iterator(first), shows);
        box.first = { std::min(box.first[0], static_cast<int>(first - row)), std::min(box.first[1], r) };
        box.end = { std::max(box.end[0], static_cast<int>(last.base() - row)), std::max(box.end[1], r + 1) };
      }
    }
  }
  return box.end[0] > 0 ? box : PixelBox{};
}

CountedGradient::CountedGradient(const RadiographView & target, double sigma)
  : m_Size(target.view.size)
  , m_Gradient(target.view.size[0], target.view.size[1], sigma)
  , m_Weights(CountedWeights(target, m_Gradient.Radius()))
{}

GradientComponents
CountedGradient::Apply(const float * image) const
{
  return this->Apply(image, { { 0, 0 }, m_Size });
}

GradientComponents
CountedGradient::Apply(const float * image, const PixelBox & box) const
{
  GradientComponents result{ std::vector<float>(box.GetNumberOfPixels()), std::vector<float>(box.GetNumberOfPixels()) };
  m_Gradient.Apply(image, box, result[0].data(), result[1].data());
  const auto columns = static_cast<std::size_t>(box.Columns());
  for (auto & component : result)
  {
    auto at = component.begin();
    for (int r = box.first[1]; r < box.end[1]; ++r)
    {
      const float * weights = &m_Weights[static_cast<std::size_t>(r) * static_cast<std::size_t>(m_Size[0]) +
                                         static_cast<std::size_t>(box.first[0])];
      at = std::transform(at, at + static_cast<std::ptrdiff_t>(columns), weights, at, [](float d, float w) {
        return w > 0.0f ? d : 0.0f;
      });
    }
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
