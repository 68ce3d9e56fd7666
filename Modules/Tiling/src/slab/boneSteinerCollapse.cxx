/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSteinerCollapse.h"

#include "bonePredicates.h"
#include "boneTetraComplex.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>

namespace bone
{
namespace tiling
{
namespace
{
constexpr double GoodShape = 0.4;
constexpr double FirstFloor = 0.03; ///< worst shape of bone that the first round may make
constexpr double ShapeWeight = 3.0;
constexpr double ShapeUnit = 1e-8;
constexpr double CostUnit = 1e-6;         // mm
constexpr double ErrorUnit = 1e-4;        // mm; quadrics cancel
constexpr double LeastArea = 1e-5;        // mm^2; faces of less have no direction
constexpr double LeastShape = 1e-6;       ///< of bone, and
constexpr double LeastOuterVolume = 1e-8; ///< mm^3 of what is outside: beyond what coordinates are rounded by
constexpr double SteinerTargetFactor = 1.5;
constexpr double ErrorWeight = 10.0; ///< a surface's error against the way a point goes

/** Values that differ by what coordinates are rounded by are to be the same, so that a turned stack is filled alike. */
double
Rounded(double value, double unit)
{
  return unit * std::floor(value / unit + 0.5);
}

/** Volume over the cube of the root mean square edge, 1 for a regular tetrahedron; negative where inverted. */
double
Shape(const Vector3 & a, const Vector3 & b, const Vector3 & c, const Vector3 & d)
{
  const Vector3 x = b - a, y = c - a, z = d - a;
  const double  square = (x.squaredNorm() + y.squaredNorm() + z.squaredNorm() + (c - b).squaredNorm() +
                         (d - b).squaredNorm() + (d - c).squaredNorm()) /
                        6.0;
  return Rounded(1.4142135623730951 * x.cross(y).dot(z) / (square * std::sqrt(square)), ShapeUnit);
}

/** Sum of squared distances to planes, weighted by area. */
struct Quadric
{
  Eigen::Matrix3d a{ Eigen::Matrix3d::Zero() };
  Vector3         b{ Vector3::Zero() };
  double          c{ 0.0 };
  double          area{ 0.0 };

  void
  AddPlane(const Vector3 & normal, const Vector3 & point, double weight)
  {
    const double d = -normal.dot(point);
    a += weight * normal * normal.transpose();
    b += weight * d * normal;
    c += weight * d * d;
    area += weight;
  }

  Quadric &
  operator+=(const Quadric & other)
  {
    a += other.a;
    b += other.b;
    c += other.c;
    area += other.area;
    return *this;
  }

  /** Root mean square distance of x to the planes. */
  double
  Distance(const Vector3 & x) const
  {
    return area > 0 ? std::sqrt(std::max(0.0, (x.dot(a * x) + 2.0 * b.dot(x) + c) / area)) : 0.0;
  }
};

class SteinerCollapser
{
public:
  SteinerCollapser(const MeshArrays & mesh, IdType first, const SteinerPlaces & places, const Execution & execution)
    : m_Complex(mesh)
    , m_First(first)
    , m_Places(places)
    , m_Execution(execution)
    , m_Quadrics(mesh.points.size() - first)
    , m_Dirty(mesh.points.size(), 1)
    , m_Gone(mesh.points.size(), 0)
    , m_Target(mesh.points.size(), -1)
    , m_Cost(mesh.points.size(), 0.0)
  {
    m_Origin = places.ideal.empty() ? Vector3(Vector3::Zero()) : places.ideal.front();
    for (const auto & face : places.faces)
    {
      const Vector3 &p = Ideal(face[0]), &q = Ideal(face[1]), &r = Ideal(face[2]);
      const Vector3  normal = (q - p).cross(r - p);
      const double   twice = normal.norm();
      if (twice > LeastArea)
      {
        for (IdType v : face)
        {
          m_Quadrics[v - m_First].AddPlane(normal / twice, p - m_Origin, 0.5 * twice);
        }
      }
    }
  }

  /** Collapses until nothing more is allowed that makes no worse shape than `floor`, or than there was. */
  void
  Run(double floor)
  {
    m_Floor = floor;
    const IdType points = static_cast<IdType>(m_Complex.Points().size());
    std::fill(m_Dirty.begin(), m_Dirty.end(), 1);
    for (bool any = true; any;)
    {
      any = false;
      for (IdType v = m_First; v < points; ++v)
      {
        if (!m_Gone[v] && m_Dirty[v] && Update(v))
        {
          m_Queue.push({ m_Cost[v], v });
        }
      }
      while (!m_Queue.empty())
      {
        const IdType v = m_Queue.top().second;
        m_Queue.pop();
        m_Execution.ThrowIfAborted();
        if (m_Gone[v])
        {
          continue;
        }
        if (m_Dirty[v] && !StillAllowed(v))
        {
          if (Update(v))
          {
            m_Queue.push({ m_Cost[v], v });
          }
          continue;
        }
        Commit(v, m_Target[v]);
        any = true;
      }
    }
  }

