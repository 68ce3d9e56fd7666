/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneDeformableRegistration.h"

#include "boneDeformableModel.h"
#include "boneEvolutionStrategy.h"
#include "boneMeshDerivatives.h"
#include "bonePatchGradientCorrelation.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>

namespace bone
{
namespace
{
constexpr Eigen::Index PoseSteps = 6;

Vector3
CentreOf(const std::vector<Vector3> & points)
{
  const Vector3 sum = std::accumulate(points.begin(), points.end(), Vector3(Vector3::Zero()));
  return sum / static_cast<double>(points.size());
}

/** Pose and coefficients. */
struct State
{
  RigidPose       pose;
  Eigen::VectorXd coefficients;
};

/** The X-rays at one resolution, and what a state's radiographs cost. */
class DeformableCost
{
public:
  DeformableCost(const DeformableModel &             model,
                 const std::vector<RadiographView> & views,
                 int                                 pixels,
                 int                                 patch,
                 double                              sigma)
    : m_Model(model)
  {
    for (const RadiographView & view : views)
    {
      const RadiographView reduced = ReduceView(view, ReductionTo(view.view, pixels));
      m_Views.push_back(reduced.view);
      try
      {
        m_Metrics.push_back(std::make_unique<PatchGradientCorrelation>(reduced, patch, sigma));
      }
      catch (const std::invalid_argument & error)
      {
        throw std::invalid_argument("View " + std::to_string(m_Views.size()) + ": " + error.what() + '.');
      }
    }
  }

  /** The cost alone, with the mean density of each cell of the atlas' mean. */
  double
  EvaluateShape(const State & state, const Execution & execution) const
  {
    const std::vector<Vector3>      points = m_Model.MovePoints(state.coefficients);
    std::vector<XRayGeometry::View> views;
    std::vector<std::vector<float>> images;
    std::vector<float *>            pointers;
    for (const auto & view : m_Views)
    {
      views.push_back(state.pose.ToModelSpace(view));
      images.emplace_back(static_cast<std::size_t>(view.size[0]) * static_cast<std::size_t>(view.size[1]));
    }
    for (auto & image : images)
    {
      pointers.push_back(image.data());
    }
    ProjectMesh(points, m_Model.meanDensities, views, MeshRadiographParameters{}, execution, pointers);
    double sum = 0.0;
    for (std::size_t v = 0; v < views.size(); ++v)
    {
      sum += m_Metrics[v]->Evaluate(pointers[v]) / static_cast<double>(views.size());
    }
    return sum;
  }

