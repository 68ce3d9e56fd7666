/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneChordDerivative.h"
#include "boneMeshDerivatives.h"
#include "boneModelView.h"

#include <algorithm>
#include <numeric>

namespace bone
{
namespace
{
class Backprojector
{
public:
  Backprojector(const ProjectionModel &    model,
                const XRayGeometry::View & view,
                double *                   coefficients,
                bool                       withPositions)
    : m_View(model, view)
    , m_Rays(m_View.Rays())
    , m_Coefficients(coefficients)
    , m_Stride(m_View.Cells().Density().Stride())
    , m_Positions(withPositions ? 12 * model.Cells().tetrahedra.size() : 0)
  {}

  void
  Run(const Execution & execution, const float * image);
  void
  GatherPositions(Vector3 * gradient) const;

private:
  void
  SetWeights(const float * image, const Execution & execution);
  void
  ClearBesideModel();
  void
  SetBlocks(const ProjectionModel::Blocks & blocks, std::size_t first, std::size_t end);
  void
  SetGeneral(const ProjectionModel::Blocks & blocks, std::size_t block, bool isSeen);
  void
  AddGeneral(std::size_t t);
  void
  Clear(std::size_t t);

  ModelView          m_View;
  const RayFrame &   m_Rays;
  double *           m_Coefficients;
  std::size_t        m_Stride;
  LargeArray<float>  m_Weights; ///< the image times the rays' step length
  projection::Band   m_Band{};
  LargeArray<double> m_Positions; ///< of each cell: 4 vertices x 3, in space
};

void
Backprojector::SetWeights(const float * image, const Execution & execution)
{
  const int columns = m_Rays.Columns(), rows = m_Rays.Rows(), stride = columns + projection::spareColumns;
  m_Weights.resize(static_cast<std::size_t>(stride) * (rows + projection::spareRows));
  constexpr std::size_t rowsAtOnce = 64;
  execution.For(
    rows + projection::spareRows,
    [&](std::size_t row) {
      float * const to = m_Weights.data() + row * stride;
      const bool    isSpare = row >= static_cast<std::size_t>(rows);
      std::fill(to + (isSpare ? 0 : columns), to + stride, 0.0f);
      if (!isSpare)
      {
        m_Rays.StepLengths(static_cast<int>(row), 0, columns, to);
        std::transform(to, to + columns, image + row * columns, to, std::multiplies<>());
      }
    },
    rowsAtOnce);
  m_Band = projection::Band{ m_Weights.data(), stride, 0, rows, columns };
}

void
Backprojector::Clear(std::size_t t)
{
  std::fill_n(m_Coefficients + t * m_Stride, m_Stride, 0.0);
  if (!m_Positions.empty())
  {
    std::fill_n(&m_Positions[12 * t], 12, 0.0);
  }
}

/** What the model's blocks do not write: cells that are not selected, and numbers beyond a cell's degree. */
void
Backprojector::ClearBesideModel()
{
  const MeshCells & cells = m_View.Model().Cells();
  for (std::size_t t = 0; t < cells.tetrahedra.size(); ++t)
  {
    if (cells.degree[t] < cells.maximumDegree || !m_View.Cells().Density().IsSelected(t))
    {
      Clear(t);
    }
  }
}

void
Backprojector::AddGeneral(std::size_t t)
{
  const MeshRadiographParameters & parameters = m_View.Model().Parameters();
  const ChordDerivative            derivative(m_View.Cells().Density(), parameters, t);
  const int                        count = BernsteinCount(m_View.Cells().Density().Degree(t));
  double * const                   coefficients = m_Coefficients + t * m_Stride;
  m_View.Cells().ForEachChord(
    t, 0, m_Band.endRow, [&](int row, int column, const CellChord & chord, const AffineBarycentric & mu) {
      const ChordTerms terms = derivative.At(chord, RatesAlong(mu, m_Rays, column, row));
      const double     weight = m_Band.data[row * m_Band.stride + column];
      for (int p = 0; p < count; ++p)
      {
        coefficients[p] += parameters.scale * weight * terms.basis[p];
      }
      for (int q = 0; q < 12 && !m_Positions.empty(); ++q)
      {
        for (int k = 0; k < 3; ++k)
        {
          m_Positions[12 * t + 3 * (q % 4) + k] += weight * terms.k[q] * mu.gradient(q / 4 + 1, k);
        }
      }
    });
}

void
Backprojector::SetGeneral(const ProjectionModel::Blocks & blocks, std::size_t block, bool isSeen)
{
  constexpr std::size_t size = ProjectionModel::Blocks::size;
  for (std::size_t i = block * size; i < (block + 1) * size && blocks.cells[i] >= 0; ++i)
  {
    Clear(blocks.cells[i]);
    if (isSeen)
    {
      AddGeneral(blocks.cells[i]);
    }
  }
}

void
Backprojector::SetBlocks(const ProjectionModel::Blocks & blocks, std::size_t first, std::size_t end)
{
  std::vector<std::int32_t> chosen;
  for (std::size_t b = first; b < end; ++b)
  {
    PixelRange range;
    double     row;
    const auto path = m_View.FindRange(blocks, b, range, row);
    if (path == ModelView::Path::Kernel)
    {
      chosen.push_back(static_cast<std::int32_t>(b));
    }
    else
    {
      SetGeneral(blocks, b, path == ModelView::Path::General);
    }
  }
  if (!chosen.empty())
  {
    const projection::Adjoint task{ m_Coefficients, m_Positions.empty() ? nullptr : m_Positions.data() };
    m_View.Run(blocks, chosen, [&](const projection::BlockRun & run) {
      projection::SelectKernels(m_View.Model().Parameters().portable).adjoin(run, task, m_Band);
    });
  }
}

void
Backprojector::Run(const Execution & execution, const float * image)
{
  SetWeights(image, execution.Silent());
  ClearBesideModel();
  constexpr std::size_t atOnce = 32;
  struct Part
  {
    const ProjectionModel::Blocks * blocks;
    std::size_t                     first;
  };
  std::vector<Part> parts;
  for (const ProjectionModel::Blocks & blocks : m_View.Model().ByDegree())
  {
    for (std::size_t first = 0; first < blocks.Count(); first += atOnce)
    {
      parts.push_back({ &blocks, first });
    }
  }
  execution.For(parts.size(), [&](std::size_t i) {
    SetBlocks(*parts[i].blocks, parts[i].first, std::min(parts[i].blocks->Count(), parts[i].first + atOnce));
  });
}

void
Backprojector::GatherPositions(Vector3 * gradient) const
{
  const MeshCells & cells = m_View.Model().Cells();
  std::fill_n(gradient, m_View.Model().Points().size(), Vector3(Vector3::Zero()));
  for (std::size_t i = 0; i < m_Positions.size() / 3; ++i)
  {
    gradient[cells.tetrahedra[i / 4][i % 4]] += Vector3::Map(&m_Positions[3 * i]);
  }
}
} // namespace

void
BackprojectToMesh(const ProjectionModel &    model,
                  const XRayGeometry::View & view,
                  const Execution &          execution,
                  const float *              image,
                  double *                   coefficients,
                  Vector3 *                  positions)
{
  Backprojector backprojector(model, view, coefficients, positions != nullptr);
  backprojector.Run(execution, image);
  if (positions != nullptr)
  {
    backprojector.GatherPositions(positions);
  }
}

void
BackprojectToMesh(const std::vector<Vector3> &     points,
                  const MeshCells &                cells,
                  const XRayGeometry::View &       view,
                  const MeshRadiographParameters & parameters,
                  const Execution &                execution,
                  const float *                    image,
                  double *                         coefficients,
                  Vector3 *                        positions)
{
  BackprojectToMesh(ProjectionModel(points, cells, parameters, execution.Silent(), false),
                    view,
                    execution,
                    image,
                    coefficients,
                    positions);
}
} // namespace bone
