/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneModelTraining.h"

#include "boneBernstein.h"
#include "bonePointAlignment.h"
#include "boneSymmetricEigen.h"
#include "boneVectorAnalysis.h"

#include <itkMacro.h>

#include <algorithm>
#include <numeric>
#include <set>

namespace bone
{
namespace
{
/** Throws where a subject is not on the topology of the first, or of the atlas that it is added to. */
void
VerifySubject(const std::string & name,
              const MeshArrays &  mesh,
              const std::string & firstName,
              const MeshArrays &  first)
{
  if (mesh.points.size() != first.points.size() || mesh.tetrahedra != first.tetrahedra)
  {
    itkGenericExceptionMacro(
      "Subject " << name << " has another topology than " << firstName << " (" << mesh.points.size() << " points and "
                 << mesh.tetrahedra.size() << " tetrahedra, not " << first.points.size() << " and "
                 << first.tetrahedra.size() << ", or in another order): register the standard model to it first.");
  }
  if (mesh.maximumDegree != first.maximumDegree)
  {
    itkGenericExceptionMacro("Subject " << name << " has density of degree " << mesh.maximumDegree << ", " << firstName
                                        << " of " << first.maximumDegree << " (-1: none): fit all with one degree.");
  }
  if (mesh.HasDensity() &&
      std::any_of(mesh.degree.begin(), mesh.degree.end(), [&mesh](int d) { return d != mesh.maximumDegree; }))
  {
    itkGenericExceptionMacro("Subject " << name << " has tetrahedra of several degrees: fit all with one degree.");
  }
  if (mesh.quantity != first.quantity)
  {
    itkGenericExceptionMacro("Subject " << name << " has density in " << DensityQuantityName(mesh.quantity) << ", "
                                        << firstName << " in " << DensityQuantityName(first.quantity)
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

/** \class ShapeStore
 * \brief The subjects' points: in memory, or, where they need more than is given, read from the set at every turn. */
class ShapeStore
{
public:
  ShapeStore(const TrainingSet & set, double bytes)
    : m_Set(set)
    , m_Bytes(bytes)
  {}
  /** Subject after subject. */
  void
  Add(std::vector<Vector3> && points)
  {
    m_Points = points.size();
    const double each = static_cast<double>(m_Points * sizeof(Vector3));
    if (each * static_cast<double>(m_Set.GetNumberOfSubjects()) <= m_Bytes)
    {
      m_Shapes.push_back(std::move(points));
    }
  }
  void
  Load(std::size_t i, std::vector<Vector3> & shape) const
  {
    shape = m_Shapes.empty() ? m_Set.GetSubject(i).points : m_Shapes[i];
    if (shape.size() != m_Points)
    {
      itkGenericExceptionMacro("Subject " << m_Set.GetSubjectName(i) << " changed while it was read.");
    }
  }

private:
  const TrainingSet &               m_Set;
  double                            m_Bytes;
  std::size_t                       m_Points{ 0 };
  std::vector<std::vector<Vector3>> m_Shapes;
};

/** What a model is trained from. */
struct TrainingTask
{
  const TrainingSet &                set;
  const StatisticalModelParameters & parameters;
  const StatisticalModelContent *    former; ///< the atlas that subjects are added to, if there is one
  MeshArrays                         topology;
  ShapeStore                         shapes;
  std::vector<std::size_t>           chosen;
};

/** The chosen subjects' points, each moved by its map. */
VectorSource
MovedShapes(const TrainingTask & task, const std::vector<AffineMap> & maps)
{
  const auto d = 3 * static_cast<Eigen::Index>(task.topology.points.size());
  return { static_cast<Eigen::Index>(maps.size()), d, [&task, &maps, d](Eigen::Index i, double * y) {
            const auto           k = static_cast<std::size_t>(i);
            std::vector<Vector3> shape;
            task.shapes.Load(task.chosen[k], shape);
            Apply(maps[k], shape);
            std::copy_n(shape.front().data(), d, y);
          } };
}

/** Coefficients of the chosen subjects. */
VectorSource
Densities(const TrainingTask & task)
{
  const auto d = static_cast<Eigen::Index>(task.topology.coefficients.size());
  return { static_cast<Eigen::Index>(task.chosen.size()), d, [&task, d](Eigen::Index i, double * y) {
            const std::size_t subject = task.chosen[static_cast<std::size_t>(i)];
            const MeshArrays  mesh = task.set.GetSubject(subject);
            if (static_cast<Eigen::Index>(mesh.coefficients.size()) != d)
            {
              itkGenericExceptionMacro("Subject " << task.set.GetSubjectName(subject) << " changed while it was read.");
            }
            std::copy(mesh.coefficients.begin(), mesh.coefficients.end(), y);
          } };
}

/** The maps of the chosen subjects to the mean's frame. */
std::vector<AffineMap>
AlignSubjects(const TrainingTask & task, std::vector<Vector3> & mean)
{
  const ShapeSource source{ task.chosen.size(), [&task](std::size_t i, std::vector<Vector3> & shape) {
                             task.shapes.Load(task.chosen[i], shape);
                           } };
  if (task.former == nullptr)
  {
    ProcrustesResult found = AlignShapes(source, task.parameters.alignment);
    mean = std::move(found.mean);
    return std::move(found.maps);
  }
  mean = task.former->mean.points;
  const AlignmentKind    kind = task.former->similarity ? AlignmentKind::Similarity : task.parameters.alignment;
  std::vector<AffineMap> maps;
  std::vector<Vector3>   shape;
  for (std::size_t i = 0; i < source.count; ++i)
  {
    source.load(i, shape);
    maps.push_back(AlignToMean(shape, mean, kind));
  }
  return maps;
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

/** Reads every subject once: verifies it and takes its shape. Leaves the mesh of the first, or of the atlas. */
void
ReadSubjects(TrainingTask & task, const Execution & execution)
{
  const std::size_t     n = task.set.GetNumberOfSubjects();
  std::set<std::string> names;
  std::string           first = "the atlas";
  if (task.former != nullptr)
  {
    task.topology = task.former->mean;
    names.insert(task.former->subjects.begin(), task.former->subjects.end());
  }
  for (std::size_t i = 0; i < n; ++i)
  {
    MeshArrays        mesh = task.set.GetSubject(i);
    const std::string name = task.set.GetSubjectName(i);
    if (i == 0 && task.former == nullptr)
    {
      first = name;
      task.topology = mesh;
    }
    VerifySubject(name, mesh, first, task.topology);
    if (names.count(name) != 0)
    {
      itkGenericExceptionMacro("Subject " << name << " is in the atlas already: leave it out, or name it otherwise.");
    }
    task.shapes.Add(std::move(mesh.points));
    execution.Report(static_cast<double>(i + 1) / static_cast<double>(n));
  }
}

/** Root mean square distances to the mean, of subjects in their order. */
struct Distances
{
  std::vector<double> shape;   ///< of points, mm
  std::vector<double> density; ///< of coefficients; empty: there are none
};

/** Those of vectors that modes make of their scores, and, on average, of what the modes leave out. */
std::vector<double>
DistancesOfScores(const PrincipalModes & modes, const Eigen::MatrixXd & scores, double count, bool withRest)
{
  const Eigen::MatrixXd scaled = scores * modes.variances.cwiseSqrt().asDiagonal();
  const Eigen::MatrixXd products = modes.modes.transpose() * modes.modes;
  const Eigen::VectorXd squares = (scaled * products).cwiseProduct(scaled).rowwise().sum();
  const double          rest = withRest ? std::max(0.0, modes.totalVariance - modes.variances.sum()) : 0.0;
  std::vector<double>   distances;
  for (const double square : squares)
  {
    distances.push_back(std::sqrt((square + rest) / count));
  }
  return distances;
}

/** The model of the chosen subjects, and how far each is from the mean, those of the atlas first. */
StatisticalModelContent
AnalyzeSubjects(const TrainingTask & task, const Execution & execution, Distances & distances)
{
  const StatisticalModelParameters & parameters = task.parameters;
  const StatisticalModelContent *    former = task.former;
  const auto                         points = static_cast<double>(task.topology.points.size());
  const auto                         coefficients = static_cast<double>(task.topology.coefficients.size());
  StatisticalModelContent            content;
  content.mean = task.topology;
  content.similarity = former != nullptr ? former->similarity : parameters.alignment == AlignmentKind::Similarity;
  execution.ThrowIfAborted();
  const std::vector<AffineMap> maps = AlignSubjects(task, content.mean.points);
  const auto                   note = [](std::vector<double> & list, double count) {
    return [&list, count](const Eigen::VectorXd & y, const Eigen::VectorXd & mean) {
      list.push_back(std::sqrt((y - mean).squaredNorm() / count));
    };
  };
  const AnalysisParameters analysis{ parameters.varianceProportion,
                                     parameters.maximumModes,
                                     static_cast<std::size_t>(parameters.memory * 1e6) };
  FormerVectors            formerShapes, formerDensities;
  if (former != nullptr)
  {
    formerShapes = { &former->shape, &former->shapeScores };
    formerDensities = { &former->density, &former->densityScores };
    distances.shape = DistancesOfScores(former->shape, former->shapeScores, points, true);
  }
  content.shape = AnalyzeVectors(MovedShapes(task, maps),
                                 {},
                                 {},
                                 analysis,
                                 content.shapeScores,
                                 execution.Part(0.1, 0.3),
                                 formerShapes,
                                 note(distances.shape, points));
  content.mean.points = UnstackPoints(content.shape.mean);
  if (task.topology.HasDensity())
  {
    const Eigen::VectorXd weights = parameters.coefficientProduct ? Eigen::VectorXd() : VolumeWeights(content.mean);
    const Eigen::MatrixXd block = parameters.coefficientProduct
                                    ? Eigen::MatrixXd()
                                    : BernsteinGram(content.mean.maximumDegree, parameters.withinCellWeight);
    if (former != nullptr)
    {
      distances.density = DistancesOfScores(former->density, former->densityScores, coefficients, false);
    }
    content.density = AnalyzeVectors(Densities(task),
                                     weights,
                                     block,
                                     analysis,
                                     content.densityScores,
                                     execution.Part(0.3, 1.0),
                                     formerDensities,
                                     note(distances.density, coefficients));
    content.mean.coefficients.assign(content.density.mean.data(),
                                     content.density.mean.data() + content.density.GetDimension());
    const bool combined = parameters.combined || (former != nullptr && former->combined.variances.size() > 0);
    if (combined && content.density.GetNumberOfModes() > 0 && content.shape.GetNumberOfModes() > 0)
    {
      content.combined = Combine(content, parameters.varianceProportion);
    }
  }
  if (former != nullptr)
  {
    content.subjects = former->subjects;
  }
  for (const std::size_t i : task.chosen)
  {
    content.subjects.push_back(task.set.GetSubjectName(i));
  }
  return content;
}

/** The set's subjects among all distances, of which theirs are the last. */
std::vector<SubjectDeviation>
FindDeviations(const TrainingSet & set, const Distances & distances, double threshold)
{
  const std::vector<double> shapeScores = ModifiedScores(distances.shape),
                            densityScores = ModifiedScores(distances.density);
  std::vector<SubjectDeviation> subjects;
  const std::size_t             before = distances.shape.size() - set.GetNumberOfSubjects();
  for (std::size_t i = 0; i < set.GetNumberOfSubjects(); ++i)
  {
    SubjectDeviation deviation;
    deviation.name = set.GetSubjectName(i);
    deviation.shape = distances.shape[before + i];
    deviation.shapeScore = shapeScores[before + i];
    if (!distances.density.empty())
    {
      deviation.density = distances.density[before + i];
      deviation.densityScore = densityScores[before + i];
    }
    deviation.outlier = threshold > 0 && std::max(deviation.shapeScore, deviation.densityScore) > threshold;
    subjects.push_back(deviation);
  }
  return subjects;
}

void
VerifyTask(const TrainingSet &                set,
           const StatisticalModelParameters & parameters,
           const StatisticalModelContent *    former)
{
  const std::size_t count = set.GetNumberOfSubjects();
  if (count < (former == nullptr ? 2u : 1u))
  {
    itkGenericExceptionMacro("The training set has " << count << " subjects; "
                                                     << (former == nullptr ? "modes of variation need two or more."
                                                                           : "there is none to add to the atlas."));
  }
  if (former != nullptr &&
      (former->shapeScores.rows() < 2 || (parameters.alignment == AlignmentKind::Similarity && !former->similarity)))
  {
    itkGenericExceptionMacro("Subjects cannot be added to this atlas: it "
                             << (former->shapeScores.rows() < 2 ? "does not hold the scores of its subjects."
                                                                : "was trained without similarity."));
  }
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
TrainModel(const TrainingSet &                set,
           const StatisticalModelParameters & parameters,
           const Execution &                  execution,
           const StatisticalModelContent *    former)
{
  VerifyTask(set, parameters, former);
  TrainingTask task{ set, parameters, former, {}, ShapeStore(set, 1e6 * parameters.memory), {} };
  ReadSubjects(task, execution.Part(0.0, 0.2));
  if (parameters.combined && !task.topology.HasDensity())
  {
    itkGenericExceptionMacro("A combined model was asked for, but the subjects have no density.");
  }
  TrainingResult result;
  Distances      distances;
  task.chosen.resize(set.GetNumberOfSubjects());
  std::iota(task.chosen.begin(), task.chosen.end(), 0);
  result.content = AnalyzeSubjects(task, execution.Part(0.2, 0.7), distances);
  result.subjects = FindDeviations(set, distances, parameters.outlierThreshold);
  if (!parameters.rejectOutliers)
  {
    return result;
  }
  task.chosen.clear();
  for (std::size_t i = 0; i < result.subjects.size(); ++i)
  {
    result.subjects[i].used = !result.subjects[i].outlier;
    if (result.subjects[i].used)
    {
      task.chosen.push_back(i);
    }
  }
  if (task.chosen.size() < (former == nullptr ? 2u : 1u))
  {
    itkGenericExceptionMacro("Fewer than two subjects are left after rejecting outliers: raise the threshold.");
  }
  if (task.chosen.size() < result.subjects.size())
  {
    Distances unused;
    result.content = AnalyzeSubjects(task, execution.Part(0.7, 1.0), unused);
  }
  return result;
}
} // namespace bone
