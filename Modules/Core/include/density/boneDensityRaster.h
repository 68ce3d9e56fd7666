/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneDensityRaster_h
#define boneDensityRaster_h

#include "boneBernstein.h"
#include "boneMeshArrays.h"
#include "boneVoxelGrid.h"

#include <vector>

namespace bone
{
/** \class DensityRaster
 * \brief Values of a density model at the voxel centres of a grid, slice by slice.
 *
 * Tetrahedra are cut into the rows of voxels they meet, so that nothing is searched for. A voxel centre on a face
 * shared by several tetrahedra (to about 1e-10 of their size) takes the one of lowest id; no centre inside the body is
 * left out. Flat and inverted tetrahedra are left out. Slices are independent: const use is safe from many threads. */
class DensityRaster
{
public:
  /** Keeps a reference to the mesh. Throws std::invalid_argument where the mesh holds no density or the grid's axes are
   * singular. */
  DensityRaster(const MeshArrays & mesh, const VoxelGrid & grid);

  /** Writes slice k: values[j * size[0] + i], `outside` where no tetrahedron is. `cells`, unless null, takes the
   * tetrahedron's id, or -1. */
  void
  FillSlice(int k, double outside, double * values, IdType * cells = nullptr) const;

private:
  /** In index coordinates: mu_1..3 = inverse (index - origin). */
  struct Cell
  {
    Eigen::Matrix3d inverse;
    Vector3         origin;
    double          tolerance;
    int             firstRow, lastRow;
  };

  void
  FillRow(IdType t, int j, int k, double * values, IdType * cells) const;

  const MeshArrays &       m_Mesh;
  VoxelGrid                m_Grid;
  std::vector<Cell>        m_Cells;
  std::vector<std::size_t> m_Start; // of each slice's tetrahedra in m_List
  std::vector<IdType>      m_List;  // ids, descending within a slice: the lowest one writes last
};
} // namespace bone

#endif
