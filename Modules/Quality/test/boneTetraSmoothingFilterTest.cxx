/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneTetraSmoothingFilter.h"

#include "boneTriangleTree.h"

#include "../../Core/test/boneTestBodies.h"
#include "boneMeshValidator.h"
#include "boneQualityMeasures.h"

#include <itkCommand.h>
#include <itkMultiThreaderBase.h>

#include <gtest/gtest.h>

#include <map>

using namespace bone;

namespace TetraSmoothingFilterTests
{
using MeshType = DensityMesh<double>;
using FilterType = TetraSmoothingFilter<MeshType>;

MeshType::Pointer
AsMesh(MeshArrays arrays)
{
  auto mesh = MeshType::New();
  mesh->SetArrays(std::move(arrays));
  return mesh;
}

MeshArrays
Smooth(const MeshArrays & arrays, SmoothingMethod method, int iterations, double bound = 0.3)
{
  auto filter = FilterType::New();
  filter->SetInput(AsMesh(arrays));
  filter->SetMethod(method);
  filter->SetIterations(iterations);
  filter->SetDistanceBound(bound);
  filter->Update();
  return filter->GetOutput()->GetArrays();
}

double
Volume(const MeshArrays & mesh, int minimumRegion = 0)
{
  double sum = 0;
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
  {
    const Id4 & v = mesh.tetrahedra[t];
    sum += mesh.region[t] >= minimumRegion
             ? SignedVolume(mesh.points[v[0]], mesh.points[v[1]], mesh.points[v[2]], mesh.points[v[3]])
             : 0.0;
  }
  return sum;
}

/** Mean angle between neighbouring boundary triangles. */
double
Roughness(const MeshArrays & mesh)
{
  const auto faces = BoundaryFaces(mesh);
  const auto normal = [&](std::size_t f) {
    const auto & v = faces[f];
    return Vector3((mesh.points[v[1]] - mesh.points[v[0]]).cross(mesh.points[v[2]] - mesh.points[v[0]]).normalized());
  };
  std::map<std::pair<IdType, IdType>, std::size_t> open;
  double                                           sum = 0;
  int                                              count = 0;
  for (std::size_t f = 0; f < faces.size(); ++f)
  {
    for (int k = 0; k < 3; ++k)
    {
      const IdType a = faces[f][k], b = faces[f][(k + 1) % 3];
      const auto   found = open.emplace(std::make_pair(std::min(a, b), std::max(a, b)), f);
      if (!found.second)
      {
        sum += std::acos(std::clamp(normal(f).dot(normal(found.first->second)), -1.0, 1.0));
        ++count;
      }
    }
  }
  return sum / count;
}

test::TubeShape
Shape(unsigned seed)
{
  test::TubeShape shape;
  shape.seed = seed;
  shape.bumps = 0.3;
  shape.closed = seed % 3 == 0;
  shape.slices = shape.closed ? 30 : 14;
  shape.spacing = shape.closed ? 5 : 2;
  return shape;
}

TEST(TetraSmoothingFilter, EnhancedKeepsEveryBodyValidAndItsLayers)
{
  for (unsigned seed = 1; seed <= 8; ++seed)
  {
    const auto mesh = seed % 4 == 0 ? test::MakeBall(4, { 1, 1, 2 }, 12, 0.18, seed) : test::MakeTube(Shape(seed));
    const auto made = Smooth(mesh, SmoothingMethod::Enhanced, 12);
    const auto validation = ValidateMesh(made);
    EXPECT_TRUE(validation.IsValid()) << "seed " << seed << ": " << validation.Summary();
    EXPECT_EQ(made.tetrahedra, mesh.tetrahedra);
    EXPECT_EQ(made.region, mesh.region);
    EXPECT_EQ(made.layer, mesh.layer);
    EXPECT_EQ(made.slice, mesh.slice);
    for (int region = 1; region <= 3; ++region)
    {
      EXPECT_NEAR(Volume(made, region) / Volume(mesh, region), 1.0, 0.04) << "seed " << seed << ", region " << region;
    }
  }
}

TEST(TetraSmoothingFilter, EnhancedShrinksFarLessThanLaplacianAndNeverInverts)
{
  const auto   mesh = test::MakeTube(Shape(2));
  const double volume = Volume(mesh);
  for (int iterations : { 1, 5, 20 })
  {
    const double plain = std::abs(Volume(Smooth(mesh, SmoothingMethod::Laplacian, iterations)) / volume - 1);
    const double smart = std::abs(Volume(Smooth(mesh, SmoothingMethod::Smart, iterations)) / volume - 1);
    const auto   made = Smooth(mesh, SmoothingMethod::Enhanced, iterations);
    const double enhanced = std::abs(Volume(made) / volume - 1);
    EXPECT_LT(enhanced, 0.1 * plain) << iterations;
    EXPECT_LT(enhanced, 0.1 * smart) << iterations;
    EXPECT_EQ(CountInverted(made), 0u);
  }
}

TEST(TetraSmoothingFilter, SmartNeverInvertsWherePlainDoes)
{
  const auto mesh = test::MakeBall(5, { 1, 2, 2 }, 12, 0.15, 1);
  EXPECT_GT(CountInverted(Smooth(mesh, SmoothingMethod::Laplacian, 10)), 0u);
  EXPECT_EQ(CountInverted(Smooth(mesh, SmoothingMethod::Smart, 10)), 0u);
}

TEST(TetraSmoothingFilter, FairsStepsBetweenSlicesAndRaisesQuality)
{
  auto       shape = Shape(1);
  const auto mesh = test::MakeTube(shape);
  const auto made = Smooth(mesh, SmoothingMethod::Enhanced, 10, 0.5);
  shape.bumps = shape.jitter = 0;
  const double even = Roughness(test::MakeTube(shape));
  EXPECT_LT(Roughness(made) - even, 0.4 * (Roughness(mesh) - even));
  EXPECT_GT(SummarizeQuality(made, QualityMeasure::MinimumDihedralAngle).percentile1,
            SummarizeQuality(mesh, QualityMeasure::MinimumDihedralAngle).percentile1);
}

TEST(TetraSmoothingFilter, BoundaryAndInterfacesStayWithinTheBound)
{
  for (double bound : { 0.0, 0.1, 0.5 })
  {
    const auto mesh = test::MakeTube(Shape(4));
    const auto made = Smooth(mesh, SmoothingMethod::Enhanced, 10, bound);
    for (int region = 1; region <= 3; ++region)
    {
      std::vector<TriangleTree::Triangle> triangles;
      for (const auto & f : BoundaryFaces(mesh, region))
      {
        triangles.push_back({ mesh.points[f[0]], mesh.points[f[1]], mesh.points[f[2]] });
      }
      const TriangleTree tree(triangles);
      for (const auto & f : BoundaryFaces(made, region))
      {
        for (IdType p : f)
        {
          EXPECT_LE(std::sqrt(tree.FindNearest(made.points[p]).squaredDistance), bound + 1e-9);
        }
      }
    }
  }
}

TEST(TetraSmoothingFilter, FlatEndsStayFlat)
{
  const auto   shape = Shape(1);
  const auto   mesh = test::MakeTube(shape);
  const auto   made = Smooth(mesh, SmoothingMethod::Enhanced, 10);
  const double top = (shape.slices - 1) * shape.spacing;
  for (std::size_t p = 0; p < mesh.points.size(); ++p)
  {
    if (mesh.slice[p] == 0 || mesh.slice[p] == shape.slices - 1)
    {
      EXPECT_NEAR(made.points[p].z(), mesh.slice[p] == 0 ? 0.0 : top, 1e-9);
    }
  }
  EXPECT_EQ(FindSurfaces(made).dimension, FindSurfaces(mesh).dimension);
}

TEST(TetraSmoothingFilter, IsDeterministicAndIndependentOfThreads)
{
  const auto mesh = test::MakeTube(Shape(5));
  itk::MultiThreaderBase::SetGlobalDefaultNumberOfThreads(1);
  const auto one = Smooth(mesh, SmoothingMethod::Enhanced, 5);
  itk::MultiThreaderBase::SetGlobalDefaultNumberOfThreads(2);
  const auto two = Smooth(mesh, SmoothingMethod::Enhanced, 5);
  EXPECT_EQ(one.points, two.points);
}

TEST(TetraSmoothingFilter, RunsAgainOnlyAfterAChange)
{
  auto filter = FilterType::New();
  filter->SetInput(AsMesh(test::MakeTube(Shape(1))));
  filter->SetIterations(2);
  auto second = FilterType::New();
  second->SetInput(filter->GetOutput());
  second->SetIterations(1);
  int  runs[2] = { 0, 0 };
  auto first = itk::CStyleCommand::New();
  first->SetClientData(&runs[0]);
  first->SetCallback([](itk::Object *, const itk::EventObject &, void * n) { ++*static_cast<int *>(n); });
  filter->AddObserver(itk::StartEvent(), first);
  auto other = itk::CStyleCommand::New();
  other->SetClientData(&runs[1]);
  other->SetCallback([](itk::Object *, const itk::EventObject &, void * n) { ++*static_cast<int *>(n); });
  second->AddObserver(itk::StartEvent(), other);
  const auto expect = [&](int a, int b) {
    EXPECT_EQ(runs[0], a);
    EXPECT_EQ(runs[1], b);
  };
  second->Update();
  expect(1, 1);
  second->Update();
  second->GetOutput()->Update();
  expect(1, 1);
  second->SetIterations(3);
  second->Update();
  expect(1, 2);
  filter->SetDistanceBound(0.2);
  second->Update();
  expect(2, 3);
  filter->SetDistanceBound(0.2);
  second->Update();
  expect(2, 3);
}

TEST(TetraSmoothingFilter, InvertedInputIsAnErrorThatCounts)
{
  auto mesh = test::MakeTube(Shape(1));
  std::swap(mesh.tetrahedra[5][0], mesh.tetrahedra[5][1]);
  std::swap(mesh.tetrahedra[9][0], mesh.tetrahedra[9][1]);
  mesh.neighbors = ComputeFaceNeighbors(mesh.tetrahedra);
  auto filter = FilterType::New();
  filter->SetInput(AsMesh(mesh));
  try
  {
    filter->Update();
    FAIL() << "no exception";
  }
  catch (const itk::ExceptionObject & error)
  {
    EXPECT_NE(std::string(error.GetDescription()).find("2 of the"), std::string::npos) << error.GetDescription();
  }
  filter->SetMethod(SmoothingMethod::Laplacian);
  EXPECT_NO_THROW(filter->Update());
}

TEST(TetraSmoothingFilter, InvertedInputIsUntangledWhereInnerPointsCanDoIt)
{
  auto                 mesh = test::MakeBall(4, { 1, 1, 2 }, 12, 0.1, 1);
  const SurfaceComplex surfaces = FindSurfaces(mesh);
  std::size_t          moved = 0;
  for (std::size_t p = 0; p < mesh.points.size(); ++p)
  {
    // Every third inner point far out of the cells around it.
    if (surfaces.dimension[p] == 3 && p % 3 == 0)
    {
      mesh.points[p] += Vector3(4.0, -3.0, 5.0);
      ++moved;
    }
  }
  ASSERT_GT(moved, 0u);
  ASSERT_GT(CountInverted(mesh), moved);
  const auto made = Smooth(mesh, SmoothingMethod::Enhanced, 2);
  EXPECT_EQ(CountInverted(made), 0u);
  EXPECT_TRUE(ValidateMesh(made).IsValid()) << ValidateMesh(made).Summary();
}

TEST(TetraSmoothingFilter, RefusesBadParametersAndInputs)
{
  auto filter = FilterType::New();
  EXPECT_THROW(filter->Update(), itk::ExceptionObject) << "no input";
  filter->SetInput(MeshType::New());
  EXPECT_THROW(filter->Update(), itk::ExceptionObject) << "an empty mesh";
  filter->SetInput(AsMesh(test::MakeBall(2, { 2 }, 10, 0.1, 1)));
  const auto refuses = [&](auto set) {
    auto bad = FilterType::New();
    bad->SetInput(filter->GetInput());
    set(bad.GetPointer());
    EXPECT_THROW(bad->Update(), itk::ExceptionObject);
  };
  refuses([](FilterType * f) { f->SetIterations(-1); });
  refuses([](FilterType * f) { f->SetFairingIterations(-1); });
  refuses([](FilterType * f) { f->SetDistanceBound(-0.1); });
  refuses([](FilterType * f) { f->SetDistanceBound(std::nan("")); });
  refuses([](FilterType * f) { f->SetWeight(1.0); });
  refuses([](FilterType * f) { f->SetWeight(std::nan("")); });
  refuses([](FilterType * f) { f->SetAngleFloor(2.0); });
  filter->SetIterations(0);
  filter->Update();
  EXPECT_EQ(filter->GetOutput()->GetArrays().points, filter->GetInput()->GetArrays().points);
}

TEST(TetraSmoothingFilter, StopsWhenAsked)
{
  auto filter = FilterType::New();
  filter->SetInput(AsMesh(test::MakeTube(Shape(1))));
  auto command = itk::CStyleCommand::New();
  command->SetCallback([](itk::Object * o, const itk::EventObject &, void *) {
    static_cast<itk::ProcessObject *>(o)->AbortGenerateDataOn();
  });
  filter->AddObserver(itk::ProgressEvent(), command);
  EXPECT_THROW(filter->Update(), itk::ProcessAborted);
}

TEST(TetraSmoothingFilter, FloatMeshWorks)
{
  using FloatMesh = DensityMesh<float>;
  auto mesh = FloatMesh::New();
  mesh->SetArrays(test::MakeTube(Shape(1)));
  auto filter = TetraSmoothingFilter<FloatMesh>::New();
  filter->SetInput(mesh);
  filter->Update();
  EXPECT_EQ(CountInverted(filter->GetOutput()->GetArrays()), 0u);
}
} // namespace TetraSmoothingFilterTests
