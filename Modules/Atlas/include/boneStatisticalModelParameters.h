/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneStatisticalModelParameters_h
#define boneStatisticalModelParameters_h

#include "boneAlignmentKind.h"

namespace bone
{
// clang-format off
#define BONE_STATISTICAL_MODEL_PARAMETERS(value, flag) \
  value(AlignmentKind, alignment, Alignment, AlignmentKind::Rigid, ParameterRange::Any(), "", "alignment", \
    "How shapes are brought together: none, rigid, or similarity, which takes size out of the shape modes") \
  value(double, varianceProportion, VarianceProportion, 0.98, ParameterRange::Above(0.0, 1.0), "", "variance", \
    "Share of the variance of shape, and of density, that the modes explain; 1 keeps full rank") \
  value(int, maximumModes, MaximumModes, 0, ParameterRange::AtLeast(0), "", "modes", \
    "Largest number of modes of each; 0: no limit") \
  flag(combined, Combined, false, "combined", "Combined modes of shape and density too") \
  flag(coefficientProduct, CoefficientProduct, false, "coefficient-product", \
    "Modes of density by coefficients, which count alike as in the paper, in place of integrals over the volume") \
  value(double, withinCellWeight, WithinCellWeight, 0.25, ParameterRange::Above(0.0, 1.0), "", "within-cell-weight", \
    "In integrals over the volume: how much the variation within a tetrahedron counts against its mean; 1: the integral") \
  value(double, outlierThreshold, OutlierThreshold, 3.5, ParameterRange::NotNegativeOrInfinite(), "", \
    "outlier-threshold", "Modified z-score of the distance to the mean above which a subject is an outlier; 0: none is") \
  flag(rejectOutliers, RejectOutliers, false, "reject-outliers", "Leave outliers out") \
  value(double, memory, Memory, 1024.0, ParameterRange::NotNegative(), "MB", "memory", \
    "For subjects and modes held at once. Where not all subjects fit, or there are more than 1023, modes are found in " \
    "the span of half as many directions as fit, 512 or twice the largest number of modes at most")
// clang-format on

/** Parameters of StatisticalModelEstimator. */
BONE_PARAMETER_STRUCT(StatisticalModelParameters, BONE_STATISTICAL_MODEL_PARAMETERS);
} // namespace bone

#endif
