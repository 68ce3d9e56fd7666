/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneProjectedCells_h
#define boneProjectedCells_h

#include "boneProjectionKernel.h"
#include "boneRayCell.h"

namespace bone
{
/** The part of a ray that lies in a tetrahedron. */
struct CellChord
{
  Barycentric entry;
  Barycentric exit;
  double      length;    ///< in s, see RayFrame
  int         entryFace; ///< -1 where it starts within the cell, at the source
  int         exitFace;  ///< -1 where it ends within the cell, at the pixel
};

/** A point's column, row and s, see RayFrame::Project, and 0. */
using ProjectedPoint = Eigen::Array4d;

/** A cell of which a vertex is nearer to the source's plane than this part of the way to the detector takes the general
 * path: its projection may be unbounded. */
constexpr double nearSource = 0.02;

/** The tetrahedra of a mesh as a view sees them, by bands of rows. */
class ProjectedCells
{
public:
  ProjectedCells(const std::vector<Vector3> &     points,
                 const MeshCells &                cells,
                 const XRayGeometry::View &       view,
                 const MeshRadiographParameters & parameters,
                 int                              bands);

  /** Projects the points and finds each band's cells. */
  void
  Prepare(const Execution & execution);

  const RayFrame &
  Rays() const
  {
    return m_Frame;
  }
  const CellDensity &
  Density() const
  {
    return m_Density;
  }
  std::size_t
  Bands() const
  {
    return m_BandStart.size() - 1;
  }
  int
  FirstRow(std::size_t band) const
  {
    return m_BandStart[band];
  }
  int
  EndRow(std::size_t band) const
  {
    return m_BandStart[band + 1];
  }
  /** The cells that meet a band, ascending. */
  std::vector<IdType>
  CellsOfBand(std::size_t band) const;

  /** The cells of all bands; a cell that meets several bands counts in each. */
  std::size_t
  CountInBands() const;

  /** The columns that these cells may cover: first, and one past the last. */
  std::pair<int, int>
  ColumnsOf(const std::vector<IdType> & ids) const;

  /** Calls drawGroup(group, ids of its members, how many ids of cells of the same kind and degree follow these) for the
   * cells of `ids` that lie wholly between source and detector, by groups of up to projection::groupSize of one degree,
   * and drawGeneral(t) for those near the source or through the detector, in the order of `ids`. */
  template <typename TGroup, typename TGeneral>
  void
  ForEachGroup(const std::vector<IdType> & ids, const TGroup & drawGroup, const TGeneral & drawGeneral) const;

  /** Calls function(row, column, chord, mu) for each ray of the rows that passes cell t, in double precision. */
  template <typename TFunction>
  void
  ForEachChord(std::size_t t, int firstRow, int endRow, const TFunction & function) const;

private:
  enum class Path : std::uint8_t
  {
    None,    ///< not drawn: not selected, beyond the detector, or between the pixels
    Kernel,  ///< wholly between source and detector
    General, ///< behind or near the source, or through the detector
  };
  struct RowRange
  {
    std::int32_t first{ 0 };
    std::int32_t end{ 0 };
    Path         path{ Path::None };
  };
  /** Some tetrahedra, sorted by bands. */
  struct Bins
  {
    std::vector<std::size_t> start; ///< per band, into cells
    std::vector<IdType>      cells;
  };

  void
  ProjectPoints(const Execution & execution);
  void
  SetBands();
  RowRange
  Locate(std::size_t t) const;
  void
  FillBins(std::size_t first, std::size_t end, Bins & bins) const;
  projection::CellGroup
  MakeGroup(const IdType * ids, int count) const;
  ColumnRun
  ColumnsOfRow(const CellLines & lines, int row) const;

  const std::vector<Vector3> &     m_Points;
  const MeshCells &                m_Cells;
  const MeshRadiographParameters & m_Parameters;
  CellDensity                      m_Density;
  RayFrame                         m_Frame;

  std::vector<ProjectedPoint> m_Projected;
  std::vector<RowRange>       m_Rows;      ///< the rows of each tetrahedron
  std::vector<int>            m_BandStart; ///< first row of each band, and the number of rows
  std::vector<Bins>           m_Bins;      ///< the bins of each block of tetrahedra
};

/** Sets the depths at which a ray enters and leaves a tetrahedron and the faces that it meets there, from the lines of
 * the faces' planes at its pixel. Returns false where the ray misses the tetrahedron. */
bool
ClipDepth(const CellLines & lines, double detectorDepth, double column, double row, double (&depth)[2], int (&face)[2]);

/** Points or cells that a loop of short bodies takes at a time. */
constexpr std::size_t loopChunk = 1024;

template <typename TGroup, typename TGeneral>
void
ProjectedCells::ForEachGroup(const std::vector<IdType> & ids,
                             const TGroup &              drawGroup,
                             const TGeneral &            drawGeneral) const
{
  for (std::size_t i = 0; i < ids.size();)
  {
    const auto t = static_cast<std::size_t>(ids[i]);
    const Path path = m_Rows[t].path;
    if (path != Path::Kernel)
    {
      if (path == Path::General)
      {
        drawGeneral(t);
      }
      ++i;
      continue;
    }
    std::size_t end = i + 1;
    while (end < ids.size() && m_Rows[ids[end]].path == Path::Kernel &&
           m_Density.Degree(ids[end]) == m_Density.Degree(t))
    {
      ++end;
    }
    for (; i < end;)
    {
      const int             count = static_cast<int>(std::min<std::size_t>(projection::groupSize, end - i));
      projection::CellGroup group = MakeGroup(&ids[i], count);
      drawGroup(group, &ids[i], end - i - count);
      i += count;
    }
  }
}

template <typename TFunction>
void
ProjectedCells::ForEachChord(std::size_t t, int firstRow, int endRow, const TFunction & function) const
{
  const Id4 &       v = m_Cells.tetrahedra[t];
  AffineBarycentric mu;
  if (!mu.Set(m_Points[v[0]], m_Points[v[1]], m_Points[v[2]], m_Points[v[3]]))
  {
    return;
  }
  const CellLines lines = RestrictToRays(m_Frame, mu);
  for (int row = firstRow; row < endRow; ++row)
  {
    const ColumnRun run = ColumnsOfRow(lines, row);
    for (int column = static_cast<int>(run.first); column <= run.last; ++column)
    {
      double    depth[2];
      int       face[2];
      CellChord chord;
      if (!ClipDepth(lines, m_Frame.DetectorDepth(), column, row, depth, face))
      {
        continue;
      }
      const double  from = m_Frame.Parameter(depth[0]), to = m_Frame.Parameter(depth[1]);
      const Vector3 origin = m_Frame.Origin(column, row), direction = m_Frame.Direction(column, row);
      chord.entry = mu.At(origin + from * direction);
      chord.exit = mu.At(origin + to * direction);
      chord.length = to - from;
      chord.entryFace = face[0];
      chord.exitFace = face[1];
      function(row, column, chord, mu);
    }
  }
}
} // namespace bone

#endif
