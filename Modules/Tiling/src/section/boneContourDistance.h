/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneContourDistance_h
#define boneContourDistance_h

#include "boneTriangleTree.h"
#include "boneTypes.h"

#include <vector>

namespace bone
{
namespace tiling
{
/** Distance to a closed contour in the plane, negative inside. */
class ContourDistance
{
public:
  /** \param move  added to the contour's points */
  ContourDistance(const std::vector<Vector2> & polygon, const Vector2 & move);

  double
  At(const Vector2 & q) const;

private:
  std::vector<Vector2> m_Polygon;
  TriangleTree         m_Segments;
};
} // namespace tiling
} // namespace bone

#endif
