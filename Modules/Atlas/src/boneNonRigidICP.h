/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneNonRigidICP_h
#define boneNonRigidICP_h

#include "boneDirectedSurface.h"
#include "boneExecution.h"

namespace bone
{
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
                  const NonRigidICPParameters & parameters,
                  const Execution &             execution = {});
} // namespace bone

#endif
