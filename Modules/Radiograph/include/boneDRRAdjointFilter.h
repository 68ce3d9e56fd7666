/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneDRRAdjointFilter_h
#define boneDRRAdjointFilter_h

#include "boneDRRImageFilter.h"
#include "boneMeshDerivatives.h"

#include <itkMultiThreaderBase.h>
#include <itkProcessObject.h>
#include <itkSimpleDataObjectDecorator.h>

namespace bone
{
/** \class DRRAdjointFilter
 * \brief From radiographs back to a density model: the transpose of DRRImageFilter.
 *
 * For f = sum over the pixels of Image * radiograph: with the derivative of any function of the radiograph as Image,
 * the outputs are that function's derivatives by all of the model.
 *
 * Inputs: the mesh (primary); for each view an "Image" of columns x rows pixels (third size 1 or none; its place in
 * space is not looked at) and a "Geometry" (SetImage(i, ...), SetGeometry(i, ...); without i view 0), over which the
 * outputs are summed. Outputs: the mesh with df/dc in place of its density coefficients c (quantity unknown), and
 * GetPointGradient(), df/dx of each point, per mm.
 *
 * Parameters as DRRImageFilter's: MinimumRegion, MaximumRegion (what is not selected has derivative 0), HUToAttenuation
 * (None or WaterScaled) and WaterAttenuation.
 *
 * Refused: what DRRImageFilter refuses; an image of another size than its view, or with values that are not finite. */
template <typename TMesh = DensityMesh<double>, typename TImage = itk::Image<float, 3>>
class DRRAdjointFilter : public itk::ProcessObject
{
public:
  ITK_DISALLOW_COPY_AND_MOVE(DRRAdjointFilter);
  using Self = DRRAdjointFilter;
  using Superclass = itk::ProcessObject;
  using Pointer = itk::SmartPointer<Self>;
  using ConstPointer = itk::SmartPointer<const Self>;
  itkNewMacro(Self);
  itkTypeMacro(DRRAdjointFilter, itk::ProcessObject);

  using MeshType = TMesh;
  using ImageType = TImage;
  using PointGradientType = itk::SimpleDataObjectDecorator<std::vector<Vector3>>;

  using Superclass::SetInput;
  void
  SetInput(const TMesh * mesh)
  {
    this->SetNthInput(0, const_cast<TMesh *>(mesh));
  }
  const TMesh *
  GetInput() const
  {
    return itkDynamicCastInDebugMode<const TMesh *>(this->GetPrimaryInput());
  }
  void
  SetImage(const TImage * image)
  {
    this->SetImage(0, image);
  }
  void
  SetImage(unsigned int view, const TImage * image)
  {
    this->Superclass::SetInput(Name("Image", view), const_cast<TImage *>(image));
  }
  const TImage *
  GetImage(unsigned int view = 0) const
  {
    return itkDynamicCastInDebugMode<const TImage *>(this->Superclass::GetInput(Name("Image", view)));
  }
  void
  SetGeometry(const XRayGeometry * geometry)
  {
    this->SetGeometry(0, geometry);
  }
  void
  SetGeometry(unsigned int view, const XRayGeometry * geometry)
  {
    this->Superclass::SetInput(Name("Geometry", view), const_cast<XRayGeometry *>(geometry));
  }
  const XRayGeometry *
  GetGeometry(unsigned int view = 0) const
  {
    return itkDynamicCastInDebugMode<const XRayGeometry *>(this->Superclass::GetInput(Name("Geometry", view)));
  }

  TMesh *
  GetOutput()
  {
    return itkDynamicCastInDebugMode<TMesh *>(this->GetPrimaryOutput());
  }
  const std::vector<Vector3> &
  GetPointGradient() const
  {
    return static_cast<const PointGradientType *>(this->Superclass::GetOutput("PointGradient"))->Get();
  }

  itkSetMacro(MinimumRegion, int);
  itkGetConstMacro(MinimumRegion, int);
  itkSetMacro(MaximumRegion, int);
  itkGetConstMacro(MaximumRegion, int);
  itkSetMacro(HUToAttenuation, HUToAttenuation);
  itkGetConstMacro(HUToAttenuation, HUToAttenuation);
  itkSetMacro(WaterAttenuation, double);
  itkGetConstMacro(WaterAttenuation, double);

  using Superclass::MakeOutput;
  itk::DataObject::Pointer
  MakeOutput(itk::ProcessObject::DataObjectPointerArraySizeType) override
  {
    return TMesh::New().GetPointer();
  }

protected:
  DRRAdjointFilter();
  ~DRRAdjointFilter() override = default;

  void
  VerifyPreconditions() ITKv5_CONST override;
  void
  GenerateData() override;
  void
  PrintSelf(std::ostream & os, itk::Indent indent) const override;

private:
  static std::string
  Name(const char * what, unsigned int view)
  {
    return view == 0 ? what : what + std::to_string(view);
  }
  /** The pixels of a view's image; throws where they cannot be those. */
  std::vector<float>
  GetWeights(unsigned int view) const;

  int             m_MinimumRegion{ std::numeric_limits<int>::min() };
  int             m_MaximumRegion{ std::numeric_limits<int>::max() };
  HUToAttenuation m_HUToAttenuation{ HUToAttenuation::None };
  double          m_WaterAttenuation{ WaterAttenuationAt60keV };
};
} // namespace bone

#ifndef ITK_MANUAL_INSTANTIATION
#include "boneDRRAdjointFilter.hxx"
#endif

#endif