  /** Moves the points that are left towards their ideal places. */
  void
  MoveToIdeal()
  {
    const IdType points = static_cast<IdType>(m_Complex.Points().size());
    for (int round = 0; round < MoveRounds; ++round)
    {
      for (IdType v = m_First; v < points; ++v)
      {
        m_Execution.ThrowIfAborted();
        const Vector3 from = m_Complex.Points()[v];
        if (m_Gone[v] || m_Complex.Dimension(v) == 3 || from == Ideal(v))
        {
          continue;
        }
        const double worst = std::min(FirstFloor, WorstShape(v));
        double       share = 1.0;
        for (int attempt = 0; attempt < MoveAttempts; ++attempt, share *= 0.5)
        {
          const Vector3 x = from + share * (Ideal(v) - from);
          m_Complex.TryPoint(v, x);
          if (IsPositive(v) && WorstShape(v) >= worst)
          {
            m_Complex.MovePoint(v, x);
            break;
          }
          m_Complex.TryPoint(v, from);
        }
        m_Dirty[v] = 1;
      }
    }
  }

  MeshArrays
  Result() const
  {
    MeshArrays mesh;
    mesh.points = m_Complex.Points();
    for (IdType t = 0; t < m_Complex.Size(); ++t)
    {
      if (m_Complex.IsAlive(t))
      {
        mesh.tetrahedra.push_back(m_Complex.Cell(t));
        mesh.region.push_back(m_Complex.Region(t));
      }
    }
    return mesh;
  }

private:
  using Entry = std::pair<double, IdType>;

  static constexpr int MoveRounds = 3;
  static constexpr int MoveAttempts = 4;

  const Vector3 &
  Ideal(IdType v) const
  {
    return v < m_First ? m_Complex.Points()[v] : m_Places.ideal[v - m_First];
  }

  /** How far the surfaces at v would be off if v were at w. */
  double
  SurfaceError(IdType v, IdType w) const
  {
    return Rounded(m_Quadrics[v - m_First].Distance(Ideal(w) - m_Origin), ErrorUnit);
  }

  /** Looks for the best target of v. */
  bool
  Update(IdType v)
  {
    m_Execution.ThrowIfAborted();
    m_Dirty[v] = 0;
    const bool onSurface = m_Complex.Dimension(v) < 3;
    m_Rated.clear();
    for (IdType w : Targets(v))
    {
      const double error = onSurface ? SurfaceError(v, w) : 0.0;
      if (error <= m_Places.tolerance)
      {
        m_Rated.emplace_back(Rounded(ErrorWeight * error + (Place(v, onSurface) - Ideal(w)).norm() *
                                                             (w < m_First ? 1.0 : SteinerTargetFactor),
                                     CostUnit),
                             w);
      }
    }
    std::sort(m_Rated.begin(), m_Rated.end());
    const double floor = Floor(v);
    m_Target[v] = -1;
    m_Cost[v] = std::numeric_limits<double>::infinity();
    for (const auto & [least, w] : m_Rated)
    {
      if (least >= m_Cost[v])
      {
        break;
      }
      const double shape = ShapeAfter(v, w, floor);
      if (!(shape >= floor))
      {
        continue;
      }
      const double lack = std::max(0.0, 1.0 - shape / GoodShape);
      const double cost = Rounded(least * (1.0 + ShapeWeight * lack * lack), CostUnit);
      if (cost < m_Cost[v] && m_Complex.CanCollapse(v, w) == MeshOperation::Done && StaysPositive(v, w))
      {
        m_Cost[v] = cost;
        m_Target[v] = w;
      }
    }
    return m_Target[v] >= 0;
  }

  /** Whether v may still go where it was to go before something around it changed. */
  bool
  StillAllowed(IdType v) const
  {
    const IdType w = m_Target[v];
    const double floor = Floor(v);
    return w >= 0 && !m_Gone[w] && (m_Complex.Dimension(v) == 3 || SurfaceError(v, w) <= m_Places.tolerance) &&
           AreJoined(v, w) && ShapeAfter(v, w, floor) >= floor && m_Complex.CanCollapse(v, w) == MeshOperation::Done &&
           StaysPositive(v, w);
  }

  /** Where v counts as being: points inside regions have no place of their own. */
  const Vector3 &
  Place(IdType v, bool onSurface) const
  {
    return onSurface ? Ideal(v) : m_Complex.Points()[v];
  }

  bool
  IsPositive(IdType v) const
  {
    const auto & p = m_Complex.Points();
    const auto & star = m_Complex.Star(v);
    return std::all_of(star.begin(), star.end(), [&](IdType t) {
      const Id4 & c = m_Complex.Cell(t);
      return Orient3D(p[c[0]], p[c[1]], p[c[2]], p[c[3]]) > 0;
    });
  }

