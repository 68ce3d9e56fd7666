/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCanvas.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>

namespace bone
{
namespace
{
/** Seven rows of five bits, the left pixel the highest bit. */
using Glyph = std::array<unsigned char, 7>;

const std::map<char, Glyph> &
Glyphs()
{
  static const std::map<char, Glyph> glyphs = {
    { 'A', { { 0x0E, 0x11, 0x11, 0x1F, 0x11, 0x11, 0x11 } } },
    { 'B', { { 0x1E, 0x11, 0x11, 0x1E, 0x11, 0x11, 0x1E } } },
    { 'C', { { 0x0E, 0x11, 0x10, 0x10, 0x10, 0x11, 0x0E } } },
    { 'D', { { 0x1E, 0x11, 0x11, 0x11, 0x11, 0x11, 0x1E } } },
    { 'E', { { 0x1F, 0x10, 0x10, 0x1E, 0x10, 0x10, 0x1F } } },
    { 'F', { { 0x1F, 0x10, 0x10, 0x1E, 0x10, 0x10, 0x10 } } },
    { 'G', { { 0x0E, 0x11, 0x10, 0x17, 0x11, 0x11, 0x0F } } },
    { 'H', { { 0x11, 0x11, 0x11, 0x1F, 0x11, 0x11, 0x11 } } },
    { 'I', { { 0x0E, 0x04, 0x04, 0x04, 0x04, 0x04, 0x0E } } },
    { 'J', { { 0x07, 0x02, 0x02, 0x02, 0x02, 0x12, 0x0C } } },
    { 'K', { { 0x11, 0x12, 0x14, 0x18, 0x14, 0x12, 0x11 } } },
    { 'L', { { 0x10, 0x10, 0x10, 0x10, 0x10, 0x10, 0x1F } } },
    { 'M', { { 0x11, 0x1B, 0x15, 0x15, 0x11, 0x11, 0x11 } } },
    { 'N', { { 0x11, 0x19, 0x15, 0x13, 0x11, 0x11, 0x11 } } },
    { 'O', { { 0x0E, 0x11, 0x11, 0x11, 0x11, 0x11, 0x0E } } },
    { 'P', { { 0x1E, 0x11, 0x11, 0x1E, 0x10, 0x10, 0x10 } } },
    { 'Q', { { 0x0E, 0x11, 0x11, 0x11, 0x15, 0x12, 0x0D } } },
    { 'R', { { 0x1E, 0x11, 0x11, 0x1E, 0x14, 0x12, 0x11 } } },
    { 'S', { { 0x0F, 0x10, 0x10, 0x0E, 0x01, 0x01, 0x1E } } },
    { 'T', { { 0x1F, 0x04, 0x04, 0x04, 0x04, 0x04, 0x04 } } },
    { 'U', { { 0x11, 0x11, 0x11, 0x11, 0x11, 0x11, 0x0E } } },
    { 'V', { { 0x11, 0x11, 0x11, 0x11, 0x11, 0x0A, 0x04 } } },
    { 'W', { { 0x11, 0x11, 0x11, 0x15, 0x15, 0x1B, 0x11 } } },
    { 'X', { { 0x11, 0x11, 0x0A, 0x04, 0x0A, 0x11, 0x11 } } },
    { 'Y', { { 0x11, 0x11, 0x0A, 0x04, 0x04, 0x04, 0x04 } } },
    { 'Z', { { 0x1F, 0x01, 0x02, 0x04, 0x08, 0x10, 0x1F } } },
    { '0', { { 0x0E, 0x11, 0x13, 0x15, 0x19, 0x11, 0x0E } } },
    { '1', { { 0x04, 0x0C, 0x04, 0x04, 0x04, 0x04, 0x0E } } },
    { '2', { { 0x0E, 0x11, 0x01, 0x06, 0x08, 0x10, 0x1F } } },
    { '3', { { 0x0E, 0x11, 0x01, 0x06, 0x01, 0x11, 0x0E } } },
    { '4', { { 0x02, 0x06, 0x0A, 0x12, 0x1F, 0x02, 0x02 } } },
    { '5', { { 0x1F, 0x10, 0x1E, 0x01, 0x01, 0x11, 0x0E } } },
    { '6', { { 0x06, 0x08, 0x10, 0x1E, 0x11, 0x11, 0x0E } } },
    { '7', { { 0x1F, 0x01, 0x02, 0x04, 0x08, 0x08, 0x08 } } },
    { '8', { { 0x0E, 0x11, 0x11, 0x0E, 0x11, 0x11, 0x0E } } },
    { '9', { { 0x0E, 0x11, 0x11, 0x0F, 0x01, 0x02, 0x0C } } },
    { '.', { { 0x00, 0x00, 0x00, 0x00, 0x00, 0x0C, 0x0C } } },
    { ',', { { 0x00, 0x00, 0x00, 0x00, 0x0C, 0x04, 0x08 } } },
    { ':', { { 0x00, 0x0C, 0x0C, 0x00, 0x0C, 0x0C, 0x00 } } },
    { '-', { { 0x00, 0x00, 0x00, 0x1F, 0x00, 0x00, 0x00 } } },
    { '+', { { 0x00, 0x04, 0x04, 0x1F, 0x04, 0x04, 0x00 } } },
    { '=', { { 0x00, 0x00, 0x1F, 0x00, 0x1F, 0x00, 0x00 } } },
    { '%', { { 0x18, 0x19, 0x02, 0x04, 0x08, 0x13, 0x03 } } },
    { '/', { { 0x01, 0x01, 0x02, 0x04, 0x08, 0x10, 0x10 } } },
    { '(', { { 0x02, 0x04, 0x08, 0x08, 0x08, 0x04, 0x02 } } },
    { ')', { { 0x08, 0x04, 0x02, 0x02, 0x02, 0x04, 0x08 } } },
  };
  return glyphs;
}

unsigned char
ToByte(double share)
{
  return static_cast<unsigned char>(std::lround(255.0 * std::clamp(share, 0.0, 1.0)));
}
} // namespace

Canvas::Canvas(int columns, int rows, const Color & background)
  : m_Image(PictureImage::New())
  , m_Columns(columns)
  , m_Rows(rows)
{
  PictureImage::SizeType size = { { static_cast<itk::SizeValueType>(columns), static_cast<itk::SizeValueType>(rows) } };
  m_Image->SetRegions(size);
  m_Image->Allocate();
  PictureImage::PixelType pixel;
  std::copy(background.begin(), background.end(), pixel.Begin());
  m_Image->FillBuffer(pixel);
}

void
Canvas::Set(int column, int row, const Color & color)
{
  if (column >= 0 && row >= 0 && column < m_Columns && row < m_Rows)
  {
    PictureImage::PixelType pixel;
    std::copy(color.begin(), color.end(), pixel.Begin());
    m_Image->SetPixel({ { column, row } }, pixel);
  }
}

void
Canvas::DrawPanel(int column, int row, const Panel & panel, const Window & window)
{
  std::size_t k = 0;
  for (int r = 0; r < panel.rows; ++r)
  {
    for (int c = 0; c < panel.columns; ++c, ++k)
    {
      if (!std::isnan(panel.values[k]))
      {
        const unsigned char grey = ToByte((panel.values[k] - window.lower) / (window.upper - window.lower));
        this->Set(column + c, row + r, { { grey, grey, grey } });
      }
    }
  }
}

void
Canvas::DrawDifference(int column, int row, const Panel & panel, double scale)
{
  std::size_t k = 0;
  for (int r = 0; r < panel.rows; ++r)
  {
    for (int c = 0; c < panel.columns; ++c, ++k)
    {
      if (!std::isnan(panel.values[k]))
      {
        const double        share = std::clamp(panel.values[k] / scale, -1.0, 1.0);
        const unsigned char fading = ToByte(1.0 - std::abs(share));
        this->Set(
          column + c, row + r, share < 0.0 ? Color{ { fading, fading, 255 } } : Color{ { 255, fading, fading } });
      }
    }
  }
}

void
Canvas::DrawLine(const Vector2 & a, const Vector2 & b, const Color & color)
{
  const int steps = std::max(1, static_cast<int>(std::ceil((b - a).cwiseAbs().maxCoeff())));
  for (int i = 0; i <= steps; ++i)
  {
    const Vector2 p = a + (b - a) * (static_cast<double>(i) / steps);
    const int     column = static_cast<int>(std::floor(p.x()));
    const int     row = static_cast<int>(std::floor(p.y()));
    this->Set(column, row, color);
    this->Set(column + 1, row, color);
    this->Set(column, row + 1, color);
    this->Set(column + 1, row + 1, color);
  }
}

void
Canvas::DrawText(int column, int row, const std::string & text, int magnification, const Color & color)
{
  for (std::size_t i = 0; i < text.size(); ++i)
  {
    const auto glyph = Glyphs().find(static_cast<char>(std::toupper(static_cast<unsigned char>(text[i]))));
    if (glyph == Glyphs().end())
    {
      continue;
    }
    for (int y = 0; y < 7 * magnification; ++y)
    {
      for (int x = 0; x < 5 * magnification; ++x)
      {
        if ((glyph->second[y / magnification] >> (4 - x / magnification) & 1) != 0)
        {
          this->Set(column + static_cast<int>(i) * 6 * magnification + x, row + y, color);
        }
      }
    }
  }
}
} // namespace bone
