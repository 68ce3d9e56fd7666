/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneRadiographView.h"

#include <algorithm>
#include <cmath>

namespace bone
{
RadiographView
ReduceView(const RadiographView & view, int factor)
{
  if (factor <= 1)
  {
    return view;
  }
  RadiographView reduced;
  reduced.view = view.view;
  const std::array<int, 2> size{ { std::max(1, view.view.size[0] / factor), std::max(1, view.view.size[1] / factor) } };
  const double             shift = 0.5 * (factor - 1);
  reduced.view.size = size;
  reduced.view.spacing = factor * view.view.spacing;
  reduced.view.detectorOrigin +=
    shift * (view.view.spacing[0] * view.view.detectorU + view.view.spacing[1] * view.view.detectorV);
  reduced.values.assign(reduced.GetNumberOfPixels(), 0.0f);
  reduced.weights.assign(reduced.GetNumberOfPixels(), 0.0f);
  for (int r = 0; r < size[1]; ++r)
  {
    for (int c = 0; c < size[0]; ++c)
    {
      double sum = 0.0;
      double weight = 0.0;
      for (int y = r * factor; y < std::min((r + 1) * factor, view.view.size[1]); ++y)
      {
        for (int x = c * factor; x < std::min((c + 1) * factor, view.view.size[0]); ++x)
        {
          const std::size_t i = static_cast<std::size_t>(y) * view.view.size[0] + x;
          const double      w = view.weights.empty() ? 1.0 : view.weights[i];
          sum += w > 0.0 ? w * view.values[i] : 0.0;
          weight += w;
        }
      }
      const std::size_t at = static_cast<std::size_t>(r) * size[0] + c;
      reduced.values[at] = weight > 0.0 ? static_cast<float>(sum / weight) : 0.0f;
      reduced.weights[at] = static_cast<float>(weight / (factor * factor));
    }
  }
  return reduced;
}

int
ReductionTo(const XRayGeometry::View & view, int pixels)
{
  const int longer = std::max(view.size[0], view.size[1]);
  return std::max(1, static_cast<int>(std::lround(static_cast<double>(longer) / pixels)));
}
} // namespace bone
