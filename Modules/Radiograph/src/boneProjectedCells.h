/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneProjectedCells_h
#define boneProjectedCells_h

#include "boneProjectionKernel.h"
#include "boneRayCell.h"

namespace bone
{
/** What a ray passes of a cell. */
struct CellChord
{
  Barycentric entry;
  Barycentric exit;
  double      length;    ///< in s, see RayFrame
  int         entryFace; ///< -1 where it starts within the cell, at the source
  int         exitFace;  ///< -1 where it ends within the cell, at the pixel
};

/** The tetrahedra of a mesh as a view sees them, by bands of rows. */
class ProjectedCells
{
public:
  ProjectedCells(const std::vector<Vector3> &  points,
                 const MeshArrays &            cells,
                 const XRayGeometry::View &    view,
                 const MeshRadiographOptions & options,
                 int                           bandRows);

  /** Projects the points and finds each band's cells. */
  void
  Prepare(const ParallelFor & parallelFor);

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
    return m_BinStart.size() - 1;
  }
  int
  FirstRow(std::size_t band) const
  {
    return static_cast<int>(band) * m_BandRows;
  }
  int
  EndRow(std::size_t band) const
  {
    return std::min(m_Frame.Rows(), FirstRow(band) + m_BandRows);
  }
  /** Whether there are cells near the source or through the detector, which the kernels cannot take. */
  bool
  HasGeneral() const
  {
    return m_HasGeneral;
  }
  /** Mean of the points' ray parameter s; 0 without points. */
  double
  MeanParameter() const;
  /** An empty group for Append. */
  projection::CellGroup
  EmptyGroup() const;

  /** Calls drawGroup(group, ids) for the cells of [first, last) (ids) that lie wholly between source and detector, by
   * groups of one degree, and drawGeneral(t) for those near the source or through the detector. */
  template <typename TIterator, typename TGroup, typename TGeneral>
  void
  ForEachGroup(TIterator first, TIterator last, const TGroup & drawGroup, const TGeneral & drawGeneral) const;
  template <typename TGroup, typename TGeneral>
  void
  ForEachGroupOfBand(std::size_t band, const TGroup & drawGroup, const TGeneral & drawGeneral) const
  {
    ForEachGroup(
      m_BinCells.begin() + m_BinStart[band], m_BinCells.begin() + m_BinStart[band + 1], drawGroup, drawGeneral);
  }

  /** Calls function(row, column, chord, mu) for each ray of the rows that passes cell t, in double precision. */
  template <typename TFunction>
  void
  ForEachChord(std::size_t t, int firstRow, int endRow, const TFunction & function) const;

private:
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

  void
  Locate(std::size_t t);
  void
  FillBins();
  void
  Append(std::size_t t, projection::CellGroup & group) const;
  ColumnRun
  ColumnsOfRow(const CellLines & lines, int row) const;

  const std::vector<Vector3> &  m_Points;
  const MeshArrays &            m_Cells;
  const MeshRadiographOptions & m_Options;
  CellDensity                   m_Density;
  RayFrame                      m_Frame;
  int                           m_BandRows;

  std::vector<Vector3>     m_Projected; ///< column, row, s of each point
  std::vector<RowRange>    m_Rows;      ///< of each cell
  bool                     m_HasGeneral{ false };
  std::vector<std::size_t> m_BinStart; ///< per band, into m_BinCells
  std::vector<IdType>      m_BinCells; ///< ascending within a band
};

/** Entry and exit depth of a ray and their faces, by the planes' lines at its pixel; false where it misses. */
bool
ClipDepth(const CellLines & lines, double detectorDepth, double column, double row, double (&depth)[2], int (&face)[2]);

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

template <typename TIterator, typename TGroup, typename TGeneral>
void
ProjectedCells::ForEachGroup(TIterator        first,
                             TIterator        last,
                             const TGroup &   drawGroup,
                             const TGeneral & drawGeneral) const
{
  projection::CellGroup group = EmptyGroup();
  std::size_t           ids[projection::groupSize];
  const auto            flush = [&]() {
    if (group.count > 0)
    {
      drawGroup(group, ids);
    }
    group.count = 0;
  };
  for (; first != last; ++first)
  {
    const auto t = static_cast<std::size_t>(*first);
    if (m_Rows[t].path == Path::General)
    {
      drawGeneral(t);
    }
    else if (m_Rows[t].path == Path::Kernel)
    {
      if (group.count == projection::groupSize || (group.count > 0 && group.degree != m_Density.Degree(t)))
      {
        flush();
      }
      ids[group.count] = t;
      Append(t, group);
    }
  }
  flush();
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
