/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneMeshDerivatives.h"

#include "boneProjectedCells.h"

#include <algorithm>
#include <functional>
#include <numeric>

namespace bone
{
namespace
{
constexpr int maximumCount = BernsteinCount(MaximumBernsteinDegree);
constexpr int poseModes = 6;

/** K_ij (i = 1..3), see boneDerivativeKernel.hxx, and the integrals of the Bernstein polynomials for one chord. */
struct ChordTerms
{
  double k[12]{};
  double basis[maximumCount]{};
};

/** Adds sign * rho mu_j / (d mu_face / ds) at one end of a chord. */
void
AddFaceTerm(const Barycentric & mu, double value, int face, double rate, ChordTerms & terms)
{
  for (int j = 0; j < 4; ++j)
  {
    const double term = value * mu[j] / rate;
    for (int i = 1; i < 4; ++i)
    {
      terms.k[4 * (i - 1) + j] += face == i ? term : (face == 0 ? -term : 0.0);
    }
  }
}

/** In double precision, for cells that the kernels cannot take. */
class ChordDerivative
{
public:
  ChordDerivative(const CellDensity & density, const MeshRadiographOptions & options, std::size_t t)
    : m_Degree(density.Degree(t))
  {
    const double * c = density.Coefficients(t);
    std::transform(c, c + BernsteinCount(m_Degree), m_Coefficients, [&](double value) {
      return options.scale * value + options.offset;
    });
  }

  ChordTerms
  At(const CellChord & chord, const Eigen::Vector4d & rates) const
  {
    // Gauss-Legendre, five points: exact to degree 9.
    static constexpr double x[] = {
      -0.90617984593866399, -0.53846931010568309, 0.0, 0.53846931010568309, 0.90617984593866399
    };
    static constexpr double w[] = {
      0.11846344252809454, 0.23931433524968324, 0.28444444444444444, 0.23931433524968324, 0.11846344252809454
    };
    ChordTerms terms;
    for (int g = 0; g < 5; ++g)
    {
      const Barycentric mu = 0.5 * (1 - x[g]) * chord.entry + 0.5 * (1 + x[g]) * chord.exit;
      const double      weight = w[g] * chord.length;
      double            values[maximumCount];
      BernsteinBasis(m_Degree, mu, values);
      for (int p = 0; p < BernsteinCount(m_Degree); ++p)
      {
        terms.basis[p] += weight * values[p];
      }
      const Eigen::Vector4d gradient = BernsteinBarycentricGradient(m_Degree, m_Coefficients, mu);
      for (int q = 0; q < 12; ++q)
      {
        terms.k[q] -= weight * (gradient[q / 4 + 1] - gradient[0]) * mu[q % 4];
      }
    }
    if (chord.exitFace >= 0)
    {
      const double value = BernsteinValue(m_Degree, m_Coefficients, chord.exit);
      AddFaceTerm(chord.exit, value, chord.exitFace, rates[chord.exitFace], terms);
    }
    if (chord.entryFace >= 0)
    {
      const double value = BernsteinValue(m_Degree, m_Coefficients, chord.entry);
      AddFaceTerm(chord.entry, -value, chord.entryFace, rates[chord.entryFace], terms);
    }
    return terms;
  }

private:
  int    m_Degree;
  double m_Coefficients[maximumCount];
};

Eigen::Vector4d
RatesAlong(const AffineBarycentric & mu, const RayFrame & rays, int column, int row)
{
  return mu.gradient * rays.Direction(column, row);
}

class DerivativeProjector
{
public:
  DerivativeProjector(const std::vector<Vector3> &  points,
                      const MeshArrays &            cells,
                      const XRayGeometry::View &    view,
                      const MeshRadiographOptions & options,
                      const RadiographModes &       modes)
    : m_Points(points)
    , m_Cells(cells)
    , m_Options(options)
    , m_Modes(modes)
    , m_Projected(points, cells, view, options, std::clamp(view.size[1] / 8, 8, 64))
    , m_ShapeModes((modes.pose ? poseModes : 0) + static_cast<int>(modes.shape.size()))
  {
    for (const auto & mode : modes.density)
    {
      m_Density.push_back(mode.data());
    }
  }

