/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneWorseyFarinSplit_h
#define boneWorseyFarinSplit_h

#include "boneMeshArrays.h"

namespace bone
{
/** Number of tetrahedra that one is split into. */
constexpr std::size_t WorseyFarinCells = 12;

/** Vertices of each part of a split tetrahedron: 0 to 3 its vertices, 4 + i the split point of the face opposite vertex
 * i, 8 its incentre. A part is an edge of a face, the face's split point and the incentre, in positive orientation. */
constexpr std::array<std::array<int, 4>, WorseyFarinCells>
WorseyFarinParts()
{
  std::array<std::array<int, 4>, WorseyFarinCells> parts{};
  for (int face = 0; face < 4; ++face)
  {
    for (int edge = 0; edge < 3; ++edge)
    {
      auto & part = parts[3 * face + edge];
      part[0] = TetraFaces[face][(edge + 1) % 3];
      part[1] = TetraFaces[face][edge];
      part[2] = 4 + face;
      part[3] = 8;
    }
  }
  return parts;
}

/** Centre of the inscribed sphere, as barycentric coordinates: the areas of the opposite faces over their sum. */
Eigen::Vector4d
IncentreCoordinates(const MeshArrays & mesh, const Id4 & tetra);

/** The mesh with every tetrahedron split into twelve, on which C1 cubic splines have a local basis (Worsey and Farin,
 * Constructive Approximation 3:99-110, 1987, doi:10.1007/BF01890556; Lai and Schumaker, Spline Functions on
 * Triangulations, 2007, chapters 16 and 18, doi:10.1017/CBO9780511721588).
 *
 * A tetrahedron is split at its incentre, and each face at a point inside it: where the line between the incentres of
 * its two tetrahedra meets it, which they see alike, and at the boundary where the inscribed sphere touches it. Thus
 * the split is conforming, across regions too, and the surfaces stay in place. Points of `mesh` (mm) come first,
 * unchanged, then the incentres, then the faces' points; tetrahedron t becomes 12 t + k, k as in WorseyFarinParts(). A
 * new point's layer is the largest of the vertices it lies between, its slice that of the first of them. The density is
 * left out. The mesh must be valid (\ref ValidateMesh); a flat or inverted tetrahedron throws std::invalid_argument.
 * O(#t log #t). */
MeshArrays
SplitWorseyFarin(const MeshArrays & mesh);
} // namespace bone

#endif
