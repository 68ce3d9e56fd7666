/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "bonePageData.h"

#include "boneJpeg.h"
#include "bonePageParts.h"

#include <algorithm>
#include <cmath>

namespace bone
{
namespace
{
/** The view of the first slice that holds all contours and a margin. */
PlaneView
FrameSlices(const CTImage * ct, const ContourStack & stack)
{
  constexpr double most = 600000.0; // pixels of all slices
  constexpr double margin = 5.0;    // mm about the contours

  std::vector<Vector3> points;
  for (const ContourSlice & slice : stack.GetSlices())
  {
    for (const Contour & contour : slice.contours)
    {
      points.insert(points.end(), contour.points.begin(), contour.points.end());
    }
  }
  const auto      spacing = ct->GetSpacing();
  const double    voxel = std::min({ spacing[0], spacing[1], spacing[2] });
  const Vector3   origin = stack.GetSlices().front().origin;
  const PlaneView fine = FramePlane(stack.GetNormal(), origin, points, margin, 1000); // tells the sides' lengths
  const double    count = static_cast<double>(stack.GetSlices().size());
  const double    pixel = std::max(voxel, fine.pixel * std::sqrt(count * fine.columns * fine.rows / most));
  const double    side = fine.pixel * std::max(fine.columns, fine.rows);
  return FramePlane(stack.GetNormal(), origin, points, margin, std::max(1, static_cast<int>(side / pixel)));
}

/** The slices side by side in one grey picture, a tile each, `across` of them in a row. */
class Mosaic
{
public:
  Mosaic(const PlaneView & view, std::size_t count)
    : m_Across(static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(count)))))
    , m_Columns(RoundUp(view.columns))
    , m_Rows(RoundUp(view.rows))
    , m_Picture(PictureImage::New())
  {
    const std::size_t      down = (count + m_Across - 1) / m_Across;
    PictureImage::SizeType size = { { m_Across * m_Columns, down * m_Rows } };
    m_Picture->SetRegions(size);
    m_Picture->Allocate();
    m_Picture->FillBuffer(PictureImage::PixelType(static_cast<unsigned char>(0)));
  }

  void
  SetTile(std::size_t k, const Panel & panel, const Window & window)
  {
    for (int r = 0; r < panel.rows; ++r)
    {
      for (int c = 0; c < panel.columns; ++c)
      {
        const double value = panel.values[static_cast<std::size_t>(r) * static_cast<std::size_t>(panel.columns) +
                                          static_cast<std::size_t>(c)];
        const double share = (value - window.lower) / (window.upper - window.lower); // NaN outside: black
        const auto   grey = static_cast<unsigned char>(share > 0.0 ? std::lround(255.0 * std::min(share, 1.0)) : 0);
        m_Picture->SetPixel({ { static_cast<itk::IndexValueType>(k % m_Across * m_Columns) + c,
                                static_cast<itk::IndexValueType>(k / m_Across * m_Rows) + r } },
                            PictureImage::PixelType(grey));
      }
    }
  }

  nlohmann::json
  Pack(const Window & window) const
  {
    return { { "jpeg", ToBase64(ToJpeg(m_Picture)) },
             { "across", m_Across },
             { "tile", { m_Columns, m_Rows } },
             { "step", (window.upper - window.lower) / 255.0 },
             { "offset", window.lower } };
  }

private:
  /** To a JPEG's block, that a slice does not shine into the next. */
  static std::size_t
  RoundUp(int pixels)
  {
    return static_cast<std::size_t>((pixels + 7) / 8 * 8);
  }

  std::size_t           m_Across;
  std::size_t           m_Columns;
  std::size_t           m_Rows;
  PictureImage::Pointer m_Picture;
};

/** A slice's contours in pixels. */
nlohmann::json
PackLines(const ContourSlice & slice, const PlaneView & view)
{
  nlohmann::json lines = nlohmann::json::array();
  for (const Contour & contour : slice.contours)
  {
    const ContourStyle & style = StyleOf(contour);
    std::vector<double>  pixels;
    for (const Vector3 & x : contour.points)
    {
      const Vector2 p = view.Project(x);
      pixels.push_back(0.1 * std::round(10.0 * p.x()));
      pixels.push_back(0.1 * std::round(10.0 * p.y()));
    }
    lines.push_back(
      { { "name", style.name }, { "color", ToHex(style.color) }, { "closed", !contour.axis }, { "points", pixels } });
  }
  return lines;
}
} // namespace

nlohmann::json
PackSlices(const CTImage *                  ct,
           const ContourStack &             stack,
           const Window &                   window,
           const std::string &              unit,
           const std::vector<std::string> & titles)
{
  PlaneView         view = FrameSlices(ct, stack);
  const std::size_t count = stack.GetSlices().size();
  Mosaic            mosaic(view, count);
  nlohmann::json    contours = nlohmann::json::array();
  const Vector3     normal = stack.GetNormal();
  const Vector3     flat = view.corner - view.corner.dot(normal) * normal;
  for (std::size_t k = 0; k < count; ++k)
  {
    view.corner = flat + stack.GetHeight(k) * normal;
    mosaic.SetTile(k, SamplePlane(ct, view), window);
    contours.push_back(PackLines(stack.GetSlices()[k], view));
  }
  return { { "columns", view.columns },
           { "rows", view.rows },
           { "count", count },
           { "pixel", view.pixel },
           { "values", mosaic.Pack(window) },
           { "unit", unit },
           { "window", { window.lower, window.upper } },
           { "letters", PackLetters(view.Letters()) },
           { "titles", titles },
           { "contours", { { "gzip", ToBase64(Gzip(contours.dump())) } } } };
}
} // namespace bone
