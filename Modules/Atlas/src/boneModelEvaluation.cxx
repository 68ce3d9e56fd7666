/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneModelEvaluation.h"

#include "boneDensityFitKernel.h"
#include "boneLeftOutModels.h"
#include "boneStatisticalModel.h"

#include <cmath>
#include <limits>
#include <stdexcept>

namespace bone
{
namespace
{
/** A shape's points as one vector. */
Eigen::Map<const Eigen::VectorXd>
Stacked(const std::vector<Vector3> & shape)
{
  return { shape.front().data(), 3 * static_cast<Eigen::Index>(shape.size()) };
}

double
MeanDistance(const Eigen::Ref<const Eigen::VectorXd> & a, const Eigen::Ref<const Eigen::VectorXd> & b)
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
Compactness(const ModeAccumulator & model, int k)
{
  const Eigen::Index count = std::min<Eigen::Index>(k, model.GetVariances().size());
  const double       total = model.GetTotalVariance();
  return total > 0 ? model.GetVariances().head(count).sum() / total : 1.0;
}

MeanWithError
Specificity(const ModeAccumulator &                   model,
            const std::vector<std::vector<Vector3>> & shapes,
            int                                       k,
            const EvaluationParameters &              parameters)
{
  const Eigen::Index    count = std::min<Eigen::Index>(k, model.GetVariances().size());
  const Eigen::VectorXd deviation = model.GetVariances().head(count).cwiseSqrt();
  std::vector<double>   distances;
  for (int s = 0; s < parameters.samples; ++s)
  {
    const Eigen::VectorXd b = SampleCoefficients(count, parameters.seed + static_cast<std::uint64_t>(s));
    const Eigen::VectorXd sample = model.GetMean() + model.GetModes().leftCols(count) * deviation.cwiseProduct(b);
    double                nearest = std::numeric_limits<double>::max();
    for (const auto & shape : shapes)
    {
      nearest = std::min(nearest, MeanDistance(sample, Stacked(shape)));
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
  LeftOutModels models(Stacked(shapes.front()).size(), n);
  for (const auto & shape : shapes)
  {
    models.Next() = Stacked(shape);
  }
  models.Finish();
  std::vector<std::vector<double>> errors(modes.size());
  for (const auto & shape : shapes)
  {
    const Eigen::VectorXd y = Stacked(shape);
    std::vector<Vector3>  moved = shape;
    Apply(AlignToMean(shape, UnstackPoints(models.MeanWithout(y)), parameters.alignment), moved);
    const Eigen::VectorXd x = Stacked(moved);
    models.Reconstruct(y, x, modes, [&](std::size_t m, const Eigen::VectorXd & nearest) {
      errors[m].push_back(MeanDistance(nearest, x));
    });
  }
  std::vector<ModelQuality> result;
  for (std::size_t m = 0; m < modes.size(); ++m)
  {
    ModelQuality quality;
    quality.modes = modes[m];
    quality.compactness = Compactness(models.GetAll(), modes[m]);
    quality.generalisation = Summarize(errors[m]);
    quality.specificity = Specificity(models.GetAll(), shapes, modes[m], parameters);
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
                  std::size_t                  count,
                  const CoefficientPass &      subjects,
                  const EvaluationParameters & parameters)
{
  const std::vector<int> modes = UsableModes(parameters, static_cast<Eigen::Index>(count));
  const auto             dimension = static_cast<Eigen::Index>(mesh.coefficients.size());
  const auto             vectorOf = [dimension](const std::vector<double> & coefficients) {
    if (static_cast<Eigen::Index>(coefficients.size()) != dimension)
    {
      throw std::invalid_argument("Densities to evaluate must have the coefficients of the mesh.");
    }
    return Eigen::Map<const Eigen::VectorXd>(coefficients.data(), dimension);
  };
  LeftOutModels models(dimension, static_cast<Eigen::Index>(count));
  subjects([&](const std::vector<double> & own) { models.Next() = vectorOf(own); });
  models.Finish();
  struct Errors
  {
    std::vector<double> bias, meanAbsolute, rootMeanSquare;
  };
  std::vector<Errors> errors(modes.size());
  subjects([&](const std::vector<double> & own) {
    const Eigen::VectorXd y = vectorOf(own);
    models.Reconstruct(y, y, modes, [&](std::size_t m, const Eigen::VectorXd & nearest) {
      const DensityDifference difference = CompareDensities(mesh, nearest, y);
      errors[m].bias.push_back(difference.bias);
      errors[m].meanAbsolute.push_back(difference.meanAbsolute);
      errors[m].rootMeanSquare.push_back(difference.rootMeanSquare);
    });
  });
  std::vector<DensityQuality> result;
  for (std::size_t m = 0; m < modes.size(); ++m)
  {
    result.push_back({ modes[m],
                       Compactness(models.GetAll(), modes[m]),
                       Summarize(errors[m].bias),
                       Summarize(errors[m].meanAbsolute),
                       Summarize(errors[m].rootMeanSquare) });
  }
  return result;
}
} // namespace bone
