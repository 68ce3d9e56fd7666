/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneDensityFitFilter.h"

#include "boneBernstein.h"
#include "boneDensityTestMeshes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace
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
  ExpectLinear(*shortFilter, mesh, 1, 1.0);
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
    const MeshArrays & fitted = filter->GetOutput()->GetCells();
    double             worst = 0;
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
}

TEST(DensityFitFilter, StopsWhenAskedTo)
{
  const auto image = test::ObliqueImage<test::DoubleImage>(test::Linear);
  auto       filter = MakeFit(Block(), image.GetPointer(), 8);
  filter->AddObserver(itk::ProgressEvent(), [&filter](const itk::EventObject &) { filter->AbortGenerateDataOn(); });
  EXPECT_THROW(filter->Update(), itk::ProcessAborted);
}

TEST(DensityFitFilter, PrintsItsParameters)
{
  std::ostringstream text;
  DoubleFit::New()->Print(text);
  EXPECT_NE(text.str().find("Degree: 3"), std::string::npos);
  EXPECT_NE(text.str().find("Quantity: HU"), std::string::npos);
}
} // namespace
