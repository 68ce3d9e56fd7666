/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneNonRigidICP.h"

#include "boneSparseCholesky.h"

#include <algorithm>
#include <set>

namespace bone
{
namespace
{
constexpr double NormalCosine = 0.5; // closest points whose normals differ by more do not count

std::vector<std::array<IdType, 2>>
Edges(const TriangleSurface & surface)
{
  std::set<std::array<IdType, 2>> edges;
  for (const auto & t : surface.triangles)
  {
    for (int i = 0; i < 3; ++i)
    {
      edges.insert({ std::min(t[i], t[(i + 1) % 3]), std::max(t[i], t[(i + 1) % 3]) });
    }
  }
  return { edges.begin(), edges.end() };
}

/** The normal equations (alpha^2 (M x G)^T (M x G) + (W D)^T (W D)) X = (W D)^T W U of the paper's equation 12, where
 * the rows of X are the transposed 3 by 4 affine maps of the vertices. */
class NonRigidSystem
{
public:
  explicit NonRigidSystem(const TriangleSurface & source)
    : m_Rest(source.points)
    , m_Edges(Edges(source))
  {
    Eigen::AlignedBox3d box;
    for (const Vector3 & x : m_Rest)
    {
      box.extend(x);
    }
    m_Centre = box.center();
    m_Scale = 0.5 * box.diagonal().norm();
  }

  std::vector<Vector3>
  Solve(double stiffness, const std::vector<Vector3> & places, const std::vector<double> & weights)
  {
    const auto               n = static_cast<Eigen::Index>(m_Rest.size());
    std::vector<SparseEntry> entries;
    for (const auto & edge : m_Edges)
    {
      const int a = 4 * edge[0], b = 4 * edge[1];
      for (int i = 0; i < 4; ++i)
      {
        entries.push_back({ a + i, a + i, stiffness });
        entries.push_back({ b + i, b + i, stiffness });
        entries.push_back({ std::max(a, b) + i, std::min(a, b) + i, -stiffness });
      }
    }
    Eigen::MatrixXd right = Eigen::MatrixX3d::Zero(4 * n, 3);
    for (Eigen::Index v = 0; v < n; ++v)
    {
      const double          w = weights[static_cast<std::size_t>(v)];
      const Eigen::Vector4d x = this->Homogeneous(v);
      for (int i = 0; i < 4; ++i)
      {
        for (int j = 0; j <= i; ++j)
        {
          entries.push_back({ 4 * v + i, 4 * v + j, w * x[i] * x[j] });
        }
        right.row(4 * v + i) = w * x[i] * ((places[static_cast<std::size_t>(v)] - m_Centre) / m_Scale).transpose();
      }
    }
    m_Factor.Factorize(4 * n, entries);
    const Eigen::MatrixXd maps = m_Factor.Solve(right);
    std::vector<Vector3>  moved(m_Rest.size());
    for (Eigen::Index v = 0; v < n; ++v)
    {
      moved[static_cast<std::size_t>(v)] =
        m_Centre + m_Scale * (maps.middleRows<4>(4 * v).transpose() * this->Homogeneous(v));
    }
    return moved;
  }

private:
  Eigen::Vector4d
  Homogeneous(Eigen::Index v) const
  {
    Eigen::Vector4d x;
    x << (m_Rest[static_cast<std::size_t>(v)] - m_Centre) / m_Scale, 1.0;
    return x;
  }

  std::vector<Vector3>               m_Rest;
  std::vector<std::array<IdType, 2>> m_Edges;
  Vector3                            m_Centre;
  double                             m_Scale;
  SparseCholesky                     m_Factor;
};
} // namespace

std::vector<Vector3>
DeformNonRigidICP(const TriangleSurface &       source,
                  const DirectedSurface &       target,
                  const NonRigidICPParameters & parameters,
                  const Execution &             execution)
{
  NonRigidSystem  system(source);
  TriangleSurface now = source;
  std::size_t     step = 0;
  for (const double stiffness : parameters.stiffness)
  {
    execution.Report(static_cast<double>(step++) / static_cast<double>(parameters.stiffness.size()));
    double move = parameters.tolerance + 1;
    for (int i = 0; i < parameters.iterations && move > parameters.tolerance; ++i)
    {
      const std::vector<Vector3> normals = PointNormals(now);
      std::vector<Vector3>       places = now.points;
      std::vector<double>        weights(now.points.size(), 0.0);
      execution.Silent().For(
        now.points.size(),
        [&](std::size_t v) {
          const auto match = target.Find(now.points[v], normals[v]);
          if (match.triangle >= 0 && normals[v].dot(target.NormalAt(match.triangle, match.point)) > NormalCosine)
          {
            places[v] = match.point;
            weights[v] = 1.0;
          }
        },
        64);
      std::vector<Vector3> moved = system.Solve(stiffness, places, weights);
      move = 0;
      for (std::size_t v = 0; v < moved.size(); ++v)
      {
        move += (moved[v] - now.points[v]).norm() / static_cast<double>(moved.size());
      }
      now.points = std::move(moved);
    }
  }
  return now.points;
}
} // namespace bone
