/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneEdgeUses_h
#define boneEdgeUses_h

#include "boneMeshArrays.h"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace bone
{
/** Two points in one number, the order of the numbers that of the pairs. */
inline std::uint64_t
PairKey(IdType a, IdType b)
{
  return static_cast<std::uint64_t>(a) << 32 | static_cast<std::uint32_t>(b);
}

/** A use of an edge by a triangle of a surface. */
struct EdgeUse
{
  std::uint64_t key;    ///< smaller and larger point
  std::uint32_t corner; ///< 3 face + i for the edge from the face's vertex i to vertex i + 1

  IdType
  First() const
  {
    return static_cast<IdType>(key >> 32);
  }

  IdType
  Second() const
  {
    return static_cast<IdType>(key & 0xffffffffu);
  }

  int
  Face() const
  {
    return static_cast<int>(corner / 3);
  }
};

/** The uses of all edges of a surface, those of one edge side by side, by face; `pointOf(face, i)` is a face's vertex.
 */
template <typename TPointOf>
std::vector<EdgeUse>
SortedEdges(std::size_t numberOfFaces, TPointOf pointOf)
{
  std::vector<EdgeUse> edges;
  edges.reserve(3 * numberOfFaces);
  for (std::size_t f = 0; f < numberOfFaces; ++f)
  {
    for (std::size_t i = 0; i < 3; ++i)
    {
      const IdType a = pointOf(f, i), b = pointOf(f, (i + 1) % 3);
      edges.push_back({ PairKey(std::min(a, b), std::max(a, b)), static_cast<std::uint32_t>(3 * f + i) });
    }
  }
  std::sort(edges.begin(), edges.end(), [](const EdgeUse & a, const EdgeUse & b) {
    return a.key != b.key ? a.key < b.key : a.corner < b.corner;
  });
  return edges;
}

/** Calls visit(first, last) with the uses of each edge. */
template <typename TVisit>
void
ForEachEdge(const std::vector<EdgeUse> & edges, TVisit visit)
{
  for (auto first = edges.begin(); first != edges.end();)
  {
    const auto last = std::find_if(first, edges.end(), [&](const EdgeUse & edge) { return edge.key != first->key; });
    visit(first, last);
    first = last;
  }
}
} // namespace bone

#endif