  bool
  AreJoined(IdType v, IdType w) const
  {
    const auto & star = m_Complex.Star(v);
    return std::any_of(star.begin(), star.end(), [&](IdType t) { return m_Complex.Has(t, w); });
  }

  std::vector<IdType>
  Targets(IdType v)
  {
    switch (m_Complex.Dimension(v))
    {
      case 0:
        return {};
      case 1:
        return m_Complex.Surfaces().curve[v];
      case 2:
      {
        std::vector<IdType> targets;
        m_Complex.SurfaceStar(v, m_Faces);
        for (const auto & face : m_Faces)
        {
          targets.push_back(face.a);
        }
        return targets;
      }
      default:
        return m_Complex.PointNeighbors(v);
    }
  }

  /** What the cells around v must have when it is gone: no less than they had, up to what is asked for, and no sign
   * that depends on rounding. */
  double
  Floor(IdType v) const
  {
    return std::max(LeastShape, std::min(m_Floor, WorstShape(v)));
  }

  /** The worst shape of the bone around v. */
  double
  WorstShape(IdType v) const
  {
    const auto & p = m_Complex.Points();
    double       worst = 1.0;
    for (IdType t : m_Complex.Star(v))
    {
      const Id4 & c = m_Complex.Cell(t);
      if (m_Complex.Region(t) > 0)
      {
        worst = std::min(worst, Shape(p[c[0]], p[c[1]], p[c[2]], p[c[3]]));
      }
    }
    return worst;
  }

  /** The worst shape of the bone around v when it lies at w; below `floor` as soon as something is below it. */
  double
  ShapeAfter(IdType v, IdType w, double floor) const
  {
    const auto & p = m_Complex.Points();
    double       worst = 1.0;
    for (IdType t : m_Complex.Star(v))
    {
      if (m_Complex.Has(t, w))
      {
        continue;
      }
      Id4 c = m_Complex.Cell(t);
      c[m_Complex.LocalIndex(t, v)] = w;
      if (m_Complex.Region(t) > 0)
      {
        worst = std::min(worst, Shape(p[c[0]], p[c[1]], p[c[2]], p[c[3]]));
        if (!(worst >= floor))
        {
          return worst;
        }
      }
      else if (!(SignedVolume(p[c[0]], p[c[1]], p[c[2]], p[c[3]]) > LeastOuterVolume))
      {
        return -1.0;
      }
    }
    return worst;
  }

  bool
  StaysPositive(IdType v, IdType w) const
  {
    const auto & p = m_Complex.Points();
    for (IdType t : m_Complex.Star(v))
    {
      Id4 c = m_Complex.Cell(t);
      if (!m_Complex.Has(t, w))
      {
        c[m_Complex.LocalIndex(t, v)] = w;
        if (Orient3D(p[c[0]], p[c[1]], p[c[2]], p[c[3]]) <= 0)
        {
          return false;
        }
      }
    }
    return true;
  }

  void
  Commit(IdType v, IdType w)
  {
    m_Complex.Collapse(v, w);
    m_Gone[v] = 1;
    m_Execution.Report(static_cast<double>(++m_Collapsed) / static_cast<double>(m_Quadrics.size()));
    if (w >= m_First)
    {
      m_Quadrics[w - m_First] += m_Quadrics[v - m_First];
    }
    m_Dirty[w] = 1;
    for (IdType p : m_Complex.PointNeighbors(w))
    {
      m_Dirty[p] = 1;
    }
  }

  TetraComplex                                                        m_Complex;
  IdType                                                              m_First;
  const SteinerPlaces &                                               m_Places;
  const Execution &                                                   m_Execution;
  std::vector<Quadric>                                                m_Quadrics; ///< of the Steiner points
  Vector3                                                             m_Origin{ Vector3::Zero() };
  double                                                              m_Floor{ 0.0 };
  std::size_t                                                         m_Collapsed{ 0 };
  std::vector<char>                                                   m_Dirty, m_Gone;
  std::vector<IdType>                                                 m_Target;
  std::vector<double>                                                 m_Cost;
  std::vector<Entry>                                                  m_Rated;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<Entry>> m_Queue;
  std::vector<TetraComplex::SurfaceFace>                              m_Faces;
};
} // namespace

MeshArrays
CollapseSteinerPoints(const MeshArrays &    mesh,
                      IdType                firstSteiner,
                      const SteinerPlaces & places,
                      const Execution &     execution)
{
  MeshArrays whole = mesh;
  whole.neighbors = ComputeFaceNeighbors(whole.tetrahedra);
  SteinerCollapser collapser(whole, firstSteiner, places, execution);
  collapser.Run(FirstFloor);
  collapser.MoveToIdeal();
  collapser.Run(FirstFloor);
  collapser.Run(0.0);
  collapser.MoveToIdeal();
  return collapser.Result();
}
} // namespace tiling
} // namespace bone
