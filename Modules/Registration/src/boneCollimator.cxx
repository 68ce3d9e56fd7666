/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCollimator.h"

#include <algorithm>
#include <cmath>

namespace bone
{
namespace
{
/** The search is made on an image of at most so many pixels along each side. */
constexpr int MostPixels = 384;
/** Shares of the contrast between shadow and open field: of the threshold, of the drop at a border (median, and at
 * least), and of the variation within the shadow. */
constexpr double ThresholdShare = 0.3;
constexpr double MedianDrop = 0.25;
constexpr double LeastDrop = 0.15;
constexpr double ShadowVariation = 0.3;
/** Pixels to either side of a border between which the exposure drops. */
constexpr double HalfDrop = 3.0;
/** Pixels by which a straight part of the hull may leave its chord. */
constexpr double Straightness = 0.7;
/** Shares: of an edge's samples that drop, of bright pixels in the shadow, of an edge's length in the shorter side, of
 * a bright patch in all that is bright. */
constexpr double DroppingShare = 0.6;
constexpr double BrightShare = 0.02;
constexpr double LeastLength = 0.2;
constexpr double LeastPatch = 0.02;

struct SmallImage
{
  int                 columns{ 0 };
  int                 rows{ 0 };
  double              block{ 1 }; ///< pixels of the image in one of this
  std::vector<double> values;

