/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneHierarchyLocator.h"

#include <stdexcept>

namespace bone
{
namespace
{
/** The cell of a locator's mesh at the centroid of each cell of a mesh. Neighbours in number are near in space. */
std::vector<IdType>
CellsAtCentroids(const MeshArrays & mesh, const TetraLocator & locator)
{
  std::vector<IdType> cells;
  IdType              at = -1;
  for (const Id4 & t : mesh.tetrahedra)
  {
    const auto & p = mesh.points;
    at = locator.FindNearest((p[t[0]] + p[t[1]] + p[t[2]] + p[t[3]]) / 4.0, at).cell;
    cells.push_back(at);
  }
  return cells;
}
} // namespace

HierarchyLocator::HierarchyLocator(const std::vector<MeshArrays> & levels)
{
  for (const MeshArrays & level : levels)
  {
    if (level.tetrahedra.empty())
    {
      throw std::invalid_argument("HierarchyLocator: level " + std::to_string(m_Locators.size() + 1) +
                                  " has no tetrahedra.");
    }
    m_Locators.push_back(std::make_unique<TetraLocator>(level));
  }
  for (std::size_t k = 0; k + 1 < levels.size(); ++k)
  {
    m_Coarser.push_back(CellsAtCentroids(levels[k], *m_Locators[k + 1]));
    m_Finer.push_back(CellsAtCentroids(levels[k + 1], *m_Locators[k]));
  }
}

IdType
HierarchyLocator::StartingCell(std::size_t from, IdType cell, std::size_t to) const
{
  for (; from < to; ++from)
  {
    cell = m_Coarser[from][cell];
  }
  for (; from > to; --from)
  {
    cell = m_Finer[from - 1][cell];
  }
  return cell;
}
} // namespace bone
