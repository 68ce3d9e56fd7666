/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneCorticalThicknessFilter_h
#define boneCorticalThicknessFilter_h

#include "boneCorticalThickness.h"
#include "boneDensityMesh.h"

#include <itkImage.h>
#include <itkProcessObject.h>
#include <itkSimpleDataObjectDecorator.h>

namespace bone
{
/** \class CorticalThicknessFilter
 * \brief Cortical thickness at the points of a mesh's exterior surface, measured in the CT along the inward normal.
 *
 * Inputs: the mesh (primary, "Mesh"), of any density or none; "Image", the CT in HU, whose geometry (origin, spacing,
 * direction, start index) is honoured. Output: a decorated \ref CorticalThicknessMap. See \ref MapCorticalThickness for
 * what is done, and \ref CorticalThicknessParameters.
 *
 * Throws itk::ExceptionObject where an input is missing, the image has no voxels, the mesh no tetrahedra or points that
 * are not finite, and where MapCorticalThickness throws. */
template <typename TImage = itk::Image<float, 3>, typename TMesh = DensityMesh<double>>
class CorticalThicknessFilter : public itk::ProcessObject
{
public:
  ITK_DISALLOW_COPY_AND_MOVE(CorticalThicknessFilter);
  using Self = CorticalThicknessFilter;
  using Superclass = itk::ProcessObject;
  using Pointer = itk::SmartPointer<Self>;
  using ConstPointer = itk::SmartPointer<const Self>;
  itkNewMacro(Self);
  itkTypeMacro(CorticalThicknessFilter, itk::ProcessObject);

  using ImageType = TImage;
  using MeshType = TMesh;
  using OutputType = itk::SimpleDataObjectDecorator<CorticalThicknessMap>;
  static_assert(TImage::ImageDimension == 3, "The image must be three-dimensional.");

  itkSetInputMacro(Mesh, TMesh);
  itkGetInputMacro(Mesh, TMesh);
  itkSetInputMacro(Image, TImage);
  itkGetInputMacro(Image, TImage);

  BONE_PLAIN_FILTER_PARAMETERS(CorticalThicknessParameters, BONE_CORTICAL_THICKNESS_PARAMETERS)

  OutputType *
  GetOutput()
  {
    return itkDynamicCastInDebugMode<OutputType *>(this->GetPrimaryOutput());
  }
  const OutputType *
  GetOutput() const
  {
    return itkDynamicCastInDebugMode<const OutputType *>(this->GetPrimaryOutput());
  }
  /** After an update. */
  const CorticalThicknessMap &
  GetMap() const
  {
    return this->GetOutput()->Get();
  }

  using Superclass::MakeOutput;
  itk::DataObject::Pointer
  MakeOutput(itk::ProcessObject::DataObjectPointerArraySizeType) override
  {
    return OutputType::New().GetPointer();
  }

protected:
  CorticalThicknessFilter();
  ~CorticalThicknessFilter() override = default;

  void
  GenerateData() override;
};

extern template class CorticalThicknessFilter<itk::Image<float, 3>, DensityMesh<double>>;
} // namespace bone

#ifndef ITK_MANUAL_INSTANTIATION
#include "boneCorticalThicknessFilter.hxx"
#endif

#endif
