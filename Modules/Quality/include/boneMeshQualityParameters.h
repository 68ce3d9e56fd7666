/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneMeshQualityParameters_h
#define boneMeshQualityParameters_h

#include "boneParameters.h"

namespace bone
{
// clang-format off
#define BONE_MESH_QUALITY_PARAMETERS(value, flag) \
  value(int, label, Label, 0, ParameterRange::Any(), "", "", \
    "The bone's value in the label map; 0: every value but 0") \
  value(int, iterations, Iterations, 4, ParameterRange::AtLeast(0), "", "iterations", \
    "Smoothing iterations at the start") \
  value(double, distanceBound, DistanceBound, 0.3, ParameterRange::LengthOrZero(), "mm", "distance", \
    "How far boundary and interfaces may be from the first ones; 0: they stay as they are") \
  value(int, fairingIterations, FairingIterations, 10, ParameterRange::AtLeast(0), "", "fairing-iterations", \
    "Steps that fair the surfaces") \
  value(int, rounds, Rounds, 4, ParameterRange::AtLeast(0), "", "rounds", \
    "Rounds of smoothing, swaps, repair and optimisation") \
  value(double, targetAngle, TargetAngle, 0.44, ParameterRange::Above(0.0, 1.23), "rad", "target-angle", \
    "Cells with a smaller dihedral angle are swapped and their inner points optimised") \
  value(double, gradation, Gradation, 0.65, ParameterRange::NotNegative(), "mm a mm", "gradation", \
    "Growth of cells inward from the surfaces; 0: no points are added") \
  value(int, optimizationPasses, OptimizationPasses, 1, ParameterRange::AtLeast(0), "", "optimization-passes", \
    "Passes of optimisation a round") \
  value(double, sliverFactor, SliverFactor, 4.0, ParameterRange::AtLeast(1.0), "", "sliver-factor", \
    "How many times the distance bound surfaces may go to mend the worst cells") \
  value(double, stiffness, Stiffness, 0.08, ParameterRange::NotNegative(), "", "stiffness", \
    "Resistance of surfaces to bending where they are fitted")
// clang-format on

/** Parameters of MeshQualityFilter. */
BONE_PARAMETER_STRUCT(MeshQualityParameters, BONE_MESH_QUALITY_PARAMETERS);
} // namespace bone

#endif
