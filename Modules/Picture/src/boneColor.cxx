/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneColor.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace bone
{
namespace
{
/** The map's colours at even distances. */
const std::vector<Color> &
Stops(ColorMap map)
{
  static const std::vector<Color> grey = { { { 0, 0, 0 } }, { { 255, 255, 255 } } };
  static const std::vector<Color> sequential = { { { 68, 1, 84 } },    { { 72, 40, 120 } },  { { 62, 74, 137 } },
                                                 { { 49, 104, 142 } }, { { 38, 130, 142 } }, { { 31, 158, 137 } },
                                                 { { 53, 183, 121 } }, { { 109, 205, 89 } }, { { 180, 222, 44 } },
                                                 { { 253, 231, 37 } } };
  static const std::vector<Color> diverging = { { { 5, 48, 97 } },     { { 33, 102, 172 } },  { { 67, 147, 195 } },
                                                { { 146, 197, 222 } }, { { 209, 229, 240 } }, { { 247, 247, 247 } },
                                                { { 253, 219, 199 } }, { { 244, 165, 130 } }, { { 214, 96, 77 } },
                                                { { 178, 24, 43 } },   { { 103, 0, 31 } } };
  return map == ColorMap::Grey ? grey : map == ColorMap::Sequential ? sequential : diverging;
}
} // namespace

Color
MapColor(ColorMap map, double share)
{
  const auto & stops = Stops(map);
  const double at = (share > 0.0 ? std::min(share, 1.0) : 0.0) * static_cast<double>(stops.size() - 1);
  const auto   first = std::min(static_cast<std::size_t>(at), stops.size() - 2);
  const double rest = at - static_cast<double>(first);
  Color        color;
  for (std::size_t i = 0; i < 3; ++i)
  {
    color[i] = static_cast<unsigned char>(std::lround((1.0 - rest) * stops[first][i] + rest * stops[first + 1][i]));
  }
  return color;
}

Color
MapColor(ColorMap map, double value, const Window & window)
{
  const double width = window.upper - window.lower;
  return MapColor(map, width > 0.0 ? (value - window.lower) / width : 0.0);
}

Color
SeriesColor(std::size_t k)
{
  static const std::array<Color, 7> colors = { { { { 0, 114, 178 } },
                                                 { { 213, 94, 0 } },
                                                 { { 0, 158, 115 } },
                                                 { { 204, 121, 167 } },
                                                 { { 86, 180, 233 } },
                                                 { { 230, 159, 0 } },
                                                 { { 60, 60, 60 } } } };
  return colors[k % colors.size()];
}

const std::array<ContourStyle, 5> &
ContourStyles()
{
  // Of the set by Okabe and Ito.
  static const std::array<ContourStyle, 5> styles = { { { "periosteal", { { 213, 94, 0 } } },
                                                        { "endosteal", { { 240, 228, 66 } } },
                                                        { "medullary", { { 86, 180, 233 } } },
                                                        { "hole", { { 204, 121, 167 } } },
                                                        { "medial axis", { { 0, 158, 115 } } } } };
  return styles;
}

ContourKind
KindOf(const Contour & contour)
{
  if (contour.axis)
  {
    return ContourKind::MedialAxis;
  }
  if (contour.region == Region::Outside)
  {
    return ContourKind::Hole;
  }
  return contour.layer == 0   ? ContourKind::Periosteal
         : contour.layer == 1 ? ContourKind::Endosteal
                              : ContourKind::Medullary;
}

const ContourStyle &
StyleOf(const Contour & contour)
{
  return ContourStyles()[static_cast<std::size_t>(KindOf(contour))];
}
} // namespace bone
