/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneRigidBundle.h"

#include "boneDamping.h"
#include "boneMeshDerivatives.h"
#include "boneMetricSum.h"
#include "boneOutwardMove.h"
#include "bonePatchGradientCorrelation.h"
#include "boneRigidSearch.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

namespace bone
{
namespace
{
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/** Poses of the bodies, how far their surfaces lie outside of the models' (mm), and motions of the views. */
struct BundleState
{
  std::vector<RigidPose> poses;
  std::vector<double>    outward;
  std::vector<RigidPose> motions;
};

/** Bodies with their surfaces where a state has them, made ready for radiographs. */
struct ReadyBodies
{
  std::vector<std::vector<Vector3>>                   points;
  std::vector<std::unique_ptr<const ProjectionModel>> models; ///< of these points
};

/** What the motion's step moves a posed body by, as a step of the body's pose. */
Matrix6
StepOfMotion(const RigidPose & pose, const RigidPose & motion)
{
  // The body's centre lies at `arm` from the motion's: translation + rotation x arm.
  const Vector3   arm = pose.centre + pose.translation - motion.centre;
  Eigen::Matrix3d cross;
  cross << 0, -arm.z(), arm.y(), arm.z(), 0, -arm.x(), -arm.y(), arm.x(), 0;
  Matrix6 step = Matrix6::Zero();
  step.topLeftCorner<3, 3>() = pose.rotation.transpose();
  step.topRightCorner<3, 3>() = -pose.rotation.transpose() * cross;
  step.bottomRightCorner<3, 3>() = pose.rotation.transpose();
  return step;
}

/** The bodies' poses and the views' motions together. Parameters: six steps (RigidPose::Moved) and an outward move of
 * the surface for each body, and six steps for each view but the first where motions are estimated. The surface is
 * among them as one view cannot tell it from depth, and would be believed against where the other views are said to be.
 */
class RigidBundle
{
public:
  RigidBundle(const std::vector<MeshArrays> &     bodies,
              const std::vector<RadiographView> & views,
              const RigidRadiographParameters &   parameters)
    : m_P(parameters)
    , m_Bodies(bodies)
    , m_AreViewsMoved(parameters.viewTranslationDeviation > 0.0 || parameters.viewRotationDeviation > 0.0)
  {
    for (const RadiographView & view : views)
    {
      m_Views.push_back(ReduceView(view, ReductionTo(view.view, parameters.pixels)));
      m_Metrics.push_back(
        std::make_unique<PatchGradientCorrelation>(m_Views.back(), parameters.patch, parameters.sigma));
    }
    // What is said to be exact may still move by a hair.
    const auto       precision = [](double deviation) { return std::pow(std::max(deviation, 1e-6), -2); };
    constexpr double anywhere = 1e4; // mm, radians: nothing is known of poses that no view shows
    m_Prior = Eigen::VectorXd::Constant(this->IndexOfMotion(this->CountMotions() + 1), precision(anywhere));
    for (const MeshArrays & body : bodies)
    {
      m_Prior[OfBody * static_cast<Eigen::Index>(m_Outward.size()) + 6] = precision(parameters.surfaceDeviation);
      m_Outward.push_back(OutwardMove(body));
    }
    for (std::size_t v = 1; v <= this->CountMotions(); ++v)
    {
      m_Prior.segment<3>(this->IndexOfMotion(v)).setConstant(precision(parameters.viewTranslationDeviation));
      m_Prior.segment<3>(this->IndexOfMotion(v) + 3)
        .setConstant(precision(parameters.viewRotationDeviation * std::acos(-1.0) / 180.0));
    }
  }

  ReadyBodies
  MakeReady(const BundleState & state, const Execution & execution) const
  {
    ReadyBodies ready;
    for (std::size_t b = 0; b < m_Bodies.size(); ++b)
    {
      ready.points.push_back(this->PointsOf(state, b));
    }
    for (std::size_t b = 0; b < m_Bodies.size(); ++b)
    {
      ready.models.push_back(std::make_unique<const ProjectionModel>(
        ready.points[b], m_Bodies[b], MeshRadiographParameters{}, execution.Silent()));
    }
    return ready;
  }

