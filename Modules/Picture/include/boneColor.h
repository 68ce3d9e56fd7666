/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneColor_h
#define boneColor_h

#include "boneContourStack.h"

#include <array>
#include <string>

namespace bone
{
/** Red, green, blue. */
using Color = std::array<unsigned char, 3>;

/** Values shown as the first and the last colour of a map. */
struct Window
{
  double lower{ 0.0 };
  double upper{ 1.0 };
};

/** How values become colours; all can be told apart by colour-blind readers. */
enum class ColorMap
{
  Grey,       ///< black to white
  Sequential, ///< viridis: dark blue to yellow
  Diverging   ///< ColorBrewer's RdBu: blue below, white at, red above the middle
};

/** The colour at `share` of the way from the first to the last one; clamped to 0..1, NaN is 0. */
Color
MapColor(ColorMap map, double share);

/** The colour of a value in a window; the first one where the window is empty. */
Color
MapColor(ColorMap map, double value, const Window & window);

/** Color `k` of a set for lines and markers on white that colour-blind readers can tell apart (Okabe and Ito); it
 * begins again after seven. */
Color
SeriesColor(std::size_t k);

/** What a line on a picture means, and its colour. */
struct ContourStyle
{
  std::string name;
  Color       color;
};

/** The kinds of contours, outside in. */
enum class ContourKind : std::size_t
{
  Periosteal,
  Endosteal,
  Medullary,
  Hole,
  MedialAxis
};

/** Name and colour of each kind of contour, in the order of ContourKind; every picture and page asks here. */
const std::array<ContourStyle, 5> &
ContourStyles();

/** The kind of a contour: by its axis, its region (a hole), else its layer. */
ContourKind
KindOf(const Contour & contour);

/** Name and colour of a contour's kind. */
const ContourStyle &
StyleOf(const Contour & contour);
} // namespace bone

#endif
