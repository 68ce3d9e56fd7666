/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "bonePatchGradientCorrelation.h"

#include "boneMetricPixels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>
#include <stdexcept>
#include <utility>

namespace bone
{
namespace
{
/** Weighted sums over the pixels of blocks or patches, #n of them; channel 0 is the radiograph, the rest are its
 * derivatives by the parameters. */
struct PatchSums
{
  std::array<Eigen::MatrixXd, 2> sum;       ///< #channels by #n, of each component
  Eigen::MatrixXd                withFixed; ///< #channels by #n, of the products with the X-ray, both components
  Eigen::MatrixXd                withModel; ///< with channel 0

  PatchSums(Eigen::Index channels, Eigen::Index n)
    : sum{ Eigen::MatrixXd::Zero(channels, n), Eigen::MatrixXd::Zero(channels, n) }
    , withFixed(Eigen::MatrixXd::Zero(channels, n))
    , withModel(Eigen::MatrixXd::Zero(channels, n))
  {}

  /** The sums over #n patches of two by two blocks, from column `to` on: `from` is the first block of the first one,
   * and the blocks below are `inRow` columns further. */
  void
  SetPatches(Eigen::Index to, Eigen::Index n, const PatchSums & blocks, Eigen::Index from, Eigen::Index inRow)
  {
    const auto add = [=](Eigen::MatrixXd & patches, const Eigen::MatrixXd & of) {
      patches.middleCols(to, n) = of.middleCols(from, n) + of.middleCols(from + 1, n) + of.middleCols(from + inRow, n) +
                                  of.middleCols(from + inRow + 1, n);
    };
    add(sum[0], blocks.sum[0]);
    add(sum[1], blocks.sum[1]);
    add(withFixed, blocks.withFixed);
    add(withModel, blocks.withModel);
  }
};

/** Gradients of a radiograph and its derivatives, in a box of whole blocks. */
struct Channels
{
  PixelBox                        box;
  std::vector<GradientComponents> gradients;
};
} // namespace

struct PatchGradientCorrelation::Data
{
  CountedGradient     gradient;
  std::array<int, 2>  size;
  int                 block; ///< half a patch, pixels
  std::array<int, 2>  blocks{};
  GradientComponents  weighted;     ///< of the X-ray, times the weights
  Eigen::VectorXd     patchWeights; ///< of each patch, the sum of the weights
  std::vector<double> inverseNorms; ///< 1 / |f| of each patch; 0 where the X-ray shows nothing
  /** Of each patch, the weighted sum of the X-ray's. */
  std::array<Eigen::VectorXd, 2> patchSums;

  Data(const RadiographView & target, int patch, double sigma)
    : gradient(target, sigma)
    , size(target.view.size)
    , block(std::max(2, patch / 2))
  {
    for (int axis = 0; axis < 2; ++axis)
    {
      blocks[axis] = std::max(2, (size[axis] + block - 1) / block);
    }
    const GradientComponents fixed = gradient.Apply(target.values.data());
    weighted = fixed;
    for (auto & component : weighted)
    {
      std::transform(
        component.begin(), component.end(), this->Weights().begin(), component.begin(), [](float f, float w) {
          return w * f;
        });
    }
    patchWeights = this->SumOfPatches(this->Weights());
    patchSums = { this->SumOfPatches(weighted[0]), this->SumOfPatches(weighted[1]) };
    const PixelBox  whole{ { 0, 0 }, size };
    const PatchSums sums = this->Sum({ whole, { fixed } });
    const auto      squares = sums.withFixed.row(0);
    const double    largest = squares.maxCoeff();
    if (!squares.allFinite() || !(largest > 0.0))
    {
      throw std::invalid_argument("the X-ray is constant or not finite where its pixels count");
    }
    for (Eigen::Index p = 0; p < squares.size(); ++p)
    {
      inverseNorms.push_back(squares[p] > 1e-10 * largest ? 1.0 / std::sqrt(squares[p]) : 0.0);
    }
  }

