/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneMeshQualityFilter.h"

#include "../../Core/test/boneTestBodies.h"
#include "boneMeshValidator.h"
#include "boneQualityMeasures.h"
#include "boneTetraSwapFilter.h"

#include <gtest/gtest.h>

using namespace bone;

namespace
{
using MeshType = DensityMesh<double>;

MeshType::Pointer
AsMesh(MeshArrays arrays)
{
  auto mesh = MeshType::New();
  mesh->SetArrays(std::move(arrays));
  return mesh;
}

MeshArrays
Body(unsigned seed)
{
  test::TubeShape shape;
  shape.seed = seed;
  shape.bumps = 0.3;
  return seed % 2 == 0 ? test::MakeBall(4, { 1, 1, 2 }, 12, 0.18, seed) : test::MakeTube(shape);
}

double
SmallestAngle(const MeshArrays & mesh)
{
  return SummarizeQuality(mesh, QualityMeasure::MinimumDihedralAngle).minimum;
}
} // namespace

TEST(MeshQualityFilter, KeepsMeshesValidAndRaisesTheirQuality)
{
  for (unsigned seed = 1; seed <= 6; ++seed)
  {
    const auto mesh = Body(seed);
    auto       filter = MeshQualityFilter<MeshType>::New();
    filter->SetInput(AsMesh(mesh));
    filter->SetRounds(2);
    filter->Update();
    const auto made = filter->GetOutput()->GetArrays();
    const auto validation = ValidateMesh(made);
    EXPECT_TRUE(validation.IsValid()) << "seed " << seed << ": " << validation.Summary();
    EXPECT_EQ(made.points.size(), mesh.points.size());
    EXPECT_GT(SmallestAngle(made), 1.2 * SmallestAngle(mesh)) << "seed " << seed;
    EXPECT_GT(SmallestAngle(made), 10.0 / 57.3);
    for (int region = 0; region <= 3; ++region)
    {
      EXPECT_EQ(BoundaryFaces(made, region).size(), BoundaryFaces(mesh, region).size())
        << "surfaces keep their triangles";
    }
    EXPECT_GT(filter->GetReport().flips, 0u);
    EXPECT_FALSE(made.HasDensity());
  }
}

TEST(MeshQualityFilter, IsDeterministicAndLazy)
{
  auto       a = MeshQualityFilter<MeshType>::New(), b = MeshQualityFilter<MeshType>::New();
  const auto mesh = AsMesh(Body(3));
  for (auto * filter : { a.GetPointer(), b.GetPointer() })
  {
    filter->SetInput(mesh);
    filter->SetRounds(1);
    filter->Update();
  }
  EXPECT_EQ(a->GetOutput()->GetArrays().points, b->GetOutput()->GetArrays().points);
  EXPECT_EQ(a->GetOutput()->GetTetrahedra(), b->GetOutput()->GetTetrahedra());
  const auto time = a->GetOutput()->GetUpdateMTime();
  a->Update();
  EXPECT_EQ(a->GetOutput()->GetUpdateMTime(), time);
}

TEST(MeshQualityFilter, RefusesBadParameters)
{
  const auto mesh = AsMesh(test::MakeBall(2, { 2 }, 10, 0.1, 1));
  const auto refuses = [&](auto set) {
    auto bad = MeshQualityFilter<MeshType>::New();
    bad->SetInput(mesh);
    set(bad.GetPointer());
    EXPECT_THROW(bad->Update(), itk::ExceptionObject);
  };
  refuses([](auto * f) { f->SetRounds(-1); });
  refuses([](auto * f) { f->SetTargetAngle(std::nan("")); });
  refuses([](auto * f) { f->SetTargetAngle(0.0); });
  refuses([](auto * f) { f->SetDistanceBound(-1.0); });
  refuses([](auto * f) { f->SetInput(nullptr); });
}

TEST(TetraSwapFilter, MovesNoPointAndNeverLowersTheWorstAngle)
{
  for (unsigned seed = 1; seed <= 4; ++seed)
  {
    const auto mesh = Body(seed);
    auto       filter = TetraSwapFilter<MeshType>::New();
    filter->SetInput(AsMesh(mesh));
    filter->SetTargetAngle(0.5);
    filter->Update();
    const auto made = filter->GetOutput()->GetArrays();
    EXPECT_EQ(made.points, mesh.points);
    EXPECT_EQ(made.layer, mesh.layer);
    EXPECT_GE(SmallestAngle(made), SmallestAngle(mesh));
    EXPECT_TRUE(ValidateMesh(made).IsValid()) << ValidateMesh(made).Summary();
    EXPECT_GT(filter->GetReport().done, 0u);
    EXPECT_GT(filter->GetReport().refused[static_cast<int>(MeshOperation::Surface)], 0u);
  }
}

TEST(TetraSwapFilter, RefusesBadParameters)
{
  auto filter = TetraSwapFilter<MeshType>::New();
  filter->SetInput(AsMesh(test::MakeBall(2, { 2 }, 10, 0.1, 1)));
  filter->SetTargetAngle(-1);
  EXPECT_THROW(filter->Update(), itk::ExceptionObject);
  filter->SetTargetAngle(0.3);
  filter->SetMaximumPasses(-1);
  EXPECT_THROW(filter->Update(), itk::ExceptionObject);
}
