/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneModelEvaluation.h"

#include "boneDensityFitKernel.h"
#include "boneGramAnalysis.h"
#include "boneStatisticalModel.h"

#include <cmath>
#include <limits>
#include <stdexcept>

namespace bone
{
namespace
{
/** Full-rank modes of the columns of a matrix but one (-1: of all). */
PrincipalModes
ModesWithout(const Eigen::MatrixXd & columns, Eigen::Index left)
{
  VectorSource source;
  source.count = columns.cols() - (left >= 0 ? 1 : 0);
  source.dimension = columns.rows();
  source.load = [&columns, left](Eigen::Index i, double * y) {
    Eigen::Map<Eigen::VectorXd>(y, columns.rows()) = columns.col(left >= 0 && i >= left ? i + 1 : i);
  };
  return AnalyzeVectors(source, {}, {}, GramParameters());
}

/** The nearest vector to y of the model with k modes. */
Eigen::VectorXd
Reconstruct(const PrincipalModes & model, const Eigen::VectorXd & y, Eigen::Index k)
{
  const auto modes = model.modes.leftCols(std::min(k, model.GetNumberOfModes()));
  return model.mean + modes * (modes.transpose() * (y - model.mean));
}

double
MeanDistance(const Eigen::VectorXd & a, const Eigen::VectorXd & b)
{
  const Eigen::Map<const Eigen::Matrix3Xd> x(a.data(), 3, a.size() / 3), y(b.data(), 3, b.size() / 3);
  return (x - y).colwise().norm().mean();
}

std::vector<int>
UsableModes(const EvaluationParameters & parameters, Eigen::Index subjects)
{
  if (subjects < 3)
  {
    throw std::invalid_argument("Leave-one-out needs three subjects or more.");
  }
  std::vector<int> modes;
  for (const int k : parameters.modes)
  {
    if (k >= 0 && k <= subjects - 2)
    {
      modes.push_back(k);
    }
  }
  return modes;
}

double
Compactness(const PrincipalModes & model, int k)
{
  const Eigen::Index count = std::min<Eigen::Index>(k, model.GetNumberOfModes());
  return model.totalVariance > 0 ? model.variances.head(count).sum() / model.totalVariance : 1.0;
}

MeanWithError
Specificity(const PrincipalModes &       model,
            const Eigen::MatrixXd &      columns,
            int                          k,
            const EvaluationParameters & parameters)
{
  std::vector<double> distances;
  for (int s = 0; s < parameters.samples; ++s)
  {
    const Eigen::Index    count = std::min<Eigen::Index>(k, model.GetNumberOfModes());
    const Eigen::VectorXd sample =
      model.Synthesize(SampleCoefficients(count, parameters.seed + static_cast<std::uint64_t>(s)));
    double nearest = std::numeric_limits<double>::max();
    for (Eigen::Index i = 0; i < columns.cols(); ++i)
    {
      nearest = std::min(nearest, MeanDistance(sample, columns.col(i)));
    }
    distances.push_back(nearest);
  }
  return Summarize(distances);
}
} // namespace

MeanWithError
Summarize(const std::vector<double> & values)
{
  MeanWithError result;
  const double  n = static_cast<double>(values.size());
  if (values.empty())
  {
    return result;
  }
  for (const double value : values)
  {
    result.mean += value / n;
  }
  if (values.size() > 1)
  {
    double sum = 0;
    for (const double value : values)
    {
      sum += (value - result.mean) * (value - result.mean);
    }
    result.standardError = std::sqrt(sum / (n - 1) / n);
  }
  return result;
}

std::vector<ModelQuality>
EvaluateShapes(std::vector<std::vector<Vector3>> shapes, const EvaluationParameters & parameters)
{
  const auto             n = static_cast<Eigen::Index>(shapes.size());
  const std::vector<int> modes = UsableModes(parameters, n);
  AlignShapes(shapes, parameters.alignment);
  Eigen::MatrixXd columns(3 * static_cast<Eigen::Index>(shapes.front().size()), n);
  for (Eigen::Index i = 0; i < n; ++i)
  {
    columns.col(i) = StackPoints(shapes[static_cast<std::size_t>(i)]);
  }
  std::vector<std::vector<double>> errors(modes.size());
  for (Eigen::Index i = 0; i < n; ++i)
  {
    const PrincipalModes model = ModesWithout(columns, i);
    auto &               shape = shapes[static_cast<std::size_t>(i)];
    const AffineMap      pose = AlignToMean(shape, UnstackPoints(model.mean), parameters.alignment);
    for (Vector3 & x : shape)
    {
      x = pose(x);
    }
    const Eigen::VectorXd y = StackPoints(shape);
    for (std::size_t m = 0; m < modes.size(); ++m)
    {
      errors[m].push_back(MeanDistance(Reconstruct(model, y, modes[m]), y));
    }
  }
  const PrincipalModes      whole = ModesWithout(columns, -1);
  std::vector<ModelQuality> result;
  for (std::size_t m = 0; m < modes.size(); ++m)
  {
    ModelQuality quality;
    quality.modes = modes[m];
    quality.compactness = Compactness(whole, modes[m]);
    quality.generalisation = Summarize(errors[m]);
    quality.specificity = Specificity(whole, columns, modes[m], parameters);
    result.push_back(quality);
  }
  return result;
}

DensityDifference
CompareDensities(const MeshArrays & mesh, const Eigen::VectorXd & first, const Eigen::VectorXd & second)
{
  const auto count = static_cast<Eigen::Index>(mesh.HasDensity() ? BernsteinCount(mesh.maximumDegree) : 0);
  const auto cells = static_cast<Eigen::Index>(mesh.tetrahedra.size());
  if (count == 0 || first.size() != count * cells || second.size() != first.size())
  {
    throw std::invalid_argument("Densities to compare must have the coefficients of the mesh.");
  }
  const DensityFitKernel kernel(mesh.maximumDegree, DensityFitKernel::MinimumLattice(mesh.maximumDegree));
  Eigen::MatrixXd        basis(static_cast<Eigen::Index>(kernel.SamplePoints().size()), count);
  std::vector<double>    row(static_cast<std::size_t>(count));
  for (Eigen::Index s = 0; s < basis.rows(); ++s)
  {
    BernsteinBasis(mesh.maximumDegree, kernel.SamplePoints()[static_cast<std::size_t>(s)], row.data());
    basis.row(s) = Eigen::Map<const Eigen::RowVectorXd>(row.data(), count);
  }
  DensityDifference result;
  double            sum = 0, square = 0;
  for (Eigen::Index t = 0; t < cells; ++t)
  {
    const Id4 &  c = mesh.tetrahedra[static_cast<std::size_t>(t)];
    const double volume =
      std::abs(SignedVolume(mesh.points[c[0]], mesh.points[c[1]], mesh.points[c[2]], mesh.points[c[3]]));
    const Eigen::VectorXd values = basis * (first.segment(t * count, count) - second.segment(t * count, count));
    sum += volume;
    result.bias += volume * values.mean();
    result.meanAbsolute += volume * values.cwiseAbs().mean();
    square += volume * values.squaredNorm() / static_cast<double>(values.size());
  }
  result.bias /= sum;
  result.meanAbsolute /= sum;
  result.rootMeanSquare = std::sqrt(square / sum);
  return result;
}

std::vector<DensityQuality>
EvaluateDensities(const MeshArrays &           mesh,
                  const Eigen::MatrixXd &      coefficients,
                  const EvaluationParameters & parameters)
{
  const Eigen::Index     n = coefficients.cols();
  const std::vector<int> modes = UsableModes(parameters, n);
  struct Errors
  {
    std::vector<double> bias, meanAbsolute, rootMeanSquare;
  };
  std::vector<Errors> errors(modes.size());
  for (Eigen::Index i = 0; i < n; ++i)
  {
    const PrincipalModes model = ModesWithout(coefficients, i);
    for (std::size_t m = 0; m < modes.size(); ++m)
    {
      const Eigen::VectorXd   y = coefficients.col(i);
      const DensityDifference difference = CompareDensities(mesh, Reconstruct(model, y, modes[m]), y);
      errors[m].bias.push_back(difference.bias);
      errors[m].meanAbsolute.push_back(difference.meanAbsolute);
      errors[m].rootMeanSquare.push_back(difference.rootMeanSquare);
    }
  }
  const PrincipalModes        whole = ModesWithout(coefficients, -1);
  std::vector<DensityQuality> result;
  for (std::size_t m = 0; m < modes.size(); ++m)
  {
    result.push_back({ modes[m],
                       Compactness(whole, modes[m]),
                       Summarize(errors[m].bias),
                       Summarize(errors[m].meanAbsolute),
                       Summarize(errors[m].rootMeanSquare) });
  }
  return result;
}
} // namespace bone
