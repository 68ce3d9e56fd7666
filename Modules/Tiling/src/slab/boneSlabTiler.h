/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneSlabTiler_h
#define boneSlabTiler_h

#include "boneContourStack.h"
#include "boneExecution.h"
#include "bonePieceMatching.h"
#include "boneRingKnit.h"
#include "boneSectionBuilder.h"
#include "boneSectionJoin.h"
#include "boneSectionSplit.h"
#include "boneTilingReport.h"

namespace bone
{
namespace tiling
{
/** Fills the space between corresponding sections of two planes. */
class SlabTiler
{
public:
  SlabTiler(const ContourStack &      stack,
            const TilingMetric &      metric,
            VertexPool &              pool,
            std::vector<TiledTetra> & tetrahedra,
            TilingReport &            report,
            const Execution &         execution)
    : m_Stack(stack)
    , m_Metric(metric)
    , m_Pool(pool)
    , m_Tetrahedra(tetrahedra)
    , m_Report(report)
    , m_Execution(execution)
  {}

  /** Knits the sections of two planes that belong together, if that can be done as it is. */
  bool
  TryDirect(const std::vector<Section> & lower, const std::vector<Section> & upper);

  /** Knits the single section of one plane, split into parts, with those of the other, if that can be done
   * (\ref SplitSection). */
  bool
  TrySplit(const std::vector<Section> & lower, const std::vector<Section> & upper);

  /** Closes a section by a ridge over its medial axis at `height` (above or below its own), if it has one and that can
   * be done. */
  bool
  TryCap(const Section & section, double height, bool above);

private:
  /** Whether a wall of the tetrahedra from `begin` is twisted against the contours it joins. */
  bool
  WallsSkew(const Section & lower, const Section & upper, std::size_t begin, double height) const;
  bool
  TryKnit(const Section & lower, const Section & upper, const std::vector<int> & regions);
  bool
  KnitFrom(const Section &          lower,
           const Section &          upper,
           int                      ring,
           const Merge &            wall,
           const std::vector<int> & regions,
           int &                    budget);
  /** Whether a layer would end at an axis where it already ended from the other side: four of its faces would meet
   * there. */
  bool
  EndsOnBothSides(const Section & lower, const Section & upper) const;
  void
  MarkCollapsed(const Section & section);
  Section
  RidgeOver(const Section & section, double height);

  const ContourStack &      m_Stack;
  const TilingMetric &      m_Metric;
  VertexPool &              m_Pool;
  std::vector<TiledTetra> & m_Tetrahedra;
  TilingReport &            m_Report;
  const Execution &         m_Execution;
  EdgeSet                   m_UsedEdges; ///< edges that bridges run along
  std::set<int>             m_Collapsed; ///< vertices of axes at which a layer ends
  CutTrace                  m_Cuts;      ///< of the sections that were split
};

/** True where the outer walls of the tetrahedra from `begin` on cross each other, looked at in planes between the
 * slices. */
bool
WallsCross(const VertexPool &              pool,
           const ContourStack &            stack,
           const std::vector<TiledTetra> & tetrahedra,
           std::size_t                     begin,
           double                          lowerHeight,
           double                          upperHeight);
} // namespace tiling
} // namespace bone

#endif
