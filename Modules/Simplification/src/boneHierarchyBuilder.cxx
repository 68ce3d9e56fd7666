/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneHierarchyBuilder.h"

#include <algorithm>
#include <numeric>

namespace bone
{
namespace
{
/** Flips after a level is reached look at cells with a dihedral angle below this, rad (25 degrees). */
constexpr double FlipAngle = 0.44;
/** Under a bound on the density error, this share of the cells goes before the error is measured again. */
constexpr double Stride = 0.06;
} // namespace

HierarchyBuilder::HierarchyBuilder(MeshArrays mesh, const CollapseParameters & parameters, ParallelFor parallelFor)
  : m_Before(std::move(mesh))
  , m_BeforePoint(m_Before.points.size())
  , m_BeforeCell(m_Before.tetrahedra.size())
  , m_ParallelFor(std::move(parallelFor))
{
  if (m_Before.neighbors.empty())
  {
    m_Before.neighbors = ComputeFaceNeighbors(m_Before.tetrahedra);
  }
  m_Source.layer = m_Before.layer;
  m_Source.slice = m_Before.slice;
  m_Source.region = m_Before.region;
  std::iota(m_BeforePoint.begin(), m_BeforePoint.end(), 0);
  std::iota(m_BeforeCell.begin(), m_BeforeCell.end(), 0);
  m_Collapser = std::make_unique<MeshCollapser>(m_Before, parameters);
  m_SampleCell.resize(m_Collapser->Densities().All().size());
  for (std::size_t t = 0; t < m_Before.tetrahedra.size(); ++t)
  {
    for (int s : m_Collapser->Densities().InCell(static_cast<IdType>(t)))
    {
      m_SampleCell[s] = static_cast<IdType>(t);
    }
  }
}

HierarchyBuilder::Draft
HierarchyBuilder::Compact() const
{
  Draft draft;
  draft.mesh = m_Collapser->Complex().Compact(m_Source, draft.pointId, draft.cellSlot);
  if (!m_Before.HasDensity())
  {
    return draft;
  }
  const auto &        changed = m_Collapser->Changed();
  std::vector<IdType> parent;
  for (IdType slot : draft.cellSlot)
  {
    const bool kept = slot < static_cast<IdType>(m_BeforeCell.size()) && !changed[slot];
    parent.push_back(kept ? m_BeforeCell[slot] : -1);
  }
  RefitDensity(m_Before, draft.mesh, parent, draft.cellSlot, m_Collapser->Densities(), m_SampleCell, m_ParallelFor);
  draft.densityError = DensityError(draft.mesh, draft.cellSlot, m_Collapser->Densities(), m_ParallelFor);
  return draft;
}

bool
HierarchyBuilder::CollapseTo(IdType target, BuiltLevel & level, const std::function<void()> & progress)
{
  level.collapses += m_Collapser->Run(target, progress);
  m_Collapser->Flip(FlipAngle);
  return m_Collapser->Complex().AliveCells() <= target;
}

std::string
HierarchyBuilder::CollapseWithin(const LevelRequest &          request,
                                 BuiltLevel &                  level,
                                 const std::function<void()> & progress)
{
  while (m_Collapser->Complex().AliveCells() > request.tetrahedra)
  {
    const MeshCollapser last = *m_Collapser;
    const std::size_t   collapses = level.collapses;
    const auto          next = static_cast<IdType>((1.0 - Stride) * last.Complex().AliveCells());
    const bool          reached = CollapseTo(std::max(next, request.tetrahedra), level, progress);
    if (Compact().densityError > request.maximumDensityError)
    {
      *m_Collapser = last;
      level.collapses = collapses;
      return "density error bound";
    }
    if (!reached)
    {
      return "nothing more allowed";
    }
  }
  return "tetrahedra reached";
}

BuiltLevel
HierarchyBuilder::Next(const LevelRequest & request, const std::function<void(double)> & progress)
{
  BuiltLevel   level;
  const auto   refusedBefore = m_Collapser->Refused();
  const double start = m_Collapser->Complex().AliveCells();
  const double span = std::max(1.0, start - request.tetrahedra);
  const auto   report = [&]() { progress(std::min(1.0, (start - m_Collapser->Complex().AliveCells()) / span)); };
  m_Collapser->ClearChanged();
  if (m_Before.HasDensity() && request.maximumDensityError >= 0)
  {
    level.stopReason = CollapseWithin(request, level, report);
  }
  else
  {
    level.stopReason = CollapseTo(request.tetrahedra, level, report) ? "tetrahedra reached" : "nothing more allowed";
  }
  if (level.stopReason == "nothing more allowed" && m_Collapser->IsBoundedBySurfaces())
  {
    level.stopReason = "surface bounds";
  }
  Draft draft = Compact();
  level.mesh = std::move(draft.mesh);
  level.densityError = draft.densityError;
  level.surfaceError = m_Collapser->SurfaceDistance();
  for (int i = 0; i < MeshOperationCount; ++i)
  {
    level.refused[i] = m_Collapser->Refused()[i] - refusedBefore[i];
  }
  for (IdType id : draft.pointId)
  {
    const auto at = std::lower_bound(m_BeforePoint.begin(), m_BeforePoint.end(), id);
    level.parentPoint.push_back(static_cast<IdType>(at - m_BeforePoint.begin()));
  }
  m_Before = level.mesh;
  m_BeforePoint = draft.pointId;
  m_BeforeCell.assign(m_Collapser->Complex().Size(), -1);
  for (std::size_t t = 0; t < draft.cellSlot.size(); ++t)
  {
    m_BeforeCell[draft.cellSlot[t]] = static_cast<IdType>(t);
    for (int s : m_Collapser->Densities().InCell(draft.cellSlot[t]))
    {
      m_SampleCell[s] = static_cast<IdType>(t);
    }
  }
  return level;
}
} // namespace bone
