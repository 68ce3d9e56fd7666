/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "bonePatchGradientCorrelation.h"

#include "boneMetricPixels.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace bone
{
namespace
{
/** Weighted sums over the pixels of blocks or patches, #n of them; channel 0 is the X-ray, 1 the radiograph, the rest
 * are its derivatives by the parameters. */
struct PatchSums
{
  Eigen::VectorXd                weight;
  std::array<Eigen::MatrixXd, 2> sum;       ///< #channels by #n, of each component
  Eigen::MatrixXd                withFixed; ///< #channels by #n, of the products with channel 0, both components
  Eigen::MatrixXd                withModel; ///< with channel 1

  PatchSums(Eigen::Index channels, Eigen::Index n)
    : weight(Eigen::VectorXd::Zero(n))
    , sum{ Eigen::MatrixXd::Zero(channels, n), Eigen::MatrixXd::Zero(channels, n) }
    , withFixed(Eigen::MatrixXd::Zero(channels, n))
    , withModel(Eigen::MatrixXd::Zero(channels, n))
  {}

  void
  Add(Eigen::Index to, const PatchSums & other, Eigen::Index from)
  {
    weight[to] += other.weight[from];
    for (int axis = 0; axis < 2; ++axis)
    {
      sum[axis].col(to) += other.sum[axis].col(from);
    }
    withFixed.col(to) += other.withFixed.col(from);
    withModel.col(to) += other.withModel.col(from);
  }

  /** Products of what deviates from the patch's means in place of products. */
  void
  Centre()
  {
    for (Eigen::Index p = 0; p < weight.size(); ++p)
    {
      for (int axis = 0; axis < 2 && weight[p] > 0.0; ++axis)
      {
        withFixed.col(p) -= sum[axis](0, p) / weight[p] * sum[axis].col(p);
        withModel.col(p) -= sum[axis](1, p) / weight[p] * sum[axis].col(p);
      }
    }
  }
};

/** Adds a row of a block: the products of n pixels of a channel, whose weighted channels 0 and 1 are given. */
void
AddRow(const float * channel,
       const float * weights,
       const float * fixed,
       const float * model,
       int           n,
       double &      sum,
       double &      withFixed,
       double &      withModel)
{
  float s = 0.0f;
  float f = 0.0f;
  float g = 0.0f;
  for (int i = 0; i < n; ++i)
  {
    s += weights[i] * channel[i];
    f += fixed[i] * channel[i];
    g += model[i] * channel[i];
  }
  sum += s;
  withFixed += f;
  withModel += g;
}
} // namespace

struct PatchGradientCorrelation::Data
{
  CountedGradient     gradient;
  std::array<int, 2>  size;
  int                 block; ///< half a patch, pixels
  std::array<int, 2>  blocks{};
  GradientComponents  fixed;        ///< of the X-ray, less what is nothing
  GradientComponents  weighted;     ///< times the weights
  std::vector<double> inverseNorms; ///< 1 / |f| of each patch; 0 where the X-ray shows nothing

  Data(const RadiographView & target, int patch, double sigma)
    : gradient(target, sigma)
    , size(target.view.size)
    , block(std::max(2, patch / 2))
  {
    for (int axis = 0; axis < 2; ++axis)
    {
      blocks[axis] = std::max(2, (size[axis] + block - 1) / block);
    }
  }

  std::size_t
  Pixels() const
  {
    return static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]);
  }
  Eigen::Index
  Patches() const
  {
    return static_cast<Eigen::Index>(blocks[0] - 1) * (blocks[1] - 1);
  }
  /** Block (i, j) of the four of a patch. */
  Eigen::Index
  BlockOf(Eigen::Index patch, int i, int j) const
  {
    const Eigen::Index column = patch % (blocks[0] - 1);
    const Eigen::Index row = patch / (blocks[0] - 1);
    return (row + j) * blocks[0] + column + i;
  }

  const std::vector<float> &
  Weights() const
  {
    return gradient.GetWeights();
  }

  /** Of all channels but the first, which is the X-ray. */
  PatchSums
  Sum(const std::vector<GradientComponents> & channels) const
  {
    const auto         count = static_cast<Eigen::Index>(channels.size()) + 1;
    const auto &       weights = this->Weights();
    PatchSums          ofBlocks(count, static_cast<Eigen::Index>(blocks[0]) * blocks[1]);
    std::vector<float> model(static_cast<std::size_t>(size[0]));
    for (int r = 0; r < size[1]; ++r)
    {
      const std::size_t start = static_cast<std::size_t>(r) * size[0];
      for (int axis = 0; axis < 2; ++axis)
      {
        for (int c = 0; c < size[0]; ++c)
        {
          model[c] = weights[start + c] * channels[0][axis][start + c];
        }
        for (int b = 0; b * block < size[0]; ++b)
        {
          const int          first = b * block;
          const int          n = std::min(block, size[0] - first);
          const std::size_t  at = start + first;
          const Eigen::Index to = static_cast<Eigen::Index>(r / block) * blocks[0] + b;
          for (Eigen::Index k = 0; k < count; ++k)
          {
            const auto & channel = k == 0 ? fixed[axis] : channels[static_cast<std::size_t>(k) - 1][axis];
            AddRow(&channel[at],
                   &weights[at],
                   &weighted[axis][at],
                   &model[first],
                   n,
                   ofBlocks.sum[axis](k, to),
                   ofBlocks.withFixed(k, to),
                   ofBlocks.withModel(k, to));
          }
          if (axis == 0)
          {
            float w = 0.0f;
            for (int i = 0; i < n; ++i)
            {
              w += weights[at + i];
            }
            ofBlocks.weight[to] += w;
          }
        }
      }
    }
    PatchSums ofPatches(count, this->Patches());
    for (Eigen::Index p = 0; p < this->Patches(); ++p)
    {
      for (int i = 0; i < 4; ++i)
      {
        ofPatches.Add(p, ofBlocks, this->BlockOf(p, i % 2, i / 2));
      }
    }
    ofPatches.Centre();
    return ofPatches;
  }

  /** The sum over pixels of a_p w (derivative i) (derivative j), where `ofPatches` are the a_p of the patches. */
  Eigen::MatrixXd
  Gram(const std::vector<GradientComponents> & channels, const Eigen::VectorXd & ofPatches) const
  {
    const auto &    weights = this->Weights();
    const auto      m = static_cast<Eigen::Index>(channels.size()) - 1;
    Eigen::VectorXd ofBlocks = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(blocks[0]) * blocks[1]);
    for (Eigen::Index p = 0; p < ofPatches.size(); ++p)
    {
      for (int i = 0; i < 4; ++i)
      {
        ofBlocks[this->BlockOf(p, i % 2, i / 2)] += ofPatches[p];
      }
    }
    GramSum                            sum(m);
    Eigen::MatrixXf                    part(size[0], m);
    std::vector<std::pair<int, float>> roots; // of the pixels that count: column, root of the factor
    for (int r = 0; r < size[1]; ++r)
    {
      const std::size_t start = static_cast<std::size_t>(r) * size[0];
      roots.clear();
      for (int c = 0; c < size[0]; ++c)
      {
        const double a = weights[start + c] * ofBlocks[static_cast<Eigen::Index>(r / block) * blocks[0] + c / block];
        if (a > 0.0)
        {
          roots.emplace_back(c, static_cast<float>(std::sqrt(a)));
        }
      }
      const auto used = static_cast<Eigen::Index>(roots.size());
      for (int axis = 0; axis < 2 && used > 0; ++axis)
      {
        for (Eigen::Index k = 0; k < m; ++k)
        {
          const float * channel = &channels[static_cast<std::size_t>(k) + 1][axis][start];
          for (Eigen::Index i = 0; i < used; ++i)
          {
            const auto & [column, root] = roots[static_cast<std::size_t>(i)];
            part(i, k) = root * channel[column];
          }
        }
        sum.Add(part, used);
      }
    }
    return sum.Get();
  }
};

