/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneSharedCoefficients_h
#define boneSharedCoefficients_h

#include "boneMeshArrays.h"

#include <cstdint>
#include <vector>

namespace bone
{
/** Numbering of the coefficients of a continuous density: a use is t * count + c, coefficient c of tetrahedron t. */
struct SharedCoefficients
{
  std::size_t                size{ 0 };
  std::vector<std::uint32_t> global; ///< for each use the coefficient it shares
  std::vector<std::uint32_t> start;  ///< size + 1: of each coefficient's uses in `uses`
  std::vector<std::uint32_t> uses;   ///< ascending for each coefficient

  /** Fills start and uses from global. */
  void
  ListUses();

  template <typename TBody>
  void
  ForUses(std::size_t coefficient, const TBody & body) const
  {
    for (std::uint32_t entry = start[coefficient]; entry < start[coefficient + 1]; ++entry)
    {
      body(uses[entry]);
    }
  }
};

/** Coefficients of a degree on the vertices, edges and faces that tetrahedra of one region share
 * become one. O(#t log #t). */
SharedCoefficients
ShareCoefficients(const MeshArrays & mesh, int degree);
} // namespace bone

#endif