  const std::vector<float> &
  Weights() const
  {
    return gradient.GetWeights();
  }
  std::size_t
  PixelAt(int column, int row) const
  {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(size[0]) + static_cast<std::size_t>(column);
  }

  /** Blocks of a box along an axis. */
  int
  BlocksOf(const PixelBox & box, int axis) const
  {
    return box.end[axis] == size[axis] ? blocks[axis] - box.first[axis] / block
                                       : (box.end[axis] - box.first[axis]) / block;
  }
  /** Patches of two by two blocks of a box. */
  Eigen::Index
  PatchesOf(const PixelBox & box) const
  {
    return static_cast<Eigen::Index>(this->BlocksOf(box, 0) - 1) * (this->BlocksOf(box, 1) - 1);
  }
  /** Column and row, among all patches, of a patch of a box. */
  std::array<Eigen::Index, 2>
  PlaceOf(const PixelBox & box, Eigen::Index patch) const
  {
    const Eigen::Index inRow = this->BlocksOf(box, 0) - 1;
    return { box.first[0] / block + patch % inRow, box.first[1] / block + patch / inRow };
  }
  Eigen::Index
  IndexOf(const std::array<Eigen::Index, 2> & place) const
  {
    return place[1] * (blocks[0] - 1) + place[0];
  }
  double
  InverseNormOf(const PixelBox & box, Eigen::Index patch) const
  {
    return inverseNorms[static_cast<std::size_t>(this->IndexOf(this->PlaceOf(box, patch)))];
  }
  /** Block (i, j) of the four of a patch, both of a box. */
  Eigen::Index
  BlockOf(const PixelBox & box, Eigen::Index patch, int i, int j) const
  {
    const Eigen::Index inRow = this->BlocksOf(box, 0);
    return (patch / (inRow - 1) + j) * inRow + patch % (inRow - 1) + i;
  }

  Eigen::VectorXd
  SumOfPatches(const std::vector<float> & image) const
  {
    const PixelBox  whole{ { 0, 0 }, size };
    Eigen::VectorXd ofBlocks = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(blocks[0]) * blocks[1]);
    for (int r = 0; r < size[1]; ++r)
    {
      for (int c = 0; c < size[0]; ++c)
      {
        ofBlocks[static_cast<Eigen::Index>(r / block) * blocks[0] + c / block] += image[this->PixelAt(c, r)];
      }
    }
    Eigen::VectorXd sums(this->PatchesOf(whole));
    for (Eigen::Index p = 0; p < sums.size(); ++p)
    {
      sums[p] = ofBlocks[this->BlockOf(whole, p, 0, 0)] + ofBlocks[this->BlockOf(whole, p, 1, 0)] +
                ofBlocks[this->BlockOf(whole, p, 0, 1)] + ofBlocks[this->BlockOf(whole, p, 1, 1)];
    }
    return sums;
  }

  /** Gradients where there are any, and a block more on all sides, so that all patches that they touch are whole. */
  Channels
  Differentiate(const std::vector<const float *> & images) const
  {
    Channels channels;
    channels.box = BoxOf(images, size);
    if (channels.box.GetNumberOfPixels() == 0)
    {
      return channels;
    }
    const int radius = gradient.Radius();
    for (int axis = 0; axis < 2; ++axis)
    {
      int & first = channels.box.first[axis];
      int & end = channels.box.end[axis];
      first = std::max(0, (first - radius) / block - 1) * block;
      end = std::min(size[axis], ((end + radius + block - 1) / block + 1) * block);
    }
    for (const float * image : images)
    {
      channels.gradients.push_back(gradient.Apply(image, channels.box));
    }
    return channels;
  }