PatchGradientCorrelation::~PatchGradientCorrelation() = default;

PatchGradientCorrelation::PatchGradientCorrelation(const RadiographView & target, int patch, double sigma)
{
  auto data = std::make_unique<Data>(target, patch, sigma);
  data->fixed = data->gradient.Apply(target.values.data());
  for (int axis = 0; axis < 2; ++axis)
  {
    data->weighted[axis].resize(data->Pixels());
    std::transform(data->fixed[axis].begin(),
                   data->fixed[axis].end(),
                   data->Weights().begin(),
                   data->weighted[axis].begin(),
                   [](float f, float w) { return w * f; });
  }
  const PatchSums sums = data->Sum({ data->fixed });
  const auto      squares = sums.withFixed.row(0);
  const double    largest = squares.maxCoeff();
  if (!squares.allFinite() || !(largest > 0.0))
  {
    throw std::invalid_argument("the X-ray is constant or not finite where its pixels count");
  }
  for (Eigen::Index p = 0; p < squares.size(); ++p)
  {
    data->inverseNorms.push_back(squares[p] > 1e-10 * largest ? 1.0 / std::sqrt(squares[p]) : 0.0);
  }
  m_Data = std::move(data);
}

double
PatchGradientCorrelation::Evaluate(const float * image) const
{
  const PatchSums sums = m_Data->Sum({ m_Data->gradient.Apply(image) });
  double          shared = 0.0;
  double          norms = 0.0;
  for (Eigen::Index p = 0; p < m_Data->Patches(); ++p)
  {
    shared += sums.withFixed(1, p) * m_Data->inverseNorms[static_cast<std::size_t>(p)];
    norms += std::sqrt(std::max(0.0, sums.withModel(1, p)));
  }
  return norms > 0.0 ? 1.0 - shared / norms : 1.0;
}

