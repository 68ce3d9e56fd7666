/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneFilterCases.h"

#include "boneBuildPlan.h"
#include "boneFemurPhantom.h"

namespace bone
{
namespace test
{
Specimen::Specimen()
{
  phantom = Phantom::New();
  Phantom::SpacingType spacing;
  spacing.Fill(3.0);
  phantom->SetModel(std::make_shared<const FemurPhantom>());
  phantom->SetSpacing(spacing);
  phantom->Update();
  ct = phantom->GetOutput();
  labels = phantom->GetLabelOutput();

  pipeline.SetImage(ct);
  pipeline.SetLabelImage(labels);
  pipeline.GetSnake()->SetSliceStep(10.0);
  pipeline.SetContourSpacing(12.0);
  pipeline.GetFit()->SetDegree(2);
  pipeline.GetQuality()->Update();
  geometry = FrontView(pipeline.GetQuality()->GetOutput());
  pipeline.SetGeometry(geometry);
  pipeline.GetCollapse()->SetLevels({ pipeline.GetQuality()->GetOutput()->GetNumberOfTetrahedra() / 2 });
  pipeline.Update();

  auto intensity = IntensityImageFilter<CTImage>::New();
  intensity->SetInput(pipeline.GetRadiograph(0)->GetOutput());
  intensity->Update();
  intensities = intensity->GetOutput();

  MeshArrays arrays = pipeline.GetFit()->GetOutput()->GetArrays();
  for (Vector3 & p : arrays.points)
  {
    p = Vector3(1.02 * p.x(), 0.97 * p.y(), 1.05 * p.z());
  }
  for (double & c : arrays.coefficients)
  {
    c *= 0.9;
  }
  other = Mesh::New();
  other->SetArrays(std::move(arrays));

  auto estimator = StatisticalModelEstimator<>::New();
  estimator->AddSubject("one", pipeline.GetFit()->GetOutput());
  estimator->AddSubject("two", other);
  estimator->Update();
  atlas = estimator->GetOutput();
}

const Specimen &
Specimen::Get()
{
  static const Specimen specimen;
  return specimen;
}
} // namespace test
} // namespace bone
