/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneMedialAxisFilter.h"

#include "boneMedialAxis.h"

#include <algorithm>

namespace bone
{
ContourSlice
MedialAxisFilter::MakeSlice(const ContourStack & input, std::size_t k)
{
  const ContourSlice & slice = input.GetSlices()[k];
  MedialAxisParameters parameters = m_Parameters;
  const double         height = input.GetHeight(k);
  ContourSlice         result;
  result.origin = slice.origin;
  int                  nextId = 0;
  std::vector<Polygon> polygons;
  for (const Contour & contour : slice.contours)
  {
    if (!contour.axis)
    {
      nextId = std::max(nextId, contour.id + 1);
      result.contours.push_back(contour);
      polygons.emplace_back();
      for (const Vector3 & point : contour.points)
      {
        polygons.back().push_back(input.ToPlane(point));
      }
    }
  }
  const std::vector<int> around = FindPolygonsAround(polygons);
  for (std::size_t c = 0; c < polygons.size(); ++c)
  {
    const Contour        contour = result.contours[c];
    std::vector<Polygon> border(1, polygons[c]);
    bool                 innermost = contour.region != Region::Outside;
    for (std::size_t other = 0; other < polygons.size() && innermost; ++other)
    {
      if (around[other] == static_cast<int>(c))
      {
        border.push_back(polygons[other]);
        innermost = result.contours[other].region == Region::Outside;
      }
    }
    if (!innermost)
    {
      continue;
    }
    double length = 0.0;
    for (std::size_t i = 0; i < polygons[c].size(); ++i)
    {
      length += (polygons[c][(i + 1) % polygons[c].size()] - polygons[c][i]).norm();
    }
    parameters.spacing =
      m_Parameters.spacing > 0.0 ? m_Parameters.spacing : length / static_cast<double>(polygons[c].size());
    for (AxisBranch & branch : ComputeMedialAxis(border, parameters))
    {
      Contour axis;
      axis.axis = true;
      axis.layer = contour.layer + 1;
      axis.region = contour.region;
      axis.id = nextId++;
      axis.clearance = std::move(branch.clearance);
      for (const Vector2 & q : branch.points)
      {
        axis.points.push_back(input.FromPlane(q, height));
      }
      result.contours.push_back(std::move(axis));
    }
  }
  return result;
}
} // namespace bone
