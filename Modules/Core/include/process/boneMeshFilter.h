/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneMeshFilter_h
#define boneMeshFilter_h

#include "boneMeshSource.h"

#include <algorithm>

namespace bone
{
/** \class MeshFilter
 * \brief Base of the filters that make a density mesh from another: the primary input is named "Mesh".
 *
 * \tparam TMesh a \ref DensityMesh. */
template <typename TMesh>
class MeshFilter : public MeshSource<TMesh>
{
public:
  ITK_DISALLOW_COPY_AND_MOVE(MeshFilter);
  using Self = MeshFilter;
  using Superclass = MeshSource<TMesh>;
  using Pointer = itk::SmartPointer<Self>;
  using ConstPointer = itk::SmartPointer<const Self>;
  itkTypeMacro(MeshFilter, MeshSource);
  using MeshType = TMesh;

  using itk::ProcessObject::SetInput;
  virtual void
  SetInput(const TMesh * mesh)
  {
    this->itk::ProcessObject::SetPrimaryInput(const_cast<TMesh *>(mesh));
  }
  const TMesh *
  GetInput() const
  {
    return itkDynamicCastInDebugMode<const TMesh *>(this->GetPrimaryInput());
  }
  void
  SetMesh(const TMesh * mesh)
  {
    this->SetInput(mesh);
  }
  const TMesh *
  GetMesh() const
  {
    return this->GetInput();
  }

protected:
  MeshFilter() { this->SetPrimaryInputName("Mesh"); }
  ~MeshFilter() override = default;

  /** A copy of the input. Throws itk::ExceptionObject where it has no tetrahedra or points that are not finite. */
  MeshArrays
  CopyInput() const
  {
    MeshArrays arrays = this->GetInput()->GetArrays();
    if (arrays.tetrahedra.empty())
    {
      itkExceptionMacro("The input 'Mesh' has no tetrahedra.");
    }
    if (!std::all_of(arrays.points.begin(), arrays.points.end(), [](const Vector3 & p) { return p.allFinite(); }))
    {
      itkExceptionMacro("A point of the input 'Mesh' is not finite.");
    }
    return arrays;
  }
};
} // namespace bone

#endif
