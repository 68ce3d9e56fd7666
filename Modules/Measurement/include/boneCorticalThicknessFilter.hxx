/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneCorticalThicknessFilter_hxx
#define boneCorticalThicknessFilter_hxx

#include "boneCorticalThicknessFilter.h"

#include <algorithm>
#include <stdexcept>

namespace bone
{
template <typename TImage, typename TMesh>
CorticalThicknessFilter<TImage, TMesh>::CorticalThicknessFilter()
{
  this->SetPrimaryInputName("Mesh");
  this->AddRequiredInputName("Image");
  this->SetNumberOfRequiredOutputs(1);
  this->SetNthOutput(0, OutputType::New());
}

template <typename TImage, typename TMesh>
void
CorticalThicknessFilter<TImage, TMesh>::GenerateData()
{
  const Execution  execution(this);
  const MeshArrays mesh = this->GetMesh()->GetArrays();
  const TImage *   image = this->GetImage();
  if (mesh.tetrahedra.empty())
  {
    itkExceptionMacro("The input 'Mesh' has no tetrahedra.");
  }
  if (!std::all_of(mesh.points.begin(), mesh.points.end(), [](const Vector3 & p) { return p.allFinite(); }))
  {
    itkExceptionMacro("A point of the input 'Mesh' is not finite.");
  }
  if (image->GetBufferedRegion().GetNumberOfPixels() == 0)
  {
    itkExceptionMacro("The input 'Image' has no voxels.");
  }
  const auto * buffer = image->GetBufferPointer();
  CTVoxels     ct;
  ct.grid = MakeVoxelGrid(*image, image->GetBufferedRegion());
  ct.value = [buffer](std::size_t at) { return static_cast<double>(buffer[at]); };
  try
  {
    this->GetOutput()->Set(MapCorticalThickness(mesh, ct, m_Parameters, execution));
  }
  catch (const std::invalid_argument & error)
  {
    itkExceptionMacro("" << error.what());
  }
}
} // namespace bone

#endif
