/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneFitDensity.h"

#include "boneCellVoxels.h"
#include "boneDensityFitPlan.h"
#include "bonePenalizedFit.h"
#include "boneTriangleTree.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace bone
{
namespace
{
/** What holds a fit of weighted samples: nothing to speak of up to degree 1, Tikhonov's term on control values above.
 */
std::vector<double>
SamplePenalties(int degree, double tikhonov)
{
  std::vector<double> penalties(degree + 1, 1e-9);
  for (int k = 2; k <= degree; ++k)
  {
    penalties[k] += std::max(tikhonov, 1e-6) / BernsteinDamping(degree, k);
  }
  return penalties;
}

/** What holds the change that voxels make to a fit of samples: its mean square, and that of its control values. */
std::vector<double>
VoxelPenalties(int degree, double tikhonov, double voxelWeight)
{
  std::vector<double> penalties(degree + 1, 1.0);
  for (int k = 0; k <= degree; ++k)
  {
    penalties[k] = (1 + tikhonov / BernsteinDamping(degree, k)) / (voxelWeight > 0 ? voxelWeight : 1.0);
  }
  return penalties;
}

/** What all tetrahedra of one degree share. */
struct Pass
{
  Pass(const MeshArrays & mesh, const std::vector<IdType> & cells, double voxel, int n, const DensityFitParameters & s)
    : degree(n)
    , count(BernsteinCount(n))
    , plan(mesh, cells, voxel, n, s.tikhonov)
    , sampleFit(n, SamplePenalties(n, s.tikhonov))
    , voxelFit(n, VoxelPenalties(n, s.tikhonov, s.voxelWeight))
  {}

  int            degree;
  std::size_t    count; // coefficients
  DensityFitPlan plan;
  PenalizedFit   sampleFit;
  PenalizedFit   voxelFit;
};

/** What was found in one tetrahedron, at the degree it took. */
struct Finding
{
  float overshoot{ 0.0F };
  int   voxels{ 0 };
  bool  sparse{ false };
  bool  limited{ false };
  bool  unsupported{ false };
};

/** What is known of one tetrahedron while it is fitted. */
struct CellData
{
  Eigen::Matrix<double, 3, 4> vertices; // index coordinates
  double                      volume;   // in voxels
  std::vector<Barycentric>    places;   // of its voxels
  std::vector<double>         values;
  std::vector<double>         weights; // of its voxels; empty: all 1
  double                      low, high;
  bool                        nearSurface{ false }; // nearer to one than its margin, in part
  Finding                     found;
};

/** One batch of tetrahedra. */
struct Batch
{
  explicit Batch(const DensityFitPlan::Batch & b, std::size_t count)
    : kernel(*b.kernel)
    , tetrahedra(b.tetrahedra)
    , cells(b.tetrahedra.size())
    , samples(kernel.SamplePoints().size(), cells.size())
    , fitted(count, cells.size())
    , change(Eigen::MatrixXd::Zero(count, cells.size()))
  {}

  const DensityFitKernel &    kernel;
  const std::vector<IdType> & tetrahedra;
  std::vector<CellData>       cells;
  Eigen::MatrixXd             samples; // values, a column each tetrahedron
  Eigen::MatrixXd             fitted;  // Bernstein coefficients
  Eigen::MatrixXd             change;  // orthonormal coefficients
  DensityFitReport            report;
};

/** A surface, and how deep a place must lie for its own value to count, mm. */
struct Rim
{
  TriangleTree tree;
  double       margin;
};

/** Faces between regions. */
std::vector<std::array<IdType, 3>>
InterfaceFaces(const MeshArrays & mesh)
{
  std::vector<std::array<IdType, 3>> faces;
  for (std::size_t t = 0; t < mesh.region.size(); ++t)
  {
    for (int i = 0; i < 4; ++i)
    {
      const IdType other = mesh.neighbors[t][i];
      if (other >= 0 && mesh.region[t] < mesh.region[other])
      {
        const Id4 & v = mesh.tetrahedra[t];
        faces.push_back({ v[TetraFaces[i][0]], v[TetraFaces[i][1]], v[TetraFaces[i][2]] });
      }
    }
  }
  return faces;
}

class Fitter
{
public:
  Fitter(MeshArrays & mesh, const DensityFitImage & image, const DensityFitParameters & parameters);

  DensityFitReport
  Run(const Execution & execution);

private:
  void
  FitBatch(const Pass & pass, Batch & batch);
  void
  Sample(Batch & batch, std::size_t c) const;
  void
  FindVoxels(Batch & batch, std::size_t c, std::vector<CellVoxel> & found) const;
  void
  WeighSamples(const Pass & pass, Batch & batch, std::size_t c) const;
  void
  AddVoxels(const Pass & pass, Batch & batch, std::size_t c) const;
  double
  SquaredError(const Pass & pass, const Batch & batch, std::size_t c) const;
  void
  Finish(const Pass & pass, Batch & batch);
  void
  AddRim(const std::vector<std::array<IdType, 3>> & faces, double margin);
  bool
  MoveInward(Vector3 & index) const;
  void
  Summarize(DensityFitReport & report) const;

  MeshArrays &                 m_Mesh;
  const DensityFitImage &      m_Image;
  const DensityFitParameters & m_Parameters;
  Eigen::Matrix3d              m_ToIndex;
  std::vector<Rim>             m_Rims;     // those with a margin; the mesh's surface last
  std::vector<Finding>         m_Findings; // of each tetrahedron
  std::vector<char>            m_Open;     // of each tetrahedron: its error is above the bound
};

Fitter::Fitter(MeshArrays & mesh, const DensityFitImage & image, const DensityFitParameters & parameters)
  : m_Mesh(mesh)
  , m_Image(image)
  , m_Parameters(parameters)
  , m_ToIndex(image.grid.axes.inverse())
  , m_Findings(mesh.tetrahedra.size())
  , m_Open(mesh.tetrahedra.size(), 1)
{
  if ((parameters.surfaceMargin > 0 || parameters.interfaceMargin > 0) && mesh.neighbors.empty())
  {
    mesh.neighbors = ComputeFaceNeighbors(mesh.tetrahedra);
  }
  if (parameters.interfaceMargin > 0)
  {
    this->AddRim(InterfaceFaces(mesh), parameters.interfaceMargin);
  }
  if (parameters.surfaceMargin > 0)
  {
    this->AddRim(BoundaryFaces(mesh), parameters.surfaceMargin);
  }
}

void
Fitter::AddRim(const std::vector<std::array<IdType, 3>> & faces, double margin)
{
  if (!faces.empty())
  {
    std::vector<TriangleTree::Triangle> triangles;
    for (const auto & face : faces)
    {
      triangles.push_back({ { m_Mesh.points[face[0]], m_Mesh.points[face[1]], m_Mesh.points[face[2]] } });
    }
    m_Rims.push_back({ TriangleTree(std::move(triangles)), margin });
  }
}

/** Moves x away from a surface that it is nearer to than the margin, as MoveInward says. */
bool
MoveFrom(const Rim & rim, Vector3 & x)
{
  auto nearest = rim.tree.FindNearest(x);
  bool near = false;
  for (int step = 0; step < 4; ++step)
  {
    const double depth = std::sqrt(nearest.squaredDistance);
    const bool   tooNear = depth < (1 - 1e-9) * rim.margin;
    near = near || tooNear;
    if (!tooNear || depth == 0)
    {
      break;
    }
    const Vector3 moved = nearest.point + (x - nearest.point) * (rim.margin / depth);
    const auto    next = rim.tree.FindNearest(moved);
    if (next.squaredDistance <= nearest.squaredDistance)
    {
      break;
    }
    x = moved;
    nearest = next;
  }
  return near;
}

/** Moves a place nearer to a surface than its margin inward to that depth, away from one face after another at edges
 * and corners, but not where that brings it nearer to another part of the surface. Returns whether it was nearer. */
bool
Fitter::MoveInward(Vector3 & index) const
{
  Vector3 x = m_Image.grid.origin + m_Image.grid.axes * index;
  bool    near = false;
  for (const Rim & rim : m_Rims)
  {
    near = MoveFrom(rim, x) || near;
  }
  index = m_ToIndex * (x - m_Image.grid.origin);
  return near;
}

void
Fitter::Sample(Batch & batch, std::size_t c) const
{
  CellData &  cell = batch.cells[c];
  const Id4 & v = m_Mesh.tetrahedra[batch.tetrahedra[c]];
  for (int i = 0; i < 4; ++i)
  {
    cell.vertices.col(i) = m_ToIndex * (m_Mesh.points[v[i]] - m_Image.grid.origin);
  }
  cell.volume = std::abs((cell.vertices.rightCols<3>().colwise() - cell.vertices.col(0)).determinant()) / 6;
  if (!m_Rims.empty())
  {
    Vector3 middle = Vector3::Zero();
    for (const IdType p : v)
    {
      middle += 0.25 * m_Mesh.points[p];
    }
    double radius = 0;
    for (const IdType p : v)
    {
      radius = std::max(radius, (m_Mesh.points[p] - middle).norm());
    }
    for (const Rim & rim : m_Rims)
    {
      cell.nearSurface =
        cell.nearSurface || std::sqrt(rim.tree.FindNearest(middle).squaredDistance) < radius + rim.margin;
    }
  }
  const auto &         pattern = batch.kernel.SamplePoints();
  std::vector<Vector3> places(pattern.size());
  const auto &         size = m_Image.grid.size;
  const Vector3        last(size[0] - 0.5, size[1] - 0.5, size[2] - 0.5);
  for (std::size_t s = 0; s < pattern.size(); ++s)
  {
    places[s] = cell.vertices * pattern[s];
    if (cell.nearSurface)
    {
      this->MoveInward(places[s]);
    }
    batch.report.outside += (places[s].array() < -0.5).any() || (places[s].array() > last.array()).any() ? 1 : 0;
  }
  batch.report.samples += places.size();
  m_Image.interpolated(places.data(), places.size(), batch.samples.col(c).data());
  cell.low = batch.samples.col(c).minCoeff();
  cell.high = batch.samples.col(c).maxCoeff();
}

void
Fitter::FindVoxels(Batch & batch, std::size_t c, std::vector<CellVoxel> & found) const
{
  CellData & cell = batch.cells[c];
  FindCellVoxels(cell.vertices, m_Image.grid.size, found);
  std::vector<Vector3> indices;
  for (const CellVoxel & voxel : found)
  {
    const auto & [i, j, k] = voxel.index;
    Vector3 index(i, j, k);
    if ((m_Parameters.holdOut && IsHeldOut(i, j, k)) || (cell.nearSurface && this->MoveInward(index)))
    {
      continue;
    }
    indices.push_back(index);
    cell.places.push_back(voxel.mu);
  }
  cell.values.resize(indices.size());
  m_Image.voxels(indices.data(), indices.size(), cell.values.data());
  if (m_Image.weights)
  {
    cell.weights.resize(indices.size());
    m_Image.weights(indices.data(), indices.size(), cell.weights.data());
  }
  for (const double value : cell.values)
  {
    cell.low = std::min(cell.low, value);
    cell.high = std::max(cell.high, value);
  }
  cell.found.voxels = static_cast<int>(indices.size());
}

/** Replaces the fit of a tetrahedron whose samples do not all weigh the same. */
void
Fitter::WeighSamples(const Pass & pass, Batch & batch, std::size_t c) const
{
  CellData &           cell = batch.cells[c];
  const auto &         pattern = batch.kernel.SamplePoints();
  std::vector<Vector3> places(pattern.size());
  Eigen::VectorXd      weights(pattern.size());
  std::transform(pattern.begin(), pattern.end(), places.begin(), [&cell](const Barycentric & mu) -> Vector3 {
    return cell.vertices * mu;
  });
  m_Image.weights(places.data(), places.size(), weights.data());
  const double total = weights.sum();
  if (!(total > 0))
  {
    cell.weights.clear();
    cell.found.unsupported = true;
    return;
  }
  if (weights.maxCoeff() == weights.minCoeff())
  {
    return;
  }
  const double          mean = weights.dot(batch.samples.col(c)) / total;
  const Eigen::VectorXd rest = batch.samples.col(c).array() - mean;
  Eigen::VectorXd       orthonormal(pass.count);
  pass.sampleFit.Solve(pattern.size(), pattern.data(), rest.data(), weights.data(), total, orthonormal.data());
  batch.fitted.col(c) = (OrthonormalToBernstein(pass.degree) * orthonormal).array() + mean;
}

void
Fitter::AddVoxels(const Pass & pass, Batch & batch, std::size_t c) const
{
  const CellData & cell = batch.cells[c];
  const double     total = cell.weights.empty() ? static_cast<double>(cell.values.size())
                                                : std::accumulate(cell.weights.begin(), cell.weights.end(), 0.0);
  if (!(total > 0))
  {
    return;
  }
  std::vector<double> rest(cell.values.size());
  for (std::size_t v = 0; v < rest.size(); ++v)
  {
    rest[v] = cell.values[v] - BernsteinValue(pass.degree, batch.fitted.col(c).data(), cell.places[v]);
  }
  pass.voxelFit.Solve(rest.size(),
                      cell.places.data(),
                      rest.data(),
                      cell.weights.empty() ? nullptr : cell.weights.data(),
                      std::max(total, cell.volume),
                      batch.change.col(c).data());
}

/** Mean square over voxels and samples, which stand for as much as their weights in the fit. */
double
Fitter::SquaredError(const Pass & pass, const Batch & batch, std::size_t c) const
{
  const CellData & cell = batch.cells[c];
  const double *   coefficients = batch.fitted.col(c).data();
  const auto &     pattern = batch.kernel.SamplePoints();
  double           ofSamples = 0, ofVoxels = 0;
  for (std::size_t s = 0; s < pattern.size(); ++s)
  {
    const double rest = BernsteinValue(pass.degree, coefficients, pattern[s]) - batch.samples(s, c);
    ofSamples += rest * rest / static_cast<double>(pattern.size());
  }
  for (std::size_t v = 0; v < cell.values.size(); ++v)
  {
    const double rest = BernsteinValue(pass.degree, coefficients, cell.places[v]) - cell.values[v];
    ofVoxels += rest * rest;
  }
  const double share = m_Parameters.voxelWeight / std::max(cell.volume, static_cast<double>(cell.values.size()));
  return (ofSamples + share * ofVoxels) / (1 + share * static_cast<double>(cell.values.size()));
}

void
Fitter::Finish(const Pass & pass, Batch & batch)
{
  const std::size_t row = BernsteinCount(m_Mesh.maximumDegree);
  for (std::size_t c = 0; c < batch.cells.size(); ++c)
  {
    const IdType t = batch.tetrahedra[c];
    CellData &   cell = batch.cells[c];
    const double range = cell.high - cell.low;
    double *     fitted = batch.fitted.col(c).data();
    const auto [least, largest] = std::minmax_element(fitted, fitted + pass.count);
    const double beyond = std::max({ *largest - cell.high, cell.low - *least, 0.0 });
    cell.found.overshoot = range > 0 ? static_cast<float>(beyond / range) : 0.0F;
    cell.found.limited = beyond > m_Parameters.overshootLimit * range;
    cell.found.sparse = cell.values.size() < pass.count;
    if (cell.found.limited)
    {
      LimitControlValues(pass.degree, cell.low, cell.high, m_Parameters.overshootLimit * range, fitted);
    }
    m_Findings[t] = cell.found;
    if (m_Parameters.maximumError > 0)
    {
      m_Open[t] = this->SquaredError(pass, batch, c) > m_Parameters.maximumError * m_Parameters.maximumError ? 1 : 0;
    }
    m_Mesh.degree[t] = pass.degree;
    std::copy_n(fitted, pass.count, &m_Mesh.coefficients[t * row]);
  }
}

void
Fitter::FitBatch(const Pass & pass, Batch & batch)
{
  std::vector<CellVoxel> found;
  for (std::size_t c = 0; c < batch.cells.size(); ++c)
  {
    this->Sample(batch, c);
  }
  batch.report.finite = batch.samples.allFinite();
  if (!batch.report.finite)
  {
    return;
  }
  batch.kernel.FitMany(batch.cells.size(), batch.samples.data(), batch.fitted.data());
  for (std::size_t c = 0; c < batch.cells.size(); ++c)
  {
    this->FindVoxels(batch, c, found);
    if (m_Image.weights)
    {
      this->WeighSamples(pass, batch, c);
    }
    if (m_Parameters.voxelWeight > 0)
    {
      this->AddVoxels(pass, batch, c);
    }
  }
  batch.fitted.noalias() += OrthonormalToBernstein(pass.degree) * batch.change;
  this->Finish(pass, batch);
}

void
Fitter::Summarize(DensityFitReport & report) const
{
  std::vector<float> overshoot;
  for (const Finding & found : m_Findings)
  {
    overshoot.push_back(found.overshoot);
    report.voxels += found.voxels;
    report.sparse += found.sparse ? 1 : 0;
    report.limited += found.limited ? 1 : 0;
    report.unsupported += found.unsupported ? 1 : 0;
  }
  const auto at = [&overshoot](double share) {
    const auto place =
      overshoot.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(overshoot.size() - 1));
    std::nth_element(overshoot.begin(), place, overshoot.end());
    return static_cast<double>(*place);
  };
  report.overshootMedian = at(0.5);
  report.overshoot90 = at(0.9);
  report.overshootMaximum = at(1.0);
}

DensityFitReport
Fitter::Run(const Execution & execution)
{
  m_Mesh.maximumDegree = m_Parameters.degree;
  m_Mesh.degree.assign(m_Mesh.tetrahedra.size(), m_Parameters.degree);
  m_Mesh.coefficients.assign(m_Mesh.tetrahedra.size() * BernsteinCount(m_Parameters.degree), 0.0);
  const double voxelVolume = m_Image.grid.VoxelVolume();

  DensityFitReport report;
  const int        first = m_Parameters.maximumError > 0 ? 0 : m_Parameters.degree;
  const double     passes = m_Parameters.degree - first + 1;
  for (int degree = first; degree <= m_Parameters.degree; ++degree)
  {
    std::vector<IdType> cells;
    for (std::size_t t = 0; t < m_Open.size(); ++t)
    {
      if (m_Open[t] != 0)
      {
        cells.push_back(static_cast<IdType>(t));
      }
    }
    const Pass                    pass(m_Mesh, cells, voxelVolume, degree, m_Parameters);
    std::vector<DensityFitReport> reports(pass.plan.GetBatches().size());
    execution.Part((degree - first) / passes, (degree - first + 1) / passes).For(reports.size(), [&](std::size_t b) {
      Batch batch(pass.plan.GetBatches()[b], pass.count);
      this->FitBatch(pass, batch);
      reports[b] = batch.report;
    });
    for (const DensityFitReport & r : reports)
    {
      report.samples += r.samples;
      report.outside += r.outside;
      report.finite = report.finite && r.finite;
    }
    if (!report.finite)
    {
      break;
    }
  }
  this->Summarize(report);
  return report;
}

void
ClearUnused(MeshArrays & mesh)
{
  const int largest = *std::max_element(mesh.degree.begin(), mesh.degree.end());
  if (largest == mesh.maximumDegree)
  {
    return;
  }
  const std::size_t from = BernsteinCount(mesh.maximumDegree), to = BernsteinCount(largest);
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
  {
    std::copy_n(&mesh.coefficients[t * from], to, &mesh.coefficients[t * to]);
  }
  mesh.coefficients.resize(mesh.tetrahedra.size() * to);
  mesh.maximumDegree = largest;
}
} // namespace

