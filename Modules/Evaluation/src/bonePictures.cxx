/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "bonePictures.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace bone
{
namespace
{
void
DrawContours(Canvas &             canvas,
             const Rectangle &    place,
             const Panel &        panel,
             const PlaneView &    view,
             const ContourSlice & slice)
{
  for (const Contour & contour : slice.contours)
  {
    std::vector<Vector2> points;
    for (const Vector3 & p : contour.points)
    {
      points.push_back(PanelPoint(place, panel, view.Project(p)));
    }
    canvas.DrawPolyline(points, StyleOf(contour).color, 1.8, !contour.axis, &place);
  }
}

/** Model minus reference; NaN where both are 0. */
Panel
Difference(const Panel & model, const Panel & reference)
{
  Panel difference = model;
  for (std::size_t k = 0; k < difference.values.size(); ++k)
  {
    difference.values[k] -= reference.values[k];
    if (model.values[k] == 0.0F && reference.values[k] == 0.0F)
    {
      difference.values[k] = std::nanf("");
    }
  }
  return difference;
}

/** Four levels at most beside one another: the models, and below them their differences. The reference is in the first
 * column of the first group alone. */
std::vector<std::vector<PanelCell>>
ComparisonRows(const Comparison & comparison)
{
  constexpr std::size_t               across = 4;
  std::vector<std::vector<PanelCell>> rows;
  PanelStyle                          style;
  style.letters = comparison.letters;
  style.pixelSize = comparison.pixelSize;
  style.scaleNote = comparison.scaleNote;
  style.unit = comparison.unit;
  for (std::size_t i = 0; i < comparison.levels.size(); ++i)
  {
    const LevelPanel & level = comparison.levels[i];
    style.window = comparison.window;
    style.map = ColorMap::Grey;
    if (i % across == 0)
    {
      rows.resize(rows.size() + 2);
      PanelCell first;
      if (i == 0)
      {
        style.title = comparison.referenceName;
        style.colorBar = true;
        first = { comparison.reference, style, {} };
        style.colorBar = false;
      }
      rows[rows.size() - 2].push_back(first);
      rows.back().emplace_back();
    }
    style.title = level.name;
    rows[rows.size() - 2].push_back({ level.panel, style, {} });
    style.title = level.name + " \u2212 " + comparison.referenceName;
    style.window = { -comparison.scale, comparison.scale };
    style.map = ColorMap::Diverging;
    style.colorBar = true;
    rows.back().push_back({ Difference(level.panel, comparison.reference), style, {} });
    style.colorBar = false;
  }
  return rows;
}
} // namespace

Canvas
DrawSlices(const CTImage *           ct,
           const ContourStack *      stack,
           const Window &            window,
           const std::string &       unit,
           const itk::ImageBase<3> * whole)
{
  constexpr std::size_t most = 6, across = 3;
  const auto &          slices = stack->GetSlices();
  const Vector3 &       normal = stack->GetNormal();
  std::vector<Vector3>  points;
  for (const ContourSlice & slice : slices)
  {
    for (const Contour & contour : slice.contours)
    {
      points.insert(points.end(), contour.points.begin(), contour.points.end());
    }
  }
  if (points.empty())
  {
    throw std::invalid_argument("The slices cannot be drawn: the stack has no contours");
  }
  PlaneView     view = FramePlane(normal, slices.front().origin, points, 5.0, 380);
  const Vector3 flatCorner = view.corner - view.corner.dot(normal) * normal;

  Figure                 figure;
  std::vector<PanelCell> cells;
  const std::size_t      count = std::min(most, slices.size());
  for (std::size_t i = 0; i < count; ++i)
  {
    const std::size_t k = (2 * i + 1) * slices.size() / (2 * count);
    view.corner = flatCorner + stack->GetHeight(k) * normal;
    PanelCell cell;
    cell.panel = SamplePlane(ct, view);
    cell.style.title = DescribeSlice(whole != nullptr ? whole : ct, normal, slices[k].origin);
    cell.style.letters = view.Letters();
    cell.style.pixelSize = Vector2::Constant(view.pixel);
    cell.style.window = window;
    cell.style.unit = unit;
    cell.style.colorBar = i == (count - 1) / across * across;
    cell.overlay = [panel = Panel{ view.columns, view.rows, {} }, view, slice = &slices[k]](
                     Canvas & canvas, const Rectangle & place) { DrawContours(canvas, place, panel, view, *slice); };
    cells.push_back(std::move(cell));
  }
  figure.sections.emplace_back();
  for (std::size_t i = 0; i < count; i += across)
  {
    const auto first = cells.begin() + static_cast<std::ptrdiff_t>(i);
    figure.sections[0].rows.emplace_back(first,
                                         cells.begin() + static_cast<std::ptrdiff_t>(std::min(i + across, count)));
  }
  figure.legend.assign(ContourStyles().begin(), ContourStyles().end());
  figure.note = "CT slices are counted from 0, in the order of the file; coordinates are LPS.";
  return DrawFigure(figure);
}

Canvas
DrawComparison(const std::vector<Comparison> & comparisons)
{
  Figure figure;
  for (const Comparison & comparison : comparisons)
  {
    figure.sections.push_back({ comparison.title, ComparisonRows(comparison) });
  }
  return DrawFigure(figure);
}
} // namespace bone
