/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneMeshQualityFilter_h
#define boneMeshQualityFilter_h

#include "boneMeshImprovement.h"
#include "boneMeshToMeshFilter.h"

#include <itkImage.h>

namespace bone
{
/** \class MeshQualityFilter
 * \brief Makes a tiled mesh fit for computing by rounds of smoothing, swaps and optimisation (paper 2.7).
 *
 * Boundary and interfaces are faired by at most DistanceBound; then each round smooths inner points, adds and removes
 * points inside regions until cells grow from the surfaces inward by Gradation, swaps faces and edges, and improves the
 * worst cells: flips of surface edges, edge collapses, and a pattern search for their points. Each of these raises
 * the smallest dihedral angle of what it touches. In the end boundary and interfaces are fitted to the first ones, with
 * a resistance to bending, and regions get their volumes back. A valid mesh stays valid, flat cuts flat, layers what
 * they are.
 *
 * Surfaces stay within DistanceBound of the first ones and these within DistanceBound of them, as measured at the
 * corners, centroid and three more points of each triangle; where no change within it mends a cell with an angle below
 * 10 degrees, within 1.5 times that. Within SliverFactor times that where the angle is below 5 degrees, and where
 * surfaces are fitted, as contours that the mesh has left out may be that far from it.
 *
 * Optional input "Contours": what the mesh was tiled from, best before slices were left out and contours resampled.
 * Surfaces are then fitted to the contours, and their edges flipped where that brings contours closer or lowers the
 * dihedral deviation.
 *
 * Optional input "LabelImage", on any grid: the bone, as voxels. The boundary is fitted to the outline of `Label` too,
 * most of all between slices, where there are no contours; where it passes the centre of a voxel on the wrong side by
 * less than a sixteenth of a voxel, it is moved to the right one.
 *
 * The numbers of cells and points change. A point that was added within region r has layer r, as a medial axis there,
 * and the slice of a neighbour. The result does not depend on the number of threads. Parameters: \ref
 * MeshQualityParameters. Errors: \ref MeshToMeshFilter. */
template <typename TMesh = DensityMesh<double>, typename TLabelImage = itk::Image<short, 3>>
class MeshQualityFilter : public MeshToMeshFilter<TMesh>
{
public:
  ITK_DISALLOW_COPY_AND_MOVE(MeshQualityFilter);
  using Self = MeshQualityFilter;
  using Superclass = MeshToMeshFilter<TMesh>;
  using Pointer = itk::SmartPointer<Self>;
  using ConstPointer = itk::SmartPointer<const Self>;
  itkNewMacro(Self);
  itkTypeMacro(MeshQualityFilter, MeshToMeshFilter);

  using LabelImageType = TLabelImage;
  static_assert(TLabelImage::ImageDimension == 3, "MeshQualityFilter needs a three-dimensional label image");

  itkSetInputMacro(Contours, ContourStack);
  itkGetInputMacro(Contours, ContourStack);
  itkSetInputMacro(LabelImage, TLabelImage);
  itkGetInputMacro(LabelImage, TLabelImage);

  BONE_PLAIN_FILTER_PARAMETERS(MeshQualityParameters, BONE_MESH_QUALITY_PARAMETERS)

  /** What the last run did. */
  itkGetConstReferenceMacro(Report, ImprovementReport);

protected:
  MeshQualityFilter()
  {
    this->AddOptionalInputName("Contours");
    this->AddOptionalInputName("LabelImage");
  }
  ~MeshQualityFilter() override = default;
  void
  Improve(TetraComplex & complex, const Execution & execution) override;

private:
  ImprovementReport m_Report;
};

extern template class MeshQualityFilter<DensityMesh<double>>;
} // namespace bone

#ifndef ITK_MANUAL_INSTANTIATION
#include "boneMeshQualityFilter.hxx"
#endif

#endif
