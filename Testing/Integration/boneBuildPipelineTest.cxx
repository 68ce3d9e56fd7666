/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneBuildPipeline.h"

#include "boneBuildEvaluation.h"
#include "boneBuildPlan.h"
#include "boneFemurPhantom.h"
#include "boneMeshImageMetrics.h"
#include "bonePhantomImageSource.h"
#include "boneStageClock.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace BuildPipelineTests
{
using Source = bone::PhantomImageSource<bone::CTImage>;

Source::Pointer
MakePhantom(double spacing, double noise)
{
  auto                source = Source::New();
  Source::SpacingType spacings;
  spacings.Fill(spacing);
  source->SetModel(std::make_shared<const bone::FemurPhantom>());
  source->SetSpacing(spacings);
  source->SetNoise(noise);
  source->Update();
  return source;
}

/** A pipeline on a coarse phantom. */
class BuildPipelineTest : public testing::Test
{
protected:
  void
  SetUp() override
  {
    m_Phantom = MakePhantom(2.0, 10.0);
    m_Pipeline.SetImage(m_Phantom->GetOutput());
    m_Pipeline.SetLabelImage(m_Phantom->GetLabelOutput());
    m_Pipeline.GetSnake()->SetSliceStep(8.0);
    m_Pipeline.SetContourSpacing(8.0);
    m_Pipeline.GetFit()->SetDegree(2);
    m_Pipeline.GetQuality()->Update();
    const auto * mesh = m_Pipeline.GetQuality()->GetOutput();
    m_Pipeline.SetGeometry(bone::FrontView(mesh));
    m_Pipeline.GetCollapse()->SetLevels({ mesh->GetNumberOfTetrahedra() * 2 / 3 });
  }

  /** Names of the stages that ran since the clock was reset. */
  std::vector<std::string>
  Executed() const
  {
    std::vector<std::string> names;
    for (const auto & [name, stage] : m_Pipeline.GetStages())
    {
      names.insert(names.end(), static_cast<std::size_t>(m_Clock.GetRuns(name)), name);
    }
    return names;
  }

  Source::Pointer     m_Phantom;
  bone::BuildPipeline m_Pipeline{ 2 };
  bone::StageClock    m_Clock{ m_Pipeline.GetStages() };
};

TEST_F(BuildPipelineTest, UnchangedPipelineRunsNoStage)
{
  m_Pipeline.Update();
  EXPECT_THAT(Executed(),
              testing::ElementsAre("contours",
                                   "slices",
                                   "resample",
                                   "medial axis",
                                   "tiling",
                                   "quality",
                                   "fit",
                                   "collapse",
                                   "radiograph L1",
                                   "radiograph L2"));
  m_Clock.Reset();
  m_Pipeline.Update();
  EXPECT_THAT(Executed(), testing::IsEmpty());
}

TEST_F(BuildPipelineTest, ChangedDegreeRunsFitAndWhatFollows)
{
  m_Pipeline.Update();
  m_Clock.Reset();
  m_Pipeline.GetFit()->SetDegree(2); // no change
  m_Pipeline.Update();
  EXPECT_THAT(Executed(), testing::IsEmpty());
  m_Pipeline.GetFit()->SetDegree(1);
  m_Pipeline.Update();
  EXPECT_THAT(Executed(), testing::ElementsAre("fit", "collapse", "radiograph L1", "radiograph L2"));
  EXPECT_EQ(m_Pipeline.GetCollapse()->GetOutput()->GetMesh(1)->GetCells().maximumDegree, 1);
}

TEST_F(BuildPipelineTest, ChangedContourSpacingRunsResamplingAndWhatFollows)
{
  m_Pipeline.Update();
  m_Clock.Reset();
  m_Pipeline.SetContourSpacing(9.0);
  m_Pipeline.Update();
  EXPECT_THAT(Executed(),
              testing::ElementsAre(
                "resample", "medial axis", "tiling", "quality", "fit", "collapse", "radiograph L1", "radiograph L2"));
}

TEST_F(BuildPipelineTest, SplinesLeaveTheHierarchyAsItIs)
{
  m_Pipeline.Update();
  EXPECT_EQ(m_Pipeline.GetSpline(0), nullptr);
  bone::BuildParameters parameters;
  m_Pipeline.GetParameters(parameters);
  parameters.fit.degree = 3;
  m_Pipeline.SetParameters(parameters);
  m_Pipeline.Update();
  m_Clock.Reset();
  parameters.fit.continuousGradient = true;
  m_Pipeline.SetParameters(parameters);
  m_Pipeline.Update();
  EXPECT_THAT(Executed(), testing::IsEmpty());
  for (std::size_t level = 0; level < m_Pipeline.GetNumberOfLevels(); ++level)
  {
    const auto * mesh = m_Pipeline.GetHierarchy()->GetMesh(level);
    const auto   spline = m_Pipeline.GetSpline(level);
    EXPECT_EQ(spline->GetNumberOfTetrahedra(), 12 * mesh->GetNumberOfTetrahedra());
    EXPECT_LT(m_Pipeline.GetSplineFit(level)->GetNumberOfFreeCoefficients(), 10 * mesh->GetNumberOfTetrahedra());
  }
  bone::BuildParameters kept;
  m_Pipeline.GetParameters(kept);
  EXPECT_TRUE(kept.fit == parameters.fit);
}

TEST_F(BuildPipelineTest, ChangedGeometryRunsRadiographsOnly)
{
  m_Pipeline.Update();
  m_Clock.Reset();
  auto geometry = bone::XRayGeometry::New();
  auto view = m_Pipeline.GetRadiograph(0)->GetGeometry()->GetView();
  view.size = { { 50, 60 } };
  geometry->SetView(view);
  m_Pipeline.SetGeometry(geometry);
  m_Pipeline.Update();
  EXPECT_THAT(Executed(), testing::ElementsAre("radiograph L1", "radiograph L2"));
}

TEST(BuildPipeline, RecoversThePhantomsNoiseFreeDensity)
{
  const auto          noisy = MakePhantom(1.0, 20.0);
  const auto          clean = MakePhantom(1.0, 0.0);
  bone::BuildPipeline pipeline(1);
  pipeline.SetImage(noisy->GetOutput());
  pipeline.SetLabelImage(noisy->GetLabelOutput());
  pipeline.GetSnake()->SetSliceStep(2.5);
  pipeline.SetContourSpacing(4.0);
  pipeline.GetFit()->SetDegree(3);
  pipeline.GetFit()->Update();

  const bone::DensityComparison error =
    bone::CompareWithImage(pipeline.GetFit()->GetOutput()->GetArrays(), clean->GetOutput(), clean->GetLabelOutput());
  EXPECT_LE(error.meanAbsolutePercent, 3.0);
  EXPECT_GT(error.voxels, 100000U);
}
} // namespace BuildPipelineTests
