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

  struct Parameters
  {
    double cosineFloor{ 1.0 }; ///< no angle below that of this and below what it was
    double slack{ 0.0 };       ///< share of the smaller region beside a surface by which its volume may differ
    Limit  limit{};            ///< none: points may go anywhere
  };

  /** Moves surface points until what each surface encloses is as large as it was, but for the slack. */
  void
  Restore(TetraComplex & complex, PointMover & mover, const Parameters & parameters) const;

private:
  /** Volume of all cells of a region of at least the key. */
  static std::map<int, double>
  VolumesWithin(const TetraComplex & complex);

  std::map<int, double> m_Volumes;
};
} // namespace bone

#endif
