/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneModelView.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <numeric>
#include <sstream>

namespace bone
{
MeshRadiographParameters
MakeMeshRadiographParameters(int minimumRegion, int maximumRegion, HUToAttenuation conversion, double waterAttenuation)
{
  MeshRadiographParameters parameters;
  parameters.minimumRegion = minimumRegion;
  parameters.maximumRegion = maximumRegion;
  if (conversion != HUToAttenuation::None)
  {
    parameters.scale = waterAttenuation / 1000.0;
    parameters.offset = waterAttenuation;
  }
  return parameters;
}

std::string
FindObstacle(const std::vector<Vector3> &     points,
             const MeshCells &                cells,
             const MeshRadiographParameters & parameters,
             HUToAttenuation                  conversion)
{
  std::ostringstream text;
  const auto         finite = [](double value) { return std::isfinite(value); };
  const bool         restricted = parameters.minimumRegion > MeshRadiographParameters().minimumRegion ||
                          parameters.maximumRegion < MeshRadiographParameters().maximumRegion;
  if (conversion != HUToAttenuation::None && conversion != HUToAttenuation::WaterScaled)
  {
    text << "HUToAttenuation is " << ParameterText(conversion)
         << ", which is no line: a polynomial would not stay one. Convert the CT and fit the model to the result "
            "(AttenuationImageFilter), then leave it at None.";
  }
  else if (parameters.minimumRegion > parameters.maximumRegion)
  {
    text << "MinimumRegion (" << parameters.minimumRegion << ") is above MaximumRegion (" << parameters.maximumRegion
         << "): no tetrahedron would count.";
  }
  else if (cells.tetrahedra.empty())
  {
    text << "The input 'Mesh' has no tetrahedra.";
  }
  else if (!cells.HasDensity())
  {
    text << "The input 'Mesh' has no density: fit one to a CT first.";
  }
  else if (!std::all_of(points.begin(), points.end(), [](const Vector3 & p) { return p.allFinite(); }) ||
           !std::all_of(cells.coefficients.begin(), cells.coefficients.end(), finite))
  {
    text << "A point or a density coefficient of the input 'Mesh' is not finite.";
  }
  else if (restricted && cells.region.empty())
  {
    text << "The input 'Mesh' has no regions to choose from: leave MinimumRegion and MaximumRegion alone.";
  }
  else if (conversion != HUToAttenuation::None && cells.quantity != DensityQuantity::HounsfieldUnit &&
           cells.quantity != DensityQuantity::Unknown)
  {
    text << "HUToAttenuation is " << ParameterText(conversion) << ", but the density of the input 'Mesh' is in "
         << DensityQuantityName(cells.quantity) << ": set it to None.";
  }
  return text.str();
}

namespace
{
/** The radiograph of a model in one view: its blocks by bands of rows, in the order of their centres, each drawn whole
 * into a picture of the rows its band's blocks cover; these overlap and are added up in order. */
class ModelProjection
{
public:
  ModelProjection(const ProjectionModel & model, const XRayGeometry::View & view)
    : m_View(model, view)
    , m_Rays(m_View.Rays())
    , m_Bands(BandCount(view.size[1]))
  {
    Distribute();
  }

  /** Those of the bands, then those of the cells that take the general path. */
  std::size_t
  Tasks() const
  {
    return m_Bands.size() + (m_General.empty() ? 0 : m_Bands.size());
  }
  void
  Draw(std::size_t task, const projection::Kernels & kernels);
  /** Rows [firstRow, endRow) of the image, when all tasks are done. */
  void
  WriteRows(int firstRow, int endRow, float * image) const;

private:
  struct Band
  {
    PixelRange                             range;
    std::vector<std::vector<std::int32_t>> blocks; ///< of each of the model's degrees
    std::vector<float>                     sums;
    std::ptrdiff_t                         stride{ 0 };
  };

  void
  Distribute();
  void
  DrawBand(Band & band, const projection::Kernels & kernels) const;
  void
  DrawGeneral(int firstRow, int endRow);

