/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneContinuousDensity.h"

#include "boneBernstein.h"
#include "boneSharedCoefficients.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace bone
{
namespace
{
constexpr std::size_t BlockSize = 256;  // tetrahedra of one matrix product
constexpr std::size_t ChunkSize = 8192; // coefficients of one partial sum

using Vector = Eigen::VectorXd;

/** The assembled mass matrix and its preconditioner, applied without being stored. */
class MassSystem
{
public:
  MassSystem(const MeshArrays & mesh, const SharedCoefficients & shared, const Execution & execution)
    : m_Shared(shared)
    , m_Execution(execution)
    , m_Cells(mesh.tetrahedra.size())
    , m_Count(BernsteinCount(mesh.maximumDegree))
    , m_Mass(Eigen::Map<const Eigen::MatrixXd>(BernsteinGramMatrix(mesh.maximumDegree, mesh.maximumDegree).data(),
                                               m_Count,
                                               m_Count))
    , m_Inverse(m_Mass.ldlt().solve(Eigen::MatrixXd::Identity(m_Count, m_Count)))
    , m_Volume(m_Cells)
    , m_Local(m_Cells * m_Count)
  {
    for (std::size_t t = 0; t < m_Cells; ++t)
    {
      const Id4 & v = mesh.tetrahedra[t];
      m_Volume[t] = SignedVolume(mesh.points[v[0]], mesh.points[v[1]], mesh.points[v[2]], mesh.points[v[3]]);
      if (!(m_Volume[t] > 0))
      {
        throw std::invalid_argument("Tetrahedron " + std::to_string(t) +
                                    " is flat or inverted; a continuous density needs a valid mesh.");
      }
    }
    m_Weight.resize(shared.size);
    this->ForChunks([&](std::size_t i) {
      double volume = 0;
      shared.ForUses(i, [&](std::size_t use) { volume += m_Volume[use / m_Count]; });
      m_Weight[i] = 1 / volume;
    });
  }

  /** For every coefficient the mean of the tetrahedra's own, by volume. */
  Vector
  MeanOf(const double * local) const
  {
    Vector mean(m_Shared.size);
    this->ForChunks([&](std::size_t i) {
      double sum = 0;
      m_Shared.ForUses(i, [&](std::size_t use) { sum += m_Volume[use / m_Count] * local[use]; });
      mean[i] = sum * m_Weight[i];
    });
    return mean;
  }

  /** Sum over tetrahedra of volume times mass matrix times their own coefficients. */
  Vector
  RightSide(const double * local)
  {
    this->ForBlocks(m_Mass, [&](std::size_t t, double * in) {
      for (std::size_t c = 0; c < m_Count; ++c)
      {
        in[c] = m_Volume[t] * local[t * m_Count + c];
      }
    });
    return this->Assemble([](std::size_t, double value) { return value; });
  }

  Vector
  Apply(const Vector & x)
  {
    this->ForBlocks(m_Mass, [&](std::size_t t, double * in) {
      for (std::size_t c = 0; c < m_Count; ++c)
      {
        in[c] = m_Volume[t] * x[m_Shared.global[t * m_Count + c]];
      }
    });
    return this->Assemble([](std::size_t, double value) { return value; });
  }

  /** Inverses of the tetrahedra's matrices between weights that share a residual out by volume. */
  Vector
  Precondition(const Vector & r)
  {
    this->ForBlocks(m_Inverse, [&](std::size_t t, double * in) {
      for (std::size_t c = 0; c < m_Count; ++c)
      {
        const std::size_t i = m_Shared.global[t * m_Count + c];
        in[c] = m_Weight[i] * r[i];
      }
    });
    return this->Assemble([this](std::size_t use, double value) {
      return m_Weight[m_Shared.global[use]] * m_Volume[use / m_Count] * value;
    });
  }

  /** Sum in a fixed order, for any number of threads. */
  double
  Dot(const Vector & a, const Vector & b) const
  {
    const std::size_t   chunks = (m_Shared.size + ChunkSize - 1) / ChunkSize;
    std::vector<double> partial(chunks);
    m_Execution.For(chunks, [&](std::size_t chunk) {
      const std::size_t begin = chunk * ChunkSize, count = std::min(ChunkSize, m_Shared.size - begin);
      partial[chunk] = a.segment(begin, count).dot(b.segment(begin, count));
    });
    double sum = 0;
    for (double p : partial)
    {
      sum += p;
    }
    return sum;
  }

private:
  template <typename TBody>
  void
  ForChunks(const TBody & body) const
  {
    m_Execution.For((m_Shared.size + ChunkSize - 1) / ChunkSize, [&](std::size_t chunk) {
      const std::size_t end = std::min((chunk + 1) * ChunkSize, m_Shared.size);
      for (std::size_t i = chunk * ChunkSize; i < end; ++i)
      {
        body(i);
      }
    });
  }

  /** m_Local = matrix times what `gather` gives for each tetrahedron. */
  template <typename TGather>
  void
  ForBlocks(const Eigen::MatrixXd & matrix, const TGather & gather)
  {
    m_Execution.For((m_Cells + BlockSize - 1) / BlockSize, [&](std::size_t block) {
      const std::size_t begin = block * BlockSize, count = std::min(BlockSize, m_Cells - begin);
      Eigen::MatrixXd   in(m_Count, count);
      for (std::size_t t = 0; t < count; ++t)
      {
        gather(begin + t, in.col(t).data());
      }
      Eigen::Map<Eigen::MatrixXd>(&m_Local[begin * m_Count], m_Count, count).noalias() = matrix * in;
    });
  }

  template <typename TScale>
  Vector
  Assemble(const TScale & scale) const
  {
    Vector result(m_Shared.size);
    this->ForChunks([&](std::size_t i) {
      double sum = 0;
      m_Shared.ForUses(i, [&](std::size_t use) { sum += scale(use, m_Local[use]); });
      result[i] = sum;
    });
    return result;
  }

  const SharedCoefficients & m_Shared;
  const Execution            m_Execution;
  std::size_t                m_Cells;
  std::size_t                m_Count;
  Eigen::MatrixXd            m_Mass;
  Eigen::MatrixXd            m_Inverse;
  std::vector<double>        m_Volume;
  std::vector<double>        m_Weight; // 1 / volume around each coefficient
  std::vector<double>        m_Local;  // work: a value for each tetrahedron's coefficient
};
} // namespace

ContinuousDensityReport
MakeDensityContinuous(MeshArrays & mesh, const Execution & execution, double tolerance, int maximumIterations)
{
  const int degree = mesh.maximumDegree;
  if (degree < 1 || std::any_of(mesh.degree.begin(), mesh.degree.end(), [degree](int d) { return d != degree; }))
  {
    throw std::invalid_argument("A continuous density needs one degree of 1 or more in all tetrahedra.");
  }
  const SharedCoefficients shared = ShareCoefficients(mesh);
  MassSystem               system(mesh, shared, execution.Silent());
  ContinuousDensityReport  report;
  report.freeCoefficients = shared.size;

  const Vector right = system.RightSide(mesh.coefficients.data());
  Vector       x = system.MeanOf(mesh.coefficients.data());
  Vector       r = right - system.Apply(x);
  const double target = tolerance * std::sqrt(system.Dot(right, right));
  double       size = std::sqrt(system.Dot(r, r));
  const double begin = size;
  Vector       p;
  double       rz = 0;
  while (size > target && report.iterations < maximumIterations)
  {
    const Vector z = system.Precondition(r);
    const double next = system.Dot(r, z);
    p = report.iterations == 0 ? z : Vector(z + (next / rz) * p);
    rz = next;
    const Vector q = system.Apply(p);
    const double step = rz / system.Dot(p, q);
    x += step * p;
    r -= step * q;
    size = std::sqrt(system.Dot(r, r));
    ++report.iterations;
    execution.Report(std::log(begin / size) / std::log(begin / target));
  }
  report.residual = target > 0 ? size / target * tolerance : 0.0;
  for (std::size_t use = 0; use < shared.global.size(); ++use)
  {
    mesh.coefficients[use] = x[shared.global[use]];
  }
  return report;
}
} // namespace bone
