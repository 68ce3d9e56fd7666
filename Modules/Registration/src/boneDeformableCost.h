/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneDeformableCost_h
#define boneDeformableCost_h

#include "boneDeformableModel.h"
#include "boneExecution.h"
#include "boneMeshDerivatives.h"
#include "boneMetricSum.h"
#include "boneRigidPose.h"

namespace bone
{
/** Pose and coefficients of a bone. */
struct DeformableState
{
  RigidPose       pose;
  Eigen::VectorXd coefficients;
};

/** \class DeformableCost
 * \brief How badly the radiographs of a bone agree with X-rays at one resolution: gradients, and, once they are asked
 * for, line integrals. */
class DeformableCost
{
public:
  /** Throws std::invalid_argument with the number of a view that cannot be used. */
  DeformableCost(const DeformableModel &                model,
                 const std::vector<RadiographView> &    views,
                 const DeformableRadiographParameters & parameters,
                 int                                    pixels);

  /** Side of the patches, pixels: about as wide a part of the bone at each resolution. */
  static int
  PatchAt(int pixels, const DeformableRadiographParameters & parameters);

  /** Compares line integrals from now on, around where the bone of this state shows. */
  void
  UseIntensities(const DeformableState & state, const Execution & execution);

  /** The mean over the views of the gradients' cost, and of the line integrals' where they are used, with their
   * derivatives by the six steps of the pose and the coefficients. */
  std::vector<MetricSum>
  Evaluate(const DeformableState & state, const Execution & execution);

  /** What Evaluate has as costs, alone. */
  std::vector<double>
  EvaluateCosts(const DeformableState & state, const Execution & execution) const;

  /** What Evaluate has, and of each metric the second derivatives by all parameters and by how far the outer surface
   * lies outward, mm. */
  std::vector<MetricSum>
  Evaluate(const DeformableState & state, std::vector<Eigen::VectorXd> & surfaceSlopes, const Execution & execution);

  /** The gradients' cost alone, of another model. */
  double
  EvaluateShape(const CoarseModel & model, const DeformableState & state, const Execution & execution) const;

private:
  using Metrics = std::vector<std::unique_ptr<RadiographMetric>>;

  /** The radiographs of points and cells. */
  std::vector<std::vector<float>>
  Project(const std::vector<Vector3> & points,
          const MeshCells &            cells,
          const RigidPose &            pose,
          const Execution &            execution) const;

  const DeformableModel &                m_Model;
  const DeformableRadiographParameters & m_P;
  MeshRadiographParameters               m_Attenuation;
  std::vector<RadiographView>            m_Views;
  RadiographModes                        m_Modes;
  std::vector<std::vector<float>>        m_Images;  ///< of each view, the radiograph and its derivatives
  std::vector<Metrics>                   m_Metrics; ///< of gradients, of line integrals; one a view
};
} // namespace bone

#endif
