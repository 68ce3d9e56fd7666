/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneCanvas_h
#define boneCanvas_h

#include "boneColor.h"
#include "boneImageIO.h"
#include "boneTypes.h"

#include <memory>
#include <string>
#include <vector>

namespace bone
{
/** Values of a picture before they have colours, row by row from the upper left one. */
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

/** A place on a canvas, pixels. */
struct Rectangle
{
  double x{ 0.0 };
  double y{ 0.0 };
  double width{ 0.0 };
  double height{ 0.0 };
};

/** Where a text stands, from its anchor. */
enum class TextAlign
{
  Left, ///< begins at the anchor
  Centre,
  Right ///< ends at the anchor
};

enum class TextHeight
{
  Baseline,
  Middle, ///< of capital letters
  Top     ///< of capital letters
};

struct TextStyle
{
  double     size{ 13.0 }; ///< pixels
  Color      color{ { 32, 32, 32 } };
  TextAlign  align{ TextAlign::Left };
  TextHeight height{ TextHeight::Baseline };
  bool       bold{ false };
  bool       halo{ false };   ///< black about the letters, to be read on any grey
  bool       upward{ false }; ///< turned a quarter anticlockwise about the anchor
};

/** \class Canvas
 * \brief A picture to draw on, which becomes pixels or vectors when it is done.
 *
 * Places are in pixels at scale 1, x to the right and y downwards from the upper left corner; the pixel in column c and
 * row r covers c..c+1 by r..r+1. What falls outside is cut off. Text is UTF-8 in DejaVu Sans, or in the sans-serif that
 * there is; bytes that are no UTF-8 become question marks. A canvas that was moved from can only be assigned to. */
class Canvas
{
public:
  /** Throws std::invalid_argument where a size is not positive. */
  explicit Canvas(double width = 1.0, double height = 1.0, const Color & background = { { 255, 255, 255 } });
  Canvas(Canvas && other) noexcept;
  Canvas &
  operator=(Canvas && other) noexcept;
  ~Canvas();

  /** At scale 1, pixels. */
  double
  GetWidth() const
  {
    return m_Width;
  }
  double
  GetHeight() const
  {
    return m_Height;
  }

  /** A panel's values in colours, its outer edges those of the place; NaN leaves what is there. */
  void
  DrawPanel(const Rectangle & place, const Panel & panel, const Window & window, ColorMap map = ColorMap::Grey);
  /** The same with a pixel of the canvas for each value, the upper left one at (x, y). */
  void
  DrawPanel(double x, double y, const Panel & panel, const Window & window, ColorMap map = ColorMap::Grey);

  /** A line of a width in pixels. */
  void
  DrawLine(const Vector2 & a, const Vector2 & b, const Color & color, double width = 2.0);
  /** Lines from point to point, back to the first where it is closed; nothing for fewer than two points. Where `clip`
   * is given, only inside of it. */
  void
  DrawPolyline(const std::vector<Vector2> & points,
               const Color &                color,
               double                       width = 2.0,
               bool                         closed = false,
               const Rectangle *            clip = nullptr);
  /** By the even-odd rule. `opacity`: 0..1. */
  void
  FillPolygon(const std::vector<Vector2> & points, const Color & color, double opacity = 1.0);
  void
  FillRectangle(const Rectangle & place, const Color & color, double opacity = 1.0);
  void
  FillCircle(const Vector2 & centre, double radius, const Color & color);

  /** One line of text at an anchor. */
  void
  DrawText(const Vector2 & anchor, const std::string & text, const TextStyle & style = {});
  /** How far a text goes, pixels. */
  static double
  MeasureText(const std::string & text, const TextStyle & style = {});

  /** \name Results
   * At `scale` pixels for one. Throw std::invalid_argument where the scale is not positive or a side would have more
   * than 32767 pixels.
   * \{ */
  PictureImage::Pointer
  GetImage(double scale = 1.0) const;
  /** The bytes of a PNG file. */
  std::string
  GetPng(double scale = 1.0) const;
  /** The text of an SVG file, letters as outlines, the same for the same picture. All ids begin with `idPrefix`: give
   * each picture its own where several stand in one HTML page. */
  std::string
  GetSvg(const std::string & idPrefix = "picture") const;
  /** The bytes of a PDF file; a pixel is a point (1/72 inch). */
  std::string
  GetPdf() const;
  /** Writes the whole file or none, .png (at `scale`), .svg or .pdf by the extension. Throws IOError where it has
   * another, or the file cannot be written. */
  void
  Write(const std::string & path, double scale = 1.0) const;
  /** \} */

private:
  struct Drawing;
  double                   m_Width;
  double                   m_Height;
  std::unique_ptr<Drawing> m_Drawing;
};

/** Where a panel's pixel (column, row; fractional, whole numbers are centres) lies on the canvas. */
Vector2
PanelPoint(const Rectangle & place, const Panel & panel, const Vector2 & pixel);
} // namespace bone

#endif