  /** Sums over the patches of the channels' box, of what deviates from the patches' means. */
  PatchSums
  Sum(const Channels & channels) const
  {
    const PixelBox &   box = channels.box;
    const auto         count = static_cast<Eigen::Index>(channels.gradients.size());
    PatchSums          ofBlocks(count, static_cast<Eigen::Index>(this->BlocksOf(box, 0)) * this->BlocksOf(box, 1));
    std::vector<float> model(box.GetNumberOfPixels());
    for (int axis = 0; axis < 2; ++axis)
    {
      auto from = channels.gradients[0][axis].begin();
      auto to = model.begin();
      for (int r = box.first[1]; r < box.end[1]; ++r, from += box.Columns())
      {
        to = std::transform(
          from, from + box.Columns(), &this->Weights()[this->PixelAt(box.first[0], r)], to, std::multiplies<>());
      }
      for (int r = box.first[1]; r < box.end[1]; r += block)
      {
        for (Eigen::Index k = 0; k < count; ++k)
        {
          this->AddProducts(channels, axis, model, r, k, ofBlocks);
        }
      }
    }
    PatchSums          sums(count, this->PatchesOf(box));
    const Eigen::Index inRow = this->BlocksOf(box, 0);
    for (Eigen::Index to = 0, from = 0; to < this->PatchesOf(box); to += inRow - 1, from += inRow)
    {
      sums.SetPatches(to, inRow - 1, ofBlocks, from, inRow);
      const Eigen::Index at = this->IndexOf(this->PlaceOf(box, to));
      for (int axis = 0; axis < 2; ++axis)
      {
        const auto            sum = sums.sum[axis].middleCols(to, inRow - 1);
        const Eigen::ArrayXd  weights = patchWeights.segment(at, inRow - 1);
        const auto            isCounted = weights > 0.0;
        const Eigen::VectorXd ofFixed = isCounted.select(patchSums[axis].segment(at, inRow - 1).array() / weights, 0.0);
        const Eigen::VectorXd ofModel = isCounted.select(sum.row(0).transpose().array() / weights, 0.0);
        sums.withFixed.middleCols(to, inRow - 1) -= sum * ofFixed.asDiagonal();
        sums.withModel.middleCols(to, inRow - 1) -= sum * ofModel.asDiagonal();
      }
    }
    return sums;
  }

  /** Adds the products of a component of channel k to the sums of the row of blocks that begins with row r. */
  void
  AddProducts(const Channels &           channels,
              int                        axis,
              const std::vector<float> & model,
              int                        r,
              Eigen::Index               k,
              PatchSums &                to) const
  {
    const PixelBox &   box = channels.box;
    const int          columns = box.Columns();
    const float *      channel = channels.gradients[static_cast<std::size_t>(k)][axis].data();
    std::vector<float> sums(3 * static_cast<std::size_t>(columns));
    float * const      s = sums.data();
    float * const      f = s + columns;
    float * const      g = f + columns;
    const Eigen::Index row = static_cast<Eigen::Index>((r - box.first[1]) / block) * this->BlocksOf(box, 0);
    for (const int end = std::min(r + block, box.end[1]); r < end; ++r)
    {
      const std::size_t at = static_cast<std::size_t>(r - box.first[1]) * static_cast<std::size_t>(columns);
      AddRow(columns,
             channel + at,
             &this->Weights()[this->PixelAt(box.first[0], r)],
             &weighted[axis][this->PixelAt(box.first[0], r)],
             &model[at],
             s,
             f,
             g);
    }
    for (Eigen::Index b = row, c = 0; c < columns; ++b, c += block)
    {
      const Eigen::Index n = std::min<Eigen::Index>(block, columns - c);
      to.sum[axis](k, b) += std::accumulate(s + c, s + c + n, 0.0);
      to.withFixed(k, b) += std::accumulate(f + c, f + c + n, 0.0);
      to.withModel(k, b) += std::accumulate(g + c, g + c + n, 0.0);
    }
  }

  static void
  AddRow(int           n,
         const float * channel,
         const float * weights,
         const float * fixed,
         const float * model,
         float *       s,
         float *       f,
         float *       g)
  {
    using Row = Eigen::Map<Eigen::ArrayXf>;
    using ConstRow = Eigen::Map<const Eigen::ArrayXf>;
    const ConstRow values(channel, n);
    Row(s, n) += ConstRow(weights, n) * values;
    Row(f, n) += ConstRow(fixed, n) * values;
    Row(g, n) += ConstRow(model, n) * values;
  }

