/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneContinuousDensity_h
#define boneContinuousDensity_h

#include "boneExecution.h"
#include "boneMeshArrays.h"

namespace bone
{
/** What MakeDensityContinuous or MakeGradientContinuous did. */
struct ContinuousDensityReport
{
  std::size_t freeCoefficients{ 0 }; ///< those of the spline's own basis
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

/** Replaces the density of a split mesh by the cubic one nearest to it in the mean square over the body that has a
 * continuous gradient (C1) within each region of `mesh`; between regions value and gradient keep their jumps.
 *
 * `split` is SplitWorseyFarin(mesh) with a density of degree 3 in all its parts, such as FitDensity gives it. The
 * spline is known by its value and gradient at each vertex of a region and by the two derivatives across each edge
 * at its middle: 4 V + 2 E free coefficients a region, fewer than the continuous cubics of `mesh` have. Cubic
 * polynomials are reproduced. It is continuous to rounding, however far the iterations go. Conjugate gradients as in
 * MakeDensityContinuous, with a
 * mass matrix a tetrahedron (6 kB each).
 *
 * Throws std::invalid_argument where the density or the mesh does not suit. The result does not depend on the number of
 * threads. Progress is by iterations. Source: see SplitWorseyFarin. */
ContinuousDensityReport
MakeGradientContinuous(const MeshArrays & mesh,
                       MeshArrays &       split,
                       const Execution &  execution,
                       double             tolerance = 1e-7,
                       int                maximumIterations = 500);
} // namespace bone

#endif
