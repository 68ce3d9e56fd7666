/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneProjectionModel.h"

#include "boneProjectedCells.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace bone
{
static_assert(ProjectionModel::Blocks::size == projection::lanes, "a block fills a vector");

namespace
{
/** Bits of a number, two zeros after each. */
std::uint32_t
Spread(std::uint32_t x)
{
  x = (x | (x << 16)) & 0x030000ff;
  x = (x | (x << 8)) & 0x0300f00f;
  x = (x | (x << 4)) & 0x030c30c3;
  return (x | (x << 2)) & 0x09249249;
}

/** The tetrahedra along a Morton curve through a grid that has about as many cubes as there are tetrahedra, so that
 * those that follow each other are near each other; in a cube by their numbers. */
std::vector<std::int32_t>
SortBySpace(const std::vector<Vector3> & points, const MeshCells & cells, const Execution & execution)
{
  const std::size_t count = cells.tetrahedra.size();
  Vector3           low = Vector3::Constant(std::numeric_limits<double>::max()), high = -low;
  for (const Vector3 & x : points)
  {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  int bits = 1;
  while (bits < 7 && (std::size_t{ 1 } << (3 * bits)) < count)
  {
    ++bits;
  }
  const double extent = (high - low).maxCoeff(), scale = extent > 0 ? 0.25 * ((1 << bits) - 1) / extent : 0.0;
  std::vector<std::uint32_t> key(count);
  const auto                 setKey = [&](std::size_t t) {
    const Id4 &   v = cells.tetrahedra[t];
    const Vector3 x = scale * (points[v[0]] + points[v[1]] + points[v[2]] + points[v[3]] - 4.0 * low);
    key[t] = Spread(static_cast<std::uint32_t>(x[0])) | Spread(static_cast<std::uint32_t>(x[1])) << 1 |
             Spread(static_cast<std::uint32_t>(x[2])) << 2;
  };
  execution.For(count, setKey, loopChunk);
  std::vector<std::uint32_t> start((std::size_t{ 1 } << (3 * bits)) + 1, 0);
  for (std::uint32_t k : key)
  {
    ++start[k + 1];
  }
  std::partial_sum(start.begin(), start.end(), start.begin());
  std::vector<std::int32_t> sorted(count);
  for (std::size_t t = 0; t < count; ++t)
  {
    sorted[start[key[t]]++] = static_cast<std::int32_t>(t);
  }
  return sorted;
}
} // namespace

std::size_t
ProjectionModel::Blocks::CoefficientsSize() const
{
  return static_cast<std::size_t>(BernsteinCount(degree) + 1) * size;
}

ProjectionModel::ProjectionModel(const std::vector<Vector3> &     points,
                                 const MeshCells &                cells,
                                 const MeshRadiographParameters & parameters,
                                 const Execution &                execution,
                                 bool                             keep)
  : m_Points(points)
  , m_Cells(cells)
  , m_Parameters(parameters)
{
  SetCells(SortBySpace(points, cells, execution));
  constexpr std::size_t chunk = 128;
  for (Blocks & blocks : m_Blocks)
  {
    const std::size_t count = (blocks.cells.size() + Blocks::size - 1) / Blocks::size,
                      perBlock = blocks.CoefficientsSize();
    blocks.cells.resize(count * Blocks::size, -1);
    blocks.centres.resize(count);
    blocks.halfSizes.resize(count);
    if (keep)
    {
      blocks.vertices.resize(count * Blocks::verticesSize);
      blocks.coefficients.resize(count * perBlock);
    }
    const auto set = [&](std::size_t b) {
      SetBox(blocks, b);
      if (keep)
      {
        Fill(blocks, b, &blocks.vertices[b * Blocks::verticesSize], &blocks.coefficients[b * perBlock]);
      }
    };
    execution.For(count, set, chunk);
  }
}

void
ProjectionModel::SetCells(const std::vector<std::int32_t> & sorted)
{
  const CellDensity density(m_Cells, m_Parameters);
  std::vector<int>  place(MaximumBernsteinDegree + 1, -1); // of each degree's blocks
  for (std::int32_t t : sorted)
  {
    if (!density.IsSelected(t))
    {
      continue;
    }
    const int degree = density.Degree(t);
    if (place[degree] < 0)
    {
      place[degree] = static_cast<int>(m_Blocks.size());
      m_Blocks.emplace_back();
      m_Blocks.back().degree = degree;
    }
    m_Blocks[place[degree]].cells.push_back(t);
  }
}

void
ProjectionModel::SetBox(Blocks & blocks, std::size_t block) const
{
  const std::int32_t * const cells = &blocks.cells[block * Blocks::size];
  Vector3                    low = m_Points[m_Cells.tetrahedra[cells[0]][0]], high = low;
  for (int g = 0; g < Blocks::size && cells[g] >= 0; ++g)
  {
    for (IdType v : m_Cells.tetrahedra[cells[g]])
    {
      low = low.cwiseMin(m_Points[v]);
      high = high.cwiseMax(m_Points[v]);
    }
  }
  blocks.centres[block] = 0.5 * (low + high);
  blocks.halfSizes[block] = 0.5 * (high - low);
}

void
ProjectionModel::Fill(const Blocks & blocks, std::size_t block, double * vertices, float * coefficients) const
{
  const CellDensity          density(m_Cells, m_Parameters);
  const std::size_t          count = BernsteinCount(blocks.degree);
  const std::int32_t * const cells = &blocks.cells[block * Blocks::size];
  for (int g = 0; g < Blocks::size; ++g)
  {
    // The last block is filled up with its first cell.
    const auto t = static_cast<std::size_t>(cells[g] >= 0 ? cells[g] : cells[0]);
    for (int i = 0; i < 4; ++i)
    {
      const Vector3 & x = m_Points[m_Cells.tetrahedra[t][i]];
      for (int k = 0; k < 3; ++k)
      {
        vertices[(3 * i + k) * Blocks::size + g] = x[k];
      }
    }
    const double * const from = density.Coefficients(t);
    float                largest = 0.0f;
    for (std::size_t p = 0; p < count; ++p)
    {
      const auto value = static_cast<float>(m_Parameters.scale * from[p] + m_Parameters.offset);
      coefficients[p * Blocks::size + g] = value;
      largest = std::max(largest, std::abs(value));
    }
    coefficients[count * Blocks::size + g] = largest;
  }
  projection::SelectKernels(m_Parameters.portable).expand(blocks.degree, coefficients);
}
} // namespace bone
