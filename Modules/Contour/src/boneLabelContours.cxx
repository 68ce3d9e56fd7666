/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneLabelContours.h"

#include <cmath>

namespace bone
{
namespace
{
double
TotalArea(const std::vector<Polygon> & contours)
{
  double area = 0.0;
  for (const Polygon & contour : contours)
  {
    area += SignedArea(contour);
  }
  return area;
}
} // namespace

std::vector<BonePiece>
ContoursOfLabel(const LabelField & label,
                const PlaneGrid &  grid,
                const Vector3 &    u,
                const Vector3 &    v,
                double             height,
                double             minimumArea,
                int &              dropped)
{
  const double wanted = label.LabelArea(grid, u, v, height);
  if (!(wanted > 0.0))
  {
    return {};
  }
  const PlaneField     field = label.SamplePlane(grid, u, v, height);
  std::vector<Polygon> contours = ExtractLevelContours(field, 0.0);
  double               low = -0.35 * grid.spacing.minCoeff(); // encloses too much
  double               high = -low;                           // encloses too little
  double               level = 0.0;
  double               area = TotalArea(contours);
  for (int step = 0; step < 12 && std::abs(area - wanted) > 1e-3 * wanted; ++step)
  {
    (area > wanted ? low : high) = level;
    level = 0.5 * (low + high);
    contours = ExtractLevelContours(field, level);
    area = TotalArea(contours);
  }
  return GroupPieces(std::move(contours), minimumArea, dropped);
}
} // namespace bone
