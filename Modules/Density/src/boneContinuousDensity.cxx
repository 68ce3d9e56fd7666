/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneContinuousDensity.h"

#include "boneBernstein.h"
#include "boneSharedSystem.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <stdexcept>

namespace bone
{
namespace
{
/** The assembled mass matrix of one degree and its preconditioner. */
class MassSystem : public SharedSystem
{
public:
  MassSystem(const MeshArrays & mesh, const SharedCoefficients & shared, const Execution & execution)
    : SharedSystem(mesh, shared, BernsteinCount(mesh.maximumDegree), execution)
    , m_Mass(Eigen::Map<const Eigen::MatrixXd>(BernsteinGramMatrix(mesh.maximumDegree, mesh.maximumDegree).data(),
                                               m_Count,
                                               m_Count))
    , m_Inverse(m_Mass.ldlt().solve(Eigen::MatrixXd::Identity(m_Count, m_Count)))
  {}

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
    return this->Assemble();
  }

  Vector
  Apply(const Vector & x) override
  {
    this->ForBlocks(m_Mass, [&](std::size_t t, double * in) {
      for (std::size_t c = 0; c < m_Count; ++c)
      {
        in[c] = m_Volume[t] * x[m_Shared.global[t * m_Count + c]];
      }
    });
    return this->Assemble();
  }

  /** Inverses of the tetrahedra's matrices between weights that share a residual out by volume. */
  Vector
  Precondition(const Vector & r) override
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

private:
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

  Eigen::MatrixXd m_Mass;
  Eigen::MatrixXd m_Inverse;
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
  const SharedCoefficients   shared = ShareCoefficients(mesh, degree);
  MassSystem                 system(mesh, shared, execution.Silent());
  const SharedSystem::Vector right = system.RightSide(mesh.coefficients.data());
  SharedSystem::Vector       x = system.MeanOf(mesh.coefficients.data());
  const auto                 report = system.Solve(right, x, tolerance, maximumIterations, execution);
  for (std::size_t use = 0; use < shared.global.size(); ++use)
  {
    mesh.coefficients[use] = x[shared.global[use]];
  }
  return report;
}
} // namespace bone
