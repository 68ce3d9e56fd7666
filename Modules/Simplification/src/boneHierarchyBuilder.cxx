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
constexpr double LevelFlipAngle = 0.44;
/** Under a bound on the density error, this share of the cells goes before the error is measured again; when the bound
 * is passed, the step is taken back and halved until it is this small. */
constexpr double Stride = 0.3;
constexpr double SmallestStride = 0.005;
/** Cells are flipped once more when there are so many more than asked for: flips that make fewer cells come first. */
constexpr double FlipAhead = 1.02;
/** Share of the wanted angles that collapses keep to while they can. */
constexpr double SoftShare = 0.6;
/** Cells are collapsed again after angles were improved this often at the most. */
constexpr int MostRounds = 3;
/** How much a level's surfaceError may be too low, mm. */
constexpr double SurfaceTolerance = 0.01;

std::string
ReasonOf(const MeshCollapser & collapser)
{
  switch (collapser.StoppedBy())
  {
    case MeshOperation::Distance:
      return "surface distance bound";
    case MeshOperation::Volume:
      return "volume bound";
    case MeshOperation::Density:
      return "cell error bound";
    default:
      return "nothing more allowed";
  }
}
} // namespace

HierarchyBuilder::HierarchyBuilder(MeshArrays                      mesh,
                                   const TetraCollapseParameters & parameters,
                                   const Execution &               execution)
  : m_Before(std::move(mesh))
  , m_BeforePoint(m_Before.points.size())
  , m_BeforeCell(m_Before.tetrahedra.size())
  , m_ImproveAngles(parameters.improveAngles)
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
  m_Finest = m_Before;
  m_Degree = m_Before.maximumDegree;
  m_Collapser = std::make_unique<MeshCollapser>(m_Before, parameters, execution);
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
HierarchyBuilder::Compact(const LevelRequest & request, const Execution & execution) const
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
  const LevelDensity density(m_Before, parent, draft.cellSlot, m_Collapser->Densities(), m_SampleCell, execution);
  density.Fit(draft.mesh, m_Degree);
  if (m_Collapser->Fits() != nullptr)
  {
    draft.cellError = density.FitWithin(draft.mesh, *m_Collapser->Fits(), request.maximumCellError);
  }
  double bound = request.maximumDensityError;
  for (int attempt = 0; attempt < (bound < 0 ? 1 : 3); ++attempt)
  {
    // Samples come first, being quick; where they say too little, the bound on them is lowered as much.
    if (bound >= 0 && density.Elevate(draft.mesh, bound, request.maximumDegree) > bound)
    {
      draft.densityError = std::numeric_limits<double>::infinity();
      break;
    }
    draft.densityError = density.IntegratedError(m_Finest, draft.mesh);
    if (draft.densityError <= request.maximumDensityError || request.maximumDegree <= m_Degree)
    {
      break;
    }
    bound *= request.maximumDensityError / draft.densityError;
  }
  return draft;
}

void
HierarchyBuilder::CollapseBy(const std::vector<AngleFloors> & floors,
                             IdType                           target,
                             BuiltLevel &                     level,
                             const Execution &                execution)
{
  for (std::size_t i = 0; i < floors.size() && m_Collapser->Complex().AliveCells() > target; ++i)
  {
    m_Collapser->SetFloors(floors[i]);
    level.collapses += m_Collapser->Run(target, i == 0 ? execution : execution.Silent());
  }
}

bool
HierarchyBuilder::CollapseTo(IdType target, BuiltLevel & level, const Execution & execution)
{
  const AngleFloors        wanted = m_Collapser->WantedAngles(), least = m_Collapser->LeastAngles();
  const AngleFloors        soft{ std::max(least.cortical, SoftShare * wanted.cortical),
                          std::max(least.other, SoftShare * wanted.other) };
  std::vector<AngleFloors> floors = { least };
  if (m_ImproveAngles)
  {
    floors.insert(floors.begin(), soft);
  }
  CollapseBy(floors, static_cast<IdType>(FlipAhead * target), level, execution.Part(0.0, 0.9));
  m_Collapser->Flip(LevelFlipAngle, FlipCellCount::NotMore, target, execution);
  CollapseBy(floors, target, level, execution.Part(0.9, 1.0));
  m_Collapser->Flip(LevelFlipAngle, FlipCellCount::Same, target, execution);
  if (m_ImproveAngles)
  {
    m_Collapser->ImproveAngles(target, execution.Silent());
    for (int i = 0; i < MostRounds && m_Collapser->Complex().AliveCells() > target; ++i)
    {
      // Where the bound on volumes ended collapses, regions have their volumes again.
      const std::size_t before = level.collapses;
      CollapseBy(floors, target, level, execution.Silent());
      if (level.collapses == before)
      {
        break;
      }
      m_Collapser->ImproveAngles(target, execution.Silent());
    }
  }
  return m_Collapser->Complex().AliveCells() <= target;
}

