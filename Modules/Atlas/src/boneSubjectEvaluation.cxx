/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSubjectEvaluation.h"

#include "bonePointAlignment.h"
#include "boneResidualModes.h"

#include <boost/math/distributions/chi_squared.hpp>

#include <cmath>
#include <stdexcept>

namespace bone
{
namespace
{
Usualness
ScoreOf(const PrincipalModes & modes, const Eigen::VectorXd & y)
{
  Usualness result;
  result.scores = modes.Project(y);
  result.distance = result.scores.norm();
  if (result.scores.size() > 0)
  {
    const boost::math::chi_squared distribution(static_cast<double>(result.scores.size()));
    result.probability = boost::math::cdf(boost::math::complement(distribution, result.distance * result.distance));
  }
  return result;
}

double
TypicalResidual(const StatisticalModelContent & atlas)
{
  constexpr Eigen::Index least = 4;
  const Eigen::Index     subjects = atlas.shapeScores.rows();
  if (subjects < least)
  {
    return 0.0;
  }
  const double left =
    LeaveOneOutResiduals(atlas.shape, atlas.shapeScores).squaredNorm() / static_cast<double>(subjects);
  const double dropped = std::max(0.0, atlas.shape.totalVariance - atlas.shape.variances.sum());
  return std::sqrt((left + dropped) / static_cast<double>(atlas.mean.points.size()));
}
} // namespace

SubjectEvaluation
EvaluateSubject(const StatisticalModelContent & atlas, const MeshArrays & subject)
{
  if (subject.tetrahedra != atlas.mean.tetrahedra || subject.points.size() != atlas.mean.points.size())
  {
    throw std::invalid_argument("The subject is not in the topology of the atlas: register it first.");
  }
  SubjectEvaluation result;
  const AffineMap   align =
    AlignToMean(subject.points, atlas.mean.points, atlas.similarity ? AlignmentKind::Similarity : AlignmentKind::Rigid);
  std::vector<Vector3> aligned;
  for (const Vector3 & x : subject.points)
  {
    aligned.push_back(align(x));
  }
  result.shape = ScoreOf(atlas.shape, StackPoints(aligned));
  const std::vector<Vector3> nearest = UnstackPoints(atlas.shape.Synthesize(result.shape.scores));
  for (std::size_t p = 0; p < aligned.size(); ++p)
  {
    result.shapeResidual += (aligned[p] - nearest[p]).norm() / static_cast<double>(aligned.size());
  }
  result.shapeTypical = TypicalResidual(atlas);
  result.hasDensity = atlas.density.GetDimension() > 0 && subject.HasDensity();
  if (result.hasDensity)
  {
    const Eigen::Map<const Eigen::VectorXd> density(subject.coefficients.data(),
                                                    static_cast<Eigen::Index>(subject.coefficients.size()));
    if (density.size() != atlas.density.GetDimension())
    {
      throw std::invalid_argument("The subject's density has another degree than that of the atlas.");
    }
    result.density = ScoreOf(atlas.density, density);
    result.densityResidual = CompareDensities(subject, density, atlas.density.Synthesize(result.density.scores));
  }
  return result;
}
} // namespace bone
