/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneGramAnalysis.h"

#include "boneSymmetricEigen.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <stdexcept>

namespace bone
{
namespace
{
constexpr Eigen::Index Batch = 16;            // vectors streamed at once
constexpr Eigen::Index RowChunk = 4096;       // entries a thread works on
constexpr Eigen::Index ColumnTile = 32;       // vectors of a held block that a thread works on
constexpr double       NoiseLevel = 1e-13;    // of the largest eigenvalue
constexpr double       RoundingLevel = 1e-11; // of the mean's length: what differs by less does not differ

void
InParallel(const Execution & execution, Eigen::Index count, const std::function<void(Eigen::Index)> & body)
{
  execution.Silent().For(static_cast<std::size_t>(count),
                         [&body](std::size_t i) { body(static_cast<Eigen::Index>(i)); });
}

/** Calls body(first row, rows) for fixed chunks of all rows. */
void
OverRows(const Execution & execution, Eigen::Index rows, const std::function<void(Eigen::Index, Eigen::Index)> & body)
{
  InParallel(execution, (rows + RowChunk - 1) / RowChunk, [&](Eigen::Index chunk) {
    const Eigen::Index first = chunk * RowChunk;
    body(first, std::min(RowChunk, rows - first));
  });
}

/** Turns vectors to ones whose plain inner product is that of weights and a block, and back. */
class PlainProduct
{
public:
  PlainProduct(const Eigen::VectorXd & weights, const Eigen::MatrixXd & block)
    : m_Scale(weights.cwiseSqrt())
    , m_Factor(block.rows(), block.cols())
  {
    if (block.size() > 0)
    {
      const Eigen::LLT<Eigen::MatrixXd> factor(block);
      if (factor.info() != Eigen::Success)
      {
        throw std::invalid_argument("The block of an inner product must be positive definite.");
      }
      m_Factor = factor.matrixU();
    }
  }
  void
  To(Eigen::MatrixXd & vectors) const
  {
    if (m_Factor.size() > 0)
    {
      auto runs = this->Runs(vectors);
      runs = (m_Factor * runs).eval();
    }
    if (m_Scale.size() > 0)
    {
      vectors.array().colwise() *= m_Scale.array();
    }
  }
  void
  From(Eigen::MatrixXd & vectors) const
  {
    if (m_Scale.size() > 0)
    {
      vectors.array().colwise() /= m_Scale.array();
    }
    if (m_Factor.size() > 0)
    {
      auto runs = this->Runs(vectors);
      m_Factor.triangularView<Eigen::Upper>().solveInPlace(runs);
    }
  }

private:
  Eigen::Map<Eigen::MatrixXd>
  Runs(Eigen::MatrixXd & vectors) const
  {
    return { vectors.data(), m_Factor.rows(), vectors.size() / m_Factor.rows() };
  }

