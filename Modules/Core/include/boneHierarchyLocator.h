/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneHierarchyLocator_h
#define boneHierarchyLocator_h

#include "boneDensityHierarchy.h"
#include "boneTetraLocator.h"

#include <memory>
#include <vector>

namespace bone
{
/** \class HierarchyLocator
 * \brief Finds points in the levels of a hierarchy: a cell on one level gives a starting cell on any other.
 *
 * A cell's counterpart on the next level up or down is the one in which its centroid lies, or that is nearest to it;
 * further levels are reached step by step. The result of a search does not depend on where it starts. Building is
 * O(n log n) in all cells of all levels; const use is safe from many threads. */
class HierarchyLocator
{
public:
  /** Levels from fine to coarse; each must have tetrahedra, otherwise std::invalid_argument. */
  explicit HierarchyLocator(const std::vector<MeshArrays> & levels);

  template <typename TMesh>
  explicit HierarchyLocator(const DensityHierarchy<TMesh> & hierarchy)
    : HierarchyLocator(ArraysOf(hierarchy))
  {}

  /** Where to begin on level `to` for a point in a cell of level `from`; 0 is the finest. */
  IdType
  StartingCell(std::size_t from, IdType cell, std::size_t to) const;

  /** The tetrahedron of a level that contains x, or the nearest place of its boundary, given a cell of some level. */
  CellLocation
  FindNearest(std::size_t level, const Vector3 & x, std::size_t hintLevel, IdType hintCell) const
  {
    return m_Locators[level]->FindNearest(x, StartingCell(hintLevel, hintCell, level));
  }

  const TetraLocator &
  GetLocator(std::size_t level) const
  {
    return *m_Locators.at(level);
  }

private:
  template <typename TMesh>
  static std::vector<MeshArrays>
  ArraysOf(const DensityHierarchy<TMesh> & hierarchy)
  {
    std::vector<MeshArrays> levels;
    for (const auto & level : hierarchy.GetLevels())
    {
      levels.push_back(level.mesh->GetArrays());
    }
    return levels;
  }

  std::vector<std::unique_ptr<TetraLocator>> m_Locators;
  std::vector<std::vector<IdType>>           m_Coarser; ///< of each level's cells, on the level after it
  std::vector<std::vector<IdType>>           m_Finer;   ///< of the cells of the level after it, on this level
};
} // namespace bone

#endif
