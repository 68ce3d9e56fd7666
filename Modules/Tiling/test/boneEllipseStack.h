/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneEllipseStack_h
#define boneEllipseStack_h

#include "boneContourStack.h"

#include <cmath>
#include <vector>

namespace bone
{
constexpr double Pi = 3.14159265358979323846;

struct Loop
{
  Vector2 centre;
  double  rx, ry;
  int     layer, region;
};

/** A stack of ellipses: one list of loops a slice, `points` on each. Holes run clockwise. */
inline ContourStack::Pointer
MakeStack(const std::vector<std::vector<Loop>> & slices, double step, int points = 24)
{
  ContourStack::SliceContainer container;
  for (std::size_t k = 0; k < slices.size(); ++k)
  {
    ContourSlice slice;
    slice.origin = Vector3(0, 0, step * static_cast<double>(k));
    for (const Loop & loop : slices[k])
    {
      Contour contour;
      contour.layer = loop.layer;
      contour.region = loop.region;
      contour.id = static_cast<int>(slice.contours.size());
      for (int i = 0; i < points; ++i)
      {
        const double t = (loop.region == 0 ? -1 : 1) * 2 * Pi * i / points;
        contour.points.emplace_back(
          loop.centre.x() + loop.rx * std::cos(t), loop.centre.y() + loop.ry * std::sin(t), slice.origin.z());
      }
      slice.contours.push_back(contour);
    }
    container.push_back(slice);
  }
  auto stack = ContourStack::New();
  stack->SetSlices(container);
  return stack;
}
} // namespace bone

#endif
