/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSeeds.h"

#include "boneTriangleDistance.h"

#include <algorithm>
#include <sstream>

namespace bone
{
SurfaceSeeds::SurfaceSeeds(const TriangleSurface & closed, const std::vector<Landmark> & landmarks, double farthest)
  : surface(closed)
  , m_Farthest(farthest)
{
  for (const auto & t : closed.triangles)
  {
    const Vector3 &a = closed.points[t[0]], &b = closed.points[t[1]], &c = closed.points[t[2]];
    middles.insert(middles.end(), { 0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a) });
    areas.insert(areas.end(), 3, (b - a).cross(c - a).norm() / 6.0);
  }
  const TriangleDistance distance(closed.points, closed.triangles);
  for (const Landmark & landmark : landmarks)
  {
    const double beyond = std::max(distance.FindNearest(landmark.point).distance, 0.0);
    m_Seeds.insert({ landmark.name, { landmark.point, beyond } });
  }
}

const Vector3 &
SurfaceSeeds::Find(const std::string & name, double beyond) const
{
  const auto found = m_Seeds.find(name);
  if (found == m_Seeds.end())
  {
    throw MissingSeed("landmark " + name + " is missing");
  }
  if (!(found->second.distance <= m_Farthest + beyond))
  {
    std::ostringstream text;
    text << "landmark " << name << " lies " << found->second.distance
         << " mm beyond the bone: that part of it is not there, or the landmark is of another space";
    throw MissingSeed(text.str());
  }
  return found->second.point;
}
} // namespace bone