  MetricValue
  Evaluate(const State & state, const Execution & execution, std::vector<double> * ofViews = nullptr) const
  {
    const MeshArrays mesh = m_Model.Synthesize(state.coefficients);
    RadiographModes  modes;
    modes.pose = true;
    modes.poseCentre = state.pose.centre;
    modes.shape = m_Model.displacements;
    modes.density = m_Model.densities;
    const auto  parameters = static_cast<Eigen::Index>(modes.Count());
    const auto  share = 1.0 / static_cast<double>(m_Views.size());
    MetricValue total;
    total.gradient = Eigen::VectorXd::Zero(parameters);
    total.hessian = Eigen::MatrixXd::Zero(parameters, parameters);
    total.shares.resize(parameters, 0);
    std::vector<MetricValue> values(m_Views.size());
    for (std::size_t v = 0; v < m_Views.size(); ++v)
    {
      const auto           view = state.pose.ToModelSpace(m_Views[v]);
      const std::size_t    pixels = static_cast<std::size_t>(view.size[0]) * static_cast<std::size_t>(view.size[1]);
      std::vector<float>   images(pixels * (1 + modes.Count()));
      std::vector<float *> pointers;
      for (std::size_t i = 0; i <= modes.Count(); ++i)
      {
        pointers.push_back(&images[i * pixels]);
      }
      ProjectMeshDerivatives(mesh.points, mesh, view, MeshRadiographParameters{}, modes, execution, pointers);
      values[v] = m_Metrics[v]->EvaluateDerivatives(pointers);
    }
    for (const MetricValue & value : values)
    {
      total.cost += share * value.cost;
      total.gradient += share * value.gradient;
      total.hessian += share * value.hessian;
      const Eigen::Index before = total.shares.cols();
      total.shares.conservativeResize(parameters, before + value.shares.cols());
      total.shares.rightCols(value.shares.cols()) = share * value.shares;
      if (ofViews != nullptr)
      {
        ofViews->push_back(value.cost);
      }
    }
    return total;
  }

private:
  const DeformableModel &                        m_Model;
  std::vector<XRayGeometry::View>                m_Views;
  std::vector<std::unique_ptr<RadiographMetric>> m_Metrics;
};

/** By how much a cost has to count for its curvature to agree with the scatter of the shares of its gradient. */
double
EstimatePrecision(const MetricValue & value)
{
  const Eigen::VectorXd scale =
    value.hessian.diagonal().cwiseMax(std::numeric_limits<double>::min()).cwiseSqrt().cwiseInverse();
  Eigen::MatrixXd       hessian = scale.asDiagonal() * value.hessian * scale.asDiagonal();
  const Eigen::VectorXd mean = value.gradient / static_cast<double>(value.shares.cols());
  const Eigen::MatrixXd shares = scale.asDiagonal() * (value.shares.colwise() - mean);
  Eigen::MatrixXd       damped = hessian;
  damped.diagonal().array() += 1e-2;
  const Eigen::LDLT<Eigen::MatrixXd> solver(damped);
  const double                       curvature = solver.solve(hessian).trace();
  const double                       scatter = solver.solve(shares).cwiseProduct(shares).sum();
  return scatter > 0.0 ? curvature / scatter : 0.0;
}

class DeformableSearch
{
public:
  DeformableSearch(const StatisticalModelContent &                              atlas,
                   const std::vector<RadiographView> &                          views,
                   const RigidPose &                                            initial,
                   const DeformableRadiographParameters &                       parameters,
                   const std::function<void(const Eigen::VectorXd &, double)> & observe)
    : m_P(parameters)
    , m_Views(views)
    , m_Observe(observe)
    , m_Model(atlas, parameters)
    , m_Initial(initial.About(CentreOf(atlas.mean.points)))
  {
    for (const Vector3 & x : m_Model.mean.points)
    {
      m_Radius += (x - m_Initial.centre).squaredNorm();
    }
    m_Radius = std::sqrt(2.0 / 3.0 * m_Radius / static_cast<double>(m_Model.mean.points.size()));
    this->MakePrior();
  }

  DeformableRegistrationResult
  Run(const Execution & execution) const
  {
    DeformableRegistrationResult result;
    State                        state = this->Search(execution.Part(0.0, 0.3));
    std::vector<int>             resolutions;
    for (int pixels = m_P.searchPixels; pixels < m_P.pixels; pixels *= 2)
    {
      resolutions.push_back(pixels);
    }
    resolutions.push_back(m_P.pixels);
    for (const int pixels : resolutions)
    {
      const DeformableCost cost(m_Model, m_Views, pixels, this->PatchAt(pixels), m_P.sigma);
      this->Descend(cost, state, result, execution.Silent());
    }
    result.pose = state.pose;
    result.coefficients = state.coefficients;
    result.shapeModes = m_Model.shapeModes;
    result.smoothModes = m_Model.smoothModes;
    result.densityModes = m_Model.densityModes;
    this->Finish(result);
    execution.Report(1.0);
    return result;
  }

private:
  void
  MakePrior()
  {
    m_Prior = Eigen::VectorXd::Ones(PoseSteps + m_Model.GetNumberOfCoefficients());
    const double degree = std::acos(-1.0) / 180.0;
    const auto   precision = [](double deviation) { return deviation > 0.0 ? 1.0 / (deviation * deviation) : 0.0; };
    m_Prior.head<3>().setConstant(precision(m_P.translationDeviation));
    m_Prior.segment<3>(3).setConstant(precision(m_P.rotationDeviation * degree));
  }