MetricValue
PatchGradientCorrelation::EvaluateDerivatives(const std::vector<float *> & images) const
{
  std::vector<GradientComponents> channels;
  for (const float * image : images)
  {
    channels.push_back(m_Data->gradient.Apply(image));
  }
  const auto      m = static_cast<Eigen::Index>(images.size()) - 1;
  const PatchSums sums = m_Data->Sum(channels);
  const auto      patches = m_Data->Patches();

  MetricValue     value;
  Eigen::MatrixXd ofPatches = Eigen::MatrixXd::Zero(m, patches); // of the shared part
  Eigen::MatrixXd ofNorms = Eigen::MatrixXd::Zero(m, patches);
  Eigen::VectorXd norms = Eigen::VectorXd::Zero(patches);
  Eigen::VectorXd likeness = Eigen::VectorXd::Zero(patches);
  double          shared = 0.0;
  const double    least = 1e-12 * std::max(0.0, sums.withModel.row(1).maxCoeff());
  for (Eigen::Index p = 0; p < patches; ++p)
  {
    const double inverse = m_Data->inverseNorms[static_cast<std::size_t>(p)];
    shared += sums.withFixed(1, p) * inverse;
    ofPatches.col(p) = inverse * sums.withFixed.col(p).tail(m);
    if (sums.withModel(1, p) > least)
    {
      norms[p] = std::sqrt(sums.withModel(1, p));
      ofNorms.col(p) = sums.withModel.col(p).tail(m) / norms[p];
      likeness[p] = sums.withFixed(1, p) * inverse / norms[p];
    }
  }
  const double total = norms.sum();
  value.gradient = Eigen::VectorXd::Zero(m);
  value.hessian = Eigen::MatrixXd::Zero(m, m);
  if (!(total > 0.0))
  {
    value.cost = 1.0;
    value.shares.resize(m, 0);
    return value;
  }
  const double correlation = shared / total;
  value.cost = 1.0 - correlation;
  // The patches' shares in clusters of two by two patches' width.
  constexpr int width = 4;
  const int     clusters = (m_Data->blocks[0] - 1 + width - 1) / width;
  const int     rows = (m_Data->blocks[1] - 1 + width - 1) / width;
  value.blocksInRow = clusters;
  value.shares = Eigen::MatrixXd::Zero(m, static_cast<Eigen::Index>(clusters) * rows);
  Eigen::VectorXd ofGram = Eigen::VectorXd::Zero(patches);
  for (Eigen::Index p = 0; p < patches; ++p)
  {
    const Eigen::VectorXd share = (correlation * ofNorms.col(p) - ofPatches.col(p)) / total;
    const Eigen::Index    column = p % (m_Data->blocks[0] - 1);
    const Eigen::Index    row = p / (m_Data->blocks[0] - 1);
    value.shares.col(row / width * clusters + column / width) += share;
    value.gradient += share;
    if (norms[p] > 0.0)
    {
      // Half the squared length of f / |f| - g / |g| is 1 - likeness; its curvature goes with the likeness.
      ofGram[p] = std::max(likeness[p], 0.1) / (norms[p] * total);
    }
  }
  value.hessian = m_Data->Gram(channels, ofGram);
  for (Eigen::Index p = 0; p < patches; ++p)
  {
    if (ofGram[p] > 0.0)
    {
      value.hessian -= ofGram[p] * ofNorms.col(p) * ofNorms.col(p).transpose();
      for (int axis = 0; axis < 2 && sums.weight[p] > 0.0; ++axis)
      {
        const auto mean = sums.sum[axis].col(p).tail(m);
        value.hessian -= ofGram[p] / sums.weight[p] * mean * mean.transpose();
      }
    }
  }
  return value;
}

std::vector<float>
PatchGradientCorrelation::Correlations(const float * image) const
{
  const PatchSums     sums = m_Data->Sum({ m_Data->gradient.Apply(image) });
  std::vector<float>  map(m_Data->Pixels(), 0.0f);
  const double        least = 1e-12 * std::max(0.0, sums.withModel.row(1).maxCoeff());
  std::vector<double> ofBlocks(static_cast<std::size_t>(m_Data->blocks[0]) * m_Data->blocks[1], 0.0);
  for (Eigen::Index p = 0; p < m_Data->Patches(); ++p)
  {
    if (sums.withModel(1, p) > least)
    {
      for (int i = 0; i < 4; ++i)
      {
        ofBlocks[static_cast<std::size_t>(m_Data->BlockOf(p, i % 2, i / 2))] +=
          0.25 * sums.withFixed(1, p) * m_Data->inverseNorms[static_cast<std::size_t>(p)] /
          std::sqrt(sums.withModel(1, p));
      }
    }
  }
  for (std::size_t i = 0; i < map.size(); ++i)
  {
    const std::size_t row = i / static_cast<std::size_t>(m_Data->size[0]) / m_Data->block;
    const std::size_t column = i % static_cast<std::size_t>(m_Data->size[0]) / m_Data->block;
    map[i] = static_cast<float>(ofBlocks[row * m_Data->blocks[0] + column]);
  }
  return map;
}
} // namespace bone
