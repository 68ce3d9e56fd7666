/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneTestSurfaces_h
#define boneTestSurfaces_h

#include "boneTriangleDistance.h"

#include <algorithm>
#include <vector>

/** Closed triangle surfaces for tests. */
namespace bone::test
{
struct Shape
{
  std::vector<Vector3>                    points;
  std::vector<TriangleDistance::Triangle> triangles;
};

inline Shape
Box(const Vector3 & half)
{
  Shape s;
  for (int i = 0; i < 8; ++i)
  {
    s.points.push_back(half.cwiseProduct(Vector3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1)));
  }
  s.triangles = {
    { { 0, 2, 1 } }, { { 1, 2, 3 } }, { { 4, 5, 6 } }, { { 5, 7, 6 } }, { { 0, 1, 4 } }, { { 1, 5, 4 } },
    { { 2, 6, 3 } }, { { 3, 6, 7 } }, { { 0, 4, 2 } }, { { 2, 4, 6 } }, { { 1, 3, 5 } }, { { 3, 7, 5 } }
  };
  return s;
}

/** Signed distance to that box. */
inline double
BoxDistance(const Vector3 & x, const Vector3 & half)
{
  const Vector3 q = x.cwiseAbs() - half;
  return q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0);
}

} // namespace bone::test

#endif
