/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneTetraSmoothingParameters_h
#define boneTetraSmoothingParameters_h

#include "boneParameters.h"

namespace bone
{
enum class SmoothingMethod : int
{
  Laplacian = 0, ///< every point to the mean of its neighbours; shrinks, and may invert cells
  Smart = 1,     ///< the same, but a point stays where a cell would invert
  Enhanced = 2 ///< means along the point's own surface, put back on it; weighted back until no cell inverts (paper 2.7)
};

template <>
struct ParameterChoices<SmoothingMethod>
{
  static constexpr std::array<const char *, 3> names = { "laplacian", "smart", "enhanced" };
};

// clang-format off
#define BONE_TETRA_SMOOTHING_PARAMETERS(value, flag) \
  value(SmoothingMethod, method, Method, SmoothingMethod::Enhanced, ParameterRange::Any(), "", "", \
    "enhanced keeps the shape; smart and laplacian shrink it, laplacian may invert cells") \
  value(int, iterations, Iterations, 10, ParameterRange::AtLeast(0), "", "iterations", "Passes over all points") \
  value(double, distanceBound, DistanceBound, 0.3, ParameterRange::LengthOrZero(), "mm", "distance", \
    "How far boundary and interfaces may be faired; 0: not") \
  value(int, fairingIterations, FairingIterations, 10, ParameterRange::AtLeast(0), "", "fairing-iterations", \
    "Steps that fair the surfaces") \
  value(double, weight, Weight, 0.5, ParameterRange::Above(0.0, 0.999), "", "weight", \
    "The paper's alpha: share of the old place in each step back") \
  value(double, angleFloor, AngleFloor, 0.14, ParameterRange::Between(0.0, 1.23), "rad", "angle-floor", \
    "Dihedral angle that no move may go below, unless it was below")
// clang-format on

/** Parameters of TetraSmoothingFilter. */
BONE_PARAMETER_STRUCT(TetraSmoothingParameters, BONE_TETRA_SMOOTHING_PARAMETERS);
} // namespace bone

#endif
