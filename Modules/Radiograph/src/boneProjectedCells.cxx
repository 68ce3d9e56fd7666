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
ProjectedCells::ProjectedCells(const std::vector<Vector3> &     points,
                               const MeshCells &                cells,
                               const XRayGeometry::View &       view,
                               const MeshRadiographParameters & parameters,
                               int                              bands)
  : m_Points(points)
  , m_Cells(cells)
  , m_Parameters(parameters)
  , m_Density(cells, parameters)
  , m_Frame(RayFrame::Displaced(view))
  , m_BandStart(bands + 1)
{}

void
ProjectedCells::Prepare(const Execution & execution)
{
  ProjectPoints(execution);
  SetBands();
  m_Rows.resize(m_Cells.tetrahedra.size());
  const std::size_t block = 2048, blocks = (m_Rows.size() + block - 1) / block;
  m_Bins.resize(blocks);
  execution.For(blocks, [&](std::size_t b) {
    const std::size_t first = b * block, end = std::min(m_Rows.size(), first + block);
    for (std::size_t t = first; t < end; ++t)
    {
      m_Rows[t] = Locate(t);
    }
    FillBins(first, end, m_Bins[b]);
  });
}

void
ProjectedCells::ProjectPoints(const Execution & execution)
{
  m_Projected.resize(m_Points.size());
  const auto project = [&](std::size_t p) {
    const Vector3 x = m_Frame.Project(m_Points[p]);
    m_Projected[p] = ProjectedPoint(x[0], x[1], x[2], 0.0);
  };
  // A few points take less time than to start a loop.
  constexpr std::size_t few = 16384;
  if (m_Points.size() > few)
  {
    execution.For(m_Points.size(), project, loopChunk);
    return;
  }
  for (std::size_t p = 0; p < m_Points.size(); ++p)
  {
    project(p);
  }
}

/** Bands of about as many points each, so that they take about as long. */
void
ProjectedCells::SetBands()
{
  const int                bands = static_cast<int>(Bands()), rows = m_Frame.Rows();
  std::vector<std::size_t> count(rows + 1, 0); // of points at each row, then above it
  for (const ProjectedPoint & p : m_Projected)
  {
    const bool seen = p[1] >= 0 && p[1] < rows;
    count[seen ? static_cast<int>(p[1]) : 0] += seen ? 1 : 0;
  }
  // Rows take time, too.
  const std::size_t perRow = 1 + m_Projected.size() / (8 * static_cast<std::size_t>(rows));
  std::size_t       before = 0;
  for (std::size_t & c : count)
  {
    const std::size_t here = c + perRow;
    c = before;
    before += here;
  }
  m_BandStart.front() = 0;
  m_BandStart.back() = rows;
  for (int band = 1; band < bands; ++band)
  {
    const std::size_t share = count[rows] * band / bands;
    const auto        at = std::lower_bound(count.begin(), count.end(), share) - count.begin();
    m_BandStart[band] = std::clamp(static_cast<int>(at), m_BandStart[band - 1], rows);
  }
}

projection::CellGroup
ProjectedCells::MakeGroup(const IdType * ids, int count) const
{
  projection::CellGroup group;
  group.count = count;
  group.degree = m_Density.Degree(ids[0]);
  group.scale = m_Parameters.scale;
  group.offset = m_Parameters.offset;
  group.parallel = m_Frame.IsParallel();
  for (int g = 0; g < group.count; ++g)
  {
    const std::size_t t = ids[g];
    for (int i = 0; i < 4; ++i)
    {
      const ProjectedPoint & p = m_Projected[m_Cells.tetrahedra[t][i]];
      group.column[i][g] = p[0];
      group.row[i][g] = p[1];
      group.s[i][g] = p[2];
    }
    group.coefficients[g] = m_Density.Coefficients(t);
  }
  return group;
}

