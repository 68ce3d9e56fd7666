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

/** Moves a point, mm per unit. */
Vector3
PoseVelocity(int mode, const Vector3 & fromCentre)
{
  const Vector3 axis = Vector3::Unit(mode % 3);
  return mode < 3 ? axis : Vector3(axis.cross(fromCentre));
}

/** The derivative by a rigid motion as a combination of the four that the kernels make: along the ray of pixel
 * (column, row) a point at parameter s moves by a + (s - middle) b. Of that the part across the ray counts, in columns
 * and rows times s (parallel beam: in columns and rows), and that along the ray of b, which stretches the mesh. */
class PoseCombination
{
public:
  PoseCombination(const RayFrame & rays, const Vector3 & centre, double middle, int mode)
    : m_Parallel(rays.IsParallel())
  {
    const auto at = [&](double column, double row) {
      const Vector3               direction = rays.Direction(column, row);
      const Vector3               x = rays.Origin(column, row) + middle * direction - centre;
      Eigen::Matrix<double, 3, 2> moved;
      moved.col(0) = rays.ToPixel() * PoseVelocity(mode, x);
      moved.col(1) = rays.ToPixel() * (PoseVelocity(mode, x + direction) - PoseVelocity(mode, x));
      return moved;
    };
    m_AtZero = at(0, 0);
    m_PerColumn = at(1, 0) - m_AtZero;
    m_PerRow = at(0, 1) - m_AtZero;
  }

  /** Adds the combination of the image and the derivatives that follow it, `plane` apart, at the row's columns, where
   * all of these begin. */
  void
  Add(int row, std::pair<int, int> columns, const float * image, std::ptrdiff_t plane, float * sum) const
  {
    // Quadratic in the column: the part along columns, then that along rows, of a and of b.
    const Eigen::Matrix<double, 3, 2> start = m_AtZero + row * m_PerRow;
    const double                      along = m_Parallel ? 0.0 : 1.0;
    for (int k = 0; k < projection::posePlanes; ++k)
    {
      const int    part = k / 2, axis = 1 + k % 2;
      const double shift = along * (axis == 1 ? 0.0 : row), perShift = along * (axis == 1 ? 1.0 : 0.0);
      const double step0 = start(0, part), step1 = m_PerColumn(0, part);
      const auto   c0 = static_cast<float>(start(axis, part) - shift * step0);
      const auto   c1 = static_cast<float>(m_PerColumn(axis, part) - shift * step1 - perShift * step0);
      const auto   c2 = static_cast<float>(-perShift * step1);
      AddProduct(c0, c1, c2, columns, image + (k + 1) * plane, sum);
    }
    AddProduct(static_cast<float>(start(0, 1)), static_cast<float>(m_PerColumn(0, 1)), 0.0f, columns, image, sum);
  }

private:
  /** sum += (c0 + c1 c + c2 c^2) from at each column c. */
  static void
  AddProduct(float c0, float c1, float c2, std::pair<int, int> columns, const float * from, float * sum)
  {
    for (int c = columns.first; c < columns.second; ++c)
    {
      const auto x = static_cast<float>(c);
      *sum++ += (c0 + x * (c1 + x * c2)) * *from++;
    }
  }

  bool                        m_Parallel;
  Eigen::Matrix<double, 3, 2> m_AtZero, m_PerColumn, m_PerRow; ///< (s, s column, s row) of a and b
};

/** Memory aligned for vectors. */
struct alignas(64) Aligned
{
  unsigned char bytes[64];
};

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
    , m_Projected(points, cells, view, options, std::max({ 1, std::min(8, view.size[1] / 8), view.size[1] / 64 }))
  {
    for (const auto & mode : modes.density)
    {
      m_Density.push_back(mode.data());
    }
  }

  void
  Run(const LoopRunner & loops, const std::vector<float *> & images);

private:
  /** Where a band's derivatives lie, after the image: the kernels' four of the pose, shape, density; and the image and
   * the pose's six of the cells that the kernels cannot take. */
  int
  ShapePlane() const
  {
    return 1 + (m_Modes.pose ? projection::posePlanes : 0);
  }
  int
  DensityPlane() const
  {
    return ShapePlane() + static_cast<int>(m_Modes.shape.size());
  }
  int
  GeneralPlane() const
  {
    return DensityPlane() + static_cast<int>(m_Modes.density.size());
  }
  int
  Planes() const
  {
    return GeneralPlane() + (m_Projected.HasGeneral() ? 1 + (m_Modes.pose ? poseModes : 0) : 0);
  }
  void
  AddGeneral(std::size_t t, const projection::Band & band, std::ptrdiff_t plane) const;
  void
  DrawBand(std::size_t bandId, const std::vector<float *> & images) const;
  void
  WriteRow(int                          row,
           std::pair<int, int>          columns,
           const float *                sums,
           std::ptrdiff_t               plane,
           const std::vector<float *> & images) const;

  const std::vector<Vector3> &  m_Points;
  const MeshArrays &            m_Cells;
  const MeshRadiographOptions & m_Options;
  const RadiographModes &       m_Modes;
  ProjectedCells                m_Projected;
  double                        m_Middle{ 0.0 }; ///< of the points, in s
  std::vector<const double *>   m_Density;
  std::vector<PoseCombination>  m_Pose;
  std::vector<Vector3>          m_Displacement; ///< of each point and shape mode, in the rays' coordinates
};

