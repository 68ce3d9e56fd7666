/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneLabelContours.h"

#include <algorithm>
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

constexpr double LevelRange = 0.35; // of the grid's spacing

// A label seen in a plane.
struct LabelPlane
{
  const LabelField & label;
  const PlaneField & field;
  Vector3            u;
  Vector3            v;
  double             height;

  // Area of the label, or (for a hole) of what is not the label, in the box around a contour.
  double
  AreaAbout(const Polygon & contour, bool hole) const
  {
    const PlaneGrid box = CoveringGrid({ contour }, 0.0, field.grid.origin, field.grid.spacing);
    const double    area = label.LabelArea(box, u, v, height);
    return hole ? static_cast<double>(box.Count()) * box.spacing.x() * box.spacing.y() - area : area;
  }
};

// The contour around a point, alone, at a level; empty where it is merged with another or there is none.
Polygon
ContourAlone(const PlaneField & field, double level, const Polygon & seed, const std::vector<Polygon> & others)
{
  for (Polygon & contour : ExtractLevelContours(field, level))
  {
    if ((SignedArea(contour) < 0.0) != (SignedArea(seed) < 0.0) || !PointInPolygon(seed[0], contour))
    {
      continue;
    }
    for (const Polygon & other : others)
    {
      if (other[0] != seed[0] && PointInPolygon(other[0], contour))
      {
        return {};
      }
    }
    return std::move(contour);
  }
  return {};
}

// Adds the contours of level 0 that vanished at the level of the right area.
void
BringBackVanished(const std::vector<Polygon> & atZero, std::vector<Polygon> & contours)
{
  const std::size_t count = contours.size();
  for (const Polygon & lost : atZero)
  {
    const bool vanished = std::none_of(
      contours.begin(), contours.begin() + static_cast<std::ptrdiff_t>(count), [&lost](const Polygon & contour) {
        return (SignedArea(contour) < 0.0) == (SignedArea(lost) < 0.0) && PolygonsOverlap(lost, contour);
      });
    if (vanished)
    {
      contours.push_back(lost);
    }
  }
}

// Removes contours whose label's area is below `minimumArea`; returns how many. A voxel or two alone, or a hole of that
// size, is smoothed to a fraction of its area and gets a level of its own.
int
SettleSmall(const LabelPlane & plane, double level, double minimumArea, std::vector<Polygon> & contours)
{
  const std::vector<Polygon> before = contours;
  int                        dropped = 0;
  for (std::size_t c = 0; c < contours.size(); ++c)
  {
    if (std::abs(SignedArea(contours[c])) >= minimumArea)
    {
      continue;
    }
    const bool hole = SignedArea(contours[c]) < 0.0;
    double     tight = hole ? std::max(level, 0.0) : std::min(level, 0.0);
    double     wide = tight;
    Polygon    best;
    for (double factor = 2.0; factor > 0.3 && best.empty(); factor *= 0.7)
    {
      wide = tight + (hole ? factor : -factor) * LevelRange * plane.field.grid.spacing.minCoeff();
      best = ContourAlone(plane.field, wide, before[c], before);
    }
    if (best.empty()) // it would merge with another at once
    {
      wide = tight;
      best = before[c];
    }
    const double wanted = plane.AreaAbout(best, hole);
    if (wanted < minimumArea)
    {
      contours[c].clear();
      ++dropped;
      continue;
    }
    for (int step = 0; step < 8; ++step)
    {
      const double middle = 0.5 * (tight + wide);
      Polygon      contour = ContourAlone(plane.field, middle, before[c], before);
      const double area = contour.empty() ? 0.0 : std::abs(SignedArea(contour));
      (area < wanted ? tight : wide) = middle;
      if (area >= wanted)
      {
        best = std::move(contour);
      }
    }
    contours[c] = std::move(best);
  }
  contours.erase(
    std::remove_if(contours.begin(), contours.end(), [](const Polygon & contour) { return contour.empty(); }),
    contours.end());
  return dropped;
}
} // namespace

std::vector<SectionPiece>
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
  const auto           atZero = contours;
  double               low = -LevelRange * grid.spacing.minCoeff(); // encloses too much
  double               high = -low;                                 // encloses too little
  double               level = 0.0;
  double               area = TotalArea(contours);
  for (int step = 0; step < 12 && std::abs(area - wanted) > 1e-3 * wanted; ++step)
  {
    (area > wanted ? low : high) = level;
    level = 0.5 * (low + high);
    contours = ExtractLevelContours(field, level);
    area = TotalArea(contours);
  }
  BringBackVanished(atZero, contours);
  dropped += SettleSmall({ label, field, u, v, height }, level, minimumArea, contours);
  return GroupPieces(std::move(contours), 0.0, dropped);
}
} // namespace bone