std::string
FindConflict(const DensityFitParameters & parameters)
{
  if (parameters.continuousGradient && parameters.maximumError > 0)
  {
    return "A density with a continuous gradient has one degree: set no bound on its error, or leave the gradient as "
           "it is";
  }
  if (parameters.continuousGradient && parameters.degree != 3)
  {
    return "A density with a continuous gradient has degree 3, not " + std::to_string(parameters.degree) +
           ": set the degree to 3, or leave the gradient as it is";
  }
  if (parameters.continuous && parameters.maximumError > 0)
  {
    return "A continuous density has one degree: set MaximumError to 0, or turn Continuous off";
  }
  if (parameters.continuous && parameters.degree < 1)
  {
    return "A continuous density needs Degree 1 or more: raise it, or turn Continuous off";
  }
  return {};
}

DensityFitReport
FitDensity(MeshArrays &                 mesh,
           const DensityFitImage &      image,
           const DensityFitParameters & parameters,
           const Execution &            execution)
{
  const DensityFitReport report = Fitter(mesh, image, parameters).Run(execution);
  ClearUnused(mesh);
  return report;
}

OutlineContrast
MeasureSurfaceContrast(const MeshArrays & mesh, const VoxelGrid & grid, const ImageSampler & values)
{
  const double          pixel = grid.axes.colwise().norm().maxCoeff();
  const double          inward = 0.5 * pixel, outward = OutlineContrast::ReachOutside(pixel);
  const Eigen::Matrix3d toIndex = grid.axes.inverse();
  std::vector<Vector3>  places; // inside and outside in turn
  std::vector<double>   areas;
  MeshArrays            joined;
  if (mesh.neighbors.empty())
  {
    joined.tetrahedra = mesh.tetrahedra;
    joined.neighbors = ComputeFaceNeighbors(mesh.tetrahedra);
  }
  for (const auto & face : BoundaryFaces(mesh.neighbors.empty() ? joined : mesh))
  {
    const Vector3 & a = mesh.points[face[0]];
    const Vector3   normal = (mesh.points[face[1]] - a).cross(mesh.points[face[2]] - a);
    const double    area = normal.norm();
    if (area > 0.0)
    {
      const Vector3 middle = (a + mesh.points[face[1]] + mesh.points[face[2]]) / 3.0;
      places.push_back(toIndex * (middle - inward / area * normal - grid.origin));
      places.push_back(toIndex * (middle + outward / area * normal - grid.origin));
      areas.push_back(area);
    }
  }
  std::vector<double> found(places.size());
  values(places.data(), places.size(), found.data());
  const Vector3   last(grid.size[0] - 1.0, grid.size[1] - 1.0, grid.size[2] - 1.0);
  OutlineContrast contrast;
  for (std::size_t k = 0; k < areas.size(); ++k)
  {
    const Vector3 & beyond = places[2 * k + 1];
    if ((beyond.array() >= 0.0).all() && (beyond.array() <= last.array()).all())
    {
      contrast.Add(found[2 * k], found[2 * k + 1], areas[k]);
    }
  }
  return contrast;
}

