/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneDRRAdjointFilter_h
#define boneDRRAdjointFilter_h

#include "boneDRRParameters.h"
#include "boneMeshDerivatives.h"
#include "boneMeshFilter.h"

#include <itkImage.h>
#include <itkSimpleDataObjectDecorator.h>

namespace bone
{
/** \class DRRAdjointFilter
 * \brief From radiographs back to a density model: the transpose of DRRImageFilter.
 *
 * The outputs are the derivatives of f = sum over the pixels of Image * radiograph. Where Image is the derivative of
 * any function of the radiograph, they are the derivatives of that function with respect to the model.
 *
 * Inputs: the mesh (primary); for each view an "Image" of columns x rows pixels (third size 1 or none; its place in
 * space is ignored) and a "Geometry" (SetImage(i, ...), SetGeometry(i, ...); without i view 0). The outputs are sums
 * over the views. Outputs: the mesh with df/dc in place of its density coefficients c (quantity unknown), and
 * GetPointGradient(), df/dx of each point, per mm.
 *
 * Parameters: \ref DRRAdjointParameters, as DRRImageFilter's. Tetrahedra that are not selected have derivative 0.
 * HUToAttenuation must be None or WaterScaled.
 *
 * Refused: what DRRImageFilter refuses; an image of another size than its view, or with values that are not finite. */
template <typename TMesh = DensityMesh<double>, typename TImage = itk::Image<float, 3>>
class DRRAdjointFilter : public MeshFilter<TMesh>
{
public:
  ITK_DISALLOW_COPY_AND_MOVE(DRRAdjointFilter);
  using Self = DRRAdjointFilter;
  using Superclass = MeshFilter<TMesh>;
  using Pointer = itk::SmartPointer<Self>;
  using ConstPointer = itk::SmartPointer<const Self>;
  itkNewMacro(Self);
  itkTypeMacro(DRRAdjointFilter, MeshFilter);

  using ImageType = TImage;
  using PointGradientType = itk::SimpleDataObjectDecorator<std::vector<Vector3>>;

  void
  SetImage(const TImage * image)
  {
    this->SetImage(0, image);
  }
  void
  SetImage(unsigned int view, const TImage * image)
  {
    this->itk::ProcessObject::SetInput(Name("Image", view), const_cast<TImage *>(image));
  }
  const TImage *
  GetImage(unsigned int view = 0) const
  {
    return itkDynamicCastInDebugMode<const TImage *>(this->itk::ProcessObject::GetInput(Name("Image", view)));
  }
  void
  SetGeometry(const XRayGeometry * geometry)
  {
    this->SetGeometry(0, geometry);
  }
  void
  SetGeometry(unsigned int view, const XRayGeometry * geometry)
  {
    this->itk::ProcessObject::SetInput(Name("Geometry", view), const_cast<XRayGeometry *>(geometry));
  }
  const XRayGeometry *
  GetGeometry(unsigned int view = 0) const
  {
    return itkDynamicCastInDebugMode<const XRayGeometry *>(this->itk::ProcessObject::GetInput(Name("Geometry", view)));
  }

  const std::vector<Vector3> &
  GetPointGradient() const
  {
    return static_cast<const PointGradientType *>(this->itk::ProcessObject::GetOutput("PointGradient"))->Get();
  }

  BONE_PLAIN_FILTER_PARAMETERS(DRRAdjointParameters, BONE_DRR_ADJOINT_PARAMETERS)

protected:
  DRRAdjointFilter();
  ~DRRAdjointFilter() override = default;

  void
  GenerateData() override;

private:
  static std::string
  Name(const char * what, unsigned int view)
  {
    return view == 0 ? what : what + std::to_string(view);
  }
  /** The pixels of a view's image. Throws where the image does not fit the view or has a value that is not finite. */
  std::vector<float>
  GetWeights(unsigned int view) const;
};
} // namespace bone

#ifndef ITK_MANUAL_INSTANTIATION
#include "boneDRRAdjointFilter.hxx"
#endif

#endif
