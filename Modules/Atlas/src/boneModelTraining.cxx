/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneModelTraining.h"

#include "boneBernstein.h"
#include "boneGramAnalysis.h"
#include "bonePointAlignment.h"
#include "boneSymmetricEigen.h"

#include <itkMacro.h>

#include <algorithm>
#include <numeric>

namespace bone
{
namespace
{
using Shapes = std::vector<std::vector<Vector3>>;

/** Throws where a subject is not on the topology of the first. */
void
VerifySubject(const TrainingSet & set, std::size_t i, const MeshArrays & mesh, const MeshArrays & first)
{
  const std::string name = set.GetSubjectName(i);
  if (mesh.points.size() != first.points.size() || mesh.tetrahedra != first.tetrahedra)
  {
    itkGenericExceptionMacro(
      "Subject " << name << " has another topology than " << set.GetSubjectName(0) << " (" << mesh.points.size()
                 << " points and " << mesh.tetrahedra.size() << " tetrahedra, not " << first.points.size() << " and "
                 << first.tetrahedra.size() << ", or in another order): register the standard model to it first.");
  }
  if (mesh.maximumDegree != first.maximumDegree)
  {
    itkGenericExceptionMacro("Subject " << name << " has density of degree " << mesh.maximumDegree << ", "
                                        << set.GetSubjectName(0) << " of " << first.maximumDegree
                                        << " (-1: none): fit all with one degree.");
  }
  if (mesh.HasDensity() &&
      std::any_of(mesh.degree.begin(), mesh.degree.end(), [&mesh](int d) { return d != mesh.maximumDegree; }))
  {
    itkGenericExceptionMacro("Subject " << name << " has tetrahedra of several degrees: fit all with one degree.");
  }
  if (mesh.quantity != first.quantity)
  {
    itkGenericExceptionMacro("Subject " << name << " has density in " << DensityQuantityName(mesh.quantity) << ", "
                                        << set.GetSubjectName(0) << " in " << DensityQuantityName(first.quantity)
                                        << ": bring all to one unit.");
  }
  for (const Vector3 & x : mesh.points)
  {
    if (!x.allFinite())
    {
      itkGenericExceptionMacro("Subject " << name << " has a point that is not finite.");
    }
  }
}

/** Inner products of the Bernstein polynomials of a degree in a cell of volume 1: of their means, plus `within` times
 * that of what they differ from them. The same for the same functions, whatever the degree. */
Eigen::MatrixXd
BernsteinGram(int degree, double within)
{
  const int       count = BernsteinCount(degree);
  Eigen::MatrixXd gram(count, count);
  for (int i = 0; i < count; ++i)
  {
    for (int j = 0; j < count; ++j)
    {
      const Eigen::VectorXd a = Eigen::VectorXd::Unit(count, i), b = Eigen::VectorXd::Unit(count, j);
      gram(i, j) = BernsteinInnerProduct(degree, a.data(), degree, b.data(), 1.0);
    }
  }
  const double mean = 1.0 / count; // of each polynomial
  return (within * gram.array() + (1.0 - within) * mean * mean).matrix();
}

/** Volume of the cell of every coefficient, of mean 1 over the cells. */
Eigen::VectorXd
VolumeWeights(const MeshArrays & mesh)
{
  const auto      count = static_cast<Eigen::Index>(BernsteinCount(mesh.maximumDegree));
  const auto      cells = static_cast<Eigen::Index>(mesh.tetrahedra.size());
  Eigen::VectorXd weights(count * cells);
  double          sum = 0;
  for (Eigen::Index t = 0; t < cells; ++t)
  {
    const Id4 &  c = mesh.tetrahedra[static_cast<std::size_t>(t)];
    const double volume =
      std::abs(SignedVolume(mesh.points[c[0]], mesh.points[c[1]], mesh.points[c[2]], mesh.points[c[3]]));
    weights.segment(t * count, count).setConstant(volume);
    sum += volume;
  }
  const double mean = sum / static_cast<double>(cells);
  return (weights / mean).cwiseMax(1e-6); // a flat cell of the mean keeps a weight that can be divided by
}

VectorSource
ShapeSource(const Shapes & shapes)
{
  const auto d = 3 * static_cast<Eigen::Index>(shapes.front().size());
  return { static_cast<Eigen::Index>(shapes.size()), d, [&shapes, d](Eigen::Index i, double * y) {
            const auto & shape = shapes[static_cast<std::size_t>(i)];
            std::copy_n(shape.front().data(), d, y);
          } };
}

/** Coefficients of the chosen subjects. */
VectorSource
DensitySource(const TrainingSet & set, const std::vector<std::size_t> & chosen, Eigen::Index dimension)
{
  return { static_cast<Eigen::Index>(chosen.size()), dimension, [&set, &chosen, dimension](Eigen::Index i, double * y) {
            const MeshArrays mesh = set.GetSubject(chosen[static_cast<std::size_t>(i)]);
            if (static_cast<Eigen::Index>(mesh.coefficients.size()) != dimension)
            {
              itkGenericExceptionMacro("Subject " << set.GetSubjectName(chosen[static_cast<std::size_t>(i)])
                                                  << " changed while it was read.");
            }
            std::copy(mesh.coefficients.begin(), mesh.coefficients.end(), y);
          } };
}

CombinedModes
Combine(const StatisticalModelContent & content, double proportion)
{
  CombinedModes         combined;
  const Eigen::Index    n = content.shapeScores.rows();
  const Eigen::Index    ks = content.shape.GetNumberOfModes(), kd = content.density.GetNumberOfModes();
  const Eigen::VectorXd shape = content.shape.variances.cwiseSqrt(), density = content.density.variances.cwiseSqrt();
  combined.shapeWeight = std::sqrt(content.density.totalVariance / content.shape.totalVariance);
  Eigen::MatrixXd both(n, ks + kd);
  both << combined.shapeWeight * content.shapeScores * shape.asDiagonal(), content.densityScores * density.asDiagonal();
  const Eigen::MatrixXd covariance = both.transpose() * both / static_cast<double>(n - 1);
  const SymmetricEigen  eigen = EigenOf(covariance);
  const Eigen::VectorXd variances = eigen.values.reverse();
  Eigen::Index          k = 0;
  double                explained = 0;
  while (k < variances.size() && variances[k] > 1e-12 * variances[0] &&
         (proportion >= 1.0 || explained < proportion * variances.sum()))
  {
    explained += variances[k++];
  }
  combined.variances = variances.head(k);
  combined.vectors = eigen.vectors.rowwise().reverse().leftCols(k);
  return combined;
}

double
RootMeanSquare(const double * a, const double * b, std::size_t count, std::size_t per)
{
  double sum = 0;
  for (std::size_t i = 0; i < count; ++i)
  {
    sum += (a[i] - b[i]) * (a[i] - b[i]);
  }
  return std::sqrt(sum / static_cast<double>(count / per));
}

/** Reads every subject once: verifies it, takes its shape, and leaves the first one's mesh. */
MeshArrays
ReadShapes(const TrainingSet & set, const Execution & execution, Shapes & shapes)
{
  const std::size_t n = set.GetNumberOfSubjects();
  MeshArrays        first;
  for (std::size_t i = 0; i < n; ++i)
  {
    MeshArrays mesh = set.GetSubject(i);
    if (i == 0)
    {
      first = mesh;
    }
    VerifySubject(set, i, mesh, first);
    shapes.push_back(std::move(mesh.points));
    execution.Report(static_cast<double>(i + 1) / static_cast<double>(n));
  }
  return first;
}

void
FindDeviations(const TrainingSet &             set,
               const Shapes &                  shapes,
               const StatisticalModelContent & content,
               double                          threshold,
               const Execution &               execution,
               std::vector<SubjectDeviation> & subjects)
{
  std::vector<double> shape, density;
  for (std::size_t i = 0; i < shapes.size(); ++i)
  {
    execution.Report(static_cast<double>(i) / static_cast<double>(shapes.size()));
    shape.push_back(
      RootMeanSquare(shapes[i].front().data(), content.mean.points.front().data(), 3 * shapes[i].size(), 3));
    if (content.mean.HasDensity())
    {
      const MeshArrays mesh = set.GetSubject(i);
      density.push_back(
        RootMeanSquare(mesh.coefficients.data(), content.mean.coefficients.data(), mesh.coefficients.size(), 1));
    }
  }
  const std::vector<double> shapeScores = ModifiedScores(shape), densityScores = ModifiedScores(density);
  for (std::size_t i = 0; i < shapes.size(); ++i)
  {
    SubjectDeviation deviation;
    deviation.name = set.GetSubjectName(i);
    deviation.shape = shape[i];
    deviation.shapeScore = shapeScores[i];
    deviation.density = density.empty() ? 0.0 : density[i];
    deviation.densityScore = density.empty() ? 0.0 : densityScores[i];
    deviation.outlier = threshold > 0 && std::max(deviation.shapeScore, deviation.densityScore) > threshold;
    subjects.push_back(deviation);
  }
}

/** Aligns the chosen shapes and finds all modes. `shapes` are moved. */
StatisticalModelContent
AnalyzeSubjects(const TrainingSet &                set,
                const std::vector<std::size_t> &   chosen,
                const MeshArrays &                 topology,
                Shapes &                           shapes,
                const StatisticalModelParameters & parameters,
                const Execution &                  execution)
{
  StatisticalModelContent content;
  content.mean = topology;
  content.similarity = parameters.alignment == AlignmentKind::Similarity;
  execution.ThrowIfAborted();
  content.mean.points = AlignShapes(shapes, parameters.alignment).mean;
  GramParameters gram{ parameters.varianceProportion, parameters.maximumModes, parameters.blockBytes };
  content.shape = AnalyzeVectors(ShapeSource(shapes), {}, {}, gram, &content.shapeScores, execution.Part(0.1, 0.4));
  if (topology.HasDensity())
  {
    const Eigen::VectorXd weights = parameters.coefficientProduct ? Eigen::VectorXd() : VolumeWeights(content.mean);
    const Eigen::MatrixXd block = parameters.coefficientProduct
                                    ? Eigen::MatrixXd()
                                    : BernsteinGram(content.mean.maximumDegree, parameters.withinCellWeight);
    const auto            dimension = static_cast<Eigen::Index>(topology.coefficients.size());
    content.density = AnalyzeVectors(
      DensitySource(set, chosen, dimension), weights, block, gram, &content.densityScores, execution.Part(0.4, 1.0));
    content.mean.coefficients.assign(content.density.mean.data(), content.density.mean.data() + dimension);
    if (parameters.combined && content.density.GetNumberOfModes() > 0 && content.shape.GetNumberOfModes() > 0)
    {
      content.combined = Combine(content, parameters.varianceProportion);
    }
  }
  for (const std::size_t i : chosen)
  {
    content.subjects.push_back(set.GetSubjectName(i));
  }
  return content;
}
} // namespace

std::vector<double>
ModifiedScores(const std::vector<double> & values)
{
  const auto median = [](std::vector<double> list) {
    const std::size_t half = list.size() / 2;
    std::nth_element(list.begin(), list.begin() + half, list.end());
    const double upper = list[half];
    return list.size() % 2 == 1 ? upper : 0.5 * (upper + *std::max_element(list.begin(), list.begin() + half));
  };
  std::vector<double> scores(values.size(), 0.0);
  if (values.empty())
  {
    return scores;
  }
  const double        middle = median(values);
  std::vector<double> distance;
  for (const double value : values)
  {
    distance.push_back(std::abs(value - middle));
  }
  const double spread = median(distance);
  for (std::size_t i = 0; i < values.size() && spread > 0; ++i)
  {
    scores[i] = 0.6745 * (values[i] - middle) / spread;
  }
  return scores;
}

TrainingResult
TrainModel(const TrainingSet & set, const StatisticalModelParameters & parameters, const Execution & execution)
{
  if (set.GetNumberOfSubjects() < 2)
  {
    itkGenericExceptionMacro("The training set has " << set.GetNumberOfSubjects()
                                                     << " subjects; modes of variation need two or more.");
  }
  Shapes           shapes;
  const MeshArrays topology = ReadShapes(set, execution.Part(0.0, 0.15), shapes);
  if (parameters.combined && !topology.HasDensity())
  {
    itkGenericExceptionMacro("A combined model was asked for, but the subjects have no density.");
  }
  TrainingResult           result;
  std::vector<std::size_t> chosen(shapes.size());
  std::iota(chosen.begin(), chosen.end(), 0);
  result.content = AnalyzeSubjects(set, chosen, topology, shapes, parameters, execution.Part(0.15, 0.65));
  FindDeviations(set, shapes, result.content, parameters.outlierThreshold, execution.Part(0.65, 0.75), result.subjects);
  if (parameters.rejectOutliers)
  {
    Shapes kept;
    chosen.clear();
    for (std::size_t i = 0; i < shapes.size(); ++i)
    {
      result.subjects[i].used = !result.subjects[i].outlier;
      if (result.subjects[i].used)
      {
        chosen.push_back(i);
        kept.push_back(std::move(shapes[i]));
      }
    }
    if (chosen.size() < 2)
    {
      itkGenericExceptionMacro("Fewer than two subjects are left after rejecting outliers: raise the threshold.");
    }
    if (chosen.size() < shapes.size())
    {
      result.content = AnalyzeSubjects(set, chosen, topology, kept, parameters, execution.Part(0.75, 1.0));
    }
  }
  return result;
}
} // namespace bone
