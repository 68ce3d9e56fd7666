/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneMeshWalk.h"

#include "boneRayCell.h"

#include <algorithm>
#include <cmath>

namespace bone
{
namespace
{
/** A boundary face towards the source. */
struct EntryFace
{
  IdType cell;
  int    face;
  int    firstRow, endRow;
};

/** Where a ray of one row enters the mesh. */
struct Entry
{
  int    column;
  double depth;
  IdType cell;
  int    face; ///< -1 where the ray starts within the cell
};

bool
operator<(const Entry & a, const Entry & b)
{
  return a.column != b.column ? a.column < b.column : (a.depth != b.depth ? a.depth > b.depth : a.cell < b.cell);
}

class Walker
{
public:
  Walker(const std::vector<Vector3> &     points,
         const MeshCells &                cells,
         const XRayGeometry::View &       view,
         const MeshRadiographParameters & parameters)
    : m_Points(points)
    , m_Cells(cells)
    , m_Density(cells, parameters)
    , m_Frame(RayFrame::Displaced(view))
  {}

  void
  Run(const Execution & execution, float * image, std::int32_t * cellsPassed);

private:
  void
  Prepare(const Execution & execution);
  void
  FindEntryFaces();
  void
  FindSource();
  void
  CollectEntries(int row, std::vector<Entry> & entries) const;
  Barycentric
  At(const CellLines & lines, double depth, double column, double row) const;
  double
  Walk(const Entry & entry, int row, std::int32_t & passed) const;
  void
  DrawRow(int row, float * image, std::int32_t * cellsPassed) const;