  /** The cost alone. */
  double
  EvaluateCost(const BundleState & state, const ReadyBodies & ready, const Execution & execution) const
  {
    std::vector<std::vector<float>> images;
    for (const RadiographView & view : m_Views)
    {
      images.emplace_back(view.GetNumberOfPixels(), 0.0f);
    }
    for (std::size_t b = 0; b < m_Bodies.size(); ++b)
    {
      std::vector<XRayGeometry::View> seen;
      std::vector<std::vector<float>> own;
      std::vector<float *>            pointers;
      for (std::size_t v = 0; v < m_Views.size(); ++v)
      {
        seen.push_back(this->Seen(state, v, b));
        pointers.push_back(own.emplace_back(images[v].size()).data());
      }
      ProjectMesh(*ready.models[b], seen, execution, pointers);
      for (std::size_t v = 0; v < m_Views.size(); ++v)
      {
        std::transform(own[v].begin(), own[v].end(), images[v].begin(), images[v].begin(), std::plus<float>());
      }
    }
    std::vector<double> costs(m_Views.size());
    execution.For(costs.size(), [&](std::size_t v) { costs[v] = m_Metrics[v]->Evaluate(images[v].data()); });
    return std::accumulate(costs.begin(), costs.end(), 0.0) / static_cast<double>(costs.size());
  }

  MetricSum
  Evaluate(const BundleState & state, const ReadyBodies & ready, const Execution & execution) const
  {
    std::vector<std::vector<std::vector<float>>> images;
    for (std::size_t v = 0; v < m_Views.size(); ++v)
    {
      images.push_back(this->Project(state, ready, v, execution));
    }
    std::vector<MetricValue> values(m_Views.size());
    execution.For(values.size(), [&](std::size_t v) {
      std::vector<float *> pointers;
      for (std::vector<float> & image : images[v])
      {
        pointers.push_back(image.data());
      }
      values[v] = m_Metrics[v]->EvaluateDerivatives(pointers);
    });
    MetricSum sum(m_Prior.size());
    for (std::size_t v = 0; v < m_Views.size(); ++v)
    {
      MetricValue &         value = values[v];
      const Eigen::MatrixXd map = this->Parameterize(state, v);
      value.gradient = map.transpose() * value.gradient;
      value.hessian = map.transpose() * value.hessian * map;
      value.shares = map.transpose() * value.shares;
      sum.Add(value, 1.0 / static_cast<double>(m_Views.size()));
    }
    return sum;
  }

  /** Levenberg-Marquardt steps from `at`, where Evaluate gives `value`; whether they ended before they ran out. */
  bool
  Descend(BundleState &                                          at,
          MetricSum &                                            value,
          const Execution &                                      execution,
          const std::function<void(const RigidPose &, double)> & observe) const
  {
    constexpr double least = 0.5; // of the logarithm of the posterior
    Damping          damping;
    bool             isDone = false;
    for (int i = 0; i < m_P.iterations && !isDone; ++i)
    {
      const double          precision = value.EstimatePrecision();
      Eigen::MatrixXd       hessian = precision * value.hessian;
      const Eigen::VectorXd gradient = precision * value.gradient + m_Prior.cwiseProduct(this->FromPrior(at));
      hessian.diagonal() += m_Prior;
      const double      floor = 1e-12 * hessian.diagonal().maxCoeff();
      const BundleState next = this->Moved(at, -LongerSteps * damping.Damp(hessian, floor).ldlt().solve(gradient));
      const ReadyBodies ready = this->MakeReady(next, execution);
      const double      there = this->EvaluateCost(next, ready, execution.Silent());
      const double      gain = precision * (value.cost - there) + this->PriorCost(at) - this->PriorCost(next);
      if (gain > 0.0)
      {
        at = next;
        value = this->Evaluate(at, ready, execution.Silent());
      }
      damping.Tell(gain > 0.0);
      isDone = damping.IsStuck() || (gain > 0.0 && gain < least);
      if (observe)
      {
        observe(at.poses.front(), value.cost);
      }
      execution.Report((i + 1.0) / m_P.iterations);
    }
    return isDone;
  }

