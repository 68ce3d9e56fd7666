/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneDRRDerivativeImageFilter_h
#define boneDRRDerivativeImageFilter_h

#include "boneDRRImageFilter.h"
#include "boneMeshDerivatives.h"

namespace bone
{
/** \class DRRDerivativeImageFilter
 * \brief The radiograph of a density model with its derivatives by pose, shape and density, in one run.
 *
 * Inputs as DRRImageFilter's, one view. Output 0 is the radiograph, output 1 + m (GetDerivative(m)) its derivative by
 * mode m of RadiographModes: the radiograph's unit per mm, per radian or per unit of the mode. See
 * ProjectMeshDerivatives for what is exact.
 *
 * Parameters: Modes (default: none), and those of DRRImageFilter.
 *
 * Refused: what DRRImageFilter refuses; a second view; a shape mode that has not one displacement a
 * point, a density mode that has not one number a coefficient, and numbers that are not finite. */
template <typename TMesh = DensityMesh<double>, typename TOutputImage = itk::Image<float, 3>>
class DRRDerivativeImageFilter : public DRRImageFilter<TMesh, TOutputImage>
{
public:
  ITK_DISALLOW_COPY_AND_MOVE(DRRDerivativeImageFilter);
  using Self = DRRDerivativeImageFilter;
  using Superclass = DRRImageFilter<TMesh, TOutputImage>;
  using Pointer = itk::SmartPointer<Self>;
  using ConstPointer = itk::SmartPointer<const Self>;
  itkNewMacro(Self);
  itkTypeMacro(DRRDerivativeImageFilter, DRRImageFilter);

  /** Runs the filter again, whatever the modes were. */
  void
  SetModes(RadiographModes modes);
  itkGetConstReferenceMacro(Modes, RadiographModes);

  TOutputImage *
  GetDerivative(unsigned int mode)
  {
    return this->GetOutput(1 + mode);
  }

protected:
  DRRDerivativeImageFilter() = default;
  ~DRRDerivativeImageFilter() override = default;

  unsigned int
  GetViewOfOutput(unsigned int) const override
  {
    return 0;
  }
  void
  VerifyPreconditions() const override;
  void
  ComputeIntegrals(const std::vector<XRayGeometry::View> & views,
                   const Execution &                       execution,
                   const std::vector<float *> &            integrals) override;
  void
  PrintSelf(std::ostream & os, itk::Indent indent) const override;

private:
  RadiographModes m_Modes;
};
} // namespace bone

#ifndef ITK_MANUAL_INSTANTIATION
#include "boneDRRDerivativeImageFilter.hxx"
#endif

#endif