  const std::vector<Vector3> & m_Points;
  const MeshCells &            m_Cells;
  CellDensity                  m_Density;
  RayFrame                     m_Frame;
  std::vector<CellLines>       m_Lines;
  std::vector<std::uint8_t>    m_Flat;
  std::vector<EntryFace>       m_EntryFaces;
  IdType                       m_SourceCell{ -1 };
};

void
Walker::Prepare(const Execution & execution)
{
  const std::size_t count = m_Cells.tetrahedra.size();
  m_Lines.resize(count);
  m_Flat.resize(count);
  constexpr std::size_t chunk = 1024;
  const auto restrict = [&](std::size_t t) {
    const Id4 &       v = m_Cells.tetrahedra[t];
    AffineBarycentric mu;
    m_Flat[t] = !mu.Set(m_Points[v[0]], m_Points[v[1]], m_Points[v[2]], m_Points[v[3]]);
    if (!m_Flat[t])
    {
      m_Lines[t] = RestrictToRays(m_Frame, mu);
    }
  };
  execution.For(count, restrict, chunk);
}

void
Walker::FindEntryFaces()
{
  for (std::size_t t = 0; t < m_Lines.size(); ++t)
  {
    for (int face = 0; face < 4; ++face)
    {
      if (m_Flat[t] || m_Cells.neighbors[t][face] >= 0 || !(m_Lines[t][face].depth < 0))
      {
        continue;
      }
      double low = std::numeric_limits<double>::max(), high = -low;
      bool   bounded = true;
      for (int corner : TetraFaces[face])
      {
        const Vector3 p = m_Frame.Project(m_Points[m_Cells.tetrahedra[t][corner]]);
        bounded = bounded && (m_Frame.IsParallel() || p[2] > 0);
        low = std::min(low, p[1]);
        high = std::max(high, p[1]);
      }
      const double rows = m_Frame.Rows();
      const int    first = bounded ? static_cast<int>(std::clamp(std::floor(low), 0.0, rows)) : 0;
      const int    end = bounded ? static_cast<int>(std::clamp(std::floor(high) + 1, 0.0, rows)) : m_Frame.Rows();
      if (first < end)
      {
        m_EntryFaces.push_back({ static_cast<IdType>(t), face, first, end });
      }
    }
  }
}

void
Walker::FindSource()
{
  // With a point source the lines' factors of depth are the barycentric coordinates of the source.
  constexpr double tolerance = 1e-12;
  for (std::size_t t = 0; t < m_Lines.size() && !m_Frame.IsParallel() && m_SourceCell < 0; ++t)
  {
    const auto & lines = m_Lines[t];
    if (!m_Flat[t] && std::all_of(lines.begin(), lines.end(), [](const auto & l) { return l.depth >= -tolerance; }))
    {
      m_SourceCell = static_cast<IdType>(t);
    }
  }
}

void
Walker::CollectEntries(int row, std::vector<Entry> & entries) const
{
  entries.clear();
  for (const EntryFace & entry : m_EntryFaces)
  {
    if (row < entry.firstRow || row >= entry.endRow)
    {
      continue;
    }
    const CellLines & lines = m_Lines[entry.cell];
    const auto &      plane = lines[entry.face];
    const double      constant = -plane.At(0, row) / plane.depth, perColumn = -plane.column / plane.depth;
    ColumnRun         run{ 0.0, m_Frame.Columns() - 1.0 };
    run.Keep(constant - m_Frame.DetectorDepth(), perColumn);
    for (int i = 0; i < 4; ++i)
    {
      if (i != entry.face)
      {
        run.Keep(lines[i].At(0, row) + lines[i].depth * constant, lines[i].column + lines[i].depth * perColumn);
      }
    }
    const double first = std::ceil(std::clamp(run.first, 0.0, static_cast<double>(m_Frame.Columns())));
    for (int column = static_cast<int>(first); column <= run.last; ++column)
    {
      entries.push_back({ column, constant + column * perColumn, entry.cell, entry.face });
    }
  }
  for (int column = 0; m_SourceCell >= 0 && column < m_Frame.Columns(); ++column)
  {
    entries.push_back({ column, std::numeric_limits<double>::infinity(), m_SourceCell, -1 });
  }
  std::sort(entries.begin(), entries.end());
}

Barycentric
Walker::At(const CellLines & lines, double depth, double column, double row) const
{
  Barycentric mu;
  for (int i = 0; i < 4; ++i)
  {
    const double value = lines[i].At(column, row);
    mu[i] = m_Frame.IsParallel() ? value + depth * lines[i].depth : lines[i].depth + value / depth;
  }
  return mu;
}

double
Walker::Walk(const Entry & entry, int row, std::int32_t & passed) const
{
  double sum = 0, depth = entry.depth;
  IdType cell = entry.cell;
  int    from = entry.face;
  for (std::size_t steps = 0; cell >= 0 && !m_Flat[cell] && steps < m_Lines.size(); ++steps)
  {
    const CellLines & lines = m_Lines[cell];
    double            exit = -std::numeric_limits<double>::infinity();
    int               to = -1;
    for (int i = 0; i < 4; ++i)
    {
      const double value = lines[i].At(entry.column, row);
      // A source on a face leaves through it at once or not at all.
      const bool   atSource = std::isinf(depth) && lines[i].depth <= 0;
      const double plane = atSource ? (value < 0 ? depth : exit) : -value / lines[i].depth;
      if (i != from && (lines[i].depth > 0 || atSource) && plane > exit)
      {
        exit = plane;
        to = i;
      }
    }
    const bool arrives = to < 0 || exit <= m_Frame.DetectorDepth();
    exit = std::min(depth, std::max(exit, m_Frame.DetectorDepth()));
    ++passed;
    if (m_Density.IsSelected(cell) && exit < depth)
    {
      const double length = m_Frame.Parameter(exit) - m_Frame.Parameter(depth);
      sum += m_Density.Integrate(cell, At(lines, depth, entry.column, row), At(lines, exit, entry.column, row), length);
    }
    if (arrives)
    {
      break;
    }
    const IdType next = m_Cells.neighbors[cell][to];
    if (next >= 0)
    {
      const Id4 & back = m_Cells.neighbors[next];
      from = static_cast<int>(std::find(back.begin(), back.end(), cell) - back.begin());
    }
    cell = next;
    depth = exit;
  }
  return sum;
}

void
Walker::DrawRow(int row, float * image, std::int32_t * cellsPassed) const
{
  std::vector<Entry> entries;
  CollectEntries(row, entries);
  std::vector<double>       sums(m_Frame.Columns(), 0.0);
  std::vector<std::int32_t> passed(m_Frame.Columns(), 0);
  for (const Entry & entry : entries)
  {
    sums[entry.column] += Walk(entry, row, passed[entry.column]);
  }
  for (int column = 0; column < m_Frame.Columns(); ++column)
  {
    const std::size_t pixel = static_cast<std::size_t>(row) * m_Frame.Columns() + column;
    image[pixel] = static_cast<float>(sums[column] * m_Frame.StepLength(column, row));
    if (cellsPassed != nullptr)
    {
      cellsPassed[pixel] = passed[column];
    }
  }
}

void
Walker::Run(const Execution & execution, float * image, std::int32_t * cellsPassed)
{
  Prepare(execution.Silent());
  FindEntryFaces();
  FindSource();
  execution.For(m_Frame.Rows(), [&](std::size_t row) { DrawRow(static_cast<int>(row), image, cellsPassed); });
}
} // namespace

void
WalkMesh(const std::vector<Vector3> &     points,
         const MeshCells &                cells,
         const XRayGeometry::View &       view,
         const MeshRadiographParameters & parameters,
         const Execution &                execution,
         float *                          image,
         std::int32_t *                   cellsPassed)
{
  Walker(points, cells, view, parameters).Run(execution, image, cellsPassed);
}
} // namespace bone