  void
  Run(const LoopRunner & loops, float * image, float * derivatives)
  {
    m_Projected.Prepare(loops.prepare);
    loops.draw(m_Projected.Bands(), [&](std::size_t band) { DrawBand(band, image, derivatives); });
  }

private:
  Vector3
  Displacement(int mode, IdType point) const;
  void
  SetShape(std::size_t t, double * shape) const;
  void
  AddGeneral(std::size_t t, const projection::Band & band, std::ptrdiff_t plane) const;
  void
  DrawBand(std::size_t bandId, float * image, float * derivatives) const;

  const std::vector<Vector3> &  m_Points;
  const MeshArrays &            m_Cells;
  const MeshRadiographOptions & m_Options;
  const RadiographModes &       m_Modes;
  ProjectedCells                m_Projected;
  int                           m_ShapeModes;
  std::vector<const double *>   m_Density;
};

Vector3
DerivativeProjector::Displacement(int mode, IdType point) const
{
  const int poses = m_Modes.pose ? poseModes : 0;
  if (mode >= poses)
  {
    return m_Modes.shape[mode - poses][point];
  }
  const Vector3 axis = Vector3::Unit(mode % 3);
  return mode < 3 ? axis : Vector3(axis.cross(Vector3(m_Points[point] - m_Modes.poseCentre)));
}

/** gradient of mu_i . displacement of vertex j, for each mode; 0 for a flat cell. */
void
DerivativeProjector::SetShape(std::size_t t, double * shape) const
{
  const Id4 &       v = m_Cells.tetrahedra[t];
  AffineBarycentric mu;
  if (m_ShapeModes == 0 || !mu.Set(m_Points[v[0]], m_Points[v[1]], m_Points[v[2]], m_Points[v[3]]))
  {
    std::fill_n(shape, 12 * m_ShapeModes, 0.0);
    return;
  }
  for (int mode = 0; mode < m_ShapeModes; ++mode)
  {
    for (int j = 0; j < 4; ++j)
    {
      const Vector3 w = Displacement(mode, v[j]);
      for (int i = 1; i < 4; ++i)
      {
        shape[12 * mode + 4 * (i - 1) + j] = mu.gradient.row(i).dot(w);
      }
    }
  }
}

void
DerivativeProjector::AddGeneral(std::size_t t, const projection::Band & band, std::ptrdiff_t plane) const
{
  const ChordDerivative derivative(m_Projected.Density(), m_Options, t);
  const std::size_t     first = t * BernsteinCount(m_Cells.maximumDegree);
  const int             count = BernsteinCount(m_Cells.degree[t]);
  std::vector<double>   shape(12 * static_cast<std::size_t>(m_ShapeModes));
  SetShape(t, shape.data());
  m_Projected.ForEachChord(
    t, band.firstRow, band.endRow, [&](int row, int column, const CellChord & chord, const AffineBarycentric & mu) {
      const ChordTerms terms = derivative.At(chord, RatesAlong(mu, m_Projected.Rays(), column, row));
      float *          out = band.data + (row - band.firstRow) * band.stride + column;
      *out += static_cast<float>(m_Projected.Density().Integrate(t, chord.entry, chord.exit, chord.length));
      for (int mode = 0; mode < m_ShapeModes; ++mode)
      {
        out += plane;
        *out += static_cast<float>(std::inner_product(terms.k, terms.k + 12, shape.data() + 12 * mode, 0.0));
      }
      for (const double * mode : m_Density)
      {
        out += plane;
        *out +=
          static_cast<float>(m_Options.scale * std::inner_product(terms.basis, terms.basis + count, mode + first, 0.0));
      }
    });
}

void
DerivativeProjector::DrawBand(std::size_t bandId, float * image, float * derivatives) const
{
  const RayFrame &       rays = m_Projected.Rays();
  const int              columns = rays.Columns();
  const int              firstRow = m_Projected.FirstRow(bandId), endRow = m_Projected.EndRow(bandId);
  const int              stride = columns + projection::lanes;
  const std::ptrdiff_t   plane = static_cast<std::ptrdiff_t>(stride) * (endRow - firstRow);
  const std::size_t      planes = 1 + m_Modes.Count();
  std::vector<float>     sums(planes * plane, 0.0f);
  const projection::Band band{ sums.data(), stride, firstRow, endRow, columns };

  const int               densityModes = static_cast<int>(m_Density.size());
  const std::size_t       stepOfShape = 12 * static_cast<std::size_t>(m_ShapeModes);
  std::vector<double>     shape(projection::groupSize * stepOfShape);
  std::vector<double>     scratch(projection::DerivativeScratch(m_ShapeModes, densityModes));
  projection::Derivatives task{};
  task.shapeModes = m_ShapeModes;
  task.densityModes = densityModes;
  task.density = m_Density.data();
  task.plane = plane;
  task.scratch = scratch.data();
  const projection::Kernels & kernels = projection::SelectKernels(m_Options.portable);
  m_Projected.ForEachGroupOfBand(
    bandId,
    [&](projection::CellGroup & group, const std::size_t * ids) {
      for (int g = 0; g < group.count; ++g)
      {
        SetShape(ids[g], shape.data() + g * stepOfShape);
        task.shape[g] = shape.data() + g * stepOfShape;
        task.coefficient[g] = static_cast<std::ptrdiff_t>(ids[g] * BernsteinCount(m_Cells.maximumDegree));
      }
      kernels.derive(group, task, band);
    },
    [&](std::size_t t) { AddGeneral(t, band, plane); });

  const std::size_t  pixels = static_cast<std::size_t>(columns) * rays.Rows();
  std::vector<float> lengths(columns);
  for (int row = firstRow; row < endRow; ++row)
  {
    for (int column = 0; column < columns; ++column)
    {
      lengths[column] = static_cast<float>(rays.StepLength(column, row));
    }
    for (std::size_t m = 0; m < planes; ++m)
    {
      const float * from = sums.data() + m * plane + static_cast<std::ptrdiff_t>(row - firstRow) * stride;
      float *       to = (m == 0 ? image : derivatives + (m - 1) * pixels) + static_cast<std::size_t>(row) * columns;
      std::transform(lengths.begin(), lengths.end(), from, to, std::multiplies<float>());
    }
  }
}

class Backprojector
{
public:
  Backprojector(const std::vector<Vector3> &  points,
                const MeshArrays &            cells,
                const XRayGeometry::View &    view,
                const MeshRadiographOptions & options,
                bool                          withPositions)
    : m_Points(points)
    , m_Cells(cells)
    , m_Options(options)
    , m_Projected(points, cells, view, options, view.size[1])
    , m_Positions(withPositions ? 12 * cells.tetrahedra.size() : 0, 0.0)
  {}