void
DerivativeProjector::Run(const LoopRunner & loops, const std::vector<float *> & images)
{
  m_Projected.Prepare(loops.prepare);
  if (m_Modes.pose)
  {
    m_Middle = m_Projected.MeanParameter();
    for (int mode = 0; mode < poseModes; ++mode)
    {
      m_Pose.emplace_back(m_Projected.Rays(), m_Modes.poseCentre, m_Middle, mode);
    }
  }
  const std::size_t shapeModes = m_Modes.shape.size();
  m_Displacement.resize(m_Points.size() * shapeModes + 1); // one to spare, as the kernels read on
  ForEachInBlocks(loops.prepare, m_Points.size() * shapeModes, [&](std::size_t i) {
    m_Displacement[i] = m_Projected.Rays().ToPixel() * m_Modes.shape[i % shapeModes][i / shapeModes];
  });
  loops.draw(m_Projected.Bands(), [&](std::size_t band) { DrawBand(band, images); });
}

void
DerivativeProjector::AddGeneral(std::size_t t, const projection::Band & band, std::ptrdiff_t plane) const
{
  const ChordDerivative derivative(m_Projected.Density(), m_Options, t);
  const std::size_t     first = t * BernsteinCount(m_Cells.maximumDegree);
  const int             count = BernsteinCount(m_Cells.degree[t]);
  m_Projected.ForEachChord(
    t, band.firstRow, band.endRow, [&](int row, int column, const CellChord & chord, const AffineBarycentric & mu) {
      const ChordTerms terms = derivative.At(chord, RatesAlong(mu, m_Projected.Rays(), column, row));
      float *          sums = band.data + (row - band.firstRow) * band.stride + column;
      const auto       add = [&](int to, double value) { sums[to * plane] += static_cast<float>(value); };
      // The change for displacements of the vertices.
      const auto change = [&](const auto & displacement) {
        double sum = 0;
        for (int q = 0; q < 12; ++q)
        {
          sum += terms.k[q] * mu.gradient.row(q / 4 + 1).dot(displacement(m_Cells.tetrahedra[t][q % 4]));
        }
        return sum;
      };
      add(GeneralPlane(), m_Projected.Density().Integrate(t, chord.entry, chord.exit, chord.length));
      for (int mode = 0; m_Modes.pose && mode < poseModes; ++mode)
      {
        add(GeneralPlane() + 1 + mode,
            change([&](IdType v) { return PoseVelocity(mode, m_Points[v] - m_Modes.poseCentre); }));
      }
      for (std::size_t m = 0; m < m_Modes.shape.size(); ++m)
      {
        add(ShapePlane() + static_cast<int>(m), change([&](IdType v) { return m_Modes.shape[m][v]; }));
      }
      for (std::size_t m = 0; m < m_Density.size(); ++m)
      {
        const double sum = std::inner_product(terms.basis, terms.basis + count, m_Density[m] + first, 0.0);
        add(DensityPlane() + static_cast<int>(m), m_Options.scale * sum);
      }
    });
}

