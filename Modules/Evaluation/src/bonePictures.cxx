/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "bonePictures.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

namespace bone
{
namespace
{
constexpr int Gap = 8;
constexpr int Caption = 24;
constexpr int CaptionWidth = 228; // of 19 characters

void
DrawContours(Canvas & canvas, const Vector2 & corner, const PlaneView & view, const ContourSlice & slice)
{
  for (const Contour & contour : slice.contours)
  {
    const std::size_t count = contour.points.size();
    const std::size_t lines = contour.axis ? count - std::min<std::size_t>(count, 1) : count;
    for (std::size_t i = 0; i < lines; ++i)
    {
      canvas.DrawLine(corner + view.Project(contour.points[i]),
                      corner + view.Project(contour.points[(i + 1) % count]),
                      StyleOf(contour).color);
    }
  }
}

std::string
Rounded(double value)
{
  std::ostringstream text;
  text << std::fixed << std::setprecision(std::abs(value) < 10.0 ? 1 : 0) << value;
  return text.str();
}
} // namespace

PictureImage::Pointer
DrawSlices(const CTImage * ct, const ContourStack * stack, const Window & window)
{
  constexpr int        columns = 3;
  constexpr int        rows = 2;
  const auto &         slices = stack->GetSlices();
  std::vector<Vector3> points;
  for (const ContourSlice & slice : slices)
  {
    for (const Contour & contour : slice.contours)
    {
      points.insert(points.end(), contour.points.begin(), contour.points.end());
    }
  }
  PlaneView     view = FramePlane(stack->GetNormal(), slices.front().origin, points, 5.0, 380);
  Canvas        canvas(columns * (view.columns + Gap) + Gap, rows * (view.rows + Caption + Gap) + Gap);
  const Vector3 flatCorner = view.corner - view.corner.dot(stack->GetNormal()) * stack->GetNormal();
  for (int i = 0; i < columns * rows; ++i)
  {
    const auto k = static_cast<std::size_t>((i + 0.5) / (columns * rows) * static_cast<double>(slices.size()));
    const int  column = Gap + i % columns * (view.columns + Gap);
    const int  row = Gap + i / columns * (view.rows + Caption + Gap);
    view.corner = flatCorner + stack->GetHeight(k) * stack->GetNormal();
    canvas.DrawText(Vector2(column, row + 16),
                    "slice " + std::to_string(k) + ", " + Rounded(stack->GetHeight(k)) + " mm");
    canvas.DrawPanel(column, row + Caption, SamplePlane(ct, view), window);
    DrawContours(canvas, Vector2(column, row + Caption), view, slices[k]);
  }
  return canvas.GetImage();
}

PictureImage::Pointer
DrawComparison(const Panel &                   reference,
               const std::string &             referenceName,
               const std::vector<LevelPanel> & levels,
               const Window &                  window,
               double                          scale)
{
  const int width = std::max(reference.columns, CaptionWidth) + Gap;
  const int height = reference.rows + Caption + Gap;
  Canvas    canvas(3 * width + Gap, static_cast<int>(levels.size()) * height + Gap);
  for (std::size_t i = 0; i < levels.size(); ++i)
  {
    const Panel & model = levels[i].panel;
    const int     row = Gap + static_cast<int>(i) * height;
    Panel         difference = model;
    for (std::size_t k = 0; k < difference.values.size(); ++k)
    {
      difference.values[k] -= reference.values[k];
      if (model.values[k] == 0.0F && reference.values[k] == 0.0F)
      {
        difference.values[k] = std::nanf(""); // beside the bone on a radiograph
      }
    }
    canvas.DrawText(Vector2(Gap, row + 16), referenceName);
    canvas.DrawPanel(Gap, row + Caption, reference, window);
    canvas.DrawText(Vector2(Gap + width, row + 16), levels[i].name);
    canvas.DrawPanel(Gap + width, row + Caption, model, window);
    canvas.DrawText(Vector2(Gap + 2 * width, row + 16), "model - CT, +-" + Rounded(scale));
    canvas.DrawPanel(Gap + 2 * width, row + Caption, difference, { -scale, scale }, ColorMap::Diverging);
  }
  return canvas.GetImage();
}
} // namespace bone
