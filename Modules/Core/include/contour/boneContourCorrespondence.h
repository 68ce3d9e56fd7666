/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneContourCorrespondence_h
#define boneContourCorrespondence_h

#include <map>
#include <vector>

namespace bone
{
/** \struct ContourCorrespondence
 * \brief Which pieces of bone on a slice go on as which on the next (paper 2.5).
 *
 * A piece is named by the id of its periosteal contour on its slice (\ref Contour::id). */
struct ContourCorrespondence
{
  /** Pieces that are one body between the two slices. One side may be empty: the piece ends, or begins, there. */
  struct Group
  {
    std::vector<int> lower;
    std::vector<int> upper;

    bool
    operator==(const Group & other) const
    {
      return lower == other.lower && upper == other.upper;
    }
  };

  /** Groups between slice k and k + 1, by k. */
  std::map<int, std::vector<Group>> slabs;
};
} // namespace bone

#endif
