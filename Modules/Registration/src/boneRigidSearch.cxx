/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneRigidSearch.h"

#include "boneDamping.h"
#include "boneEvolutionStrategy.h"
#include "boneImageResolutions.h"
#include "boneMeanDensities.h"
#include "bonePatchGradientCorrelation.h"
#include "bonePrincipalModes.h"
#include "boneRigidCost.h"
#include "boneShownPoints.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace bone
{
namespace
{
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/** Images' longer side and the model's level, from coarse to fine. */
struct Resolution
{
  int         pixels;
  std::size_t level;
};

/** On the coarsest level first, on the finest last. */
std::vector<Resolution>
MakeResolutions(const std::vector<int> & pixels, std::size_t levels)
{
  std::vector<Resolution> resolutions;
  for (const int side : pixels)
  {
    resolutions.push_back({ side, levels - 1 - std::min(levels - 1, resolutions.size()) });
  }
  resolutions.back().level = 0;
  return resolutions;
}

/** The unit vector from the source at right angles to the detector; its sign may be the other. */
Vector3
BeamOf(const XRayGeometry::View & view)
{
  return view.detectorU.cross(view.detectorV).normalized();
}

/** How turns about a centre move points. */
struct Turns
{
  double          radius;    ///< root mean square of what a turn of one radian moves the points by
  Eigen::Matrix3d principal; ///< about the points' principal axes, as rotation vectors that move them by 1 mm: columns
};

Turns
TurnsOf(const std::vector<Vector3> & points, const std::vector<std::size_t> & which, const Vector3 & centre)
{
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  double          squares = 0.0;
  for (const std::size_t p : which)
  {
    const Vector3 arm = points[p] - centre;
    spread += arm * arm.transpose() / static_cast<double>(which.size());
    squares += arm.squaredNorm();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(spread);
  Turns turns{ std::sqrt(2.0 / 3.0 * squares / static_cast<double>(which.size())), eigen.eigenvectors() };
  for (int k = 0; k < 3; ++k)
  {
    turns.principal.col(k) /= std::sqrt(spread.trace() - eigen.eigenvalues()[k]);
  }
  return turns;
}

/** Whether a motion of the pose's raises the cost so little that the pose may be one that slides along the edges of
 * something else. */
bool
HasLooseMotion(const RigidRegistrationResult & result)
{
  constexpr double ofTrue = 0.28; // of the distinctness
  return result.costs.size() > 1 && result.leastDistinctness < ofTrue * result.distinctness;
}

/** Costs, distinctnesses and quality of the pose. */
void
Judge(const RigidCost & cost, const Turns & turns, const Execution & execution, RigidRegistrationResult & result)
{
  constexpr double     away = 8.0; // mm
  constexpr double     ofTrue = 0.38, ofTrueFromOneView = 0.45;
  constexpr double     ofWrong = 0.3;
  std::vector<Vector6> motions(9, Vector6::Zero()); // translations, turns about the geometry's and the principal axes
  for (int k = 0; k < 3; ++k)
  {
    motions[k][k] = away;
    motions[3 + k][3 + k] = away / turns.radius;
    motions[6 + k].tail<3>() = away * turns.principal.col(k);
  }
  std::vector<double> costs(2 * motions.size());
  execution.Silent().For(costs.size(), [&](std::size_t k) {
    costs[k] = cost.Evaluate(result.pose.Moved((k % 2 == 0 ? 1.0 : -1.0) * motions[k / 2]), execution.Silent());
  });
  result.cost = cost.Evaluate(result.pose, execution.Silent(), &result.costs);
  const auto   turned = costs.begin() + 6, principal = costs.begin() + 12;
  const double mean = std::accumulate(costs.begin(), principal, 0.0) / 12.0;
  const double least = std::min(*std::min_element(costs.begin(), turned), *std::min_element(principal, costs.end()));
  const auto   rise = [&result](double there) {
    return result.cost > 0.0 ? there / result.cost - 1.0 : std::numeric_limits<double>::max();
  };
  result.distinctness = rise(mean);
  result.leastDistinctness = rise(least);
  const double enough = result.costs.size() > 1 ? ofTrue : ofTrueFromOneView;
  result.quality = result.distinctness >= enough    ? RegistrationQuality::Ok
                   : result.distinctness >= ofWrong ? RegistrationQuality::Suspect
                                                    : RegistrationQuality::Failed;
  if (result.beyondSearch || result.ambiguous || HasLooseMotion(result))
  {
    result.quality = std::max(result.quality, RegistrationQuality::Suspect);
  }
}

/** A level made ready for radiographs; it must outlive the model. */
std::unique_ptr<const ProjectionModel>
MakeModel(const MeshArrays & level, const Execution & execution)
{
  return std::make_unique<const ProjectionModel>(level.points, level, MeshRadiographParameters{}, execution.Silent());
}

/** PatchGradientCorrelation of the views, reduced to so many pixels. */
std::unique_ptr<const RigidCost>
MakeCost(const RigidRadiographParameters &   parameters,
         const std::vector<RadiographView> & views,
         int                                 pixels,
         const ProjectionModel &             model)
{
  std::vector<RadiographView> reduced;
  for (const RadiographView & view : views)
  {
    reduced.push_back(ReduceView(view, ReductionTo(view.view, pixels)));
  }
  return std::make_unique<const RigidCost>(model, reduced, [&parameters](const RadiographView & view) {
    return std::make_unique<PatchGradientCorrelation>(view, parameters.patch, parameters.sigma);
  });
}

class RigidSearch
{
public:
  RigidSearch(const std::vector<MeshArrays> &                        levels,
              const std::vector<RadiographView> &                    views,
              const RigidPose &                                      initial,
              const RigidRadiographParameters &                      parameters,
              const std::function<void(const RigidPose &, double)> & observe)
    : m_P(parameters)
    , m_Views(views)
    , m_Observe(observe)
    , m_Shown(ShownPoints(levels.front().points, initial, views, parameters.searchTranslation))
    , m_Initial(initial.About(MeanOf(levels.front().points, m_Shown)))
    , m_Turns(TurnsOf(levels.front().points, m_Shown, m_Initial.centre))
    , m_Resolutions(MakeResolutions(
        ImageResolutions(parameters.searchPixels, parameters.pixels, levels.back().points, m_Initial, views),
        levels.size()))
  {
    // A start's turns about three axes add up to more than the largest about one.
    constexpr double beyond = 1.25;
    m_Box << Vector3::Constant(beyond * m_P.searchTranslation),
      Vector3::Constant(beyond * m_P.searchRotation * std::acos(-1.0) / 180.0);
    m_IsSearched = m_Box.minCoeff() > 0.0 || m_Box.maxCoeff() > 0.0;
    if (m_IsSearched)
    {
      m_Means = SimplifyMeans(levels.back(), SearchTetrahedra, Execution()).mesh;
    }
    for (const MeshArrays & level : levels)
    {
      m_Levels.push_back(MakeModel(level, Execution()));
    }
    for (const Resolution & resolution : m_Resolutions)
    {
      m_Costs.push_back(MakeCost(m_P, m_Views, resolution.pixels, *m_Levels[resolution.level]));
    }
  }

  RigidRegistrationResult
  Run(const Execution & execution) const
  {
    constexpr int           enough = 3; // searches that find the same pose, though it is not distinct
    RigidRegistrationResult best, bestHopeless;
    best.cost = bestHopeless.cost = std::numeric_limits<double>::infinity();
    std::vector<RigidPose> found;
    const int              searches = m_IsSearched ? m_P.searches : 1;
    int                    done = 0;
    for (; done < searches && !this->IsSettled(best, found); ++done)
    {
      const Execution         part = execution.Part(static_cast<double>(done) / searches, (done + 1.0) / searches);
      RigidRegistrationResult result;
      result.pose = m_IsSearched ? this->Search(done, part.Part(0.0, 0.7)) : m_Initial;
      this->Approach(LittleBeforeFinerImages, part.Part(0.7, 0.85), result);
      if (this->IsHopeless(result))
      {
        bestHopeless = result.cost < bestHopeless.cost ? result : bestHopeless;
        continue;
      }
      if (this->IsClear(result))
      {
        best = result;
        found.push_back(result.pose);
        continue;
      }
      this->Finish(part.Part(0.85, 1.0), result);
      found.push_back(result.pose);
      best = result.cost < best.cost ? result : best;
      if (best.quality == RegistrationQuality::Suspect && !best.beyondSearch && !HasLooseMotion(best) &&
          this->CountNear(best.pose, found) >= enough)
      {
        best.quality = RegistrationQuality::Ok;
      }
    }
    if (found.empty())
    {
      best = bestHopeless;
      this->Finish(execution.Silent(), best);
    }
    if (searches > 1 && best.quality == RegistrationQuality::Ok && !this->IsSettled(best, found))
    {
      best.quality = RegistrationQuality::Suspect;
    }
    best.searches = done;
    if (m_Views.size() == 1 && best.quality == RegistrationQuality::Ok)
    {
      this->CompareTilts(execution.Silent(), best);
    }
    execution.Report(1.0);
    return best;
  }

private:
  /** How far a step moves the model's points, root mean square, mm. */
  double
  Length(const Vector6 & step) const
  {
    return std::sqrt(step.head<3>().squaredNorm() + m_Turns.radius * m_Turns.radius * step.tail<3>().squaredNorm());
  }

  /** Those of the poses that are all but this one. */
  std::ptrdiff_t
  CountNear(const RigidPose & pose, const std::vector<RigidPose> & poses) const
  {
    constexpr double same = 1.0; // mm
    return std::count_if(
      poses.begin(), poses.end(), [&](const RigidPose & other) { return this->Length(pose.StepTo(other)) < same; });
  }

  /** Whether no other pose need be searched for: a pose that is not clear has to be found twice. Of a long bone of
   * which two X-rays showed a third, where the true pose had a distinctness of 4, one search in ten ended 5 to 17 mm
   * off with 0.4 to 0.65, as true ones of hip bones in CTs of 3 mm have. */
  bool
  IsSettled(const RigidRegistrationResult & best, const std::vector<RigidPose> & found) const
  {
    return best.quality == RegistrationQuality::Ok &&
           (best.distinctness >= ClearDistinctness || this->CountNear(best.pose, found) >= 2);
  }

  /** The pose at these coordinates of the box: translation from the start along the geometry's axes, rotation vector in
   * the model's, each in units of half the box. */
  RigidPose
  FromBox(const Vector6 & coordinates) const
  {
    const Vector6 step = coordinates.cwiseProduct(m_Box);
    RigidPose     pose = m_Initial.Moved((Vector6() << Vector3::Zero(), step.tail<3>()).finished());
    pose.translation += step.head<3>();
    return pose;
  }

  /** In the box's coordinates, before halves of its size. */
  Vector6
  StepInBox(const RigidPose & pose) const
  {
    Vector6 step = m_Initial.StepTo(pose);
    step.head<3>() = pose.translation - m_Initial.translation;
    return step;
  }

  /** The pose in the box that is nearest to this one, by coordinates. */
  RigidPose
  Bound(const RigidPose & pose) const
  {
    if (!m_IsSearched)
    {
      return pose;
    }
    const Vector6 step = this->StepInBox(pose), inside = step.cwiseMin(m_Box).cwiseMax(-m_Box);
    return inside == step ? pose : this->FromBox(inside.cwiseQuotient(m_Box.cwiseMax(1e-30)));
  }

  /** Whether the pose lies beyond what is to be searched, or where the box ends: the cost may fall on from there. */
  bool
  IsBeyondSearch(const RigidPose & pose) const
  {
    constexpr double end = 0.98; // of the box's turns: steps towards its end are cut short
    Vector6          step = this->StepInBox(pose);
    if (m_Views.size() == 1)
    {
      // Its depth is off by millimetres until it is known how far the surface lies outside the model's.
      const Vector3 beam = BeamOf(m_Views.front().view);
      step.head<3>() -= beam.dot(step.head<3>()) * beam;
    }
    step = step.cwiseAbs();
    const auto isBeyond = [&](Eigen::Index k) {
      return m_Box[k] > 0.0 && step[k] > (k < 3 ? BeyondTranslations * m_P.searchTranslation : end * m_Box[k]);
    };
    return m_IsSearched && (isBeyond(0) || isBeyond(1) || isBeyond(2) || isBeyond(3) || isBeyond(4) || isBeyond(5));
  }

  RigidPose
  Search(int search, const Execution & execution) const
  {
    constexpr int    generations = 100;
    constexpr double narrow = 0.08; // of the box
    const auto       model = MakeModel(m_Means, execution);
    const auto       cost = MakeCost(m_P, m_Views, m_Resolutions.front().pixels, *model);
    const auto       seed = static_cast<std::uint64_t>(m_P.seed) * 1000 + static_cast<std::uint64_t>(search);
    // From the start, and, where that led astray, from elsewhere and with more poses.
    const Vector6     mean = search == 0 ? Vector6(Vector6::Zero()) : Vector6(0.4 * SampleCoefficients(6, seed));
    EvolutionStrategy strategy(mean.cwiseMin(1.0).cwiseMax(-1.0), 0.4, m_P.population * (2 + search) / 2, seed);
    while (strategy.GetGeneration() < generations && !strategy.IsConverged(narrow))
    {
      const Eigen::MatrixXd & candidates = strategy.Ask();
      Eigen::VectorXd         costs(candidates.cols());
      execution.Silent().For(static_cast<std::size_t>(costs.size()), [&](std::size_t i) {
        const auto k = static_cast<Eigen::Index>(i);
        costs[k] = cost->Evaluate(this->FromBox(candidates.col(k)), execution.Silent());
      });
      strategy.Tell(costs);
      execution.Report(static_cast<double>(strategy.GetGeneration()) / generations);
    }
    return this->FromBox(strategy.BestCandidate());
  }

  /** Refines the pose on all resolutions but the last, and judges it by the one before. */
  void
  Approach(double little, const Execution & execution, RigidRegistrationResult & result) const
  {
    const std::size_t before = m_Costs.size() - 1;
    for (std::size_t s = 0; s < before; ++s)
    {
      const auto share = 1.0 / static_cast<double>(before);
      this->Descend(*m_Costs[s], little, result, execution.Part(share * static_cast<double>(s), share * (s + 1.0)));
    }
    result.beyondSearch = this->IsBeyondSearch(result.pose);
    if (before > 0)
    {
      Judge(*m_Costs[before - 1], m_Turns, execution, result);
    }
  }

  /** Of the angle that the model's longest axis has with the view's plane. */
  double
  CosineOfTilt(const RigidPose & pose) const
  {
    return BeamOf(m_Views.front().view).cross(pose.rotation * m_Turns.principal.col(2).normalized()).norm();
  }

  /** The pose turned until the model's longest axis has this angle (radians) with the view's plane, and moved along its
   * ray to where it looks as long as before. */
  RigidPose
  Tilted(const RigidPose & pose, double angle) const
  {
    const XRayGeometry::View & view = m_Views.front().view;
    const Vector3              beam = BeamOf(view);
    const Vector3              axis = pose.rotation * m_Turns.principal.col(2).normalized();
    const Vector3              across = axis - beam.dot(axis) * beam;
    const Vector3              wanted = std::cos(angle) * across.normalized() + std::sin(angle) * beam;
    RigidPose                  tilted = pose;
    tilted.rotation = Eigen::Quaterniond::FromTwoVectors(axis, wanted).toRotationMatrix() * pose.rotation;
    tilted.translation += (std::cos(angle) / across.norm() - 1.0) * (pose.Apply(pose.centre) - view.source);
    return tilted;
  }

  /** From one view, a long bone that is tilted towards the source looks much like one that is tilted away, or like a
   * nearer one that is tilted more. Refines the pose from seven tilts, and takes the best. It is ambiguous where
   * another one fits about as well: on hip bones and a cut femur none costs less than 1.9 times as much, on whole
   * femora 1.13 and more (at times 1.0), on a tibia 1.07 to 1.13, whose best is 4 mm from its place. */
  void
  CompareTilts(const Execution & execution, RigidRegistrationResult & best) const
  {
    constexpr double endOn = 0.5; // cosine of the axis' angle with the view's plane: below, it hardly shows its length
    if (this->CosineOfTilt(best.pose) < endOn)
    {
      return;
    }
    constexpr double                     step = 8.0 * 0.017453292519943295; // radians
    constexpr double                     same = 8.0;                        // mm, two pixels of the coarsest images
    constexpr double                     asWell = 1.13;                     // of the cost
    std::vector<RigidRegistrationResult> poses(1, best);
    this->Descend(*m_Costs[std::max<std::size_t>(2, m_Costs.size()) - 2], LittleAtLast, poses.front(), execution);
    for (int k = -3; k <= 3; ++k)
    {
      RigidRegistrationResult tilted = best;
      tilted.pose = this->Tilted(best.pose, k * step);
      this->Descend(*m_Costs.front(), LittleAtLast, tilted, execution);
      if (this->Length(best.pose.StepTo(tilted.pose)) > same)
      {
        this->Approach(LittleAtLast, execution, tilted);
        poses.push_back(tilted);
      }
    }
    std::swap(poses.front(), *std::min_element(poses.begin(), poses.end(), [](const auto & a, const auto & b) {
                return a.cost < b.cost;
              }));
    if (this->Length(poses.front().pose.StepTo(best.pose)) > same)
    {
      best = poses.front();
      this->Finish(execution, best);
    }
    best.ambiguous = std::any_of(poses.begin() + 1, poses.end(), [&](const RigidRegistrationResult & other) {
      return other.cost<asWell * poses.front().cost && this->Length(poses.front().pose.StepTo(other.pose))> std::max(
        same, 0.1 * m_Turns.radius);
    });
    best.quality = best.ambiguous ? std::max(best.quality, RegistrationQuality::Suspect) : best.quality;
  }

  /** Whether an approached pose would fail on the last resolution too: where distinctness was below 0.3, on four bones,
   * it differed by 0.005 at the most there, where a pose that is not failed has 0.3. */
  bool
  IsHopeless(const RigidRegistrationResult & result) const
  {
    constexpr double least = 0.25;
    return m_Costs.size() > 1 && result.distinctness < least;
  }

  static constexpr double ClearDistinctness = 0.8;

  /** Whether an approached pose need not be refined here: the bundle's adjustment does, and would call it `ok`. Where
   * distinctness was above 0.4, on four bones, it differed by 0.025 at the most on the last resolution. */
  bool
  IsClear(const RigidRegistrationResult & result) const
  {
    return m_Costs.size() > 1 && result.quality == RegistrationQuality::Ok && result.distinctness >= ClearDistinctness;
  }

  /** Refines the pose on the last resolution, and judges it. */
  void
  Finish(const Execution & execution, RigidRegistrationResult & result) const
  {
    this->Descend(*m_Costs.back(), LittleAtLast, result, execution);
    result.beyondSearch = this->IsBeyondSearch(result.pose);
    Judge(*m_Costs.back(), m_Turns, execution, result);
  }

  /** Which share of the cost is little gain: where finer images, on which the pose moves further, and a comparison of
   * poses follow. */
  static constexpr double LittleBeforeFinerImages = 0.005;
  static constexpr double LittleAtLast = 0.0;

  /** Levenberg-Marquardt steps within the box, until they gain little. */
  void
  Descend(const RigidCost & cost, double little, RigidRegistrationResult & at, const Execution & execution) const
  {
    constexpr double shortest = 0.01; // mm
    constexpr double least = 1e-4;    // which kinks of the cost at the projected edges make it rough by
    MetricValue      value = cost.EvaluateDerivatives(at.pose, execution.Silent());
    Damping          damping;
    at.cost = value.cost;
    at.converged = false;
    for (int i = 0; i < m_P.iterations && !at.converged; ++i)
    {
      const Matrix6   damped = damping.Damp(Matrix6(value.hessian), 1e-12 * value.hessian.diagonal().maxCoeff());
      const RigidPose next =
        this->Bound(at.pose.Moved(-(little > 0.0 ? LongerSteps : 1.0) * damped.ldlt().solve(value.gradient)));
      const double length = this->Length(at.pose.StepTo(next));
      const double there = cost.Evaluate(next, execution.Silent());
      const double gain = at.cost - there;
      damping.Tell(gain > 0.0);
      at.converged = length < shortest || damping.IsStuck() || (gain > 0.0 && gain < std::max(least, little * there));
      if (gain > 0.0)
      {
        at.pose = next;
        at.cost = there;
        if (!at.converged)
        {
          value = cost.EvaluateDerivatives(at.pose, execution.Silent());
        }
      }
      if (m_Observe)
      {
        m_Observe(at.pose, at.cost);
      }
      execution.Report((i + 1.0) / m_P.iterations);
    }
  }

  const RigidRadiographParameters &                      m_P;
  const std::vector<RadiographView> &                    m_Views;
  const std::function<void(const RigidPose &, double)> & m_Observe;
  std::vector<std::size_t>                               m_Shown; ///< points of the first level
  RigidPose                                              m_Initial;
  Turns                                                  m_Turns;
  std::vector<Resolution>                                m_Resolutions;
  MeshArrays                                             m_Means;
  Vector6                                                m_Box;
  bool                                                   m_IsSearched{ false };
  std::vector<std::unique_ptr<const ProjectionModel>>    m_Levels;
  std::vector<std::unique_ptr<const RigidCost>>          m_Costs;
};
} // namespace

void
JudgePose(const MeshArrays &                  model,
          const std::vector<RadiographView> & views,
          const RigidRadiographParameters &   parameters,
          const Execution &                   execution,
          RigidRegistrationResult &           result)
{
  const auto ready = MakeModel(model, execution);
  const auto cost = MakeCost(parameters, views, parameters.pixels, *ready);
  const auto shown = ShownPoints(model.points, result.pose, views, 0.0);
  Judge(*cost, TurnsOf(model.points, shown, result.pose.centre), execution, result);
}

void
SetCosts(const MeshArrays &                  model,
         const std::vector<RadiographView> & views,
         const RigidRadiographParameters &   parameters,
         const Execution &                   execution,
         RigidRegistrationResult &           result)
{
  const auto ready = MakeModel(model, execution);
  const auto cost = MakeCost(parameters, views, parameters.pixels, *ready);
  result.cost = cost->Evaluate(result.pose, execution.Silent(), &result.costs);
}

RigidRegistrationResult
SearchRigid(const std::vector<MeshArrays> &                        levels,
            const std::vector<RadiographView> &                    views,
            const RigidPose &                                      initial,
            const RigidRadiographParameters &                      parameters,
            const Execution &                                      execution,
            const std::function<void(const RigidPose &, double)> & observe)
{
  return RigidSearch(levels, views, initial, parameters, observe).Run(execution);
}
} // namespace bone
