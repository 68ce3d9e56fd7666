/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/

// Figures of the atlas, as JSON lines; atlas.py makes the report of them:
//   boneAtlasValidation registration STANDARD.vtu REFERENCE.ply SUBJECT.ply...   correspondence is known
//   boneAtlasValidation frames|icp ...                                           the same with the alternatives
//   boneAtlasValidation population STANDARD.vtu SUBJECTS VOXEL                   scans of phantoms with known factors
//   boneAtlasValidation samples ATLAS.h5 FOLDER FIRST COUNT NOISE                random subjects of an atlas
//   boneAtlasValidation compare ATLAS.h5 ATLAS.h5 MODES                          the first modes of two atlases

#include "boneAtlasRegistration.h"
#include "boneDirectedSurface.h"
#include "boneBuildPipeline.h"
#include "boneHemipelvisPhantom.h"
#include "boneMeshIO.h"
#include "boneModelEvaluation.h"
#include "boneModelIO.h"
#include "bonePhantomImageSource.h"
#include "bonePopulation.h"
#include "boneStatisticalModelEstimator.h"

#include <itkMultiThreaderBase.h>

#include <Eigen/QR>
#include <Eigen/SVD>
#include <nlohmann/json.hpp>

#include <array>
#include <ctime>
#include <iomanip>
#include <iostream>
#include <numeric>
#include <random>
#include <sstream>

