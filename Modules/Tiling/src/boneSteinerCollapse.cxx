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
constexpr double SteinerTargetFactor = 1.5;

/** Volume over the cube of the root mean square edge, 1 for a regular tetrahedron; negative where inverted. */
double
Shape(const Vector3 & a, const Vector3 & b, const Vector3 & c, const Vector3 & d)
{
  const Vector3 x = b - a, y = c - a, z = d - a;
  const double  square = (x.squaredNorm() + y.squaredNorm() + z.squaredNorm() + (c - b).squaredNorm() +
                         (d - b).squaredNorm() + (d - c).squaredNorm()) /
                        6.0;
  return 1.4142135623730951 * x.cross(y).dot(z) / (square * std::sqrt(square));
}

class SteinerCollapser
{
public:
  SteinerCollapser(const MeshArrays & mesh, IdType first)
    : m_Complex(mesh)
    , m_First(first)
    , m_Dirty(mesh.points.size(), 1)
    , m_Gone(mesh.points.size(), 0)
    , m_Target(mesh.points.size(), -1)
    , m_Cost(mesh.points.size(), 0.0)
  {}

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

  /** Looks for the best target of v. */
  bool
  Update(IdType v)
  {
    m_Dirty[v] = 0;
    const auto & p = m_Complex.Points();
    m_Rated.clear();
    for (IdType w : Targets(v))
    {
      m_Rated.emplace_back((p[v] - p[w]).norm() * (w < m_First ? 1.0 : SteinerTargetFactor), w);
    }
    std::sort(m_Rated.begin(), m_Rated.end());
    const double floor = std::min(m_Floor, WorstShape(v));
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
      const double cost = least * (1.0 + ShapeWeight * lack * lack);
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
    const double floor = std::min(m_Floor, WorstShape(v));
    return w >= 0 && !m_Gone[w] && AreJoined(v, w) && ShapeAfter(v, w, floor) >= floor &&
           m_Complex.CanCollapse(v, w) == MeshOperation::Done && StaysPositive(v, w);
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
      else if (!(SignedVolume(p[c[0]], p[c[1]], p[c[2]], p[c[3]]) > 0))
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
    m_Dirty[w] = 1;
    for (IdType p : m_Complex.PointNeighbors(w))
    {
      m_Dirty[p] = 1;
    }
  }

  TetraComplex                                                        m_Complex;
  IdType                                                              m_First;
  double                                                              m_Floor{ 0.0 };
  std::vector<char>                                                   m_Dirty, m_Gone;
  std::vector<IdType>                                                 m_Target;
  std::vector<double>                                                 m_Cost;
  std::vector<Entry>                                                  m_Rated;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<Entry>> m_Queue;
  std::vector<TetraComplex::SurfaceFace>                              m_Faces;
};
} // namespace

MeshArrays
CollapseSteinerPoints(const MeshArrays & mesh, IdType firstSteiner)
{
  MeshArrays whole = mesh;
  whole.neighbors = ComputeFaceNeighbors(whole.tetrahedra);
  SteinerCollapser collapser(whole, firstSteiner);
  collapser.Run(FirstFloor);
  collapser.Run(0.0);
  return collapser.Result();
}
} // namespace tiling
} // namespace bone
