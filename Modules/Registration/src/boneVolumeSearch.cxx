/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneVolumeSearch.h"

#include "boneFeatureCorrelation.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

namespace bone
{
namespace
{
constexpr std::size_t  chunk = 1000;     // hypotheses of one sequence of random numbers
constexpr std::size_t  refined = 300;    // of the best hypotheses
constexpr std::size_t  kept = 16;        // candidates that are returned
constexpr double       coarseSize = 8.0; // voxels of the first comparison, mm
constexpr double       fineSize = 4.0;   // of the last one
constexpr Eigen::Index modesVaried = 5;  // of shape, at last

double
Uniform(std::mt19937_64 & random)
{
  return static_cast<double>(random() >> 11U) * 0x1.0p-53;
}

const VolumeEdge &
Pick(const std::vector<VolumeEdge> & edges, std::mt19937_64 & random)
{
  return edges[std::min(edges.size() - 1,
                        static_cast<std::size_t>(Uniform(random) * static_cast<double>(edges.size())))];
}

/** The model's edge laid on the image's, turned about its normal. */
RigidPose
LayOn(const VolumeEdge & ofModel, double size, const VolumeEdge & ofImage, double turn, const Vector3 & centre)
{
  RigidPose pose;
  pose.centre = centre;
  pose.rotation =
    (Eigen::AngleAxisd(turn, ofImage.normal) * Eigen::Quaterniond::FromTwoVectors(ofModel.normal, ofImage.normal))
      .toRotationMatrix();
  pose.translation = ofImage.point - centre - pose.rotation * (ofModel.point + size * ofModel.leading - centre);
  return pose;
}

void
SortByScore(std::vector<VolumeCandidate> & candidates)
{
  std::stable_sort(candidates.begin(), candidates.end(), [](const VolumeCandidate & a, const VolumeCandidate & b) {
    return a.score > b.score;
  });
}

/** Mean distance of the model's points under two poses. */
double
DistanceOf(const VolumeCandidate & a, const VolumeCandidate & b, const std::vector<Vector3> & points)
{
  double            sum = 0.0;
  const std::size_t stride = std::max<std::size_t>(1, points.size() / 50);
  std::size_t       n = 0;
  for (std::size_t p = 0; p < points.size(); p += stride, ++n)
  {
    sum += (a.pose.Apply(points[p]) - b.pose.Apply(points[p])).norm();
  }
  return sum / static_cast<double>(n);
}

/** The best of those that lie within `distance` of one another, `most` of them. */
std::vector<VolumeCandidate>
Distinct(std::vector<VolumeCandidate> candidates,
         const std::vector<Vector3> & points,
         double                       distance,
         std::size_t                  most)
{
  SortByScore(candidates);
  std::vector<VolumeCandidate> best;
  for (const VolumeCandidate & candidate : candidates)
  {
    if (best.size() == most)
    {
      break;
    }
    const bool isNew = std::none_of(best.begin(), best.end(), [&](const VolumeCandidate & other) {
      return DistanceOf(candidate, other, points) < distance;
    });
    if (isNew)
    {
      best.push_back(candidate);
    }
  }
  return best;
}

std::vector<VolumeCandidate>
Hypothesize(const FeatureCorrelation &    map,
            Eigen::Index                  leading,
            const Vector3 &               centre,
            const AtlasVolumeParameters & p,
            const Execution &             execution)
{
  const auto                                chunks = (static_cast<std::size_t>(p.hypotheses) + chunk - 1) / chunk;
  const std::size_t                         best = std::max<std::size_t>(10, 20 * refined / chunks);
  std::vector<std::vector<VolumeCandidate>> found(chunks);
  execution.For(chunks, [&](std::size_t c) {
    std::mt19937_64 random(static_cast<std::uint64_t>(p.seed) * 1000003U + c);
    for (std::size_t i = 0; i < chunk; ++i)
    {
      const VolumeEdge & ofModel = Pick(map.ModelEdges(), random);
      const VolumeEdge & ofImage = Pick(map.ImageEdges(), random);
      VolumeCandidate    candidate;
      candidate.coefficients = Eigen::VectorXd::Constant(leading, 3.0 * (2.0 * Uniform(random) - 1.0));
      candidate.pose = LayOn(ofModel,
                             leading > 0 ? candidate.coefficients[0] : 0.0,
                             ofImage,
                             2.0 * std::acos(-1.0) * Uniform(random),
                             centre);
      map.ScoreEdges(candidate, 16);
      if (candidate.share >= p.leastShare)
      {
        found[c].push_back(std::move(candidate));
      }
    }
    SortByScore(found[c]);
    found[c].resize(std::min(found[c].size(), best));
    for (VolumeCandidate & candidate : found[c])
    {
      map.ScoreEdges(candidate);
    }
  });
  std::vector<VolumeCandidate> all;
  for (const auto & some : found)
  {
    all.insert(all.end(), some.begin(), some.end());
  }
  SortByScore(all);
  return all;
}
} // namespace

std::vector<VolumeCandidate>
SearchVolume(const DeformableModel &       model,
             const VolumeView &            ct,
             const AtlasVolumeParameters & p,
             const Execution &             execution)
{
  const std::vector<Vector3> & points = model.mean.points;
  const Vector3                centre =
    std::accumulate(points.begin(), points.end(), Vector3(Vector3::Zero())) / static_cast<double>(points.size());
  const FeatureCorrelation coarse(model, ct, coarseSize, p.softTissue, 500, modesVaried, execution.Part(0.0, 0.2));
  if (coarse.ImageEdges().empty() || coarse.ModelEdges().empty())
  {
    return {};
  }
  std::vector<VolumeCandidate> candidates =
    Hypothesize(coarse, std::min<Eigen::Index>(1, model.shapeModes), centre, p, execution.Part(0.2, 0.6));
  const auto refine = [&](const FeatureCorrelation & map, Eigen::Index modes, int iterations) {
    execution.Silent().For(candidates.size(), [&](std::size_t i) {
      Eigen::VectorXd & b = candidates[i].coefficients;
      const auto        old = b.size();
      b.conservativeResize(std::min(modes, model.shapeModes));
      b.tail(b.size() - old).setZero();
      map.Refine(candidates[i], iterations);
      map.ScoreEdges(candidates[i]);
    });
    candidates.erase(std::remove_if(candidates.begin(),
                                    candidates.end(),
                                    [&](const VolumeCandidate & c) { return c.share < p.leastShare; }),
                     candidates.end());
  };
  candidates = Distinct(std::move(candidates), points, coarseSize, refined);
  refine(coarse, 1, 15);
  candidates = Distinct(std::move(candidates), points, coarseSize, refined / 5);
  refine(coarse, 3, 15);
  const FeatureCorrelation fine(model, ct, fineSize, p.softTissue, 1500, modesVaried, execution.Part(0.7, 0.8));
  candidates = Distinct(std::move(candidates), points, coarseSize, 2 * kept);
  refine(fine, modesVaried, 20);
  return Distinct(std::move(candidates), points, coarseSize, kept);
}
} // namespace bone
