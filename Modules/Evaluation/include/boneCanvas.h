/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneCanvas_h
#define boneCanvas_h

#include "boneImageIO.h"
#include "boneTypes.h"

#include <string>
#include <vector>

namespace bone
{
/** Red, green, blue. */
using Color = std::array<unsigned char, 3>;

/** A grey picture before it has a window: values row by row. */
struct Panel
{
  int                columns{ 0 };
  int                rows{ 0 };
  std::vector<float> values; ///< NaN: nothing there

  float &
  At(int column, int row)
  {
    return values[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column)];
  }
};

/** Values shown as black and white. */
struct Window
{
  double lower{ 0.0 };
  double upper{ 1.0 };
};

/** \class Canvas
 * \brief A picture to draw on. Pixel (0, 0) is the upper left one; what falls outside is cut off. */
class Canvas
{
public:
  Canvas(int columns, int rows, const Color & background = { { 24, 24, 24 } });

  /** Grey values of a panel with its upper left corner at (column, row); NaN leaves the background. */
  void
  DrawPanel(int column, int row, const Panel & panel, const Window & window);
  /** The same in colours: blue below, white at, red above 0; full colour at +-scale. */
  void
  DrawDifference(int column, int row, const Panel & panel, double scale);
  /** A line between two points in pixels, two pixels wide. */
  void
  DrawLine(const Vector2 & a, const Vector2 & b, const Color & color);
  /** Capital letters, digits and . , : - + = % / ( ), 7 pixels high and 6 wide, magnified; other characters are blanks.
   */
  void
  DrawText(int                 column,
           int                 row,
           const std::string & text,
           int                 magnification = 2,
           const Color &       color = { { 235, 235, 235 } });

  PictureImage::Pointer
  GetImage() const
  {
    return m_Image;
  }

private:
  void
  Set(int column, int row, const Color & color);

  PictureImage::Pointer m_Image;
  int                   m_Columns;
  int                   m_Rows;
};
} // namespace bone

#endif
