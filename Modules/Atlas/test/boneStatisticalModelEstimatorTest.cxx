/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneStatisticalModelEstimator.h"

#include "boneAtlasTestPopulation.h"

#include <itkMultiThreaderBase.h>

#include <gtest/gtest.h>

namespace StatisticalModelEstimatorTests
{
using namespace bone;
using namespace bone::test;
using Estimator = StatisticalModelEstimator<DensityMesh<double>>;

Estimator::Pointer
Estimate(
  const std::vector<MeshArrays> &          subjects,
  const std::function<void(Estimator *)> & set = [](Estimator *) {})
{
  auto estimator = Estimator::New();
  estimator->SetInput(MakeSet(subjects));
  estimator->SetVarianceProportion(1.0);
  set(estimator);
  estimator->Update();
  return estimator;
}

double
LargestDistance(const std::vector<Vector3> & a, const std::vector<Vector3> & b)
{
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
  {
    largest = std::max(largest, (a[i] - b[i]).norm());
  }
  return largest;
}

double
OrthonormalityError(const PrincipalModes & model)
{
  const Eigen::Index k = model.GetNumberOfModes();
  Eigen::MatrixXd    weighted = model.modes;
  for (Eigen::Index i = 0; i < k; ++i)
  {
    weighted.col(i) = model.Dual(model.modes.col(i));
  }
  return (model.modes.transpose() * weighted - Eigen::MatrixXd::Identity(k, k)).cwiseAbs().maxCoeff();
}

/** Every training subject is the model of its own coefficients. */
void
ExpectReproduced(const StatisticalModel * model, const std::vector<MeshArrays> & subjects, AlignmentKind kind)
{
  const auto & content = model->GetContent();
  for (const MeshArrays & subject : subjects)
  {
    std::vector<Vector3> points = subject.points;
    Move(AlignToMean(points, content.mean.points, kind), points);
    const Eigen::VectorXd shape = content.shape.Project(StackPoints(points));
    const Eigen::VectorXd density = content.density.Project(
      Eigen::Map<const Eigen::VectorXd>(subject.coefficients.data(), content.density.GetDimension()));
    const MeshArrays made = model->Synthesize(shape, density);
    EXPECT_LT(LargestDistance(made.points, points), 1e-8);
    for (std::size_t i = 0; i < made.coefficients.size(); ++i)
    {
      ASSERT_NEAR(made.coefficients[i], subject.coefficients[i], 1e-8 * 1000);
    }
  }
}

TEST(StatisticalModelEstimator, ReproducesTheTrainingSetAtFullRank)
{
  const auto subjects = MakePopulation(7);
  ExpectReproduced(Estimate(subjects)->GetOutput(), subjects, AlignmentKind::Rigid);
  const auto similar = Estimate(subjects, [](Estimator * e) { e->SetAlignment(AlignmentKind::Similarity); });
  ExpectReproduced(similar->GetOutput(), subjects, AlignmentKind::Similarity);
  EXPECT_TRUE(similar->GetOutput()->GetContent().similarity);
  ExpectReproduced(
    Estimate(subjects, [](Estimator * e) { e->CoefficientProductOn(); })->GetOutput(), subjects, AlignmentKind::Rigid);
}

TEST(StatisticalModelEstimator, ModesAreOrthonormalAndScoresAreThoseOfTheSubjects)
{
  for (const bool coefficients : { false, true })
  {
    const auto estimator = Estimate(MakePopulation(9), [&](Estimator * e) { e->SetCoefficientProduct(coefficients); });
    const auto & content = estimator->GetOutput()->GetContent();
    EXPECT_LT(OrthonormalityError(content.shape), 1e-12);
    EXPECT_LT(OrthonormalityError(content.density), 1e-12);
    // Scores: mean 0, variance 1, uncorrelated.
    const Eigen::MatrixXd & b = content.shapeScores;
    EXPECT_LT(b.colwise().mean().cwiseAbs().maxCoeff(), 1e-9);
    const Eigen::MatrixXd covariance = b.transpose() * b / 8.0;
    EXPECT_LT((covariance - Eigen::MatrixXd::Identity(b.cols(), b.cols())).cwiseAbs().maxCoeff(), 1e-9);
    EXPECT_NEAR(content.shape.variances.sum(), content.shape.totalVariance, 1e-9 * content.shape.totalVariance);
  }
}

TEST(StatisticalModelEstimator, VolumeWeightedModesAreThoseOfTheDensityWhateverItsDegree)
{
  auto       subjects = MakePopulation(8);
  const auto low = Estimate(subjects);
  const int  degree = subjects.front().maximumDegree;
  const auto from = static_cast<std::size_t>(BernsteinCount(degree)),
             to = static_cast<std::size_t>(BernsteinCount(degree + 2));
  for (MeshArrays & subject : subjects)
  {
    const auto before = subject.coefficients;
    subject.maximumDegree = degree + 2;
    subject.degree.assign(subject.tetrahedra.size(), degree + 2);
    subject.coefficients.resize(subject.tetrahedra.size() * to);
    for (std::size_t t = 0; t < subject.tetrahedra.size(); ++t)
    {
      BernsteinElevate(degree, &before[t * from], degree + 2, &subject.coefficients[t * to]);
    }
  }
  const auto  high = Estimate(subjects);
  const auto &a = low->GetOutput()->GetContent().density, &b = high->GetOutput()->GetContent().density;
  ASSERT_EQ(a.GetNumberOfModes(), b.GetNumberOfModes());
  EXPECT_LT((b.variances - a.variances).norm(), 1e-8 * b.variances.norm());
}

TEST(StatisticalModelEstimator, VariationWithinCellsCountsByItsWeight)
{
  const auto subjects = MakePopulation(8);
  const auto variance = [&](double weight) {
    const auto estimator = Estimate(subjects, [&](Estimator * e) { e->SetWithinCellWeight(weight); });
    return estimator->GetOutput()->GetContent();
  };
  const auto model = variance(1.0);
  // The variance of the cells' means, from the subjects.
  const std::size_t cells = model.mean.tetrahedra.size();
  const auto        count = static_cast<Eigen::Index>(subjects.front().coefficients.size() / cells);
  Eigen::VectorXd   volume(cells);
  Eigen::MatrixXd   means(cells, subjects.size());
  for (std::size_t t = 0; t < cells; ++t)
  {
    const Id4 &  c = model.mean.tetrahedra[t];
    const auto & p = model.mean.points;
    volume[static_cast<Eigen::Index>(t)] = SignedVolume(p[c[0]], p[c[1]], p[c[2]], p[c[3]]);
    for (std::size_t i = 0; i < subjects.size(); ++i)
    {
      means(t, i) =
        Eigen::Map<const Eigen::VectorXd>(&subjects[i].coefficients[t * static_cast<std::size_t>(count)], count).mean();
    }
  }
  means.colwise() -= means.rowwise().mean().eval();
  const double between = (volume.asDiagonal() * means.cwiseAbs2()).sum() / volume.mean() / 7.0;
  const double all = model.density.totalVariance;
  EXPECT_GT(all, 1.005 * between);
  for (const double weight : { 0.01, 0.25, 0.5 })
  {
    EXPECT_NEAR(variance(weight).density.totalVariance, between + weight * (all - between), 1e-10 * all);
  }
}

TEST(StatisticalModelEstimator, FindsAsManyDensityModesAsThereArePatterns)
{
  const auto estimator = Estimate(MakePopulation(9));
  EXPECT_EQ(estimator->GetOutput()->GetContent().density.GetNumberOfModes(), 3);
}

TEST(StatisticalModelEstimator, SampleYieldsItsCoefficients)
{
  const auto   estimator = Estimate(MakePopulation(8));
  const auto * model = estimator->GetOutput();
  const auto & content = model->GetContent();
  const auto   shape = SampleCoefficients(content.shape.GetNumberOfModes(), 4);
  const auto   density = SampleCoefficients(content.density.GetNumberOfModes(), 5);
  const auto   mesh = model->Synthesize(shape, density);
  EXPECT_LT((content.shape.Project(StackPoints(mesh.points)) - shape).norm(), 1e-8);
  const Eigen::Map<const Eigen::VectorXd> c(mesh.coefficients.data(), content.density.GetDimension());
  EXPECT_LT((content.density.Project(c) - density).norm(), 1e-8);
}

TEST(StatisticalModelEstimator, DoesNotDependOnPose)
{
  auto       subjects = MakePopulation(8);
  const auto still = Estimate(subjects);
  for (unsigned i = 0; i < subjects.size(); ++i)
  {
    Move(RandomPose(i), subjects[i].points);
  }
  const auto           moved = Estimate(subjects);
  const auto &         a = still->GetOutput()->GetContent();
  const auto &         b = moved->GetOutput()->GetContent();
  std::vector<Vector3> mean = b.mean.points;
  Move(FitAlignment(mean, a.mean.points, AlignmentKind::Rigid), mean);
  EXPECT_LT(LargestDistance(mean, a.mean.points), 1e-8);
  EXPECT_LT((a.shape.variances.head(6) - b.shape.variances.head(6)).norm(), 1e-8 * a.shape.variances[0]);
  EXPECT_LT((a.density.variances - b.density.variances).norm(), 1e-10 * a.density.variances.norm());
}

TEST(StatisticalModelEstimator, DoesNotDependOnTheOrderOfSubjects)
{
  auto       subjects = MakePopulation(8);
  const auto forward = Estimate(subjects);
  std::reverse(subjects.begin(), subjects.end());
  const auto   backward = Estimate(subjects);
  const auto & a = forward->GetOutput()->GetContent();
  const auto & b = backward->GetOutput()->GetContent();
  EXPECT_LT(LargestDistance(a.mean.points, b.mean.points), 1e-8);
  EXPECT_LT((a.shape.modes.leftCols(3) - b.shape.modes.leftCols(3)).cwiseAbs().maxCoeff(), 1e-7);
  EXPECT_LT((a.density.modes - b.density.modes).cwiseAbs().maxCoeff(), 1e-7);
  EXPECT_LT((a.shapeScores.leftCols(3) - b.shapeScores.leftCols(3).colwise().reverse()).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(StatisticalModelEstimator, IsTheSameForAnyNumberOfThreads)
{
  const auto subjects = MakePopulation(8);
  const auto before = itk::MultiThreaderBase::GetGlobalDefaultNumberOfThreads();
  itk::MultiThreaderBase::SetGlobalDefaultNumberOfThreads(1);
  const auto one = Estimate(subjects);
  itk::MultiThreaderBase::SetGlobalDefaultNumberOfThreads(4);
  const auto four = Estimate(subjects);
  itk::MultiThreaderBase::SetGlobalDefaultNumberOfThreads(before);
  EXPECT_EQ(one->GetOutput()->GetContent().shape.modes, four->GetOutput()->GetContent().shape.modes);
  EXPECT_EQ(one->GetOutput()->GetContent().density.modes, four->GetOutput()->GetContent().density.modes);
}

TEST(StatisticalModelEstimator, StreamedBlocksGiveTheSameModel)
{
  const auto   subjects = MakePopulation(40, 0);
  const auto   whole = Estimate(subjects);
  const auto   streamed = Estimate(subjects, [](Estimator * e) { e->SetMemory(0); });
  const auto & a = whole->GetOutput()->GetContent().density;
  const auto & b = streamed->GetOutput()->GetContent().density;
  ASSERT_EQ(a.GetNumberOfModes(), b.GetNumberOfModes());
  EXPECT_LT((a.modes - b.modes).cwiseAbs().maxCoeff(), 1e-9);
}

/** Subjects whose densities vary in as many patterns as there are cells, each a tenth less than the one before. */
std::vector<MeshArrays>
MakeManifold(unsigned count)
{
  std::vector<MeshArrays>          subjects(count, MakeSubject(1, 0));
  const auto                       d = static_cast<Eigen::Index>(subjects[0].coefficients.size());
  std::mt19937                     generator(7);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd                  patterns(d, d);
  for (double & x : patterns.reshaped())
  {
    x = normal(generator);
  }
  for (MeshArrays & subject : subjects)
  {
    Eigen::Map<Eigen::VectorXd> density(subject.coefficients.data(), d);
    double                      size = 100;
    for (Eigen::Index k = 0; k < d; ++k, size *= 0.9)
    {
      density += size * normal(generator) * patterns.col(k) / std::sqrt(static_cast<double>(d));
    }
  }
  return subjects;
}

TEST(StatisticalModelEstimator, LeadingModesHoldWhereMemoryDoesNot)
{
  const auto   subjects = MakeManifold(300);
  const auto   whole = Estimate(subjects);
  const auto   streamed = Estimate(subjects, [](Estimator * e) { e->SetMemory(0); });
  const auto & a = whole->GetOutput()->GetContent().density;
  const auto & b = streamed->GetOutput()->GetContent().density;
  EXPECT_GT(a.GetNumberOfModes(), 60);
  ASSERT_EQ(b.GetNumberOfModes(), 16); // half of the least that is held
  EXPECT_NEAR(b.totalVariance, a.totalVariance, 1e-10 * a.totalVariance);
  EXPECT_LT((a.mean - b.mean).norm(), 1e-10 * a.mean.norm());
  EXPECT_LT(OrthonormalityError(b), 1e-10);
  for (Eigen::Index k = 0; k < 8; ++k)
  {
    EXPECT_NEAR(b.variances[k], a.variances[k], 2e-3 * a.variances[k]) << k;
    EXPECT_LE(b.variances[k], a.variances[k] * (1 + 1e-10)) << k; // of the data, in a subspace
  }
  // Scores are those of the subjects, and uncorrelated.
  const auto &          content = streamed->GetOutput()->GetContent();
  const Eigen::VectorXd last =
    b.Project(Eigen::Map<const Eigen::VectorXd>(subjects.back().coefficients.data(), b.GetDimension()));
  EXPECT_LT((content.densityScores.bottomRows(1).transpose() - last).norm(), 1e-8);
  const Eigen::MatrixXd covariance = content.densityScores.transpose() * content.densityScores / 299.0;
  EXPECT_LT((covariance - Eigen::MatrixXd::Identity(16, 16)).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(StatisticalModelEstimator, ShapesThatDoNotFitAreReadAgain)
{
  const auto   subjects = MakePopulation(9);
  const auto   held = Estimate(subjects);
  const auto   read = Estimate(subjects, [](Estimator * e) { e->SetMemory(0.001); });
  const auto & a = held->GetOutput()->GetContent();
  const auto & b = read->GetOutput()->GetContent();
  EXPECT_LT(LargestDistance(a.mean.points, b.mean.points), 1e-12);
  EXPECT_LT((a.shapeScores - b.shapeScores).cwiseAbs().maxCoeff(), 1e-9);
}

/** The model of the first subjects, and the others added to it. */
Estimator::Pointer
EstimateInTwoSteps(
  const std::vector<MeshArrays> &          subjects,
  std::size_t                              first,
  const std::function<void(Estimator *)> & set = [](Estimator *) {})
{
  const auto before = Estimate({ subjects.begin(), subjects.begin() + static_cast<std::ptrdiff_t>(first) }, set);
  auto       more = MeshTrainingSet<>::New();
  for (std::size_t i = first; i < subjects.size(); ++i)
  {
    auto mesh = DensityMesh<double>::New();
    mesh->SetArrays(subjects[i]);
    more->AddSubject("subject " + std::to_string(i), mesh);
  }
  auto estimator = Estimator::New();
  estimator->SetVarianceProportion(1.0);
  set(estimator);
  estimator->SetInput(more);
  estimator->SetAtlas(before->GetOutput());
  estimator->Update();
  return estimator;
}

TEST(StatisticalModelEstimator, SubjectsAddedToAModelOfFullRankGiveTheModelOfAll)
{
  const auto plain = [](Estimator * e) {
    e->SetAlignment(AlignmentKind::None);
    e->CoefficientProductOn();
    e->CombinedOn();
  };
  const auto   subjects = MakePopulation(12);
  const auto   whole = Estimate(subjects, plain);
  const auto   added = EstimateInTwoSteps(subjects, 8, plain);
  const auto & a = whole->GetOutput()->GetContent();
  const auto & b = added->GetOutput()->GetContent();
  EXPECT_EQ(a.subjects, b.subjects);
  EXPECT_LT(LargestDistance(a.mean.points, b.mean.points), 1e-10);
  ASSERT_EQ(a.shapeScores.cols(), b.shapeScores.cols());
  EXPECT_LT((a.shape.modes - b.shape.modes).cwiseAbs().maxCoeff(), 1e-7);
  EXPECT_LT((a.density.modes - b.density.modes).cwiseAbs().maxCoeff(), 1e-7);
  EXPECT_LT((a.shapeScores - b.shapeScores).cwiseAbs().maxCoeff(), 1e-7);
  EXPECT_LT((a.densityScores - b.densityScores).cwiseAbs().maxCoeff(), 1e-7);
  EXPECT_NEAR(a.density.totalVariance, b.density.totalVariance, 1e-9 * a.density.totalVariance);
  EXPECT_LT((a.combined.variances - b.combined.variances).norm(), 1e-7 * a.combined.variances.norm());
  ASSERT_EQ(added->GetSubjectDeviations().size(), 4u);
  EXPECT_EQ(added->GetSubjectDeviations()[0].name, "subject 8");
}

TEST(StatisticalModelEstimator, SubjectsAddedInAnyPoseGiveNearlyTheModelOfAll)
{
  auto subjects = MakePopulation(24);
  for (unsigned i = 20; i < subjects.size(); ++i)
  {
    Move(RandomPose(i), subjects[i].points);
  }
  const auto   whole = Estimate(subjects);
  const auto   added = EstimateInTwoSteps(subjects, 20);
  const auto & a = whole->GetOutput()->GetContent();
  const auto & b = added->GetOutput()->GetContent();
  EXPECT_LT((a.shape.variances.head(3) - b.shape.variances.head(3)).norm(), 1e-3 * a.shape.variances[0]);
  EXPECT_LT((a.density.variances - b.density.variances).norm(), 1e-2 * a.density.variances[0]);
}

TEST(StatisticalModelEstimator, NamesOutliersAmongThoseAdded)
{
  auto subjects = MakePopulation(14);
  for (double & c : subjects[12].coefficients)
  {
    c += 2000;
  }
  for (Vector3 & x : subjects[13].points)
  {
    x[0] += 0.1 * x[2] * x[2];
  }
  const auto added = EstimateInTwoSteps(subjects, 11, [](Estimator * e) { e->RejectOutliersOn(); });
  ASSERT_EQ(added->GetSubjectDeviations().size(), 3u);
  EXPECT_FALSE(added->GetSubjectDeviations()[0].outlier);
  EXPECT_TRUE(added->GetSubjectDeviations()[1].outlier);
  EXPECT_TRUE(added->GetSubjectDeviations()[2].outlier);
  EXPECT_GT(added->GetSubjectDeviations()[2].shape, 3 * added->GetSubjectDeviations()[0].shape);
  const auto & names = added->GetOutput()->GetContent().subjects;
  EXPECT_EQ(std::count(names.begin(), names.end(), "subject 11"), 1);
  EXPECT_EQ(std::count(names.begin(), names.end(), "subject 12"), 0);
  EXPECT_EQ(std::count(names.begin(), names.end(), "subject 13"), 0);
}

TEST(StatisticalModelEstimator, RefusesToAddWhatDoesNotBelong)
{
  const auto atlas = Estimate(MakePopulation(5));
  const auto add = [&](const std::vector<MeshArrays> & subjects, AlignmentKind kind = AlignmentKind::Rigid) {
    Estimate(subjects, [&](Estimator * e) {
      e->SetAtlas(atlas->GetOutput());
      e->SetAlignment(kind);
    });
  };
  EXPECT_THROW(add({ MakeSubject(9) }), itk::ExceptionObject); // "subject 0" is in it
  EXPECT_THROW(EstimateInTwoSteps({ MakeSubject(1), MakeSubject(2), MakeSubject(3, 1) }, 2), itk::ExceptionObject);
  EXPECT_THROW(add({}), itk::ExceptionObject);
  auto other = MeshTrainingSet<>::New();
  auto mesh = DensityMesh<double>::New();
  mesh->SetArrays(MakeSubject(9));
  other->AddSubject("other", mesh);
  auto estimator = Estimator::New();
  estimator->SetInput(other);
  estimator->SetAtlas(atlas->GetOutput());
  EXPECT_NO_THROW(estimator->Update());
  estimator->SetAlignment(AlignmentKind::Similarity);
  EXPECT_THROW(estimator->Update(), itk::ExceptionObject);
}

TEST(StatisticalModelEstimator, KeepsTheShareOfVarianceAskedFor)
{
  const auto   subjects = MakePopulation(10);
  const auto   estimator = Estimate(subjects, [](Estimator * e) { e->SetVarianceProportion(0.9); });
  const auto & shape = estimator->GetOutput()->GetContent().shape;
  const auto   k = shape.GetNumberOfModes();
  EXPECT_GE(shape.variances.sum(), 0.9 * shape.totalVariance);
  EXPECT_LT(shape.variances.head(k - 1).sum(), 0.9 * shape.totalVariance);
  const auto two = Estimate(subjects, [](Estimator * e) { e->SetMaximumModes(2); });
  EXPECT_EQ(two->GetOutput()->GetContent().shape.GetNumberOfModes(), 2);
}

TEST(StatisticalModelEstimator, CombinedModelReproducesTheSubjects)
{
  const auto   estimator = Estimate(MakePopulation(7), [](Estimator * e) { e->CombinedOn(); });
  const auto * model = estimator->GetOutput();
  const auto & content = model->GetContent();
  ASSERT_TRUE(model->IsCombined());
  EXPECT_EQ(content.combined.variances.size(), 6);
  for (Eigen::Index i = 0; i < content.shapeScores.rows(); ++i)
  {
    const Eigen::VectorXd joined =
      model->JoinCombined(content.shapeScores.row(i).transpose(), content.densityScores.row(i).transpose());
    Eigen::VectorXd shape, density;
    model->SplitCombined(joined, shape, density);
    EXPECT_LT((shape - content.shapeScores.row(i).transpose()).norm(), 1e-6);
    EXPECT_LT((density - content.densityScores.row(i).transpose()).norm(), 1e-6);
  }
}

TEST(StatisticalModelEstimator, NamesOutliersAndLeavesThemOut)
{
  auto subjects = MakePopulation(12);
  for (Vector3 & x : subjects[4].points)
  {
    x[0] += 0.1 * x[2] * x[2];
  }
  for (double & c : subjects[7].coefficients)
  {
    c += 900;
  }
  const auto estimator = Estimate(subjects, [](Estimator * e) { e->RejectOutliersOn(); });
  for (std::size_t i = 0; i < subjects.size(); ++i)
  {
    EXPECT_EQ(estimator->GetSubjectDeviations()[i].outlier, i == 4 || i == 7) << i;
  }
  EXPECT_EQ(estimator->GetOutput()->GetContent().subjects.size(), 10u);
}

TEST(StatisticalModelEstimator, ShapesAloneMakeAModel)
{
  const auto estimator = Estimate(MakePopulation(5, -1));
  EXPECT_FALSE(estimator->GetOutput()->HasDensity());
  EXPECT_EQ(estimator->GetOutput()->GetContent().shape.GetNumberOfModes(), 4);
}

TEST(StatisticalModelEstimator, RefusesSetsThatAreNone)
{
  EXPECT_THROW(Estimate(MakePopulation(1)), itk::ExceptionObject);
  auto subjects = MakePopulation(3);
  std::swap(subjects[1].tetrahedra[0], subjects[1].tetrahedra[1]);
  EXPECT_THROW(Estimate(subjects), itk::ExceptionObject);
  EXPECT_THROW(Estimate({ MakeSubject(1, 1), MakeSubject(2, 2) }), itk::ExceptionObject);
  EXPECT_THROW(Estimate({ MakeSubject(1, -1), MakeSubject(2, -1) }, [](Estimator * e) { e->CombinedOn(); }),
               itk::ExceptionObject);
  EXPECT_THROW(Estimate(MakePopulation(3), [](Estimator * e) { e->SetVarianceProportion(0); }), itk::ExceptionObject);
  EXPECT_THROW(Estimate(MakePopulation(3), [](Estimator * e) { e->SetWithinCellWeight(0); }), itk::ExceptionObject);
  EXPECT_THROW(Estimate(MakePopulation(3), [](Estimator * e) { e->SetWithinCellWeight(1.1); }), itk::ExceptionObject);
  EXPECT_THROW(Estimate(MakePopulation(3), [](Estimator * e) { e->SetAlignment(AlignmentKind::Affine); }),
               itk::ExceptionObject);
}

TEST(StatisticalModelEstimator, RunsOnlyWhenSomethingChanged)
{
  const auto estimator = Estimate(MakePopulation(3));
  const auto before = estimator->GetOutput()->GetMTime();
  estimator->Update();
  EXPECT_EQ(estimator->GetOutput()->GetMTime(), before);
  estimator->SetMaximumModes(1);
  estimator->Update();
  EXPECT_GT(estimator->GetOutput()->GetMTime(), before);
}

template <typename TMesh>
class StatisticalModelEstimatorMeshes : public testing::Test
{
};
using MeshTypes = testing::Types<DensityMesh<double>, DensityMesh<float>>;
TYPED_TEST_SUITE(StatisticalModelEstimatorMeshes, MeshTypes);

TYPED_TEST(StatisticalModelEstimatorMeshes, SubjectsAreInputsOfThePipeline)
{
  const auto                               subjects = MakePopulation(5);
  auto                                     estimator = StatisticalModelEstimator<TypeParam>::New();
  std::vector<typename TypeParam::Pointer> meshes;
  for (const MeshArrays & subject : subjects)
  {
    meshes.push_back(TypeParam::New());
    meshes.back()->SetArrays(subject);
    estimator->AddSubject("subject " + std::to_string(meshes.size()), meshes.back());
  }
  estimator->SetVarianceProportion(1.0);
  estimator->Update();
  const auto first = Estimate(subjects)->GetOutput()->GetContent();
  const auto before = estimator->GetOutput()->GetContent();
  EXPECT_EQ(before.subjects.size(), subjects.size());
  EXPECT_LT(LargestDistance(before.mean.points, first.mean.points), 1e-4);
  EXPECT_NEAR(before.shape.totalVariance, first.shape.totalVariance, 1e-4 * first.shape.totalVariance);

  // Without a change nothing runs; with a changed mesh the model is made anew.
  const auto time = estimator->GetOutput()->GetMTime();
  estimator->Update();
  EXPECT_EQ(estimator->GetOutput()->GetMTime(), time);
  MeshArrays wider = subjects[0];
  for (Vector3 & x : wider.points)
  {
    x.x() *= 1.2;
  }
  meshes[0]->SetArrays(wider);
  estimator->Update();
  EXPECT_GT(estimator->GetOutput()->GetMTime(), time);
  EXPECT_GT(LargestDistance(estimator->GetOutput()->GetContent().mean.points, before.mean.points), 1e-3);

  estimator->SetInput(MakeSet(subjects));
  EXPECT_THROW(estimator->Update(), itk::ExceptionObject);
  estimator->RemoveSubjects();
  estimator->Update();
  EXPECT_LT(LargestDistance(estimator->GetOutput()->GetContent().mean.points, first.mean.points), 1e-12);
}

TEST(StatisticalModelEstimator, AChangedMeshOfATrainingSetMakesTheModelAnew)
{
  const auto subjects = MakePopulation(4);
  auto       set = MeshTrainingSet<>::New();
  auto       mesh = DensityMesh<double>::New();
  mesh->SetArrays(subjects[0]);
  set->AddSubject("first", mesh);
  for (std::size_t i = 1; i < subjects.size(); ++i)
  {
    auto other = DensityMesh<double>::New();
    other->SetArrays(subjects[i]);
    set->AddSubject("other", other);
  }
  auto estimator = Estimator::New();
  estimator->SetInput(set);
  estimator->Update();
  const auto time = estimator->GetOutput()->GetMTime();
  estimator->Update();
  EXPECT_EQ(estimator->GetOutput()->GetMTime(), time);
  mesh->SetArrays(subjects[1]);
  estimator->Update();
  EXPECT_GT(estimator->GetOutput()->GetMTime(), time);
}
} // namespace StatisticalModelEstimatorTests
