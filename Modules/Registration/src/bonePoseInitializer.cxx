/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "bonePoseInitializer.h"

#include "boneLandmarkProjection.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <random>

namespace bone
{
namespace
{
constexpr std::size_t SampleSize = 4;
/** Samples that are tried in any case, and the chance that none of those tried is without outliers. */
constexpr double LeastSamples = 20;
constexpr double MissedSamples = 1e-6;
/** Poses of a sample that are followed to their minimum, and poses of all samples that are refined. */
constexpr std::size_t FollowedStarts = 6;
constexpr std::size_t RefinedPoses = 8;
/** Points whose distances from a line, root mean square, are this part of their extent along it lie on the line. */
constexpr double LineTolerance = 0.02;
/** Deviations, mm and radians, that mean that nothing is known. */
constexpr double UnknownLength = 1e4;
constexpr double UnknownAngle = 10.0;
/** By how much the squared distances over their variance differ for poses that both may be right. */
constexpr double AmbiguousDifference = 6.0;

/** Points that differ, in the order in which they first come. */
std::vector<Vector3>
DistinctPoints(const std::vector<LandmarkPair> & pairs, const std::vector<std::size_t> & ids)
{
  std::vector<Vector3> points;
  for (const std::size_t i : ids)
  {
    const Vector3 & p = pairs[i].point;
    if (std::none_of(points.begin(), points.end(), [&p](const Vector3 & q) { return (p - q).norm() < 1e-6; }))
    {
      points.push_back(p);
    }
  }
  return points;
}

Vector3
Centroid(const std::vector<Vector3> & points)
{
  Vector3 sum = Vector3::Zero();
  for (const Vector3 & p : points)
  {
    sum += p;
  }
  return sum / static_cast<double>(points.size());
}

bool
LieOnALine(const std::vector<Vector3> & points)
{
  const Vector3   centre = Centroid(points);
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const Vector3 & p : points)
  {
    scatter += (p - centre) * (p - centre).transpose();
  }
  const Vector3 squares = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter).eigenvalues();
  return !(squares[1] + squares[0] > LineTolerance * LineTolerance * squares[2]);
}

/** Whether two views that differ in direction show all the points. */
bool
TwoViewsShowAll(const std::vector<LandmarkProjection> & projections,
                const std::vector<LandmarkPair> &       pairs,
                const std::vector<std::size_t> &        ids,
                std::size_t                             points)
{
  std::vector<Vector3> beams;
  for (std::size_t view = 0; view < projections.size(); ++view)
  {
    std::vector<std::size_t> here;
    std::copy_if(
      ids.begin(), ids.end(), std::back_inserter(here), [&](std::size_t i) { return pairs[i].view == view; });
    if (!here.empty() && DistinctPoints(pairs, here).size() == points)
    {
      beams.push_back(projections[view].GetRay(pairs[here.front()].pixel).direction);
    }
  }
  return std::any_of(beams.begin(), beams.end(), [&](const Vector3 & beam) {
    return std::abs(beam.dot(beams.front())) < std::cos(0.05);
  });
}

/** How many distinct points the pairs need to have. */
std::size_t
PointsNeeded(const std::vector<LandmarkProjection> & projections,
             const std::vector<LandmarkPair> &       pairs,
             const std::vector<std::size_t> &        ids,
             bool                                    prior)
{
  return prior || TwoViewsShowAll(projections, pairs, ids, 3) ? 3 : 4;
}

std::vector<std::size_t>
AllIds(std::size_t count)
{
  std::vector<std::size_t> ids(count);
  for (std::size_t i = 0; i < count; ++i)
  {
    ids[i] = i;
  }
  return ids;
}

