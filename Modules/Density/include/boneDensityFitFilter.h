/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneDensityFitFilter_h
#define boneDensityFitFilter_h

#include "boneDensityMesh.h"
#include "boneFitDensity.h"

#include <itkImage.h>
#include <itkMultiThreaderBase.h>
#include <itkProcessObject.h>

#include <ostream>
#include <type_traits>
#include <vector>

namespace bone
{
/** How an image is interpolated between its voxels. */
enum class DensityInterpolator : int
{
  Linear,
  CubicBSpline
};

inline std::ostream &
operator<<(std::ostream & os, DensityInterpolator interpolator)
{
  return os << (interpolator == DensityInterpolator::Linear ? "Linear" : "CubicBSpline");
}

/** \class DensityFitFilter
 * \brief Fits a Bernstein polynomial to an image in every tetrahedron of a mesh (paper 3).
 *
 * Inputs: the mesh (primary, "Mesh"), of any valid shape; "Image", a 3D image whose geometry (origin, spacing,
 * direction, start index) is honoured; "Weights", optional, an image of 0 or more on any grid: how much the values at a
 * place count (0: not at all, as in an artefact; interpolation reaches two voxels, so mark it with that rim). Output:
 * the mesh, its points and attributes as they were, with the density's degree, coefficients and quantity; a density
 * that the input held is replaced.
 *
 * Each tetrahedron samples the interpolated image at a fixed pattern of interior points (\ref DensityFitKernel), more
 * than twice as many as there are coefficients and several for each voxel in it (\ref DensityFitPlan); their
 * least-squares fit is p0. The voxels whose centres lie in the tetrahedron, which interpolation blurs, then have their
 * say: the result p minimises  (1/V) sum_v (p(x_v) - y_v)^2 + (1/VoxelWeight) mean (p - p0)^2  (\ref PenalizedFit), V
 * being their number or the tetrahedron's volume in voxels, whichever is more. A tetrahedron without voxels keeps p0,
 * so nothing swings where voxels are few. Only points inside the tetrahedron count, so a bone's surface is as sharp as
 * the mesh. Where a mesh reaches beyond the outermost voxel centres, the nearest value between them is taken.
 *
 * Parameters:
 * - Degree: 0..8, default 3; 1, 4, 10, 20, 35, 56, 84, 120, 165 coefficients for each tetrahedron.
 * - Continuous: one least-squares spline for each region (\ref MakeDensityContinuous) in place of tetrahedra on their
 *   own; needs degree 1 or more. Jumps remain between regions. Default off.
 * - Interpolator: Linear (default), which is freed of its error by curvature (\ref QuadraticSampler) so that the mass
 * is kept, or CubicBSpline (\ref CubicSampler).
 * - VoxelWeight: of the voxels' own values against the interpolated image, no unit, default 4; 0: the interpolated
 * image alone.
 * - Tikhonov: weight of the term that holds control values near those of the lower degree (\ref DensityFitKernel),
 *   default 1e-4, no unit; 0: plain least squares, which reproduces polynomials of the degree exactly. Linear fields
 *   are exact in any case.
 * - OvershootLimit: how far control values may lie beyond the tetrahedron's data, in ranges of those data (no unit,
 *   infinite: anywhere); where they lie further, the parts of highest degree are reduced (\ref LimitControlValues).
 *   Default 8.
 * - SurfaceMargin (mm): what lies nearer to the mesh's surface counts as what lies this deep straight inward of it, so
 *   that voxels partly outside the bone leave no dark rim. Default 0: the image as it is.
 * - InterfaceMargin (mm): the same for the faces between regions, from either side, so that a scanner's blur does not
 *   mix the layers' densities. Default 0.
 * - MaximumError (density units): above 0, each tetrahedron takes the lowest degree, up to Degree, whose root mean
 * square error over its samples and voxels is no more than this. Not with Continuous. Default 0: all have Degree.
 * - HoldOut: the voxels of IsHeldOut(), one in five, play no part in the fit, so that the error at them tells what the
 *   model says between voxels. Default off.
 * - Quantity: what the image's values mean, default HounsfieldUnit.
 *
 * Throws itk::ExceptionObject where an input is missing, the image is empty, the mesh has no tetrahedra or points that
 * are not finite, the mesh lies wholly outside the image, a voxel value used is not finite, or a parameter does not
 * suit.
 *
 * \sa DensityImageFilter */
template <typename TImage = itk::Image<float, 3>, typename TMesh = DensityMesh<double>>
class DensityFitFilter : public itk::ProcessObject
{
public:
  ITK_DISALLOW_COPY_AND_MOVE(DensityFitFilter);
  using Self = DensityFitFilter;
  using Superclass = itk::ProcessObject;
  using Pointer = itk::SmartPointer<Self>;
  using ConstPointer = itk::SmartPointer<const Self>;
  itkNewMacro(Self);
  itkTypeMacro(DensityFitFilter, itk::ProcessObject);

