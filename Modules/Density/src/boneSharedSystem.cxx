/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSharedSystem.h"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace bone
{
SharedSystem::SharedSystem(const MeshArrays &         mesh,
                           const SharedCoefficients & shared,
                           std::size_t                count,
                           const Execution &          execution)
  : m_Shared(shared)
  , m_Execution(execution)
  , m_Cells(mesh.tetrahedra.size())
  , m_Count(count)
  , m_Volume(m_Cells)
  , m_Weight(shared.size)
  , m_Local(m_Cells * count)
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
  this->ForChunks([&](std::size_t i) {
    double volume = 0;
    shared.ForUses(i, [&](std::size_t use) { volume += m_Volume[use / m_Count]; });
    m_Weight[i] = 1 / volume;
  });
}

SharedSystem::Vector
SharedSystem::MeanOf(const double * local) const
{
  Vector mean(m_Shared.size);
  this->ForChunks([&](std::size_t i) {
    double sum = 0;
    m_Shared.ForUses(i, [&](std::size_t use) { sum += m_Volume[use / m_Count] * local[use]; });
    mean[i] = sum * m_Weight[i];
  });
  return mean;
}

double
SharedSystem::Dot(const Vector & a, const Vector & b) const
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

ContinuousDensityReport
SharedSystem::Solve(const Vector &    right,
                    Vector &          x,
                    double            tolerance,
                    int               maximumIterations,
                    const Execution & execution)
{
  ContinuousDensityReport report;
  report.freeCoefficients = m_Shared.size;
  Vector       r = right - this->Apply(x);
  const double target = tolerance * std::sqrt(this->Dot(right, right));
  double       size = std::sqrt(this->Dot(r, r));
  const double begin = size;
  Vector       p;
  double       rz = 0;
  while (size > target && report.iterations < maximumIterations)
  {
    const Vector z = this->Precondition(r);
    const double next = this->Dot(r, z);
    p = report.iterations == 0 ? z : Vector(z + (next / rz) * p);
    rz = next;
    const Vector q = this->Apply(p);
    const double step = rz / this->Dot(p, q);
    x += step * p;
    r -= step * q;
    size = std::sqrt(this->Dot(r, r));
    ++report.iterations;
    execution.Report(std::log(begin / size) / std::log(begin / target));
  }
  report.residual = target > 0 ? size / target * tolerance : 0.0;
  return report;
}
} // namespace bone
