/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneDeformablePosterior_h
#define boneDeformablePosterior_h

#include "boneDeformableRegistration.h"

#include <cstdint>
#include <memory>
#include <string>

namespace bone
{
class DeformableModel;

/** \class DeformablePosterior
 * \brief What a deformable registration leaves open: bones drawn from the normal distribution about the most probable
 * one, with the result's covariance. */
class DeformablePosterior
{
public:
  /** The atlas and the parameters must be those that the result came of. Throws std::invalid_argument where they have
   * other modes than the result. */
  DeformablePosterior(const StatisticalModelContent &        atlas,
                      const DeformableRadiographParameters & parameters,
                      DeformableRegistrationResult           result);
  ~DeformablePosterior();
  DeformablePosterior(const DeformablePosterior &) = delete;
  DeformablePosterior &
  operator=(const DeformablePosterior &) = delete;

  /** A bone in the geometry's space, in the topology of the atlas; the same for a seed on every machine. Cells may be
   * inverted where the covariance is wide. */
  MeshArrays
  Draw(std::uint64_t seed) const;

private:
  DeformableRegistrationResult           m_Result;
  std::unique_ptr<const DeformableModel> m_Model;
  Eigen::MatrixXd                        m_Factor;
};

/** A factor F of a covariance: F F^T, so that mean + F z with standard normal z is drawn from the posterior. */
Eigen::MatrixXd
PosteriorFactor(const Eigen::MatrixXd & covariance);

/** Writes a registration's `mean` (#n by 1: six steps of the pose, 0, then the coefficients), `covariance` and `factor`
 * (#n by #n) and `pointDeviations` (#points by 3, mm, along the axes of the space that the pose leads into) into an
 * HDF5 file (.h5), the whole file or none. Throws IOError. */
void
WritePosterior(const Eigen::VectorXd &      coefficients,
               const Eigen::MatrixXd &      covariance,
               const std::vector<Vector3> & pointDeviations,
               const std::string &          path);
} // namespace bone

#endif
