/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneProjectedCells.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace bone
{
namespace
{
/** A cell of which a vertex is nearer to the source's plane than this part of the way to the detector takes the general
 * path: its projection may be unbounded. */
constexpr double nearSource = 0.02;
} // namespace

ProjectedCells::ProjectedCells(const std::vector<Vector3> &  points,
                               const MeshArrays &            cells,
                               const XRayGeometry::View &    view,
                               const MeshRadiographOptions & options,
                               int                           bandRows)
  : m_Points(points)
  , m_Cells(cells)
  , m_Options(options)
  , m_Density(cells, options)
  , m_Frame(RayFrame::Displaced(view))
  , m_BandRows(bandRows)
{}

void
ProjectedCells::Prepare(const ParallelFor & parallelFor)
{
  m_Projected.resize(m_Points.size());
  ForEachInBlocks(parallelFor, m_Points.size(), [&](std::size_t p) { m_Projected[p] = m_Frame.Project(m_Points[p]); });
  m_Rows.resize(m_Cells.tetrahedra.size());
  ForEachInBlocks(parallelFor, m_Rows.size(), [&](std::size_t t) { Locate(t); });
  m_HasGeneral =
    std::any_of(m_Rows.begin(), m_Rows.end(), [](const RowRange & range) { return range.path == Path::General; });
  FillBins();
}

double
ProjectedCells::MeanParameter() const
{
  const double sum = std::accumulate(
    m_Projected.begin(), m_Projected.end(), 0.0, [](double before, const Vector3 & p) { return before + p[2]; });
  return m_Projected.empty() ? 0.0 : sum / static_cast<double>(m_Projected.size());
}

projection::CellGroup
ProjectedCells::EmptyGroup() const
{
  projection::CellGroup group;
  group.count = 0;
  group.scale = m_Options.scale;
  group.offset = m_Options.offset;
  group.parallel = m_Frame.IsParallel();
  return group;
}

void
ProjectedCells::Locate(std::size_t t)
{
  RowRange & range = m_Rows[t];
  if (!m_Density.IsSelected(t))
  {
    return;
  }
  double low[3], high[3];
  for (int k = 0; k < 3; ++k)
  {
    const Id4 & v = m_Cells.tetrahedra[t];
    const auto  x = { m_Projected[v[0]][k], m_Projected[v[1]][k], m_Projected[v[2]][k], m_Projected[v[3]][k] };
    low[k] = std::min(x);
    high[k] = std::max(x);
  }
  // s at the detector is 1 with a point source, 0 in a parallel beam.
  const double detector = m_Frame.DetectorDepth();
  if (low[2] >= detector || (!m_Frame.IsParallel() && high[2] <= 0))
  {
    return;
  }
  if (high[2] > detector || (!m_Frame.IsParallel() && low[2] < nearSource))
  {
    range = { 0, m_Frame.Rows(), Path::General };
    return;
  }
  const bool   seen = high[0] >= 0 && low[0] <= m_Frame.Columns() - 1 && std::ceil(low[0]) <= std::floor(high[0]);
  const double first = std::max(0.0, std::ceil(low[1])), last = std::min(m_Frame.Rows() - 1.0, std::floor(high[1]));
  if (seen && first <= last)
  {
    range = { static_cast<std::int32_t>(first), static_cast<std::int32_t>(last) + 1, Path::Kernel };
  }
}

void
ProjectedCells::FillBins()
{
  const std::size_t bins = (m_Frame.Rows() + m_BandRows - 1) / m_BandRows;
  m_BinStart.assign(bins + 1, 0);
  const auto forEachBin = [&](const auto & function) {
    for (std::size_t t = 0; t < m_Rows.size(); ++t)
    {
      for (int bin = m_Rows[t].first / m_BandRows; bin * m_BandRows < m_Rows[t].end; ++bin)
      {
        function(static_cast<IdType>(t), bin);
      }
    }
  };
  forEachBin([&](IdType, int bin) { ++m_BinStart[bin + 1]; });
  std::partial_sum(m_BinStart.begin(), m_BinStart.end(), m_BinStart.begin());
  m_BinCells.resize(m_BinStart.back());
  auto next = m_BinStart;
  forEachBin([&](IdType t, int bin) { m_BinCells[next[bin]++] = t; });
}

void
ProjectedCells::Append(std::size_t t, projection::CellGroup & group) const
{
  for (int i = 0; i < 4; ++i)
  {
    const Vector3 & p = m_Projected[m_Cells.tetrahedra[t][i]];
    group.column[i][group.count] = p[0];
    group.row[i][group.count] = p[1];
    group.s[i][group.count] = p[2];
  }
  group.degree = m_Density.Degree(t);
  group.coefficients[group.count++] = m_Density.Coefficients(t);
}

// Columns whose rays may meet the cell: those where no back plane lies before a front plane.
ColumnRun
ProjectedCells::ColumnsOfRow(const CellLines & lines, int row) const
{
  const double     detectorDepth = m_Frame.DetectorDepth();
  const int        columns = m_Frame.Columns();
  constexpr double margin = 1e-6;
  ColumnRun        run{ 0.0, columns - 1.0 };
  for (const auto & front : lines)
  {
    if (front.depth > 0)
    {
      continue;
    }
    if (front.depth == 0)
    {
      run.Keep(front.At(0, row), front.column);
      continue;
    }
    // The front plane's depth less that of the detector, then less that of each back plane.
    const double constant = -front.At(0, row) / front.depth, perColumn = -front.column / front.depth;
    run.Keep(constant - detectorDepth, perColumn);
    for (const auto & back : lines)
    {
      if (back.depth > 0)
      {
        run.Keep(constant + back.At(0, row) / back.depth, perColumn + back.column / back.depth);
      }
    }
  }
  run.first = std::ceil(std::clamp(run.first - margin, 0.0, static_cast<double>(columns)));
  run.last = std::floor(std::min(columns - 1.0, run.last + margin));
  return run;
}

bool
ClipDepth(const CellLines & lines, double detectorDepth, double column, double row, double (&depth)[2], int (&face)[2])
{
  depth[0] = std::numeric_limits<double>::infinity();
  depth[1] = detectorDepth;
  face[0] = face[1] = -1;
  for (int i = 0; i < 4; ++i)
  {
    const RayFrame::DepthLine & line = lines[i];
    const double                value = line.At(column, row), at = -value / line.depth;
    if (line.depth < 0 && at < depth[0])
    {
      depth[0] = at;
      face[0] = i;
    }
    else if (line.depth > 0 && at > depth[1])
    {
      depth[1] = at;
      face[1] = i;
    }
    else if (line.depth == 0 && !(value >= 0))
    {
      return false;
    }
  }
  return depth[0] > depth[1];
}
} // namespace bone
