/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneProjectedCells.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace bone
{
ProjectedCells::ProjectedCells(const std::vector<Vector3> &     points,
                               const MeshCells &                cells,
                               const XRayGeometry::View &       view,
                               const MeshRadiographParameters & parameters)
  : m_Points(points)
  , m_Cells(cells)
  , m_Density(cells, parameters)
  , m_Frame(RayFrame::Displaced(view))
{}

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