void
DerivativeProjector::DrawBand(std::size_t bandId, const std::vector<float *> & images) const
{
  const int              firstRow = m_Projected.FirstRow(bandId), endRow = m_Projected.EndRow(bandId);
  const int              columns = m_Projected.Rays().Columns();
  const std::ptrdiff_t   plane = columns + projection::lanes;
  const std::ptrdiff_t   stride = plane * Planes();
  std::vector<float>     sums(stride * (endRow - firstRow), 0.0f);
  const projection::Band band{ sums.data(), stride, firstRow, endRow, columns };

  const std::size_t    shapeModes = m_Modes.shape.size(), densityModes = m_Density.size();
  std::vector<Aligned> scratch(
    projection::DerivativeScratch(shapeModes, densityModes, m_Cells.maximumDegree) / sizeof(Aligned) + 1);
  projection::Derivatives task{};
  task.pose = m_Modes.pose;
  task.middle = m_Middle;
  task.shapeModes = static_cast<int>(shapeModes);
  task.densityModes = static_cast<int>(densityModes);
  task.density = m_Density.data();
  task.plane = plane;
  task.scratch = scratch.data();
  const std::ptrdiff_t        coefficients = BernsteinCount(m_Cells.maximumDegree);
  const projection::Kernels & kernels = projection::SelectKernels(m_Options.portable);
  const std::vector<IdType>   ids = m_Projected.CellsOfBand(bandId);
  m_Projected.ForEachGroup(
    ids,
    [&](projection::CellGroup & group, const IdType * members, std::size_t after) {
      for (int g = 0; g < group.count; ++g)
      {
        for (int i = 0; shapeModes > 0 && i < 4; ++i)
        {
          task.shape[g][i] = m_Displacement[m_Cells.tetrahedra[members[g]][i] * shapeModes].data();
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
    [&](std::size_t t) { AddGeneral(t, band, plane); });
  const std::pair<int, int> range = m_Projected.ColumnsOf(ids);
  for (int row = firstRow; row < endRow; ++row)
  {
    WriteRow(row, range, sums.data() + (row - firstRow) * stride, plane, images);
  }
}

/** From a row of sums in s to line integrals, which are 0 beside the columns. */
void
DerivativeProjector::WriteRow(int                          row,
                              std::pair<int, int>          columns,
                              const float *                sums,
                              std::ptrdiff_t               plane,
                              const std::vector<float *> & images) const
{
  const RayFrame &   rays = m_Projected.Rays();
  const int          first = columns.first, count = columns.second - columns.first;
  std::vector<float> lengths(count), sum(count);
  rays.StepLengths(row, columns.first, columns.second, lengths.data());
  sums += first;
  auto       image = images.begin();
  const auto write = [&](const float * from) {
    float * to = *image++ + static_cast<std::size_t>(row) * rays.Columns();
    std::fill_n(to, first, 0.0f);
    std::transform(lengths.begin(), lengths.end(), from, to + first, std::multiplies<float>());
    std::fill(to + columns.second, to + rays.Columns(), 0.0f);
  };
  const auto setGeneral = [&](int k) {
    const float * const from = sums + (GeneralPlane() + k) * plane;
    m_Projected.HasGeneral() ? std::copy_n(from, count, sum.data()) : std::fill_n(sum.data(), count, 0.0f);
  };
  setGeneral(0);
  std::transform(sum.begin(), sum.end(), sums, sum.begin(), std::plus<float>());
  write(sum.data());
  for (std::size_t mode = 0; mode < m_Pose.size(); ++mode)
  {
    setGeneral(1 + static_cast<int>(mode));
    m_Pose[mode].Add(row, columns, sums, plane, sum.data());
    write(sum.data());
  }
  for (int from = ShapePlane(); from < GeneralPlane(); ++from)
  {
    write(sums + from * plane);
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
    , m_Projected(points, cells, view, options, 1)
    , m_Positions(withPositions ? 4 * cells.tetrahedra.size() : 0, Vector3(Vector3::Zero()))
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
  std::vector<Vector3>          m_Positions; ///< of each cell and vertex, in space
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
        m_Positions[4 * t + q % 4] += weight * terms.k[q] * mu.gradient.row(q / 4 + 1).transpose();
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
  constexpr std::size_t       block = 256;
  const projection::Kernels & kernels = projection::SelectKernels(m_Options.portable);
  loops.draw((cells + block - 1) / block, [&](std::size_t b) {
    std::vector<IdType> ids(std::min(cells, (b + 1) * block) - b * block);
    std::iota(ids.begin(), ids.end(), static_cast<IdType>(b * block));
    m_Projected.ForEachGroup(
      ids,
      [&](projection::CellGroup & group, const IdType * members, std::size_t) {
        projection::Adjoint task{};
        for (int g = 0; g < group.count; ++g)
        {
          task.basis[g] = coefficients + members[g] * stride;
          task.positions[g] = m_Positions.empty() ? nullptr : m_Positions[4 * members[g]].data();
        }
        kernels.adjoin(group, task, m_Band);
        for (std::size_t i = 0; i < 4 * static_cast<std::size_t>(group.count) && !m_Positions.empty(); ++i)
        {
          Vector3 & position = m_Positions[4 * static_cast<std::size_t>(members[i / 4]) + i % 4];
          position = m_Projected.Rays().ToPixel().transpose() * position;
        }
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
  for (std::size_t i = 0; i < m_Positions.size(); ++i)
  {
    gradient[m_Cells.tetrahedra[i / 4][i % 4]] += m_Positions[i];
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
                       const std::vector<float *> &  images)
{
  DerivativeProjector(points, cells, view, options, modes).Run(loops, images);
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
