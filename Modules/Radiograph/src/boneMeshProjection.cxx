/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneMeshRadiograph.h"
#include "boneProjectionKernel.h"
#include "boneRayCell.h"

#include <algorithm>
#include <cmath>

namespace bone
{
namespace
{
/** A cell of which a vertex is nearer to the source's plane than this part of the way to the detector takes the general
 * path: its projection may be unbounded. */
constexpr double nearSource = 0.02;

enum class Path : std::uint8_t
{
  None,    ///< not selected, not before the detector, or between the pixels
  Kernel,  ///< wholly between source and detector
  General, ///< behind or near the source, or through the detector
};

struct RowRange
{
  std::int32_t first{ 0 };
  std::int32_t end{ 0 };
  Path         path{ Path::None };
};

class Projector
{
public:
  Projector(const std::vector<Vector3> &  points,
            const MeshArrays &            cells,
            const XRayGeometry::View &    view,
            const MeshRadiographOptions & options)
    : m_Points(points)
    , m_Cells(cells)
    , m_Options(options)
    , m_Density(cells, options)
    , m_Frame(RayFrame::Displaced(view))
    , m_AddCells(options.portable ? projection::AddCellsPortable : projection::SelectAddCells())
  {}

  void
  Run(const LoopRunner & loops, float * image);

private:
  void
  Locate(std::size_t t);
  void
  FillBins();
  void
  AddGeneral(std::size_t t, const projection::Band & band) const;
  void
  Append(std::size_t t, projection::CellGroup & group) const;
  void
  DrawBand(std::size_t bin, float * image) const;

  /** Rows of a band: few enough for the cache and for the threads, many enough that few cells lie in two. */
  int
  BandRows() const
  {
    return std::clamp(m_Frame.Rows() / 8, 8, 64);
  }

  const std::vector<Vector3> &  m_Points;
  const MeshArrays &            m_Cells;
  const MeshRadiographOptions & m_Options;
  CellDensity                   m_Density;
  RayFrame                      m_Frame;
  projection::AddCellsFunction  m_AddCells;

