/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneFigure.h"

#include "boneTicks.h"

#include <algorithm>
#include <cmath>

namespace bone
{
namespace
{
constexpr double Margin = 12.0;      // about the figure and between its panels
constexpr double TitleRow = 22.0;    // above a panel
constexpr double ScaleRow = 20.0;    // below a panel
constexpr double ColorBarRow = 34.0; // below a panel
constexpr double HeadingRow = 28.0;  // above a section
constexpr double LegendRow = 24.0;
constexpr double NoteRow = 20.0;
constexpr double LeastColorBar = 150.0; // that its numbers and unit find room
constexpr double LargestColorBar = 240.0;

const Color     Ink{ { 32, 32, 32 } };
const TextStyle TitleStyle{ 12.0, Ink };
const TextStyle SmallStyle{ 11.0, Ink };
const TextStyle HeadingStyle{ 15.0, Ink, TextAlign::Left, TextHeight::Baseline, true };

bool
HasScaleBar(const PanelStyle & style)
{
  return style.pixelSize.minCoeff() > 0.0;
}

std::string
ScaleText(const PanelCell & cell)
{
  const std::string length = TickText(ScaleBarLength(cell.panel, cell.style)) + " mm";
  return cell.style.scaleNote.empty() ? length : length + " " + cell.style.scaleNote;
}

/** Pixels of the scale bar. */
double
ScaleBarPixels(const PanelCell & cell)
{
  return ScaleBarLength(cell.panel, cell.style) / cell.style.pixelSize.x() * ShownSize(cell.panel, cell.style).x() /
         cell.panel.columns;
}

Vector2
CellSize(const PanelCell & cell)
{
  if (cell.panel.columns <= 0)
  {
    return Vector2::Zero();
  }
  const PanelStyle & style = cell.style;
  Vector2            size = ShownSize(cell.panel, style);
  if (!style.title.empty())
  {
    size.x() = std::max(size.x(), Canvas::MeasureText(style.title, TitleStyle));
    size.y() += TitleRow;
  }
  if (HasScaleBar(style))
  {
    size.x() = std::max(size.x(), ScaleBarPixels(cell) + 6.0 + Canvas::MeasureText(ScaleText(cell), SmallStyle));
    size.y() += ScaleRow;
  }
  if (style.colorBar)
  {
    size.x() = std::max(size.x(), LeastColorBar);
    size.y() += ColorBarRow;
  }
  return size;
}

void
DrawLetters(Canvas & canvas, const Rectangle & place, const SideLetters & letters)
{
  constexpr double in = 5.0;
  const Vector2    middle(place.x + 0.5 * place.width, place.y + 0.5 * place.height);
  TextStyle        style{ 14.0, { { 255, 255, 255 } }, TextAlign::Left, TextHeight::Middle, true, true };
  canvas.DrawText({ place.x + in, middle.y() }, letters.left, style);
  style.align = TextAlign::Right;
  canvas.DrawText({ place.x + place.width - in, middle.y() }, letters.right, style);
  style.align = TextAlign::Centre;
  style.height = TextHeight::Top;
  canvas.DrawText({ middle.x(), place.y + in }, letters.top, style);
  style.height = TextHeight::Baseline;
  canvas.DrawText({ middle.x(), place.y + place.height - in }, letters.bottom, style);
}

void
DrawScaleBar(Canvas & canvas, const Vector2 & corner, const PanelCell & cell)
{
  const double length = ScaleBarPixels(cell);
  const double y = corner.y() + 10.0;
  canvas.DrawLine({ corner.x(), y }, { corner.x() + length, y }, Ink);
  for (const double x : { corner.x() + 0.5, corner.x() + length - 0.5 })
  {
    canvas.DrawLine({ x, y - 4.0 }, { x, y + 4.0 }, Ink, 1.0);
  }
  TextStyle style = SmallStyle;
  style.height = TextHeight::Middle;
  canvas.DrawText({ corner.x() + length + 6.0, y }, ScaleText(cell), style);
}

void
DrawColorBar(Canvas & canvas, const Vector2 & corner, double width, const PanelStyle & style)
{
  constexpr int    steps = 64;
  constexpr double height = 10.0;
  const Window &   window = style.window;
  Panel            colors{ steps, 1, {} };
  for (int k = 0; k < steps; ++k)
  {
    colors.values.push_back(static_cast<float>((k + 0.5) / steps));
  }
  const double y = corner.y() + 6.0;
  canvas.FillRectangle({ corner.x() - 0.5, y - 0.5, width + 1.0, height + 1.0 }, Ink);
  canvas.DrawPanel({ corner.x(), y, width, height }, colors, { 0.0, 1.0 }, style.map);
  const std::string plus = style.map == ColorMap::Diverging && window.upper > 0.0 ? "+" : "";
  TextStyle         text = SmallStyle;
  text.height = TextHeight::Top;
  canvas.DrawText({ corner.x(), y + height + 5.0 }, TickText(window.lower), text);
  text.align = TextAlign::Centre;
  canvas.DrawText({ corner.x() + 0.5 * width, y + height + 5.0 }, style.unit, text);
  text.align = TextAlign::Right;
  canvas.DrawText({ corner.x() + width, y + height + 5.0 }, plus + TickText(window.upper), text);
}

void
DrawCell(Canvas & canvas, Vector2 corner, double width, const PanelCell & cell)
{
  if (cell.panel.columns <= 0)
  {
    return;
  }
  const PanelStyle & style = cell.style;
  const Vector2      size = ShownSize(cell.panel, style);
  if (!style.title.empty())
  {
    canvas.DrawText({ corner.x(), corner.y() + 15.0 }, style.title, TitleStyle);
    corner.y() += TitleRow;
  }
  const Rectangle     place{ corner.x(), corner.y(), size.x(), size.y() };
  const unsigned char nothing = style.map == ColorMap::Grey ? 24 : 72;
  canvas.FillRectangle(place, { { nothing, nothing, nothing } });
  canvas.DrawPanel(place, cell.panel, style.window, style.map);
  if (cell.overlay)
  {
    cell.overlay(canvas, place);
  }
  DrawLetters(canvas, place, style.letters);
  corner.y() += size.y();
  if (HasScaleBar(style))
  {
    DrawScaleBar(canvas, corner, cell);
    corner.y() += ScaleRow;
  }
  if (style.colorBar)
  {
    DrawColorBar(canvas, corner, std::min(width, LargestColorBar), style);
  }
}

/** Widths of a section's columns, and heights of its rows. */
struct Grid
{
  std::vector<double> widths;
  std::vector<double> heights;
};

Grid
LayOut(const FigureSection & section)
{
  Grid grid;
  for (const auto & row : section.rows)
  {
    grid.widths.resize(std::max(grid.widths.size(), row.size()), 0.0);
    grid.heights.push_back(0.0);
    for (std::size_t c = 0; c < row.size(); ++c)
    {
      const Vector2 size = CellSize(row[c]);
      grid.widths[c] = std::max(grid.widths[c], size.x());
      grid.heights.back() = std::max(grid.heights.back(), size.y());
    }
  }
  return grid;
}

double
Sum(const std::vector<double> & sizes)
{
  double sum = 0.0;
  for (const double size : sizes)
  {
    sum += size > 0.0 ? size + Margin : 0.0;
  }
  return sum;
}

constexpr double Swatch = 26.0; // of the legend's lines

double
LegendWidth(const std::vector<ContourStyle> & legend)
{
  double width = Margin;
  for (const ContourStyle & entry : legend)
  {
    width += Swatch + 6.0 + Canvas::MeasureText(entry.name, TitleStyle) + 18.0;
  }
  return width;
}

void
DrawLegend(Canvas & canvas, const Vector2 & corner, const std::vector<ContourStyle> & legend)
{
  TextStyle style = TitleStyle;
  style.height = TextHeight::Middle;
  double       x = corner.x();
  const double y = corner.y() + 0.5 * LegendRow;
  for (const ContourStyle & entry : legend)
  {
    // As on a panel: bright colours do not show on white.
    canvas.FillRectangle({ x, y - 7.0, Swatch, 14.0 }, { { 24, 24, 24 } });
    canvas.DrawLine({ x + 4.0, y }, { x + Swatch - 4.0, y }, entry.color, 2.5);
    canvas.DrawText({ x + Swatch + 6.0, y }, entry.name, style);
    x += Swatch + 6.0 + Canvas::MeasureText(entry.name, TitleStyle) + 18.0;
  }
}

void
DrawSection(Canvas & canvas, const FigureSection & section, const Grid & grid, double y)
{
  if (!section.title.empty())
  {
    canvas.DrawText({ Margin, y + 17.0 }, section.title, HeadingStyle);
    y += HeadingRow;
  }
  for (std::size_t r = 0; r < section.rows.size(); ++r)
  {
    double x = Margin;
    for (std::size_t c = 0; c < section.rows[r].size(); ++c)
    {
      DrawCell(canvas, { x, y }, grid.widths[c], section.rows[r][c]);
      x += grid.widths[c] + Margin;
    }
    y += grid.heights[r] + Margin;
  }
}
} // namespace

Vector2
ShownSize(const Panel & panel, const PanelStyle & style)
{
  const Vector2 pixel = HasScaleBar(style) ? Vector2(style.pixelSize / style.pixelSize.minCoeff()) : Vector2(1.0, 1.0);
  return { std::round(style.zoom * panel.columns * pixel.x()), std::round(style.zoom * panel.rows * pixel.y()) };
}

double
ScaleBarLength(const Panel & panel, const PanelStyle & style)
{
  return HasScaleBar(style) ? NiceLength(0.4 * panel.columns * style.pixelSize.x()) : 0.0;
}

Canvas
DrawFigure(const Figure & figure)
{
  std::vector<Grid> grids;
  double            width = 0.0;
  double            height = Margin;
  for (const FigureSection & section : figure.sections)
  {
    grids.push_back(LayOut(section));
    width = std::max({ width, Sum(grids.back().widths), Canvas::MeasureText(section.title, HeadingStyle) + Margin });
    height += Sum(grids.back().heights) + (section.title.empty() ? 0.0 : HeadingRow);
  }
  const double legend = figure.legend.empty() ? 0.0 : LegendRow;
  const double note = figure.note.empty() ? 0.0 : NoteRow;
  width = std::max({ width, LegendWidth(figure.legend), Canvas::MeasureText(figure.note, SmallStyle) + Margin });

  Canvas canvas(std::ceil(width + Margin), std::ceil(height + legend + note + (legend + note > 0.0 ? 8.0 : 0.0)));
  double y = Margin;
  for (std::size_t i = 0; i < figure.sections.size(); ++i)
  {
    const FigureSection & section = figure.sections[i];
    DrawSection(canvas, section, grids[i], y);
    y += Sum(grids[i].heights) + (section.title.empty() ? 0.0 : HeadingRow);
  }
  DrawLegend(canvas, { Margin, y }, figure.legend);
  canvas.DrawText({ Margin, y + legend + 12.0 }, figure.note, SmallStyle);
  return canvas;
}
} // namespace bone
