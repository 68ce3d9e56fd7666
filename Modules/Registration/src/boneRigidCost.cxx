/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneRigidCost.h"

#include "boneMeshDerivatives.h"

#include <stdexcept>
#include <string>

namespace bone
{
RigidCost::RigidCost(const ProjectionModel &             model,
                     const std::vector<RadiographView> & views,
                     const MetricMaker &                 makeMetric)
  : m_Model(model)
{
  for (const RadiographView & view : views)
  {
    m_Views.push_back(view.view);
    try
    {
      m_Metrics.push_back(makeMetric(view));
    }
    catch (const std::invalid_argument & error)
    {
      throw std::invalid_argument("View " + std::to_string(m_Views.size()) + ": " + error.what() + '.');
    }
  }
}

double
RigidCost::Evaluate(const RigidPose & pose, const Execution & execution, std::vector<double> * ofViews) const
{
  std::vector<XRayGeometry::View> views;
  std::vector<std::vector<float>> images;
  std::vector<float *>            pointers;
  for (const auto & view : m_Views)
  {
    views.push_back(pose.ToModelSpace(view));
    images.emplace_back(static_cast<std::size_t>(view.size[0]) * static_cast<std::size_t>(view.size[1]));
  }
  for (auto & image : images)
  {
    pointers.push_back(image.data());
  }
  ProjectMesh(m_Model, views, execution, pointers);
  std::vector<double> costs(views.size());
  execution.Silent().For(views.size(), [&](std::size_t v) { costs[v] = m_Metrics[v]->Evaluate(pointers[v]); });
  double sum = 0.0;
  for (const double cost : costs)
  {
    sum += cost / static_cast<double>(costs.size());
  }
  if (ofViews != nullptr)
  {
    *ofViews = std::move(costs);
  }
  return sum;
}

MetricValue
RigidCost::EvaluateDerivatives(const RigidPose &                         pose,
                               const Execution &                         execution,
                               const std::vector<std::vector<Vector3>> & shape) const
{
  RadiographModes modes;
  modes.shape = shape;
  modes.pose = true;
  modes.poseCentre = pose.centre;
  std::vector<MetricValue>          values(m_Views.size());
  std::vector<std::vector<float>>   images(m_Views.size());
  std::vector<std::vector<float *>> pointers(m_Views.size());
  for (std::size_t v = 0; v < m_Views.size(); ++v)
  {
    const auto        view = pose.ToModelSpace(m_Views[v]);
    const std::size_t pixels = static_cast<std::size_t>(view.size[0]) * static_cast<std::size_t>(view.size[1]);
    images[v].resize(pixels * (1 + modes.Count()));
    for (std::size_t i = 0; i <= modes.Count(); ++i)
    {
      pointers[v].push_back(&images[v][i * pixels]);
    }
    ProjectMeshDerivatives(m_Model, view, modes, execution, pointers[v]);
  }
  execution.Silent().For(m_Views.size(),
                         [&](std::size_t v) { values[v] = m_Metrics[v]->EvaluateDerivatives(pointers[v]); });
  const auto  parameters = static_cast<Eigen::Index>(modes.Count());
  const auto  share = 1.0 / static_cast<double>(m_Views.size());
  MetricValue total;
  total.gradient = Eigen::VectorXd::Zero(parameters);
  total.hessian = Eigen::MatrixXd::Zero(parameters, parameters);
  total.shares.resize(parameters, 0);
  for (const MetricValue & value : values)
  {
    total.cost += share * value.cost;
    total.gradient += share * value.gradient;
    total.hessian += share * value.hessian;
    const Eigen::Index before = total.shares.cols();
    total.shares.conservativeResize(parameters, before + value.shares.cols());
    total.shares.rightCols(value.shares.cols()) = share * value.shares;
  }
  return total;
}
} // namespace bone