  std::vector<Vector3>     m_Projected; ///< column, row, s of each point
  std::vector<RowRange>    m_Rows;      ///< of each cell
  std::vector<std::size_t> m_BinStart;  ///< per band, into m_BinCells
  std::vector<IdType>      m_BinCells;  ///< ascending within a band
};

/** parallelFor over blocks of items, so that a call is worth its while. */
template <typename TFunction>
void
ForEachInBlocks(const ParallelFor & parallelFor, std::size_t count, const TFunction & function)
{
  constexpr std::size_t block = 1024;
  parallelFor((count + block - 1) / block, [&](std::size_t b) {
    const std::size_t end = std::min(count, (b + 1) * block);
    for (std::size_t i = b * block; i < end; ++i)
    {
      function(i);
    }
  });
}

void
Projector::Locate(std::size_t t)
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
Projector::FillBins()
{
  const std::size_t bins = (m_Frame.Rows() + BandRows() - 1) / BandRows();
  m_BinStart.assign(bins + 1, 0);
  const int  bandRows = BandRows();
  const auto forEachBin = [&](const auto & function) {
    for (std::size_t t = 0; t < m_Rows.size(); ++t)
    {
      for (int bin = m_Rows[t].first / bandRows; bin * bandRows < m_Rows[t].end; ++bin)
      {
        function(static_cast<IdType>(t), bin);
      }
    }
  };
  forEachBin([&](IdType, int bin) { ++m_BinStart[bin + 1]; });
  for (std::size_t bin = 0; bin < bins; ++bin)
  {
    m_BinStart[bin + 1] += m_BinStart[bin];
  }
  m_BinCells.resize(m_BinStart.back());
  auto next = m_BinStart;
  forEachBin([&](IdType t, int bin) { m_BinCells[next[bin]++] = t; });
}

void
Projector::Append(std::size_t t, projection::CellGroup & group) const
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

/** Entry and exit depth of a ray, by the planes' lines at its pixel; entry <= exit where it misses. */
void
ClipDepth(const CellLines & lines, double column, double row, double & entry, double & exit)
{
  for (const auto & line : lines)
  {
    const double value = line.At(column, row);
    if (line.depth < 0)
    {
      entry = std::min(entry, -value / line.depth);
    }
    else if (line.depth > 0)
    {
      exit = std::max(exit, -value / line.depth);
    }
    else if (!(value >= 0))
    {
      entry = -std::numeric_limits<double>::infinity();
    }
  }
}

/** Columns whose rays may meet the cell: those where no back plane lies before a front plane. */
ColumnRun
ColumnsOfRow(const CellLines & lines, double detectorDepth, int row, int columns)
{
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

void
Projector::AddGeneral(std::size_t t, const projection::Band & band) const
{
  const Id4 &       v = m_Cells.tetrahedra[t];
  AffineBarycentric mu;
  if (!mu.Set(m_Points[v[0]], m_Points[v[1]], m_Points[v[2]], m_Points[v[3]]))
  {
    return;
  }
  const CellLines lines = RestrictToRays(m_Frame, mu);
  for (int row = band.firstRow; row < band.endRow; ++row)
  {
    const ColumnRun run = ColumnsOfRow(lines, m_Frame.DetectorDepth(), row, m_Frame.Columns());
    for (int column = static_cast<int>(run.first); column <= run.last; ++column)
    {
      double entry = std::numeric_limits<double>::infinity(), exit = m_Frame.DetectorDepth();
      ClipDepth(lines, column, row, entry, exit);
      if (!(entry > exit))
      {
        continue;
      }
      const double  from = m_Frame.Parameter(entry), to = m_Frame.Parameter(exit);
      const Vector3 origin = m_Frame.Origin(column, row), direction = m_Frame.Direction(column, row);
      const double  integral =
        m_Density.Integrate(t, mu.At(origin + from * direction), mu.At(origin + to * direction), to - from);
      band.data[(row - band.firstRow) * band.stride + column] += static_cast<float>(integral);
    }
  }
}

void
Projector::DrawBand(std::size_t bin, float * image) const
{
  const int              columns = m_Frame.Columns();
  const int              firstRow = static_cast<int>(bin) * BandRows();
  const int              endRow = std::min(m_Frame.Rows(), firstRow + BandRows());
  const int              stride = columns + projection::lanes;
  std::vector<float>     sums(static_cast<std::size_t>(stride) * (endRow - firstRow), 0.0f);
  const projection::Band band{ sums.data(), stride, firstRow, endRow, columns };
  projection::CellGroup group;
  group.count = 0;
  group.scale = m_Options.scale;
  group.offset = m_Options.offset;
  group.parallel = m_Frame.IsParallel();
  const auto flush = [&]() {
    if (group.count > 0)
    {
      m_AddCells(group, band);
    }
    group.count = 0;
  };
  for (std::size_t i = m_BinStart[bin]; i < m_BinStart[bin + 1]; ++i)
  {
    const auto t = static_cast<std::size_t>(m_BinCells[i]);
    if (m_Rows[t].path == Path::General)
    {
      AddGeneral(t, band);
      continue;
    }
    if (group.count == projection::groupSize || (group.count > 0 && group.degree != m_Density.Degree(t)))
    {
      flush();
    }
    Append(t, group);
  }
  flush();
  for (int row = firstRow; row < endRow; ++row)
  {
    const float * from = sums.data() + static_cast<std::size_t>(row - firstRow) * stride;
    float *       to = image + static_cast<std::size_t>(row) * columns;
    for (int column = 0; column < columns; ++column)
    {
      to[column] = static_cast<float>(from[column] * m_Frame.StepLength(column, row));
    }
  }
}

void
Projector::Run(const LoopRunner & loops, float * image)
{
  m_Projected.resize(m_Points.size());
  ForEachInBlocks(
    loops.prepare, m_Points.size(), [&](std::size_t p) { m_Projected[p] = m_Frame.Project(m_Points[p]); });
  m_Rows.resize(m_Cells.tetrahedra.size());
  ForEachInBlocks(loops.prepare, m_Rows.size(), [&](std::size_t t) { Locate(t); });
  FillBins();
  loops.draw(m_BinStart.size() - 1, [&](std::size_t bin) { DrawBand(bin, image); });
}
} // namespace

void
ProjectMesh(const std::vector<Vector3> &  points,
            const MeshArrays &            cells,
            const XRayGeometry::View &    view,
            const MeshRadiographOptions & options,
            const LoopRunner &            loops,
            float *                       image)
{
  Projector(points, cells, view, options).Run(loops, image);
}
} // namespace bone