  /** About as wide a patch of the bone at each resolution. */
  int
  PatchAt(int pixels) const
  {
    return std::max(4, m_P.patch * pixels / m_P.pixels);
  }

  /** Pose and leading modes of shape by an evolution strategy, on small images and with each cell's mean density. */
  State
  Search(const Execution & execution) const
  {
    constexpr int      generations = 100;
    constexpr double   narrow = 0.01;        // of the box
    constexpr double   mostDeviations = 4.0; // of a mode of shape
    constexpr double   beyond = 1.25;        // turns about three axes add up
    const Eigen::Index shape = std::min<Eigen::Index>(m_P.searchModes, m_Model.shapeModes);
    State              state{ m_Initial, Eigen::VectorXd::Zero(m_Model.GetNumberOfCoefficients()) };
    Eigen::VectorXd    box(PoseSteps + shape);
    box << Vector3::Constant(beyond * m_P.searchTranslation),
      Vector3::Constant(beyond * m_P.searchRotation * std::acos(-1.0) / 180.0),
      Eigen::VectorXd::Constant(shape, mostDeviations);
    if (!(box.head<PoseSteps>().maxCoeff() > 0.0))
    {
      return state;
    }
    const DeformableCost cost(m_Model, m_Views, m_P.searchPixels, this->PatchAt(m_P.searchPixels), m_P.sigma);
    EvolutionStrategy    strategy(
      Eigen::VectorXd::Zero(box.size()), 0.4, m_P.population, static_cast<std::uint64_t>(m_P.seed));
    const auto at = [&](const Eigen::VectorXd & candidate) {
      const Eigen::VectorXd step = candidate.cwiseProduct(box);
      State                 there = state;
      there.pose = m_Initial.Moved(step.head<PoseSteps>());
      there.coefficients.head(shape) = step.tail(shape);
      return there;
    };
    while (strategy.GetGeneration() < generations && !strategy.IsConverged(narrow))
    {
      const Eigen::MatrixXd & candidates = strategy.Ask();
      Eigen::VectorXd         costs(candidates.cols());
      execution.Silent().For(static_cast<std::size_t>(costs.size()), [&](std::size_t i) {
        const auto k = static_cast<Eigen::Index>(i);
        costs[k] = cost.EvaluateShape(at(candidates.col(k)), execution.Silent());
      });
      strategy.Tell(costs);
      execution.Report(static_cast<double>(strategy.GetGeneration()) / generations);
    }
    return at(strategy.BestCandidate());
  }

  /** Steps from the prior's mode to a state, in the parameters' units. */
  Eigen::VectorXd
  FromPrior(const State & state) const
  {
    Eigen::VectorXd step(m_Prior.size());
    step << m_Initial.StepTo(state.pose), state.coefficients;
    return step;
  }
  double
  PriorCost(const State & state) const
  {
    return 0.5 * this->FromPrior(state).cwiseAbs2().dot(m_Prior);
  }

  static State
  Moved(const State & state, const Eigen::VectorXd & step)
  {
    return { state.pose.Moved(step.head<PoseSteps>()), state.coefficients + step.tail(state.coefficients.size()) };
  }

