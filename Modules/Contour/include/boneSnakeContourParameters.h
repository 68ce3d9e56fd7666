/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneSnakeContourParameters_h
#define boneSnakeContourParameters_h

#include "boneParameters.h"

namespace bone
{
/** Least distance between nested contours, mm, where none is given. */
constexpr double LeastLayerDistance = 0.8;

// clang-format off
#define BONE_SNAKE_CONTOUR_PARAMETERS(value, flag) \
  value(unsigned int, axis, Axis, 2, ParameterRange::Between(0, 2), "", "", \
    "Image axis, 0 to 2, that the slices follow one another along") \
  value(double, sliceStep, SliceStep, 0.0, ParameterRange::LengthOrZero(), "mm", "", \
    "Distance of slices; 0: every slice of the image. Other planes are interpolated; with a label the distance is made " \
    "smaller as needed for the first and last plane to fall on the label's first and last slice") \
  value(int, label, Label, 0, ParameterRange::Any(), "", "", \
    "The bone's value in the label map; 0: every value but 0") \
  flag(refineLabelOutline, RefineLabelOutline, false, "refine", \
    "Move the label's outline to the edges of the CT; else the contours keep the label's area") \
  value(double, refineDistance, RefineDistance, 0.0, ParameterRange::LengthOrZero(), "mm", "refine-distance", \
    "Bound on that motion; 0: half a pixel, as far as a label is off at its best") \
  flag(followLabel, FollowLabel, false, "follow", \
    "The label map marks some slices only: follow the bone from them on the others") \
  value(double, elasticity, Elasticity, 0.02, ParameterRange::NotNegative(), "mm^2", "elasticity", \
    "Snake: weight of the squared first derivative") \
  value(double, rigidity, Rigidity, 0.3, ParameterRange::NotNegative(), "mm^4", "rigidity", \
    "Snake: weight of the squared second derivative") \
  value(double, externalWeight, ExternalWeight, 1.0, ParameterRange::Positive(), "", "external-weight", \
    "Snake: weight of the image's force") \
  value(int, maximumNumberOfIterations, MaximumNumberOfIterations, 200, ParameterRange::AtLeast(1), "", \
    "max-iterations", "Snake: iterations at most") \
  value(double, convergenceTolerance, ConvergenceTolerance, 0.01, ParameterRange::Length(), "mm", "convergence", \
    "Snake: converged when the root mean square motion of the points is less") \
  value(double, minimumEdgeSlope, MinimumEdgeSlope, 40.0, ParameterRange::Positive(), "HU/mm", "edge-slope", \
    "Least slope of an edge") \
  value(int, numberOfLayers, NumberOfLayers, 3, ParameterRange::Between(1, 3), "", "layers", \
    "1 periosteal, 2 with endosteal, 3 with medullary contours") \
  value(double, minimumLayerDistance, MinimumLayerDistance, 0.0, ParameterRange::LengthOrZero(), "mm", \
    "layer-distance", "Least distance between a contour and the next inside it; 0: 0.8 mm or a pixel, whichever is more") \
  value(double, minimumContourArea, MinimumContourArea, 4.0, ParameterRange::NotNegative(), "mm^2", "contour-area", \
    "Contours and holes of less area are left out") \
  flag(keepSmallPieces, KeepSmallPieces, false, "keep-small", \
    "Keep pieces and holes of a single slice, and bodies of few slices or little volume") \
  value(double, boneThreshold, BoneThreshold, 150.0, ParameterRange::Any(), "HU", "bone-threshold", \
    "What never reaches it is no bone") \
  value(double, endostealThreshold, EndostealThreshold, 0.0, ParameterRange::NotNegative(), "HU", \
    "endosteal-threshold", "End of the cortex; 0: half-way from the local maximum to the level inside") \
  value(double, medullaryThreshold, MedullaryThreshold, 40.0, ParameterRange::Any(), "HU", "medullary-threshold", \
    "The medullary cavity lies below") \
  value(double, maximumCorticalThickness, MaximumCorticalThickness, 12.0, ParameterRange::Length(), "mm", \
    "cortical-thickness", "Depth to which the end of the cortex is sought")
// clang-format on

/** Parameters of SnakeContourFilter. */
BONE_PARAMETER_STRUCT(SnakeContourParameters, BONE_SNAKE_CONTOUR_PARAMETERS);
} // namespace bone

#endif
