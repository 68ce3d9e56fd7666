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

/** The mean of the shapes, each moved by what `mapOf` returns for it. */
template <typename TMapOf>
std::vector<Vector3>
MeanOf(const ShapeSource & source, const TMapOf & mapOf)
{
  std::vector<Vector3> mean, shape;
  for (std::size_t i = 0; i < source.count; ++i)
  {
    source.load(i, shape);
    if (i == 0)
    {
      mean.assign(shape.size(), Vector3::Zero());
    }
    if (shape.empty() || shape.size() != mean.size())
    {
      throw std::invalid_argument("All shapes must have the same points.");
    }
    const AffineMap map = mapOf(i, shape);
    for (std::size_t p = 0; p < mean.size(); ++p)
    {
      mean[p] += map(shape[p]) / static_cast<double>(source.count);
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

void
Apply(const AffineMap & map, std::vector<Vector3> & points)
{
  for (Vector3 & x : points)
  {
    x = map(x);
  }
}

ProcrustesResult
AlignShapes(const ShapeSource & source, AlignmentKind kind)
{
  if (source.count == 0 || kind == AlignmentKind::Affine)
  {
    throw std::invalid_argument("Shapes are aligned rigidly or by similarity, and there must be one or more.");
  }
  ProcrustesResult result;
  result.maps.resize(source.count);
  const auto known = [&](std::size_t i, const std::vector<Vector3> &) { return result.maps[i]; };
  if (kind == AlignmentKind::None)
  {
    result.mean = MeanOf(source, known);
    return result;
  }
  source.load(0, result.mean);
  double size = 0;
  for (const Vector3 & x : result.mean)
  {
    size = std::max(size, (x - result.mean.front()).norm());
  }
  double change = size;
  while (change > ProcrustesTolerance * size && result.iterations++ < MaximumProcrustesIterations)
  {
    std::vector<Vector3> mean = MeanOf(source, [&](std::size_t i, const std::vector<Vector3> & shape) {
      return result.maps[i] = AlignToMean(shape, result.mean, kind);
    });
    Apply(AlignToMean(mean, result.mean, kind), mean); // it does not drift
    change = RootMeanSquare(mean, result.mean);
    result.mean = std::move(mean);
  }
  const AffineMap frame = ToMeanFrame(result.maps, result.mean);
  for (AffineMap & map : result.maps)
  {
    map = Compose(frame, map);
  }
  result.mean = MeanOf(source, known);
  return result;
}

ProcrustesResult
AlignShapes(std::vector<std::vector<Vector3>> & shapes, AlignmentKind kind)
{
  ProcrustesResult result =
    AlignShapes({ shapes.size(), [&shapes](std::size_t i, std::vector<Vector3> & shape) { shape = shapes[i]; } }, kind);
  for (std::size_t i = 0; i < shapes.size(); ++i)
  {
    Apply(result.maps[i], shapes[i]);
  }
  return result;
}
} // namespace bone
