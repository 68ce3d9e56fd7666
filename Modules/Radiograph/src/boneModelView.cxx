/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneModelView.h"

#include <algorithm>
#include <iterator>
#include <numeric>

namespace bone
{
int
BandCount(int rows)
{
  return std::max({ 1, std::min(8, rows / 8), rows / 64 });
}

std::vector<int>
ShareRows(const std::vector<std::size_t> & blocksOfRow, int bands)
{
  std::size_t all = 0;
  for (std::size_t count : blocksOfRow)
  {
    all += count;
  }
  // Rows take time, too.
  const double     perRow = 1e-3 + static_cast<double>(all) / (8.0 * blocksOfRow.size());
  const double     share = (static_cast<double>(all) + perRow * blocksOfRow.size()) / bands;
  std::vector<int> bandOfRow(blocksOfRow.size());
  double           before = 0;
  for (std::size_t row = 0; row < blocksOfRow.size(); ++row)
  {
    bandOfRow[row] = std::min(static_cast<int>(before / share), bands - 1);
    before += static_cast<double>(blocksOfRow[row]) + perRow;
  }
  return bandOfRow;
}

ModelView::ModelView(const ProjectionModel & model, const XRayGeometry::View & view)
  : m_Model(model)
  , m_Cells(model.Points(), model.Cells(), view, model.Parameters())
{}

ModelView::Path
ModelView::FindRange(const ProjectionModel::Blocks & blocks, std::size_t block, PixelRange & range, double & row) const
{
  const RayFrame &        rays = Rays();
  const Vector3 &         centre = blocks.centres[block];
  const Vector3 &         halfSize = blocks.halfSizes[block];
  const Eigen::Matrix3d & toPixel = rays.ToPixel();
  const Vector3           q = toPixel * (centre - rays.Origin(0, 0));
  const bool              parallel = rays.IsParallel();
  const auto              reach = [&](const Vector3 & gradient) { return gradient.cwiseAbs().dot(halfSize); };
  const Vector3           perS = toPixel.row(0);
  const double            depth = reach(perS), nearest = q[0] - depth, farthest = q[0] + depth;
  // s at the detector is 1 with a point source, 0 in a parallel beam.
  const double detector = rays.DetectorDepth();
  if (nearest >= detector || (!parallel && farthest <= 0))
  {
    return Path::None;
  }
  if (farthest > detector || (!parallel && nearest < nearSource))
  {
    return Path::General;
  }
  const auto limit = [&](int axis, int count, int & first, int & end) {
    const double  at = parallel ? q[axis] : q[axis] / q[0];
    const Vector3 gradient = toPixel.row(axis);
    const double  half = parallel ? reach(gradient) : reach(gradient - at * perS) / nearest;
    const double  low = std::max(at - half, -1.0), high = std::min(at + half, static_cast<double>(count));
    first = std::max(0, static_cast<int>(low));
    end = high < 0 ? 0 : std::min(count, static_cast<int>(high) + 1);
    return at;
  };
  limit(1, rays.Columns(), range.firstColumn, range.endColumn);
  row = limit(2, rays.Rows(), range.firstRow, range.endRow);
  return range.IsEmpty() ? Path::None : Path::Kernel;
}

projection::BlockRun
ModelView::MakeRun(const ProjectionModel::Blocks & blocks) const
{
  const RayFrame &     rays = Rays();
  const CellDensity &  density = m_Cells.Density();
  const Vector3        origin = rays.Origin(0, 0);
  projection::BlockRun run{ nullptr,
                            0,
                            blocks.vertices.data(),
                            blocks.coefficients.data(),
                            blocks.cells.data(),
                            density.Coefficients(0),
                            density.Stride(),
                            blocks.degree,
                            m_Model.Parameters().scale,
                            m_Model.Parameters().offset,
                            { origin[0], origin[1], origin[2] },
                            {},
                            rays.IsParallel() };
  for (int i = 0; i < 3; ++i)
  {
    for (int k = 0; k < 3; ++k)
    {
      run.toPixel[i][k] = rays.ToPixel()(i, k);
    }
  }
  return run;
}

void
ModelView::Run(const ProjectionModel::Blocks &                               blocks,
               const std::vector<std::int32_t> &                             chosen,
               const std::function<void(const projection::BlockRun & run)> & kernel) const
{
  projection::BlockRun run = MakeRun(blocks);
  if (blocks.IsKept())
  {
    run.blocks = chosen.data();
    run.count = chosen.size();
    kernel(run);
    return;
  }
  constexpr std::size_t     atOnce = 16, size = ProjectionModel::Blocks::size;
  const std::size_t         perBlock = blocks.CoefficientsSize();
  std::vector<std::int32_t> ids(atOnce), cells(atOnce * size);
  std::vector<double>       vertices(atOnce * ProjectionModel::Blocks::verticesSize);
  std::vector<float>        coefficients(atOnce * perBlock);
  std::iota(ids.begin(), ids.end(), 0);
  run.blocks = ids.data();
  run.cells = cells.data();
  run.vertices = vertices.data();
  run.coefficients = coefficients.data();
  for (std::size_t first = 0; first < chosen.size(); first += atOnce)
  {
    run.count = std::min(atOnce, chosen.size() - first);
    for (std::size_t i = 0; i < run.count; ++i)
    {
      const auto block = static_cast<std::size_t>(chosen[first + i]);
      std::copy_n(&blocks.cells[block * size], size, &cells[i * size]);
      m_Model.Fill(blocks, block, &vertices[i * ProjectionModel::Blocks::verticesSize], &coefficients[i * perBlock]);
    }
    kernel(run);
  }
}

void
ModelView::CopyCells(const ProjectionModel::Blocks & blocks, std::size_t block, std::vector<std::int32_t> & cells) const
{
  const auto first = blocks.cells.begin() + static_cast<std::ptrdiff_t>(block * ProjectionModel::Blocks::size);
  std::copy_if(
    first, first + ProjectionModel::Blocks::size, std::back_inserter(cells), [](std::int32_t t) { return t >= 0; });
}
} // namespace bone
