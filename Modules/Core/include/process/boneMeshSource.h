/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneMeshSource_h
#define boneMeshSource_h

#include "boneDensityMesh.h"

#include <itkProcessObject.h>

namespace bone
{
/** \class MeshSource
 * \brief Base of the process objects whose primary output is a density mesh.
 *
 * \tparam TMesh a \ref DensityMesh. */
template <typename TMesh>
class MeshSource : public itk::ProcessObject
{
public:
  ITK_DISALLOW_COPY_AND_MOVE(MeshSource);
  using Self = MeshSource;
  using Superclass = itk::ProcessObject;
  using Pointer = itk::SmartPointer<Self>;
  using ConstPointer = itk::SmartPointer<const Self>;
  itkTypeMacro(MeshSource, itk::ProcessObject);
  using OutputMeshType = TMesh;

  TMesh *
  GetOutput()
  {
    return itkDynamicCastInDebugMode<TMesh *>(this->GetPrimaryOutput());
  }
  const TMesh *
  GetOutput() const
  {
    return itkDynamicCastInDebugMode<const TMesh *>(this->GetPrimaryOutput());
  }

  using Superclass::MakeOutput;
  itk::DataObject::Pointer
  MakeOutput(itk::ProcessObject::DataObjectPointerArraySizeType) override
  {
    return TMesh::New().GetPointer();
  }

protected:
  MeshSource()
  {
    this->SetNumberOfRequiredOutputs(1);
    this->SetNthOutput(0, TMesh::New());
  }
  ~MeshSource() override = default;

  /** Makes `arrays` the output. */
  void
  SetResult(MeshArrays && arrays)
  {
    TMesh * output = this->GetOutput();
    output->SetArrays(std::move(arrays));
    output->SetBufferedRegion(output->GetRequestedRegion());
  }
};
} // namespace bone

#endif
