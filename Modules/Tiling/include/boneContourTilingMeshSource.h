/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneContourTilingMeshSource_h
#define boneContourTilingMeshSource_h

#include "boneContourTiler.h"
#include "boneMeshSource.h"

#include <itkImage.h>

namespace bone
{
/** \class ContourTilingMeshSource
 * \brief Tiles a stack of nested contours into a layered, conforming tetrahedral mesh (paper 2.2 to 2.6).
 *
 * Inputs: "Contours" (primary), a ContourStack (mm, LPS) whose contours are simple and nested; "DensityImage",
 * optional: the CT, which the metrics `density` and `combined` read along the edges they choose from (trilinear;
 * outside the image an edge costs its length alone). Output: a mesh with region per tetrahedron, layer and slice per
 * point, face neighbours, no density.
 *
 * Parameters: \ref TilingParameters. The metric `combined` is span length plus density deviation / 500, and span length
 * alone without a density image. SetMetricObject takes a metric of another class in place of that parameter.
 *
 * The method, what it does where a slab cannot be knitted, and what it reports: \ref TileContours, \ref TilingReport.
 * The mesh is valid or the update throws itk::ExceptionObject naming slice and contour. The result does not depend on
 * the number of threads.
 *
 * \tparam TMesh a \ref DensityMesh
 * \tparam TImage type of the density image, of any scalar pixel type */
template <typename TMesh = DensityMesh<double>, typename TImage = itk::Image<float, 3>>
class ContourTilingMeshSource : public MeshSource<TMesh>
{
public:
  ITK_DISALLOW_COPY_AND_MOVE(ContourTilingMeshSource);
  using Self = ContourTilingMeshSource;
  using Superclass = MeshSource<TMesh>;
  using Pointer = itk::SmartPointer<Self>;
  using ConstPointer = itk::SmartPointer<const Self>;
  itkNewMacro(Self);
  itkTypeMacro(ContourTilingMeshSource, MeshSource);

  using MeshType = TMesh;
  using DensityImageType = TImage;
  static_assert(TImage::ImageDimension == 3, "The density image must be three-dimensional.");

  using itk::ProcessObject::SetInput;
  void
  SetInput(const ContourStack * contours)
  {
    this->SetPrimaryInput(const_cast<ContourStack *>(contours));
  }
  const ContourStack *
  GetInput() const
  {
    return itkDynamicCastInDebugMode<const ContourStack *>(this->GetPrimaryInput());
  }

  itkSetInputMacro(DensityImage, TImage);
  itkGetInputMacro(DensityImage, TImage);

  BONE_FILTER_PARAMETERS(TilingParameters, BONE_TILING_PARAMETERS)

  /** A metric in place of the parameter's; null goes back to the parameter. */
  void
  SetMetricObject(std::shared_ptr<const TilingMetric> metric);

  /** Correspondence of pieces in some slabs; null (default) leaves all to overlap and distance. What was used is in the
   * report. */
  void
  SetCorrespondence(std::shared_ptr<const ContourCorrespondence> correspondence);

  /** What the last update met. */
  itkGetConstReferenceMacro(Report, TilingReport);

protected:
  ContourTilingMeshSource();
  ~ContourTilingMeshSource() override = default;
  void
  VerifyPreconditions() const override;
  /** A mesh takes no information from contours. */
  void
  GenerateOutputInformation() override
  {}
  void
  GenerateData() override;
  void
  PrintSelf(std::ostream & os, itk::Indent indent) const override;

private:
  DensitySampler
  MakeSampler() const;

  std::shared_ptr<const TilingMetric>          m_MetricObject;
  std::shared_ptr<const ContourCorrespondence> m_Correspondence;
  TilingReport                                 m_Report;
};
} // namespace bone

#ifndef ITK_MANUAL_INSTANTIATION
#include "boneContourTilingMeshSource.hxx"
#endif

#endif
