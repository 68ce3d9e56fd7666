/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneResidualModes_h
#define boneResidualModes_h

#include "boneStatisticalModel.h"

namespace bone
{
/** \brief What the modes of a set of subjects leave of a new one, by leave-one-out.
 *
 * `scores` (#subjects by #modes, standard deviations) are those of the subjects. Each column of the result is a subject
 * less its nearest vector in the affine hull of the others, in units of the modes: modes * column is the vector. */
Eigen::MatrixXd
LeaveOneOutResiduals(const PrincipalModes & modes, const Eigen::MatrixXd & scores);

/** \brief Smooth displacements with the variance of what an atlas' modes of shape leave of a new subject.
 *
 * The modes are those of SmoothModes (`length`, mm, `modes` at the most), less the small rigid motions in them: shapes
 * are aligned. Their variances, alike for each three of one shape, are the most likely ones of what the atlas' own
 * subjects, each less its projection on the modes of the others, have of them (leave-one-out, expectation
 * maximisation): the others take a part of each smooth mode, and what they take says nothing of its variance. The total
 * variance is of all that is left, in these modes or not, with that of the modes which the atlas left out; these raise
 * the variances in proportion. Throws std::invalid_argument where the atlas has the scores of fewer than four subjects,
 * and what SmoothModes throws. */
PrincipalModes
ResidualModes(const StatisticalModelContent & atlas, double length, int modes);
} // namespace bone

#endif
