/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSeeds.h"

#include "boneTriangleDistance.h"

#include <algorithm>
#include <sstream>

namespace bone
{
std::vector<double>
PointAreas(const TriangleSurface & surface)
{
  std::vector<double> areas(surface.points.size(), 0.0);
  for (const auto & t : surface.triangles)
  {
    const Vector3 & a = surface.points[t[0]];
    const double    area = 0.5 * (surface.points[t[1]] - a).cross(surface.points[t[2]] - a).norm();
    for (const IdType id : t)
    {
      areas[id] += area / 3.0;
    }
  }
  return areas;
}

SurfaceSeeds::SurfaceSeeds(const TriangleSurface & closed, const std::vector<Landmark> & landmarks, double farthest)
  : surface(closed)
  , areas(PointAreas(closed))
  , m_Farthest(farthest)
{
  const TriangleDistance distance(closed.points, closed.triangles);
  for (const Landmark & landmark : landmarks)
  {
    const double beyond = std::max(distance.FindNearest(landmark.point).distance, 0.0);
    m_Seeds.insert({ landmark.name, { landmark.point, beyond } });
  }
}

const Vector3 &
SurfaceSeeds::Find(const std::string & name) const
{
  const auto found = m_Seeds.find(name);
  if (found == m_Seeds.end())
  {
    throw MissingSeed("landmark " + name + " is missing");
  }
  if (!(found->second.distance <= m_Farthest))
  {
    std::ostringstream text;
    text << "landmark " << name << " lies " << found->second.distance
         << " mm beyond the bone: that part of it is not there, or the landmark is of another space";
    throw MissingSeed(text.str());
  }
  return found->second.point;
}
} // namespace bone
