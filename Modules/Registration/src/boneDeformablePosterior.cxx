/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneDeformablePosterior.h"

#include "boneDeformableModel.h"
#include "boneModelIO.h"
#include "boneSymmetricEigen.h"

#include <stdexcept>

namespace bone
{
DeformablePosterior::DeformablePosterior(const StatisticalModelContent &        atlas,
                                         const DeformableRadiographParameters & parameters,
                                         DeformableRegistrationResult           result)
  : m_Result(std::move(result))
  , m_Model(std::make_unique<const DeformableModel>(atlas, parameters))
  , m_Factor(PosteriorFactor(m_Result))
{
  if (m_Model->GetNumberOfCoefficients() != m_Result.coefficients.size())
  {
    throw std::invalid_argument("The atlas and the parameters have " +
                                std::to_string(m_Model->GetNumberOfCoefficients()) + " modes, the result " +
                                std::to_string(m_Result.coefficients.size()) + '.');
  }
}

DeformablePosterior::~DeformablePosterior() = default;

MeshArrays
DeformablePosterior::Draw(std::uint64_t seed) const
{
  const Eigen::VectorXd step = m_Factor * SampleCoefficients(m_Factor.cols(), seed);
  const RigidPose       pose = m_Result.pose.Moved(step.head<6>());
  MeshArrays            mesh = m_Model->Synthesize(m_Result.coefficients + step.tail(m_Result.coefficients.size()));
  for (Vector3 & x : mesh.points)
  {
    x = pose.Apply(x);
  }
  return mesh;
}

Eigen::MatrixXd
PosteriorFactor(const DeformableRegistrationResult & result)
{
  const auto eigen = EigenOf<Eigen::Dynamic>(result.covariance);
  return eigen.vectors * eigen.values.cwiseMax(0.0).cwiseSqrt().asDiagonal();
}

void
WritePosterior(const DeformableRegistrationResult & result, const std::string & path)
{
  Eigen::MatrixXd mean = Eigen::MatrixXd::Zero(6 + result.coefficients.size(), 1);
  mean.bottomRows(result.coefficients.size()) = result.coefficients;
  Eigen::MatrixXd deviations(static_cast<Eigen::Index>(result.pointDeviations.size()), 3);
  for (std::size_t p = 0; p < result.pointDeviations.size(); ++p)
  {
    deviations.row(static_cast<Eigen::Index>(p)) = result.pointDeviations[p].transpose();
  }
  WriteMatrices({ { "mean", mean },
                  { "covariance", result.covariance },
                  { "factor", PosteriorFactor(result) },
                  { "pointDeviations", deviations } },
                path);
}
} // namespace bone