bool
LimitControlValues(int degree, double low, double high, double margin, double * coefficients)
{
  const Eigen::Index          count = BernsteinCount(degree);
  Eigen::Map<Eigen::VectorXd> c(coefficients, count);
  const double                least = low - margin, largest = high + margin;
  if (c.minCoeff() >= least && c.maxCoeff() <= largest)
  {
    return false;
  }
  const Eigen::VectorXd orthonormal = BernsteinToOrthonormal(degree) * c;
  for (int k = degree - 1; k >= 0; --k)
  {
    const Eigen::Index    kept = BernsteinCount(k);
    const Eigen::VectorXd lower = OrthonormalToBernstein(degree).leftCols(kept) * orthonormal.head(kept);
    const bool            inside = lower.minCoeff() >= least && lower.maxCoeff() <= largest;
    if (!inside && k > 0)
    {
      c = lower;
      continue;
    }
    double share = inside ? 1.0 : 0.0; // of the part of degree k + 1 that may stay
    for (Eigen::Index i = 0; inside && i < count; ++i)
    {
      const double step = c[i] - lower[i];
      const double room = step > 0 ? largest - lower[i] : least - lower[i];
      share = std::abs(step) > std::abs(room) ? std::min(share, room / step) : share;
    }
    c = lower + share * (c - lower);
    break;
  }
  return true;
}
} // namespace bone
