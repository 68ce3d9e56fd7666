/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneDensityFitFilter_h
#define boneDensityFitFilter_h

#include "boneFitDensity.h"
#include "boneMeshFilter.h"

#include <itkImage.h>

#include <string>
#include <type_traits>
#include <vector>

namespace bone
{
/** \class DensityFitFilter
 * \brief Fits a Bernstein polynomial to an image in every tetrahedron of a mesh (paper 3).
 *
 * Inputs: the mesh (primary, "Mesh"), of any valid shape; "Image", a 3D image whose geometry (origin, spacing,
 * direction, start index) is honoured; "Weights", optional, an image of 0 or more on any grid: how much the values at a
 * place count (0: not at all, as in an artefact; interpolation reaches two voxels, so mark it with that rim). Output:
 * the mesh, its points and attributes as they were (but with ContinuousGradient, see below), with the density's degree,
 * coefficients and quantity; a density that the input held is replaced.
 *
 * Each tetrahedron samples the interpolated image at a fixed pattern of interior points (\ref DensityFitKernel), more
 * than twice as many as there are coefficients and several for each voxel in it; their
 * least-squares fit is p0. The voxels whose centres lie in the tetrahedron, which interpolation blurs, are then
 * added: the result p minimises  (1/V) sum_v (p(x_v) - y_v)^2 + (1/VoxelWeight) mean (p - p0)^2, V
 * being their number or the tetrahedron's volume in voxels, whichever is more. A tetrahedron without voxels keeps p0,
 * so the polynomial does not oscillate where voxels are few. Only points inside the tetrahedron count, so a bone's
 * surface is as sharp as the mesh. Where a mesh reaches beyond the outermost voxel centres, the nearest value between
 * them is taken.
 *
 * Parameters: \ref DensityFitParameters. Continuous replaces the tetrahedra's polynomials by one least-squares spline
 * for each region (\ref MakeDensityContinuous); jumps remain between regions; it needs degree 1 or more.
 * ContinuousGradient does so with a gradient that is continuous too (\ref MakeGradientContinuous); it needs degree 3,
 * and the output is the mesh with every tetrahedron split into twelve (\ref SplitWorseyFarin). The linear interpolator
 * is freed of its error by curvature (\ref QuadraticSampler), so that the mass is kept. With VoxelWeight 0 the
 * interpolated image alone counts, with Tikhonov 0 the fit is plain least squares, which reproduces polynomials of the
 * degree exactly; linear fields are exact in any case. Where control values lie beyond OvershootLimit, the parts of
 * highest degree are reduced (\ref LimitControlValues). SurfaceMargin keeps voxels partly outside the bone from leaving
 * a dark rim, InterfaceMargin keeps a scanner's blur from mixing the densities of two layers. MaximumError counts
 * samples and voxels of the tetrahedron; not with Continuous or ContinuousGradient. HoldOut leaves out the voxels of
 * IsHeldOut(), one in five, so that the error at them tells what the model says between voxels.
 *
 * Throws itk::ExceptionObject where an input is missing, the image is empty, the mesh has no tetrahedra or points that
 * are not finite, the mesh lies wholly outside the image, a voxel value used is not finite, or a parameter does not
 * suit.
 *
 * \sa DensityImageFilter */
template <typename TImage = itk::Image<float, 3>, typename TMesh = DensityMesh<double>>
class DensityFitFilter : public MeshFilter<TMesh>
{
public:
  ITK_DISALLOW_COPY_AND_MOVE(DensityFitFilter);
  using Self = DensityFitFilter;
  using Superclass = MeshFilter<TMesh>;
  using Pointer = itk::SmartPointer<Self>;
  using ConstPointer = itk::SmartPointer<const Self>;
  itkNewMacro(Self);
  itkTypeMacro(DensityFitFilter, MeshFilter);

  using ImageType = TImage;
  static_assert(TImage::ImageDimension == 3, "The image must be three-dimensional.");

  itkSetInputMacro(Image, TImage);
  itkGetInputMacro(Image, TImage);
  itkSetInputMacro(Weights, TImage);
  itkGetInputMacro(Weights, TImage);

  BONE_FILTER_PARAMETERS(DensityFitParameters, BONE_DENSITY_FIT_PARAMETERS)

  /** After an update: share of the sample points that lay beyond the image's border (half a voxel outside its outermost
   * centres) and took the nearest value. */
  double
  GetOutsideFraction() const
  {
    return m_Report.samples > 0 ? static_cast<double>(m_Report.outside) / static_cast<double>(m_Report.samples) : 0.0;
  }

  /** After an update: what the fit found. With MaximumError its samples are those of all degrees tried. */
  itkGetConstReferenceMacro(Report, DensityFitReport);

  /** After an update: a line for each reason to think that the mesh and the image do not belong together. */
  std::vector<std::string>
  GetDoubts() const;

  /** After an update: what the image has on both sides of the mesh's surface. */
  itkGetConstReferenceMacro(Contrast, OutlineContrast);

  /** After an update: the number of coefficients, those of the spline's own basis with Continuous and
   * ContinuousGradient. */
  itkGetConstMacro(NumberOfFreeCoefficients, std::size_t);

protected:
  DensityFitFilter();
  ~DensityFitFilter() override = default;

  void
  VerifyPreconditions() const override;
  void
  GenerateData() override;
  void
  PrintSelf(std::ostream & os, itk::Indent indent) const override;

private:
  void
  VerifyInputs() const;

  using RealType = std::conditional_t<std::is_same_v<typename TImage::PixelType, double>, double, float>;

  /** The image's values, each held-out voxel replaced by the mean of its neighbours, of which none is held out. */
  std::vector<RealType>
  WithoutHeldOutVoxels(const VoxelGrid & grid, const Execution & execution) const;

  template <typename TPixel>
  ImageSampler
  MakeInterpolator(const TPixel *     buffer,
                   const VoxelGrid &  grid,
                   const MeshArrays & arrays,
                   const Execution &  execution) const;

  ImageSampler
  MakeWeights(const VoxelGrid & grid) const;

  void
  Fit(MeshArrays & arrays, const Execution & execution);

  /** Fits and joins; returns the number of free coefficients. */
  std::size_t
  FitSpline(MeshArrays & arrays, const Execution & execution);

  /** More is told. A bone that is cut by the image ends within half a voxel of it. */
  static constexpr double LargestOutsideFraction = 0.01;

  DensityFitReport m_Report;
  OutlineContrast  m_Contrast;
  std::size_t      m_NumberOfFreeCoefficients{ 0 };
};

extern template class DensityFitFilter<itk::Image<float, 3>, DensityMesh<double>>;
} // namespace bone

#ifndef ITK_MANUAL_INSTANTIATION
#include "boneDensityFitFilter.hxx"
#endif

#endif
