/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneInteriorDeformation_h
#define boneInteriorDeformation_h

#include "bonePointAlignment.h"
#include "boneAtlasRegistrationParameters.h"
#include "boneExecution.h"
#include "boneMeshArrays.h"

#include <memory>

namespace bone
{
/** \class InteriorDeformation
 * \brief Moves the interior points of a tetrahedral mesh to where its exterior points went (paper 6.1).
 *
 * Harmonic: displacement after the alignment, by linear finite elements on the standard mesh; the matrix is factorised
 * once, here, and serves every subject. EigenFrame: for an interior point v, o and the axes F are mean and eigenvectors
 * of the covariance of its nearest exterior points, F' and o' those of their new places; v' = o' + F' F^T (v - o).
 * Signs of F' are those nearest to the alignment's rotation of F.
 *
 * Const use is safe from many threads. */
class InteriorDeformation
{
public:
  /** `exterior`: ids of the mesh's exterior points, ascending. Throws std::invalid_argument for a mesh without
   * tetrahedra. */
  InteriorDeformation(const MeshArrays & mesh, const std::vector<IdType> & exterior);
  ~InteriorDeformation();

  /** All points of the mesh; `moved` are the new places of the exterior ones, in order. */
  std::vector<Vector3>
  Deform(InteriorRule                 rule,
         const AffineMap &            alignment,
         const std::vector<Vector3> & moved,
         const Execution &            execution = {}) const;

private:
  struct Solver;

  std::vector<Vector3>
  DeformHarmonic(const AffineMap & alignment, const std::vector<Vector3> & moved) const;
  std::vector<Vector3>
  DeformByFrames(const AffineMap & alignment, const std::vector<Vector3> & moved, const Execution & execution) const;

  std::vector<Vector3>    m_Points;
  std::vector<IdType>     m_Exterior;
  std::vector<IdType>     m_Interior;
  std::unique_ptr<Solver> m_Solver;
};

} // namespace bone

#endif
