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

/** A cell of which a vertex is nearer to the source's plane than this part of the way to the detector takes the general
 * path: its projection may be unbounded. */
constexpr double nearSource = 0.02;

/** The rays of a view and the tetrahedra of a mesh, clipped one by one in double precision. */
class ProjectedCells
{
public:
  ProjectedCells(const std::vector<Vector3> &     points,
                 const MeshCells &                cells,
                 const XRayGeometry::View &       view,
                 const MeshRadiographParameters & parameters);

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

  /** Calls function(row, column, chord, mu) for each ray of the rows that passes cell t, in double precision. */
  template <typename TFunction>
  void
  ForEachChord(std::size_t t, int firstRow, int endRow, const TFunction & function) const;

private:
  ColumnRun
  ColumnsOfRow(const CellLines & lines, int row) const;

  const std::vector<Vector3> & m_Points;
  const MeshCells &            m_Cells;
  CellDensity                  m_Density;
  RayFrame                     m_Frame;
};

/** Sets the depths at which a ray enters and leaves a tetrahedron and the faces that it meets there, from the lines of
 * the faces' planes at its pixel. Returns false where the ray misses the tetrahedron. */
bool
ClipDepth(const CellLines & lines, double detectorDepth, double column, double row, double (&depth)[2], int (&face)[2]);

/** Points or cells that a loop of short bodies takes at a time. */
constexpr std::size_t loopChunk = 1024;

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
