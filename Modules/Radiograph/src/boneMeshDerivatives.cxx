/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneMeshDerivatives.h"

#include "boneChordDerivative.h"

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
  DerivativeProjector(const std::vector<Vector3> &     points,
                      const MeshCells &                cells,
                      const XRayGeometry::View &       view,
                      const MeshRadiographParameters & parameters,
                      const RadiographModes &          modes)
    : m_Points(points)
    , m_Cells(cells)
    , m_Parameters(parameters)
    , m_Modes(modes)
    , m_Projected(points, cells, view, parameters, std::max({ 1, std::min(8, view.size[1] / 8), view.size[1] / 64 }))
    , m_VertexModes((modes.pose ? poseModes : 0) + static_cast<int>(modes.shape.size()))
    , m_VertexBlocks(projection::BlockCount(m_VertexModes))
    , m_Density{ cells.coefficients.data() }
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
  void
  AddCells(const std::vector<IdType> & ids, const Execution & execution, const projection::Band & band);
  void
  AddGeneral(std::size_t t, const projection::Band & band) const;
  void
  DrawBand(std::size_t bandId, const Execution & execution, const std::vector<float *> & images);
  void
  WriteRow(int row, std::pair<int, int> columns, const float * sums, const std::vector<float *> & images) const;

  const std::vector<Vector3> &     m_Points;
  const MeshCells &                m_Cells;
  const MeshRadiographParameters & m_Parameters;
  const RadiographModes &          m_Modes;
  ProjectedCells                   m_Projected;
  int                              m_VertexModes; ///< pose and shape
  int                              m_VertexBlocks;
  std::vector<const double *>      m_Density; ///< that of the mesh, then the modes'
  int                              m_DensityBlocks;
  std::atomic<std::size_t>         m_Done{ 0 };    ///< cells drawn, counted in each band
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
        const Vector3 moved = m_Projected.Rays().ToPixel() * Velocity(mode, p);
        for (int axis = 0; axis < 3; ++axis)
        {
          to[axis * m_VertexBlocks * projection::modeLanes + mode] = static_cast<float>(moved[axis]);
        }
      }
    },
    loopChunk);
}

void
DerivativeProjector::Run(const Execution & execution, const std::vector<float *> & images)
{
  m_Projected.Prepare(execution.Silent());
  if (m_VertexModes > 0)
  {
    SetDisplacements(execution.Silent());
  }
  execution.For(m_Projected.Bands(), [&](std::size_t band) { DrawBand(band, execution, images); });
}

void
DerivativeProjector::AddGeneral(std::size_t t, const projection::Band & band) const
{
  const ChordDerivative derivative(m_Projected.Density(), m_Parameters, t);
  const std::size_t     first = t * BernsteinCount(m_Cells.maximumDegree);
  const int             count = BernsteinCount(m_Cells.degree[t]);
  m_Projected.ForEachChord(
    t, band.firstRow, band.endRow, [&](int row, int column, const CellChord & chord, const AffineBarycentric & mu) {
      const ChordTerms     terms = derivative.At(chord, RatesAlong(mu, m_Projected.Rays(), column, row));
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
      sums[0] += static_cast<float>(m_Projected.Density().Integrate(t, chord.entry, chord.exit, chord.length));
      for (std::size_t m = 1; m < m_Density.size(); ++m)
      {
        const double sum = std::inner_product(terms.basis, terms.basis + count, m_Density[m] + first, 0.0);
        sums[m] += static_cast<float>(m_Parameters.scale * sum);
      }
    });
}

void
DerivativeProjector::AddCells(const std::vector<IdType> & ids,
                              const Execution &           execution,
                              const projection::Band &    band)
{
  projection::Derivatives task{};
  task.vertexBlocks = m_VertexBlocks;
  task.densityBlocks = m_DensityBlocks;
  task.densityModes = static_cast<int>(m_Density.size());
  task.density = m_Density.data();
  const std::size_t           total = m_Projected.CountInBands();
  const std::ptrdiff_t        coefficients = BernsteinCount(m_Cells.maximumDegree);
  const projection::Kernels & kernels = projection::SelectKernels(m_Parameters.portable);
  m_Projected.ForEachGroup(
    ids,
    [&](projection::CellGroup & group, const IdType * members, std::size_t after) {
      // A band of many modes takes long.
      execution.Report(static_cast<double>(m_Done += group.count) / static_cast<double>(total));
      for (int g = 0; g < group.count; ++g)
      {
        for (int i = 0; m_VertexBlocks > 0 && i < 4; ++i)
        {
          const std::size_t point = m_Cells.tetrahedra[members[g]][i];
          task.displacement[g][i] = m_Displacement[3 * m_VertexBlocks * point].of;
        }
        task.coefficient[g] = static_cast<std::ptrdiff_t>(members[g]) * coefficients;
      }
      task.nextCount = static_cast<int>(std::min<std::size_t>(after, projection::groupSize));
      for (int g = 0; g < task.nextCount; ++g)
      {
        task.next[g] = static_cast<std::ptrdiff_t>(members[group.count + g]) * coefficients;
      }
      kernels.derive(group, task, band);
    },
    [&](std::size_t t) {
      AddGeneral(t, band);
      execution.Report(static_cast<double>(++m_Done) / static_cast<double>(total));
    });
}

void
DerivativeProjector::DrawBand(std::size_t bandId, const Execution & execution, const std::vector<float *> & images)
{
  const int                 firstRow = m_Projected.FirstRow(bandId), endRow = m_Projected.EndRow(bandId);
  const int                 columns = m_Projected.Rays().Columns();
  const std::vector<IdType> ids = m_Projected.CellsOfBand(bandId);
  const std::pair<int, int> range = m_Projected.ColumnsOf(ids);
  const std::ptrdiff_t      stride = range.second - range.first;
  std::vector<ModeBlock>    sums(stride * (endRow - firstRow) * Blocks() + 1, ModeBlock{}); // never empty
  AddCells(ids, execution, projection::Band{ sums.data()->of, stride, firstRow, endRow, columns, range.first });
  for (int row = firstRow; row < endRow; ++row)
  {
    WriteRow(row, range, sums.data()->of + (row - firstRow) * stride * Blocks() * projection::modeLanes, images);
  }
}

/** From a row of sums in s to line integrals, which are 0 beside the columns. */
void
DerivativeProjector::WriteRow(int                          row,
                              std::pair<int, int>          columns,
                              const float *                sums,
                              const std::vector<float *> & images) const
{
  const RayFrame &     rays = m_Projected.Rays();
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
ProjectMeshDerivatives(const std::vector<Vector3> &     points,
                       const MeshCells &                cells,
                       const XRayGeometry::View &       view,
                       const MeshRadiographParameters & parameters,
                       const RadiographModes &          modes,
                       const Execution &                execution,
                       const std::vector<float *> &     images)
{
  DerivativeProjector(points, cells, view, parameters, modes).Run(execution, images);
}

} // namespace bone