ProjectedCells::RowRange
ProjectedCells::Locate(std::size_t t) const
{
  if (!m_Density.IsSelected(t))
  {
    return {};
  }
  const Id4 &            v = m_Cells.tetrahedra[t];
  const ProjectedPoint & a = m_Projected[v[0]];
  const ProjectedPoint & b = m_Projected[v[1]];
  const ProjectedPoint & c = m_Projected[v[2]];
  const ProjectedPoint & d = m_Projected[v[3]];
  const ProjectedPoint   low = a.min(b).min(c.min(d)), high = a.max(b).max(c.max(d));
  // s at the detector is 1 with a point source, 0 in a parallel beam.
  const double detector = m_Frame.DetectorDepth(), nearest = low[2], farthest = high[2];
  if (nearest >= detector || (!m_Frame.IsParallel() && farthest <= 0))
  {
    return {};
  }
  if (farthest > detector || (!m_Frame.IsParallel() && nearest < nearSource))
  {
    return { 0, m_Frame.Rows(), Path::General };
  }
  // Whole columns and rows within the cell's range and the detector.
  const auto whole = [](double least, double most, int count, std::int32_t & first, std::int32_t & end) {
    const double from = std::max(least, 0.0), to = std::min(most, count - 1.0);
    if (!(from <= to))
    {
      return false;
    }
    first = static_cast<std::int32_t>(from);
    first += first < from ? 1 : 0;
    end = static_cast<std::int32_t>(to) + 1;
    return first < end;
  };
  RowRange     range{ 0, 0, Path::Kernel };
  std::int32_t first, end;
  const bool   seen = whole(low[0], high[0], m_Frame.Columns(), first, end) &&
                    whole(low[1], high[1], m_Frame.Rows(), range.first, range.end);
  return seen ? range : RowRange();
}

void
ProjectedCells::FillBins(std::size_t first, std::size_t end, Bins & bins) const
{
  // The bands of each row.
  const std::size_t bands = Bands();
  const auto        forEachBin = [&](const auto & function) {
    std::size_t band = 0;
    for (std::size_t t = first; t < end; ++t)
    {
      const RowRange & range = m_Rows[t];
      if (range.path == Path::None)
      {
        continue;
      }
      // Neighbouring cells are mostly near: go from where the last one was.
      while (range.first < m_BandStart[band])
      {
        --band;
      }
      while (range.first >= m_BandStart[band + 1])
      {
        ++band;
      }
      for (std::size_t k = band; k < bands && m_BandStart[k] < range.end; ++k)
      {
        function(static_cast<IdType>(t), k);
      }
    }
  };
  bins.start.assign(bands + 1, 0);
  forEachBin([&](IdType, std::size_t band) { ++bins.start[band + 1]; });
  std::partial_sum(bins.start.begin(), bins.start.end(), bins.start.begin());
  bins.cells.resize(bins.start.back());
  auto next = bins.start;
  forEachBin([&](IdType t, std::size_t band) { bins.cells[next[band]++] = t; });
}

std::size_t
ProjectedCells::CountInBands() const
{
  return std::accumulate(m_Bins.begin(), m_Bins.end(), std::size_t{ 0 }, [](std::size_t count, const Bins & bins) {
    return count + bins.cells.size();
  });
}

std::vector<IdType>
ProjectedCells::CellsOfBand(std::size_t band) const
{
  std::vector<IdType> ids;
  for (const Bins & bins : m_Bins)
  {
    ids.insert(ids.end(), bins.cells.begin() + bins.start[band], bins.cells.begin() + bins.start[band + 1]);
  }
  return ids;
}

std::pair<int, int>
ProjectedCells::ColumnsOf(const std::vector<IdType> & ids) const
{
  double low = m_Frame.Columns(), high = -1;
  for (IdType t : ids)
  {
    if (m_Rows[t].path == Path::General)
    {
      return { 0, m_Frame.Columns() };
    }
    for (IdType v : m_Cells.tetrahedra[t])
    {
      low = std::min(low, m_Projected[v][0]);
      high = std::max(high, m_Projected[v][0]);
    }
  }
  const int first = static_cast<int>(std::max(low, 0.0));
  return { first, std::max(first, static_cast<int>(std::min(high + 1, static_cast<double>(m_Frame.Columns())))) };
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
