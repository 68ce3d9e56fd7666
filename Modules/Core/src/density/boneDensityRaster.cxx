/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneDensityRaster.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <tuple>

namespace bone
{
namespace
{
/** First and last whole number of the range, made a hair wider and clipped to [0, size). */
std::pair<int, int>
WholeNumbersIn(double lower, double upper, int size)
{
  constexpr double hair = 1e-6;
  const double     first = std::max(std::ceil(lower - hair), 0.0);
  const double     last = std::min(std::floor(upper + hair), size - 1.0);
  return first <= last ? std::make_pair(static_cast<int>(first), static_cast<int>(last)) : std::make_pair(0, -1);
}
} // namespace

DensityRaster::DensityRaster(const MeshArrays & mesh, const VoxelGrid & grid)
  : m_Mesh(mesh)
  , m_Grid(grid)
  , m_Cells(mesh.tetrahedra.size())
  , m_Start(static_cast<std::size_t>(grid.size[2]) + 1, 0)
{
  if (!mesh.HasDensity())
  {
    throw std::invalid_argument("The mesh holds no density: fit one first.");
  }
  if (!(grid.VoxelVolume() > 0))
  {
    throw std::invalid_argument("The grid's axes are singular.");
  }
  const Eigen::Matrix3d            toIndex = grid.axes.inverse();
  std::vector<std::pair<int, int>> slices(m_Cells.size());
  for (std::size_t t = 0; t < m_Cells.size(); ++t)
  {
    Eigen::Matrix<double, 3, 4> x;
    for (int i = 0; i < 4; ++i)
    {
      x.col(i) = toIndex * (mesh.points[mesh.tetrahedra[t][i]] - grid.origin);
    }
    Cell &                cell = m_Cells[t];
    const Eigen::Matrix3d edges = x.rightCols<3>().colwise() - x.col(0);
    const double          determinant = edges.determinant();
    const Vector3         lower = x.rowwise().minCoeff(), upper = x.rowwise().maxCoeff();
    const double          diagonal = (upper - lower).norm();
    cell.origin = x.col(0);
    cell.inverse = edges.inverse();
    cell.tolerance =
      1e-10 + 64 * std::numeric_limits<double>::epsilon() * diagonal * diagonal * diagonal / std::abs(determinant);
    std::tie(cell.firstRow, cell.lastRow) = WholeNumbersIn(lower[1], upper[1], grid.size[1]);
    const bool solid = determinant * toIndex.determinant() > 0 && cell.tolerance < 1e-3;
    slices[t] = solid ? WholeNumbersIn(lower[2], upper[2], grid.size[2]) : std::make_pair(0, -1);
    for (int k = slices[t].first; k <= slices[t].second; ++k)
    {
      ++m_Start[k + 1];
    }
  }
  for (std::size_t k = 1; k < m_Start.size(); ++k)
  {
    m_Start[k] += m_Start[k - 1];
  }
  m_List.resize(m_Start.back());
  std::vector<std::size_t> next(m_Start.begin(), m_Start.end() - 1);
  for (std::size_t t = m_Cells.size(); t-- > 0;)
  {
    for (int k = slices[t].first; k <= slices[t].second; ++k)
    {
      m_List[next[k]++] = static_cast<IdType>(t);
    }
  }
}

void
DensityRaster::FillSlice(int k, double outside, double * values, IdType * cells) const
{
  const std::size_t size = static_cast<std::size_t>(m_Grid.size[0]) * m_Grid.size[1];
  std::fill_n(values, size, outside);
  if (cells != nullptr)
  {
    std::fill_n(cells, size, -1);
  }
  for (std::size_t entry = m_Start[k]; entry < m_Start[k + 1]; ++entry)
  {
    const IdType t = m_List[entry];
    for (int j = m_Cells[t].firstRow; j <= m_Cells[t].lastRow; ++j)
    {
      const std::size_t row = static_cast<std::size_t>(j) * m_Grid.size[0];
      this->FillRow(t, j, k, values + row, cells != nullptr ? cells + row : nullptr);
    }
  }
}

void
DensityRaster::FillRow(IdType t, int j, int k, double * values, IdType * cells) const
{
  const Cell &      cell = m_Cells[t];
  const Vector3     mu0 = cell.inverse * (Vector3(0, j, k) - cell.origin);
  const Barycentric start(1 - mu0.sum(), mu0[0], mu0[1], mu0[2]);
  const Barycentric step(-cell.inverse.col(0).sum(), cell.inverse(0, 0), cell.inverse(1, 0), cell.inverse(2, 0));
  // start + i step >= -tolerance in all four coordinates bounds i.
  double lower = 0, upper = m_Grid.size[0] - 1.0;
  for (int m = 0; m < 4; ++m)
  {
    const double reach = start[m] + cell.tolerance;
    if (step[m] > 0)
    {
      lower = std::max(lower, -reach / step[m]);
    }
    else if (step[m] < 0)
    {
      upper = std::min(upper, -reach / step[m]);
    }
    else if (reach < 0)
    {
      return;
    }
  }
  const int      degree = m_Mesh.degree[t];
  const double * c = &m_Mesh.coefficients[static_cast<std::size_t>(t) * BernsteinCount(m_Mesh.maximumDegree)];
  const double   last = std::floor(upper);
  for (double i = std::ceil(lower); i <= last; ++i)
  {
    const auto at = static_cast<std::size_t>(i);
    values[at] = BernsteinValue(degree, c, start + i * step);
    if (cells != nullptr)
    {
      cells[at] = t;
    }
  }
}
} // namespace bone
