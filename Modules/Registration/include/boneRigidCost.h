/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneRigidCost_h
#define boneRigidCost_h

#include "boneProjectionModel.h"
#include "boneRadiographMetric.h"
#include "boneRigidPose.h"

#include <functional>

namespace bone
{
/** Makes the metric of a view. */
using MetricMaker = std::function<std::unique_ptr<RadiographMetric>(const RadiographView &)>;

/** \class RigidCost
 * \brief How badly a density model in a pose agrees with X-rays: the mean of a metric over the views.
 *
 * The model stays and the views move, so that what depends on the model alone is computed once. Thread-safe. The
 * projection model must outlive this. */
class RigidCost
{
public:
  /** Throws what the metrics throw, with the number of the view. */
  RigidCost(const ProjectionModel & model, const std::vector<RadiographView> & views, const MetricMaker & makeMetric);

  std::size_t
  GetNumberOfViews() const
  {
    return m_Views.size();
  }

  /** The mean cost. `ofViews`: where given, each view's. */
  double
  Evaluate(const RigidPose & pose, const Execution & execution, std::vector<double> * ofViews = nullptr) const;

  /** The cost and what changes it: the steps of RigidPose::Moved, and after these six the displacements `shape` of the
   * model's points, mm per unit. */
  MetricValue
  EvaluateDerivatives(const RigidPose &                         pose,
                      const Execution &                         execution,
                      const std::vector<std::vector<Vector3>> & shape = {}) const;

private:
  const ProjectionModel &                        m_Model;
  std::vector<XRayGeometry::View>                m_Views;
  std::vector<std::unique_ptr<RadiographMetric>> m_Metrics;
};
} // namespace bone

#endif
