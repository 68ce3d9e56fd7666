/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCanvas.h"

#include "boneAtomicFile.h"
#include "boneCairo.h"
#include "boneFileName.h"
#include "boneSvgIds.h"
#include "boneUtf8.h"

#include <cairo-pdf.h>
#include <cairo-svg.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace bone
{
namespace
{
void
VerifyStatus(cairo_status_t status)
{
  if (status != CAIRO_STATUS_SUCCESS)
  {
    throw std::runtime_error(std::string("The picture could not be drawn: ") + cairo_status_to_string(status));
  }
}

/** For results: all pixels of `paint` are drawn and the surface is complete. */
void
Finish(cairo_surface_t * surface, cairo_surface_t * paint, double scale)
{
  const CairoContext context(cairo_create(surface));
  cairo_scale(context.get(), scale, scale);
  cairo_set_source_surface(context.get(), paint, 0.0, 0.0);
  cairo_paint(context.get());
  VerifyStatus(cairo_status(context.get()));
}

cairo_status_t
Append(void * text, const unsigned char * data, unsigned int length) noexcept
{
  try
  {
    static_cast<std::string *>(text)->append(reinterpret_cast<const char *>(data), length);
    return CAIRO_STATUS_SUCCESS;
  }
  catch (...)
  {
    return CAIRO_STATUS_NO_MEMORY;
  }
}

void
SetColor(cairo_t * context, const Color & color, double opacity = 1.0)
{
  cairo_set_source_rgba(context, color[0] / 255.0, color[1] / 255.0, color[2] / 255.0, opacity);
}

void
AddPath(cairo_t * context, const std::vector<Vector2> & points)
{
  cairo_new_path(context);
  for (const Vector2 & p : points)
  {
    cairo_line_to(context, p.x(), p.y());
  }
}

void
SetFont(cairo_t * context, const TextStyle & style)
{
  cairo_select_font_face(
    context, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL, style.bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(context, style.size);
  // Letters of the same shape and width at all scales.
  cairo_font_options_t * options = cairo_font_options_create();
  cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_NONE);
  cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
  cairo_font_options_set_antialias(options, CAIRO_ANTIALIAS_GRAY);
  cairo_set_font_options(context, options);
  cairo_font_options_destroy(options);
}

double
Advance(cairo_t * context, const std::string & text)
{
  cairo_text_extents_t extents;
  cairo_text_extents(context, text.c_str(), &extents);
  return extents.x_advance;
}

CairoSurface
MakeRecording(double width, double height)
{
  const cairo_rectangle_t extents{ 0.0, 0.0, width, height };
  return CairoSurface(cairo_recording_surface_create(CAIRO_CONTENT_COLOR_ALPHA, &extents));
}

/** The panel as Cairo's pixels: premultiplied, native byte order. */
CairoSurface
MakeImage(const Panel & panel, const Window & window, ColorMap map)
{
  CairoSurface image(cairo_image_surface_create(CAIRO_FORMAT_ARGB32, panel.columns, panel.rows));
  VerifyStatus(cairo_surface_status(image.get()));
  unsigned char * data = cairo_image_surface_get_data(image.get());
  const auto      stride = static_cast<std::size_t>(cairo_image_surface_get_stride(image.get()));
  std::size_t     k = 0;
  for (int r = 0; r < panel.rows; ++r)
  {
    auto * row = reinterpret_cast<std::uint32_t *>(data + static_cast<std::size_t>(r) * stride);
    for (int c = 0; c < panel.columns; ++c, ++k)
    {
      const Color color = MapColor(map, panel.values[k], window);
      row[c] = std::isnan(panel.values[k]) ? 0U
                                           : 0xFF000000U | std::uint32_t{ color[0] } << 16U |
                                               std::uint32_t{ color[1] } << 8U | std::uint32_t{ color[2] };
    }
  }
  cairo_surface_mark_dirty(image.get());
  return image;
}
} // namespace

struct Canvas::Drawing
{
  CairoSurface surface;
  CairoContext context;
};

Canvas::Canvas(double width, double height, const Color & background)
  : m_Width(width)
  , m_Height(height)
{
  if (!(width > 0.0 && height > 0.0 && std::isfinite(width) && std::isfinite(height)))
  {
    throw std::invalid_argument("A picture of " + std::to_string(width) + " by " + std::to_string(height) +
                                " pixels cannot be drawn: give positive sizes");
  }
  m_Drawing = std::make_unique<Drawing>();
  m_Drawing->surface = MakeRecording(width, height);
  m_Drawing->context.reset(cairo_create(m_Drawing->surface.get()));
  VerifyStatus(cairo_status(m_Drawing->context.get()));
  this->FillRectangle({ 0.0, 0.0, width, height }, background);
}

Canvas::Canvas(Canvas && other) noexcept = default;
Canvas &
Canvas::operator=(Canvas && other) noexcept = default;
Canvas::~Canvas() = default;

void
Canvas::DrawPanel(double x, double y, const Panel & panel, const Window & window, ColorMap map)
{
  this->DrawPanel({ x, y, static_cast<double>(panel.columns), static_cast<double>(panel.rows) }, panel, window, map);
}

void
Canvas::DrawPanel(const Rectangle & place, const Panel & panel, const Window & window, ColorMap map)
{
  if (panel.columns <= 0 || panel.rows <= 0)
  {
    return;
  }
  const CairoSurface image = MakeImage(panel, window, map);
  cairo_t *          context = m_Drawing->context.get();
  cairo_save(context);
  cairo_rectangle(context, place.x, place.y, place.width, place.height);
  cairo_clip(context);
  cairo_translate(context, place.x, place.y);
  cairo_scale(context, place.width / panel.columns, place.height / panel.rows);
  cairo_set_source_surface(context, image.get(), 0.0, 0.0);
  cairo_pattern_set_filter(cairo_get_source(context), CAIRO_FILTER_GOOD);
  cairo_pattern_set_extend(cairo_get_source(context), CAIRO_EXTEND_PAD);
  cairo_paint(context);
  cairo_restore(context);
}

void
Canvas::DrawLine(const Vector2 & a, const Vector2 & b, const Color & color, double width)
{
  this->DrawPolyline({ a, b }, color, width);
}

void
Canvas::DrawPolyline(const std::vector<Vector2> & points,
                     const Color &                color,
                     double                       width,
                     bool                         closed,
                     const Rectangle *            clip)
{
  if (points.size() < 2)
  {
    return;
  }
  cairo_t * context = m_Drawing->context.get();
  cairo_save(context);
  if (clip != nullptr)
  {
    cairo_rectangle(context, clip->x, clip->y, clip->width, clip->height);
    cairo_clip(context);
  }
  AddPath(context, points);
  if (closed)
  {
    cairo_close_path(context);
  }
  SetColor(context, color);
  cairo_set_line_width(context, width);
  cairo_set_line_join(context, CAIRO_LINE_JOIN_ROUND);
  cairo_stroke(context);
  cairo_restore(context);
}

void
Canvas::FillPolygon(const std::vector<Vector2> & points, const Color & color, double opacity)
{
  cairo_t * context = m_Drawing->context.get();
  AddPath(context, points);
  cairo_set_fill_rule(context, CAIRO_FILL_RULE_EVEN_ODD);
  SetColor(context, color, opacity);
  cairo_fill(context);
}

void
Canvas::FillRectangle(const Rectangle & place, const Color & color, double opacity)
{
  cairo_t * context = m_Drawing->context.get();
  cairo_rectangle(context, place.x, place.y, place.width, place.height);
  SetColor(context, color, opacity);
  cairo_fill(context);
}

void
Canvas::FillCircle(const Vector2 & centre, double radius, const Color & color)
{
  cairo_t * context = m_Drawing->context.get();
  cairo_new_path(context);
  cairo_arc(context, centre.x(), centre.y(), radius, 0.0, 2.0 * std::acos(-1.0));
  SetColor(context, color);
  cairo_fill(context);
}

void
Canvas::DrawText(const Vector2 & anchor, const std::string & text, const TextStyle & style)
{
  constexpr double  capital = 0.729; // height of capital letters, DejaVu Sans
  cairo_t *         context = m_Drawing->context.get();
  const std::string valid = ToValidUtf8(text);
  cairo_save(context);
  SetFont(context, style);
  const double width = Advance(context, valid);
  cairo_translate(context, anchor.x(), anchor.y());
  if (style.upward)
  {
    cairo_rotate(context, -0.5 * std::acos(-1.0));
  }
  const double x = style.align == TextAlign::Left ? 0.0 : style.align == TextAlign::Centre ? -0.5 * width : -width;
  const double y = style.height == TextHeight::Baseline
                     ? 0.0
                     : capital * style.size * (style.height == TextHeight::Middle ? 0.5 : 1.0);
  if (style.halo)
  {
    cairo_move_to(context, x, y);
    cairo_text_path(context, valid.c_str());
    SetColor(context, { { 0, 0, 0 } });
    cairo_set_line_width(context, 0.25 * style.size);
    cairo_set_line_join(context, CAIRO_LINE_JOIN_ROUND);
    cairo_stroke(context);
  }
  cairo_move_to(context, x, y);
  SetColor(context, style.color);
  cairo_show_text(context, valid.c_str());
  cairo_restore(context);
  VerifyStatus(cairo_status(context));
}

double
Canvas::MeasureText(const std::string & text, const TextStyle & style)
{
  const CairoSurface surface = MakeRecording(1.0, 1.0);
  const CairoContext context(cairo_create(surface.get()));
  SetFont(context.get(), style);
  const double width = Advance(context.get(), ToValidUtf8(text));
  VerifyStatus(cairo_status(context.get()));
  return width;
}

namespace
{
CairoSurface
Rasterize(cairo_surface_t * drawing, double width, double height, double scale)
{
  constexpr double most = 32767.0; // of an image of Cairo
  const double     columns = std::max(1.0, std::round(width * scale));
  const double     rows = std::max(1.0, std::round(height * scale));
  if (!(scale > 0.0) || !(columns <= most) || !(rows <= most))
  {
    throw std::invalid_argument("A picture of " + std::to_string(std::lround(width)) + " by " +
                                std::to_string(std::lround(height)) + " pixels cannot be made at scale " +
                                std::to_string(scale) +
                                ": give a positive scale, at which no side has more than 32767 pixels");
  }
  CairoSurface image(cairo_image_surface_create(CAIRO_FORMAT_RGB24, static_cast<int>(columns), static_cast<int>(rows)));
  VerifyStatus(cairo_surface_status(image.get()));
  Finish(image.get(), drawing, scale);
  cairo_surface_flush(image.get());
  return image;
}
} // namespace

PictureImage::Pointer
Canvas::GetImage(double scale) const
{
  const CairoSurface    pixels = Rasterize(m_Drawing->surface.get(), m_Width, m_Height, scale);
  const int             columns = cairo_image_surface_get_width(pixels.get());
  const int             rows = cairo_image_surface_get_height(pixels.get());
  const auto            stride = static_cast<std::size_t>(cairo_image_surface_get_stride(pixels.get()));
  const unsigned char * data = cairo_image_surface_get_data(pixels.get());

  auto                   image = PictureImage::New();
  PictureImage::SizeType size = { { static_cast<itk::SizeValueType>(columns), static_cast<itk::SizeValueType>(rows) } };
  image->SetRegions(size);
  image->Allocate();
  PictureImage::PixelType * to = image->GetBufferPointer();
  for (int r = 0; r < rows; ++r)
  {
    const auto * row = reinterpret_cast<const std::uint32_t *>(data + static_cast<std::size_t>(r) * stride);
    for (int c = 0; c < columns; ++c, ++to)
    {
      to->Set(static_cast<unsigned char>(row[c] >> 16U & 255U),
              static_cast<unsigned char>(row[c] >> 8U & 255U),
              static_cast<unsigned char>(row[c] & 255U));
    }
  }
  return image;
}

std::string
Canvas::GetPng(double scale) const
{
  const CairoSurface pixels = Rasterize(m_Drawing->surface.get(), m_Width, m_Height, scale);
  std::string        bytes;
  VerifyStatus(cairo_surface_write_to_png_stream(pixels.get(), Append, &bytes));
  return bytes;
}

std::string
Canvas::GetSvg(const std::string & idPrefix) const
{
  std::string        text;
  const CairoSurface surface(cairo_svg_surface_create_for_stream(Append, &text, m_Width, m_Height));
  cairo_svg_surface_set_document_unit(surface.get(), CAIRO_SVG_UNIT_PX);
  Finish(surface.get(), m_Drawing->surface.get(), 1.0);
  cairo_surface_finish(surface.get());
  VerifyStatus(cairo_surface_status(surface.get()));
  return RenameSvgIds(text, idPrefix);
}

std::string
Canvas::GetPdf() const
{
  std::string        bytes;
  const CairoSurface surface(cairo_pdf_surface_create_for_stream(Append, &bytes, m_Width, m_Height));
  Finish(surface.get(), m_Drawing->surface.get(), 1.0);
  cairo_surface_finish(surface.get());
  VerifyStatus(cairo_surface_status(surface.get()));
  return bytes;
}

void
Canvas::Write(const std::string & path, double scale) const
{
  if (HasExtension(path, ".png"))
  {
    WriteFileAtomically(path, this->GetPng(scale));
  }
  else if (HasExtension(path, ".svg"))
  {
    WriteFileAtomically(path, this->GetSvg());
  }
  else if (HasExtension(path, ".pdf"))
  {
    WriteFileAtomically(path, this->GetPdf());
  }
  else
  {
    throw IOError(path, "pictures are written as .png, .svg or .pdf: give a name that ends so");
  }
}

Vector2
PanelPoint(const Rectangle & place, const Panel & panel, const Vector2 & pixel)
{
  return { place.x + (pixel.x() + 0.5) * place.width / panel.columns,
           place.y + (pixel.y() + 0.5) * place.height / panel.rows };
}
} // namespace bone