  /** Adds the patches' shares in clusters of two by two patches' width. */
  void
  Cluster(const PixelBox & box, const Eigen::MatrixXd & shares, MetricValue & value) const
  {
    constexpr int width = 4;
    const int     inRow = (blocks[0] - 1 + width - 1) / width;
    const int     rows = (blocks[1] - 1 + width - 1) / width;
    value.blocksInRow = inRow;
    value.shares = Eigen::MatrixXd::Zero(shares.rows(), static_cast<Eigen::Index>(inRow) * rows);
    for (Eigen::Index p = 0; p < shares.cols(); ++p)
    {
      const auto [column, row] = this->PlaceOf(box, p);
      value.shares.col(row / width * inRow + column / width) += shares.col(p);
    }
  }

  /** The sum over pixels of a_p w (derivative i) (derivative j), where `factors` are the a_p of the box's patches. */
  Eigen::MatrixXd
  Gram(const Channels & channels, const Eigen::VectorXd & factors) const
  {
    const PixelBox & box = channels.box;
    const auto       m = static_cast<Eigen::Index>(channels.gradients.size()) - 1;
    const int        inRow = this->BlocksOf(box, 0);
    Eigen::VectorXd  ofBlocks = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(inRow) * this->BlocksOf(box, 1));
    for (Eigen::Index p = 0; p < factors.size(); ++p)
    {
      for (int i = 0; i < 4; ++i)
      {
        ofBlocks[this->BlockOf(box, p, i % 2, i / 2)] += factors[p];
      }
    }
    GramSum                            sum(m);
    Eigen::MatrixXf                    part(box.Columns(), m);
    std::vector<std::pair<int, float>> roots; // of the pixels that count: column, root of the factor
    for (int r = box.first[1]; r < box.end[1]; ++r)
    {
      const std::size_t start = static_cast<std::size_t>(r - box.first[1]) * static_cast<std::size_t>(box.Columns());
      roots.clear();
      for (int c = 0; c < box.Columns(); ++c)
      {
        const double a = this->Weights()[this->PixelAt(box.first[0] + c, r)] *
                         ofBlocks[static_cast<Eigen::Index>((r - box.first[1]) / block) * inRow + c / block];
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
          const float * channel = &channels.gradients[static_cast<std::size_t>(k) + 1][axis][start];
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
  : m_Data(std::make_unique<const Data>(target, patch, sigma))
{}

double
PatchGradientCorrelation::Evaluate(const float * image) const
{
  const Channels channels = m_Data->Differentiate({ image });
  if (channels.gradients.empty())
  {
    return 1.0;
  }
  const PatchSums sums = m_Data->Sum(channels);
  double          shared = 0.0;
  double          norms = 0.0;
  for (Eigen::Index p = 0; p < sums.withModel.cols(); ++p)
  {
    shared += sums.withFixed(0, p) * m_Data->InverseNormOf(channels.box, p);
    norms += std::sqrt(std::max(0.0, sums.withModel(0, p)));
  }
  return norms > 0.0 ? 1.0 - shared / norms : 1.0;
}

MetricValue
PatchGradientCorrelation::EvaluateDerivatives(const std::vector<float *> & images) const
{
  const auto  m = static_cast<Eigen::Index>(images.size()) - 1;
  MetricValue value;
  value.cost = 1.0;
  value.gradient = Eigen::VectorXd::Zero(m);
  value.hessian = Eigen::MatrixXd::Zero(m, m);
  value.shares.resize(m, 0);
  const Channels channels = m_Data->Differentiate({ images.begin(), images.end() });
  if (channels.gradients.empty())
  {
    return value;
  }
  const PatchSums sums = m_Data->Sum(channels);
  const auto      patches = m_Data->PatchesOf(channels.box);
  Eigen::MatrixXd shared = Eigen::MatrixXd::Zero(m, patches); // derivatives of the products with the X-ray
  Eigen::MatrixXd ofNorms = Eigen::MatrixXd::Zero(m, patches);
  Eigen::VectorXd norms = Eigen::VectorXd::Zero(patches);
  Eigen::VectorXd likeness = Eigen::VectorXd::Zero(patches);
  double          product = 0.0;
  const double    least = 1e-12 * std::max(0.0, sums.withModel.row(0).maxCoeff());
  for (Eigen::Index p = 0; p < patches; ++p)
  {
    const double inverse = m_Data->InverseNormOf(channels.box, p);
    product += sums.withFixed(0, p) * inverse;
    shared.col(p) = inverse * sums.withFixed.col(p).tail(m);
    if (sums.withModel(0, p) > least)
    {
      norms[p] = std::sqrt(sums.withModel(0, p));
      ofNorms.col(p) = sums.withModel.col(p).tail(m) / norms[p];
      likeness[p] = sums.withFixed(0, p) * inverse / norms[p];
    }
  }
  const double total = norms.sum();
  if (!(total > 0.0))
  {
    return value;
  }
  const double          correlation = product / total;
  const Eigen::MatrixXd shares = (correlation * ofNorms - shared) / total;
  value.cost = 1.0 - correlation;
  value.gradient = shares.rowwise().sum();
  m_Data->Cluster(channels.box, shares, value);
  // Half the squared length of f / |f| - g / |g| is 1 - likeness; its curvature goes with the likeness.
  Eigen::VectorXd factors = Eigen::VectorXd::Zero(patches);
  Eigen::VectorXd ofMeans = Eigen::VectorXd::Zero(patches);
  for (Eigen::Index p = 0; p < patches; ++p)
  {
    const double weight = m_Data->patchWeights[m_Data->IndexOf(m_Data->PlaceOf(channels.box, p))];
    if (norms[p] > 0.0)
    {
      factors[p] = std::max(likeness[p], 0.1) / (norms[p] * total);
      ofMeans[p] = weight > 0.0 ? factors[p] / weight : 0.0;
    }
  }
  const auto subtract = [&value](const auto & columns, const Eigen::VectorXd & ofColumns) {
    const Eigen::MatrixXd scaled = columns * ofColumns.cwiseSqrt().asDiagonal();
    value.hessian.selfadjointView<Eigen::Lower>().rankUpdate(scaled, -1.0);
  };
  value.hessian = m_Data->Gram(channels, factors);
  subtract(ofNorms, factors);
  subtract(sums.sum[0].bottomRows(m), ofMeans);
  subtract(sums.sum[1].bottomRows(m), ofMeans);
  value.hessian = Eigen::MatrixXd(value.hessian.selfadjointView<Eigen::Lower>());
  return value;
}

std::vector<float>
PatchGradientCorrelation::Correlations(const float * image) const
{
  std::vector<float> map(m_Data->Weights().size(), 0.0f);
  const Channels     channels = m_Data->Differentiate({ image });
  if (channels.gradients.empty())
  {
    return map;
  }
  const PixelBox &    box = channels.box;
  const PatchSums     sums = m_Data->Sum(channels);
  const double        least = 1e-12 * std::max(0.0, sums.withModel.row(0).maxCoeff());
  const auto          inRow = static_cast<std::size_t>(m_Data->BlocksOf(box, 0));
  std::vector<double> ofBlocks(inRow * static_cast<std::size_t>(m_Data->BlocksOf(box, 1)), 0.0);
  for (Eigen::Index p = 0; p < sums.withModel.cols(); ++p)
  {
    if (sums.withModel(0, p) > least)
    {
      for (int i = 0; i < 4; ++i)
      {
        ofBlocks[static_cast<std::size_t>(m_Data->BlockOf(box, p, i % 2, i / 2))] +=
          0.25 * sums.withFixed(0, p) * m_Data->InverseNormOf(box, p) / std::sqrt(sums.withModel(0, p));
      }
    }
  }
  for (int r = 0; r < box.Rows(); ++r)
  {
    for (int c = 0; c < box.Columns(); ++c)
    {
      map[m_Data->PixelAt(box.first[0] + c, box.first[1] + r)] = static_cast<float>(
        ofBlocks[static_cast<std::size_t>(r / m_Data->block) * inRow + static_cast<std::size_t>(c / m_Data->block)]);
    }
  }
  return map;
}
} // namespace bone
