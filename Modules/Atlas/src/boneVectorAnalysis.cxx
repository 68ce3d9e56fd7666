/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneVectorAnalysis.h"

#include "boneModeAccumulator.h"
#include "boneSymmetricEigen.h"
#include "boneVectorProduct.h"

#include <algorithm>
#include <stdexcept>

namespace bone
{
namespace
{
constexpr Eigen::Index Batch = 32;            // vectors projected at once
constexpr Eigen::Index MostModes = 512;       // that are found where no more are asked for, of as many vectors again
constexpr double       RoundingLevel = 1e-11; // of the mean's length: what differs by less does not differ

/** How many modes explain the proportion. `rounding`: of a variance. */
Eigen::Index
CountModes(const Eigen::VectorXd & variances, double total, double rounding, const AnalysisParameters & parameters)
{
  Eigen::Index most = CountAboveRounding(variances);
  if (parameters.maximumModes > 0)
  {
    most = std::min(most, parameters.maximumModes);
  }
  const bool   all = parameters.proportion >= 1.0;
  Eigen::Index k = 0;
  double       explained = 0;
  while (k < most && variances[k] > rounding && (all || explained < parameters.proportion * total))
  {
    explained += variances[k++];
  }
  return k;
}

/** One column, turned to the plain product. */
Eigen::VectorXd
ToPlain(const VectorProduct & product, Eigen::VectorXd y)
{
  product.ToPlain(y);
  return y;
}

/** Coefficients of the former vectors in the new modes: those of the vectors that their model makes. */
Eigen::MatrixXd
ProjectFormer(const FormerVectors & former, const VectorProduct & product, const ModeAccumulator & found)
{
  const PrincipalModes & old = *former.modes;
  Eigen::MatrixXd        modes = old.modes;
  product.ToPlain(modes);
  const Eigen::MatrixXd turn = found.GetModes().transpose() * modes * old.variances.cwiseSqrt().asDiagonal();
  const Eigen::VectorXd shift = found.GetModes().transpose() * (ToPlain(product, old.mean) - found.GetMean());
  return (*former.scores * turn.transpose()).rowwise() + shift.transpose();
}

/** The second pass: rows of coefficients. `mean`: in the source's own product. */
void
ProjectSource(const VectorSource &    source,
              const VectorProduct &   product,
              const ModeAccumulator & found,
              const Eigen::VectorXd & mean,
              const VectorVisitor &   visit,
              const Execution &       execution,
              Eigen::MatrixXd &       rows,
              Eigen::Index            row)
{
  Eigen::MatrixXd vectors(source.dimension, Batch), products(rows.cols(), Batch);
  for (Eigen::Index first = 0; first < source.count; first += Batch)
  {
    execution.Report(static_cast<double>(first) / static_cast<double>(source.count));
    const Eigen::Index count = std::min(Batch, source.count - first);
    for (Eigen::Index i = 0; i < count; ++i)
    {
      source.load(first + i, vectors.col(i).data());
      if (visit)
      {
        visit(vectors.col(i), mean);
      }
    }
    vectors.leftCols(count).colwise() -= mean;
    product.ToPlain(vectors.leftCols(count));
    InnerProducts(execution, found.GetModes(), vectors.leftCols(count), products.leftCols(count));
    rows.middleRows(row + first, count) = products.leftCols(count).transpose();
  }
}

/** Gives each mode the sign that makes its largest entry positive; of equally large ones the first decides. */
void
FixSigns(Eigen::MatrixXd & modes, Eigen::MatrixXd & scores)
{
  for (Eigen::Index k = 0; k < modes.cols(); ++k)
  {
    Eigen::Index largest = 0;
    modes.col(k).cwiseAbs().maxCoeff(&largest);
    if (modes(largest, k) < 0)
    {
      modes.col(k) = -modes.col(k);
      scores.col(k) = -scores.col(k);
    }
  }
}
} // namespace

PrincipalModes
AnalyzeVectors(const VectorSource &       source,
               const Eigen::VectorXd &    weights,
               const Eigen::MatrixXd &    block,
               const AnalysisParameters & parameters,
               Eigen::MatrixXd &          scores,
               const Execution &          execution,
               const FormerVectors &      former,
               const VectorVisitor &      visit)
{
  const Eigen::Index before = former.modes == nullptr ? 0 : former.scores->rows();
  const Eigen::Index n = before + source.count;
  if (n < 2 || source.dimension < 1)
  {
    throw std::invalid_argument("Modes of variation need two subjects or more.");
  }
  PrincipalModes result;
  result.weights = former.modes == nullptr ? weights : former.modes->weights;
  result.block = former.modes == nullptr ? block : former.modes->block;
  const VectorProduct product(result.weights, result.block);
  const Eigen::Index  held = source.count + (former.modes == nullptr ? 0 : former.modes->GetNumberOfModes() + 1);
  ModeAccumulator     found(
    source.dimension, held, parameters.bytes, 2 * std::max(MostModes, parameters.maximumModes), execution);
  if (former.modes != nullptr)
  {
    Eigen::MatrixXd modes = former.modes->modes;
    product.ToPlain(modes);
    found.Start(
      before, ToPlain(product, former.modes->mean), modes, former.modes->variances, former.modes->totalVariance);
  }
  const Execution firstPass = execution.Part(0.0, 0.6);
  for (Eigen::Index i = 0; i < source.count; ++i)
  {
    firstPass.Report(static_cast<double>(i) / static_cast<double>(source.count));
    auto place = found.Next();
    source.load(i, place.data());
    product.ToPlain(place);
  }
  double     rounding = 0;
  const auto keep = [&](const Eigen::VectorXd & variances, double total) {
    const double level = RoundingLevel * found.GetMean().norm();
    rounding = level * level;
    return found.IsTruncated() ? variances.size() : CountModes(variances, total, rounding, parameters);
  };
  found.Finish(keep);
  result.mean = found.GetMean();
  product.FromPlain(result.mean);
  result.totalVariance = found.GetTotalVariance();

  scores.resize(n, found.GetModes().cols());
  if (former.modes != nullptr)
  {
    scores.topRows(before) = ProjectFormer(former, product, found);
  }
  ProjectSource(source, product, found, result.mean, visit, execution.Part(0.6, 1.0), scores, before);
  const SymmetricEigen  ritz = EigenOf<Eigen::Dynamic>(scores.transpose() * scores / static_cast<double>(n - 1));
  const Eigen::VectorXd variances = ritz.values.reverse();
  const Eigen::Index    k = CountModes(variances, result.totalVariance, rounding, parameters);
  const Eigen::MatrixXd turn = ritz.vectors.rowwise().reverse().leftCols(k);
  result.variances = variances.head(k);
  result.modes = found.TakeModes();
  CombineColumns(execution, turn, result.modes);
  result.modes.conservativeResize(Eigen::NoChange, k);
  scores = (scores * turn * result.variances.cwiseSqrt().cwiseInverse().asDiagonal()).eval();
  product.FromPlain(result.modes);
  FixSigns(result.modes, scores);
  return result;
}
} // namespace bone