  /** The covariance of all parameters, as RegisterRigid's, at the minimum. */
  Eigen::MatrixXd
  MakeCovariance(const MetricSum & value) const
  {
    const auto      size = m_Prior.size();
    const double    precision = value.EstimatePrecision();
    Eigen::MatrixXd hessian = precision * value.hessian;
    hessian.diagonal() += m_Prior;
    Eigen::MatrixXd errors = precision * precision * value.scatters.front();
    errors.diagonal() += m_Prior;
    const Eigen::MatrixXd inverse = hessian.ldlt().solve(Eigen::MatrixXd::Identity(size, size));
    return inverse * errors * inverse;
  }

  static constexpr Eigen::Index OfBody = 7; ///< parameters of a body: six steps, and its surface's

  /** Those of the views whose motions are estimated. */
  std::size_t
  CountMotions() const
  {
    return m_AreViewsMoved ? m_Views.size() - 1 : 0;
  }
  /** Of the first parameter of the motion of view `view`, which is not the first one. */
  Eigen::Index
  IndexOfMotion(std::size_t view) const
  {
    return OfBody * static_cast<Eigen::Index>(m_Bodies.size()) + 6 * (static_cast<Eigen::Index>(view) - 1);
  }

private:
  BundleState
  Moved(const BundleState & state, const Eigen::VectorXd & step) const
  {
    BundleState moved = state;
    for (std::size_t b = 0; b < m_Bodies.size(); ++b)
    {
      const auto at = OfBody * static_cast<Eigen::Index>(b);
      moved.poses[b] = state.poses[b].Moved(step.segment<6>(at));
      moved.outward[b] += step[at + 6];
    }
    for (std::size_t v = 1; v <= this->CountMotions(); ++v)
    {
      moved.motions[v] = state.motions[v].Moved(step.segment<6>(this->IndexOfMotion(v)));
    }
    return moved;
  }

  /** Steps from the prior's mode; of the poses, of which nothing is known beforehand, 0. */
  Eigen::VectorXd
  FromPrior(const BundleState & state) const
  {
    Eigen::VectorXd step = Eigen::VectorXd::Zero(m_Prior.size());
    for (std::size_t b = 0; b < m_Bodies.size(); ++b)
    {
      step[OfBody * static_cast<Eigen::Index>(b) + 6] = state.outward[b];
    }
    for (std::size_t v = 1; v <= this->CountMotions(); ++v)
    {
      const RigidPose stated{ Eigen::Matrix3d::Identity(), Vector3::Zero(), state.motions[v].centre };
      step.segment<6>(this->IndexOfMotion(v)) = stated.StepTo(state.motions[v]);
    }
    return step;
  }
  double
  PriorCost(const BundleState & state) const
  {
    return 0.5 * this->FromPrior(state).cwiseAbs2().dot(m_Prior);
  }

  /** The image parameters of a view, which are those of the bodies, by all parameters. */
  Eigen::MatrixXd
  Parameterize(const BundleState & state, std::size_t view) const
  {
    const auto      ofImage = OfBody * static_cast<Eigen::Index>(m_Bodies.size());
    Eigen::MatrixXd map = Eigen::MatrixXd::Identity(ofImage, m_Prior.size());
    for (std::size_t b = 0; b < m_Bodies.size() && view > 0 && m_AreViewsMoved; ++b)
    {
      map.block<6, 6>(OfBody * static_cast<Eigen::Index>(b), this->IndexOfMotion(view)) =
        StepOfMotion(state.poses[b], state.motions[view]);
    }
    return map;
  }

  /** A body's points, its surface as far outward as it is found to be. */
  std::vector<Vector3>
  PointsOf(const BundleState & state, std::size_t body) const
  {
    std::vector<Vector3> points = m_Bodies[body].points;
    for (std::size_t p = 0; p < points.size(); ++p)
    {
      points[p] += state.outward[body] * m_Outward[body][p];
    }
    return points;
  }

  /** A view from a body's model. */
  XRayGeometry::View
  Seen(const BundleState & state, std::size_t view, std::size_t body) const
  {
    return state.poses[body].ToModelSpace(state.motions[view].ToModelSpace(m_Views[view].view));
  }

