/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneCurvedBoundary_h
#define boneCurvedBoundary_h

#include "boneFiniteElementModel.h"
#include "boneTriangleDistance.h"

namespace bone
{
/** Least Jacobian determinant of a curved element, as a share of the straight one's. */
constexpr double LeastCurvedJacobian = 0.25;

/** What CurveBoundary did. */
struct CurvedBoundary
{
  IdType curved{ 0 };        ///< nodes that lie on the surface
  IdType refused{ 0 };       ///< nodes that stay in the middle of their edge, as an element would suffer
  double largestMove{ 0.0 }; ///< mm, of a node that lies on the surface
};

/** \brief Moves the nodes on the edges of the boundary to the nearest point of a surface.
 *
 * Edges of flat cuts stay straight, their rims too. The Jacobian determinant of an element with ten nodes is a
 * polynomial of degree 3; where one of its Bernstein coefficients, which bound it, would fall below LeastCurvedJacobian
 * of the straight element's, the node of it that was moved farthest goes back, until none does. The moduli
 * stay those of the straight elements.
 *
 * Throws std::invalid_argument where the elements have four nodes. */
CurvedBoundary
CurveBoundary(const TriangleDistance & surface, FiniteElementModel & model);

/** The least Bernstein coefficient of the Jacobian determinant of an element with ten nodes, over the determinant of
 * the element with its corners and straight edges: 1 where its edges are straight. */
double
LeastRelativeJacobian(const FiniteElementModel & model, std::size_t element);
} // namespace bone

#endif