  using ImageType = TImage;
  using MeshType = TMesh;
  static_assert(TImage::ImageDimension == 3, "The image must be three-dimensional.");

  using Superclass::SetInput;
  void
  SetInput(const TMesh * mesh);
  void
  SetMesh(const TMesh * mesh)
  {
    this->SetInput(mesh);
  }
  const TMesh *
  GetInput() const;
  const TMesh *
  GetMesh() const
  {
    return this->GetInput();
  }
  itkSetInputMacro(Image, TImage);
  itkGetInputMacro(Image, TImage);
  itkSetInputMacro(Weights, TImage);
  itkGetInputMacro(Weights, TImage);

  TMesh *
  GetOutput();
  const TMesh *
  GetOutput() const;

  itkSetMacro(Degree, int);
  itkGetConstMacro(Degree, int);
  itkSetMacro(Continuous, bool);
  itkGetConstMacro(Continuous, bool);
  itkBooleanMacro(Continuous);
  itkSetMacro(Tikhonov, double);
  itkGetConstMacro(Tikhonov, double);
  itkSetEnumMacro(Interpolator, DensityInterpolator);
  itkGetEnumMacro(Interpolator, DensityInterpolator);
  itkSetMacro(VoxelWeight, double);
  itkGetConstMacro(VoxelWeight, double);
  itkSetMacro(OvershootLimit, double);
  itkGetConstMacro(OvershootLimit, double);
  itkSetMacro(SurfaceMargin, double);
  itkGetConstMacro(SurfaceMargin, double);
  itkSetMacro(InterfaceMargin, double);
  itkGetConstMacro(InterfaceMargin, double);
  itkSetMacro(MaximumError, double);
  itkGetConstMacro(MaximumError, double);
  itkSetMacro(HoldOut, bool);
  itkGetConstMacro(HoldOut, bool);
  itkBooleanMacro(HoldOut);
  itkSetEnumMacro(Quantity, DensityQuantity);
  itkGetEnumMacro(Quantity, DensityQuantity);

  /** After an update: share of the sample points that lay beyond the image's border (half a voxel outside its outermost
   * centres) and took the nearest value. */
  double
  GetOutsideFraction() const
  {
    return m_Report.samples > 0 ? static_cast<double>(m_Report.outside) / static_cast<double>(m_Report.samples) : 0.0;
  }

  /** After an update: what the fit found. With MaximumError its samples are those of all degrees tried. */
  const DensityFitReport &
  GetReport() const
  {
    return m_Report;
  }

  /** After an update: the number of coefficients, those that Continuous makes one counted once. */
  itkGetConstMacro(NumberOfFreeCoefficients, std::size_t);

  using Superclass::MakeOutput;
  itk::DataObject::Pointer
  MakeOutput(itk::ProcessObject::DataObjectPointerArraySizeType index) override;

protected:
  DensityFitFilter();
  ~DensityFitFilter() override = default;

  void
  VerifyPreconditions() ITKv5_CONST override;
  void
  GenerateData() override;
  void
  PrintSelf(std::ostream & os, itk::Indent indent) const override;

private:
  void
  VerifyInputs(const MeshArrays & arrays) const;

  using RealType = std::conditional_t<std::is_same_v<typename TImage::PixelType, double>, double, float>;

  /** The image's values, each held-out voxel replaced by the mean of its neighbours, of which none is held out. */
  std::vector<RealType>
  WithoutHeldOutVoxels(const VoxelGrid & grid) const;

  template <typename TPixel>
  ImageSampler
  MakeInterpolator(const TPixel * buffer, const VoxelGrid & grid, const MeshArrays & arrays) const;

  ImageSampler
  MakeWeights(const VoxelGrid & grid) const;

  void
  Fit(MeshArrays & arrays);

  int                 m_Degree{ 3 };
  bool                m_Continuous{ false };
  double              m_Tikhonov{ 1e-4 };
  DensityInterpolator m_Interpolator{ DensityInterpolator::Linear };
  double              m_VoxelWeight{ 4.0 };
  double              m_OvershootLimit{ 8.0 };
  double              m_SurfaceMargin{ 0.0 };
  double              m_InterfaceMargin{ 0.0 };
  double              m_MaximumError{ 0.0 };
  bool                m_HoldOut{ false };
  DensityQuantity     m_Quantity{ DensityQuantity::HounsfieldUnit };
  DensityFitReport    m_Report;
  std::size_t         m_NumberOfFreeCoefficients{ 0 };
};

extern template class DensityFitFilter<itk::Image<float, 3>, DensityMesh<double>>;
} // namespace bone

#ifndef ITK_MANUAL_INSTANTIATION
#include "boneDensityFitFilter.hxx"
#endif

#endif
