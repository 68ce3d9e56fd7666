/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneAngleMerit_h
#define boneAngleMerit_h

#include "boneAngleGoal.h"
#include "boneRegionVolumes.h"
#include "boneSurfaceTarget.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace bone
{
/** \class AngleMerit
 * \brief What a coarse level is worth to finite elements: the sum that an \ref AngleRelaxation raises.
 *
 * Of each cell, its smallest dihedral angle up to 45 degrees, rad, less f times the share of 1.03 floors that it is
 * below these, f the weight of floors. From the sum of these is taken
 * - for each region, 50 sqrt(f) (c / b)^2, c the change of its volume from the finest level's and b the bound on it,
 * - w times the mean over all surfaces of (d / 0.025 e)^2, d the distance to the finest level's surface, looked at in
 *   three places of each triangle, e the mean length of the boundary's edges, w the weight of surfaces.
 * So angles, volumes and surfaces are one measure, in which a little of one may be given for much of another. */
class AngleMerit
{
public:
  /** \param finest, volumes  of the finest level; must live as long as this. */
  AngleMerit(const SurfaceTarget & finest,
             const RegionVolumes & volumes,
             const AngleGoal &     goal,
             const TetraComplex &  complex);

  void
  SetWeights(double surfaces, double floors)
  {
    m_SurfaceWeight = surfaces;
    m_FloorWeight = floors;
  }

  /** Takes note of the volumes as they are. */
  void
  NoteVolumes(const TetraComplex & complex)
  {
    m_Changes = m_Volumes.ChangesTo(complex);
  }
  /** The volumes have changed by so much more. */
  void
  AddToVolumes(const std::vector<double> & changes);

  /** Largest cosine of a dihedral angle that a cell of a region may get, where the largest there is `worst`. */
  double
  LargestCosine(int region, double worst) const
  {
    return std::max(worst, std::cos(m_Least.Of(region)));
  }
  /** Of a cell of a region by the cosine of its smallest dihedral angle. */
  double
  OfCell(double cosine, int region) const;
  /** No cell is worth more than this. */
  static double
  LargestOfCell();
  /** What is gained where the regions' volumes change by so much more. */
  double
  OfVolumes(const std::vector<double> & changes) const;
  /** Of a triangle of a surface; negative. */
  double
  OfTriangle(int surface, const std::array<Vector3, 3> & corners) const;
  /** Of a triangle's area, mm^2, times a squared distance, mm^2. */
  double
  OfDistance(double areaTimesSquared) const
  {
    return -m_SurfaceWeight * m_SurfaceScale * areaTimesSquared;
  }

  const RegionVolumes &
  Volumes() const
  {
    return m_Volumes;
  }
  const SurfaceTarget &
  Finest() const
  {
    return m_Finest;
  }

private:
  const SurfaceTarget & m_Finest;
  const RegionVolumes & m_Volumes;
  AngleFloors           m_Floors;
  AngleFloors           m_Least;
  std::vector<double>   m_Bounds;  ///< of the regions' changes, mm^3
  std::vector<double>   m_Changes; ///< of the regions, mm^3
  double                m_SurfaceWeight{ 0.0 };
  double                m_FloorWeight{ 1.0 };
  double                m_SurfaceScale; ///< 1 / (whole area (0.025 e)^2), mm^-4
};

/** Three places of a triangle, each two thirds of the way from the opposite edge to a corner, stand for it. */
constexpr double NearCorner = 2.0 / 3.0, FarCorner = 1.0 / 6.0;
} // namespace bone

#endif
