/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneTilingParameters_h
#define boneTilingParameters_h

#include "boneParameters.h"

namespace bone
{
/** What the tiling minimises (paper 2.3): see the children of TilingMetric. */
enum class TilingMetricKind : int
{
  Span,
  Area,
  Volume,
  Density,
  Combined
};

template <>
struct ParameterChoices<TilingMetricKind>
{
  static constexpr std::array<const char *, 5> names = { "span", "area", "volume", "density", "combined" };
};

// clang-format off
#define BONE_TILING_PARAMETERS(value, flag) \
  value(TilingMetricKind, metric, Metric, TilingMetricKind::Combined, ParameterRange::Any(), "", "metric", \
    "What the tiling minimises (volume: maximises)")
// clang-format on

/** Parameters of ContourTilingMeshSource. */
BONE_PARAMETER_STRUCT(TilingParameters, BONE_TILING_PARAMETERS);
} // namespace bone

#endif
