/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSlabTopology.h"

#include "boneStackPixels.h"
#include "boneStackTopology.h"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <set>
#include <sstream>

namespace bone
{
namespace
{
constexpr int MostFiner = 8; ///< pixels, where the first give other counts
/** mm^2, a tenth of a millimetre across: how far a filled slab's slices may be moved where its cells were too flat. */
constexpr double SliverArea = 0.01;

struct Counts
{
  int  components;
  long euler;

  bool
  operator==(const Counts & other) const
  {
    return components == other.components && euler == other.euler;
  }
};

/** The parts of a slice that lie in the regions from `least` inward, numbered from 1. */
struct Pieces
{
  std::vector<int> label;      ///< of each pixel, 0: none
  std::vector<int> periosteal; ///< of each piece: id of the periosteal contour it lies in
  long             euler{ 0 };
};

/** Ids of each slice's contours that bound no hole in the regions from `least` inward because it is a void of the whole
 * body, which the tiling fills. */
std::vector<std::set<int>>
ClosedHoles(const ContourStack & stack, int least, double pixel)
{
  std::vector<std::set<int>> closed(stack.GetSlices().size());
  if (least > 1)
  {
    return closed;
  }
  const PixelGrid       grid = PixelGridOf(stack, pixel);
  int                   outside = 0;
  const auto            filled = PixelsInside(stack, least, pixel, outside);
  const std::ptrdiff_t  area = static_cast<std::ptrdiff_t>(grid.nx) * grid.ny;
  const unsigned char * slice = filled->GetBufferPointer();
  for (std::size_t k = 0; k < closed.size(); ++k)
  {
    slice += area;
    for (const PlaneContour & contour : PlaneContoursOf(stack, stack.GetSlices()[k]))
    {
      if (contour.region == Region::Outside)
      {
        std::vector<int> hole(area, 0);
        FillPolygon(grid, contour.polygon, 1, hole);
        bool any = false;
        for (std::ptrdiff_t i = 0; i < area && !any; ++i)
        {
          any = hole[i] != 0 && slice[i] != 0;
        }
        if (any)
        {
          closed[k].insert(contour.id);
        }
      }
    }
  }
  return closed;
}

Pieces
PiecesOf(const ContourStack &               stack,
         int                                slice,
         int                                least,
         const PixelGrid &                  grid,
         const std::vector<std::set<int>> & closed)
{
  Pieces pieces;
  pieces.label.assign(static_cast<std::size_t>(grid.nx) * grid.ny, 0);
  if (slice < 0 || slice >= static_cast<int>(closed.size()))
  {
    return pieces;
  }
  const auto       contours = PlaneContoursOf(stack, stack.GetSlices()[slice]);
  std::vector<int> pieceOf(contours.size(), 0), outermost(contours.size(), 0);
  for (std::size_t c = 0; c < contours.size(); ++c)
  {
    const PlaneContour & contour = contours[c];
    const int            around = contour.parent < 0 ? 0 : pieceOf[contour.parent];
    const bool           begins = contour.parent < 0 || contours[contour.parent].region == Region::Outside;
    outermost[c] = begins ? contour.id : outermost[contour.parent];
    if (around > 0 && (contour.region >= least || closed[slice].count(contour.id) > 0))
    {
      pieceOf[c] = around;
    }
    else if (contour.region >= least)
    {
      pieces.periosteal.push_back(outermost[c]);
      pieceOf[c] = static_cast<int>(pieces.periosteal.size());
      ++pieces.euler;
    }
    else if (around > 0)
    {
      --pieces.euler;
    }
    FillPolygon(grid, contour.polygon, pieceOf[c], pieces.label);
  }
  return pieces;
}

/** Where a piece below and one above overlap. */
struct Overlap
{
  int  parts{ 0 };
  int  slivers{ 0 }; ///< parts of less than SliverArea
  long euler{ 0 };
};

std::map<std::array<int, 2>, Overlap>
FindOverlaps(const Pieces & below, const Pieces & above, const PixelGrid & grid)
{
  const std::ptrdiff_t                  nx = grid.nx;
  std::map<std::array<int, 2>, Overlap> overlaps;
  std::vector<char>                     seen(below.label.size(), 0);
  std::vector<std::ptrdiff_t>           front;
  for (std::size_t seed = 0; seed < seen.size(); ++seed)
  {
    const std::array<int, 2> pair{ { below.label[seed], above.label[seed] } };
    const auto               inside = [&](std::ptrdiff_t i) {
      return pair[0] != 0 && pair[1] != 0 && below.label[i] == pair[0] && above.label[i] == pair[1];
    };
    if (seen[seed] || !inside(static_cast<std::ptrdiff_t>(seed)))
    {
      continue;
    }
    Overlap & overlap = overlaps[pair];
    ++overlap.parts;
    std::size_t pixels = 0;
    front.assign(1, static_cast<std::ptrdiff_t>(seed));
    seen[seed] = 1;
    while (!front.empty())
    {
      const std::ptrdiff_t i = front.back();
      front.pop_back();
      ++pixels;
      const bool x = inside(i + 1), y = inside(i + nx), xy = x && y && inside(i + nx + 1);
      overlap.euler += 1 - x - y + xy;
      for (const std::ptrdiff_t next : { i - 1, i + 1, i - nx, i + nx })
      {
        if (!seen[next] && inside(next)) // the rim is empty
        {
          seen[next] = 1;
          front.push_back(next);
        }
      }
    }
    overlap.slivers += static_cast<double>(pixels) * grid.pixel * grid.pixel < SliverArea;
  }
  return overlaps;
}

/** Group of each piece below, then above: of all the pieces of bone that correspond; -1 of one that is not named. */
std::vector<int>
GroupsOf(const std::vector<ContourCorrespondence::Group> & groups, const Pieces & below, const Pieces & above)
{
  std::vector<int> result;
  const auto       add = [&](const Pieces & pieces, std::vector<int> ContourCorrespondence::Group::*side) {
    for (const int id : pieces.periosteal)
    {
      const auto found = std::find_if(groups.begin(), groups.end(), [&](const auto & group) {
        return std::count(std::begin(group.*side), std::end(group.*side), id) > 0;
      });
      result.push_back(found == groups.end() ? -1 : static_cast<int>(found - groups.begin()));
    }
  };
  add(below, &ContourCorrespondence::Group::lower);
  add(above, &ContourCorrespondence::Group::upper);
  return result;
}

/** Number of pieces that overlap none. */
int
CountAlone(const std::vector<std::vector<IdType>> & joined, std::size_t pieces)
{
  std::vector<char> alone(pieces, 1);
  for (const auto & set : joined)
  {
    for (const IdType i : set)
    {
      alone[i] = alone[i] != 0 && set.size() == 1;
    }
  }
  return static_cast<int>(std::count(alone.begin(), alone.end(), 1));
}

std::vector<Counts>
AllowedCounts(const Pieces &                                    below,
              const Pieces &                                    above,
              const std::vector<ContourCorrespondence::Group> & groups,
              const PixelGrid &                                 grid)
{
  const std::vector<int>           group = GroupsOf(groups, below, above);
  const auto                       lower = static_cast<int>(below.periosteal.size());
  std::vector<std::vector<IdType>> joined;
  for (std::size_t i = 0; i < group.size(); ++i)
  {
    joined.push_back({ static_cast<IdType>(i) });
  }
  long byParts = below.euler + above.euler, byPairs = byParts;
  int  slivers = 0;
  for (const auto & [pair, overlap] : FindOverlaps(below, above, grid))
  {
    const int i = pair[0] - 1, j = lower + pair[1] - 1;
    if (group[i] == group[j])
    {
      joined.push_back({ i, j });
      byParts -= overlap.euler;
      slivers += overlap.parts > 1 ? overlap.slivers : 0;
      byPairs -= 1 - (overlap.parts - overlap.euler);
    }
  }
  const int components = CountJoined(joined, group.size());
  const int alone = CountAlone(joined, group.size());
  // Joined also where only the pieces of bone around them correspond.
  for (std::size_t i = 0; i < group.size(); ++i)
  {
    for (std::size_t j = lower; j < group.size() && static_cast<int>(i) < lower; ++j)
    {
      if (group[i] == group[j])
      {
        joined.push_back({ static_cast<IdType>(i), static_cast<IdType>(j) });
      }
    }
  }
  const int         fewer = CountJoined(joined, group.size());
  std::vector<long> eulers{ byPairs };
  for (int left = 0; left <= slivers; ++left)
  {
    eulers.push_back(byParts + left);
  }
  std::vector<Counts> allowed;
  for (const long euler : eulers)
  {
    for (int joins = 0; joins <= components - fewer; ++joins)
    {
      for (int flat = 0; flat <= alone; ++flat)
      {
        allowed.push_back({ components - joins - flat, euler - joins - flat });
      }
    }
  }
  return allowed;
}

/** Cells from `least` inward by slab, the end before the first slice included. */
std::vector<std::vector<std::size_t>>
CellsOfSlabs(const MeshArrays & mesh, const ContourStack & stack, int least)
{
  std::vector<double> heights;
  for (std::size_t k = 0; k < stack.GetSlices().size(); ++k)
  {
    heights.push_back(stack.GetHeight(k));
  }
  std::vector<std::vector<std::size_t>> cells(heights.size() + 1);
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
  {
    if (mesh.region[t] >= least)
    {
      Vector3 sum = Vector3::Zero();
      for (const IdType p : mesh.tetrahedra[t])
      {
        sum += mesh.points[p];
      }
      const double height = 0.25 * sum.dot(stack.GetNormal());
      cells[std::upper_bound(heights.begin(), heights.end(), height) - heights.begin()].push_back(t);
    }
  }
  return cells;
}

Counts
CountsOf(const MeshArrays & mesh, const std::vector<std::size_t> & cells)
{
  std::vector<std::vector<IdType>> tuples;
  for (const std::size_t t : cells)
  {
    tuples.emplace_back(mesh.tetrahedra[t].begin(), mesh.tetrahedra[t].end());
  }
  return { CountJoined(tuples, mesh.points.size()), EulerOfCells(mesh, cells) };
}
} // namespace

std::vector<std::string>
FindSlabsOfOtherTopology(const MeshArrays &            mesh,
                         const ContourStack &          stack,
                         const ContourCorrespondence & correspondence,
                         int                           least,
                         double                        pixel)
{
  const auto               closed = ClosedHoles(stack, least, pixel);
  const auto               cells = CellsOfSlabs(mesh, stack, least);
  const auto               slices = static_cast<int>(stack.GetSlices().size());
  std::vector<std::string> differing;
  for (int k = 0; k <= slices; ++k)
  {
    if (cells[k].empty() && ((k == 0 && stack.GetOpenStart()) || (k == slices && stack.GetOpenEnd())))
    {
      continue; // the bone is cut here
    }
    const auto          given = correspondence.slabs.find(k - 1);
    const auto          groups = given == correspondence.slabs.end() ? decltype(given->second){} : given->second;
    const Counts        found = CountsOf(mesh, cells[k]);
    std::vector<Counts> allowed;
    bool                same = false;
    for (int finer = 1; finer <= MostFiner && !same; finer *= 2)
    {
      const PixelGrid grid = PixelGridOf(stack, pixel / finer);
      allowed = AllowedCounts(
        PiecesOf(stack, k - 1, least, grid, closed), PiecesOf(stack, k, least, grid, closed), groups, grid);
      same = std::find(allowed.begin(), allowed.end(), found) != allowed.end();
    }
    if (!same)
    {
      std::ostringstream line;
      line << "region " << least << ", slices " << k - 1 << " to " << k << ": components " << found.components
           << ", Euler characteristic " << found.euler << "; of the stack";
      for (const Counts & one : allowed)
      {
        line << ' ' << one.components << ',' << one.euler;
      }
      differing.push_back(line.str());
    }
  }
  return differing;
}
} // namespace bone