namespace
{
using namespace bone;
using nlohmann::json;

/** Processor seconds of all threads. */
double
Cpu()
{
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

double
Percentile(std::vector<double> values, double share)
{
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

double
Mean(const std::vector<double> & values)
{
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/** Throws the surface into a pose and shuffles its vertices and triangles. */
AffineMap
Disguise(TriangleSurface & surface, unsigned seed)
{
  std::mt19937                     generator(seed);
  std::normal_distribution<double> normal;
  const Eigen::Quaterniond         q(normal(generator), normal(generator), normal(generator), normal(generator));
  AffineMap                        pose;
  pose.linear = q.normalized().toRotationMatrix();
  pose.translation = 200 * Vector3(normal(generator), normal(generator), normal(generator));
  std::vector<IdType> order(surface.points.size());
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), generator);
  std::vector<Vector3> points(surface.points.size());
  for (std::size_t p = 0; p < points.size(); ++p)
  {
    points[order[p]] = pose(surface.points[p]);
  }
  surface.points = points;
  for (auto & t : surface.triangles)
  {
    t = { order[t[0]], order[t[1]], order[t[2]] };
  }
  std::shuffle(surface.triangles.begin(), surface.triangles.end(), generator);
  return pose;
}

/** Where the standard model's exterior points belong on a subject, by the data's own correspondence. */
std::vector<Vector3>
KnownPlaces(const TriangleSurface & source,
            const DirectedSurface & reference,
            const TriangleSurface & subject,
            const AffineMap &       pose)
{
  std::vector<Vector3> places;
  for (const Vector3 & x : source.points)
  {
    const auto    match = reference.FindAny(x);
    const auto &  t = reference.GetSurface().triangles[static_cast<std::size_t>(match.triangle)];
    const Vector3 w = reference.Weights(match.triangle, match.point);
    places.push_back(pose(w[0] * subject.points[t[0]] + w[1] * subject.points[t[1]] + w[2] * subject.points[t[2]]));
  }
  return places;
}

void
PrintModes(const char * name, const std::vector<ModelQuality> & quality)
{
  for (const ModelQuality & q : quality)
  {
    std::cout << json{ { "model", name },
                       { "modes", q.modes },
                       { "compactness", q.compactness },
                       { "generalisation", q.generalisation.mean },
                       { "generalisationError", q.generalisation.standardError },
                       { "specificity", q.specificity.mean },
                       { "specificityError", q.specificity.standardError } }
              << std::endl;
  }
}

void
Registration(const std::vector<std::string> & files, const AtlasRegistrationParameters & parameters, bool evaluate)
{
  const StandardModel               model(ReadMeshArrays(files[0]));
  const DirectedSurface             reference(ReadTriangleSurface(files[1]));
  const TriangleSurface &           source = model.GetSurface();
  std::vector<std::vector<Vector3>> found, truth;
  std::vector<double>               all;
  for (std::size_t s = 2; s < files.size(); ++s)
  {
    TriangleSurface      subject = ReadTriangleSurface(files[s]);
    const auto           original = subject;
    const AffineMap      pose = Disguise(subject, static_cast<unsigned>(s + 1));
    RegistrationReport   report;
    const double         start = Cpu();
    const auto           points = model.Register({ subject, {} }, parameters, report);
    const double         seconds = Cpu() - start;
    std::vector<Vector3> surface;
    for (const IdType p : model.GetSurfacePointIds())
    {
      surface.push_back(points[p]);
    }
    const auto          expected = KnownPlaces(source, reference, original, pose);
    std::vector<double> error;
    for (std::size_t p = 0; p < surface.size(); ++p)
    {
      error.push_back((surface[p] - expected[p]).norm());
    }
    all.insert(all.end(), error.begin(), error.end());
    std::cout << json{ { "subject", files[s].substr(files[s].rfind('/') + 1) },
                       { "alignment", report.alignmentDistance },
                       { "surface", report.surfaceDistance },
                       { "back", report.subjectDistance },
                       { "mean", Mean(error) },
                       { "median", Percentile(error, 0.5) },
                       { "p95", Percentile(error, 0.95) },
                       { "tangled", report.untangling.before },
                       { "inverted", report.untangling.after },
                       { "seconds", seconds } }
              << std::endl;
    found.push_back(surface);
    truth.push_back(expected);
  }
  std::cout << json{ { "all", "median" }, { "median", Percentile(all, 0.5) }, { "mean", Mean(all) } } << std::endl;
  if (evaluate)
  {
    PrintModes("registered", EvaluateShapes(found, EvaluationParameters()));
    PrintModes("known", EvaluateShapes(truth, EvaluationParameters()));
  }
}

double
VolumeOf(const MeshArrays & mesh)
{
  double volume = 0;
  for (const Id4 & c : mesh.tetrahedra)
  {
    volume += SignedVolume(mesh.points[c[0]], mesh.points[c[1]], mesh.points[c[2]], mesh.points[c[3]]);
  }
  return volume;
}

double
MassOf(const MeshArrays & mesh)
{
  double     mass = 0;
  const auto count = static_cast<std::size_t>(BernsteinCount(mesh.maximumDegree));
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
  {
    const Id4 & c = mesh.tetrahedra[t];
    mass += BernsteinIntegral(mesh.maximumDegree,
                              &mesh.coefficients[t * count],
                              SignedVolume(mesh.points[c[0]], mesh.points[c[1]], mesh.points[c[2]], mesh.points[c[3]]));
  }
  return mass;
}

/** A phantom's CT and its label map. */
struct Scan
{
  Scan(const PhantomModel::Pointer & phantom, double voxel)
  {
    using Source = PhantomImageSource<CTImage>;
    auto                source = Source::New();
    Source::SpacingType spacing;
    spacing.Fill(voxel);
    source->SetModel(phantom);
    source->SetSpacing(spacing);
    source->Update();
    ct = source->GetOutput();
    labels = source->GetLabelOutput();
    const std::size_t count = ct->GetBufferedRegion().GetNumberOfPixels();
    for (std::size_t i = 0; i < count; ++i)
    {
      if (labels->GetBufferPointer()[i] > 0)
      {
        volume += voxel * voxel * voxel;
        mass += ct->GetBufferPointer()[i] * voxel * voxel * voxel;
      }
    }
  }

  CTImage::Pointer    ct;
  LabelImage::Pointer labels;
  double              volume{ 0 }; ///< of the label's voxels, mm^3
  double              mass{ 0 };   ///< integral of the CT over them
};

/** Share of a factor's variance that the scores of the first modes explain. */
double
Explained(const Eigen::VectorXd & factor, const Eigen::MatrixXd & scores)
{
  const Eigen::VectorXd fit = scores * scores.colPivHouseholderQr().solve(factor);
  return fit.squaredNorm() / factor.squaredNorm();
}

/** Three factors of shape and two of density, orthogonal over the subjects, of mean 0 and variance 1. */
Eigen::MatrixXd
Factors(Eigen::Index subjects)
{
  std::mt19937                           generator(7);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  Eigen::MatrixXd                        design(subjects, 6);
  design.col(0).setOnes();
  for (Eigen::Index i = 0; i < subjects; ++i)
  {
    for (Eigen::Index j = 1; j < 6; ++j)
    {
      design(i, j) = uniform(generator);
    }
  }
  const Eigen::MatrixXd q =
    Eigen::HouseholderQR<Eigen::MatrixXd>(design).householderQ() * Eigen::MatrixXd::Identity(subjects, 6);
  return q.rightCols(5) * std::sqrt(static_cast<double>(subjects - 1));
}

HemipelvisParameters
ParametersOf(const Eigen::MatrixXd & factors, Eigen::Index i)
{
  HemipelvisParameters p;
  p.scale *= 1 + 0.035 * factors(i, 0);
  p.wingRadius += 12 * factors(i, 1);
  p.inclination += 4 * factors(i, 2);
  p.corticalDensity += 50 * factors(i, 3);
  p.trabecularDensity += 25 * factors(i, 4);
  return p;
}

/** Trains on the subjects, by volume with a weight of variation within cells or (0) by coefficients, and prints what
 * the first modes explain of the factors. */
void
PrintFactors(double within, int degree, const MeshTrainingSet<> * set, const Eigen::MatrixXd & factors, double mass)
{
  auto estimator = StatisticalModelEstimator<>::New();
  estimator->SetInput(set);
  estimator->SetVarianceProportion(1.0); // all modes: the third of shape is beyond 98 % of the variance
  estimator->SetCoefficientProduct(!(within > 0));
  if (within > 0)
  {
    estimator->SetWithinCellWeight(within);
  }
  estimator->Update();
  const auto &          content = estimator->GetOutput()->GetContent();
  const Eigen::MatrixXd shape = content.shapeScores.leftCols(3), density = content.densityScores.leftCols(2);
  const char *          names[5] = {
             "size", "bend of the wing", "inclination of the cup", "cortical density", "trabecular density"
  };
  const std::string kind = within == 1 ? "integral" : within > 0 ? "volume" : "coefficients";
  const std::string product = kind + ", degree " + std::to_string(degree);
  for (Eigen::Index f = 0; f < 5; ++f)
  {
    std::cout << json{ { "product", product },
                       { "factor", names[f] },
                       { "explained", Explained(factors.col(f), f < 3 ? shape : density) } }
              << std::endl;
  }
  const double across = (shape.transpose() * density / static_cast<double>(factors.rows() - 1)).cwiseAbs().maxCoeff();
  std::cout << json{ { "product", product }, { "correlation", across }, { "mass", MassOf(content.mean) / mass } }
            << std::endl;
}

/** What the toolkit's chain makes of a scan: slices and cells of its own. */
MeshArrays
Build(const Scan & scan)
{
  BuildPipeline pipeline(/* levels */ 1);
  pipeline.SetImage(scan.ct);
  pipeline.SetLabelImage(scan.labels);
  pipeline.GetSnake()->SetSliceStep(2.5);
  pipeline.SetContourSpacing(5.0);
  pipeline.GetQuality()->Update();
  return pipeline.GetQuality()->GetOutput()->GetArrays();
}

void
Population(const std::string & standard, Eigen::Index subjects, double voxel)
{
  auto mesh = DensityMesh<double>::New();
  mesh->SetArrays(ReadMeshArrays(standard));
  constexpr int                                   Degrees[] = { 2, 0 };
  PopulationRegistration                          population(mesh, Degrees[0]);
  const Eigen::MatrixXd                           factors = Factors(subjects);
  const std::array<MeshTrainingSet<>::Pointer, 2> sets = { { MeshTrainingSet<>::New(), MeshTrainingSet<>::New() } };
  for (Eigen::Index i = 0; i < subjects; ++i)
  {
    const Scan          scan(std::make_shared<const HemipelvisPhantom>(ParametersOf(factors, i)), voxel);
    const MeshArrays    own = Build(scan);
    const MeshArrays    carried = population.Bring(own, scan.ct);
    const auto &        report = population.GetFilter()->GetReport();
    std::vector<double> layerVolume;
    const auto          brought = SurfacesOf(carried), there = SurfacesOf(own);
    for (std::size_t k = 0; k < std::min(brought.inner.size(), there.inner.size()); ++k)
    {
      layerVolume.push_back(EnclosedVolume(brought.inner[k]) / EnclosedVolume(there.inner[k]));
    }
    std::cout << json{ { "phantom", i },
                       { "cells", own.tetrahedra.size() },
                       { "surface", report.surfaceDistance },
                       { "back", report.subjectDistance },
                       { "tangled", report.untangling.before },
                       { "layers", report.layerDistance },
                       { "layerVolume", layerVolume },
                       { "ownVolume", VolumeOf(own) / scan.volume },
                       { "volume", VolumeOf(carried) / scan.volume },
                       { "mass", MassOf(carried) / scan.mass } }
              << std::endl;
    for (std::size_t d = 0; d < sets.size(); ++d)
    {
      auto subject = DensityMesh<double>::New();
      subject->SetArrays(d == 0 ? carried : FitDensityOfImage(scan.ct, Degrees[d], carried));
      sets[d]->AddSubject("phantom " + std::to_string(i), subject);
    }
  }
  const double mass = Scan(std::make_shared<const HemipelvisPhantom>(), voxel).mass;
  PrintFactors(0, Degrees[0], sets[0], factors, mass);
  PrintFactors(1, Degrees[0], sets[0], factors, mass);
  for (std::size_t d = 0; d < sets.size(); ++d)
  {
    PrintFactors(StatisticalModelEstimator<>::New()->GetWithinCellWeight(), Degrees[d], sets[d], factors, mass);
  }
}

/** Random bones of an atlas, with noise in every coefficient that is their own: 00001.vtu, ... */
void
Samples(const std::string & atlas, const std::string & folder, unsigned first, unsigned count, double noise)
{
  const auto   model = ReadStatisticalModel(atlas);
  const auto & content = model->GetContent();
  for (unsigned i = first; i < first + count; ++i)
  {
    MeshArrays   mesh = model->Synthesize(SampleCoefficients(content.shape.GetNumberOfModes(), 2 * i),
                                        SampleCoefficients(content.density.GetNumberOfModes(), 2 * i + 1));
    std::mt19937 generator(i);
    std::normal_distribution<double> normal(0.0, noise);
    for (double & c : mesh.coefficients)
    {
      c += normal(generator);
    }
    std::ostringstream name;
    name << folder << '/' << std::setw(5) << std::setfill('0') << i << ".vtu";
    WriteMeshArrays(mesh, name.str());
  }
}

/** The first modes of two atlases: variances as shares of the first's, and the largest angle between their spans. */
json
CompareModes(const PrincipalModes & a, const PrincipalModes & b, Eigen::Index count)
{
  const Eigen::Index k = std::min({ count, a.GetNumberOfModes(), b.GetNumberOfModes() });
  Eigen::MatrixXd    cross(k, k);
  double             variance = 0;
  for (Eigen::Index i = 0; i < k; ++i)
  {
    cross.col(i) = a.modes.leftCols(k).transpose() * b.Dual(b.modes.col(i));
    variance = std::max(variance, std::abs(b.variances[i] / a.variances[i] - 1));
  }
  const double cosine = cross.jacobiSvd().singularValues().minCoeff();
  return { { "modes", { a.GetNumberOfModes(), b.GetNumberOfModes() } },
           { "compared", k },
           { "variance", variance },
           { "total", std::abs(b.totalVariance / a.totalVariance - 1) },
           { "explained", { a.variances.sum() / a.totalVariance, b.variances.sum() / b.totalVariance } },
           { "degrees", std::acos(std::min(1.0, cosine)) * 180 / std::acos(-1.0) } };
}

void
Compare(const std::string & first, const std::string & second, Eigen::Index count)
{
  const auto   a = ReadStatisticalModel(first), b = ReadStatisticalModel(second);
  const auto & x = a->GetContent();
  const auto & y = b->GetContent();
  double       mean = 0;
  for (std::size_t i = 0; i < x.mean.points.size(); ++i)
  {
    mean = std::max(mean, (x.mean.points[i] - y.mean.points[i]).norm());
  }
  std::cout << json{ { "mean", mean },
                     { "shape", CompareModes(x.shape, y.shape, count) },
                     { "density", CompareModes(x.density, y.density, count) } }
            << std::endl;
}
} // namespace

int
main(int argc, char ** argv)
{
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  try
  {
    AtlasRegistrationParameters parameters;
    if (argc > 4 && arguments[0] == "registration")
    {
      Registration({ arguments.begin() + 1, arguments.end() }, parameters, argc > 7);
    }
    else if (argc > 4 && arguments[0] == "frames")
    {
      parameters.interior = InteriorRule::EigenFrame;
      Registration({ arguments.begin() + 1, arguments.end() }, parameters, false);
    }
    else if (argc > 4 && arguments[0] == "icp")
    {
      parameters.method = DeformationMethod::NonRigidICP;
      Registration({ arguments.begin() + 1, arguments.end() }, parameters, false);
    }
    else if (argc == 5 && arguments[0] == "population")
    {
      Population(arguments[1], std::stol(arguments[2]), std::stod(arguments[3]));
    }
    else if (argc == 7 && arguments[0] == "samples")
    {
      Samples(arguments[1],
              arguments[2],
              static_cast<unsigned>(std::stoul(arguments[3])),
              static_cast<unsigned>(std::stoul(arguments[4])),
              std::stod(arguments[5]));
    }
    else if (argc == 5 && arguments[0] == "compare")
    {
      Compare(arguments[1], arguments[2], std::stol(arguments[3]));
    }
    else
    {
      std::cerr << "usage: see the head of the source\n";
      return EXIT_FAILURE;
    }
  }
  catch (const std::exception & error)
  {
    std::cerr << error.what() << '\n';
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
