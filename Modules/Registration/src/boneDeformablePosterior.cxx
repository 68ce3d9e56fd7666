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
  , m_Factor(PosteriorFactor(m_Result.covariance))
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
PosteriorFactor(const Eigen::MatrixXd & covariance)
{
  const auto eigen = EigenOf<Eigen::Dynamic>(covariance);
  return eigen.vectors * eigen.values.cwiseMax(0.0).cwiseSqrt().asDiagonal();
}

void
WritePosterior(const Eigen::VectorXd &      coefficients,
               const Eigen::MatrixXd &      covariance,
               const std::vector<Vector3> & pointDeviations,
               const std::string &          path)
{
  Eigen::MatrixXd mean = Eigen::MatrixXd::Zero(6 + coefficients.size(), 1);
  mean.bottomRows(coefficients.size()) = coefficients;
  Eigen::MatrixXd deviations(static_cast<Eigen::Index>(pointDeviations.size()), 3);
  for (std::size_t p = 0; p < pointDeviations.size(); ++p)
  {
    deviations.row(static_cast<Eigen::Index>(p)) = pointDeviations[p].transpose();
  }
  WriteMatrices({ { "mean", mean },
                  { "covariance", covariance },
                  { "factor", PosteriorFactor(covariance) },
                  { "pointDeviations", deviations } },
                path);
}
} // namespace bone
