/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneVolumeKeeper_h
#define boneVolumeKeeper_h

#include "bonePointMover.h"

#include <functional>
#include <map>

namespace bone
{
/** \class VolumeKeeper
 * \brief Gives the regions back the volumes that they had.
 *
 * Smoothing and coarser triangles take a little off whatever is convex. For the boundary and each interface, the volume
 * within it is compared with that of the mesh at construction, and its points are moved along their normals by the
 * difference over the surface's area. Points of curves, corners and flat cuts stay. */
class VolumeKeeper
{
public:
  explicit VolumeKeeper(const TetraComplex & complex);

  /** Whether a point of a surface may be at x. */
  using Limit = std::function<bool(IdType p, const Vector3 & x)>;

  /** Moves surface points, no angle below that of `cosineFloor` and below what it was, and each only where \a limit (if
   * any) allows. */
  void
  Restore(TetraComplex & complex, PointMover & mover, double cosineFloor, const Limit & limit = {}) const;

private:
  /** Volume of all cells of a region of at least the key. */
  static std::map<int, double>
  VolumesWithin(const TetraComplex & complex);

  std::map<int, double> m_Volumes;
};
} // namespace bone

#endif
