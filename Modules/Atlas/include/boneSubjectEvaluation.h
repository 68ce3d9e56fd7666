/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneSubjectEvaluation_h
#define boneSubjectEvaluation_h

#include "boneModelEvaluation.h"
#include "boneStatisticalModel.h"

namespace bone
{
/** How usual a vector is among those of a normal distribution of independent modes. */
struct Usualness
{
  Eigen::VectorXd scores;             ///< coefficients of the modes, standard deviations
  double          distance{ 0.0 };    ///< Mahalanobis distance from the mean: norm of the scores
  double          probability{ 1.0 }; ///< of a subject that is as far off or further (chi-squared distribution)
};

/** \struct SubjectEvaluation
 * \brief A subject against an atlas. */
struct SubjectEvaluation
{
  Usualness shape;
  double    shapeResidual{ 0.0 }; ///< mean distance of its points from the nearest shape of the modes, mm
  /** What the atlas leaves of a subject of its own, left out (root mean square of points, mm); 0 where it has fewer
   * than four subjects. A residual far above it is of a shape that the atlas has not seen. */
  double shapeTypical{ 0.0 };

  bool      hasDensity{ false }; ///< subject and atlas have one
  Usualness density;
  DensityDifference
    densityResidual; ///< of the subject from the nearest density of the modes, over the subject's volume
};

/** \brief Coefficients, residual, and how unusual shape and density of a subject are.
 *
 * `subject` has the atlas' topology and, where both have a density, its degree. Its shape is aligned to the atlas' mean
 * first. Throws std::invalid_argument where the topology or the degree is another. */
SubjectEvaluation
EvaluateSubject(const StatisticalModelContent & atlas, const MeshArrays & subject);
} // namespace bone

#endif