  /** The radiograph of all bodies in one view, then its derivatives by the bodies' parameters. */
  std::vector<std::vector<float>>
  Project(const BundleState & state, const ReadyBodies & ready, std::size_t view, const Execution & execution) const
  {
    const std::size_t               pixels = m_Views[view].GetNumberOfPixels();
    std::vector<std::vector<float>> images(1 + OfBody * m_Bodies.size(), std::vector<float>(pixels, 0.0f));
    for (std::size_t b = 0; b < m_Bodies.size(); ++b)
    {
      RadiographModes modes;
      modes.pose = true;
      modes.poseCentre = state.poses[b].centre;
      modes.shape.push_back(m_Outward[b]);
      std::vector<float>   own(pixels);
      std::vector<float *> pointers{ own.data() };
      for (std::size_t k = 0; k < OfBody; ++k)
      {
        pointers.push_back(images[1 + OfBody * b + k].data());
      }
      ProjectMeshDerivatives(*ready.models[b], this->Seen(state, view, b), modes, execution, pointers);
      std::transform(own.begin(), own.end(), images[0].begin(), images[0].begin(), std::plus<float>());
    }
    return images;
  }

  const RigidRadiographParameters &              m_P;
  const std::vector<MeshArrays> &                m_Bodies;
  bool                                           m_AreViewsMoved;
  std::vector<RadiographView>                    m_Views;
  std::vector<std::unique_ptr<RadiographMetric>> m_Metrics;
  std::vector<std::vector<Vector3>>              m_Outward;
  Eigen::VectorXd                                m_Prior; ///< precisions
};

/** A covariance of steps in a pose's own axes, along the geometry's. */
Matrix6
TurnedTo(const RigidPose & pose, const Matrix6 & covariance)
{
  Matrix6 turn = Matrix6::Zero();
  turn.topLeftCorner<3, 3>() = pose.rotation;
  turn.bottomRightCorner<3, 3>() = pose.rotation;
  return turn * covariance * turn.transpose();
}

} // namespace

void
AdjustRigidBundle(const std::vector<MeshArrays> &                        models,
                  const std::vector<std::size_t> &                       which,
                  const std::vector<RadiographView> &                    views,
                  const RigidRadiographParameters &                      parameters,
                  const Execution &                                      execution,
                  const std::function<void(const RigidPose &, double)> & observe,
                  RigidBundleResult &                                    result)
{
  std::vector<MeshArrays> bodies;
  BundleState             state;
  Vector3                 centre = Vector3::Zero();
  for (const std::size_t b : which)
  {
    bodies.push_back(models[b]);
    state.poses.push_back(result.bodies[b].pose);
    centre += state.poses.back().Apply(state.poses.back().centre) / static_cast<double>(which.size());
  }
  state.outward.assign(which.size(), 0.0);
  for (ViewCorrection & view : result.views)
  {
    view.motion.centre = centre;
    state.motions.push_back(view.motion);
  }
  const RigidBundle           bundle(bodies, views, parameters);
  MetricSum                   value = bundle.Evaluate(state, bundle.MakeReady(state, execution), execution.Silent());
  const bool                  converged = bundle.Descend(state, value, execution, observe);
  const Eigen::MatrixXd       covariance = bundle.MakeCovariance(value);
  std::vector<RadiographView> moved = views;
  for (std::size_t v = 0; v < views.size(); ++v)
  {
    result.views[v].motion = state.motions[v];
    moved[v].view = state.motions[v].ToModelSpace(views[v].view);
    if (v > 0 && v <= bundle.CountMotions())
    {
      const auto at = bundle.IndexOfMotion(v);
      result.views[v].covariance = TurnedTo(state.motions[v], covariance.block<6, 6>(at, at));
    }
  }
  for (std::size_t i = 0; i < which.size(); ++i)
  {
    const auto                at = RigidBundle::OfBody * static_cast<Eigen::Index>(i);
    RigidRegistrationResult & body = result.bodies[which[i]];
    body.pose = state.poses[i];
    body.converged = converged;
    body.covariance = TurnedTo(body.pose, covariance.block<6, 6>(at, at));
    // The search judges by more than distinctness, and the adjustment moves the pose by tenths of a millimetre.
    if (body.quality == RegistrationQuality::Ok)
    {
      SetCosts(models[which[i]], moved, parameters, execution, body);
      continue;
    }
    const RegistrationQuality searched = body.quality;
    JudgePose(models[which[i]], moved, parameters, execution, body);
    body.quality = std::min(body.quality, searched);
  }
}
} // namespace bone
