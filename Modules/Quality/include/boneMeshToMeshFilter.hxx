/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneMeshToMeshFilter_hxx
#define boneMeshToMeshFilter_hxx

#include "boneMeshToMeshFilter.h"
#include "boneQualityMeasures.h"
#include "boneUntangle.h"

#include <type_traits>

namespace bone
{
template <typename TMesh>
MeshToMeshFilter<TMesh>::MeshToMeshFilter()
{
  this->SetNumberOfRequiredInputs(1);
  this->SetNumberOfRequiredOutputs(1);
  this->SetNthOutput(0, this->MakeOutput(0));
}

template <typename TMesh>
itk::DataObject::Pointer
MeshToMeshFilter<TMesh>::MakeOutput(itk::ProcessObject::DataObjectPointerArraySizeType)
{
  return TMesh::New().GetPointer();
}

template <typename TMesh>
void
MeshToMeshFilter<TMesh>::SetInput(const TMesh * mesh)
{
  this->SetNthInput(0, const_cast<TMesh *>(mesh));
}

template <typename TMesh>
const TMesh *
MeshToMeshFilter<TMesh>::GetInput() const
{
  return itkDynamicCastInDebugMode<const TMesh *>(this->GetPrimaryInput());
}

template <typename TMesh>
TMesh *
MeshToMeshFilter<TMesh>::GetOutput()
{
  return itkDynamicCastInDebugMode<TMesh *>(this->GetPrimaryOutput());
}

template <typename TMesh>
const TMesh *
MeshToMeshFilter<TMesh>::GetOutput() const
{
  return itkDynamicCastInDebugMode<const TMesh *>(this->GetPrimaryOutput());
}

template <typename TMesh>
MeshArrays
MeshToMeshFilter<TMesh>::TakeInput() const
{
  MeshArrays arrays = this->GetInput()->GetArrays();
  if (arrays.tetrahedra.empty())
  {
    itkExceptionMacro("The input mesh has no tetrahedra.");
  }
  return arrays;
}

template <typename TMesh>
void
MeshToMeshFilter<TMesh>::MakePositive(const MeshArrays & input, TetraComplex & complex) const
{
  const std::size_t inverted = CountInverted(input);
  if (inverted == 0)
  {
    return;
  }
  const std::size_t left = Untangle(complex);
  if (left > 0)
  {
    itkExceptionMacro("" << inverted << " of the " << input.tetrahedra.size()
                         << " tetrahedra of the input mesh are flat or inverted, and " << left
                         << " stay so however inner points are moved; give a mesh whose tetrahedra are all positively "
                            "oriented.");
  }
}

template <typename TMesh>
void
MeshToMeshFilter<TMesh>::GenerateData()
{
  const MeshArrays input = this->TakeInput();
  TetraComplex     complex(input);
  if (this->NeedsPositiveCells())
  {
    this->MakePositive(input, complex);
  }
  this->Improve(complex, [this](double done) {
    this->UpdateProgress(static_cast<float>(done));
    if (this->GetAbortGenerateData())
    {
      throw itk::ProcessAborted(__FILE__, __LINE__);
    }
  });
  std::vector<IdType> pointId, cellSlot;
  TMesh *             output = this->GetOutput();
  output->SetArrays(complex.Compact(input, pointId, cellSlot));
  output->SetBufferedRegion(output->GetRequestedRegion());
  if (!std::is_same<typename TMesh::CoordinateType, double>::value && this->NeedsPositiveCells())
  {
    const std::size_t inverted = CountInverted(output->GetArrays());
    if (inverted > 0)
    {
      itkExceptionMacro("Rounding the points of the result to single precision inverts "
                        << inverted << " tetrahedra; use a mesh with double coordinates.");
    }
  }
}
} // namespace bone

#endif