/** Samples of `size` of `count` pairs, in random order: all where they are at most `most`, otherwise that many. */
std::vector<std::vector<std::size_t>>
MakeSamples(std::size_t count, std::size_t size, std::size_t most, std::uint64_t seed)
{
  double all = 1.0;
  for (std::size_t k = 0; k < size; ++k)
  {
    all *= static_cast<double>(count - k) / static_cast<double>(k + 1);
  }
  std::vector<std::vector<std::size_t>> samples;
  std::mt19937_64                       random(seed);
  if (all <= static_cast<double>(most))
  {
    std::vector<bool> chosen(count, false);
    std::fill(chosen.begin(), chosen.begin() + static_cast<std::ptrdiff_t>(size), true);
    do
    {
      samples.emplace_back();
      for (std::size_t i = 0; i < count; ++i)
      {
        if (chosen[i])
        {
          samples.back().push_back(i);
        }
      }
    } while (std::prev_permutation(chosen.begin(), chosen.end()));
    for (std::size_t s = samples.size(); s > 1; --s)
    {
      std::swap(samples[s - 1], samples[random() % s]);
    }
    return samples;
  }
  std::vector<std::size_t> ids = AllIds(count);
  for (std::size_t s = 0; s < most; ++s)
  {
    for (std::size_t k = 0; k < size; ++k)
    {
      std::swap(ids[k], ids[k + random() % (count - k)]);
    }
    samples.emplace_back(ids.begin(), ids.begin() + static_cast<std::ptrdiff_t>(size));
  }
  return samples;
}

/** The 24 rotations of a cube: every rotation is within 63 degrees of one. */
std::vector<Eigen::Matrix3d>
CubeRotations()
{
  std::vector<Eigen::Matrix3d> rotations;
  for (int first = 0; first < 6; ++first)
  {
    for (int second = 0; second < 6; ++second)
    {
      if (first % 3 != second % 3)
      {
        const Vector3   x = (first < 3 ? 1.0 : -1.0) * Vector3::Unit(first % 3);
        const Vector3   y = (second < 3 ? 1.0 : -1.0) * Vector3::Unit(second % 3);
        Eigen::Matrix3d rotation;
        rotation << x, y, x.cross(y);
        rotations.push_back(rotation);
      }
    }
  }
  return rotations;
}

struct Candidate
{
  RigidPose pose;
  double    cost{ 0.0 };
};

/** Adds a candidate unless there is one of nearly the same pose and not more cost. */
void
AddCandidate(std::vector<Candidate> & candidates, const Candidate & added, double size)
{
  for (Candidate & other : candidates)
  {
    const LandmarkStep step = other.pose.StepTo(added.pose);
    if (step.head<3>().norm() + size * step.tail<3>().norm() < 0.02 * size)
    {
      other = added.cost < other.cost ? added : other;
      return;
    }
  }
  candidates.push_back(added);
}

void
KeepBest(std::vector<Candidate> & candidates, std::size_t count)
{
  std::stable_sort(
    candidates.begin(), candidates.end(), [](const Candidate & a, const Candidate & b) { return a.cost < b.cost; });
  candidates.resize(std::min(candidates.size(), count));
}

/** The poses that bring the sample's points onto their rays. */
std::vector<Candidate>
PosesOfSample(const RayFit & fit, const std::vector<std::size_t> & sample, const RigidPose & base, bool fromBase)
{
  static const std::vector<Eigen::Matrix3d> rotations = CubeRotations();
  std::vector<Candidate>                    starts;
  for (std::size_t r = 0; r < rotations.size() + (fromBase ? 1 : 0); ++r)
  {
    Candidate start;
    start.pose = base;
    if (r < rotations.size())
    {
      start.pose.rotation = rotations[r];
      fit.PlaceBest(sample, base.translation, start.pose);
    }
    start.cost = fit.Descend(sample, 5, start.pose);
    starts.push_back(start);
  }
  KeepBest(starts, FollowedStarts);
  for (Candidate & start : starts)
  {
    start.cost = fit.Descend(sample, 30, start.pose);
  }
  return starts;
}

/** How many samples find one without outliers, all but surely, where so many pairs are none. */
double
SamplesNeeded(const std::vector<bool> & inlier)
{
  const auto   inliers = static_cast<double>(std::count(inlier.begin(), inlier.end(), true));
  const double good = std::pow(inliers / static_cast<double>(inlier.size()), static_cast<double>(SampleSize));
  return good < 1 ? std::log(MissedSamples) / std::log(1 - good) : 0.0;
}

