/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSlabFilling.h"

#include "boneSlabFiller.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <set>
#include <stdexcept>
#include <tuple>

namespace bone
{
namespace tiling
{
namespace
{
constexpr double ShiftGain = 1.5;   ///< a shift leans upright walls too, so it must pay
constexpr double SmallShift = 0.03; // mm
constexpr int    SmallShifts = 3;
constexpr double WiderBox = 0.7;  ///< mm, with each small shift where no shift will do
constexpr int    UsualShifts = 2; ///< looked at always; others where these do not do

Vector2
CentroidOf(const VertexPool & pool, const std::vector<Section> & sections, const std::vector<int> & ids)
{
  Vector2 moment = Vector2::Zero();
  double  area = 0.0;
  for (int i : ids)
  {
    const auto polygon = OuterPolygon(pool.plane, sections[i]);
    for (std::size_t k = 1; k + 1 < polygon.size(); ++k)
    {
      const Vector2 d = polygon[k] - polygon[0], e = polygon[k + 1] - polygon[0];
      const double  twice = d.x() * e.y() - d.y() * e.x();
      moment += twice * (polygon[0] + polygon[k] + polygon[k + 1]) / 3.0;
      area += twice;
    }
  }
  return moment / area;
}

/** How far the upper slice may be moved against the lower one: not at all, by the mean way of the groups' centroids,
 * by the way of a group's. */
std::vector<Vector2>
CandidateShifts(const VertexPool &           pool,
                const std::vector<Section> & lower,
                const std::vector<Section> & upper,
                const std::vector<Group> &   groups)
{
  std::vector<Vector2> ways;
  Vector2              mean = Vector2::Zero();
  for (const Group & group : groups)
  {
    if (!group.lower.empty() && !group.upper.empty())
    {
      ways.push_back(CentroidOf(pool, upper, group.upper) - CentroidOf(pool, lower, group.lower));
      mean += ways.back();
    }
  }
  std::vector<Vector2> shifts{ Vector2::Zero() };
  if (!ways.empty())
  {
    shifts.push_back(mean / static_cast<double>(ways.size()));
  }
  if (ways.size() > 1)
  {
    shifts.insert(shifts.end(), ways.begin(), ways.end());
  }
  return shifts;
}

/** The slices' triangulations at a shift and their overlay. */
struct Alignment
{
  SlabSide                    below, above;
  std::unique_ptr<SlabFiller> filler;
  std::vector<int>            separated;
  std::ptrdiff_t              lost{ 0 }; ///< parts of layers that overlap where no slice is moved, and do not here
  double                      common{ 0.0 };

  bool
  IsBetterThan(const Alignment & other) const
  {
    return std::make_tuple(separated.size(), lost, -common) <
           std::make_tuple(other.separated.size(), other.lost, -other.common);
  }
};

/** Lays the slices over each other and fills the space between them. */
class Aligner
{
public:
  Aligner(const ContourStack &         stack,
          const std::vector<Section> & lower,
          const std::vector<Section> & upper,
          const std::vector<Group> &   groups,
          const VertexPool &           pool,
          const Execution &            execution,
          bool                         split)
    : m_Stack(stack)
    , m_Lower(lower)
    , m_Upper(upper)
    , m_Groups(groups)
    , m_Pool(pool)
    , m_Execution(execution)
    , m_Split(split)
    , m_LowerGroup(lower.size(), -1)
    , m_UpperGroup(upper.size(), -1)
    , m_Slice((lower.empty() ? upper : lower).front().slice)
  {
    for (std::size_t g = 0; g < groups.size(); ++g)
    {
      for (int i : groups[g].lower)
      {
        m_LowerGroup[i] = static_cast<int>(g);
      }
      for (int i : groups[g].upper)
      {
        m_UpperGroup[i] = static_cast<int>(g);
      }
    }
  }

  SlabFilling
  Run(double low, double high)
  {
    this->FindAlignments();
    for (std::size_t a = 0; a < m_Alignments.size(); ++a)
    {
      if (this->Fill(*m_Alignments[a], low, high))
      {
        return *m_Filling;
      }
      // Vertices right above each other give flat cells. A small shift separates them and keeps what the next
      // alignment would lose.
      const bool dear = a + 1 < m_Alignments.size() && m_Alignments[a + 1]->lost > m_Alignments[a]->lost;
      for (int i = 1; dear && i <= SmallShifts; ++i)
      {
        const auto moved = this->Align(m_Alignments[a]->above.shift + i * SmallShift * Vector2(0.8, 0.6));
        if (moved && moved->lost <= m_Alignments[a]->lost && this->Fill(*moved, low, high))
        {
          return *m_Filling;
        }
      }
    }
    if (m_Filling)
    {
      return *m_Filling;
    }
    throw std::runtime_error("slice " + std::to_string(m_Slice) + ": the space next to it cannot be filled, " +
                             m_Reason + "; use a smaller slice step");
  }

private:
  /** Vertices of a symmetric section may lie on a diagonal of the box but for rounding, or on edges of the other slice:
   * then other boxes and shifts are tried. */
  void
  FindAlignments()
  {
    this->FindAlignmentsOfAttempt();
    while (m_Alignments.empty() && m_Attempt < SmallShifts)
    {
      ++m_Attempt;
      this->FindAlignmentsOfAttempt();
    }
  }

