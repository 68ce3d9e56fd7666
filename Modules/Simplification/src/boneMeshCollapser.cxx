/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneMeshCollapser.h"

#include "boneQualityMeasures.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace bone
{
namespace
{
constexpr double FlipAngle = 20.0 / 57.29577951308232;
constexpr double RefreshShare = 0.85;

MeshArrays
WithNeighbors(MeshArrays mesh)
{
  if (mesh.neighbors.empty())
  {
    mesh.neighbors = ComputeFaceNeighbors(mesh.tetrahedra);
  }
  return mesh;
}
} // namespace

MeshCollapser::MeshCollapser(const MeshArrays &              mesh,
                             const TetraCollapseParameters & parameters,
                             const Execution &               execution)
  : m_Complex(WithNeighbors(mesh))
  , m_Improvement(parameters.improveAngles ? std::make_shared<AngleImprovement>(m_Complex) : nullptr)
  , m_Floors{ parameters.minimumCorticalDihedralAngle, parameters.minimumDihedralAngle }
  , m_Densities(mesh, execution)
  , m_SurfaceSamples(m_Complex)
  , m_Parameters(parameters)
  // Faces will grow by some three times.
  , m_FirstEdge(MeanBoundaryEdge(m_Complex))
  , m_Grid(2.0 * m_FirstEdge)
  , m_Volumes(m_Complex)
  , m_VolumeErrors(m_Volumes.Size(), 0.0)
  , m_State(mesh.points.size(), State::Gone)
  , m_Dirty(mesh.points.size(), 1)
  , m_Target(mesh.points.size(), -1)
  , m_Cost(mesh.points.size(), 0.0)
  , m_Epoch(mesh.points.size(), 0)
  , m_RefreshAt(m_Complex.AliveCells())
  , m_Changed(mesh.tetrahedra.size(), 0)
  , m_RefusedTarget(mesh.points.size(), -1)
  , m_RefusedAt(mesh.points.size(), 0)
{
  if (!parameters.maximumCellErrors.empty())
  {
    m_Fits = std::make_shared<CellFits>(WithNeighbors(mesh), mesh.maximumDegree, parameters.maximumDegree);
  }
  execution.ThrowIfAborted();
  if (!parameters.maximumSurfaceDistances.empty())
  {
    m_Envelope.emplace(m_Complex);
  }
  FillGrid();
  for (IdType v = 0; v < static_cast<IdType>(mesh.points.size()); ++v)
  {
    if (!m_Complex.Star(v).empty() && m_Complex.Dimension(v) > 0)
    {
      m_State[v] = State::Queued;
    }
  }
}

/** What v would do as things are. */
void
MeshCollapser::SetBest(IdType v, const Candidate & best)
{
  m_Dirty[v] = 0;
  m_Epoch[v] = m_Collapses;
  m_State[v] = best.w < 0 ? State::Parked : State::Queued;
  if (best.w >= 0)
  {
    m_Target[v] = best.w;
    m_Cost[v] = best.cost;
  }
  std::transform(m_Refused.begin(), m_Refused.end(), best.refused.begin(), m_Refused.begin(), std::plus<std::size_t>());
}

bool
MeshCollapser::IsWithinCellError(const Id4 & cell, IdType near) const
{
  const auto & samples = m_Densities.InCell(near);
  const auto & p = m_Complex.Points();
  const IdType hint = samples.empty() ? -1 : samples.front() / DensitySamples::SamplesPerCell;
  const auto   fit = m_Fits->FitCell({ p[cell[0]], p[cell[1]], p[cell[2]], p[cell[3]] }, m_MaximumCellError, hint);
  return fit.error <= m_MaximumCellError;
}

/** Whether all cells that v -> w leaves are within the bound on their errors: takes far longer than all else, and is
 * looked at last. */
bool
MeshCollapser::KeepsCellErrors(IdType v, IdType w)
{
  if (!(m_MaximumCellError < std::numeric_limits<double>::infinity()))
  {
    return true;
  }
  if (m_RefusedTarget[v] == w && !m_Complex.HasChanged(v, m_RefusedAt[v]))
  {
    return false;
  }
  for (IdType t : m_Complex.Star(v))
  {
    Id4 c = m_Complex.Cell(t);
    c[m_Complex.LocalIndex(t, v)] = w;
    if (!m_Complex.Has(t, w) && !IsWithinCellError(c, t))
    {
      m_RefusedTarget[v] = w;
      m_RefusedAt[v] = m_Complex.Clock();
      return false;
    }
  }
  return true;
}

void
MeshCollapser::Commit(IdType v, IdType w)
{
  double              unused = 0.0;
  std::vector<double> volumes;
  Rate(v, w, 0.0, { 1.0, 1.0 }, volumes, unused);
  for (std::size_t r = 0; r < volumes.size(); ++r)
  {
    m_VolumeErrors[r] += volumes[r];
  }
  const bool onSurface = m_Complex.Dimension(v) < 3;
  if (onSurface)
  {
    UpdateGrid(v, false);
    UpdateGrid(w, false);
    if (m_Envelope)
    {
      m_Envelope->Commit(m_Complex, v, w, m_MaximumDistance);
    }
  }
  const std::vector<IdType> around = m_Complex.Star(v);
  const auto                densities = m_Densities.TakeFrom(around);
  const auto                surfaces = m_SurfaceSamples.TakeFrom(m_Complex, around, onSurface ? v : -1);
  const auto                cells = m_Complex.Collapse(v, w);
  m_Densities.GiveTo(m_Complex, densities, cells);
  m_SurfaceSamples.GiveTo(m_Complex, surfaces, m_Complex.Star(w));
  if (onSurface)
  {
    UpdateGrid(w, true);
  }
  for (IdType t : cells)
  {
    m_Changed[t] = 1;
  }
  m_State[v] = State::Gone;
  m_Dirty[w] = 1;
  for (IdType p : m_Complex.PointNeighbors(w))
  {
    m_Dirty[p] = 1;
  }
}

bool
MeshCollapser::Requeue()
{
  bool any = false;
  for (IdType v = 0; v < static_cast<IdType>(m_State.size()); ++v)
  {
    if (m_State[v] == State::Parked && m_Dirty[v])
    {
      m_State[v] = State::Queued;
      m_Queue.push({ m_Cost[v], v });
      any = true;
    }
  }
  return any;
}

void
MeshCollapser::NoteWhyParked(const Execution & execution)
{
  Counts refused{};
  bool   density = false;
  for (IdType v = 0; v < static_cast<IdType>(m_State.size()); ++v)
  {
    if (m_State[v] == State::Parked)
    {
      execution.ThrowIfAborted();
      const Candidate best = FindBest(v);
      density = best.w >= 0 || density; // what else is allowed
      std::transform(refused.begin(), refused.end(), best.refused.begin(), refused.begin(), std::plus<std::size_t>());
    }
  }
  const auto distance = refused[static_cast<int>(MeshOperation::Distance)];
  const auto volume = refused[static_cast<int>(MeshOperation::Volume)];
  m_StoppedBy = density                  ? MeshOperation::Density
                : distance + volume == 0 ? MeshOperation::Done
                : distance >= volume     ? MeshOperation::Distance
                                         : MeshOperation::Volume;
}

void
MeshCollapser::SetMaximumCellError(double error)
{
  m_Stale = m_Stale || error != m_MaximumCellError;
  if (error != m_MaximumCellError)
  {
    std::fill(m_RefusedTarget.begin(), m_RefusedTarget.end(), -1);
  }
  m_MaximumCellError = error;
}

void
MeshCollapser::SetMaximumDistance(double distance)
{
  m_Stale = m_Stale || distance != m_MaximumDistance;
  m_MaximumDistance = distance;
}

std::size_t
MeshCollapser::Run(IdType target, const Execution & execution)
{
  const double start = m_Complex.AliveCells();
  const double span = std::max(1.0, start - target);
  std::size_t  collapses = 0;
  if (!m_IsRated && m_Complex.AliveCells() > target)
  {
    RateAll(execution);
  }
  while (m_Complex.AliveCells() > target)
  {
    execution.ThrowIfAborted();
    if (m_Queue.empty() && !Requeue())
    {
      // Volumes are bounded for whole regions, so that what was refused may have become allowed from afar.
      if (m_Stale)
      {
        Refresh(target, execution);
        continue;
      }
      NoteWhyParked(execution);
      break;
    }
    const Entry entry = m_Queue.top();
    m_Queue.pop();
    const IdType v = entry.v;
    if (m_Dirty[v] || m_Epoch[v] != m_Collapses || CheckExactly(v, m_Target[v]) != MeshOperation::Done)
    {
      const Candidate best = FindBest(v);
      SetBest(v, best);
      if (best.w < 0)
      {
        continue;
      }
      if (!m_Queue.empty() && best.cost > m_Queue.top().cost)
      {
        m_Queue.push({ best.cost, v });
        continue;
      }
    }
    if (!KeepsCellErrors(v, m_Target[v]))
    {
      ++m_Refused[static_cast<int>(MeshOperation::Density)];
      m_State[v] = State::Parked;
      continue;
    }
    Commit(v, m_Target[v]);
    ++collapses;
    ++m_Collapses;
    m_Stale = true;
    if (m_Complex.AliveCells() < m_RefreshAt)
    {
      Refresh(target, execution);
    }
    execution.Report((start - m_Complex.AliveCells()) / span);
  }
  return collapses;
}

/** Fills the queue anew. */
void
MeshCollapser::RateAll(const Execution & execution)
{
  constexpr std::size_t  chunk = 64;
  std::vector<Candidate> found(m_State.size());
  execution.Silent().For(
    found.size(),
    [&](std::size_t v) {
      if (m_State[v] != State::Gone)
      {
        found[v] = FindBest(static_cast<IdType>(v));
      }
    },
    chunk);
  m_IsRated = true;
  m_Queue = {};
  for (IdType v = 0; v < static_cast<IdType>(m_State.size()); ++v)
  {
    if (m_State[v] != State::Gone)
    {
      m_Cost[v] = 0.0;
      SetBest(v, found[v]);
      if (found[v].w >= 0)
      {
        m_Queue.push({ found[v].cost, v });
      }
    }
  }
}

void
MeshCollapser::Refresh(IdType minimumCells, const Execution & execution)
{
  Flip(FlipAngle, FlipCellCount::NotMore, minimumCells, execution);
  m_RefreshAt = static_cast<IdType>(RefreshShare * m_Complex.AliveCells());
  m_Stale = false;
  RateAll(execution);
}

std::size_t
MeshCollapser::Flip(double angle, FlipCellCount cellCount, IdType minimumCells, const Execution & execution)
{
  FlipParameters parameters;
  parameters.targetAngle = angle;
  parameters.cellCount = cellCount;
  parameters.minimumCells = minimumCells;
  if (m_MaximumCellError < std::numeric_limits<double>::infinity())
  {
    parameters.guard = [this](const std::vector<Id4> & created) {
      return std::all_of(created.begin(), created.end(), [this](const Id4 & cell) {
        return IsWithinCellError(cell, m_Complex.Star(cell[0]).front());
      });
    };
  }
  const auto report = ImproveByFlips(m_Complex, parameters, [this, &execution](const FlipResult & flip) {
    execution.ThrowIfAborted();
    m_Changed.resize(m_Complex.Size(), 0);
    m_Densities.GiveTo(m_Complex, m_Densities.TakeFrom(flip.removed), flip.created);
    m_SurfaceSamples.GiveTo(m_Complex, m_SurfaceSamples.TakeFrom(m_Complex, flip.removed, -1), flip.created);
    for (IdType t : flip.created)
    {
      m_Changed[t] = 1;
      for (IdType p : m_Complex.Cell(t))
      {
        m_Dirty[p] = 1;
      }
    }
  });
  return report.done;
}

void
MeshCollapser::SetFloors(const AngleFloors & floors)
{
  m_Stale = m_Stale || floors != m_Floors;
  m_Floors = floors;
}

AngleFloors
MeshCollapser::LeastAngles() const
{
  return { m_Parameters.minimumCorticalDihedralAngle, m_Parameters.minimumDihedralAngle };
}

AngleFloors
MeshCollapser::WantedAngles() const
{
  return { std::max(m_Parameters.wantedCorticalDihedralAngle, m_Parameters.minimumCorticalDihedralAngle),
           std::max(m_Parameters.wantedDihedralAngle, m_Parameters.minimumDihedralAngle) };
}

void
MeshCollapser::ImproveAngles(IdType target, const Execution & execution)
{
  std::vector<Id4> cells;
  for (IdType t = 0; t < m_Complex.Size(); ++t)
  {
    cells.push_back(m_Complex.Cell(t));
  }
  const std::vector<Vector3> points = m_Complex.Points();
  AngleGoal                  goal;
  goal.floors = WantedAngles();
  goal.least = LeastAngles();
  goal.volumeChange = m_Parameters.maximumVolumeChange;
  goal.minimumCells = target;
  goal.maximumCells = std::max(target, m_Complex.AliveCells());
  if (!m_Improvement->Run(m_Complex, goal, execution))
  {
    return;
  }
  m_Changed.resize(m_Complex.Size(), 0);
  for (IdType t = 0; t < m_Complex.Size(); ++t)
  {
    const Id4 & c = m_Complex.Cell(t);
    const bool  same =
      t < static_cast<IdType>(cells.size()) && c == cells[t] &&
      (c[0] < 0 || std::all_of(c.begin(), c.end(), [&](IdType p) { return m_Complex.Points()[p] == points[p]; }));
    m_Changed[t] = m_Changed[t] || (!same && m_Complex.IsAlive(t)) ? 1 : 0;
  }
  m_Densities.Distribute(m_Complex, execution);
  m_SurfaceSamples.Distribute(m_Complex);
  FillGrid();
  m_VolumeErrors = m_Volumes.ChangesTo(m_Complex);
  RequeueAll();
}

/** Where much has changed without a note of it. */
void
MeshCollapser::RequeueAll()
{
  m_Queue = {};
  for (IdType v = 0; v < static_cast<IdType>(m_State.size()); ++v)
  {
    if (m_State[v] != State::Gone)
    {
      m_State[v] = m_Complex.Star(v).empty() ? State::Gone : State::Queued;
      m_Dirty[v] = 1;
    }
    if (m_State[v] == State::Queued)
    {
      m_Queue.push({ m_Cost[v], v });
    }
  }
}

void
MeshCollapser::ClearChanged()
{
  std::fill(m_Changed.begin(), m_Changed.end(), 0);
}
} // namespace bone
