/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneSharedSystem_h
#define boneSharedSystem_h

#include "boneContinuousDensity.h"
#include "boneExecution.h"
#include "boneMeshArrays.h"
#include "boneSharedCoefficients.h"

#include <cmath>

namespace bone
{
/** A symmetric positive system that is assembled from the tetrahedra's own, without being stored. Sums are in a fixed
 * order, for any number of threads. */
class SharedSystem
{
public:
  using Vector = Eigen::VectorXd;

  /** `count` is the number of a tetrahedron's own coefficients. Throws std::invalid_argument where one is flat or
   * inverted. */
  SharedSystem(const MeshArrays &         mesh,
               const SharedCoefficients & shared,
               std::size_t                count,
               const Execution &          execution);
  virtual ~SharedSystem() = default;

  virtual Vector
  Apply(const Vector & x) = 0;
  virtual Vector
  Precondition(const Vector & r) = 0;

  /** For every coefficient the mean of the tetrahedra's own, by volume. */
  Vector
  MeanOf(const double * local) const;

  double
  Dot(const Vector & a, const Vector & b) const;

  /** Conjugate gradients from x on, until the residual is at most `tolerance` times the right side. Progress is by
   * iterations. */
  ContinuousDensityReport
  Solve(const Vector & right, Vector & x, double tolerance, int maximumIterations, const Execution & execution);

protected:
  static constexpr std::size_t BlockSize = 256;  // tetrahedra at a time
  static constexpr std::size_t ChunkSize = 8192; // coefficients of one partial sum

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

  /** For every coefficient the sum over its uses of scale(use, m_Local[use]). */
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

  Vector
  Assemble() const
  {
    return this->Assemble([](std::size_t, double value) { return value; });
  }

  const SharedCoefficients & m_Shared;
  const Execution            m_Execution;
  std::size_t                m_Cells;
  std::size_t                m_Count;
  std::vector<double>        m_Volume;
  std::vector<double>        m_Weight; // 1 / volume around each coefficient
  std::vector<double>        m_Local;  // work: a value for each tetrahedron's coefficient
};
} // namespace bone

#endif
