/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneMeshToMeshFilter_hxx
#define boneMeshToMeshFilter_hxx

#include "boneMeshToMeshFilter.h"
#include "boneQualityMeasures.h"
#include "boneInvertedCellRepair.h"

#include <type_traits>

namespace bone
{
template <typename TMesh>
void
MeshToMeshFilter<TMesh>::MakePositive(const MeshArrays & input, TetraComplex & complex) const
{
  const std::size_t inverted = CountInverted(input);
  if (inverted == 0)
  {
    return;
  }
  const std::size_t left = RepairInvertedCells(complex);
  if (left > 0)
  {
    itkExceptionMacro("" << inverted << " of the " << input.tetrahedra.size()
                         << " tetrahedra of the input 'Mesh' are flat or inverted, and " << left
                         << " stay so however inner points are moved; give a mesh whose tetrahedra are all positively "
                            "oriented.");
  }
}

template <typename TMesh>
void
MeshToMeshFilter<TMesh>::GenerateData()
{
  const Execution  execution(this);
  const MeshArrays input = this->CopyInput();
  TetraComplex     complex(input);
  if (this->NeedsPositiveCells())
  {
    this->MakePositive(input, complex);
  }
  this->Improve(complex, execution.Part(0.0, 0.95));
  std::vector<IdType> pointId, cellSlot;
  TMesh *             output = this->GetOutput();
  output->SetArrays(complex.Compact(input, pointId, cellSlot));
  if (!std::is_same<typename TMesh::CoordinateType, double>::value && this->NeedsPositiveCells())
  {
    const std::size_t inverted = CountInverted(output->GetArrays());
    if (inverted > 0)
    {
      itkExceptionMacro("Rounding the points of the result to single precision inverts "
                        << inverted << " tetrahedra; use a mesh with double coordinates.");
    }
  }
  execution.Report(1.0);
}
} // namespace bone

#endif
