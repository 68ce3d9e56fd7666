/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneSurfaceAudit_h
#define boneSurfaceAudit_h

#include "boneMeshValidator.h"

#include <map>

namespace bone
{
/** Points of the boundary of the regions from `least` inward at which its faces do not form a single fan. */
inline int
PinchedPoints(const MeshArrays & mesh, int least)
{
  std::map<IdType, std::map<IdType, IdType>> links;
  std::map<IdType, std::size_t>              faces;
  for (const auto & face : BoundaryFaces(mesh, least))
  {
    for (int k = 0; k < 3; ++k)
    {
      links[face[k]][face[(k + 1) % 3]] = face[(k + 2) % 3];
      ++faces[face[k]];
    }
  }
  int pinched = 0;
  for (const auto & [point, next] : links)
  {
    std::size_t length = 0;
    auto        here = next.begin();
    do
    {
      here = next.find(here->second);
      ++length;
    } while (here != next.end() && here != next.begin() && length <= faces[point]);
    pinched += here == next.end() || length != faces[point];
  }
  return pinched;
}
} // namespace bone

#endif
