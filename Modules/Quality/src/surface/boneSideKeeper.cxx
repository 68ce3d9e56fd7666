/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSideKeeper.h"

#include "boneTriangleDistance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

namespace bone
{
namespace
{
/** Squared barycentric coordinates of free points, summed: where they are fewer, a place cannot be moved. */
constexpr double LeastShare = 0.01;
/** Reaches from the boundary within which centres may come to the wrong side. */
constexpr double Surroundings = 3.0;

/** A centre near the boundary, and the place of the boundary nearest to it. */
struct Near
{
  IdType                triangle;
  std::array<double, 3> shares;   ///< barycentric coordinates of the place, 0 of points that stay
  Vector3               normal;   ///< unit, of the triangle
  double                distance; ///< mm, below 0 within the boundary; to first order in what has moved since
  bool                  inside;   ///< where it should be

  bool
  IsWrong() const
  {
    return (distance < 0) != inside;
  }
};

/** Centres near the boundary, by the points of their triangles. */
class NearCentres
{
public:
  NearCentres(const TetraComplex & complex, const LabelOutline & outline, double farthest, const Execution & execution)
    : m_Complex(complex)
    , m_Surface(complex.Points(), BoundaryFaces(complex))
    , m_AtPoint(complex.Points().size())
  {
    std::vector<std::optional<TriangleDistance::Nearest>> nearest(outline.voxels.size());
    execution.For(nearest.size(), [&](std::size_t v) {
      const Vector3 & centre = outline.voxels[v].centre;
      if (m_Surface.IsWithin(centre, farthest))
      {
        nearest[v] = m_Surface.FindNearest(centre);
      }
    });
    for (std::size_t v = 0; v < nearest.size(); ++v)
    {
      if (nearest[v])
      {
        Add(*nearest[v], outline.voxels[v].inside);
      }
    }
    m_Seen.assign(m_Centres.size(), -1);
  }

  const std::vector<Near> &
  Centres() const
  {
    return m_Centres;
  }

  /** The least moves of its triangle's points that bring the boundary beyond a centre by a margin. */
  std::array<Vector3, 3>
  MovesOf(const Near & near, double margin) const
  {
    const double           way = near.distance + (near.inside ? margin : -margin);
    double                 square = 0.0;
    std::array<Vector3, 3> moves{ { Vector3::Zero(), Vector3::Zero(), Vector3::Zero() } };
    for (double share : near.shares)
    {
      square += share * share;
    }
    for (int k = 0; k < 3 && square > LeastShare; ++k)
    {
      moves[k] = near.normal * (way * near.shares[k] / square);
    }
    return moves;
  }

  const TriangleIds &
  PointsOf(const Near & near) const
  {
    return m_Surface.GetTriangles()[near.triangle];
  }

  /** How many more centres would be on the wrong side if points of a triangle moved. */
  int
  CountMore(const TriangleIds & points, const std::array<Vector3, 3> & moves)
  {
    int more = 0;
    ++m_Stamp;
    for (IdType p : points)
    {
      for (int c : m_AtPoint[p])
      {
        if (m_Seen[c] != m_Stamp)
        {
          m_Seen[c] = m_Stamp;
          Near moved = m_Centres[c];
          Follow(points, moves, moved);
          more += static_cast<int>(moved.IsWrong()) - static_cast<int>(m_Centres[c].IsWrong());
        }
      }
    }
    return more;
  }

  /** A point has moved. */
  void
  Follow(IdType p, const Vector3 & move)
  {
    for (int c : m_AtPoint[p])
    {
      Follow({ p, -1, -1 }, { { move, Vector3::Zero(), Vector3::Zero() } }, m_Centres[c]);
    }
  }

private:
  void
  Add(const TriangleDistance::Nearest & nearest, bool inside)
  {
    const auto &        x = m_Complex.Points();
    const TriangleIds & ids = m_Surface.GetTriangles()[nearest.triangle];
    const Vector3       normal = (x[ids[1]] - x[ids[0]]).cross(x[ids[2]] - x[ids[0]]);
    Near near{ static_cast<IdType>(nearest.triangle), {}, normal.normalized(), nearest.distance, inside };
    for (int k = 0; k < 3; ++k)
    {
      const Vector3 a = x[ids[(k + 1) % 3]] - nearest.point, b = x[ids[(k + 2) % 3]] - nearest.point;
      near.shares[k] = m_Complex.Dimension(ids[k]) == 2 ? a.cross(b).dot(normal) / normal.squaredNorm() : 0.0;
      m_AtPoint[ids[k]].push_back(static_cast<int>(m_Centres.size()));
    }
    m_Centres.push_back(near);
  }

  void
  Follow(const TriangleIds & points, const std::array<Vector3, 3> & moves, Near & near) const
  {
    const TriangleIds & own = PointsOf(near);
    for (int k = 0; k < 3; ++k)
    {
      for (int j = 0; j < 3; ++j)
      {
        near.distance -= own[j] == points[k] ? near.shares[j] * near.normal.dot(moves[k]) : 0.0;
      }
    }
  }

  const TetraComplex &          m_Complex;
  TriangleDistance              m_Surface;
  std::vector<Near>             m_Centres;
  std::vector<std::vector<int>> m_AtPoint;
  std::vector<int>              m_Seen; ///< the stamp of the last count of each centre
  int                           m_Stamp{ 0 };
};
} // namespace

std::size_t
SideKeeper::Restore(TetraComplex &     complex,
                    PointMover &       mover,
                    const Parameters & parameters,
                    const Execution &  execution) const
{
  const double reach = parameters.reach * m_Outline.spacing, margin = parameters.margin * m_Outline.spacing;
  NearCentres  near(complex, m_Outline, Surroundings * reach, execution);
  std::vector<std::pair<double, int>> order;
  for (std::size_t c = 0; c < near.Centres().size(); ++c)
  {
    const double distance = std::abs(near.Centres()[c].distance);
    if (near.Centres()[c].IsWrong() && distance <= reach)
    {
      order.emplace_back(distance, static_cast<int>(c));
    }
  }
  std::sort(order.begin(), order.end());
  std::size_t moved = 0;
  for (const auto & entry : order)
  {
    const Near        centre = near.Centres()[entry.second];
    const TriangleIds points = near.PointsOf(centre);
    const auto        moves = near.MovesOf(centre, margin);
    if (!centre.IsWrong() || near.CountMore(points, moves) >= 0)
    {
      continue;
    }
    for (int k = 0; k < 3; ++k)
    {
      if (moves[k] != Vector3::Zero() &&
          mover.TryMove(points[k], complex.Points()[points[k]] + moves[k], parameters.cosineFloor) ==
            MeshOperation::Done)
      {
        near.Follow(points[k], moves[k]);
        ++moved;
      }
    }
  }
  return moved;
}
} // namespace bone
