/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneSlabTiler_h
#define boneSlabTiler_h

#include "boneContourStack.h"
#include "boneRingKnit.h"
#include "boneSectionBuilder.h"
#include "boneSectionJoin.h"
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
            TilingReport &            report)
    : m_Stack(stack)
    , m_Metric(metric)
    , m_Pool(pool)
    , m_Tetrahedra(tetrahedra)
    , m_Report(report)
  {}

  /** Knits the sections of two planes that belong together, if that can be done as it is. */
  bool
  TryDirect(const std::vector<Section> & lower, const std::vector<Section> & upper);

  /** Tiles the sections of two planes at the given heights that belong together: one on one side at least, none of the
   * sides empty. Throws std::runtime_error where every way fails. */
  void
  TileGroup(const std::vector<Section> & lower,
            const std::vector<Section> & upper,
            double                       lowerHeight,
            double                       upperHeight,
            int                          depth = 0);

  /** Closes a section by a ridge over its medial axis at `height` (above or below its own); always succeeds. */
  void
  Cap(const Section & section, double height, bool above);

private:
  bool
  TryKnit(const Section & lower, const Section & upper, const std::vector<int> & regions);
  bool
  KnitFrom(const Section &          lower,
           const Section &          upper,
           int                      ring,
           const Merge &            wall,
           const std::vector<int> & regions,
           int &                    budget);
  /** Region of each ring of the slab. A layer that ends at an axis where it already ended from the other side ends at
   * the slice before instead, with a flat face: four of its faces would meet at the axis. */
  std::vector<int>
  RingRegions(const Section & lower, const Section & upper) const;
  void
  MarkCollapsed(const Section & section);
  bool
  TryIntermediate(const std::vector<Section> & lower,
                  const std::vector<Section> & upper,
                  double                       lowerHeight,
                  double                       upperHeight,
                  int                          depth);
  bool
  TryPlane(const std::vector<Section> &      lower,
           const std::vector<Section> &      upper,
           double                            lowerHeight,
           double                            upperHeight,
           int                               depth,
           const std::vector<PieceOutline> & pieces,
           const PlanarTree &                axis);
  PlanarTree
  AxisOf(const std::vector<Section> & sections) const;
  bool
  TryStar(const std::vector<Section> & lowers, const std::vector<Section> & uppers, double height);
  void
  AddWallCells(const Walk & lower, const Walk & upper, const Merge & wall, int apex);
  void
  CapByCone(const Section & section, const Vector2 & apex, double height, bool above);
  Section
  RidgeOver(const Section & section, double height);

  const ContourStack &      m_Stack;
  const TilingMetric &      m_Metric;
  VertexPool &              m_Pool;
  std::vector<TiledTetra> & m_Tetrahedra;
  TilingReport &            m_Report;
  EdgeSet                   m_UsedEdges; ///< edges that bridges run along
  std::set<int>             m_Collapsed; ///< vertices of axes at which a layer ends
  int                       m_Budget{ 0 };
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
