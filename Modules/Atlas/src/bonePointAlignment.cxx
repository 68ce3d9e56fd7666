/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "bonePointAlignment.h"

#include <Eigen/LU>
#include <Eigen/SVD>

#include <stdexcept>

namespace bone
{
namespace
{
constexpr int    MaximumProcrustesIterations = 200;
constexpr double ProcrustesTolerance = 1e-12; // of the mean's size, root mean square of a point's last move

/** The proper rotation nearest to a matrix. */
Eigen::Matrix3d
NearestRotation(const Eigen::Matrix3d & m)
{
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(m, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Vector3                                 sign(1, 1, 1);
  sign[2] = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
  return svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();
}

struct Moments
{
  Vector3         from{ Vector3::Zero() };
  Vector3         to{ Vector3::Zero() };
  Eigen::Matrix3d cross{ Eigen::Matrix3d::Zero() };  // to from^T
  Eigen::Matrix3d spread{ Eigen::Matrix3d::Zero() }; // from from^T
};

Moments
FindMoments(const std::vector<Vector3> & from, const std::vector<Vector3> & to, const std::vector<double> & weights)
{
  Moments m;
  double  sum = 0;
  for (std::size_t i = 0; i < from.size(); ++i)
  {
    const double w = weights.empty() ? 1.0 : weights[i];
    sum += w;
    m.from += w * from[i];
    m.to += w * to[i];
  }
  m.from /= sum;
  m.to /= sum;
  for (std::size_t i = 0; i < from.size(); ++i)
  {
    const double  w = weights.empty() ? 1.0 : weights[i];
    const Vector3 x = from[i] - m.from;
    m.cross += w * (to[i] - m.to) * x.transpose();
    m.spread += w * x * x.transpose();
  }
  return m;
}

void
Apply(const AffineMap & map, std::vector<Vector3> & points)
{
  for (Vector3 & x : points)
  {
    x = map(x);
  }
}

std::vector<Vector3>
MeanOf(const std::vector<std::vector<Vector3>> & shapes)
{
  std::vector<Vector3> mean(shapes.front().size(), Vector3::Zero());
  for (const auto & shape : shapes)
  {
    for (std::size_t p = 0; p < mean.size(); ++p)
    {
      mean[p] += shape[p] / static_cast<double>(shapes.size());
    }
  }
  return mean;
}

double
RootMeanSquare(const std::vector<Vector3> & a, const std::vector<Vector3> & b)
{
  double sum = 0;
  for (std::size_t p = 0; p < a.size(); ++p)
  {
    sum += (a[p] - b[p]).squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(a.size()));
}

/** The map from the working frame to the mean of the subjects' frames. */
AffineMap
ToMeanFrame(const std::vector<AffineMap> & maps, const std::vector<Vector3> & mean)
{
  Eigen::Matrix3d linear = Eigen::Matrix3d::Zero();
  Vector3         centre = Vector3::Zero(), place = Vector3::Zero();
  double          logScale = 0;
  for (const Vector3 & x : mean)
  {
    centre += x / static_cast<double>(mean.size());
  }
  for (const AffineMap & map : maps)
  {
    const AffineMap back = map.Inverse();
    const double    scale = std::cbrt(back.linear.determinant());
    linear += back.linear / scale;
    place += back(centre) / static_cast<double>(maps.size());
    logScale += std::log(scale) / static_cast<double>(maps.size());
  }
  AffineMap frame;
  frame.linear = std::exp(logScale) * NearestRotation(linear);
  frame.translation = place - frame.linear * centre;
  return frame;
}
} // namespace

AffineMap
FitAlignment(const std::vector<Vector3> & from,
             const std::vector<Vector3> & to,
             AlignmentKind                kind,
             const std::vector<double> &  weights)
{
  if (from.empty() || from.size() != to.size() || (!weights.empty() && weights.size() != from.size()))
  {
    throw std::invalid_argument("An alignment needs as many points on both sides, and one or more.");
  }
  AffineMap map;
  if (kind == AlignmentKind::None)
  {
    return map;
  }
  const Moments m = FindMoments(from, to, weights);
  if (kind == AlignmentKind::Affine)
  {
    map.linear = m.spread.ldlt().solve(m.cross.transpose()).transpose();
  }
  else
  {
    map.linear = NearestRotation(m.cross);
    if (kind == AlignmentKind::Similarity)
    {
      map.linear *= map.linear.cwiseProduct(m.cross).sum() / m.spread.trace();
    }
  }
  map.translation = m.to - map.linear * m.from;
  return map;
}

AffineMap
AlignToMean(const std::vector<Vector3> & shape, const std::vector<Vector3> & mean, AlignmentKind kind)
{
  return FitAlignment(mean, shape, kind).Inverse();
}

ProcrustesResult
AlignShapes(std::vector<std::vector<Vector3>> & shapes, AlignmentKind kind)
{
  if (shapes.empty() || kind == AlignmentKind::Affine)
  {
    throw std::invalid_argument("Shapes are aligned rigidly or by similarity, and there must be one or more.");
  }
  for (const auto & shape : shapes)
  {
    if (shape.size() != shapes.front().size() || shape.empty())
    {
      throw std::invalid_argument("All shapes must have the same points.");
    }
  }
  ProcrustesResult result;
  result.maps.resize(shapes.size());
  if (kind == AlignmentKind::None)
  {
    result.mean = MeanOf(shapes);
    return result;
  }
  result.mean = shapes.front();
  const Vector3 origin = result.mean.front();
  double        size = 0;
  for (const Vector3 & x : result.mean)
  {
    size = std::max(size, (x - origin).norm());
  }
  double change = size;
  while (change > ProcrustesTolerance * size && result.iterations++ < MaximumProcrustesIterations)
  {
    for (std::size_t i = 0; i < shapes.size(); ++i)
    {
      const AffineMap step = AlignToMean(shapes[i], result.mean, kind);
      Apply(step, shapes[i]);
      result.maps[i] = Compose(step, result.maps[i]);
    }
    std::vector<Vector3> mean = MeanOf(shapes);
    Apply(AlignToMean(mean, result.mean, kind), mean); // it does not drift
    change = RootMeanSquare(mean, result.mean);
    result.mean = std::move(mean);
  }
  const AffineMap frame = ToMeanFrame(result.maps, result.mean);
  for (std::size_t i = 0; i < shapes.size(); ++i)
  {
    Apply(frame, shapes[i]);
    result.maps[i] = Compose(frame, result.maps[i]);
  }
  result.mean = MeanOf(shapes);
  return result;
}
} // namespace bone
