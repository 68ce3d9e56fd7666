/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneRadiographView_h
#define boneRadiographView_h

#include "boneXRayGeometry.h"

#include <vector>

namespace bone
{
/** \struct RadiographView
 * \brief One X-ray as registration takes it: line integrals, row by row, with the geometry they were seen in. */
struct RadiographView
{
  XRayGeometry::View view;
  std::vector<float> values;  ///< columns x rows line integrals, in any unit
  std::vector<float> weights; ///< columns x rows, 0 (unknown) to 1; empty: all 1

  std::size_t
  GetNumberOfPixels() const
  {
    return static_cast<std::size_t>(view.size[0]) * static_cast<std::size_t>(view.size[1]);
  }
};

/** The view with pixels `factor` times as wide, each the mean of those it covers, weighted; its weight is their mean
 * weight. Columns and rows at the far border that fill no pixel are left out. */
RadiographView
ReduceView(const RadiographView & view, int factor);

/** The factor by which the longer side becomes nearest to so many pixels; 1 where it has no more. */
int
ReductionTo(const XRayGeometry::View & view, int pixels);
} // namespace bone

#endif
