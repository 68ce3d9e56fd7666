/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneFigure_h
#define boneFigure_h

#include "bonePlaneView.h"

#include <functional>
#include <string>
#include <vector>

namespace bone
{
/** How a panel of a figure is shown and what stands about it. */
struct PanelStyle
{
  std::string title;             ///< above it; empty: none
  SideLetters letters;           ///< at its sides; empty ones are left out
  Vector2     pixelSize{ 0, 0 }; ///< of a column and a row, mm; 0: square pixels and no scale bar
  std::string scaleNote;         ///< after the scale bar's length: where it holds
  Window      window;            ///< values of the first and the last colour
  ColorMap    map{ ColorMap::Grey };
  bool        colorBar{ false }; ///< below it: the colours, their range and unit
  std::string unit;              ///< of the values
  double      zoom{ 1.0 };       ///< canvas pixels for the smaller side of a panel's pixel
};

/** A panel of a figure; without columns: an empty place. */
struct PanelCell
{
  Panel      panel;
  PanelStyle style;
  /** Draws over the panel, whose outer edges it is told; may be empty. */
  std::function<void(Canvas &, const Rectangle &)> overlay;
};

/** Rows of panels under a heading. */
struct FigureSection
{
  std::string                         title; ///< empty: none
  std::vector<std::vector<PanelCell>> rows;
};

/** Panels with all that a reader needs beside them. */
struct Figure
{
  std::vector<FigureSection> sections; ///< below one another
  std::vector<ContourStyle>  legend;   ///< lines drawn over the panels
  std::string                note;     ///< a line at the end; empty: none
};

/** \brief The figure, just as large as its panels and texts need; dark text on white.
 *
 * Each panel has its title above and its letters inside at the middle of its four sides; below it a scale bar of a
 * 1-2-5 length, and the colours' bar. Voxels that are not square are shown at their true aspect. Places with NaN are
 * dark grey. */
Canvas
DrawFigure(const Figure & figure);

/** Size of a panel on the canvas: at least a canvas pixel for each of its pixels, at their true aspect, times the zoom.
 */
Vector2
ShownSize(const Panel & panel, const PanelStyle & style);

/** Length (mm) of the scale bar of a panel: the largest 1-2-5 length of at most two fifths of its width; 0 without one.
 */
double
ScaleBarLength(const Panel & panel, const PanelStyle & style);
} // namespace bone

#endif
