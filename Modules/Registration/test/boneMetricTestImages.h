/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneMetricTestImages_h
#define boneMetricTestImages_h

#include "boneRadiographMetric.h"

#include <cmath>
#include <random>

namespace bone
{
/** A smooth image: the sum of twelve random waves of random heights, up to `height` each. */
inline std::vector<float>
RandomWaves(int columns, int rows, unsigned int seed, double height)
{
  std::mt19937                           random(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<float>                     image(static_cast<std::size_t>(columns) * rows, 0.0f);
  for (int wave = 0; wave < 12; ++wave)
  {
    const double a = uniform(random), b = uniform(random), phase = 3.0 * uniform(random), h = uniform(random);
    for (int i = 0; i < columns * rows; ++i)
    {
      const double phaseAt = 0.6 * a * (i % columns) + 0.6 * b * (i / columns) + phase;
      image[static_cast<std::size_t>(i)] += static_cast<float>(height * h * std::sin(phaseAt));
    }
  }
  return image;
}

/** The images as metrics take them. */
inline std::vector<float *>
PointersTo(std::vector<std::vector<float>> & images)
{
  std::vector<float *> pointers;
  for (auto & image : images)
  {
    pointers.push_back(image.data());
  }
  return pointers;
}

/** The derivative of a metric's cost along a change of the image. */
inline double
CentralDifference(const RadiographMetric &   metric,
                  const std::vector<float> & image,
                  const std::vector<float> & change,
                  double                     step)
{
  double costs[2];
  for (int side = 0; side < 2; ++side)
  {
    auto moved = image;
    for (std::size_t i = 0; i < moved.size(); ++i)
    {
      moved[i] += static_cast<float>(side == 0 ? -step : step) * change[i];
    }
    costs[side] = metric.Evaluate(moved.data());
  }
  return (costs[1] - costs[0]) / (2.0 * step);
}
} // namespace bone

#endif