  double
  At(int c, int r) const
  {
    return values[static_cast<std::size_t>(r) * columns + c];
  }
  bool
  Holds(const Vector2 & p) const
  {
    return p.x() >= 0 && p.y() >= 0 && p.x() <= columns - 1 && p.y() <= rows - 1;
  }
};

double
Quantile(std::vector<double> values, double share)
{
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/** Means of blocks, then medians of 3 x 3, which leave borders where they are. */
SmallImage
MakeSmall(const std::vector<double> & exposure, const std::array<int, 2> & size)
{
  const int  block = (std::max(size[0], size[1]) + MostPixels - 1) / MostPixels;
  SmallImage means{ size[0] / block, size[1] / block, static_cast<double>(block), {} };
  means.values.resize(static_cast<std::size_t>(means.columns) * means.rows);
  for (int r = 0; r < means.rows * block; ++r)
  {
    for (int c = 0; c < means.columns * block; ++c)
    {
      means.values[static_cast<std::size_t>(r / block) * means.columns + c / block] +=
        exposure[static_cast<std::size_t>(r) * size[0] + c] / (block * block);
    }
  }
  SmallImage small = means;
  for (int r = 0; r < small.rows; ++r)
  {
    for (int c = 0; c < small.columns; ++c)
    {
      std::array<double, 9> near;
      for (int k = 0; k < 9; ++k)
      {
        near[k] =
          means.At(std::clamp(c + k % 3 - 1, 0, small.columns - 1), std::clamp(r + k / 3 - 1, 0, small.rows - 1));
      }
      std::nth_element(near.begin(), near.begin() + 4, near.end());
      small.values[static_cast<std::size_t>(r) * small.columns + c] = near[4];
    }
  }
  return small;
}

/** The pixels above the threshold, without small patches of them (lead letters, labels). */
std::vector<bool>
BrightPixels(const SmallImage & image, double threshold)
{
  const std::size_t        count = image.values.size();
  std::vector<int>         patch(count, -1);
  std::vector<std::size_t> sizes;
  std::vector<std::size_t> open;
  std::size_t              all = 0;
  const auto               columns = static_cast<std::size_t>(image.columns);
  for (std::size_t start = 0; start < count; ++start)
  {
    if (patch[start] >= 0 || !(image.values[start] > threshold))
    {
      continue;
    }
    const int label = static_cast<int>(sizes.size());
    sizes.push_back(0);
    patch[start] = label;
    open.push_back(start);
    while (!open.empty())
    {
      const std::size_t at = open.back();
      open.pop_back();
      ++sizes.back();
      const std::size_t c = at % columns;
      const auto        visit = [&](bool inside, std::size_t next) {
        if (inside && patch[next] < 0 && image.values[next] > threshold)
        {
          patch[next] = label;
          open.push_back(next);
        }
      };
      visit(c > 0, at - 1);
      visit(c + 1 < columns, at + 1);
      visit(at >= columns, at - columns);
      visit(at + columns < count, at + columns);
    }
    all += sizes.back();
  }
  std::vector<bool> bright(count, false);
  for (std::size_t i = 0; i < count; ++i)
  {
    bright[i] = patch[i] >= 0 && static_cast<double>(sizes[patch[i]]) >= LeastPatch * static_cast<double>(all);
  }
  return bright;
}

double
Cross(const Vector2 & a, const Vector2 & b)
{
  return a.x() * b.y() - a.y() * b.x();
}

/** The convex hull, by Andrew's monotone chain; the outside is to the right of each edge. */
std::vector<Vector2>
HullOf(const SmallImage & image, const std::vector<bool> & bright)
{
  std::vector<Vector2> points; // the first and last of each row, by column
  for (int r = 0; r < image.rows; ++r)
  {
    const auto row = bright.begin() + static_cast<std::ptrdiff_t>(r) * image.columns;
    const auto first = std::find(row, row + image.columns, true);
    if (first == row + image.columns)
    {
      continue;
    }
    int last = image.columns - 1;
    while (!row[last])
    {
      --last;
    }
    points.emplace_back(static_cast<double>(first - row), r);
    points.emplace_back(last, r);
  }
  if (points.size() < 3)
  {
    return {};
  }
  std::sort(points.begin(), points.end(), [](const Vector2 & a, const Vector2 & b) {
    return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y();
  });
  std::vector<Vector2> hull;
  for (int side = 0; side < 2; ++side)
  {
    const std::size_t start = hull.size();
    for (const Vector2 & p : points)
    {
      while (hull.size() >= start + 2 && Cross(hull.back() - hull[hull.size() - 2], p - hull.back()) <= 0)
      {
        hull.pop_back();
      }
      hull.push_back(p);
    }
    hull.pop_back();
    std::reverse(points.begin(), points.end());
  }
  return hull;
}

/** Edges of the hull, one after another, whose vertices lie near their chord. */
struct Chord
{
  std::size_t first;
  std::size_t edges;
  double      length;
};

/** The hull's longest straight parts, the longest first, no edge in two of them. */
std::vector<Chord>
FindChords(const std::vector<Vector2> & hull, double leastLength)
{
  const std::size_t  n = hull.size();
  std::vector<Chord> all;
  for (std::size_t i = 0; i < n; ++i)
  {
    for (std::size_t edges = 1; edges < n; ++edges)
    {
      const Vector2 & p = hull[i];
      const Vector2   along = hull[(i + edges) % n] - p;
      const double    length = along.norm();
      bool            straight = true;
      for (std::size_t k = 1; k < edges && straight; ++k)
      {
        straight = std::abs(Cross(along, hull[(i + k) % n] - p)) <= Straightness * length;
      }
      if (!straight)
      {
        break;
      }
      if (length >= leastLength)
      {
        all.push_back({ i, edges, length });
      }
    }
  }
  std::stable_sort(all.begin(), all.end(), [](const Chord & a, const Chord & b) { return a.length > b.length; });
  std::vector<Chord> chosen;
  std::vector<bool>  used(n, false);
  for (const Chord & chord : all)
  {
    bool free = true;
    for (std::size_t k = 0; k < chord.edges; ++k)
    {
      free = free && !used[(chord.first + k) % n];
    }
    if (free)
    {
      chosen.push_back(chord);
      for (std::size_t k = 0; k < chord.edges; ++k)
      {
        used[(chord.first + k) % n] = true;
      }
    }
  }
  return chosen;
}

/** Whether the exposure drops along the chord from within the hull to outside of it. */
bool
DropsAlong(const SmallImage & image, const Vector2 & p, const Vector2 & q, const Vector2 & normal, double contrast)
{
  std::vector<double> drops;
  const int           samples = std::max(8, static_cast<int>((q - p).norm()));
  for (int k = 0; k <= samples; ++k)
  {
    const Vector2 at = p + (0.1 + 0.8 * k / samples) * (q - p);
    const Vector2 inside = at - HalfDrop * normal, outside = at + HalfDrop * normal;
    if (image.Holds(inside) && image.Holds(outside))
    {
      const auto value = [&](const Vector2 & x) {
        return image.At(static_cast<int>(std::lround(x.x())), static_cast<int>(std::lround(x.y())));
      };
      drops.push_back(value(inside) - value(outside));
    }
  }
  const auto dropping =
    std::count_if(drops.begin(), drops.end(), [&](double drop) { return drop >= LeastDrop * contrast; });
  return 2 * static_cast<int>(drops.size()) > samples &&
         static_cast<double>(dropping) >= DroppingShare * static_cast<double>(drops.size()) &&
         Quantile(drops, 0.5) >= MedianDrop * contrast;
}

/** Whether all beyond the line is evenly dark. */
bool
IsShadow(const SmallImage & image, const CollimatorEdge & edge, double threshold, double contrast)
{
  std::vector<double> beyond;
  for (int r = 0; r < image.rows; ++r)
  {
    for (int c = 0; c < image.columns; ++c)
    {
      if (edge.normal.dot(Vector2(c, r)) > edge.offset + HalfDrop)
      {
        beyond.push_back(image.At(c, r));
      }
    }
  }
  if (beyond.empty())
  {
    return false;
  }
  const auto bright = std::count_if(beyond.begin(), beyond.end(), [&](double v) { return v > threshold; });
  return static_cast<double>(bright) <= BrightShare * static_cast<double>(beyond.size()) &&
         Quantile(beyond, 0.9) - Quantile(beyond, 0.1) <= ShadowVariation * contrast;
}

/** The values of the outer two rows and columns. */
std::vector<double>
FrameOf(const SmallImage & image)
{
  std::vector<double> frame;
  for (int r = 0; r < image.rows; ++r)
  {
    for (int c = 0; c < image.columns; ++c)
    {
      if (std::min({ c, r, image.columns - 1 - c, image.rows - 1 - r }) < 2)
      {
        frame.push_back(image.At(c, r));
      }
    }
  }
  return frame;
}
} // namespace

std::vector<CollimatorEdge>
FindCollimator(const std::vector<double> & exposure, const std::array<int, 2> & size, double leastContrast)
{
  const SmallImage            image = MakeSmall(exposure, size);
  std::vector<CollimatorEdge> edges;
  if (std::min(image.columns, image.rows) < 16)
  {
    return edges;
  }
  const double shadow = Quantile(FrameOf(image), 0.05), contrast = Quantile(image.values, 0.95) - shadow;
  if (!(contrast >= leastContrast))
  {
    return edges;
  }
  const double threshold = shadow + ThresholdShare * contrast;
  const auto   hull = HullOf(image, BrightPixels(image, threshold));
  for (const Chord & chord : FindChords(hull, LeastLength * std::min(image.columns, image.rows)))
  {
    const Vector2 & p = hull[chord.first];
    const Vector2 & q = hull[(chord.first + chord.edges) % hull.size()];
    CollimatorEdge  edge;
    edge.normal = Vector2((q - p).y(), -(q - p).x()).normalized();
    edge.offset = edge.normal.dot(p);
    for (const Vector2 & v : hull)
    {
      edge.offset = std::max(edge.offset, edge.normal.dot(v));
    }
    if (DropsAlong(image, p, q, edge.normal, contrast) && IsShadow(image, edge, threshold, contrast))
    {
      // Half a pixel further is the border itself, between the last bright pixel and the first dark one.
      const double half = 0.5 * (image.block - 1);
      edge.offset = image.block * (edge.offset + 0.5) + half * edge.normal.sum();
      edges.push_back(edge);
    }
  }
  return edges;
}
} // namespace bone
