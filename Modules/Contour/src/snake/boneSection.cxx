/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSection.h"

#include "bonePredicates.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <sstream>

namespace bone
{
namespace
{
struct Box
{
  Vector2 low{ Vector2::Constant(std::numeric_limits<double>::max()) };
  Vector2 high{ Vector2::Constant(std::numeric_limits<double>::lowest()) };

  explicit Box(const Polygon & polygon)
  {
    for (const Vector2 & q : polygon)
    {
      low = low.cwiseMin(q);
      high = high.cwiseMax(q);
    }
  }
};

bool
EdgesCross(const Polygon & a, const Polygon & b)
{
  for (std::size_t i = 0; i < a.size(); ++i)
  {
    const Vector2 & p = a[i];
    const Vector2 & q = a[(i + 1) % a.size()];
    const Vector2   low = p.cwiseMin(q);
    const Vector2   high = p.cwiseMax(q);
    for (std::size_t j = 0; j < b.size(); ++j)
    {
      const Vector2 & r = b[j];
      const Vector2 & s = b[(j + 1) % b.size()];
      if (std::max(r.x(), s.x()) < low.x() || std::min(r.x(), s.x()) > high.x() || std::max(r.y(), s.y()) < low.y() ||
          std::min(r.y(), s.y()) > high.y())
      {
        continue;
      }
      if (Orient2D(p, q, r) * Orient2D(p, q, s) <= 0 && Orient2D(r, s, p) * Orient2D(r, s, q) <= 0)
      {
        return true;
      }
    }
  }
  return false;
}

// Groups of items joined by links; items are numbered over all slices.
class Groups
{
public:
  explicit Groups(std::size_t count)
    : m_Parent(count)
  {
    std::iota(m_Parent.begin(), m_Parent.end(), std::size_t{ 0 });
  }
  std::size_t
  Find(std::size_t x)
  {
    while (m_Parent[x] != x)
    {
      x = m_Parent[x] = m_Parent[m_Parent[x]];
    }
    return x;
  }
  void
  Join(std::size_t a, std::size_t b)
  {
    a = Find(a);
    b = Find(b);
    m_Parent[std::max(a, b)] = std::min(a, b);
  }

private:
  std::vector<std::size_t> m_Parent;
};

struct Item
{
  std::size_t     slice;
  std::size_t     piece;
  std::size_t     index; // of a hole or an inner contour in its piece
  const Polygon * polygon;
};

// Joins overlapping items of neighbouring slices. Items are in order of their slices.
Groups
LinkItems(const std::vector<Item> & items, std::vector<char> & linked)
{
  Groups groups(items.size());
  linked.assign(items.size(), 0);
  for (std::size_t a = 0; a < items.size(); ++a)
  {
    for (std::size_t b = a + 1; b < items.size() && items[b].slice <= items[a].slice + 1; ++b)
    {
      if (items[b].slice == items[a].slice + 1 && PolygonsOverlap(*items[a].polygon, *items[b].polygon))
      {
        groups.Join(a, b);
        linked[a] = linked[b] = 1;
      }
    }
  }
  return groups;
}

// How many different slices each group covers, at its first item.
std::vector<int>
CountSlices(const std::vector<Item> & items, Groups & groups)
{
  std::vector<int>         count(items.size(), 0);
  std::vector<std::size_t> last(items.size(), std::numeric_limits<std::size_t>::max());
  for (std::size_t i = 0; i < items.size(); ++i)
  {
    const std::size_t g = groups.Find(i);
    if (last[g] != items[i].slice)
    {
      last[g] = items[i].slice;
      ++count[g];
    }
  }
  return count;
}

std::string
Sentence(int count, const std::string & what)
{
  std::ostringstream text;
  text << "Left out " << count << ' ' << what << '.';
  return text.str();
}

// Whether q lies in bone.
bool
InBone(const Section & section, const Vector2 & q)
{
  return std::any_of(section.pieces.begin(), section.pieces.end(), [&q](const SectionPiece & piece) {
    return PointInPolygon(q, piece.outer) &&
           std::none_of(
             piece.holes.begin(), piece.holes.end(), [&q](const Polygon & hole) { return PointInPolygon(q, hole); });
  });
}

// Whether most of a loop lies outside the bone on a slice next to slice k: a hole there is the end of a notch or a
// socket, and no void.
bool
OpensToNeighbour(const std::vector<Section> & sections, std::size_t k, const Polygon & hole)
{
  const auto opens = [&hole](const Section & section) {
    const auto outside =
      std::count_if(hole.begin(), hole.end(), [&section](const Vector2 & q) { return !InBone(section, q); });
    return 2 * static_cast<std::size_t>(outside) > hole.size();
  };
  return (k > 0 && opens(sections[k - 1])) || (k + 1 < sections.size() && opens(sections[k + 1]));
}

int
DropHoles(std::vector<Section> & sections, int minimumSlices)
{
  std::vector<Item> items;
  for (std::size_t k = 0; k < sections.size(); ++k)
  {
    for (std::size_t p = 0; p < sections[k].pieces.size(); ++p)
    {
      for (std::size_t h = 0; h < sections[k].pieces[p].holes.size(); ++h)
      {
        items.push_back({ k, p, h, &sections[k].pieces[p].holes[h] });
      }
    }
  }
  std::vector<char>      linked;
  Groups                 groups = LinkItems(items, linked);
  const std::vector<int> slices = CountSlices(items, groups);
  int                    dropped = 0;
  std::vector<char>      open(items.size(), 0); // of groups
  for (std::size_t i = 0; i < items.size(); ++i)
  {
    const std::size_t g = groups.Find(i);
    if (slices[g] < minimumSlices && OpensToNeighbour(sections, items[i].slice, *items[i].polygon))
    {
      open[g] = 1;
    }
  }
  for (std::size_t i = items.size(); i-- > 0;)
  {
    const std::size_t g = groups.Find(i);
    if (slices[g] < minimumSlices && open[g] == 0)
    {
      auto & holes = sections[items[i].slice].pieces[items[i].piece].holes;
      holes.erase(holes.begin() + static_cast<std::ptrdiff_t>(items[i].index));
      ++dropped;
    }
  }
  return dropped;
}

double
SliceThickness(const std::vector<Section> & sections, std::size_t k)
{
  const std::size_t below = k > 0 ? k - 1 : k;
  const std::size_t above = k + 1 < sections.size() ? k + 1 : k;
  return above > below ? (sections[above].height - sections[below].height) / static_cast<double>(above - below) : 0.0;
}

} // namespace

bool
PolygonsOverlap(const Polygon & a, const Polygon & b)
{
  if (a.size() < 3 || b.size() < 3)
  {
    return false;
  }
  const Box boxA(a);
  const Box boxB(b);
  if ((boxA.low.array() > boxB.high.array()).any() || (boxB.low.array() > boxA.high.array()).any())
  {
    return false;
  }
  return PointInPolygon(a[0], b) || PointInPolygon(b[0], a) || EdgesCross(a, b);
}

std::vector<SectionPiece>
GroupPieces(std::vector<Polygon> contours, double minimumArea, int & dropped)
{
  std::vector<double> areas;
  for (const Polygon & contour : contours)
  {
    areas.push_back(SignedArea(contour));
  }
  std::vector<SectionPiece> pieces;
  std::vector<double>       outerAreas;
  std::vector<int>          pieceOf(contours.size(), -1);
  for (std::size_t c = 0; c < contours.size(); ++c)
  {
    if (areas[c] >= minimumArea)
    {
      pieceOf[c] = static_cast<int>(pieces.size());
      pieces.push_back({ contours[c], {}, {}, {} });
      outerAreas.push_back(areas[c]);
    }
    dropped += std::abs(areas[c]) < minimumArea;
  }
  for (std::size_t c = 0; c < contours.size(); ++c)
  {
    if (areas[c] > -minimumArea)
    {
      continue;
    }
    std::size_t owner = pieces.size();
    for (std::size_t p = 0; p < pieces.size(); ++p)
    {
      if (outerAreas[p] > -areas[c] && (owner == pieces.size() || outerAreas[p] < outerAreas[owner]) &&
          PointInPolygon(contours[c][0], pieces[p].outer))
      {
        owner = p;
      }
    }
    if (owner < pieces.size())
    {
      pieces[owner].holes.push_back(std::move(contours[c]));
    }
  }
  return pieces;
}

std::vector<std::string>
DropShortLived(std::vector<Section> & sections, int minimumSlices, double minimumVolume)
{
  std::vector<Item> items;
  int               occupied = 0;
  for (std::size_t k = 0; k < sections.size(); ++k)
  {
    occupied += !sections[k].pieces.empty();
    for (std::size_t p = 0; p < sections[k].pieces.size(); ++p)
    {
      items.push_back({ k, p, 0, &sections[k].pieces[p].outer });
    }
  }
  std::vector<std::string> lines;
  if (occupied < 2)
  {
    return lines;
  }
  std::vector<char>      linked;
  Groups                 groups = LinkItems(items, linked);
  const std::vector<int> slices = CountSlices(items, groups);
  std::vector<double>    volume(items.size(), 0.0);
  for (std::size_t i = 0; i < items.size(); ++i)
  {
    volume[groups.Find(i)] += SignedArea(*items[i].polygon) * SliceThickness(sections, items[i].slice);
  }
  int single = 0;
  int bodies = 0;
  for (std::size_t i = items.size(); i-- > 0;)
  {
    const std::size_t g = groups.Find(i);
    const bool        small = slices[g] < std::min(minimumSlices, occupied) || volume[g] < minimumVolume;
    if (linked[i] != 0 && !small)
    {
      continue;
    }
    single += linked[i] == 0;
    bodies += linked[i] != 0 && g == i;
    auto & pieces = sections[items[i].slice].pieces;
    pieces.erase(pieces.begin() + static_cast<std::ptrdiff_t>(items[i].piece));
  }
  const int holes = DropHoles(sections, std::min(2, occupied));
  if (single > 0)
  {
    lines.push_back(Sentence(single, "pieces that exist on one slice only"));
  }
  if (bodies > 0)
  {
    lines.push_back(Sentence(bodies, "bodies too short or too small"));
  }
  if (holes > 0)
  {
    lines.push_back(Sentence(holes, "holes that exist on one slice only"));
  }
  return lines;
}

int
DropShortLayers(std::vector<Section> & sections,
                std::vector<Polygon> SectionPiece::*inner,
                double                              smallestArea,
                int                                 minimumSlices)
{
  int               occupied = 0;
  std::vector<Item> items;
  for (std::size_t k = 0; k < sections.size(); ++k)
  {
    occupied += !sections[k].pieces.empty();
    for (std::size_t p = 0; p < sections[k].pieces.size(); ++p)
    {
      const auto & contours = sections[k].pieces[p].*inner;
      for (std::size_t i = 0; i < contours.size(); ++i)
      {
        items.push_back({ k, p, i, &contours[i] });
      }
    }
  }
  std::vector<char>      linked;
  Groups                 groups = LinkItems(items, linked);
  const std::vector<int> slices = CountSlices(items, groups);
  std::vector<char>      good(items.size(), 0);
  for (std::size_t i = 0; i < items.size(); ++i)
  {
    good[groups.Find(i)] |= SignedArea(*items[i].polygon) >= smallestArea;
  }
  int removed = 0;
  for (std::size_t i = items.size(); i-- > 0;)
  {
    const std::size_t g = groups.Find(i);
    if (good[g] == 0 || slices[g] < std::min(minimumSlices, occupied))
    {
      auto & contours = sections[items[i].slice].pieces[items[i].piece].*inner;
      contours.erase(contours.begin() + static_cast<std::ptrdiff_t>(items[i].index));
      ++removed;
    }
  }
  return removed;
}

ContourStack::SliceContainer
ToSlices(const std::vector<Section> & sections, const ContourStack & frame)
{
  ContourStack::SliceContainer slices;
  for (const Section & section : sections)
  {
    ContourSlice slice;
    slice.origin = frame.FromPlane(Vector2::Zero(), section.height);
    const auto add = [&](const Polygon & polygon, int layer, int region) {
      Contour contour;
      contour.layer = layer;
      contour.region = region;
      contour.id = static_cast<int>(slice.contours.size());
      for (const Vector2 & q : polygon)
      {
        contour.points.push_back(frame.FromPlane(q, section.height));
      }
      slice.contours.push_back(std::move(contour));
    };
    for (const SectionPiece & piece : section.pieces)
    {
      add(piece.outer, 0, Region::Cortical);
      for (const Polygon & hole : piece.holes)
      {
        add(hole, 0, Region::Outside);
      }
      for (const Polygon & endosteal : piece.endosteal)
      {
        add(endosteal, 1, Region::Trabecular);
      }
      for (const Polygon & medullary : piece.medullary)
      {
        add(medullary, 2, Region::Medullary);
      }
    }
    slices.push_back(std::move(slice));
  }
  return slices;
}
} // namespace bone
