/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneDeformableRadiographRegistration_hxx
#define boneDeformableRadiographRegistration_hxx

#include "boneDeformableRadiographRegistration.h"
#include "boneMeshRadiograph.h"
#include "boneTriangleSurface.h"
#include "boneUntangling.h"

namespace bone
{
template <typename TMesh, typename TImage>
DeformableRadiographRegistration<TMesh, TImage>::DeformableRadiographRegistration()
{
  this->AddRequiredInputName("Model");
  this->SetNumberOfRequiredOutputs(2);
  this->SetNthOutput(0, this->MakeOutput(0));
  this->SetNthOutput(1, this->MakeOutput(1));
}

template <typename TMesh, typename TImage>
void
DeformableRadiographRegistration<TMesh, TImage>::VerifyPreconditions() const
{
  Superclass::VerifyPreconditions();
  this->VerifyParameters();
}

template <typename TMesh, typename TImage>
void
DeformableRadiographRegistration<TMesh, TImage>::GenerateData()
{
  const StatisticalModelContent & atlas = this->GetModel()->GetContent();
  const std::string               obstacle =
    FindObstacle(atlas.mean.points, atlas.mean, MeshRadiographParameters{}, HUToAttenuation::None);
  if (!obstacle.empty())
  {
    itkExceptionMacro("The input 'Model': " << obstacle);
  }
  const std::vector<RadiographView> views = this->CopyViews();
  try
  {
    m_Result = RegisterDeformable(atlas,
                                  views,
                                  this->GetInitialPose(),
                                  this->GetParameters(),
                                  Execution(this),
                                  [this](const Eigen::VectorXd & coefficients, double cost) {
                                    m_CurrentCoefficients = coefficients;
                                    this->TellStep(cost);
                                  });
  }
  catch (const std::invalid_argument & error)
  {
    itkExceptionMacro("" << error.what());
  }
  this->RepairMesh(atlas.mean);
  this->GetOutput()->SetArrays(m_Result.mesh);
  this->GetTransformOutput()->Set(m_Result.pose.ToTransform());
}

template <typename TMesh, typename TImage>
void
DeformableRadiographRegistration<TMesh, TImage>::RepairMesh(const MeshArrays & mean)
{
  MeshArrays rest = mean;
  if (rest.neighbors.empty())
  {
    rest.neighbors = ComputeFaceNeighbors(rest.tetrahedra);
  }
  std::vector<IdType> exterior;
  ExteriorSurface(rest, exterior);
  const AffineMap        alignment{ m_Result.pose.rotation, m_Result.pose.Apply(Vector3::Zero()) };
  const UntanglingReport report = UntangleMesh(rest, exterior, alignment, m_Result.mesh.points);
  if (report.after > 0)
  {
    itkExceptionMacro("The shape found inverts "
                      << report.before << " tetrahedra, of which " << report.after
                      << " cannot be repaired: it is too far from the mean of the input 'Model'. Give a better "
                         "InitialTransform, or fewer SmoothModes.");
  }
  if (report.before > 0)
  {
    itkWarningMacro("The shape found inverts " << report.before << " tetrahedra; they were repaired.");
  }
}

template <typename TMesh, typename TImage>
void
DeformableRadiographRegistration<TMesh, TImage>::PrintSelf(std::ostream & os, itk::Indent indent) const
{
  Superclass::PrintSelf(os, indent);
  PrintParameters(os, indent, this->GetParameters());
  os << indent << "Quality: " << ParameterText(m_Result.quality) << '\n';
  os << indent << "Distinctness: " << m_Result.distinctness << '\n';
  os << indent << "Coefficients: " << m_Result.coefficients.transpose() << '\n';
  os << indent << "CurrentCoefficients: " << m_CurrentCoefficients.transpose() << '\n';
}
} // namespace bone

#endif
