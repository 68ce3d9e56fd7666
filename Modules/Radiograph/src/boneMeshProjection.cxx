/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneProjectedCells.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace bone
{
std::string
FindObstacle(const std::vector<Vector3> &  points,
             const MeshArrays &            cells,
             const MeshRadiographOptions & options,
             HUToAttenuation               conversion)
{
  std::ostringstream text;
  const auto         finite = [](double value) { return std::isfinite(value); };
  const bool         restricted = options.minimumRegion > MeshRadiographOptions().minimumRegion ||
                          options.maximumRegion < MeshRadiographOptions().maximumRegion;
  if (conversion != HUToAttenuation::None && conversion != HUToAttenuation::WaterScaled)
  {
    text << "HUToAttenuation is " << conversion
         << ", which is no line: a polynomial would not stay one. Convert the CT and fit the model to the result "
            "(AttenuationImageFilter), then leave it at None.";
  }
  else if (options.minimumRegion > options.maximumRegion)
  {
    text << "MinimumRegion (" << options.minimumRegion << ") is above MaximumRegion (" << options.maximumRegion
         << "): no tetrahedron would count.";
  }
  else if (cells.tetrahedra.empty())
  {
    text << "The mesh has no tetrahedra.";
  }
  else if (!cells.HasDensity())
  {
    text << "The mesh has no density: fit one to a CT first (DensityFitFilter).";
  }
  else if (!std::all_of(points.begin(), points.end(), [](const Vector3 & p) { return p.allFinite(); }) ||
           !std::all_of(cells.coefficients.begin(), cells.coefficients.end(), finite))
  {
    text << "A point or a density coefficient of the mesh is not finite.";
  }
  else if (restricted && cells.region.empty())
  {
    text << "The mesh has no regions to choose from: leave MinimumRegion and MaximumRegion alone.";
  }
  else if (conversion != HUToAttenuation::None && cells.quantity != DensityQuantity::HounsfieldUnit &&
           cells.quantity != DensityQuantity::Unknown)
  {
    text << "HUToAttenuation is " << conversion << ", but the mesh's density is in "
         << DensityQuantityName(cells.quantity) << ": set it to None.";
  }
  return text.str();
}

namespace
{
/** As many that their rows stay in the cache and the threads share them well, so few that not many cells lie in two. */
int
BandCount(const XRayGeometry::View & view)
{
  return std::max({ 1, std::min(8, view.size[1] / 8), view.size[1] / 64 });
}

void
DrawBand(const ProjectedCells & cells, const projection::Kernels & kernels, std::size_t bandId, float * image)
{
  const RayFrame &          rays = cells.Rays();
  const int                 columns = rays.Columns();
  const int                 firstRow = cells.FirstRow(bandId), endRow = cells.EndRow(bandId);
  const int                 stride = columns + projection::lanes;
  std::vector<float>        sums(static_cast<std::size_t>(stride) * (endRow - firstRow + projection::spareRows), 0.0f);
  const projection::Band    band{ sums.data(), stride, firstRow, endRow, columns };
  const std::vector<IdType> ids = cells.CellsOfBand(bandId);
  cells.ForEachRun(
    ids,
    [&](const projection::CellRun & run) { kernels.add(run, band); },
    [&](std::size_t t) {
      cells.ForEachChord(
        t, firstRow, endRow, [&](int row, int column, const CellChord & chord, const AffineBarycentric &) {
          const double integral = cells.Density().Integrate(t, chord.entry, chord.exit, chord.length);
          sums[static_cast<std::size_t>(row - firstRow) * stride + column] += static_cast<float>(integral);
        });
    });
  const auto [firstColumn, endColumn] = cells.ColumnsOf(ids);
  for (int row = firstRow; row < endRow; ++row)
  {
    const float * from = sums.data() + static_cast<std::size_t>(row - firstRow) * stride;
    float *       to = image + static_cast<std::size_t>(row) * columns;
    std::fill_n(to, firstColumn, 0.0f);
    rays.StepLengths(row, firstColumn, endColumn, to + firstColumn);
    for (int column = firstColumn; column < endColumn; ++column)
    {
      to[column] *= from[column];
    }
    std::fill(to + endColumn, to + columns, 0.0f);
  }
}
} // namespace

void
ProjectMesh(const std::vector<Vector3> &            points,
            const MeshArrays &                      cells,
            const std::vector<XRayGeometry::View> & views,
            const MeshRadiographOptions &           options,
            const LoopRunner &                      loops,
            const std::vector<float *> &            images)
{
  const projection::Kernels &                      kernels = projection::SelectKernels(options.portable);
  std::vector<ProjectedCells>                      projected;
  std::vector<std::pair<std::size_t, std::size_t>> bands; // view, band
  projected.reserve(views.size());
  for (std::size_t v = 0; v < views.size(); ++v)
  {
    projected.emplace_back(points, cells, views[v], options, BandCount(views[v]));
    projected.back().Prepare(loops.prepare);
    for (std::size_t band = 0; band < projected.back().Bands(); ++band)
    {
      bands.emplace_back(v, band);
    }
  }
  loops.draw(bands.size(), [&](std::size_t i) {
    DrawBand(projected[bands[i].first], kernels, bands[i].second, images[bands[i].first]);
  });
}
} // namespace bone
