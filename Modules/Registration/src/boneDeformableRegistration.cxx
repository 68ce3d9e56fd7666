/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneDeformableRegistration.h"

#include "boneDamping.h"
#include "boneDeformableCost.h"
#include "boneEvolutionStrategy.h"
#include "boneFlatCut.h"
#include "boneImageResolutions.h"
#include "boneMeanDensities.h"
#include "boneShownPoints.h"
#include "boneSymmetricEigen.h"

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
    , m_Shown(ShownPoints(atlas.mean.points, initial, views, parameters.searchTranslation))
    , m_Initial(initial.About(MeanOf(atlas.mean.points, m_Shown)))
    , m_Resolutions(ImageResolutions(parameters.searchPixels, parameters.pixels, atlas.mean.points, m_Initial, views))
  {
    this->MakePrior();
  }

  DeformableRegistrationResult
  Run(const Execution & execution) const
  {
    DeformableRegistrationResult result;
    DeformableState              state = this->FindCoarsely(result, execution.Part(0.0, 0.5));
    // The coarsest images again where there are no others: they have no line integrals yet.
    const std::size_t first = m_Resolutions.size() > 1 ? 1 : 0;
    const auto        share = 0.4 / static_cast<double>(m_Resolutions.size() - first);
    for (std::size_t i = first; i < m_Resolutions.size(); ++i)
    {
      const auto      done = 0.5 + share * static_cast<double>(i - first);
      const Execution part = execution.Part(done, done + share);
      const bool      last = i + 1 == m_Resolutions.size();
      DeformableCost  cost(m_Model, m_Views, m_P, m_Resolutions[i]);
      if (last && m_P.intensities)
      {
        cost.UseIntensities(state, part.Silent());
      }
      this->Descend(cost, last ? LittleAtLast : LittleBeforeFinerImages, state, result, part);
      if (last)
      {
        this->SetCovariance(cost, state, result, part);
      }
    }
    result.pose = state.pose;
    result.coefficients = state.coefficients;
    result.shapeModes = m_Model.shapeModes;
    result.smoothModes = m_Model.smoothModes;
    result.densityModes = m_Model.densityModes;
    this->Finish(result, execution);
    this->Judge(result, execution.Part(0.9, 1.0));
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

  /** Searches on the coarsest images and descends from what was found; again, with more bones, where that is not clear.
   */
  DeformableState
  FindCoarsely(DeformableRegistrationResult & result, const Execution & execution) const
  {
    constexpr int searches = 8;
    // On these images scatter leaves little of the distinctness.
    const int       finer = m_Resolutions[std::min<std::size_t>(1, m_Resolutions.size() - 1)];
    DeformableCost  cost(m_Model, m_Views, m_P, m_Resolutions.front());
    DeformableState best{ m_Initial, Eigen::VectorXd::Zero(m_Model.GetNumberOfCoefficients()) };
    if (!(m_P.searchTranslation > 0.0 || m_P.searchRotation > 0.0))
    {
      this->Descend(cost, LittleBeforeFinerImages, best, result, execution);
      return best;
    }
    const CoarseModel model = m_Model.Coarsen(SearchTetrahedra, m_P.searchModes, execution.Silent());
    Fit               ofBest;
    for (int k = 0; k < searches && !ofBest.IsClear(); ++k)
    {
      const Execution part = execution.Part(static_cast<double>(k) / searches, (k + 1.0) / searches);
      DeformableState state = this->Search(cost, model, k, part.Part(0.0, 0.7));
      Fit             fit = this->Descend(cost, LittleBeforeFinerImages, state, result, part.Part(0.7, 1.0));
      fit.distinctness = this->JudgeBone(this->Place(state), finer, part.Silent()).distinctness;
      // By one precision for both, as one that fits worse states a lower one.
      const double precision = std::max(fit.precision, ofBest.precision);
      if (k == 0 || precision * fit.cost + this->PriorCost(state) < precision * ofBest.cost + this->PriorCost(best))
      {
        best = state;
        ofBest = fit;
      }
    }
    return best;
  }

  /** Pose and leading modes of shape by an evolution strategy, on small images and with each cell's mean density. */
  DeformableState
  Search(const DeformableCost & cost, const CoarseModel & model, int round, const Execution & execution) const
  {
    constexpr int    generations = 100;
    constexpr double narrow = 0.15;        // of the box
    constexpr double mostDeviations = 4.0; // of a mode of shape
    constexpr double beyond = 1.25;        // turns about three axes add up
    const auto       shape = static_cast<Eigen::Index>(model.displacements.size());
    DeformableState  state{ m_Initial, Eigen::VectorXd::Zero(m_Model.GetNumberOfCoefficients()) };
    Eigen::VectorXd  box(PoseSteps + shape);
    box << Vector3::Constant(beyond * m_P.searchTranslation),
      Vector3::Constant(beyond * m_P.searchRotation * std::acos(-1.0) / 180.0),
      Eigen::VectorXd::Constant(shape, mostDeviations);
    EvolutionStrategy strategy(Eigen::VectorXd::Zero(box.size()),
                               0.4,
                               m_P.population * (2 + round) / 2,
                               static_cast<std::uint64_t>(m_P.seed + round * 1000003LL));
    // What the views show stays in its place when the shape varies, whatever becomes of the rest.
    Eigen::Matrix3Xd moves(3, shape);
    for (Eigen::Index k = 0; k < shape; ++k)
    {
      moves.col(k) = MeanOf(m_Model.displacements[static_cast<std::size_t>(k)], m_Shown);
    }
    const auto at = [&](const Eigen::VectorXd & candidate) {
      const Eigen::VectorXd step = candidate.cwiseProduct(box);
      DeformableState       there = state;
      there.pose = m_Initial.Moved(step.head<PoseSteps>());
      there.coefficients.head(shape) = step.tail(shape);
      there.pose.translation -= there.pose.rotation * moves * step.tail(shape);
      return there;
    };
    while (strategy.GetGeneration() < generations && !strategy.IsConverged(narrow))
    {
      const Eigen::MatrixXd & candidates = strategy.Ask();
      Eigen::VectorXd         costs(candidates.cols());
      execution.Silent().For(static_cast<std::size_t>(costs.size()), [&](std::size_t i) {
        const auto k = static_cast<Eigen::Index>(i);
        costs[k] = cost.EvaluateShape(model, at(candidates.col(k)), execution.Silent());
      });
      strategy.Tell(costs);
      execution.Report(static_cast<double>(strategy.GetGeneration()) / generations);
    }
    return at(strategy.BestCandidate());
  }

  /** Steps from the prior's mode to a state, in the parameters' units. */
  Eigen::VectorXd
  FromPrior(const DeformableState & state) const
  {
    Eigen::VectorXd step(m_Prior.size());
    step << m_Initial.StepTo(state.pose), state.coefficients;
    return step;
  }
  double
  PriorCost(const DeformableState & state) const
  {
    return 0.5 * this->FromPrior(state).cwiseAbs2().dot(m_Prior);
  }

  /** The bone of a state in the geometry's space. */
  MeshArrays
  Place(const DeformableState & state) const
  {
    MeshArrays bone = m_Model.Synthesize(state.coefficients);
    for (Vector3 & x : bone.points)
    {
      x = state.pose.Apply(x);
    }
    return bone;
  }

  static DeformableState
  Moved(const DeformableState & state, const Eigen::VectorXd & step)
  {
    return { state.pose.Moved(step.head<PoseSteps>()), state.coefficients + step.tail(state.coefficients.size()) };
  }

  /** By what share of its precision cost k counts. What shape leaves of the line integrals correlates over the whole
   * bone: leave-one-out over femora, mean densities are three times as exact where they count by a tenth. */
  static double
  ShareOf(std::size_t k)
  {
    return k == 0 ? 1.0 : 0.1;
  }

  /** Sum of the costs by their precisions, and the prior's. */
  struct Posterior
  {
    std::vector<double> precisions;
    Eigen::VectorXd     gradient;
    Eigen::MatrixXd     hessian;
  };
  Posterior
  MakePosterior(const std::vector<MetricSum> & values, const DeformableState & at) const
  {
    Posterior posterior;
    posterior.gradient = m_Prior.cwiseProduct(this->FromPrior(at));
    posterior.hessian = m_Prior.asDiagonal();
    for (std::size_t k = 0; k < values.size(); ++k)
    {
      posterior.precisions.push_back(ShareOf(k) * values[k].EstimatePrecision());
      posterior.gradient += posterior.precisions[k] * values[k].gradient;
      posterior.hessian += posterior.precisions[k] * values[k].hessian;
    }
    return posterior;
  }

  /** How much the logarithm of the posterior rises. */
  double
  Gain(const DeformableState &        at,
       const std::vector<MetricSum> & values,
       const DeformableState &        next,
       const std::vector<double> &    costs,
       const std::vector<double> &    precisions) const
  {
    double gain = this->PriorCost(at) - this->PriorCost(next);
    for (std::size_t k = 0; k < values.size(); ++k)
    {
      gain += precisions[k] * (values[k].cost - costs[k]);
    }
    return gain;
  }

  /** The cost of the gradients where a descent ended, the precision by which it counted in the last step, and whether
   * that place is distinct: 0 where nobody asked. */
  struct Fit
  {
    double cost{ std::numeric_limits<double>::infinity() };
    double precision{ 0.0 };
    double distinctness{ 0.0 };

    /** Leave-one-out over femora, of which one view or two showed all, or the proximal third, searches that led astray
     * had precisions of 15 to 120 or a distinctness of 0.2 to 1.0, those that found the place 230 and more and 1.3 and
     * more, with scatter or without. */
    bool
    IsClear() const
    {
      return precision >= 250.0 && distinctness >= 1.3;
    }
  };

  /** What gain of the logarithm of the posterior is little; the spread of that is half the parameters' number. */
  static constexpr double LittleBeforeFinerImages = 20.0;
  static constexpr double LittleAtLast = 2.0;

  /** Levenberg-Marquardt steps, until they gain little. */
  Fit
  Descend(DeformableCost &               cost,
          double                         little,
          DeformableState &              at,
          DeformableRegistrationResult & result,
          const Execution &              execution) const
  {
    constexpr double leastShare = 0.03; // of the cost of the gradients, as little counts where they differ much
    const Execution  silent = execution.Silent();
    auto             values = cost.Evaluate(at, silent);
    Damping          damping;
    Fit              fit;
    result.converged = false;
    for (int i = 0; i < m_P.iterations && !result.converged; ++i)
    {
      const Posterior       posterior = this->MakePosterior(values, at);
      const DeformableState next =
        Moved(at, -LongerSteps * damping.Damp(posterior.hessian).ldlt().solve(posterior.gradient));
      const auto   costs = cost.EvaluateCosts(next, silent);
      const double gain = this->Gain(at, values, next, costs, posterior.precisions);
      const bool   isLittle = gain < little && values[0].cost - costs[0] < leastShare * values[0].cost;
      damping.Tell(gain > 0.0);
      result.converged = damping.IsStuck() || (gain > 0.0 && isLittle);
      fit = { gain > 0.0 ? costs[0] : values[0].cost, posterior.precisions[0], 0.0 };
      if (gain > 0.0)
      {
        at = next;
        if (!result.converged)
        {
          values = cost.Evaluate(at, silent);
        }
      }
      if (m_Observe)
      {
        m_Observe(at.coefficients, fit.cost);
      }
      execution.Report((i + 1.0) / m_P.iterations);
    }
    return fit;
  }

  /** The covariance of the maximum of the posterior about the truth: of the errors of the costs' gradients, of what the
   * prior pulls, and of a surface that lies outside the bone's as a whole. */
  void
  SetCovariance(DeformableCost &               cost,
                const DeformableState &        at,
                DeformableRegistrationResult & result,
                const Execution &              execution) const
  {
    std::vector<Eigen::VectorXd> slopes; // by the surface
    const auto                   values = cost.Evaluate(at, slopes, execution.Silent());
    // Where no view shows the bone and nothing was known of its pose, it may be anywhere.
    constexpr double      anywhere = 1e4; // mm
    Posterior             posterior = this->MakePosterior(values, at);
    const Eigen::VectorXd known = m_Prior.cwiseMax(1.0 / (anywhere * anywhere));
    posterior.hessian.diagonal() += known - m_Prior;
    result.cost = values[0].cost;
    result.precision = posterior.precisions[0];
    result.intensityPrecision = posterior.precisions.size() > 1 ? posterior.precisions[1] : 0.0;
    const auto      size = posterior.hessian.rows();
    Eigen::MatrixXd errors = known.asDiagonal();
    Eigen::VectorXd ofSurface = Eigen::VectorXd::Zero(size);
    for (std::size_t k = 0; k < values.size(); ++k)
    {
      // A cost that counts by a share, for its errors correlate, has errors that scatter so much more.
      errors += posterior.precisions[k] * posterior.precisions[k] / ShareOf(k) * values[k].scatters.back();
      ofSurface += m_P.surfaceDeviation * posterior.precisions[k] * slopes[k];
    }
    errors += ofSurface * ofSurface.transpose();
    const Eigen::MatrixXd inverse = posterior.hessian.ldlt().solve(Eigen::MatrixXd::Identity(size, size));
    result.covariance = this->Bound(this->Widening() * inverse * errors * inverse);
  }

  /** The factor of the covariance. In one view shape takes up turns out of its plane: leave-one-out over femora, their
   * errors are twice their deviations (two views: as large), and 1.5 is how much points' deviations must be wider for
   * 95 % of their intervals to hold. */
  double
  Widening() const
  {
    constexpr double ofOneView = 1.5;
    return m_Views.size() == 1 ? ofOneView * ofOneView : 1.0;
  }

  /** A covariance that along no direction is wider than the pose's prior. The atlas' own bounds nothing: it is
   * estimated from some subjects, and leave-one-out, regions' densities lie outside of it. */
  Eigen::MatrixXd
  Bound(const Eigen::MatrixXd & covariance) const
  {
    constexpr double wide = 1e6; // variance where there is no bound, in that of the posterior
    Eigen::VectorXd  precision = (wide * covariance.diagonal()).cwiseInverse();
    precision.head<PoseSteps>() = precision.head<PoseSteps>().cwiseMax(m_Prior.head<PoseSteps>());
    const Eigen::VectorXd roots = precision.cwiseSqrt();
    const SymmetricEigen  scaled = EigenOf<Eigen::Dynamic>(roots.asDiagonal() * covariance * roots.asDiagonal());
    const Eigen::MatrixXd back = roots.cwiseInverse().asDiagonal() * scaled.vectors;
    return back * scaled.values.cwiseMin(1.0).cwiseMax(0.0).asDiagonal() * back.transpose();
  }

  /** The mesh in its place, and the deviations of its points. */
  void
  Finish(DeformableRegistrationResult & result, const Execution & execution) const
  {
    result.mesh = m_Model.Synthesize(result.coefficients);
    result.regions = this->MeasureRegions(result);
    const auto count = m_Model.shapeModes + m_Model.smoothModes;
    const auto covariance = result.covariance.topLeftCorner(PoseSteps + count, PoseSteps + count);
    result.pointDeviations.resize(result.mesh.points.size());
    execution.Silent().For(result.mesh.points.size(), [&](std::size_t p) {
      Vector3 &       x = result.mesh.points[p];
      const Vector3   arm = x - result.pose.centre;
      Eigen::MatrixXd jacobian(3, PoseSteps + count);
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
      // Leave-one-out, the smooth modes bring a bone's surface nearer, but its points along the surface not: two views
      // show little of them.
      result.pointDeviations[p] = (variances.array() + m_Model.residualVariance).sqrt();
      x = result.pose.Apply(x);
    });
  }

  /** The costs and the distinctness of the pose of a bone in its place, as of one that is known. */
  RigidRegistrationResult
  JudgeBone(const MeshArrays & bone, int pixels, const Execution & execution) const
  {
    RigidRadiographParameters rigid;
    rigid.pixels = pixels;
    rigid.patch = DeformableCost::PatchAt(pixels, m_P);
    rigid.sigma = m_P.sigma;
    RigidRegistrationResult judged;
    judged.pose = RigidPose().About(MeanOf(bone.points, ShownPoints(bone.points, RigidPose(), m_Views, 0.0)));
    JudgePose(FadeFlatCuts({ bone }, rigid.cutLength).front(), m_Views, rigid, execution, judged);
    return judged;
  }

  /** Whether the pose of the bone found is distinct. Leave-one-out over femora, descents that failed had 0.6 to 0.9,
   * those that fit 1.6 and more, and one that fits in part, 1.5 mm off, 1.0. But in one view a bone that is off by a
   * turn out of the plane, or by its depth, fits as well as one that is not: of those that fit, three of 18 are 6 to 15
   * mm off. Only the deviations tell. */
  void
  Judge(DeformableRegistrationResult & result, const Execution & execution) const
  {
    constexpr double              ofTrue = 1.5;
    const RigidRegistrationResult judged = this->JudgeBone(result.mesh, m_P.pixels, execution);
    result.costs = judged.costs;
    result.quality = judged.quality;
    result.distinctness = judged.distinctness;
    if (result.distinctness < ofTrue)
    {
      result.quality = std::max(result.quality, RegistrationQuality::Suspect);
    }
  }

  /** What the regions hold, and the deviations that come of those of the coefficients. */
  std::vector<RegionEstimate>
  MeasureRegions(const DeformableRegistrationResult & result) const
  {
    const auto                         count = result.coefficients.size();
    const auto                         covariance = result.covariance.bottomRightCorner(count, count);
    const Eigen::MatrixXd              at = m_Model.MeasureRegions(result.coefficients);
    const std::vector<Eigen::MatrixXd> slopes = m_Model.RegionSlopes(result.coefficients);
    std::vector<RegionEstimate>        regions;
    for (Eigen::Index r = 0; r < at.rows(); ++r)
    {
      std::array<double, 3> deviations{};
      for (Eigen::Index c = 0; c < 3; ++c)
      {
        Eigen::VectorXd slope(count);
        for (Eigen::Index k = 0; k < count; ++k)
        {
          slope[k] = slopes[static_cast<std::size_t>(k)](r, c);
        }
        deviations[static_cast<std::size_t>(c)] = std::sqrt(slope.dot(covariance * slope));
      }
      const int region = r + 1 < at.rows() ? static_cast<int>(r) : -1;
      if (at(r, 0) > 0.0)
      {
        regions.push_back({ region, at(r, 0), deviations[0], at(r, 1), deviations[1], at(r, 2), deviations[2] });
      }
    }
    return regions;
  }

  const DeformableRadiographParameters &                       m_P;
  const std::vector<RadiographView> &                          m_Views;
  const std::function<void(const Eigen::VectorXd &, double)> & m_Observe;
  DeformableModel                                              m_Model;
  std::vector<std::size_t>                                     m_Shown; ///< points of the mean
  RigidPose                                                    m_Initial;
  std::vector<int>                                             m_Resolutions; ///< pixels, from coarse to fine
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
