/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneModelEvaluation_h
#define boneModelEvaluation_h

#include "bonePointAlignment.h"
#include "boneTrainingSet.h"

#include <Eigen/Core>

#include <cstdint>
#include <functional>
#include <vector>

namespace bone
{
/** A mean over subjects or samples and its standard error. */
struct MeanWithError
{
  double mean{ 0.0 };
  double standardError{ 0.0 };
};

/** Mean and standard error (standard deviation over the square root of the count; 0 for one value). */
MeanWithError
Summarize(const std::vector<double> & values);

/** Difference of two densities on one mesh, over its volume, in density units. */
struct DensityDifference
{
  double bias{ 0.0 };         ///< mean of first minus second
  double meanAbsolute{ 0.0 }; ///< mean of the absolute difference
  double rootMeanSquare{ 0.0 };
};

/** How good a model with a number of modes is (M. A. Styner et al., doi:10.1007/978-3-540-45087-0_6). */
struct ModelQuality
{
  int           modes{ 0 };
  double        compactness{ 0.0 }; ///< share of the variance that the modes explain
  MeanWithError generalisation;     ///< error of a subject left out, projected onto the model of the others
  MeanWithError specificity;        ///< error of a random sample to the nearest subject
};

/** Of densities, errors of subjects left out, one a subject. */
struct DensityQuality
{
  int           modes{ 0 };
  double        compactness{ 0.0 };
  MeanWithError bias;
  MeanWithError meanAbsolute;
  MeanWithError rootMeanSquare;
};

/** How an evaluation is made. */
struct EvaluationParameters
{
  std::vector<int> modes{ 0, 1, 5, 10, 15 }; ///< numbers of modes; those above #subjects - 2 are left out
  AlignmentKind    alignment{ AlignmentKind::Rigid };
  int              samples{ 200 }; ///< random samples of specificity; 0: leave it out
  std::uint64_t    seed{ 1 };
};

/** \brief Compactness, generalisation by leave-one-out and specificity of shapes, mm: mean distance of points.
 *
 * The shapes (#subjects of #p points) are aligned first. A subject left out is aligned to the mean of the others. The
 * model of the others is that of all with the subject taken out of their sum of squares and products: exact for up to
 * 256 subjects, and beyond within the span of 128 directions found from all of them. Time is linear in the number of
 * subjects. Throws std::invalid_argument for fewer than three. */
std::vector<ModelQuality>
EvaluateShapes(std::vector<std::vector<Vector3>> shapes, const EvaluationParameters & parameters);

/** Calls visit(coefficients) for every subject, in order; it is called once a pass. */
using CoefficientPass = std::function<void(const std::function<void(const std::vector<double> &)> & visit)>;

/** \brief Compactness and generalisation by leave-one-out of densities, in density units over the volume of `mesh`.
 *
 * `count` subjects, who are not kept: there are two passes. `mesh` gives degree and volumes. Models of the others as
 * of \ref EvaluateShapes. Throws std::invalid_argument for fewer than three subjects or a mesh that does not match. */
std::vector<DensityQuality>
EvaluateDensities(const MeshArrays &           mesh,
                  std::size_t                  count,
                  const CoefficientPass &      subjects,
                  const EvaluationParameters & parameters);

/** Difference of two coefficient vectors on the mesh. */
DensityDifference
CompareDensities(const MeshArrays & mesh, const Eigen::VectorXd & first, const Eigen::VectorXd & second);
} // namespace bone

#endif
