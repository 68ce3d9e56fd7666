/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneSurfaceDeformation_h
#define boneSurfaceDeformation_h

#include "boneDirectedSurface.h"
#include "boneExecution.h"

namespace bone
{
/** Parameters of \ref DeformAdaptiveFocus. */
struct AdaptiveFocusParameters
{
  std::vector<int> rings{ 16, 12, 8, 6, 4, 3, 2 }; ///< radius of the affine segments, in rings of neighbours
  int              iterations{ 8 };                ///< with each radius
  double           ridge{ 0.01 }; ///< pull of a segment's affine map to the map of the radius before, of its spread
  double           slide{ 0.1 };  ///< weight of a pull along the surface; across it is 1 more
  int              attributeLayers{ 6 };  ///< length of the attribute vectors
  double           attributeWidth{ 0.3 }; ///< difference of attribute vectors at which a vertex counts a third
  std::size_t      targetPoints{ 6000 };  ///< points of the target that pull, about
  double           focus{ 1.0 };          ///< how much more vertices with distinct attributes count at first; 0: not
};

/** \brief Deforms a surface onto another (adaptive-focus deformation, D. Shen, E. H. Herskovits & C. Davatzikos,
 * doi:10.1109/42.921475), starting from where it is.
 *
 * Each vertex leads a segment, its neighbours within a number of rings, by the affine map from rest that brings the
 * segment best to its closest points on the target (normals must suit; from either surface to the other, each pair by
 * the area it stands for, so that tips are drawn out); the vertex takes its own place under that map. Focus and
 * neighbourhood shrink ring by ring. What the paper leaves open is decided so:
 *  - the map is fitted from the shape at rest, so that a segment stays affine to the model whatever came before;
 *  - a pair pulls with its full force across the surface and with `slide` of it along, so that segments slide to where
 *    they fit: this takes a third of the steps that plain distances take to the same correspondence;
 *  - attribute vectors (\ref AttributeVectors) weigh: a vertex whose vector has left that at rest counts less, and
 *    prominent vertices, where the neighbourhood's centroid is farthest off, lead at first (`focus`).
 * Returns the new points. Deterministic, the same for any number of threads. */
std::vector<Vector3>
DeformAdaptiveFocus(const TriangleSurface &         source,
                    const DirectedSurface &         target,
                    const AdaptiveFocusParameters & parameters,
                    const Execution &               execution = {});

/** Rings of neighbours of every vertex: ring[v] lists vertices in order of rings, start[v][r] where ring r begins;
 * ring 0 is the vertex itself. */
struct RingNeighbors
{
  std::vector<std::vector<IdType>>       ring;
  std::vector<std::vector<std::int32_t>> start; ///< rings + 2 entries a vertex
};
RingNeighbors
FindRings(const TriangleSurface & surface, int rings, const Execution & execution = {});

/** \brief Attribute vectors: for each vertex and ring 1..layers the mean signed volume of the tetrahedra of the vertex
 * and three vertices a third of the ring apart, over the sum of the magnitudes; unchanged by affine maps. */
Eigen::MatrixXd
AttributeVectors(const std::vector<Vector3> & points,
                 const RingNeighbors &        rings,
                 int                          layers,
                 const Execution &            execution = {});
} // namespace bone

#endif
