/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneBuildPipeline.h"

#include <algorithm>
#include <cmath>

namespace bone
{
std::vector<std::string>
DescribeLosses(const TilingReport & report)
{
  std::vector<std::string> lines;
  const auto               count = [&lines](int number, const std::string & what) {
    if (number > 0)
    {
      lines.push_back("The tiling left out " + std::to_string(number) + ' ' + what + '.');
    }
  };
  count(report.loopsLeftOut, "inner contours, so that a layer is thicker there");
  count(report.holesLeftOut, "holes, which are filled");
  return lines;
}

BuildPipeline::BuildPipeline(std::size_t numberOfLevels)
{
  m_Slices->SetInput(m_Snake->GetOutput());
  m_Resample->SetInput(m_Slices->GetOutput());
  m_MedialAxis->SetInput(m_Resample->GetOutput());
  m_Tiling->SetInput(m_MedialAxis->GetOutput());
  m_Quality->SetInput(m_Tiling->GetOutput());
  m_Quality->SetContours(m_Snake->GetOutput());
  m_Fit->SetMesh(m_Quality->GetOutput());
  m_Collapse->SetInput(m_Fit->GetOutput());
  m_PlacedContours->SetInput(m_MedialAxis->GetOutput());
  m_PlacedHierarchy->SetInput(m_Collapse->GetOutput());
  for (std::size_t level = 0; level < numberOfLevels; ++level)
  {
    m_Levels.push_back(HierarchyLevelFilter::New());
    m_Levels.back()->SetInput(m_PlacedHierarchy->GetOutput());
    m_Levels.back()->SetLevel(level);
    m_Radiographs.push_back(RadiographType::New());
    m_Radiographs.back()->SetInput(m_Levels.back()->GetOutput());
    m_OwnLevels.push_back(HierarchyLevelFilter::New());
    m_OwnLevels.back()->SetInput(m_Collapse->GetOutput());
    m_OwnLevels.back()->SetLevel(level);
    m_SplineFits.push_back(FitType::New());
    m_SplineFits.back()->SetMesh(m_OwnLevels.back()->GetOutput());
  }
}

void
BuildPipeline::SetImage(const CTImage * image)
{
  m_Snake->SetInput(image);
  m_Tiling->SetDensityImage(image);
  m_Fit->SetImage(image);
  for (const auto & fit : m_SplineFits)
  {
    fit->SetImage(image);
  }
}

void
BuildPipeline::SetLabelImage(const LabelImage * labels)
{
  m_Snake->SetLabelImage(labels);
  m_Quality->SetLabelImage(labels);
}

void
BuildPipeline::SetInitialContours(const ContourStack * contours)
{
  m_Snake->SetInitialContours(contours);
}

void
BuildPipeline::SetGeometry(const XRayGeometry * geometry)
{
  for (const auto & radiograph : m_Radiographs)
  {
    radiograph->SetGeometry(geometry);
  }
}

void
BuildPipeline::SetPlacement(const Placement & placement)
{
  m_Snake->SetPlacement(placement);
  m_PlacedContours->SetPlacement(placement);
  m_PlacedHierarchy->SetPlacement(placement);
}

void
BuildPipeline::SetParameters(const BuildParameters & parameters)
{
  m_Snake->SetParameters(parameters.contours);
  m_Slices->SetParameters(parameters.slices);
  m_Resample->SetParameters(parameters.resample);
  m_MedialAxis->SetParameters(parameters.medialAxis);
  m_Tiling->SetParameters(parameters.tiling);
  m_Quality->SetParameters(parameters.quality);
  DensityFitParameters fit = parameters.fit;
  for (const auto & spline : m_SplineFits)
  {
    spline->SetParameters(fit);
  }
  fit.continuousGradient = false;
  m_Fit->SetParameters(fit);
  m_Collapse->SetParameters(parameters.collapse);
  for (const auto & radiograph : m_Radiographs)
  {
    radiograph->SetParameters(parameters.radiograph);
  }
}

void
BuildPipeline::GetParameters(BuildParameters & parameters) const
{
  parameters.contours = m_Snake->GetParameters();
  parameters.slices = m_Slices->GetParameters();
  parameters.resample = m_Resample->GetParameters();
  parameters.medialAxis = m_MedialAxis->GetParameters();
  parameters.tiling = m_Tiling->GetParameters();
  parameters.quality = m_Quality->GetParameters();
  parameters.fit = m_Fit->GetParameters();
  parameters.fit.continuousGradient = m_SplineFits.front()->GetContinuousGradient();
  parameters.collapse = m_Collapse->GetParameters();
  parameters.radiograph = m_Radiographs.front()->GetParameters();
}

void
BuildPipeline::SetContourSpacing(double spacing)
{
  m_Resample->SetMaximumSpacing(spacing);
  m_Resample->SetMinimumSpacing(spacing / 3.0);
  m_Resample->SetTolerance(std::clamp(0.33 * std::pow(spacing / 8.0, 2.0), 0.05, 0.6));
}

std::vector<BuildPipeline::Stage>
BuildPipeline::GetStages() const
{
  std::vector<Stage> stages = { { "contours", m_Snake },    { "slices", m_Slices },
                                { "resample", m_Resample }, { "medial axis", m_MedialAxis },
                                { "tiling", m_Tiling },     { "quality", m_Quality },
                                { "fit", m_Fit },           { "collapse", m_Collapse } };
  for (std::size_t level = 0; level < m_Radiographs.size(); ++level)
  {
    stages.emplace_back("radiograph L" + std::to_string(level + 1), m_Radiographs[level]);
  }
  return stages;
}

BuildPipeline::MeshType::Pointer
BuildPipeline::GetSpline(std::size_t level)
{
  FitType * fit = m_SplineFits.at(level);
  if (!fit->GetContinuousGradient())
  {
    return nullptr;
  }
  return this->PlacedMeshOf(fit);
}

BuildPipeline::MeshType::Pointer
BuildPipeline::GetFinest()
{
  return this->PlacedMeshOf(m_Fit);
}

BuildPipeline::MeshType::Pointer
BuildPipeline::PlacedMeshOf(FitType * fit) const
{
  fit->Update();
  auto placed = MeshType::New();
  placed->SetArrays(Place(fit->GetOutput()->GetArrays(), m_PlacedHierarchy->GetPlacement()));
  return placed;
}

void
BuildPipeline::Update()
{
  m_PlacedContours->Update();
  for (const auto & radiograph : m_Radiographs)
  {
    radiograph->Update();
  }
}

std::vector<std::string>
BuildPipeline::GetWarnings() const
{
  std::vector<std::string> warnings = m_Snake->GetWarnings();
  for (const auto & more : { m_Resample->GetWarnings(), DescribeLosses(m_Tiling->GetReport()) })
  {
    warnings.insert(warnings.end(), more.begin(), more.end());
  }
  return warnings;
}
} // namespace bone
