/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneContinuousDensity_h
#define boneContinuousDensity_h

#include "boneExecution.h"
#include "boneMeshArrays.h"

namespace bone
{
/** What MakeDensityContinuous did. */
struct ContinuousDensityReport
{
  std::size_t freeCoefficients{ 0 }; ///< after coefficients on shared vertices, edges and faces became one
  int         iterations{ 0 };
  double      residual{ 0.0 }; ///< relative, of the normal equations
};

/** Replaces the density by the continuous one nearest to it in the mean square over the body (abstract of the paper:
 * "smooth spline").
 *
 * Within each region, tetrahedra that share a vertex, edge or face share the coefficients there, which makes the
 * density continuous (C0); between regions it keeps its jump. As the least-squares fits of the single tetrahedra hold
 * all that their samples say, their projection is the least-squares spline of the samples, the patterns' sums taken as
 * integrals. Conjugate gradients on the mass matrix, tetrahedron by tetrahedron, preconditioned by the tetrahedra's own
 * inverses (one small matrix for all of them): a few dozen iterations, whatever the degree and the mesh.
 *
 * All tetrahedra must have the degree mesh.maximumDegree >= 1 and positive volume, else std::invalid_argument. The
 * result does not depend on the number of threads. Progress is by iterations. */
ContinuousDensityReport
MakeDensityContinuous(MeshArrays &      mesh,
                      const Execution & execution,
                      double            tolerance = 1e-7,
                      int               maximumIterations = 500);
} // namespace bone

#endif
