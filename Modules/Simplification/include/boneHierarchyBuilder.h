/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneHierarchyBuilder_h
#define boneHierarchyBuilder_h

#include "boneLevelDensity.h"
#include "boneMeshCollapser.h"

#include <memory>
#include <string>

namespace bone
{
/** What one level is to be. */
struct LevelRequest
{
  IdType tetrahedra{ 0 };           ///< no more than these; 0: as few as the bounds allow
  double maximumDensityError{ -1 }; ///< root mean square, density units; negative: none
  double maximumSurfaceDistance{ std::numeric_limits<double>::infinity() }; ///< mm, both ways, to the finest level
  int    maximumDegree{ -1 }; ///< to which degrees may be raised to keep to the density error; negative: not at all
};

/** One level as made. */
struct BuiltLevel
{
  MeshArrays                                  mesh;
  std::vector<IdType>                         parentPoint; ///< id of each point in the level before
  double                                      densityError{ 0.0 };
  double                                      surfaceError{ 0.0 };
  std::string                                 stopReason;
  std::size_t                                 collapses{ 0 };
  std::array<std::size_t, MeshOperationCount> refused{}; ///< candidates refused while this level was made
};

/** \class HierarchyBuilder
 * \brief Makes one level after the other from a mesh: collapses, flips, and the densities of changed cells (paper 4).
 */
class HierarchyBuilder
{
public:
  HierarchyBuilder(MeshArrays mesh, const CollapseParameters & parameters, ParallelFor parallelFor);

  /** \a progress gets the fraction of this level that is done, and may throw. */
  BuiltLevel
  Next(const LevelRequest & request, const std::function<void(double)> & progress);

private:
  struct Draft
  {
    MeshArrays          mesh;
    std::vector<IdType> pointId;
    std::vector<IdType> cellSlot;
    double              densityError{ 0.0 };
  };

  Draft
  Compact(const LevelRequest & request) const;
  bool
  CollapseTo(IdType target, BuiltLevel & level, const std::function<void()> & progress);
  std::string
  CollapseWithin(const LevelRequest & request, BuiltLevel & level, const std::function<void()> & progress);

  MeshArrays                     m_Source;      ///< attributes of the points of the finest level
  MeshArrays                     m_Before;      ///< the level before
  std::vector<IdType>            m_BeforePoint; ///< its points in the finest level
  std::vector<IdType>            m_BeforeCell;  ///< its cell of each slot, -1 for none
  std::vector<IdType>            m_SampleCell;  ///< its cell of each density sample
  MeshArrays                     m_Finest;      ///< for distances
  int                            m_Degree;      ///< of changed cells
  std::unique_ptr<MeshCollapser> m_Collapser;
  ParallelFor                    m_ParallelFor;
};
} // namespace bone

#endif