  ModelView                 m_View;
  const RayFrame &          m_Rays;
  std::vector<Band>         m_Bands;
  std::vector<std::int32_t> m_General; ///< cells
  std::vector<float>        m_GeneralSums;
};

void
ModelProjection::Distribute()
{
  struct Place
  {
    std::int32_t set, block;
    int          row;
    PixelRange   range;
  };
  std::vector<Place>       places;
  std::vector<std::size_t> blocksOfRow(m_Rays.Rows(), 0);
  const auto &             sets = m_View.Model().ByDegree();
  for (std::size_t set = 0; set < sets.size(); ++set)
  {
    const ProjectionModel::Blocks & blocks = sets[set];
    for (std::size_t b = 0; b < blocks.Count(); ++b)
    {
      Place      place{ static_cast<std::int32_t>(set), static_cast<std::int32_t>(b), 0, {} };
      double     row = 0;
      const auto path = m_View.FindRange(blocks, b, place.range, row);
      if (path == ModelView::Path::Kernel)
      {
        place.row = static_cast<int>(std::clamp(row, 0.0, m_Rays.Rows() - 1.0));
        ++blocksOfRow[place.row];
        places.push_back(place);
      }
      else if (path == ModelView::Path::General)
      {
        m_View.CopyCells(blocks, b, m_General);
      }
    }
  }
  for (Band & band : m_Bands)
  {
    band.blocks.resize(sets.size());
  }
  const std::vector<int> bandOfRow = ShareRows(blocksOfRow, static_cast<int>(m_Bands.size()));
  for (const Place & place : places)
  {
    Band & band = m_Bands[bandOfRow[place.row]];
    band.range.Include(place.range);
    band.blocks[place.set].push_back(place.block);
  }
  if (!m_General.empty())
  {
    m_GeneralSums.assign(static_cast<std::size_t>(m_Rays.Rows()) * m_Rays.Columns(), 0.0f);
  }
}

void
ModelProjection::DrawBand(Band & band, const projection::Kernels & kernels) const
{
  const PixelRange & range = band.range;
  if (range.IsEmpty())
  {
    return;
  }
  band.stride = range.endColumn - range.firstColumn + projection::spareColumns;
  band.sums.assign(band.stride * (range.endRow - range.firstRow + projection::spareRows), 0.0f);
  const projection::Band target{ band.sums.data(), band.stride,     range.firstRow,
                                 range.endRow,     range.endColumn, range.firstColumn };
  for (std::size_t set = 0; set < band.blocks.size(); ++set)
  {
    if (!band.blocks[set].empty())
    {
      m_View.Run(m_View.Model().ByDegree()[set], band.blocks[set], [&](const projection::BlockRun & run) {
        kernels.add(run, target);
      });
    }
  }
}

void
ModelProjection::DrawGeneral(int firstRow, int endRow)
{
  for (std::int32_t t : m_General)
  {
    m_View.Cells().ForEachChord(
      t, firstRow, endRow, [&](int row, int column, const CellChord & chord, const AffineBarycentric &) {
        const double integral = m_View.Cells().Density().Integrate(t, chord.entry, chord.exit, chord.length);
        m_GeneralSums[static_cast<std::size_t>(row) * m_Rays.Columns() + column] += static_cast<float>(integral);
      });
  }
}

void
ModelProjection::Draw(std::size_t task, const projection::Kernels & kernels)
{
  const std::size_t bands = m_Bands.size();
  if (task < bands)
  {
    DrawBand(m_Bands[task], kernels);
    return;
  }
  const auto rows = static_cast<std::size_t>(m_Rays.Rows());
  DrawGeneral(static_cast<int>((task - bands) * rows / bands), static_cast<int>((task - bands + 1) * rows / bands));
}

void
ModelProjection::WriteRows(int firstRow, int endRow, float * image) const
{
  const int          columns = m_Rays.Columns();
  std::vector<float> lengths(columns);
  for (int row = firstRow; row < endRow; ++row)
  {
    float * const to = image + static_cast<std::size_t>(row) * columns;
    int           low = columns, high = 0;
    std::fill_n(to, columns, 0.0f);
    for (const Band & band : m_Bands)
    {
      const PixelRange & range = band.range;
      if (range.IsEmpty() || row < range.firstRow || row >= range.endRow)
      {
        continue;
      }
      const float * const from = band.sums.data() + (row - range.firstRow) * band.stride;
      const int           count = range.endColumn - range.firstColumn;
      for (int i = 0; i < count; ++i)
      {
        to[range.firstColumn + i] += from[i];
      }
      low = std::min(low, range.firstColumn);
      high = std::max(high, range.endColumn);
    }
    if (!m_General.empty())
    {
      const float * const from = m_GeneralSums.data() + static_cast<std::size_t>(row) * columns;
      std::transform(to, to + columns, from, to, std::plus<>());
      low = 0;
      high = columns;
    }
    if (low < high)
    {
      m_Rays.StepLengths(row, low, high, lengths.data());
      std::transform(to + low, to + high, lengths.data(), to + low, std::multiplies<>());
    }
  }
}
void
ProjectView(const ProjectionModel & model, const XRayGeometry::View & view, const Execution & execution, float * image)
{
  const projection::Kernels & kernels = projection::SelectKernels(model.Parameters().portable);
  ModelProjection             projection(model, view);
  execution.Part(0.0, 0.9).For(projection.Tasks(), [&](std::size_t task) { projection.Draw(task, kernels); });
  constexpr int rowsAtOnce = 64;
  const int     rows = view.size[1];
  execution.Part(0.9, 1.0).For(static_cast<std::size_t>((rows + rowsAtOnce - 1) / rowsAtOnce), [&](std::size_t part) {
    const int first = static_cast<int>(part) * rowsAtOnce;
    projection.WriteRows(first, std::min(rows, first + rowsAtOnce), image);
  });
}
} // namespace

void
ProjectMesh(const ProjectionModel &                 model,
            const std::vector<XRayGeometry::View> & views,
            const Execution &                       execution,
            const std::vector<float *> &            images)
{
  // A thread draws a view alone, its pictures in the cache, where there are enough views for all threads.
  if (views.size() >= execution.GetNumberOfWorkUnits())
  {
    execution.For(views.size(), [&](std::size_t v) { ProjectView(model, views[v], execution, images[v]); });
    return;
  }
  const auto share = 1.0 / static_cast<double>(views.size());
  for (std::size_t v = 0; v < views.size(); ++v)
  {
    ProjectView(model, views[v], execution.Part(share * v, share * (v + 1)), images[v]);
  }
}

void
ProjectMesh(const std::vector<Vector3> &            points,
            const MeshCells &                       cells,
            const std::vector<XRayGeometry::View> & views,
            const MeshRadiographParameters &        parameters,
            const Execution &                       execution,
            const std::vector<float *> &            images)
{
  ProjectMesh(
    ProjectionModel(points, cells, parameters, execution.Silent(), views.size() > 1), views, execution, images);
}
} // namespace bone
