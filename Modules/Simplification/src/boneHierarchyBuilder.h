/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneHierarchyBuilder_h
#define boneHierarchyBuilder_h

#include "boneBuildLevels.h"
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
  double maximumCellError{ std::numeric_limits<double>::infinity() };       ///< of each new cell, density units
  double maximumSurfaceDistance{ std::numeric_limits<double>::infinity() }; ///< mm, both ways, to the finest level
  int    maximumDegree{ -1 }; ///< to which degrees may be raised to keep to the density error; negative: not at all
};

/** \class HierarchyBuilder
 * \brief Makes one level after the other from a mesh: collapses, flips, and the densities of changed cells (paper 4).
 */
class HierarchyBuilder
{
public:
  HierarchyBuilder(MeshArrays mesh, const TetraCollapseParameters & parameters, const Execution & execution);

  BuiltLevel
  Next(const LevelRequest & request, const Execution & execution);

private:
  struct Draft
  {
    MeshArrays          mesh;
    std::vector<IdType> pointId;
    std::vector<IdType> cellSlot;
    double              densityError{ 0.0 };
    double              cellError{ 0.0 };
  };

  Draft
  Compact(const LevelRequest & request, const Execution & execution) const;
  /** Collapses under the first floors, and under the others where the ones before leave too many cells. */
  void
  CollapseBy(const std::vector<AngleFloors> & floors, IdType target, BuiltLevel & level, const Execution & execution);
  bool
  CollapseTo(IdType target, BuiltLevel & level, const Execution & execution);
  std::string
  CollapseWithin(const LevelRequest & request, BuiltLevel & level, const Execution & execution);

  MeshArrays                     m_Source;      ///< attributes of the points of the finest level
  MeshArrays                     m_Before;      ///< the level before
  std::vector<IdType>            m_BeforePoint; ///< its points in the finest level
  std::vector<IdType>            m_BeforeCell;  ///< its cell of each slot, -1 for none
  std::vector<IdType>            m_SampleCell;  ///< its cell of each density sample
  MeshArrays                     m_Finest;      ///< for distances
  int                            m_Degree;      ///< of changed cells
  bool                           m_ImproveAngles;
  std::unique_ptr<MeshCollapser> m_Collapser;
};
} // namespace bone

#endif
