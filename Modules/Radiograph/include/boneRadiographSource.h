/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneRadiographSource_h
#define boneRadiographSource_h

#include "boneAttenuation.h"
#include "boneExecution.h"
#include "boneXRayGeometry.h"

#include <itkImageSource.h>

#include <string>
#include <vector>

namespace bone
{
/** \class RadiographSource
 * \brief Base of the filters that make radiographs: the geometry as an input, the conversion to attenuation, and an
 * output image with its place in space.
 *
 * Inputs: "Geometry", an XRayGeometry, and the geometries of further views, whose radiographs are made in the same run.
 * Editing a geometry in place re-runs the filter. Output: for each view an image of columns x rows x 1 pixels in
 * physical space: its origin is the centre of pixel (0, 0), its directions are the detector's U, V and U x V, its
 * spacing the pixels' (1 mm along the third). A value is the line integral from the source (parallel: from infinity) to
 * the pixel's centre, in the density's unit times mm, or without unit where HUToAttenuation is not None. The whole
 * image is always made.
 *
 * Parameters: \ref RadiographParameters, and AttenuationTable, which HUToAttenuation::Table needs. They apply to all
 * views, see AttenuationCurve.
 *
 * \tparam TOutputImage a three-dimensional image of a scalar pixel type. */
template <typename TOutputImage>
class RadiographSource : public itk::ImageSource<TOutputImage>
{
public:
  ITK_DISALLOW_COPY_AND_MOVE(RadiographSource);
  using Self = RadiographSource;
  using Superclass = itk::ImageSource<TOutputImage>;
  using Pointer = itk::SmartPointer<Self>;
  using ConstPointer = itk::SmartPointer<const Self>;
  itkTypeMacro(RadiographSource, itk::ImageSource);

  using OutputImageType = TOutputImage;
  using OutputPixelType = typename TOutputImage::PixelType;
  static_assert(TOutputImage::ImageDimension == 3, "A radiograph lies in space: it needs a three-dimensional image.");

  itkSetInputMacro(Geometry, XRayGeometry);
  itkGetInputMacro(Geometry, XRayGeometry);

  /** View `index`, whose radiograph is GetOutput(index); views 0..index must be set. */
  virtual void
  SetGeometry(unsigned int index, const XRayGeometry * geometry)
  {
    this->itk::ProcessObject::SetInput(this->GeometryName(index), const_cast<XRayGeometry *>(geometry));
    for (unsigned int i = this->GetNumberOfIndexedOutputs(); i <= index; ++i)
    {
      this->SetNthOutput(i, this->MakeOutput(i));
    }
  }
  const XRayGeometry *
  GetGeometry(unsigned int index) const
  {
    return itkDynamicCastInDebugMode<const XRayGeometry *>(this->itk::ProcessObject::GetInput(GeometryName(index)));
  }

  BONE_FILTER_PARAMETERS(RadiographParameters, BONE_RADIOGRAPH_PARAMETERS)

  /** The same as GetParameters(), which derived filters have of their own parameters. */
  const RadiographParameters &
  GetRadiographParameters() const
  {
    return m_Parameters;
  }
  itkSetMacro(AttenuationTable, std::vector<AttenuationPoint>);
  itkGetConstReferenceMacro(AttenuationTable, std::vector<AttenuationPoint>);

protected:
  RadiographSource();
  ~RadiographSource() override = default;

  void
  VerifyPreconditions() const override;
  void
  GenerateOutputInformation() override;
  void
  EnlargeOutputRequestedRegion(itk::DataObject * output) override;
  /** The outputs are of different sizes: each is made whole. */
  void
  GenerateOutputRequestedRegion(itk::DataObject * output) override;
  void
  GenerateData() override;

  /** The view that an output shows. */
  virtual unsigned int
  GetViewOfOutput(unsigned int output) const
  {
    return output;
  }
  /** Writes rows x columns line integrals of each output, row by row; `views` are the outputs'. */
  virtual void
  ComputeIntegrals(const std::vector<XRayGeometry::View> & views,
                   const Execution &                       execution,
                   const std::vector<float *> &            integrals) = 0;

  AttenuationCurve
  GetCurve() const
  {
    return { m_Parameters, m_AttenuationTable };
  }

  void
  PrintSelf(std::ostream & os, itk::Indent indent) const override;

private:
  static std::string
  GeometryName(unsigned int index)
  {
    return index == 0 ? "Geometry" : "Geometry" + std::to_string(index);
  }

  std::vector<AttenuationPoint> m_AttenuationTable;
};
} // namespace bone

#ifndef ITK_MANUAL_INSTANTIATION
#include "boneRadiographSource.hxx"
#endif

#endif
