/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSurfaceBending.h"

#include "boneSparseCholesky.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace bone
{
namespace
{
/** Of the mean deviation: above it deviations count by themselves. */
constexpr double SoftShare = 1.0 / 8;
/** mm^2 and mm: of an edge and a triangle no shorter and no flatter is looked at. */
constexpr double Tiny = 1e-9;
/** Of the weight that draws a point: what holds it where it is. */
constexpr double Hold = 0.1;

double
Cotangent(const Vector3 & u, const Vector3 & v)
{
  return u.dot(v) / std::max(u.cross(v).norm(), Tiny);
}

/** Factors of the four points in the vector whose length is the deviation times the edge's length. */
std::array<double, 4>
DeviationFactors(const Vector3 & a, const Vector3 & b, const Vector3 & c, const Vector3 & d)
{
  const double ac = Cotangent(b - a, c - a), ad = Cotangent(b - a, d - a);
  const double bc = Cotangent(a - b, c - b), bd = Cotangent(a - b, d - b);
  return { { bc + bd, ac + ad, -ac - bc, -ad - bd } };
}

/** The edge, then the opposite corners. */
using Hinge = std::array<IdType, 4>;

/** Edges within surfaces that are not cut flat, each with its surface. */
std::vector<std::pair<int, Hinge>>
HingesOf(const TetraComplex & complex)
{
  struct Side
  {
    int    surface;
    IdType a;
    IdType b;
    IdType corner;
  };
  std::vector<Side> sides;
  for (IdType t = 0; t < complex.Size(); ++t)
  {
    for (int i = 0; i < 4 && complex.IsAlive(t); ++i)
    {
      const int surface = complex.Carries(t, i) ? complex.FaceSurfaces(t)[i] : -1;
      for (int k = 0; k < 3 && surface >= 0 && complex.Surfaces().surfaces[surface].flat < 0; ++k)
      {
        const Id4 &  cell = complex.Cell(t);
        const IdType a = cell[TetraFaces[i][k]], b = cell[TetraFaces[i][(k + 1) % 3]];
        sides.push_back({ surface, std::min(a, b), std::max(a, b), cell[TetraFaces[i][(k + 2) % 3]] });
      }
    }
  }
  const auto edge = [](const Side & side) { return std::tie(side.surface, side.a, side.b); };
  std::stable_sort(sides.begin(), sides.end(), [&edge](const Side & x, const Side & y) { return edge(x) < edge(y); });
  std::vector<std::pair<int, Hinge>> hinges;
  for (std::size_t i = 0, end = 0; i < sides.size(); i = end)
  {
    for (end = i + 1; end < sides.size() && edge(sides[end]) == edge(sides[i]);)
    {
      ++end;
    }
    if (end == i + 2)
    {
      hinges.push_back({ sides[i].surface, { sides[i].a, sides[i].b, sides[i].corner, sides[i + 1].corner } });
    }
  }
  return hinges;
}

/** The system of SurfaceBending::Solve, by the points that are free. */
class HingeSystem
{
public:
  HingeSystem(const std::vector<Vector3> &                points,
              const std::vector<char> &                   isFree,
              const std::vector<SurfaceBending::Spring> & springs,
              std::size_t                                 hinges)
    : m_Points(points)
    , m_Place(points.size(), -1)
  {
    std::vector<double> weights(points.size(), 0.0);
    for (const auto & spring : springs)
    {
      for (int i = 0; i < 3; ++i)
      {
        weights[spring.points[i]] += spring.weight * spring.shares[i];
      }
    }
    for (std::size_t p = 0; p < points.size(); ++p)
    {
      if (isFree[p] && weights[p] > 0)
      {
        m_Place[p] = static_cast<int>(m_Free.size());
        m_Free.push_back(static_cast<IdType>(p));
      }
    }
    m_Right.setZero(static_cast<Eigen::Index>(m_Free.size()), 3);
    m_Entries.reserve(m_Free.size() + 6 * springs.size() + 10 * hinges);
    for (IdType p : m_Free)
    {
      Add<1>({ p }, { 1.0 }, Hold * weights[p], points[p]);
    }
    for (const auto & spring : springs)
    {
      Add<3>(spring.points, spring.shares, spring.weight, spring.target);
    }
  }

  /** weight times the squared distance of the sum of points times factors from a target. */
  template <std::size_t VCount>
  void
  Add(const std::array<IdType, VCount> & points,
      const std::array<double, VCount> & factors,
      double                             weight,
      const Vector3 &                    target)
  {
    for (std::size_t i = 0; i < VCount; ++i)
    {
      const int row = m_Place[points[i]];
      if (row < 0)
      {
        continue;
      }
      m_Right.row(row) += weight * factors[i] * target;
      for (std::size_t j = 0; j < VCount; ++j)
      {
        const double value = weight * factors[i] * factors[j];
        const int    column = m_Place[points[j]];
        if (column >= 0)
        {
          if (row >= column) // the lower triangle is enough
          {
            m_Entries.push_back({ row, column, value });
          }
        }
        else
        {
          m_Right.row(row) -= value * m_Points[points[j]];
        }
      }
    }
  }

  std::vector<Vector3>
  Solve() const
  {
    std::vector<Vector3> result = m_Points;
    if (m_Free.empty())
    {
      return result;
    }
    SparseCholesky        factor;
    const bool            factorized = factor.Factorize(m_Right.rows(), m_Entries);
    const Eigen::MatrixXd solution = factor.Solve(m_Right);
    if (factorized && solution.allFinite())
    {
      for (std::size_t i = 0; i < m_Free.size(); ++i)
      {
        result[m_Free[i]] = solution.row(static_cast<Eigen::Index>(i));
      }
    }
    return result;
  }

private:
  const std::vector<Vector3> & m_Points;
  std::vector<int>             m_Place; ///< of each point in the system, -1: it stays
  std::vector<IdType>          m_Free;
  std::vector<SparseEntry>     m_Entries;
  Eigen::MatrixX3d             m_Right;
};
} // namespace

double
DihedralDeviation(const Vector3 & a, const Vector3 & b, const Vector3 & c, const Vector3 & d)
{
  const Vector3 e = b - a, n = e.cross(c - a), m = (d - a).cross(e);
  return std::atan2(n.cross(m).norm(), n.dot(m));
}

double
MeanBoundaryDeviation(const TetraComplex & complex, const std::vector<int> & slices)
{
  const auto & x = complex.Points();
  double       deviations = 0.0;
  std::size_t  count = 0;
  for (const auto & [surface, h] : HingesOf(complex))
  {
    const bool within = slices.empty() || slices[h[0]] == slices[h[1]];
    if (within && complex.Surfaces().surfaces[surface].IsBoundary())
    {
      deviations += DihedralDeviation(x[h[0]], x[h[1]], x[h[2]], x[h[3]]);
      ++count;
    }
  }
  return count > 0 ? deviations / static_cast<double>(count) : 0.0;
}

SurfaceBending::SurfaceBending(const TetraComplex & complex, double stiffness)
{
  for (const auto & [surface, hinge] : HingesOf(complex))
  {
    m_Hinges.push_back(hinge);
  }
  const auto &      x = complex.Points();
  std::vector<char> isEnd(x.size(), 0);
  double            deviations = 0.0, area = 0.0;
  for (const Hinge & h : m_Hinges)
  {
    deviations += DihedralDeviation(x[h[0]], x[h[1]], x[h[2]], x[h[3]]);
    const Vector3 edge = x[h[1]] - x[h[0]];
    area += (edge.cross(x[h[2]] - x[h[0]]).norm() + edge.cross(x[h[3]] - x[h[0]]).norm()) / 6.0; // a triangle has three
    isEnd[h[0]] = isEnd[h[1]] = 1;
  }
  if (deviations > 0)
  {
    m_SoftDeviation = SoftShare * deviations / static_cast<double>(m_Hinges.size());
    m_Factor = stiffness * std::pow(area / static_cast<double>(std::count(isEnd.begin(), isEnd.end(), 1)), 2);
  }
}

double
SurfaceBending::Softening(double deviation) const
{
  return 1.0 / (1.0 + deviation / m_SoftDeviation);
}

double
SurfaceBending::Energy(const Vector3 & a, const Vector3 & b, const Vector3 & c, const Vector3 & d) const
{
  const double deviation = DihedralDeviation(a, b, c, d);
  return m_Factor * deviation * deviation * Softening(deviation);
}

std::vector<Vector3>
SurfaceBending::Solve(const std::vector<Vector3> & points,
                      const std::vector<char> &    isFree,
                      const std::vector<Spring> &  springs) const
{
  HingeSystem system(points, isFree, springs, m_Hinges.size());
  for (const Hinge & h : m_Hinges)
  {
    const Vector3 &a = points[h[0]], &b = points[h[1]], &c = points[h[2]], &d = points[h[3]];
    const double   squared = std::max((b - a).squaredNorm(), Tiny);
    const double   stiffness = m_Factor * Softening(DihedralDeviation(a, b, c, d)) / squared;
    system.Add<4>(h, DeviationFactors(a, b, c, d), stiffness, Vector3::Zero());
  }
  return system.Solve();
}
} // namespace bone
