/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneVoxelFaces_h
#define boneVoxelFaces_h

#include "boneImageIO.h"
#include "bonePlacement.h"

#include <array>
#include <vector>

namespace bone
{
/** \class VoxelFaces
 * \brief The surface of a mask: the faces between voxels that are 0 and voxels that are not, those at the image's
 * border included.
 *
 * A byte a voxel. The nearest face is looked for in shells of voxels about the point, so that a search takes time that
 * goes with the third power of the distance in voxels. The image's axes are at right angles. */
class VoxelFaces
{
public:
  explicit VoxelFaces(const LabelImage * mask);

  /** Of the point to the nearest face, mm; infinity where there is none. */
  double
  Distance(const Vector3 & x) const;

  /** The middles of all faces, in the order of voxels. */
  std::vector<Vector3>
  GetCentres() const;

private:
  using Cell = std::array<long, 3>;

  /** The nearest of a cell's faces, squared. \param q  on the grid, mm. */
  double
  SquaredDistanceInCell(const Vector3 & q, const Cell & cell, unsigned char faces) const;

  Placement                  m_Place;
  Placement                  m_ToGrid;
  Vector3                    m_Spacing{ Vector3::Ones() };
  Cell                       m_Size{}; ///< of cells: a voxel is a cell, and there is one more before the first
  std::vector<unsigned char> m_Faces;  ///< bit d: the face between this cell and the next along axis d
  bool                       m_IsEmpty{ true };
};
} // namespace bone

#endif
