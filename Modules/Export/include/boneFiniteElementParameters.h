/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneFiniteElementParameters_h
#define boneFiniteElementParameters_h

#include "boneParameters.h"

namespace bone
{
/** What Young's modulus is constant over. */
enum class ModulusField : int
{
  Bins = 0, ///< elements of one bin of moduli, which share a material
  Cells = 1,
  Nodes = 2 ///< interpolated between the nodes
};

template <>
struct ParameterChoices<ModulusField>
{
  static constexpr std::array<const char *, 3> names = { "bins", "cells", "nodes" };
};

// clang-format off
#define BONE_FINITE_ELEMENT_PARAMETERS(value, flag) \
  value(int, order, Order, 2, ParameterRange::Between(1, 2), "", "order", \
    "Order of the elements: 2 for ten nodes, 1 for four, which are too stiff") \
  value(int, bins, Bins, 100, ParameterRange::Between(1, 10000), "", "bins", \
    "Materials at the most: bins of moduli, each as wide in ratio as the next") \
  value(ModulusField, modulusField, ModulusField, ModulusField::Bins, ParameterRange::Any(), "", "modulus", \
    "What Young's modulus is constant over: bins, cells (FEBio), or nodes (Abaqus, CalculiX), between which it is " \
    "interpolated") \
  value(double, leastModulus, LeastModulus, 1.0, ParameterRange::Above(0.0, 1e6), "MPa", "least-modulus", \
    "Young's modulus of softer elements is raised to it") \
  value(double, poissonRatio, PoissonRatio, 0.3, ParameterRange::Between(0.0, 0.495), "", "poisson", \
    "Poisson's ratio of all materials")
// clang-format on

/** Parameters of MakeFiniteElements. */
BONE_PARAMETER_STRUCT(FiniteElementParameters, BONE_FINITE_ELEMENT_PARAMETERS);
} // namespace bone

#endif
