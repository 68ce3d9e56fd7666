/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneContourTilingMeshSource_h
#define boneContourTilingMeshSource_h

#include "boneContourStack.h"
#include "boneContourTiler.h"
#include "boneDensityMesh.h"

#include <itkImage.h>
#include <itkProcessObject.h>

namespace bone
{
/** \class ContourTilingMeshSource
 * \brief Tiles a stack of nested contours into a layered, conforming tetrahedral mesh (paper 2.2 to 2.6).
 *
 * Input: a ContourStack (mm, LPS), its contours simple and nested. Optional input "DensityImage": the CT, which the
 * metrics `density` and `combined` read along the edges they choose from (trilinear; outside the image an edge costs
 * its length alone). Output: a mesh with region per tetrahedron, layer and slice per point, face neighbours, no
 * density.
 *
 * Parameters:
 * - Metric: `combined` (default: span length plus density deviation / 500; without a density image span length alone),
 *   `span`, `area`, `volume` or `density` (paper 2.3); or an object of your own by SetMetricObject.
 *
 * The method, its ways out where a slab cannot be knitted, and what it reports: \ref TileContours, \ref TilingReport.
 * The mesh is valid or the update throws itk::ExceptionObject naming slice and contour. The result does not depend on
 * the number of threads.
 *
 * \tparam TContourStack type of the stack
 * \tparam TMesh type of the mesh */
template <typename TContourStack = ContourStack, typename TMesh = DensityMesh<double>>
class ContourTilingMeshSource : public itk::ProcessObject
{
public:
  ITK_DISALLOW_COPY_AND_MOVE(ContourTilingMeshSource);
  using Self = ContourTilingMeshSource;
  using Superclass = itk::ProcessObject;
  using Pointer = itk::SmartPointer<Self>;
  using ConstPointer = itk::SmartPointer<const Self>;
  itkNewMacro(Self);
  itkTypeMacro(ContourTilingMeshSource, itk::ProcessObject);

  using ContourStackType = TContourStack;
  using MeshType = TMesh;
  using DensityImageType = itk::Image<float, 3>;

  using Superclass::SetInput;
  /** The contours. */
  void
  SetInput(const TContourStack * stack);
  const TContourStack *
  GetInput() const;

  /** The CT for the metrics that look at density; may be null. */
  void
  SetDensityImage(const DensityImageType * image);
  const DensityImageType *
  GetDensityImage() const;

  /** Name of the metric. Default "combined". */
  itkSetStringMacro(Metric);
  itkGetStringMacro(Metric);

  /** A metric of your own in place of a named one; null goes back to the name. */
  void
  SetMetricObject(std::shared_ptr<const TilingMetric> metric);

  /** Correspondence of pieces in some slabs; null (default) leaves all to overlap and distance. What was used is in the
   * report. */
  void
  SetCorrespondence(std::shared_ptr<const ContourCorrespondence> correspondence);

  TMesh *
  GetOutput();
  const TMesh *
  GetOutput() const;

  /** What the last update met. */
  const TilingReport &
  GetReport() const
  {
    return m_Report;
  }

  using Superclass::MakeOutput;
  itk::DataObject::Pointer MakeOutput(DataObjectPointerArraySizeType) override;

protected:
  ContourTilingMeshSource();
  ~ContourTilingMeshSource() override = default;
  void
  VerifyPreconditions() ITKv5_CONST override;
  /** A mesh takes no information from contours. */
  void
  GenerateOutputInformation() override
  {}
  void
  GenerateInputRequestedRegion() override;
  void
  GenerateData() override;
  void
  PrintSelf(std::ostream & os, itk::Indent indent) const override;

private:
  DensitySampler
  MakeSampler() const;

  std::string                                  m_Metric{ "combined" };
  std::shared_ptr<const TilingMetric>          m_MetricObject;
  std::shared_ptr<const ContourCorrespondence> m_Correspondence;
  TilingReport                                 m_Report;
};
} // namespace bone

#ifndef ITK_MANUAL_INSTANTIATION
#include "boneContourTilingMeshSource.hxx"
#endif

#endif
