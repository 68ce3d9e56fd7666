/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneDensityFitParameters_h
#define boneDensityFitParameters_h

#include "boneBernstein.h"
#include "boneDensityQuantityChoices.h"

namespace bone
{
/** How an image is interpolated between its voxels. */
enum class DensityInterpolator : int
{
  Linear,
  CubicBSpline
};

template <>
struct ParameterChoices<DensityInterpolator>
{
  static constexpr std::array<const char *, 2> names = { "linear", "bspline" };
};

// clang-format off
#define BONE_DENSITY_FIT_PARAMETERS(value, flag) \
  value(int, degree, Degree, 3, ParameterRange::Between(0, MaximumBernsteinDegree), "", "degree", \
    "Degree of the polynomials") \
  flag(continuous, Continuous, false, "continuous", "One continuous density within each region") \
  flag(continuousGradient, ContinuousGradient, false, "continuous-gradient", \
    "One density of degree 3 within each region whose gradient is continuous too; splits every tetrahedron into 12") \
  value(double, maximumError, MaximumError, 0.0, ParameterRange::NotNegative(), "density units", "max-error", \
    "Lowest degree, up to --degree, whose root mean square error in the tetrahedron is at most this; 0: --degree in all") \
  value(DensityInterpolator, interpolator, Interpolator, DensityInterpolator::Linear, ParameterRange::Any(), "", \
    "interpolator", "Between voxels: linear (its error by curvature is taken off) or bspline (cubic)") \
  value(double, voxelWeight, VoxelWeight, 4.0, ParameterRange::NotNegative(), "", "voxel-weight", \
    "Weight of voxels' own values against the interpolated image") \
  value(double, tikhonov, Tikhonov, 1e-4, ParameterRange::NotNegative(), "", "tikhonov", \
    "Weight of the term that holds control values near those of the degree below") \
  value(double, overshootLimit, OvershootLimit, 8.0, ParameterRange::NotNegativeOrInfinite(), \
    "ranges of the tetrahedron's data", "overshoot-limit", \
    "How far control values may lie beyond a tetrahedron's data") \
  value(double, surfaceMargin, SurfaceMargin, 0.0, ParameterRange::LengthOrZero(), "mm", "surface-margin", \
    "What lies nearer than this to the surface takes the value at this depth") \
  value(double, interfaceMargin, InterfaceMargin, 0.0, ParameterRange::LengthOrZero(), "mm", "interface-margin", \
    "The same for the faces between regions, from either side") \
  flag(holdOut, HoldOut, false, "", "One voxel in five plays no part in the fit") \
  value(DensityQuantity, quantity, Quantity, DensityQuantity::HounsfieldUnit, ParameterRange::Any(), "", "quantity", \
    "What the CT's values are: hu, k2hpo4, ha, ash, apparent")
// clang-format on

/** Parameters of DensityFitFilter. */
BONE_PARAMETER_STRUCT(DensityFitParameters, BONE_DENSITY_FIT_PARAMETERS);
} // namespace bone

#endif
