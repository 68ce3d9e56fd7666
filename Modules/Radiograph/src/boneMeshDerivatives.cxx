/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneMeshDerivatives.h"

#include "boneChordDerivative.h"
#include "boneModelView.h"

#include <algorithm>
#include <atomic>
#include <numeric>

namespace bone
{
namespace
{
constexpr int poseModes = 6;

/** Moves a point, mm per unit. */
Vector3
PoseVelocity(int mode, const Vector3 & fromCentre)
{
  const Vector3 axis = Vector3::Unit(mode % 3);
  return mode < 3 ? axis : Vector3(axis.cross(fromCentre));
}

/** Numbers aligned for vectors, so many modes at a time. */
struct alignas(64) ModeBlock
{
  float of[projection::modeLanes];
};

class DerivativeProjector
{
public:
  DerivativeProjector(const ProjectionModel & model, const XRayGeometry::View & view, const RadiographModes & modes)
    : m_Points(model.Points())
    , m_Cells(model.Cells())
    , m_Parameters(model.Parameters())
    , m_Modes(modes)
    , m_View(model, view)
    , m_VertexModes((modes.pose ? poseModes : 0) + static_cast<int>(modes.shape.size()))
    , m_VertexBlocks(projection::BlockCount(m_VertexModes))
    , m_Density{ m_Cells.coefficients.data() }
    , m_DensityBlocks(projection::BlockCount(1 + modes.density.size()))
  {
    for (const auto & mode : modes.density)
    {
      m_Density.push_back(mode.data());
    }
  }

  void
  Run(const Execution & execution, const std::vector<float *> & images);

private:
  /** The numbers of a pixel: vertex modes, then density modes, in whole blocks. */
  int
  Blocks() const
  {
    return m_VertexBlocks + m_DensityBlocks;
  }
  /** Velocity of a point by a vertex mode, mm per unit. */
  Vector3
  Velocity(int mode, std::size_t point) const;
  void
  SetDisplacements(const Execution & execution);
  struct Band
  {
    PixelRange                             range;  ///< its rows, and columns where they have blocks
    std::vector<std::vector<std::int32_t>> blocks; ///< of each of the model's degrees
  };

  void
  SetBands();
  void
  AddBlocks(const Band & band, const Execution & execution, const projection::Band & target);
  void
  AddGeneral(std::size_t t, const projection::Band & band) const;
  void
  DrawBand(const Band & band, const Execution & execution, const std::vector<float *> & images);
  void
  WriteRow(int row, std::pair<int, int> columns, const float * sums, const std::vector<float *> & images) const;

