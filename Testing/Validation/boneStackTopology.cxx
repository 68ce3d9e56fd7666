/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneStackTopology.h"

#include "boneMeshValidator.h"

#include <itkConnectedComponentImageFilter.h>
#include <itkImageRegionIterator.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <set>

namespace bone
{
namespace
{
using Mask = itk::Image<unsigned char, 3>;
using Labels = itk::Image<unsigned int, 3>;
using Polygon = std::vector<Vector2>;

constexpr double SpeckShare = 0.05; ///< of the largest part in which two pieces overlap

struct Grid
{
  Vector2 low;
  double  pixel;
  int     nx, ny;
};

Grid
GridOf(const ContourStack & stack, double pixel)
{
  Vector2 low = Vector2::Constant(std::numeric_limits<double>::max()), high = -low;
  for (const ContourSlice & slice : stack.GetSlices())
  {
    for (const Contour & contour : slice.contours)
    {
      for (const Vector3 & p : contour.points)
      {
        low = low.cwiseMin(stack.ToPlane(p));
        high = high.cwiseMax(stack.ToPlane(p));
      }
    }
  }
  const Vector2 size = (high - low) / pixel;
  return {
    low - Vector2::Constant(1.5 * pixel), pixel, static_cast<int>(size.x()) + 4, static_cast<int>(size.y()) + 4
  };
}

/** Writes the contour's region to the pixels whose centre lies inside. */
void
Fill(const Grid & grid, const Polygon & polygon, int region, std::vector<unsigned char> & slice)
{
  for (int j = 0; j < grid.ny; ++j)
  {
    const double        y = grid.low.y() + j * grid.pixel;
    std::vector<double> crossings;
    for (std::size_t i = 0; i < polygon.size(); ++i)
    {
      const Vector2 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
      if ((a.y() <= y) != (b.y() <= y))
      {
        crossings.push_back(a.x() + (b.x() - a.x()) * (y - a.y()) / (b.y() - a.y()));
      }
    }
    std::sort(crossings.begin(), crossings.end());
    for (std::size_t i = 0; i + 1 < crossings.size(); i += 2)
    {
      const auto first = static_cast<int>(std::ceil((crossings[i] - grid.low.x()) / grid.pixel));
      const auto last = static_cast<int>(std::floor((crossings[i + 1] - grid.low.x()) / grid.pixel));
      for (int x = first; x <= last; ++x)
      {
        slice[static_cast<std::size_t>(j) * grid.nx + x] = static_cast<unsigned char>(region);
      }
    }
  }
}

/** The region at each pixel of a slice: that of the smallest contour it lies in. */
std::vector<unsigned char>
Regions(const ContourStack & stack, const ContourSlice & slice, const Grid & grid)
{
  std::vector<std::pair<double, std::pair<Polygon, int>>> polygons;
  for (const Contour & contour : slice.contours)
  {
    Polygon polygon;
    for (const Vector3 & p : contour.points)
    {
      polygon.push_back(stack.ToPlane(p));
    }
    if (!contour.axis)
    {
      polygons.push_back({ -std::abs(SignedArea(polygon)), { polygon, contour.region } });
    }
  }
  std::sort(polygons.begin(), polygons.end(), [](const auto & a, const auto & b) { return a.first < b.first; });
  std::vector<unsigned char> regions(static_cast<std::size_t>(grid.nx) * grid.ny, 0);
  for (const auto & polygon : polygons)
  {
    Fill(grid, polygon.second.first, polygon.second.second, regions);
  }
  return regions;
}

Mask::Pointer
MaskOf(const ContourStack & stack, int least, double pixel)
{
  const Grid grid = GridOf(stack, pixel);
  auto       mask = Mask::New();
  // A slice of background on either side joins all that is outside.
  mask->SetRegions(Mask::SizeType{ { static_cast<itk::SizeValueType>(grid.nx),
                                     static_cast<itk::SizeValueType>(grid.ny),
                                     stack.GetSlices().size() + 2 } });
  mask->Allocate(true);
  unsigned char * out = mask->GetBufferPointer();
  for (const ContourSlice & slice : stack.GetSlices())
  {
    out += static_cast<std::ptrdiff_t>(grid.nx) * grid.ny;
    const auto regions = Regions(stack, slice, grid);
    std::transform(regions.begin(), regions.end(), out, [least](unsigned char r) { return r >= least; });
  }
  return mask;
}

Mask::Pointer
Complement(const Mask * mask)
{
  auto other = Mask::New();
  other->SetRegions(mask->GetLargestPossibleRegion());
  other->Allocate();
  const auto n = mask->GetLargestPossibleRegion().GetNumberOfPixels();
  std::transform(mask->GetBufferPointer(),
                 mask->GetBufferPointer() + n,
                 other->GetBufferPointer(),
                 [](unsigned char v) { return v == 0; });
  return other;
}

Labels::Pointer
Label(Mask * mask, bool corners, int & count)
{
  auto filter = itk::ConnectedComponentImageFilter<Mask, Labels>::New();
  filter->SetInput(mask);
  filter->SetFullyConnected(corners);
  filter->Update();
  count = static_cast<int>(filter->GetObjectCount());
  return filter->GetOutput();
}

/** Euler characteristic of pixels joined over their edges (voxels over their faces). */
long
EulerOfMask(const Mask * mask)
{
  const auto            size = mask->GetLargestPossibleRegion().GetSize();
  const auto            nx = static_cast<std::ptrdiff_t>(size[0]), ny = static_cast<std::ptrdiff_t>(size[1]);
  const unsigned char * p = mask->GetBufferPointer();
  const std::ptrdiff_t  step[] = { 1, nx, nx * ny };
  const std::ptrdiff_t  end = nx * ny * static_cast<std::ptrdiff_t>(size[2] - 1) - nx - 1;
  long                  euler = 0;
  for (std::ptrdiff_t i = 0; i < end; ++i)
  {
    if (!p[i])
    {
      continue; // the last slices, rows and columns are empty
    }
    const bool x = p[i + step[0]], y = p[i + step[1]], z = p[i + step[2]];
    const bool xy = x && y && p[i + step[0] + step[1]], xz = x && z && p[i + step[0] + step[2]],
               yz = y && z && p[i + step[1] + step[2]];
    euler += 1 - x - y - z + xy + xz + yz - (xy && xz && yz && p[i + step[0] + step[1] + step[2]]);
  }
  return euler;
}

/** Labels the pixels of a slice that touch along edges, from 1; 0 is outside. Returns the number of parts. */
int
LabelSlice(const std::vector<unsigned char> & slice, std::ptrdiff_t nx, std::vector<int> & label)
{
  int parts = 0;
  label.assign(slice.size(), 0);
  std::vector<std::ptrdiff_t> front;
  for (std::size_t seed = 0; seed < slice.size(); ++seed)
  {
    if (!slice[seed] || label[seed])
    {
      continue;
    }
    label[seed] = ++parts;
    front.push_back(static_cast<std::ptrdiff_t>(seed));
    while (!front.empty())
    {
      const std::ptrdiff_t here = front.back();
      front.pop_back();
      for (const std::ptrdiff_t next : { here - 1, here + 1, here - nx, here + nx })
      {
        if (slice[next] && !label[next]) // the rim is empty
        {
          label[next] = parts;
          front.push_back(next);
        }
      }
    }
  }
  return parts;
}

/** Euler characteristic of the specks of overlap of two slices: parts much smaller than another part of the overlap of
 * the same two pieces. */
long
EulerOfSpecks(const std::vector<unsigned char> & below, const std::vector<unsigned char> & above, std::ptrdiff_t nx)
{
  std::vector<unsigned char> both(below.size());
  std::transform(
    below.begin(), below.end(), above.begin(), both.begin(), [](unsigned char a, unsigned char b) { return a && b; });
  std::vector<int> lower, upper, part;
  LabelSlice(below, nx, lower);
  LabelSlice(above, nx, upper);
  const int                          parts = LabelSlice(both, nx, part);
  std::vector<long>                  euler(parts + 1, 0), size(parts + 1, 0);
  std::vector<std::array<int, 2>>    pair(parts + 1);
  std::map<std::array<int, 2>, long> largest;
  for (std::size_t i = 0; i < part.size(); ++i)
  {
    const int p = part[i];
    if (p == 0)
    {
      continue;
    }
    const bool x = part[i + 1] == p, y = part[i + nx] == p, xy = x && y && part[i + nx + 1] == p;
    euler[p] += 1 - x - y + xy;
    pair[p] = { { lower[i], upper[i] } };
    largest[pair[p]] = std::max(largest[pair[p]], ++size[p]);
  }
  long sum = 0;
  for (int p = 1; p <= parts; ++p)
  {
    sum += static_cast<double>(size[p]) < SpeckShare * static_cast<double>(largest[pair[p]]) ? euler[p] : 0;
  }
  return sum;
}

long
EulerOfSpecks(const Mask * mask)
{
  const auto                 size = mask->GetLargestPossibleRegion().GetSize();
  const auto                 area = static_cast<std::ptrdiff_t>(size[0] * size[1]);
  const unsigned char *      p = mask->GetBufferPointer();
  std::vector<unsigned char> below(p, p + area);
  long                       sum = 0;
  for (std::size_t k = 1; k < size[2]; ++k)
  {
    p += area;
    const std::vector<unsigned char> above(p, p + area);
    sum += EulerOfSpecks(below, above, static_cast<std::ptrdiff_t>(size[0]));
    below = above;
  }
  return sum;
}

long
EulerOfMesh(const MeshArrays & mesh, int least)
{
  std::set<IdType>                points;
  std::set<std::array<IdType, 2>> edges;
  std::set<std::array<IdType, 3>> faces;
  long                            cells = 0;
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
  {
    if (mesh.region[t] < least)
    {
      continue;
    }
    ++cells;
    Id4 c = mesh.tetrahedra[t];
    std::sort(c.begin(), c.end());
    for (int i = 0; i < 4; ++i)
    {
      points.insert(c[i]);
      faces.insert({ { c[i == 0], c[1 + (i <= 1)], c[2 + (i <= 2)] } });
      for (int j = i + 1; j < 4; ++j)
      {
        edges.insert({ { c[i], c[j] } });
      }
    }
  }
  return static_cast<long>(points.size()) - static_cast<long>(edges.size()) + static_cast<long>(faces.size()) - cells;
}

/** Number of sets of points that `pairs` join. */
int
CountJoined(const std::vector<std::vector<IdType>> & joined, std::size_t points)
{
  std::vector<IdType> root(points);
  std::iota(root.begin(), root.end(), 0);
  const auto find = [&root](IdType p) {
    while (root[p] != p)
    {
      p = root[p] = root[root[p]];
    }
    return p;
  };
  std::set<IdType> roots;
  for (const auto & set : joined)
  {
    for (IdType p : set)
    {
      root[find(p)] = find(set[0]);
    }
  }
  for (const auto & set : joined)
  {
    roots.insert(find(set[0]));
  }
  return static_cast<int>(roots.size());
}
} // namespace

std::ostream &
operator<<(std::ostream & os, const BodyTopology & topology)
{
  return os << topology.components << '/' << topology.handles << '/' << topology.voids;
}

StackTopology::StackTopology(const ContourStack & stack, int least, double pixel)
{
  const Mask::Pointer   mask = MaskOf(stack, least, pixel);
  int                   outside = 0;
  const Labels::Pointer around = Label(Complement(mask), true, outside);
  if (least == 1)
  {
    const unsigned int open = around->GetBufferPointer()[0];
    const auto         n = mask->GetLargestPossibleRegion().GetNumberOfPixels();
    std::transform(around->GetBufferPointer(),
                   around->GetBufferPointer() + n,
                   mask->GetBufferPointer(),
                   [open](unsigned int label) { return label != open; });
    outside = 1;
  }
  Label(mask, false, topology.components);
  topology.voids = outside - 1;
  topology.handles = topology.components + topology.voids - static_cast<int>(EulerOfMask(mask));
  handlesWithoutSpecks = topology.handles - static_cast<int>(EulerOfSpecks(mask));
}

BodyTopology
TopologyOfMesh(const MeshArrays & mesh, int least)
{
  std::vector<std::vector<IdType>> cells, faces;
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
  {
    if (mesh.region[t] >= least)
    {
      cells.emplace_back(mesh.tetrahedra[t].begin(), mesh.tetrahedra[t].end());
    }
  }
  for (const auto & f : BoundaryFaces(mesh, least))
  {
    faces.emplace_back(f.begin(), f.end());
  }
  BodyTopology topology;
  topology.components = CountJoined(cells, mesh.points.size());
  topology.voids = CountJoined(faces, mesh.points.size()) - topology.components;
  topology.handles = topology.components + topology.voids - static_cast<int>(EulerOfMesh(mesh, least));
  return topology;
}
} // namespace bone