std::string
HierarchyBuilder::CollapseWithin(const LevelRequest & request, BuiltLevel & level, const Execution & execution)
{
  // Nobody knows how many steps there will be: each takes this share of the progress that is left.
  constexpr double share = 0.15;
  double           stride = Stride, left = 1.0;
  while (m_Collapser->Complex().AliveCells() > request.tetrahedra)
  {
    const MeshCollapser last = *m_Collapser;
    const std::size_t   collapses = level.collapses;
    const auto          next = static_cast<IdType>((1.0 - stride) * last.Complex().AliveCells());
    const Execution     step = execution.Part(1.0 - left, 1.0 - (1.0 - share) * left);
    left *= 1.0 - share;
    const bool reached = CollapseTo(std::max(next, request.tetrahedra), level, step.Part(0.0, 0.5));
    if (Compact(request, step.Part(0.5, 1.0)).densityError > request.maximumDensityError)
    {
      level.refused[static_cast<int>(MeshOperation::Density)] += level.collapses - collapses;
      *m_Collapser = last;
      level.collapses = collapses;
      stride /= 2.0;
      if (stride < SmallestStride)
      {
        return "density error bound";
      }
    }
    else if (!reached)
    {
      return ReasonOf(*m_Collapser);
    }
  }
  return "tetrahedra reached";
}

BuiltLevel
HierarchyBuilder::Next(const LevelRequest & request, const Execution & execution)
{
  BuiltLevel      level;
  const Execution collapse = execution.Part(0.0, 0.8);
  const auto      refusedBefore = m_Collapser->Refused();
  m_Collapser->ClearChanged();
  m_Collapser->SetMaximumDistance(request.maximumSurfaceDistance);
  m_Collapser->SetMaximumCellError(request.maximumCellError);
  if (m_Before.HasDensity() && request.maximumDensityError >= 0)
  {
    level.stopReason = CollapseWithin(request, level, collapse);
  }
  else
  {
    level.stopReason = CollapseTo(request.tetrahedra, level, collapse) ? "tetrahedra reached" : ReasonOf(*m_Collapser);
  }
  Draft draft = Compact(request, execution.Part(0.8, 0.95));
  level.mesh = std::move(draft.mesh);
  level.densityErrorBound = request.maximumDensityError;
  level.densityError = draft.densityError;
  level.cellError = draft.cellError;
  level.surfaceError = LargestSurfaceDistance(m_Finest, level.mesh, SurfaceTolerance, execution.Part(0.95, 1.0));
  for (int i = 0; i < MeshOperationCount; ++i)
  {
    level.refused[i] += m_Collapser->Refused()[i] - refusedBefore[i];
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
  execution.Report(1.0);
  return level;
}

std::vector<BuiltLevel>
BuildLevels(MeshArrays mesh, const TetraCollapseParameters & parameters, const Execution & execution)
{
  const std::size_t       count = std::max({ parameters.levels.size(),
                                             parameters.maximumDensityErrors.size(),
                                             parameters.maximumCellErrors.size(),
                                             parameters.maximumSurfaceDistances.size() });
  HierarchyBuilder        builder(std::move(mesh), parameters, execution.Part(0.0, 0.02));
  const Execution         rest = execution.Part(0.02, 1.0);
  std::vector<BuiltLevel> built;
  for (std::size_t i = 0; i < count; ++i)
  {
    LevelRequest request;
    request.maximumDegree = parameters.maximumDegree;
    if (i < parameters.levels.size())
    {
      request.tetrahedra = parameters.levels[i];
    }
    if (i < parameters.maximumDensityErrors.size())
    {
      request.maximumDensityError = parameters.maximumDensityErrors[i];
    }
    if (i < parameters.maximumCellErrors.size())
    {
      request.maximumCellError = parameters.maximumCellErrors[i];
    }
    if (i < parameters.maximumSurfaceDistances.size())
    {
      request.maximumSurfaceDistance = parameters.maximumSurfaceDistances[i];
    }
    built.push_back(builder.Next(request, rest.Part(static_cast<double>(i) / count, (i + 1.0) / count)));
  }
  return built;
}
} // namespace bone