  const std::vector<Vector3> &     m_Points;
  const MeshCells &                m_Cells;
  const MeshRadiographParameters & m_Parameters;
  const RadiographModes &          m_Modes;
  ModelView                        m_View;
  std::vector<Band>                m_Bands;
  std::vector<std::int32_t>        m_General;     ///< cells
  int                              m_VertexModes; ///< pose and shape
  int                              m_VertexBlocks;
  std::vector<const double *>      m_Density; ///< that of the mesh, then the modes'
  int                              m_DensityBlocks;
  std::size_t                      m_Total{ 0 };   ///< blocks and general cells, counted in each band
  std::atomic<std::size_t>         m_Done{ 0 };    ///< those drawn
  std::vector<ModeBlock>           m_Displacement; ///< of each point, in the rays' coordinates: 3 x vertex blocks
};

Vector3
DerivativeProjector::Velocity(int mode, std::size_t point) const
{
  const int shape = mode - (m_Modes.pose ? poseModes : 0);
  return shape < 0 ? PoseVelocity(mode, m_Points[point] - m_Modes.poseCentre) : m_Modes.shape[shape][point];
}

void
DerivativeProjector::SetDisplacements(const Execution & execution)
{
  m_Displacement.assign(3 * m_VertexBlocks * m_Points.size(), ModeBlock{});
  execution.For(
    m_Points.size(),
    [&](std::size_t p) {
      float * const to = m_Displacement[3 * m_VertexBlocks * p].of;
      for (int mode = 0; mode < m_VertexModes; ++mode)
      {
        const Vector3 moved = m_View.Rays().ToPixel() * Velocity(mode, p);
        for (int axis = 0; axis < 3; ++axis)
        {
          to[axis * m_VertexBlocks * projection::modeLanes + mode] = static_cast<float>(moved[axis]);
        }
      }
    },
    loopChunk);
}

/** Bands of rows with about as many blocks each; a block is drawn in each band that it meets. */
void
DerivativeProjector::SetBands()
{
  const int                                                     rows = m_View.Rays().Rows();
  const auto &                                                  sets = m_View.Model().ByDegree();
  std::vector<std::size_t>                                      blocksOfRow(rows, 0);
  std::vector<std::vector<std::pair<std::int32_t, PixelRange>>> seen(sets.size());
  for (std::size_t set = 0; set < sets.size(); ++set)
  {
    for (std::size_t b = 0; b < sets[set].Count(); ++b)
    {
      PixelRange range;
      double     row = 0;
      const auto path = m_View.FindRange(sets[set], b, range, row);
      if (path == ModelView::Path::Kernel)
      {
        ++blocksOfRow[static_cast<int>(std::clamp(row, 0.0, rows - 1.0))];
        seen[set].emplace_back(static_cast<std::int32_t>(b), range);
      }
      else if (path == ModelView::Path::General)
      {
        m_View.CopyCells(sets[set], b, m_General);
      }
    }
  }
  const std::vector<int> shares = ShareRows(blocksOfRow, BandCount(rows));
  std::vector<int>       bandOfRow(rows); // shares without rows are no bands
  m_Bands.clear();
  for (int row = 0; row < rows; ++row)
  {
    if (row == 0 || shares[row] != shares[row - 1])
    {
      m_Bands.emplace_back();
    }
    bandOfRow[row] = static_cast<int>(m_Bands.size()) - 1;
    m_Bands.back().range.Include({ m_View.Rays().Columns(), 0, row, row + 1 });
  }
  for (Band & band : m_Bands)
  {
    band.blocks.resize(sets.size());
    if (!m_General.empty())
    {
      band.range.Include({ 0, m_View.Rays().Columns(), band.range.firstRow, band.range.endRow });
    }
  }
  for (std::size_t set = 0; set < sets.size(); ++set)
  {
    for (const auto & [block, range] : seen[set])
    {
      for (int b = bandOfRow[range.firstRow]; b <= bandOfRow[range.endRow - 1]; ++b)
      {
        Band & band = m_Bands[b];
        band.range.Include({ range.firstColumn, range.endColumn, band.range.firstRow, band.range.endRow });
        band.blocks[set].push_back(block);
        ++m_Total;
      }
    }
  }
  m_Total += m_General.size() * m_Bands.size();
}

void
DerivativeProjector::Run(const Execution & execution, const std::vector<float *> & images)
{
  SetBands();
  if (m_VertexModes > 0)
  {
    SetDisplacements(execution.Silent());
  }
  execution.For(m_Bands.size(), [&](std::size_t band) { DrawBand(m_Bands[band], execution, images); });
}

void
DerivativeProjector::AddGeneral(std::size_t t, const projection::Band & band) const
{
  const ChordDerivative derivative(m_View.Cells().Density(), m_Parameters, t);
  const std::size_t     first = t * BernsteinCount(m_Cells.maximumDegree);
  const int             count = BernsteinCount(m_Cells.degree[t]);
  m_View.Cells().ForEachChord(
    t, band.firstRow, band.endRow, [&](int row, int column, const CellChord & chord, const AffineBarycentric & mu) {
      const ChordTerms     terms = derivative.At(chord, RatesAlong(mu, m_View.Rays(), column, row));
      const std::ptrdiff_t pixel = (row - band.firstRow) * band.stride + column - band.firstColumn;
      float *              sums = band.data + pixel * Blocks() * projection::modeLanes;
      for (int mode = 0; mode < m_VertexModes; ++mode)
      {
        double sum = 0;
        for (int q = 0; q < 12; ++q)
        {
          sum += terms.k[q] * mu.gradient.row(q / 4 + 1).dot(Velocity(mode, m_Cells.tetrahedra[t][q % 4]));
        }
        sums[mode] += static_cast<float>(sum);
      }
      sums += m_VertexBlocks * projection::modeLanes;
      sums[0] += static_cast<float>(m_View.Cells().Density().Integrate(t, chord.entry, chord.exit, chord.length));
      for (std::size_t m = 1; m < m_Density.size(); ++m)
      {
        const double sum = std::inner_product(terms.basis, terms.basis + count, m_Density[m] + first, 0.0);
        sums[m] += static_cast<float>(m_Parameters.scale * sum);
      }
    });
}

void
DerivativeProjector::AddBlocks(const Band & band, const Execution & execution, const projection::Band & target)
{
  const projection::Kernels &   kernels = projection::SelectKernels(m_Parameters.portable);
  const projection::Derivatives task{ m_VertexBlocks,
                                      m_Displacement.empty() ? nullptr : m_Displacement.front().of,
                                      m_Cells.tetrahedra.front().data(),
                                      m_DensityBlocks,
                                      static_cast<int>(m_Density.size()),
                                      m_Density.data() };
  const auto                    report = [&](std::size_t count) {
    execution.Report(static_cast<double>(m_Done += count) / static_cast<double>(m_Total));
  };
  constexpr std::size_t atOnce = 64; // a band of many modes takes long
  for (std::size_t set = 0; set < band.blocks.size(); ++set)
  {
    const std::vector<std::int32_t> & blocks = band.blocks[set];
    for (std::size_t first = 0; first < blocks.size(); first += atOnce)
    {
      const auto                      start = blocks.begin() + static_cast<std::ptrdiff_t>(first);
      const std::vector<std::int32_t> some(start, start + std::min(atOnce, blocks.size() - first));
      m_View.Run(m_View.Model().ByDegree()[set], some, [&](const projection::BlockRun & run) {
        kernels.derive(run, task, target);
      });
      report(some.size());
    }
  }
  for (std::int32_t t : m_General)
  {
    AddGeneral(t, target);
    report(1);
  }
}

void
DerivativeProjector::DrawBand(const Band & band, const Execution & execution, const std::vector<float *> & images)
{
  const PixelRange &        range = band.range;
  const std::pair<int, int> columns{ std::min(range.firstColumn, range.endColumn), range.endColumn };
  const std::ptrdiff_t      stride = columns.second - columns.first;
  const int                 rows = range.endRow - range.firstRow;
  std::vector<ModeBlock>    sums(stride * rows * Blocks() + 1, ModeBlock{}); // never empty
  AddBlocks(band,
            execution,
            projection::Band{ sums.data()->of, stride, range.firstRow, range.endRow, range.endColumn, columns.first });
  for (int row = 0; row < rows; ++row)
  {
    WriteRow(range.firstRow + row, columns, sums.data()->of + row * stride * Blocks() * projection::modeLanes, images);
  }
}

/** From a row of sums in s to line integrals, which are 0 beside the columns. */
void
DerivativeProjector::WriteRow(int                          row,
                              std::pair<int, int>          columns,
                              const float *                sums,
                              const std::vector<float *> & images) const
{
  const RayFrame &     rays = m_View.Rays();
  const int            count = columns.second - columns.first;
  const std::ptrdiff_t each = Blocks() * projection::modeLanes;
  const int            density = m_VertexBlocks * projection::modeLanes;
  std::vector<float>   lengths(count);
  rays.StepLengths(row, columns.first, columns.second, lengths.data());
  for (float * image : images)
  {
    float * const to = image + static_cast<std::size_t>(row) * rays.Columns();
    std::fill_n(to, columns.first, 0.0f);
    std::fill(to + columns.second, to + rays.Columns(), 0.0f);
  }
  // All images of a few pixels, which stay in the cache.
  constexpr int few = 32;
  for (int start = 0; start < count; start += few)
  {
    const int  end = std::min(count, start + few);
    const auto write = [&](std::size_t image, int number) {
      float * const to = images[image] + static_cast<std::size_t>(row) * rays.Columns() + columns.first;
      for (int c = start; c < end; ++c)
      {
        to[c] = lengths[c] * sums[c * each + number];
      }
    };
    write(0, density);
    for (int mode = 0; mode < m_VertexModes; ++mode)
    {
      write(1 + mode, mode);
    }
    for (std::size_t mode = 1; mode < m_Density.size(); ++mode)
    {
      write(m_VertexModes + mode, density + static_cast<int>(mode));
    }
  }
}

} // namespace

void
ProjectMeshDerivatives(const ProjectionModel &      model,
                       const XRayGeometry::View &   view,
                       const RadiographModes &      modes,
                       const Execution &            execution,
                       const std::vector<float *> & images)
{
  DerivativeProjector(model, view, modes).Run(execution, images);
}

void
ProjectMeshDerivatives(const std::vector<Vector3> &     points,
                       const MeshCells &                cells,
                       const XRayGeometry::View &       view,
                       const MeshRadiographParameters & parameters,
                       const RadiographModes &          modes,
                       const Execution &                execution,
                       const std::vector<float *> &     images)
{
  // The blocks of a model that is not kept are filled again in each band that they meet.
  ProjectMeshDerivatives(
    ProjectionModel(points, cells, parameters, execution.Silent()), view, modes, execution, images);
}

} // namespace bone
