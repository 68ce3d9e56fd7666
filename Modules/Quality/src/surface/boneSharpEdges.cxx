/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSharpEdges.h"

#include <algorithm>

namespace bone
{
namespace
{
class SharpEdgeCollapser
{
public:
  SharpEdgeCollapser(TetraComplex &              complex,
                     const PointMover &          mover,
                     MeshRepair &                repair,
                     SurfaceEnergy &             energy,
                     const SharpEdgeParameters & parameters)
    : m_Complex(complex)
    , m_Mover(mover)
    , m_Repair(repair)
    , m_Energy(energy)
    , m_Parameters(parameters)
  {}

  std::size_t
  Run()
  {
    std::vector<std::pair<double, SurfaceEnergy::Edge>> sharp;
    for (const auto & edge : m_Energy.Edges())
    {
      const double deviation = m_Energy.Deviation(edge.first, edge.second);
      if (deviation > m_Parameters.angle)
      {
        sharp.emplace_back(-deviation, edge);
      }
    }
    std::sort(sharp.begin(), sharp.end());
    std::size_t count = 0;
    for (const auto & entry : sharp)
    {
      const auto & [a, b] = entry.second;
      count += CollapseEnd(a, b) || CollapseEnd(b, a) ? 1 : 0;
    }
    return count;
  }

private:
  /** Collapses end v of an edge onto its best neighbour, if the edge is still there and sharp. */
  bool
  CollapseEnd(IdType v, IdType other)
  {
    if (m_Complex.Star(v).empty() || m_Complex.Star(other).empty() || m_Complex.Dimension(v) != 2 ||
        !(m_Energy.Deviation(v, other) > m_Parameters.angle))
    {
      return false;
    }
    m_Complex.SurfaceStar(v, m_Faces);
    // Whether cells allow a collapse is quicker to see than what it changes.
    const double        floor = std::max(m_Parameters.cosineFloor, m_Mover.WorstCosine(v));
    std::vector<IdType> allowed = this->Neighbors();
    const auto          refused = [&](IdType w) { return !(m_Repair.WorstAfterCollapse(v, w, floor) < floor); };
    allowed.erase(std::remove_if(allowed.begin(), allowed.end(), refused), allowed.end());
    if (allowed.empty())
    {
      return false;
    }
    const SurfaceEnergy::Patch             patch = m_Energy.At(Around(v));
    std::vector<std::pair<double, IdType>> candidates;
    for (IdType w : allowed)
    {
      const double change = m_Energy.Change(patch, Afterwards(w));
      if (change < 0)
      {
        candidates.emplace_back(change, w);
      }
    }
    std::sort(candidates.begin(), candidates.end());
    std::vector<IdType> changed;
    for (const auto & candidate : candidates)
    {
      if (m_Repair.TryCollapse(v, candidate.second, floor, changed))
      {
        m_Energy.Replace(patch, Afterwards(candidate.second));
        return true;
      }
    }
    return false;
  }

  /** Of the point whose faces are looked at: points joined to it on its surface, ascending. */
  std::vector<IdType>
  Neighbors() const
  {
    std::set<IdType> neighbors;
    for (const auto & face : m_Faces)
    {
      neighbors.insert({ face.a, face.b });
    }
    return { neighbors.begin(), neighbors.end() };
  }

  std::vector<TriangleIds>
  Around(IdType v) const
  {
    std::vector<TriangleIds> triangles;
    for (const auto & face : m_Faces)
    {
      triangles.push_back({ v, face.a, face.b });
    }
    return triangles;
  }

  /** What the triangles become by a collapse onto w. */
  std::vector<TriangleIds>
  Afterwards(IdType w) const
  {
    std::vector<TriangleIds> triangles;
    for (const auto & face : m_Faces)
    {
      if (face.a != w && face.b != w)
      {
        triangles.push_back({ w, face.a, face.b });
      }
    }
    return triangles;
  }

  TetraComplex &                         m_Complex;
  const PointMover &                     m_Mover;
  MeshRepair &                           m_Repair;
  SurfaceEnergy &                        m_Energy;
  const SharpEdgeParameters &            m_Parameters;
  std::vector<TetraComplex::SurfaceFace> m_Faces;
};
} // namespace

std::size_t
CollapseSharpEdges(TetraComplex &              complex,
                   const PointMover &          mover,
                   MeshRepair &                repair,
                   SurfaceEnergy &             energy,
                   const SharpEdgeParameters & parameters)
{
  return SharpEdgeCollapser(complex, mover, repair, energy, parameters).Run();
}
} // namespace bone
