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

/** How several pieces of a slice are tiled with one of the next (paper 2.6, contour branching). */
enum class BranchingKind : int
{
  Composite, ///< the several are joined by bridges at the closest points
  Splitting, ///< the one is split into as many parts, each tiled with its counterpart
  Filling    ///< the space between the slices is filled
};

template <>
struct ParameterChoices<BranchingKind>
{
  static constexpr std::array<const char *, 3> names = { "composite", "splitting", "filling" };
};

// clang-format off
#define BONE_TILING_PARAMETERS(value, flag) \
  value(TilingMetricKind, metric, Metric, TilingMetricKind::Combined, ParameterRange::Any(), "", "metric", \
    "What the tiling minimises (volume: maximises)") \
  value(BranchingKind, branching, Branching, BranchingKind::Composite, ParameterRange::Any(), "", "branching", \
    "How several contours are tiled with one: joined by bridges, the one split into parts, or the slab filled")
// clang-format on

/** Parameters of ContourTilingMeshSource. */
BONE_PARAMETER_STRUCT(TilingParameters, BONE_TILING_PARAMETERS);
} // namespace bone

#endif
