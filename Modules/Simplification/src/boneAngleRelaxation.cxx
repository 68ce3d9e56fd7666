/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneAngleRelaxation.h"

#include "bonePointStar.h"
#include "boneQualityMeasures.h"
#include "boneTetraFlips.h"

#include <algorithm>
#include <cmath>

namespace bone
{
namespace
{
constexpr double MoveGain = 1e-3; ///< rad
constexpr double FlipGain = 0.02; ///< rad
/** Of PlanSurfaceFlip: new cells may be worse than the old ones, as long as they are positive. */
constexpr double AnyCosine = 1.0;
} // namespace

AngleRelaxation::AngleRelaxation(TetraComplex &    complex,
                                 PointMover &      mover,
                                 AngleMerit &      merit,
                                 CellCount         count,
                                 const Execution & execution)
  : m_Complex(complex)
  , m_Mover(mover)
  , m_Merit(merit)
  , m_Count(count)
  , m_Execution(execution)
{
  this->Forget();
}

void
AngleRelaxation::Forget()
{
  m_Moved.assign(m_Complex.Points().size(), 0);
  m_Flipped.assign(m_Complex.Points().size(), 0);
}

void
AngleRelaxation::Forget(const std::vector<IdType> & cells)
{
  for (IdType t : cells)
  {
    for (IdType p : m_Complex.Cell(t))
    {
      m_Moved[p] = 0;
      m_Flipped[p] = 0;
    }
  }
}

bool
AngleRelaxation::IsNew(IdType p, const std::vector<std::uint32_t> & times) const
{
  return times[p] == 0 || m_Complex.HasChanged(p, times[p]);
}

std::size_t
AngleRelaxation::Sweep()
{
  m_Merit.NoteVolumes(m_Complex);
  const std::size_t flips = this->FlipSurfaces();
  return flips + this->MovePoints();
}

std::size_t
AngleRelaxation::FlipSurfaces()
{
  double sum = 0.0;
  for (IdType t = 0; t < m_Complex.Size(); ++t)
  {
    sum += m_Complex.IsAlive(t) ? m_Merit.OfCell(CellCosine(m_Complex, t), m_Complex.Region(t)) : 0.0;
  }
  const double mean = sum / m_Complex.AliveCells();
  std::size_t  flips = 0;
  for (IdType a = 0; a < static_cast<IdType>(m_Complex.Points().size()); ++a)
  {
    if (m_Complex.Dimension(a) < 3 && this->IsNew(a, m_Flipped))
    {
      m_Flipped[a] = m_Complex.Clock();
      flips += this->FlipAt(a, mean);
    }
  }
  return flips;
}

/** The first edge at a that may be flipped. */
bool
AngleRelaxation::FlipAt(IdType a, double mean)
{
  std::vector<TetraComplex::SurfaceFace> faces;
  m_Complex.SurfaceStar(a, faces);
  for (const auto & face : faces)
  {
    if (this->TryFlip(a, face.a, mean))
    {
      return true;
    }
  }
  return false;
}

bool
AngleRelaxation::TryFlip(IdType a, IdType b, double mean)
{
  const SurfaceFlip plan = PlanSurfaceFlip(m_Complex, a, b, AnyCosine);
  const auto        more = static_cast<IdType>(plan.created.size()) - static_cast<IdType>(plan.removed.size());
  const IdType      cells = m_Complex.AliveCells() + more;
  if (plan.outcome != MeshOperation::Done || (more < 0 && cells < m_Count.least) || (more > 0 && cells > m_Count.most))
  {
    return false;
  }
  // A cell more or less is worth nothing in itself.
  const auto &        p = m_Complex.Points();
  double              gain = 0.0, worst = -1.0;
  std::vector<double> changes(m_Merit.Volumes().Size(), 0.0);
  for (IdType t : plan.removed)
  {
    const Id4 &  c = m_Complex.Cell(t);
    const double cosine = CellCosine(m_Complex, t);
    worst = std::max(worst, cosine);
    gain -= m_Merit.OfCell(cosine, m_Complex.Region(t)) - mean;
    changes[m_Merit.Volumes().NumberOf(m_Complex.Region(t))] -= SignedVolume(p[c[0]], p[c[1]], p[c[2]], p[c[3]]);
  }
  for (std::size_t i = 0; i < plan.created.size(); ++i)
  {
    const Id4 &  c = plan.created[i];
    const double cosine = LargestDihedralCosine(p[c[0]], p[c[1]], p[c[2]], p[c[3]]);
    if (cosine > m_Merit.LargestCosine(plan.regions[i], worst))
    {
      return false;
    }
    gain += m_Merit.OfCell(cosine, plan.regions[i]) - mean;
    changes[m_Merit.Volumes().NumberOf(plan.regions[i])] += SignedVolume(p[c[0]], p[c[1]], p[c[2]], p[c[3]]);
  }
  const auto [c, d] = plan.corners;
  const int f = plan.surface;
  gain += m_Merit.OfVolumes(changes) + m_Merit.OfTriangle(f, { p[a], p[c], p[d] }) +
          m_Merit.OfTriangle(f, { p[b], p[c], p[d] }) - m_Merit.OfTriangle(f, { p[a], p[b], p[c] }) -
          m_Merit.OfTriangle(f, { p[a], p[b], p[d] });
  if (!(gain > FlipGain) ||
      !m_Mover.ReplaceSurface({ { { a, b, c }, f }, { { a, b, d }, f } }, { { { a, c, d }, f }, { { b, c, d }, f } }))
  {
    return false;
  }
  m_Complex.ReplaceAcross(plan.removed, plan.created, plan.regions, f);
  m_Merit.AddToVolumes(changes);
  return true;
}

std::vector<IdType>
AngleRelaxation::TakeBatch(std::vector<IdType> & waiting)
{
  std::vector<IdType> batch, rest;
  std::vector<char>   taken(m_Complex.Points().size(), 0);
  for (IdType p : waiting)
  {
    if (taken[p])
    {
      rest.push_back(p);
      continue;
    }
    batch.push_back(p);
    for (IdType t : m_Complex.Star(p))
    {
      for (IdType q : m_Complex.Cell(t))
      {
        taken[q] = 1;
      }
    }
  }
  waiting = std::move(rest);
  return batch;
}

std::size_t
AngleRelaxation::MovePoints()
{
  std::vector<IdType> waiting;
  for (IdType p = 0; p < static_cast<IdType>(m_Complex.Points().size()); ++p)
  {
    if (!m_Complex.Star(p).empty() && m_Complex.Dimension(p) > 0 && this->IsNew(p, m_Moved))
    {
      waiting.push_back(p);
    }
  }
  std::size_t moves = 0;
  while (!waiting.empty())
  {
    const std::vector<IdType>    batch = this->TakeBatch(waiting);
    std::vector<PointStar::Move> found(batch.size());
    m_Execution.For(
      batch.size(), [&](std::size_t i) { found[i] = PointStar(m_Complex, m_Merit, batch[i]).FindMove(); }, 4);
    for (std::size_t i = 0; i < batch.size(); ++i)
    {
      moves += this->Take(batch[i], found[i]);
    }
  }
  return moves;
}

bool
AngleRelaxation::Take(IdType p, const PointStar::Move & move)
{
  m_Moved[p] = m_Complex.Clock();
  if (!(move.gain + m_Merit.OfVolumes(move.volumeChanges) > MoveGain) ||
      m_Mover.TryMove(p, move.x, 1.0) != MeshOperation::Done)
  {
    return false;
  }
  m_Merit.AddToVolumes(move.volumeChanges);
  return true;
}
} // namespace bone