  void
  Run(const LoopRunner & loops, const float * image, double * coefficients);
  void
  GatherPositions(Vector3 * gradient) const;

private:
  void
  SetWeights(const float * image);
  void
  AddGeneral(std::size_t t, double * coefficients);

  const std::vector<Vector3> &  m_Points;
  const MeshArrays &            m_Cells;
  const MeshRadiographOptions & m_Options;
  ProjectedCells                m_Projected;
  std::vector<float>            m_Weights; ///< the image times the rays' step length
  projection::Band              m_Band{};
  std::vector<double>           m_Positions; ///< weighted K_ij of each cell
};

void
Backprojector::SetWeights(const float * image)
{
  const RayFrame & rays = m_Projected.Rays();
  const int        stride = rays.Columns() + projection::lanes;
  m_Weights.assign(static_cast<std::size_t>(stride) * rays.Rows(), 0.0f);
  for (int row = 0; row < rays.Rows(); ++row)
  {
    for (int column = 0; column < rays.Columns(); ++column)
    {
      m_Weights[static_cast<std::size_t>(row) * stride + column] =
        static_cast<float>(*image++ * rays.StepLength(column, row));
    }
  }
  m_Band = projection::Band{ m_Weights.data(), stride, 0, rays.Rows(), rays.Columns() };
}

void
Backprojector::AddGeneral(std::size_t t, double * coefficients)
{
  const ChordDerivative derivative(m_Projected.Density(), m_Options, t);
  const int             count = BernsteinCount(m_Cells.degree[t]);
  m_Projected.ForEachChord(
    t, 0, m_Band.endRow, [&](int row, int column, const CellChord & chord, const AffineBarycentric & mu) {
      const ChordTerms terms = derivative.At(chord, RatesAlong(mu, m_Projected.Rays(), column, row));
      const double     weight = m_Band.data[row * m_Band.stride + column];
      for (int p = 0; p < count; ++p)
      {
        coefficients[p] += weight * terms.basis[p];
      }
      for (int q = 0; q < 12 && !m_Positions.empty(); ++q)
      {
        m_Positions[12 * t + q] += weight * terms.k[q];
      }
    });
}

void
Backprojector::Run(const LoopRunner & loops, const float * image, double * coefficients)
{
  m_Projected.Prepare(loops.prepare);
  SetWeights(image);
  const std::size_t stride = BernsteinCount(m_Cells.maximumDegree), cells = m_Cells.tetrahedra.size();
  std::fill_n(coefficients, stride * cells, 0.0);
  constexpr std::size_t    block = 256;
  std::vector<std::size_t> ids(cells);
  std::iota(ids.begin(), ids.end(), std::size_t{ 0 });
  const projection::Kernels & kernels = projection::SelectKernels(m_Options.portable);
  loops.draw((cells + block - 1) / block, [&](std::size_t b) {
    m_Projected.ForEachGroup(
      ids.begin() + b * block,
      ids.begin() + std::min(cells, (b + 1) * block),
      [&](projection::CellGroup & group, const std::size_t * members) {
        projection::Adjoint task;
        for (int g = 0; g < group.count; ++g)
        {
          task.basis[g] = coefficients + members[g] * stride;
          task.positions[g] = m_Positions.empty() ? nullptr : m_Positions.data() + 12 * members[g];
        }
        kernels.adjoin(group, task, m_Band);
      },
      [&](std::size_t t) { AddGeneral(t, coefficients + t * stride); });
    const std::size_t end = std::min(cells, (b + 1) * block) * stride;
    std::for_each(coefficients + b * block * stride, coefficients + end, [&](double & c) { c *= m_Options.scale; });
  });
}

void
Backprojector::GatherPositions(Vector3 * gradient) const
{
  std::fill_n(gradient, m_Points.size(), Vector3(Vector3::Zero()));
  for (std::size_t t = 0; t < m_Cells.tetrahedra.size(); ++t)
  {
    const Id4 &       v = m_Cells.tetrahedra[t];
    AffineBarycentric mu;
    if (!mu.Set(m_Points[v[0]], m_Points[v[1]], m_Points[v[2]], m_Points[v[3]]))
    {
      continue;
    }
    for (int q = 0; q < 12; ++q)
    {
      gradient[v[q % 4]] += m_Positions[12 * t + q] * mu.gradient.row(q / 4 + 1).transpose();
    }
  }
}
} // namespace

void
ProjectMeshDerivatives(const std::vector<Vector3> &  points,
                       const MeshArrays &            cells,
                       const XRayGeometry::View &    view,
                       const MeshRadiographOptions & options,
                       const RadiographModes &       modes,
                       const LoopRunner &            loops,
                       float *                       image,
                       float *                       derivatives)
{
  DerivativeProjector(points, cells, view, options, modes).Run(loops, image, derivatives);
}

void
BackprojectToMesh(const std::vector<Vector3> &  points,
                  const MeshArrays &            cells,
                  const XRayGeometry::View &    view,
                  const MeshRadiographOptions & options,
                  const LoopRunner &            loops,
                  const float *                 image,
                  double *                      coefficients,
                  Vector3 *                     positions)
{
  Backprojector backprojector(points, cells, view, options, positions != nullptr);
  backprojector.Run(loops, image, coefficients);
  if (positions != nullptr)
  {
    backprojector.GatherPositions(positions);
  }
}
} // namespace bone
