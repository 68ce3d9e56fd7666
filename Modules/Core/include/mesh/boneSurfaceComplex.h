/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneSurfaceComplex_h
#define boneSurfaceComplex_h

#include "boneMeshArrays.h"

#include <limits>
#include <vector>

namespace bone
{
/** \struct SurfaceComplex
 * \brief The surfaces of a layered mesh: its boundary, the interfaces between regions, and the curves where they meet.
 *
 * Outside the body counts as one more region. A face between two regions is a surface face; faces with the same pair of
 * regions are one surface. Flat cuts (where the image cut the bone) are surfaces of their own, so that their rims are
 * curves. The dimension of a point is that of the smallest stratum it lies in: it may be moved within, or collapsed
 * along, its stratum alone, and then layers, interfaces and rims are kept. */
struct SurfaceComplex
{
  static constexpr int OutsideRegion = std::numeric_limits<int>::min();

  struct Surface
  {
    int outer{ OutsideRegion }; ///< the smaller region number, OutsideRegion at the boundary of the body
    int inner{ 0 };             ///< the larger region number
    int flat{ -1 };             ///< number of the flat cut, -1 elsewhere

    bool
    IsBoundary() const
    {
      return outer == OutsideRegion;
    }
  };

  std::vector<Surface>             surfaces;
  std::vector<Id4>                 faceSurface; ///< #t, surface of the face opposite vertex i, -1 for none
  std::vector<std::uint8_t>        dimension;   ///< #p, 3 within a region, 2 on a surface, 1 on a curve, 0 a corner
  std::vector<std::vector<IdType>> curve;       ///< #p, neighbours along curves, ascending; two where dimension is 1
};

/** \brief Finds surfaces, curves and corners.
 *
 * A flat cut is an edge-connected set of at least three boundary faces in one plane that has the whole body on one
 * side, and from whose rim the boundary turns away by 30 degrees or more on average. The tolerance of "in one plane" is
 * 1e-6 of the body's extent. A surface edge is a curve where other than two faces meet or their surfaces differ.
 *
 * Needs neighbors; without regions all cells are one region. Throws std::invalid_argument without neighbors. O(n log
 * n).
 */
SurfaceComplex
FindSurfaces(const MeshArrays & mesh);
} // namespace bone

#endif
