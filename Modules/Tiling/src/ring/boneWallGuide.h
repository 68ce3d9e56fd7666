/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneWallGuide_h
#define boneWallGuide_h

#include "boneTilingTypes.h"
#include "boneTriangleTree.h"

#include <unordered_map>

namespace bone
{
namespace tiling
{
/** \brief Where the wall between the outer walks of two slices should run.
 *
 * That is where the signed distances to the two contours, interpolated over the height, are zero (shape-based
 * interpolation, S. P. Raya & J. K. Udupa, doi:10.1109/42.52980). A wall that leans as a whole runs elsewhere: it is
 * also as it should be where that holds once both contours have been moved to the middle of their centroids' way. Of a
 * walk the edges that are walked both ways (bridges, axes) bound nothing and do not count. Not for many threads. */
class WallGuide
{
public:
  WallGuide(const VertexPool & pool, const Walk & lower, const Walk & upper);

  /** Distance, mm, of the middle of the edge between vertex `below` of the lower walk and `above` of the upper one from
   * where the wall should run, to first order; 0 where a walk encloses nothing. */
  double
  Departure(int below, int above) const;

  /** What a wall's edge may depart: a share of the slices' distance and the contours' mean step, as walls between
   * coarser contours can follow the bone less closely. */
  double
  GetLimit() const
  {
    return m_Limit;
  }

private:
  struct Contour
  {
    Contour(const VertexPool & pool, const Walk & walk);

    /** Negative inside. */
    double
    SignedDistance(const Vector2 & q) const;

    TriangleTree                        segments;
    std::vector<std::array<Vector2, 3>> normals; ///< outward, of each segment, its first and its second end
    Vector2                             centroid{ Vector2::Zero() };
    double                              step{ 0.0 }; ///< mean length of the segments
  };

  const VertexPool &                                m_Pool;
  Contour                                           m_Lower, m_Upper;
  double                                            m_Height{ 0.0 }, m_Limit{ 0.0 };
  mutable std::unordered_map<std::uint64_t, double> m_Departures; ///< that were asked for
};
} // namespace tiling
} // namespace bone

#endif