std::vector<bool>
InliersOf(const DetectorFit & detector, const RigidPose & pose, std::size_t pairs, double tolerance)
{
  std::vector<bool> inlier(pairs);
  for (std::size_t i = 0; i < pairs; ++i)
  {
    inlier[i] = detector.GetDistance(pose, i) < tolerance;
  }
  return inlier;
}

void
RequireUsable(const std::vector<XRayGeometry::View> & views, const std::vector<LandmarkPair> & pairs)
{
  for (const LandmarkPair & pair : pairs)
  {
    if (pair.view >= views.size())
    {
      itkGenericExceptionMacro("Landmark '" << pair.name << "' belongs to view " << pair.view + 1 << " of "
                                            << views.size() << '.');
    }
    if (!pair.point.allFinite() || !pair.pixel.allFinite())
    {
      itkGenericExceptionMacro("Landmark '" << pair.name << "' has a coordinate that is not finite.");
    }
  }
}

void
RequireEnough(const std::vector<LandmarkProjection> & projections, const std::vector<LandmarkPair> & pairs, bool prior)
{
  const auto ids = AllIds(pairs.size());
  const auto points = DistinctPoints(pairs, ids);
  const auto needed = PointsNeeded(projections, pairs, ids, prior);
  if (points.size() < 3)
  {
    itkGenericExceptionMacro("A pose from landmarks needs four of them (three with a prior); there are "
                             << points.size() << '.');
  }
  if (points.size() < needed)
  {
    itkGenericExceptionMacro(
      "Three landmarks in one view leave up to four poses: add a fourth, give a prior, or mark all "
      "three in a second view.");
  }
  if (LieOnALine(points))
  {
    itkGenericExceptionMacro("The landmarks lie on a line, about which the model could turn: add one beside it.");
  }
}

std::string
NamesOf(const std::vector<LandmarkPair> & pairs, const std::vector<bool> & inlier)
{
  std::string names;
  for (std::size_t i = 0; i < pairs.size(); ++i)
  {
    names += inlier[i] ? "" : (names.empty() ? "" : ", ") + pairs[i].name;
  }
  return names;
}

/** Refuses where too few pairs agree. */
void
RequireConsensus(const std::vector<LandmarkProjection> & projections,
                 const std::vector<LandmarkPair> &       pairs,
                 const PoseEstimate &                    estimate,
                 double                                  tolerance,
                 bool                                    prior)
{
  std::vector<std::size_t> ids;
  for (std::size_t i = 0; i < pairs.size(); ++i)
  {
    if (estimate.inlier[i])
    {
      ids.push_back(i);
    }
  }
  const auto points = DistinctPoints(pairs, ids);
  if (2 * ids.size() < pairs.size() || points.size() < PointsNeeded(projections, pairs, ids, prior) ||
      LieOnALine(points))
  {
    itkGenericExceptionMacro("The landmarks do not agree on a pose: the best one brings "
                             << ids.size() << " of " << pairs.size() << " within " << tolerance
                             << " mm at the detector (not " << NamesOf(pairs, estimate.inlier)
                             << "). Check names, places and views.");
  }
}
} // namespace

std::vector<LandmarkPair>
MatchLandmarks(const std::vector<Landmark> & model, const std::vector<std::vector<ImageLandmark>> & views)
{
  std::vector<LandmarkPair> pairs;
  for (std::size_t view = 0; view < views.size(); ++view)
  {
    for (const ImageLandmark & seen : views[view])
    {
      const auto found =
        std::find_if(model.begin(), model.end(), [&seen](const Landmark & known) { return known.name == seen.name; });
      if (found == model.end())
      {
        itkGenericExceptionMacro("View " << view + 1 << " has a landmark '" << seen.name
                                         << "', which the model has not: name both alike.");
      }
      pairs.push_back({ seen.name, found->point, seen.pixel, static_cast<unsigned int>(view) });
    }
  }
  if (pairs.empty())
  {
    itkGenericExceptionMacro("There are no landmarks on the radiographs.");
  }
  return pairs;
}