  /** Alignments at the shifts that may do, best first. */
  void
  FindAlignmentsOfAttempt()
  {
    int tried = 0;
    for (const Vector2 & candidate : CandidateShifts(m_Pool, m_Lower, m_Upper, m_Groups))
    {
      const Vector2 shift = candidate + m_Attempt * SmallShift * Vector2(0.8, 0.6);
      if (tried++ >= UsualShifts && !m_Alignments.empty() && m_Alignments.front()->separated.empty())
      {
        break;
      }
      if (auto alignment = this->Align(shift))
      {
        m_Alignments.push_back(std::move(alignment));
        std::stable_sort(
          m_Alignments.begin(), m_Alignments.end(), [](const auto & a, const auto & b) { return a->IsBetterThan(*b); });
      }
    }
  }

  /** Null where that cannot be; m_Reason then says why. */
  std::unique_ptr<Alignment>
  Align(const Vector2 & shift)
  {
    m_Execution.ThrowIfAborted();
    auto alignment = std::make_unique<Alignment>();
    try
    {
      SlabBounds bounds = BoundsOf(m_Pool, m_Lower, m_Upper, shift);
      bounds.high += m_Attempt * WiderBox * Vector2(1.0, 0.6);
      alignment->below = MakeSide(m_Pool, m_Lower, m_LowerGroup, bounds, Vector2::Zero());
      alignment->above = MakeSide(m_Pool, m_Upper, m_UpperGroup, bounds, shift);
      auto cuts = m_Split ? FindPieceCuts(m_Pool, m_Lower, m_Upper, m_Groups, shift) : std::vector<PieceCut>{};
      alignment->filler = std::make_unique<SlabFiller>(
        m_Stack, alignment->below, alignment->above, m_Slice, m_Pool, std::move(cuts), m_Execution);
    }
    catch (const std::runtime_error & error)
    {
      m_Reason = error.what();
      return nullptr;
    }
    alignment->separated = alignment->filler->SeparatedGroups(m_Groups);
    alignment->common = alignment->filler->CommonArea() / (shift.isZero() ? 1.0 : ShiftGain);
    const std::set<LayerLink> links = alignment->filler->Links();
    m_Unmoved = shift.isZero() ? links : m_Unmoved;
    alignment->lost = std::count_if(
      m_Unmoved.begin(), m_Unmoved.end(), [&links](const LayerLink & link) { return links.count(link) == 0; });
    return alignment;
  }

  /** Whether m_Filling now is one without flat cells; else it may be one with such. */
  bool
  Fill(const Alignment & alignment, double low, double high)
  {
    try
    {
      bool        thin = false;
      SlabFilling filling = alignment.filler->Run(low, high, m_Execution, thin);
      filling.separated = alignment.separated;
      if (!thin || !m_Filling)
      {
        m_Filling = std::move(filling);
      }
      return !thin;
    }
    catch (const std::runtime_error & error)
    {
      m_Reason = error.what();
      return false;
    }
  }

  const ContourStack &                    m_Stack;
  const std::vector<Section> &            m_Lower;
  const std::vector<Section> &            m_Upper;
  const std::vector<Group> &              m_Groups;
  const VertexPool &                      m_Pool;
  const Execution &                       m_Execution;
  bool                                    m_Split;
  std::vector<int>                        m_LowerGroup;
  std::vector<int>                        m_UpperGroup;
  int                                     m_Slice;
  int                                     m_Attempt{ 0 }; ///< at alignments, while there are none
  std::vector<std::unique_ptr<Alignment>> m_Alignments;
  std::set<LayerLink>                     m_Unmoved; ///< that overlap where no slice is moved
  std::optional<SlabFilling>              m_Filling;
  std::string                             m_Reason;
};
} // namespace

SlabFilling
FillSlab(const ContourStack &         stack,
         const std::vector<Section> & lower,
         const std::vector<Section> & upper,
         const std::vector<Group> &   groups,
         double                       lowerHeight,
         double                       upperHeight,
         const VertexPool &           pool,
         const Execution &            execution,
         bool                         split)
{
  return Aligner(stack, lower, upper, groups, pool, execution, split).Run(lowerHeight, upperHeight);
}
} // namespace tiling
} // namespace bone
