/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneUntangling.h"

#include "bonePredicates.h"
#include "boneSymmetricEigen.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace bone
{
namespace
{
constexpr int    PatchRings = 2;       // neighbours of bad cells that move too
constexpr double ExteriorWeight = 1.0; // of an exterior point's squared move over the bound squared
constexpr int    Backtracks = 12;

class Untangler
{
public:
  Untangler(const MeshArrays &           rest,
            const std::vector<IdType> &  exterior,
            const AffineMap &            alignment,
            std::vector<Vector3> &       points,
            const UntanglingParameters & parameters)
    : m_Cells(rest.tetrahedra)
    , m_Points(points)
    , m_Home(points)
    , m_Exterior(points.size(), 0)
    , m_Star(points.size())
    , m_P(parameters)
  {
    for (const IdType p : exterior)
    {
      m_Exterior[p] = 1;
    }
    m_Inverse.resize(m_Cells.size());
    for (std::size_t t = 0; t < m_Cells.size(); ++t)
    {
      Eigen::Matrix3d edges;
      for (int i = 0; i < 3; ++i)
      {
        edges.col(i) = alignment.linear * (rest.points[m_Cells[t][i + 1]] - rest.points[m_Cells[t][0]]);
      }
      m_Inverse[t] = edges.inverse();
      for (const IdType p : m_Cells[t])
      {
        m_Star[p].push_back(static_cast<IdType>(t));
      }
    }
  }

  UntanglingReport
  Run(const Execution & execution)
  {
    UntanglingReport report;
    report.before = report.after = this->CountBad(0.0);
    if (report.before == 0)
    {
      return report;
    }
    // Exterior points stay where the others can do it alone.
    this->Work(false, execution.Part(0.0, 0.5));
    if (m_P.exteriorBound > 0 && this->CountBad(0.0) > 0)
    {
      this->Work(true, execution.Part(0.5, 1.0));
    }
    report.after = this->CountBad(0.0);
    for (std::size_t p = 0; p < m_Points.size(); ++p)
    {
      const double move = (m_Points[p] - m_Home[p]).norm();
      report.moved += move > 0 ? 1 : 0;
      report.exterior = m_Exterior[p] != 0 ? std::max(report.exterior, move) : report.exterior;
    }
    return report;
  }

private:
  void
  Work(bool moveExterior, const Execution & execution)
  {
    for (int i = 0; i<m_P.iterations && this->CountBad(m_P.floor)> 0; ++i)
    {
      execution.Report(static_cast<double>(i) / m_P.iterations);
      const std::vector<IdType> patch = this->Patch();
      this->SetRegularisation();
      for (const IdType p : patch)
      {
        if (moveExterior || m_Exterior[p] == 0)
        {
          execution.ThrowIfAborted();
          this->Improve(p);
        }
      }
    }
  }

  Eigen::Matrix3d
  Jacobian(IdType t) const
  {
    const Id4 &     c = m_Cells[t];
    Eigen::Matrix3d edges;
    for (int i = 0; i < 3; ++i)
    {
      edges.col(i) = m_Points[c[i + 1]] - m_Points[c[0]];
    }
    return edges * m_Inverse[t];
  }

  bool
  IsBad(IdType t, double floor) const
  {
    const Id4 & c = m_Cells[t];
    return Orient3D(m_Points[c[0]], m_Points[c[1]], m_Points[c[2]], m_Points[c[3]]) <= 0 ||
           (floor > 0 && this->Jacobian(t).determinant() < floor);
  }

  std::size_t
  CountBad(double floor) const
  {
    std::size_t count = 0;
    for (std::size_t t = 0; t < m_Cells.size(); ++t)
    {
      count += this->IsBad(static_cast<IdType>(t), floor) ? 1 : 0;
    }
    return count;
  }

  /** Points of bad cells and their neighbours, ascending. */
  std::vector<IdType>
  Patch() const
  {
    std::vector<char> in(m_Points.size(), 0);
    for (std::size_t t = 0; t < m_Cells.size(); ++t)
    {
      if (this->IsBad(static_cast<IdType>(t), m_P.floor))
      {
        for (const IdType p : m_Cells[t])
        {
          in[p] = 1;
        }
      }
    }
    for (int ring = 1; ring < PatchRings; ++ring)
    {
      const std::vector<char> before = in;
      for (const Id4 & c : m_Cells)
      {
        if (before[c[0]] + before[c[1]] + before[c[2]] + before[c[3]] > 0)
        {
          in[c[0]] = in[c[1]] = in[c[2]] = in[c[3]] = 1;
        }
      }
    }
    std::vector<IdType> patch;
    for (std::size_t p = 0; p < in.size(); ++p)
    {
      if (in[p] != 0)
      {
        patch.push_back(static_cast<IdType>(p));
      }
    }
    return patch;
  }

  void
  SetRegularisation()
  {
    double least = 1.0;
    for (std::size_t t = 0; t < m_Cells.size(); ++t)
    {
      least = std::min(least, this->Jacobian(static_cast<IdType>(t)).determinant());
    }
    m_Epsilon = std::sqrt(1e-6 + 0.04 * std::min(least, 0.0) * std::min(least, 0.0));
  }

  double
  Energy(IdType p, const Vector3 & x)
  {
    const Vector3 before = m_Points[p];
    m_Points[p] = x;
    double energy = 0;
    for (const IdType t : m_Star[p])
    {
      const Eigen::Matrix3d j = this->Jacobian(t);
      const double          d = j.determinant();
      const double          chi = 0.5 * (d + std::sqrt(m_Epsilon * m_Epsilon + d * d));
      energy += j.squaredNorm() / std::cbrt(chi * chi) + 0.2 * (d * d + 1) / chi;
    }
    if (m_Exterior[p] != 0)
    {
      energy += ExteriorWeight * (x - m_Home[p]).squaredNorm() / (m_P.exteriorBound * m_P.exteriorBound);
    }
    m_Points[p] = before;
    return energy;
  }

  /** A damped Newton step by differences; the energy falls or the point stays. */
  void
  Improve(IdType p)
  {
    const Vector3 x = m_Points[p];
    double        size = 0;
    for (const IdType t : m_Star[p])
    {
      size += std::cbrt(1.0 / std::abs(m_Inverse[t].determinant())) / static_cast<double>(m_Star[p].size());
    }
    const double          h = 1e-4 * size, e = this->Energy(p, x);
    Vector3               gradient;
    Eigen::Matrix3d       hessian;
    std::array<double, 3> plus, minus;
    for (int i = 0; i < 3; ++i)
    {
      plus[i] = this->Energy(p, x + h * Vector3::Unit(i));
      minus[i] = this->Energy(p, x - h * Vector3::Unit(i));
      gradient[i] = (plus[i] - minus[i]) / (2 * h);
      hessian(i, i) = (plus[i] - 2 * e + minus[i]) / (h * h);
    }
    for (int i = 0; i < 3; ++i)
    {
      for (int j = 0; j < i; ++j)
      {
        const double both = this->Energy(p, x + h * (Vector3::Unit(i) + Vector3::Unit(j)));
        hessian(i, j) = hessian(j, i) = (both - plus[i] - plus[j] + e) / (h * h);
      }
    }
    const SymmetricEigenOf<3> eigen = EigenOf(hessian);
    const double              largest = std::max(eigen.values.cwiseAbs().maxCoeff(), 1e-12);
    const Vector3             curvature = eigen.values.cwiseAbs().cwiseMax(1e-6 * largest);
    Vector3                   step = -eigen.vectors * (eigen.vectors.transpose() * gradient).cwiseQuotient(curvature);
    step *= std::min(1.0, size / std::max(step.norm(), 1e-300));
    for (int k = 0; k < Backtracks; ++k, step *= 0.5)
    {
      Vector3 y = x + step;
      if (m_Exterior[p] != 0 && (y - m_Home[p]).norm() > m_P.exteriorBound)
      {
        y = m_Home[p] + (y - m_Home[p]).normalized() * m_P.exteriorBound;
      }
      if (this->Energy(p, y) < e)
      {
        m_Points[p] = y;
        return;
      }
    }
  }

  const std::vector<Id4> &         m_Cells;
  std::vector<Vector3> &           m_Points;
  std::vector<Vector3>             m_Home;
  std::vector<char>                m_Exterior;
  std::vector<std::vector<IdType>> m_Star;
  std::vector<Eigen::Matrix3d>     m_Inverse; // of the edges of the cells at rest
  UntanglingParameters             m_P;
  double                           m_Epsilon{ 1e-3 };
};
} // namespace

UntanglingReport
UntangleMesh(const MeshArrays &           rest,
             const std::vector<IdType> &  exterior,
             const AffineMap &            alignment,
             std::vector<Vector3> &       points,
             const UntanglingParameters & parameters,
             const Execution &            execution)
{
  return Untangler(rest, exterior, alignment, points, parameters).Run(execution);
}
} // namespace bone
