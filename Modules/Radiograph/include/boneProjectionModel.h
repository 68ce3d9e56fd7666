/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneProjectionModel_h
#define boneProjectionModel_h

#include "boneLargeArray.h"
#include "boneMeshRadiograph.h"

#include <cstdint>
#include <vector>

namespace bone
{
/** \class ProjectionModel
 * \brief The parts of a density model that ProjectMesh needs and that do not depend on the view.
 *
 * Its tetrahedra of each degree lie in blocks of eight that are near each other: vertices in double, polynomials of
 * what is integrated in single precision, expanded about the centroids, a block's numbers one beside the other. About
 * 200 bytes a tetrahedron of degree 3. */
class ProjectionModel
{
public:
  /** Of the mesh with these points (mm; `cells.points` is not looked at), which must hold a density and, as the cells,
   * must outlive the model: see \ref MeshRadiograph. Without `keep` only the blocks are formed, and filled for each
   * radiograph anew: less work where there is but one. */
  ProjectionModel(const std::vector<Vector3> &     points,
                  const MeshCells &                cells,
                  const MeshRadiographParameters & parameters,
                  const Execution &                execution,
                  bool                             keep = true);

  /** The tetrahedra of one degree. */
  struct Blocks
  {
    static constexpr int size = 8;
    static constexpr int verticesSize = 12 * size; ///< numbers a block

    int                       degree{ 0 };
    std::vector<std::int32_t> cells;        ///< of each block; -1 after the last one of all
    std::vector<Vector3>      centres;      ///< of each block's bounding box
    std::vector<Vector3>      halfSizes;    ///< the box's
    LargeArray<double>        vertices;     ///< of each block: 4 vertices, 3 coordinates (mm), tetrahedra
    LargeArray<float>         coefficients; ///< of each block: see projection::BlockRun

    std::size_t
    Count() const
    {
      return centres.size();
    }
    std::size_t
    CoefficientsSize() const; ///< numbers a block, the largest magnitude with them
    bool
    IsKept() const
    {
      return !vertices.empty();
    }
  };

  const std::vector<Blocks> &
  ByDegree() const
  {
    return m_Blocks;
  }
  /** Writes a block's vertices and coefficients. */
  void
  Fill(const Blocks & blocks, std::size_t block, double * vertices, float * coefficients) const;

  const std::vector<Vector3> &
  Points() const
  {
    return m_Points;
  }
  const MeshCells &
  Cells() const
  {
    return m_Cells;
  }
  const MeshRadiographParameters &
  Parameters() const
  {
    return m_Parameters;
  }

private:
  void
  SetCells(const std::vector<std::int32_t> & sorted);
  void
  SetBox(Blocks & blocks, std::size_t block) const;

  const std::vector<Vector3> & m_Points;
  const MeshCells &            m_Cells;
  MeshRadiographParameters     m_Parameters;
  std::vector<Blocks>          m_Blocks;
};

/** ProjectMesh for a model that is kept, see \ref MeshRadiograph. */
void
ProjectMesh(const ProjectionModel &                 model,
            const std::vector<XRayGeometry::View> & views,
            const Execution &                       execution,
            const std::vector<float *> &            images);
} // namespace bone

#endif
