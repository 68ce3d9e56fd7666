/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneDensityFitFilter.h"

#include "boneBernstein.h"
#include "boneDensityEvaluation.h"
#include "boneDensityTestMeshes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace DensityFitFilterTests
{
using namespace bone;
using DoubleFit = DensityFitFilter<test::DoubleImage>;

const Vector3 Lower(0, -15, 20);

MeshArrays
Block()
{
  return test::MakeBlock({ { 4, 4, 4 } }, Lower, 5.0, 0.15);
}

template <typename TFilter>
void
ExpectLinear(const TFilter & filter, const MeshArrays & input, int degree, double tolerance)
{
  const MeshArrays mesh = filter.GetOutput()->GetArrays();
  ASSERT_EQ(mesh.maximumDegree, degree);
  ASSERT_EQ(mesh.degree, std::vector<int>(input.tetrahedra.size(), degree));
  const std::size_t count = BernsteinCount(degree);
  for (std::size_t t = 0; t < input.tetrahedra.size(); ++t)
  {
    std::array<double, 4> vertices;
    for (int i = 0; i < 4; ++i)
    {
      vertices[i] = test::Linear(input.points[input.tetrahedra[t][i]]);
    }
    std::vector<double> expected(count);
    BernsteinElevate(1, vertices.data(), degree, expected.data());
    for (std::size_t c = 0; c < count; ++c)
    {
      ASSERT_NEAR(mesh.coefficients[t * count + c], expected[c], tolerance);
    }
  }
}

template <typename TImage, typename TMesh = DensityMesh<double>>
typename DensityFitFilter<TImage, TMesh>::Pointer
MakeFit(const MeshArrays & mesh, const TImage * image, int degree)
{
  auto filter = DensityFitFilter<TImage, TMesh>::New();
  filter->SetInput(test::ToMesh<TMesh>(mesh));
  filter->SetImage(image);
  filter->SetDegree(degree);
  return filter;
}

TEST(DensityFitFilter, ALinearFieldOnAnObliqueAnisotropicImageIsExactAtEveryDegree)
{
  const auto       image = test::ObliqueImage<test::DoubleImage>(test::Linear);
  const MeshArrays mesh = Block();
  for (int degree = 1; degree <= MaximumBernsteinDegree; ++degree)
  {
    auto filter = MakeFit(mesh, image.GetPointer(), degree);
    filter->Update();
    ExpectLinear(*filter, mesh, degree, 1e-9);
    EXPECT_EQ(filter->GetOutsideFraction(), 0);
  }
}

TEST(DensityFitFilter, ALinearFieldIsExactWithContinuityAndWithoutDamping)
{
  const auto       image = test::ObliqueImage<test::DoubleImage>(test::Linear);
  const MeshArrays mesh = Block();
  auto             filter = MakeFit(mesh, image.GetPointer(), 4);
  filter->SetTikhonov(0);
  filter->ContinuousOn();
  filter->Update();
  ExpectLinear(*filter, mesh, 4, 1e-8);
  EXPECT_LT(filter->GetNumberOfFreeCoefficients(), 0.5 * mesh.tetrahedra.size() * BernsteinCount(4));
}

TEST(DensityFitFilter, AQuadraticFieldIsExactWithAContinuousGradient)
{
  const auto quadratic = [](const Vector3 & x) {
    return test::Linear(x) + x[0] * x[1] - 0.5 * x[2] * x[2] + 2 * x[0] * x[2] + x[1] * x[1];
  };
  const auto       image = test::ObliqueImage<test::DoubleImage>(quadratic);
  const MeshArrays mesh = Block();
  auto             filter = MakeFit(mesh, image.GetPointer(), 3);
  filter->SetTikhonov(0);
  filter->ContinuousGradientOn();
  filter->Update();
  const MeshArrays fitted = filter->GetOutput()->GetArrays();
  ASSERT_EQ(fitted.tetrahedra.size(), 12 * mesh.tetrahedra.size());
  double largest = 0;
  for (std::size_t t = 0; t < fitted.tetrahedra.size(); ++t)
  {
    for (const Barycentric & mu :
         { Barycentric(0.25, 0.25, 0.25, 0.25), Barycentric(0.7, 0.1, 0.2, 0), Barycentric(0, 0, 0, 1) })
    {
      Vector3 x = Vector3::Zero();
      for (int i = 0; i < 4; ++i)
      {
        x += mu[i] * fitted.points[fitted.tetrahedra[t][i]];
      }
      const double value = BernsteinValue(3, &fitted.coefficients[t * BernsteinCount(3)], mu);
      largest = std::max(largest, std::abs(value - quadratic(x)));
    }
  }
  EXPECT_LE(largest, 1e-9) << "of values about 1500";
  EXPECT_LT(filter->GetNumberOfFreeCoefficients(), 0.5 * mesh.tetrahedra.size() * BernsteinCount(3));
}

TEST(DensityFitFilter, ALinearFieldIsExactOnAMeshOfFloatsAndAnImageOfShorts)
{
  using FloatMesh = DensityMesh<float>;
  const MeshArrays mesh = Block();
  const auto       image = test::ObliqueImage<test::DoubleImage>(test::Linear);
  auto             filter = MakeFit<test::DoubleImage, FloatMesh>(mesh, image, 2);
  filter->Update();
  ExpectLinear(*filter, mesh, 2, 1e-3);

  using ShortImage = itk::Image<short, 3>;
  const auto rounded = test::ObliqueImage<ShortImage>([](const Vector3 & x) { return std::round(test::Linear(x)); });
  auto       shortFilter = MakeFit(mesh, rounded.GetPointer(), 1);
  shortFilter->Update();
  ExpectLinear(*shortFilter, mesh, 1, 1.5); // values rounded by up to 0.5, control values further out than the voxels
}

template <typename TPixel, typename TMesh = DensityMesh<double>>
std::vector<double>
CoefficientsOfWholeNumbers(DensityInterpolator interpolator)
{
  const auto image =
    test::ObliqueImage<itk::Image<TPixel, 3>>([](const Vector3 & x) { return std::round(test::Smooth(x)); });
  auto filter = MakeFit<itk::Image<TPixel, 3>, TMesh>(Block(), image, 3);
  filter->SetInterpolator(interpolator);
  filter->Update();
  return filter->GetOutput()->GetCells().coefficients;
}

TEST(DensityFitFilter, HasTheSameOutputForAnyPixelTypeThatHoldsTheValues)
{
  for (const auto interpolator : { DensityInterpolator::Linear, DensityInterpolator::CubicBSpline })
  {
    const auto expected = CoefficientsOfWholeNumbers<double>(interpolator);
    EXPECT_EQ(CoefficientsOfWholeNumbers<float>(interpolator), expected);
    EXPECT_EQ(CoefficientsOfWholeNumbers<int>(interpolator), expected);
    EXPECT_EQ(CoefficientsOfWholeNumbers<short>(interpolator), expected);
    EXPECT_EQ(CoefficientsOfWholeNumbers<unsigned short>(interpolator), expected);
    const auto onFloats = CoefficientsOfWholeNumbers<short, DensityMesh<float>>(interpolator);
    ASSERT_EQ(onFloats.size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i)
    {
      ASSERT_NEAR(onFloats[i], expected[i], 0.5);
    }
  }
}

TEST(DensityFitFilter, AQuadraticFieldIsExactFromDegreeTwoOn)
{
  const auto quadratic = [](const Vector3 & x) {
    return 5 * x[0] * x[0] - 3 * x[0] * x[1] + 2 * x[2] * x[2] + test::Linear(x);
  };
  const auto       image = test::ObliqueImage<test::DoubleImage>(quadratic);
  const MeshArrays mesh = Block();
  for (int degree = 2; degree <= MaximumBernsteinDegree; ++degree)
  {
    auto filter = MakeFit(mesh, image.GetPointer(), degree);
    filter->SetTikhonov(0);
    filter->Update();
    const std::vector<double> & fitted = filter->GetOutput()->GetCells().coefficients;
    const Barycentric           mu(0.4, 0.1, 0.2, 0.3);
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
    {
      Vector3 x = Vector3::Zero();
      for (int i = 0; i < 4; ++i)
      {
        x += mu[i] * mesh.points[mesh.tetrahedra[t][i]];
      }
      ASSERT_NEAR(BernsteinValue(degree, &fitted[t * BernsteinCount(degree)], mu), quadratic(x), 1e-7);
    }
  }
}

TEST(DensityFitFilter, InterpolationKeepsTheMassOfABoneThatFadesAtItsSurface)
{
  // A ball of 3 mm (one standard deviation); the block's surface lies where its density falls off and is curved most.
  const double  deviation = 3;
  const Vector3 middle = Lower + Vector3(10, 10, 10);
  const auto    image = test::ObliqueImage<test::DoubleImage>(
    [&](const Vector3 & x) { return 1000 * std::exp(-(x - middle).squaredNorm() / (2 * deviation * deviation)); });
  const MeshArrays mesh = test::MakeBlock({ { 2, 2, 2 } }, Lower + Vector3(5, 5, 5), 5.0, 0.15);
  const double     along = deviation * std::sqrt(2 * std::acos(-1.0)) * std::erf(5 / (deviation * std::sqrt(2.0)));
  for (int degree = 0; degree <= MaximumBernsteinDegree; ++degree)
  {
    auto filter = MakeFit(mesh, image.GetPointer(), degree);
    filter->SetVoxelWeight(0);
    filter->Update();
    double mass = 0;
    for (const RegionDensity & region : MeasureRegions(filter->GetOutput()->GetArrays()))
    {
      mass += region.mass;
    }
    EXPECT_NEAR(mass / (1000 * along * along * along), 1, 0.005);
  }
}

TEST(DensityFitFilter, ErrorFallsWithTheDegreeDownToThatOfLinearInterpolation)
{
  const auto       image = test::ObliqueImage<test::DoubleImage>(test::Smooth);
  const MeshArrays mesh = Block();
  double           before = 1e9;
  for (int degree = 0; degree <= 3; ++degree)
  {
    auto filter = MakeFit(mesh, image.GetPointer(), degree);
    filter->Update();
    const MeshCells & fitted = filter->GetOutput()->GetCells();
    double            worst = 0;
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
    {
      for (const Barycentric & mu : { Barycentric(0.25, 0.25, 0.25, 0.25), Barycentric(0.1, 0.3, 0.5, 0.1) })
      {
        Vector3 x = Vector3::Zero();
        for (int i = 0; i < 4; ++i)
        {
          x += mu[i] * mesh.points[mesh.tetrahedra[t][i]];
        }
        const double value = BernsteinValue(degree, &fitted.coefficients[t * BernsteinCount(degree)], mu);
        worst = std::max(worst, std::abs(value - test::Smooth(x)));
      }
    }
    EXPECT_LT(worst, before);
    before = worst;
  }
  EXPECT_LT(before, 5); // of a range of 600
}

TEST(DensityFitFilter, DoesNotChangeUnderARigidMotionOfMeshAndImage)
{
  const Eigen::Matrix3d rotation = Eigen::AngleAxisd(1.1, Vector3(0.3, 1, -2).normalized()).toRotationMatrix();
  const Vector3         shift(40, -80, 5);
  auto                  image = test::ObliqueImage<test::DoubleImage>(test::Smooth);
  MeshArrays            mesh = Block();
  auto                  still = MakeFit(mesh, image.GetPointer(), 3);
  still->Update();
  const std::vector<double> before = still->GetOutput()->GetCells().coefficients;

  for (Vector3 & p : mesh.points)
  {
    p = rotation * p + shift;
  }
  test::DoubleImage::DirectionType direction;
  test::DoubleImage::PointType     origin;
  for (unsigned int row = 0; row < 3; ++row)
  {
    origin[row] = shift[row];
    for (unsigned int k = 0; k < 3; ++k)
    {
      origin[row] += rotation(row, k) * image->GetOrigin()[k];
      direction[row][k] = 0;
      for (unsigned int m = 0; m < 3; ++m)
      {
        direction[row][k] += rotation(row, m) * image->GetDirection()[m][k];
      }
    }
  }
  image->SetDirection(direction);
  image->SetOrigin(origin);
  auto moved = MakeFit(mesh, image.GetPointer(), 3);
  moved->Update();
  const std::vector<double> & after = moved->GetOutput()->GetCells().coefficients;
  for (std::size_t c = 0; c < before.size(); ++c)
  {
    ASSERT_NEAR(after[c], before[c], 1e-8);
  }
}

TEST(DensityFitFilter, HasTheSameOutputForAnyNumberOfThreads)
{
  const auto       image = test::ObliqueImage<test::DoubleImage>(test::Smooth);
  const MeshArrays mesh = Block();
  for (bool continuous : { false, true })
  {
    std::vector<double> one;
    for (unsigned int threads : { 1u, 2u, 7u })
    {
      auto filter = MakeFit(mesh, image.GetPointer(), 3);
      filter->SetContinuous(continuous);
      filter->SetNumberOfWorkUnits(threads);
      filter->Update();
      const auto & c = filter->GetOutput()->GetCells().coefficients;
      one = one.empty() ? c : one;
      EXPECT_EQ(c, one);
    }
  }
}

TEST(DensityFitFilter, KeepsTheMeshAndReplacesItsDensity)
{
  const auto image = test::ObliqueImage<test::DoubleImage>(test::Linear);
  MeshArrays mesh = Block();
  mesh.layer.assign(mesh.points.size(), 2);
  mesh.slice.assign(mesh.points.size(), 5);
  mesh.maximumDegree = 0;
  mesh.degree.assign(mesh.tetrahedra.size(), 0);
  mesh.coefficients.assign(mesh.tetrahedra.size(), 77.0);
  auto filter = MakeFit(mesh, image.GetPointer(), 1);
  filter->SetQuantity(DensityQuantity::AshGramPerCubicCentimetre);
  filter->Update();
  const MeshArrays fitted = filter->GetOutput()->GetArrays();
  EXPECT_EQ(fitted.points, mesh.points);
  EXPECT_EQ(fitted.tetrahedra, mesh.tetrahedra);
  EXPECT_EQ(fitted.region, mesh.region);
  EXPECT_EQ(fitted.layer, mesh.layer);
  EXPECT_EQ(fitted.slice, mesh.slice);
  EXPECT_EQ(fitted.quantity, DensityQuantity::AshGramPerCubicCentimetre);
  EXPECT_EQ(fitted.coefficients.size(), 4 * mesh.tetrahedra.size());
  EXPECT_EQ(filter->GetInput()->GetCells().coefficients, mesh.coefficients);
}

TEST(DensityFitFilter, RunsOnlyWhenSomethingChanged)
{
  const auto image = test::ObliqueImage<test::DoubleImage>(test::Linear);
  auto       filter = MakeFit(Block(), image.GetPointer(), 2);
  int        runs = 0;
  filter->AddObserver(itk::StartEvent(), [&runs](const itk::EventObject &) { ++runs; });
  filter->Update();
  filter->Update();
  filter->GetOutput()->Update();
  EXPECT_EQ(runs, 1);
  filter->SetDegree(2);
  filter->SetTikhonov(filter->GetTikhonov());
  filter->Update();
  EXPECT_EQ(runs, 1);
  filter->SetDegree(3);
  filter->GetOutput()->Update();
  EXPECT_EQ(runs, 2);
  image->Modified();
  filter->Update();
  EXPECT_EQ(runs, 3);
  filter->ContinuousOn();
  filter->Update();
  EXPECT_EQ(runs, 4);
}

TEST(DensityFitFilter, TakesTheNearestValueBeyondTheImageAndSaysHowMuch)
{
  auto                        image = test::DoubleImage::New();
  test::DoubleImage::SizeType size = { { 4, 4, 4 } };
  image->SetRegions(size);
  image->Allocate();
  image->FillBuffer(0);
  const test::DoubleImage::IndexType corner = { { 3, 3, 3 } };
  image->SetPixel(corner, 1000);
  MeshArrays mesh;
  mesh.points = { { 3, 3, 3 }, { 6, 3, 3 }, { 3, 6, 3 }, { 3, 3, 6 } };
  mesh.tetrahedra = { { 0, 1, 2, 3 } };
  auto filter = MakeFit(mesh, image.GetPointer(), 1);
  filter->Update();
  for (double c : filter->GetOutput()->GetCells().coefficients)
  {
    EXPECT_NEAR(c, 1000, 1e-9);
  }
  EXPECT_GT(filter->GetOutsideFraction(), 0.5);
  EXPECT_LT(filter->GetOutsideFraction(), 1);
}

TEST(DensityFitFilter, DoubtsAMeshThatIsNotOfTheImage)
{
  using Image = test::DoubleImage;
  auto            image = Image::New();
  Image::SizeType size = { { 40, 40, 40 } };
  image->SetRegions(size);
  image->Allocate();
  for (itk::ImageRegionIteratorWithIndex<Image> it(image, image->GetLargestPossibleRegion()); !it.IsAtEnd(); ++it)
  {
    const auto index = it.GetIndex();
    it.Set(std::all_of(index.begin(), index.end(), [](auto i) { return i > 10 && i < 30; }) ? 700.0 : 40.0);
  }
  const auto doubts = [&](const Vector3 & lower, bool neighbors) {
    MeshArrays mesh = test::MakeBlock({ { 4, 4, 4 } }, lower, 5.0, 0.0);
    mesh.neighbors = neighbors ? ComputeFaceNeighbors(mesh.tetrahedra) : std::vector<Id4>();
    auto filter = MakeFit(mesh, image.GetPointer(), 1);
    filter->SetSurfaceMargin(0.0);
    filter->Update();
    return std::pair(filter->GetContrast().GetBrighterShare(), filter->GetDoubts());
  };
  for (const bool neighbors : { false, true })
  {
    const auto [right, nothing] = doubts({ 10, 10, 10 }, neighbors);
    EXPECT_DOUBLE_EQ(right, 1.0);
    EXPECT_TRUE(nothing.empty());
    const auto [beside, mismatch] = doubts({ 16, 16, 10 }, neighbors);
    EXPECT_LT(beside, 0.6);
    ASSERT_EQ(mismatch.size(), 1U);
    EXPECT_NE(mismatch[0].find("do CT and mesh belong together?"), std::string::npos);
  }
  const auto out = doubts({ 10, 10, 25 }, true).second;
  ASSERT_FALSE(out.empty());
  EXPECT_NE(out.back().find("of the mesh lie outside the image"), std::string::npos);
}

void
ExpectRefusal(itk::ProcessObject & filter, const std::string & words)
{
  try
  {
    filter.Update();
    ADD_FAILURE() << "expected an error about: " << words;
  }
  catch (const itk::ExceptionObject & error)
  {
    EXPECT_NE(std::string(error.GetDescription()).find(words), std::string::npos) << error.GetDescription();
  }
}

/** A step between two values along an oblique direction, which a polynomial cannot follow. */
double
Step(const Vector3 & x)
{
  return x[0] + 0.5 * x[1] + 0.3 * (x[2] - 30) > 7 ? 1000 : 100;
}

/** Root mean square of model less image at the voxels in the mesh. */
double
VoxelError(const MeshArrays & mesh, const test::DoubleImage & image, bool heldOut)
{
  const VoxelGrid grid = MakeVoxelGrid(image, image.GetBufferedRegion());
  return CompareDensity(mesh,
                        grid,
                        [&](std::size_t v, double & value) {
                          value = image.GetBufferPointer()[v];
                          const auto i = static_cast<int>(v % grid.size[0]);
                          const auto j = static_cast<int>(v / grid.size[0] % grid.size[1]);
                          const auto k = static_cast<int>(v / grid.size[0] / grid.size[1]);
                          return !heldOut || IsHeldOut(i, j, k);
                        })
    .rootMeanSquare;
}

TEST(DensityFitFilter, VoxelsOwnValuesBringTheModelNearerToThem)
{
  const auto       image = test::ObliqueImage<test::DoubleImage>(Step);
  const MeshArrays mesh = Block();
  double           before = 1e9;
  for (double weight : { 0.0, 1.0, 4.0 })
  {
    auto filter = MakeFit(mesh, image.GetPointer(), 4);
    filter->SetVoxelWeight(weight);
    filter->Update();
    const double error = VoxelError(filter->GetOutput()->GetArrays(), *image, false);
    EXPECT_LT(error, 0.95 * before);
    before = error;
  }
}

TEST(DensityFitFilter, HeldOutVoxelsPlayNoPart)
{
  const auto       image = test::ObliqueImage<test::DoubleImage>(test::Smooth);
  const auto       changed = test::ObliqueImage<test::DoubleImage>(test::Smooth);
  const VoxelGrid  grid = MakeVoxelGrid(*image, image->GetBufferedRegion());
  const MeshArrays mesh = Block();
  for (std::size_t v = 0; v < grid.NumberOfVoxels(); ++v)
  {
    const auto i = static_cast<int>(v % grid.size[0]), j = static_cast<int>(v / grid.size[0] % grid.size[1]);
    if (IsHeldOut(i, j, static_cast<int>(v / grid.size[0] / grid.size[1])))
    {
      changed->GetBufferPointer()[v] = 1e6;
    }
  }
  auto filter = MakeFit(mesh, image.GetPointer(), 3);
  filter->HoldOutOn();
  filter->Update();
  auto other = MakeFit(mesh, changed.GetPointer(), 3);
  other->HoldOutOn();
  other->Update();
  EXPECT_EQ(filter->GetOutput()->GetCells().coefficients, other->GetOutput()->GetCells().coefficients);
  EXPECT_LT(VoxelError(filter->GetOutput()->GetArrays(), *image, true), 30);
}

TEST(DensityFitFilter, ACubicSplineIsNearerToASmoothImageThanLinearInterpolation)
{
  const auto       image = test::ObliqueImage<test::DoubleImage>(test::Smooth);
  const MeshArrays mesh = Block();
  auto             filter = MakeFit(mesh, image.GetPointer(), 5);
  filter->Update();
  const double linear = VoxelError(filter->GetOutput()->GetArrays(), *image, false);
  filter->SetInterpolator(DensityInterpolator::CubicBSpline);
  filter->Update();
  EXPECT_LT(VoxelError(filter->GetOutput()->GetArrays(), *image, false), 0.5 * linear);
}

TEST(DensityFitFilter, WhatHasNoWeightDoesNotCount)
{
  const auto isBroken = [](const Vector3 & x) { return (x - Vector3(10, -5, 30)).norm() < 1.5; };
  const auto image =
    test::ObliqueImage<test::DoubleImage>([&](const Vector3 & x) { return isBroken(x) ? 5000 : test::Linear(x); });
  const auto weights = test::ObliqueImage<test::DoubleImage>(
    [](const Vector3 & x) { return (x - Vector3(10, -5, 30)).norm() < 5 ? 0.0 : 1.0; });
  const MeshArrays mesh = Block();
  auto             filter = MakeFit(mesh, image.GetPointer(), 1);
  filter->SetWeights(weights);
  filter->Update();
  EXPECT_EQ(filter->GetReport().unsupported, 0u);
  ExpectLinear(*filter, mesh, 1, 1e-3);

  const auto nothing = test::ObliqueImage<test::DoubleImage>([](const Vector3 &) { return 0.0; });
  filter->SetWeights(nothing);
  filter->Update();
  EXPECT_EQ(filter->GetReport().unsupported, mesh.tetrahedra.size());
  const auto negative = test::ObliqueImage<test::DoubleImage>([](const Vector3 &) { return -1.0; });
  filter->SetWeights(negative);
  ExpectRefusal(*filter, "'Weights'");
}

TEST(DensityFitFilter, ControlValuesStayWithinTheLimitAndTheMeanIsKept)
{
  const auto       image = test::ObliqueImage<test::DoubleImage>(Step);
  const MeshArrays mesh = Block();
  auto             filter = MakeFit(mesh, image.GetPointer(), 6);
  filter->SetOvershootLimit(std::numeric_limits<double>::infinity());
  filter->Update();
  const std::vector<double> free = filter->GetOutput()->GetCells().coefficients;
  EXPECT_EQ(filter->GetReport().limited, 0u);
  EXPECT_GT(filter->GetReport().overshootMaximum, 1);
  filter->SetOvershootLimit(0.5);
  filter->Update();
  EXPECT_GT(filter->GetReport().limited, 0u);
  const std::vector<double> & limited = filter->GetOutput()->GetCells().coefficients;
  const auto [least, largest] = std::minmax_element(limited.begin(), limited.end());
  EXPECT_GE(*least, 100 - 0.5 * 900 - 1e-6);
  EXPECT_LE(*largest, 1000 + 0.5 * 900 + 1e-6);
  const int count = BernsteinCount(6);
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
  {
    EXPECT_NEAR(BernsteinIntegral(6, &limited[t * count], 1.0), BernsteinIntegral(6, &free[t * count], 1.0), 1e-7);
  }
}

TEST(DensityFitFilter, AdaptiveDegreeIsAsLowAsTheErrorAllows)
{
  // Linear on one side, bent on the other.
  const auto image = test::ObliqueImage<test::DoubleImage>(
    [](const Vector3 & x) { return test::Linear(x) + (x[0] > 10 ? 4 * (x[0] - 10) * (x[0] - 10) : 0.0); });
  const MeshArrays mesh = Block();
  auto             filter = MakeFit(mesh, image.GetPointer(), 4);
  filter->SetMaximumError(2.0);
  filter->Update();
  const MeshArrays fitted = filter->GetOutput()->GetArrays();
  EXPECT_GT(std::count(fitted.degree.begin(), fitted.degree.end(), 1), 100);
  EXPECT_GT(std::count(fitted.degree.begin(), fitted.degree.end(), 2), 10);
  EXPECT_LT(VoxelError(fitted, *image, false), 2.0);
  EXPECT_EQ(fitted.maximumDegree, *std::max_element(fitted.degree.begin(), fitted.degree.end()));
  EXPECT_LT(filter->GetNumberOfFreeCoefficients(), mesh.tetrahedra.size() * BernsteinCount(2));
  filter->SetMaximumError(1e9);
  filter->Update();
  EXPECT_EQ(filter->GetOutput()->GetCells().maximumDegree, 0);
  filter->ContinuousOn();
  ExpectRefusal(*filter, "one degree");
  filter->ContinuousOff();
  filter->ContinuousGradientOn();
  ExpectRefusal(*filter, "one degree");
  filter->SetMaximumError(0);
  ExpectRefusal(*filter, "degree 3, not 4");
}

TEST(DensityFitFilter, AMarginKeepsTheDarkRimOut)
{
  // A block in an image that falls off half a millimetre inside its surface.
  const MeshArrays mesh = Block();
  const Vector3    upper = Lower + Vector3::Constant(20);
  const auto       image = test::ObliqueImage<test::DoubleImage>([&](const Vector3 & x) {
    const double depth = std::min((x - Lower).minCoeff(), (upper - x).minCoeff());
    return depth > 1.0 ? 800.0 : 100.0;
  });
  auto             filter = MakeFit(mesh, image.GetPointer(), 2);
  filter->Update();
  const double mean = MeasureRegions(filter->GetOutput()->GetArrays())[0].mean;
  filter->SetSurfaceMargin(3.0);
  filter->Update();
  const double kept = MeasureRegions(filter->GetOutput()->GetArrays())[0].mean;
  EXPECT_LT(mean, 700);
  EXPECT_NEAR(kept, 800, 1);
}

TEST(DensityFitFilter, AMarginAtInterfacesSeparatesTheRegions)
{
  // Two regions, and an image whose step between them is blurred and lies 0.8 mm off.
  MeshArrays   mesh = Block();
  const double step = Lower[0] + 10.0;
  mesh.neighbors = ComputeFaceNeighbors(mesh.tetrahedra);
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
  {
    double x = 0;
    for (const IdType p : mesh.tetrahedra[t])
    {
      x += 0.25 * mesh.points[p][0];
    }
    mesh.region[t] = x < step ? 1 : 2;
  }
  const auto image = test::ObliqueImage<test::DoubleImage>(
    [&](const Vector3 & x) { return 500.0 + 400.0 * std::tanh((x[0] - step - 0.8) / 0.5); });
  auto filter = MakeFit(mesh, image.GetPointer(), 2);
  filter->Update();
  const auto mixed = MeasureRegions(filter->GetOutput()->GetArrays());
  filter->SetInterfaceMargin(3.5);
  filter->Update();
  const auto separated = MeasureRegions(filter->GetOutput()->GetArrays());
  EXPECT_LT(mixed[1].mean, 860);
  EXPECT_NEAR(separated[0].mean, 100, 5);
  EXPECT_NEAR(separated[1].mean, 900, 5);
  filter->SetInterfaceMargin(-1);
  ExpectRefusal(*filter, "InterfaceMargin is -1");
}

TEST(DensityFitFilter, RefusesWhatItCannotFit)
{
  const auto image = test::ObliqueImage<test::DoubleImage>(test::Linear);
  auto       empty = DoubleFit::New();
  EXPECT_THROW(empty->Update(), itk::ExceptionObject);
  empty->SetInput(test::ToMesh(Block()));
  EXPECT_THROW(empty->Update(), itk::ExceptionObject);
  ExpectRefusal(*MakeFit(MeshArrays(), image.GetPointer(), 2), "no tetrahedra");
  ExpectRefusal(*MakeFit(Block(), image.GetPointer(), 9), "Degree is 9");
  ExpectRefusal(*MakeFit(Block(), image.GetPointer(), -1), "Degree is -1");
  auto continuous = MakeFit(Block(), image.GetPointer(), 0);
  continuous->ContinuousOn();
  ExpectRefusal(*continuous, "Degree 1 or more");
  auto damped = MakeFit(Block(), image.GetPointer(), 2);
  damped->SetTikhonov(std::nan(""));
  ExpectRefusal(*damped, "Tikhonov is nan");
  auto heavy = MakeFit(Block(), image.GetPointer(), 2);
  heavy->SetVoxelWeight(-1);
  ExpectRefusal(*heavy, "VoxelWeight is -1");
  heavy->SetVoxelWeight(1);
  heavy->SetOvershootLimit(std::nan(""));
  ExpectRefusal(*heavy, "OvershootLimit is nan");
  MeshArrays far = Block();
  for (Vector3 & p : far.points)
  {
    p[0] += 1000;
  }
  ExpectRefusal(*MakeFit(far, image.GetPointer(), 2), "outside the input 'Image'");
  MeshArrays broken = Block();
  broken.points[3][2] = std::nan("");
  ExpectRefusal(*MakeFit(broken, image.GetPointer(), 2), "not finite");
  const auto holes =
    test::ObliqueImage<test::DoubleImage>([](const Vector3 & x) { return x[0] > 9 && x[0] < 12 ? std::nan("") : 1.0; });
  ExpectRefusal(*MakeFit(Block(), holes.GetPointer(), 2), "not finite");
}

TEST(DensityFitFilter, RefusesAContinuousFitOfFlatCells)
{
  const auto image = test::ObliqueImage<test::DoubleImage>(test::Linear);
  MeshArrays mesh = Block();
  std::swap(mesh.tetrahedra[5][0], mesh.tetrahedra[5][1]);
  auto filter = MakeFit(mesh, image.GetPointer(), 2);
  filter->Update();
  filter->ContinuousOn();
  ExpectRefusal(*filter, "Tetrahedron 5");
  filter->SetDegree(3);
  filter->ContinuousGradientOn();
  ExpectRefusal(*filter, "Tetrahedron 5");
}

TEST(DensityFitFilter, StopsWhenAskedTo)
{
  const auto image = test::ObliqueImage<test::DoubleImage>(test::Linear);
  auto       filter = MakeFit(Block(), image.GetPointer(), 8);
  const auto id =
    filter->AddObserver(itk::ProgressEvent(), [&filter](const itk::EventObject &) { filter->AbortGenerateDataOn(); });
  EXPECT_THROW(filter->Update(), itk::ProcessAborted);
  filter->RemoveObserver(id);
  filter->Update();
  ExpectLinear(*filter, Block(), 8, 1e-9);
}

TEST(DensityFitFilter, PrintsItsParameters)
{
  std::ostringstream text;
  DoubleFit::New()->Print(text);
  EXPECT_NE(text.str().find("Degree: 3"), std::string::npos);
  EXPECT_NE(text.str().find("Quantity: hu"), std::string::npos);
}
} // namespace DensityFitFilterTests