PoseEstimate
EstimatePose(const std::vector<XRayGeometry::View> & views,
             const std::vector<LandmarkPair> &       pairs,
             const PoseInitializerParameters &       parameters,
             const std::optional<PosePrior> &        prior)
{
  try
  {
    parameters.Verify();
  }
  catch (const std::invalid_argument & error)
  {
    itkGenericExceptionMacro(<< error.what());
  }
  if (prior && (!(prior->translationDeviation > 0) || !(prior->rotationDeviation > 0)))
  {
    itkGenericExceptionMacro("The prior's deviations are " << prior->translationDeviation << " mm and "
                                                           << prior->rotationDeviation
                                                           << " radians; both must be above 0.");
  }
  RequireUsable(views, pairs);
  const std::vector<LandmarkProjection> projections(views.begin(), views.end());
  RequireEnough(projections, pairs, prior.has_value());

  const auto               everything = AllIds(pairs.size());
  const auto               points = DistinctPoints(pairs, everything);
  const RigidPose          base = (prior ? prior->pose : RigidPose()).About(Centroid(points));
  std::optional<PosePrior> centred = prior;
  if (centred)
  {
    centred->pose = base;
  }
  double size = 0.0;
  for (const Vector3 & p : points)
  {
    size = std::max(size, (p - base.centre).norm());
  }

  const RayFit           rays(projections, pairs);
  const DetectorFit      detector(projections, pairs, parameters, centred);
  std::vector<Candidate> found;
  const auto             most = static_cast<std::size_t>(parameters.samples);
  const std::size_t      sampleSize = std::min(SampleSize, pairs.size());
  double                 tried = 0.0;
  for (const auto & sample : MakeSamples(pairs.size(), sampleSize, most, parameters.seed))
  {
    const auto sampled = DistinctPoints(pairs, sample);
    if (sampled.size() < 3 || LieOnALine(sampled))
    {
      continue;
    }
    for (Candidate pose : PosesOfSample(rays, sample, base, prior.has_value()))
    {
      pose.cost = detector.Cost(pose.pose);
      AddCandidate(found, pose, size);
    }
    KeepBest(found, 4 * RefinedPoses);
    const auto inlier = InliersOf(detector, found.front().pose, pairs.size(), parameters.inlierDistance);
    tried += 1.0;
    if (tried >= std::max(LeastSamples, SamplesNeeded(inlier)))
    {
      break;
    }
  }
  KeepBest(found, RefinedPoses);
  std::vector<Candidate> refined;
  for (Candidate & candidate : found)
  {
    candidate.cost = detector.Descend(candidate.pose);
    AddCandidate(refined, candidate, size);
  }
  KeepBest(refined, RefinedPoses);
  if (refined.empty())
  {
    itkGenericExceptionMacro("No sample of four landmarks is fit for a pose: the points lie too nearly on a line.");
  }

  PoseEstimate estimate;
  estimate.pose = refined.front().pose;
  estimate.inlier = InliersOf(detector, estimate.pose, pairs.size(), parameters.inlierDistance);
  double squares = 0.0, inliers = 0.0;
  for (std::size_t i = 0; i < pairs.size(); ++i)
  {
    const double distance = detector.GetDistance(estimate.pose, i);
    estimate.distance.push_back(distance);
    squares += estimate.inlier[i] ? distance * distance : 0.0;
    inliers += estimate.inlier[i] ? 1.0 : 0.0;
  }
  estimate.rms = inliers > 0 ? std::sqrt(squares / inliers) : 0.0;
  RequireConsensus(projections, pairs, estimate, parameters.inlierDistance, prior.has_value());
  const double limit = refined.front().cost + AmbiguousDifference;
  estimate.ambiguous = refined.size() > 1 && refined[1].cost < limit;

  LandmarkMatrix information = detector.GetInformation(estimate.pose);
  information.diagonal().head<3>().array() += 1 / (UnknownLength * UnknownLength);
  information.diagonal().tail<3>().array() += 1 / (UnknownAngle * UnknownAngle);
  estimate.covariance = information.inverse();
  if (prior)
  {
    LandmarkMatrix shift = LandmarkMatrix::Identity();
    shift.topRightCorner<3, 3>() = -CrossMatrix(prior->pose.centre - base.centre);
    estimate.covariance = (shift * estimate.covariance * shift.transpose()).eval();
    estimate.pose = estimate.pose.About(prior->pose.centre);
  }
  return estimate;
}
} // namespace bone
