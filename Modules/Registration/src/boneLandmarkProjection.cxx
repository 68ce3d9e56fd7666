/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneLandmarkProjection.h"

#include <Eigen/Cholesky>

#include <cmath>
#include <limits>

namespace bone
{
namespace
{
/** A step that is smaller, mm and radians, is the last: of a pose, and of one that is refined later. */
constexpr double SmallestStep = 1e-12;
constexpr double SmallestRoughStep = 1e-4;
constexpr int    MostSteps = 200;
/** Share of the matrix that keeps directions that nothing determines where they are. */
constexpr double LeastDamping = 1e-9;

/** Derivatives of the moved point by the step. */
Eigen::Matrix<double, 3, 6>
PointByStep(const RigidPose & pose, const Vector3 & point)
{
  Eigen::Matrix<double, 3, 6> derivatives;
  derivatives << pose.rotation, -pose.rotation * CrossMatrix(point - pose.centre);
  return derivatives;
}

/** Derivatives of the rotation vector of exp(turn) exp(w) by w at 0. */
Eigen::Matrix3d
TurnByStep(const Vector3 & turn)
{
  const double          angle = turn.norm();
  const Eigen::Matrix3d cross = CrossMatrix(turn);
  const double second = angle < 1e-4 ? 1.0 / 12.0 : 1 / (angle * angle) - 0.5 / (angle * std::tan(0.5 * angle));
  return Eigen::Matrix3d::Identity() + 0.5 * cross + second * cross * cross;
}

double
Square(double x)
{
  return x * x;
}

/** Minimises by damped Gauss-Newton steps. linearize(pose, matrix, gradient) gives the matrix and half of the gradient;
 * returns the cost at the end. */
template <typename TCost, typename TLinearize>
double
DescendDamped(int steps, double smallest, RigidPose & pose, TCost && costOf, TLinearize && linearize)
{
  double         cost = costOf(pose), damping = 1e-4;
  LandmarkMatrix matrix;
  LandmarkStep   gradient;
  for (int k = 0; k < steps; ++k)
  {
    linearize(pose, matrix, gradient);
    bool better = false;
    for (int attempt = 0; attempt < 8 && !better; ++attempt)
    {
      LandmarkMatrix damped = matrix;
      damped.diagonal() *= 1 + damping;
      damped.diagonal().array() += LeastDamping * matrix.diagonal().maxCoeff();
      const LandmarkStep step = -damped.ldlt().solve(gradient);
      if (!step.allFinite())
      {
        return cost;
      }
      const RigidPose moved = pose.Moved(step);
      const double    there = costOf(moved);
      if (there <= cost)
      {
        better = true;
        pose = moved;
        cost = there;
        damping = std::max(LeastDamping, 0.1 * damping);
        if (step.norm() < smallest)
        {
          return cost;
        }
      }
      else
      {
        damping *= 10;
      }
    }
    if (!better)
    {
      return cost;
    }
  }
  return cost;
}
} // namespace

Eigen::Matrix3d
CrossMatrix(const Vector3 & a)
{
  Eigen::Matrix3d matrix;
  matrix << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return matrix;
}

LandmarkProjection::LandmarkProjection(const XRayGeometry::View & view)
  : m_View(view)
  , m_Normal(view.detectorU.cross(view.detectorV))
{
  XRayGeometry::New()->SetView(view);
  const Vector3 beam = view.parallel ? view.direction : Vector3(view.detectorOrigin - view.source);
  m_Normal *= beam.dot(m_Normal) < 0 ? -1.0 : 1.0;
}

LandmarkProjection::Ray
LandmarkProjection::GetRay(const Vector2 & pixel) const
{
  const Vector2 place = this->ToMillimetres(pixel);
  const Vector3 point = m_View.detectorOrigin + place.x() * m_View.detectorU + place.y() * m_View.detectorV;
  return m_View.parallel ? Ray{ point, m_View.direction } : Ray{ m_View.source, (point - m_View.source).normalized() };
}

bool
LandmarkProjection::Project(const Vector3 & point, Vector2 & place, Eigen::Matrix<double, 2, 3> * derivatives) const
{
  const Vector3 * axes[2] = { &m_View.detectorU, &m_View.detectorV };
  if (m_View.parallel)
  {
    const Vector3 offset = point - m_View.detectorOrigin;
    const double  along = m_View.direction.dot(m_Normal);
    for (int k = 0; k < 2; ++k)
    {
      const Vector3 slope = *axes[k] - m_View.direction.dot(*axes[k]) / along * m_Normal;
      place[k] = slope.dot(offset);
      if (derivatives != nullptr)
      {
        derivatives->row(k) = slope.transpose();
      }
    }
    return true;
  }
  const Vector3 ray = point - m_View.source, toOrigin = m_View.detectorOrigin - m_View.source;
  const double  depth = ray.dot(m_Normal), whole = toOrigin.dot(m_Normal);
  if (!(depth > 1e-9 * whole))
  {
    return false;
  }
  for (int k = 0; k < 2; ++k)
  {
    const double across = ray.dot(*axes[k]) / depth;
    place[k] = whole * across - toOrigin.dot(*axes[k]);
    if (derivatives != nullptr)
    {
      derivatives->row(k) = (whole / depth) * (*axes[k] - across * m_Normal).transpose();
    }
  }
  return true;
}

RayFit::RayFit(const std::vector<LandmarkProjection> & projections, const std::vector<LandmarkPair> & pairs)
{
  for (const LandmarkPair & pair : pairs)
  {
    const auto ray = projections[pair.view].GetRay(pair.pixel);
    m_Lines.push_back(
      { pair.point, ray.origin, Eigen::Matrix3d::Identity() - ray.direction * ray.direction.transpose() });
  }
}

void
RayFit::PlaceBest(const std::vector<std::size_t> & sample, const Vector3 & wish, RigidPose & pose) const
{
  // So little that a ray's own direction alone notices it, which the rays of a parallel beam share.
  const double    little = 1e-9 * static_cast<double>(sample.size());
  Eigen::Matrix3d matrix = little * Eigen::Matrix3d::Identity();
  Vector3         right = little * wish;
  pose.translation.setZero();
  for (const std::size_t i : sample)
  {
    const Line & line = m_Lines[i];
    matrix += line.project;
    right += line.project * (line.origin - pose.Apply(line.point));
  }
  pose.translation = matrix.ldlt().solve(right);
}

double
RayFit::Cost(const std::vector<std::size_t> & sample, const RigidPose & pose) const
{
  double sum = 0.0;
  for (const std::size_t i : sample)
  {
    const Line & line = m_Lines[i];
    sum += (line.project * (pose.Apply(line.point) - line.origin)).squaredNorm();
  }
  return sum;
}

double
RayFit::Descend(const std::vector<std::size_t> & sample, int steps, RigidPose & pose) const
{
  return DescendDamped(
    steps,
    SmallestRoughStep,
    pose,
    [&](const RigidPose & at) { return this->Cost(sample, at); },
    [&](const RigidPose & at, LandmarkMatrix & matrix, LandmarkStep & gradient) {
      matrix.setZero();
      gradient.setZero();
      for (const std::size_t i : sample)
      {
        const Line &                      line = m_Lines[i];
        const Eigen::Matrix<double, 3, 6> jacobian = line.project * PointByStep(at, line.point);
        matrix += jacobian.transpose() * jacobian;
        gradient += jacobian.transpose() * (at.Apply(line.point) - line.origin);
      }
    });
}

DetectorFit::DetectorFit(const std::vector<LandmarkProjection> & projections,
                         const std::vector<LandmarkPair> &       pairs,
                         const PoseInitializerParameters &       parameters,
                         const std::optional<PosePrior> &        prior)
  : m_Projections(projections)
  , m_Pairs(pairs)
  , m_Parameters(parameters)
  , m_Prior(prior)
{}

double
DetectorFit::GetDistance(const RigidPose & pose, std::size_t pair) const
{
  const LandmarkPair &       landmark = m_Pairs[pair];
  const LandmarkProjection & projection = m_Projections[landmark.view];
  Vector2                    place;
  return projection.Project(pose.Apply(landmark.point), place)
           ? (place - projection.ToMillimetres(landmark.pixel)).norm()
           : std::numeric_limits<double>::infinity();
}

double
DetectorFit::Cost(const RigidPose & pose) const
{
  const double limit = Square(m_Parameters.inlierDistance);
  double       sum = 0.0;
  for (std::size_t i = 0; i < m_Pairs.size(); ++i)
  {
    // Tukey's function: the squared distance of small ones, a third of the limit's square from the limit on.
    const double rest = 1 - std::min(1.0, Square(this->GetDistance(pose, i)) / limit);
    sum += limit / 3 * (1 - rest * rest * rest);
  }
  sum /= Square(m_Parameters.landmarkDeviation);
  if (m_Prior)
  {
    const LandmarkStep step = m_Prior->pose.StepTo(pose);
    sum += step.head<3>().squaredNorm() / Square(m_Prior->translationDeviation) +
           step.tail<3>().squaredNorm() / Square(m_Prior->rotationDeviation);
  }
  return sum;
}

void
DetectorFit::Linearize(const RigidPose & pose, LandmarkMatrix & matrix, LandmarkStep & gradient) const
{
  matrix.setZero();
  gradient.setZero();
  const double limit = Square(m_Parameters.inlierDistance);
  for (const LandmarkPair & landmark : m_Pairs)
  {
    const LandmarkProjection &  projection = m_Projections[landmark.view];
    Vector2                     place;
    Eigen::Matrix<double, 2, 3> byPoint;
    if (!projection.Project(pose.Apply(landmark.point), place, &byPoint))
    {
      continue;
    }
    const Vector2                     residual = place - projection.ToMillimetres(landmark.pixel);
    const double                      rest = std::max(0.0, 1 - residual.squaredNorm() / limit);
    const double                      weight = rest * rest / Square(m_Parameters.landmarkDeviation);
    const Eigen::Matrix<double, 2, 6> jacobian = byPoint * PointByStep(pose, landmark.point);
    matrix += weight * jacobian.transpose() * jacobian;
    gradient += weight * jacobian.transpose() * residual;
  }
  if (m_Prior)
  {
    const LandmarkStep    step = m_Prior->pose.StepTo(pose);
    const Eigen::Matrix3d move = m_Prior->pose.rotation.transpose() * pose.rotation;
    const Eigen::Matrix3d turn = TurnByStep(step.tail<3>());
    const double          lengths = 1 / Square(m_Prior->translationDeviation);
    const double          angles = 1 / Square(m_Prior->rotationDeviation);
    matrix.topLeftCorner<3, 3>() += lengths * move.transpose() * move;
    matrix.bottomRightCorner<3, 3>() += angles * turn.transpose() * turn;
    gradient.head<3>() += lengths * move.transpose() * step.head<3>();
    gradient.tail<3>() += angles * turn.transpose() * step.tail<3>();
  }
}

double
DetectorFit::Descend(RigidPose & pose) const
{
  return DescendDamped(
    MostSteps,
    SmallestStep,
    pose,
    [this](const RigidPose & at) { return this->Cost(at); },
    [this](const RigidPose & at, LandmarkMatrix & matrix, LandmarkStep & gradient) {
      this->Linearize(at, matrix, gradient);
    });
}

LandmarkMatrix
DetectorFit::GetInformation(const RigidPose & pose) const
{
  LandmarkMatrix matrix;
  LandmarkStep   gradient;
  this->Linearize(pose, matrix, gradient);
  return matrix;
}
} // namespace bone
