/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneAngleMerit.h"

#include <algorithm>
#include <cmath>

namespace bone
{
namespace
{
constexpr double Cap = 0.7853981633974483; ///< of angles, rad: a quarter of a right angle is enough for any cell
constexpr double AboveFloor = 1.03;
constexpr double VolumeWeight = 50.0;
constexpr double DistanceUnit = 0.025; ///< of the boundary's mean edge
constexpr double LeastVolumeBound = 1e-4;

/** Of all surfaces, interfaces once, mm^2. */
double
SurfaceArea(const TetraComplex & complex)
{
  const auto & p = complex.Points();
  double       area = 0.0;
  for (IdType t = 0; t < complex.Size(); ++t)
  {
    for (int i = 0; i < 4 && complex.IsAlive(t); ++i)
    {
      if (complex.Carries(t, i))
      {
        const Id4 &     c = complex.Cell(t);
        const Vector3 & a = p[c[TetraFaces[i][0]]];
        area += 0.5 * (p[c[TetraFaces[i][1]]] - a).cross(p[c[TetraFaces[i][2]]] - a).norm();
      }
    }
  }
  return area;
}
} // namespace

AngleMerit::AngleMerit(const SurfaceTarget & finest,
                       const RegionVolumes & volumes,
                       const AngleGoal &     goal,
                       const TetraComplex &  complex)
  : m_Finest(finest)
  , m_Volumes(volumes)
  , m_Floors(goal.floors)
  , m_Least(goal.least)
{
  for (std::size_t r = 0; r < volumes.Size(); ++r)
  {
    m_Bounds.push_back(std::max(goal.volumeChange, LeastVolumeBound) * volumes[r]);
  }
  const double unit = DistanceUnit * MeanBoundaryEdge(complex);
  m_SurfaceScale = 1.0 / (SurfaceArea(complex) * unit * unit);
  this->NoteVolumes(complex);
}

void
AngleMerit::AddToVolumes(const std::vector<double> & changes)
{
  for (std::size_t r = 0; r < changes.size(); ++r)
  {
    m_Changes[r] += changes[r];
  }
}

double
AngleMerit::LargestOfCell()
{
  return Cap;
}

double
AngleMerit::OfCell(double cosine, int region) const
{
  const double angle = std::acos(cosine), floor = AboveFloor * m_Floors.Of(region);
  return std::min(angle, Cap) - (angle < floor ? m_FloorWeight * (floor - angle) / floor : 0.0);
}

double
AngleMerit::OfVolumes(const std::vector<double> & changes) const
{
  double merit = 0.0;
  for (std::size_t r = 0; r < changes.size(); ++r)
  {
    const double now = m_Changes[r] / m_Bounds[r], then = (m_Changes[r] + changes[r]) / m_Bounds[r];
    merit += VolumeWeight * std::sqrt(m_FloorWeight) * (now * now - then * then);
  }
  return merit;
}

double
AngleMerit::OfTriangle(int surface, const std::array<Vector3, 3> & corners) const
{
  const Vector3 sum = corners[0] + corners[1] + corners[2];
  double        squared = 0.0;
  for (const Vector3 & corner : corners)
  {
    const Vector3 y = FarCorner * sum + (NearCorner - FarCorner) * corner;
    squared += (m_Finest.Nearest(surface, y) - y).squaredNorm() / 3.0;
  }
  const double area = 0.5 * (corners[1] - corners[0]).cross(corners[2] - corners[0]).norm();
  return this->OfDistance(area * squared);
}
} // namespace bone
