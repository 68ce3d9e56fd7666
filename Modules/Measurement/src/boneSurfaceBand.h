/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneSurfaceBand_h
#define boneSurfaceBand_h

#include "boneCorticalThickness.h"
#include "boneTriangleDistance.h"

#include <unordered_map>
#include <vector>

namespace bone
{
/** \class SurfaceBand
 * \brief The voxels near a closed surface by the nearest point (foot) on it, which is on none of its flat cuts. Voxels
 * outside the bone beyond a cut are left out. */
class SurfaceBand
{
public:
  /** Voxels from `outside` mm outside the surface to `inside` mm below it. `cut`: of each triangle, whether it is part
   * of a flat cut. `radius`: that of Collect. `ct` must outlive this. Throws std::invalid_argument where there are no
   * voxels, or one is not finite. */
  SurfaceBand(const TriangleSurface &   surface,
              const std::vector<bool> & cut,
              const CTVoxels &          ct,
              double                    outside,
              double                    inside,
              double                    radius,
              const Execution &         execution);

  /** The voxels whose foot lies within the radius of a point of the surface, with their distance to the surface as
   * depth. Under a ridge these end where its sides meet, though the bone goes on: deeper ones are those within the
   * radius of the inward normal, with their depth along it, as far as half the way through the bone. */
  std::vector<CorticalSample>
  Collect(const Vector3 & x, const Vector3 & inward) const;

private:
  struct Voxel
  {
    Vector3        foot;
    CorticalSample sample;
  };

  void
  CollectFeet(const Vector3 & x, std::vector<CorticalSample> & samples) const;
  void
  CollectAlong(const Vector3 & x, const Vector3 & inward, double from, double to, std::vector<CorticalSample> & samples)
    const;

  /** Half the way from a point of the surface through the bone, at most `m_Inside`. */
  double
  HalfWay(const Vector3 & x, const Vector3 & inward) const;

  std::uint64_t
  CellOf(const Vector3 & x, int i, int j, int k) const;

  const CTVoxels &                                    m_CT;
  TriangleDistance                                    m_Whole;
  double                                              m_Inside;
  double                                              m_Radius;
  std::vector<Voxel>                                  m_Voxels;
  std::unordered_map<std::uint64_t, std::vector<int>> m_Cells; ///< cubes of side `radius`
};
} // namespace bone

#endif