  void
  Descend(const DeformableCost &         cost,
          State &                        at,
          DeformableRegistrationResult & result,
          const Execution &              execution) const
  {
    constexpr double least = 0.02; // of the logarithm of the posterior
    MetricValue      value = cost.Evaluate(at, execution);
    double           damping = 1e-3;
    int              refusals = 0;
    result.converged = false;
    for (int i = 0; i < m_P.iterations && !result.converged; ++i)
    {
      const double    precision = EstimatePrecision(value);
      Eigen::MatrixXd hessian = precision * value.hessian;
      hessian.diagonal() += m_Prior;
      const Eigen::VectorXd gradient = precision * value.gradient + m_Prior.cwiseProduct(this->FromPrior(at));
      hessian.diagonal() *= 1.0 + damping;
      hessian.diagonal().array() += std::numeric_limits<double>::min();
      const State       next = Moved(at, -hessian.ldlt().solve(gradient));
      const MetricValue there = cost.Evaluate(next, execution);
      const double      gain = precision * (value.cost - there.cost) + this->PriorCost(at) - this->PriorCost(next);
      if (gain > 0.0)
      {
        at = next;
        value = there;
        damping = std::max(1e-6, 0.2 * damping);
        refusals = 0;
      }
      else
      {
        damping = std::max(0.1, 10.0 * damping);
        ++refusals;
      }
      result.converged = refusals == 2 || (gain > 0.0 && gain < least);
      if (m_Observe)
      {
        m_Observe(at.coefficients, value.cost);
      }
    }
    result.cost = value.cost;
    result.precision = EstimatePrecision(value);
    Eigen::MatrixXd posterior = result.precision * value.hessian;
    posterior.diagonal() += m_Prior;
    result.covariance = posterior.ldlt().solve(Eigen::MatrixXd::Identity(posterior.rows(), posterior.cols()));
  }

  /** The mesh in its place, and the deviations of its points. */
  void
  Finish(DeformableRegistrationResult & result) const
  {
    result.mesh = m_Model.Synthesize(result.coefficients);
    const auto      count = static_cast<Eigen::Index>(m_Model.displacements.size());
    Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(3, PoseSteps + count);
    const auto      covariance = result.covariance.topLeftCorner(PoseSteps + count, PoseSteps + count);
    for (std::size_t p = 0; p < result.mesh.points.size(); ++p)
    {
      Vector3 &     x = result.mesh.points[p];
      const Vector3 arm = x - result.pose.centre;
      for (int k = 0; k < 3; ++k)
      {
        jacobian.col(k) = Vector3::Unit(k);
        jacobian.col(3 + k) = Vector3::Unit(k).cross(arm);
      }
      for (Eigen::Index k = 0; k < count; ++k)
      {
        jacobian.col(PoseSteps + k) = m_Model.displacements[static_cast<std::size_t>(k)][p];
      }
      const Eigen::MatrixXd turned = result.pose.rotation * jacobian;
      const Vector3         variances = (turned * covariance).cwiseProduct(turned).rowwise().sum();
      result.pointDeviations.emplace_back((variances.array() + m_Model.restVariance).sqrt());
      x = result.pose.Apply(x);
    }
  }

  const DeformableRadiographParameters &                       m_P;
  const std::vector<RadiographView> &                          m_Views;
  const std::function<void(const Eigen::VectorXd &, double)> & m_Observe;
  DeformableModel                                              m_Model;
  RigidPose                                                    m_Initial;
  double                                                       m_Radius{ 0.0 };
  Eigen::VectorXd                                              m_Prior;
};
} // namespace

DeformableRegistrationResult
RegisterDeformable(const StatisticalModelContent &                              atlas,
                   const std::vector<RadiographView> &                          views,
                   const RigidPose &                                            initial,
                   const DeformableRadiographParameters &                       parameters,
                   const Execution &                                            execution,
                   const std::function<void(const Eigen::VectorXd &, double)> & observe)
{
  if (views.size() == 1 && parameters.translationDeviation == 0.0)
  {
    throw std::invalid_argument("One view cannot tell size from depth: set TranslationDeviation and RotationDeviation, "
                                "how well the start is known, or give a second view.");
  }
  return DeformableSearch(atlas, views, initial, parameters, observe).Run(execution);
}
} // namespace bone
