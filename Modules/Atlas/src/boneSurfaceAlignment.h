/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneSurfaceAlignment_h
#define boneSurfaceAlignment_h

#include "boneAtlasRegistrationParameters.h"
#include "boneDirectedSurface.h"
#include "boneExecution.h"
#include "bonePointAlignment.h"

namespace bone
{
/** Parameters of \ref AlignSurfaces. */
struct SurfaceAlignmentParameters
{
  AlignmentKind kind{ AtlasRegistrationParameters().alignment }; ///< the last step's freedom
  bool          principalAxes{ true }; ///< start from principal axes; else from where the source is
  double        trim{ 0.9 };           ///< share of the point pairs, the nearest, that count
  int           samples{ 1000 };       ///< points on each surface
  int           iterations{ 40 };      ///< of each step at most
};

/** Where an alignment ended. */
struct SurfaceAlignmentResult
{
  AffineMap map;             ///< source -> target
  double    distance{ 0.0 }; ///< root mean square of the pairs that count, mm
};

/** \brief Brings a surface onto another by iterative closest points (paper 6.1; P. J. Besl & N. D. McKay).
 *
 * Starts from the principal axes of the surfaces (area moments), whose four proper sign flips are each tried rigidly;
 * the best goes on as rigid, then similarity, then affine, as far as `kind` allows. Pairs are closest points with
 * normals that suit, from either surface to the other, so that a shape does not shrink into the other; the farthest
 * are trimmed. Deterministic. Throws std::invalid_argument for a
 * surface without area or parameters out of range. */
SurfaceAlignmentResult
AlignSurfaces(const TriangleSurface &            source,
              const DirectedSurface &            target,
              const SurfaceAlignmentParameters & parameters,
              const Execution &                  execution = {});
} // namespace bone

#endif