  Eigen::VectorXd m_Scale;
  Eigen::MatrixXd m_Factor; ///< U of block = U^T U
};

/** Reads vectors, centred and turned to the plain inner product. */
class CentredReader
{
public:
  CentredReader(const VectorSource & source, const PlainProduct & product, const Execution & execution)
    : m_Source(source)
    , m_Product(product)
    , m_Execution(execution)
    , m_Mean(Eigen::VectorXd::Zero(source.dimension))
  {
    Eigen::VectorXd y(source.dimension);
    for (Eigen::Index i = 0; i < source.count; ++i)
    {
      execution.Report(0.2 * static_cast<double>(i) / static_cast<double>(source.count));
      source.load(i, y.data());
      m_Mean += y / static_cast<double>(source.count);
    }
  }
  const Eigen::VectorXd &
  Mean() const
  {
    return m_Mean;
  }
  Eigen::MatrixXd
  Read(Eigen::Index first, Eigen::Index count) const
  {
    Eigen::MatrixXd block(m_Source.dimension, count);
    for (Eigen::Index i = 0; i < count; ++i)
    {
      m_Execution.ThrowIfAborted();
      m_Source.load(first + i, block.col(i).data());
      block.col(i) -= m_Mean;
    }
    m_Product.To(block);
    return block;
  }

private:
  const VectorSource & m_Source;
  const PlainProduct & m_Product;
  Execution            m_Execution;
  Eigen::VectorXd      m_Mean;
};

void
InnerProducts(const Execution &           execution,
              const Eigen::MatrixXd &     a,
              const Eigen::MatrixXd &     b,
              Eigen::Ref<Eigen::MatrixXd> products)
{
  const Eigen::Index tiles = (a.cols() + ColumnTile - 1) / ColumnTile;
  InParallel(execution, tiles, [&](Eigen::Index tile) {
    const Eigen::Index first = tile * ColumnTile, count = std::min(ColumnTile, a.cols() - first);
    products.middleRows(first, count).noalias() = a.middleCols(first, count).transpose() * b;
  });
}

Eigen::MatrixXd
GramMatrix(const CentredReader & reader,
           const VectorSource &  source,
           std::size_t           blockBytes,
           const Execution &     execution)
{
  const Eigen::Index n = source.count;
  const auto         fitting =
    static_cast<Eigen::Index>(blockBytes / (sizeof(double) * static_cast<std::size_t>(source.dimension)));
  const Eigen::Index size = std::min(n, std::max(fitting, Batch));
  Eigen::MatrixXd    gram(n, n);
  for (Eigen::Index first = 0; first < n; first += size)
  {
    execution.Report(static_cast<double>(first) / static_cast<double>(n));
    const Eigen::Index    held = std::min(size, n - first);
    const Eigen::MatrixXd block = reader.Read(first, held);
    InnerProducts(execution, block, block, gram.block(first, first, held, held));
    for (Eigen::Index next = first + held; next < n; next += Batch)
    {
      const Eigen::Index    count = std::min(Batch, n - next);
      const Eigen::MatrixXd other = reader.Read(next, count);
      InnerProducts(execution, block, other, gram.block(first, next, held, count));
      gram.block(next, first, count, held) = gram.block(first, next, held, count).transpose();
    }
  }
  return gram;
}

Eigen::Index
CountModes(const Eigen::VectorXd & variances, double total, double noise, const GramParameters & parameters)
{
  Eigen::Index k = 0;
  double       explained = 0;
  const bool   all = parameters.proportion >= 1.0;
  while (k < variances.size() && variances[k] > std::max(noise, NoiseLevel * variances[0]) &&
         (all || explained < parameters.proportion * total) &&
         (parameters.maximumModes <= 0 || k < parameters.maximumModes))
  {
    explained += variances[k++];
  }
  return k;
}

/** Makes the columns orthonormal: Q of the Cholesky-QR factorisation, in place. */
void
Orthonormalize(const Execution & execution, Eigen::MatrixXd & modes)
{
  const Eigen::Index           k = modes.cols(), chunks = (modes.rows() + RowChunk - 1) / RowChunk;
  Eigen::MatrixXd              products = Eigen::MatrixXd::Zero(k, k);
  const Eigen::Index           wave = 8; // partial products held at once; their order of addition is fixed
  std::vector<Eigen::MatrixXd> partial(static_cast<std::size_t>(wave));
  for (Eigen::Index first = 0; first < chunks; first += wave)
  {
    const Eigen::Index count = std::min(wave, chunks - first);
    InParallel(execution, count, [&](Eigen::Index i) {
      const Eigen::Index row = (first + i) * RowChunk;
      const auto         rows = modes.middleRows(row, std::min(RowChunk, modes.rows() - row));
      partial[static_cast<std::size_t>(i)] = rows.transpose() * rows;
    });
    for (Eigen::Index i = 0; i < count; ++i)
    {
      products += partial[static_cast<std::size_t>(i)];
    }
  }
  const Eigen::LLT<Eigen::MatrixXd> factor(products);
  OverRows(execution, modes.rows(), [&](Eigen::Index first, Eigen::Index rows) {
    const Eigen::MatrixXd solved = factor.matrixL().solve(modes.middleRows(first, rows).transpose());
    modes.middleRows(first, rows) = solved.transpose();
  });
}

/** Gives each mode the sign that makes its largest entry positive; of equally large ones the first decides. */
void
FixSigns(Eigen::MatrixXd & modes, Eigen::MatrixXd & vectors)
{
  for (Eigen::Index k = 0; k < modes.cols(); ++k)
  {
    Eigen::Index largest = 0;
    modes.col(k).cwiseAbs().maxCoeff(&largest);
    if (modes(largest, k) < 0)
    {
      modes.col(k) = -modes.col(k);
      vectors.col(k) = -vectors.col(k);
    }
  }
}
} // namespace

PrincipalModes
AnalyzeVectors(const VectorSource &    source,
               const Eigen::VectorXd & weights,
               const Eigen::MatrixXd & block,
               const GramParameters &  parameters,
               Eigen::MatrixXd *       scores,
               const Execution &       execution)
{
  const Eigen::Index n = source.count, d = source.dimension;
  if (n < 2 || d < 1)
  {
    throw std::invalid_argument("Modes of variation need two subjects or more.");
  }
  const PlainProduct    product(weights, block);
  const CentredReader   reader(source, product, execution);
  const Eigen::MatrixXd gram =
    GramMatrix(reader, source, parameters.blockBytes, execution.Part(0.2, 0.7)) / static_cast<double>(n - 1);
  const SymmetricEigen  eigen = EigenOf(gram);
  const Eigen::VectorXd variances = eigen.values.reverse();

  PrincipalModes result;
  result.mean = reader.Mean();
  result.weights = weights;
  result.block = block;
  result.totalVariance = gram.trace();
  Eigen::MatrixXd mean = result.mean;
  product.To(mean);
  const double       rounding = RoundingLevel * mean.norm();
  const Eigen::Index k = CountModes(variances, result.totalVariance, rounding * rounding, parameters);
  result.variances = variances.head(k);
  Eigen::MatrixXd vectors = eigen.vectors.rowwise().reverse().leftCols(k);
  result.modes.setZero(d, k);
  const Eigen::VectorXd scale = (static_cast<double>(n - 1) * result.variances).cwiseSqrt().cwiseInverse();
  for (Eigen::Index first = 0; first < n && k > 0; first += Batch)
  {
    execution.Report(0.7 + 0.3 * static_cast<double>(first) / static_cast<double>(n));
    const Eigen::Index    count = std::min(Batch, n - first);
    const Eigen::MatrixXd batch = reader.Read(first, count);
    const Eigen::MatrixXd parts = vectors.middleRows(first, count) * scale.asDiagonal();
    OverRows(execution, d, [&](Eigen::Index row, Eigen::Index rows) {
      result.modes.middleRows(row, rows).noalias() += batch.middleRows(row, rows) * parts;
    });
  }
  if (k > 0)
  {
    Orthonormalize(execution, result.modes);
  }
  product.From(result.modes);
  FixSigns(result.modes, vectors);
  if (scores != nullptr)
  {
    *scores = vectors * std::sqrt(static_cast<double>(n - 1));
  }
  return result;
}
} // namespace bone
