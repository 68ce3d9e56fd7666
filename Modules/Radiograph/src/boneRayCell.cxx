/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneRayCell.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace bone
{
bool
AffineBarycentric::Set(const Vector3 & a, const Vector3 & b, const Vector3 & c, const Vector3 & d)
{
  const Vector3 u = b - a, v = c - a, w = d - a;
  const double  volume = u.cross(v).dot(w);
  if (!(std::abs(volume) > 0))
  {
    return false;
  }
  gradient.row(1) = v.cross(w).transpose() / volume;
  gradient.row(2) = w.cross(u).transpose() / volume;
  gradient.row(3) = u.cross(v).transpose() / volume;
  gradient.row(0) = -(gradient.row(1) + gradient.row(2) + gradient.row(3));
  constant = -gradient * a;
  constant[0] += 1;
  return constant.allFinite() && gradient.allFinite();
}

CellLines
RestrictToRays(const RayFrame & frame, const AffineBarycentric & mu)
{
  CellLines lines;
  for (int i = 0; i < 4; ++i)
  {
    lines[i] = frame.Restrict(mu.constant[i], mu.gradient.row(i).transpose());
  }
  return lines;
}

void
ColumnRun::Keep(double constant, double perColumn)
{
  if (perColumn > 0)
  {
    first = std::max(first, -constant / perColumn);
  }
  else if (perColumn < 0)
  {
    last = std::min(last, -constant / perColumn);
  }
  else if (!(constant >= 0))
  {
    last = -std::numeric_limits<double>::infinity(); // and stays there, wherever `first` is
  }
}
} // namespace bone
