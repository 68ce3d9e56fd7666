/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSteinerCollapse.h"

#include "bonePredicates.h"
#include "boneQualityMeasures.h"
#include "boneTetraComplex.h"

#include <algorithm>
#include <cmath>
#include <queue>

namespace bone
{
namespace tiling
{
namespace
{
constexpr double GoodAngle = 25.0 / 57.29577951308232;
constexpr double FirstFloor = 4.0 / 57.29577951308232; ///< smallest angle of bone that the first round may make
constexpr double ShapeWeight = 3.0;
constexpr double SteinerTargetFactor = 1.5;

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

  /** Collapses until nothing more is allowed with no smaller angle than `floor` (rad). */
  void
  Run(double floor)
  {
    m_Limit = std::cos(floor);
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
        if (m_Dirty[v])
        {
          if (!Update(v))
          {
            continue;
          }
          if (!m_Queue.empty() && m_Cost[v] > m_Queue.top().first)
          {
            m_Queue.push({ m_Cost[v], v });
            continue;
          }
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
    m_Rated.clear();
    for (IdType w : Targets(v))
    {
      double cost = 0.0;
      if (Rate(v, w, cost))
      {
        m_Rated.emplace_back(cost, w);
      }
    }
    std::sort(m_Rated.begin(), m_Rated.end());
    for (const Entry & candidate : m_Rated)
    {
      if (m_Complex.CanCollapse(v, candidate.second) == MeshOperation::Done && StaysPositive(v, candidate.second))
      {
        m_Cost[v] = candidate.first;
        m_Target[v] = candidate.second;
        return true;
      }
    }
    return false;
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

  bool
  Rate(IdType v, IdType w, double & cost) const
  {
    const auto & p = m_Complex.Points();
    double       worst = -1.0, before = -1.0;
    for (IdType t : m_Complex.Star(v))
    {
      Id4        c = m_Complex.Cell(t);
      const bool bone = m_Complex.Region(t) > 0;
      if (bone)
      {
        before = std::max(before, LargestDihedralCosine(p[c[0]], p[c[1]], p[c[2]], p[c[3]]));
      }
      if (m_Complex.Has(t, w))
      {
        continue;
      }
      c[m_Complex.LocalIndex(t, v)] = w;
      if (!(SignedVolume(p[c[0]], p[c[1]], p[c[2]], p[c[3]]) > 0))
      {
        return false;
      }
      if (bone)
      {
        worst = std::max(worst, LargestDihedralCosine(p[c[0]], p[c[1]], p[c[2]], p[c[3]]));
      }
    }
    if (worst > std::max(m_Limit, before))
    {
      return false;
    }
    const double shape = std::max(0.0, 1.0 - std::acos(worst) / GoodAngle);
    cost = (p[v] - p[w]).norm() * (1.0 + ShapeWeight * shape * shape) * (w < m_First ? 1.0 : SteinerTargetFactor);
    return true;
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
  double                                                              m_Limit{ 1.0 };
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
