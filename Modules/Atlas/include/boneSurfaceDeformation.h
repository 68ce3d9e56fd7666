/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneSurfaceDeformation_h
#define boneSurfaceDeformation_h

#include "boneDirectedSurface.h"

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
                    const AdaptiveFocusParameters & parameters);

/** Parameters of \ref DeformNonRigidICP. */
struct NonRigidICPParameters
{
  std::vector<double> stiffness{ 50, 20, 10, 5, 2, 1, 0.5 }; ///< one after the other
  int                 iterations{ 4 };                       ///< with each stiffness at most
  double              tolerance{ 0.05 };                     ///< mean move of a vertex that ends a stiffness, mm
};

/** \brief Optimal-step non-rigid ICP (B. Amberg, S. Romdhani & T. Vetter, doi:10.1109/CVPR.2007.383165), for
 * comparison.
 *
 * Each vertex has an affine map; those of neighbours differ as little as the stiffness asks for, while vertices come to
 * their closest points. One sparse linear least-squares problem a step. Returns the new points. */
std::vector<Vector3>
DeformNonRigidICP(const TriangleSurface &       source,
                  const DirectedSurface &       target,
                  const NonRigidICPParameters & parameters);

/** Parameters of \ref FitFacets. */
struct FacetFitParameters
{
  std::vector<int> smoothing{ 0, 0 }; ///< one a pass: how often the moves are averaged over neighbours
  double           bound{ 0.5 };      ///< how far a vertex may move in all passes, mm
  double           reach{ 5.0 };      ///< farther off the target is none, mm
};

/** \brief Moves vertices along their normals so that the facets, not the vertices, lie on the target.
 *
 * A surface whose vertices lie on a bone cuts off its bulges and fills its hollows by the sagitta of its facets, which
 * takes mass off the bone. Each pass moves a vertex by the mean signed distance of the facets around it, at seven
 * places of each, weighted by its shape function and their area; two passes are near enough to the least-squares
 * solution from nearby. Moves are smoothed over the surface first where it is farther off. Vertices with a mark in
 * `fixed` (empty: none) stay. The same for any number of threads. */
void
FitFacets(TriangleSurface &          surface,
          const DirectedSurface &    target,
          const FacetFitParameters & parameters,
          const std::vector<char> &  fixed = {});

/** Rings of neighbours of every vertex: ring[v] lists vertices in order of rings, start[v][r] where ring r begins;
 * ring 0 is the vertex itself. */
struct RingNeighbors
{
  std::vector<std::vector<IdType>>       ring;
  std::vector<std::vector<std::int32_t>> start; ///< rings + 2 entries a vertex
};
RingNeighbors
FindRings(const TriangleSurface & surface, int rings);

/** \brief Attribute vectors: for each vertex and ring 1..layers the mean signed volume of the tetrahedra of the vertex
 * and three vertices a third of the ring apart, over the sum of the magnitudes; unchanged by affine maps. */
Eigen::MatrixXd
AttributeVectors(const std::vector<Vector3> & points, const RingNeighbors & rings, int layers);
} // namespace bone

#endif
