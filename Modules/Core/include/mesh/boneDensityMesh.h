/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneDensityMesh_h
#define boneDensityMesh_h

#include "boneMeshArrays.h"

#include <itkDefaultStaticMeshTraits.h>
#include <itkPointSet.h>

namespace bone
{
/** \class DensityMesh
 * \brief Layered tetrahedral mesh with a Bernstein polynomial density in every tetrahedron (paper 2 and 3).
 *
 * Points are those of the itk::PointSet it derives from, so ITK's point-set metrics and transforms take it as it is.
 * Cells are flat arrays with O(1) face neighbours (paper 2); itk::Mesh with its heap object per cell is reached by
 * conversion (module IO). Attributes and their meaning: \ref MeshArrays.
 *
 * \tparam TCoordinate coordinate type, double (default) or float. */
template <typename TCoordinate = double>
class DensityMesh
  : public itk::PointSet<TCoordinate, 3, itk::DefaultStaticMeshTraits<TCoordinate, 3, 3, TCoordinate, TCoordinate>>
{
public:
  ITK_DISALLOW_COPY_AND_MOVE(DensityMesh);
  using Self = DensityMesh;
  using Superclass =
    itk::PointSet<TCoordinate, 3, itk::DefaultStaticMeshTraits<TCoordinate, 3, 3, TCoordinate, TCoordinate>>;
  using Pointer = itk::SmartPointer<Self>;
  using ConstPointer = itk::SmartPointer<const Self>;
  itkNewMacro(Self);
  itkTypeMacro(DensityMesh, itk::PointSet);

  using CoordinateType = TCoordinate;
  using PointType = typename Superclass::PointType;

  /** Replaces the whole content. Face neighbours are computed where `arrays.neighbors` is empty. Throws
   * itk::ExceptionObject where an array has the wrong length or an id is out of range. */
  void
  SetArrays(MeshArrays arrays);

  /** The whole content as plain arrays, points in double. A copy. */
  MeshArrays
  GetArrays() const;

  /** All but the points, without a copy. */
  itkGetConstReferenceMacro(Cells, MeshCells);

  IdType
  GetNumberOfTetrahedra() const
  {
    return static_cast<IdType>(m_Cells.tetrahedra.size());
  }
  const std::vector<Id4> &
  GetTetrahedra() const
  {
    return m_Cells.tetrahedra;
  }
  const std::vector<Id4> &
  GetFaceNeighbors() const
  {
    return m_Cells.neighbors;
  }

  /** A mesh is always whole: there are no regions of it to be asked for. */
  bool
  RequestedRegionIsOutsideOfTheBufferedRegion() override
  {
    return false;
  }

  void
  Initialize() override;
  void
  Graft(const itk::DataObject * data) override;

protected:
  DensityMesh() = default;
  ~DensityMesh() override = default;
  void
  PrintSelf(std::ostream & os, itk::Indent indent) const override;

private:
  MeshCells m_Cells;
};
} // namespace bone

#ifndef ITK_MANUAL_INSTANTIATION
#include "boneDensityMesh.hxx"
#endif

#endif
