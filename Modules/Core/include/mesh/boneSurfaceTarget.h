/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneSurfaceTarget_h
#define boneSurfaceTarget_h

#include "boneTetraComplex.h"
#include "boneTriangleTree.h"

#include <vector>

namespace bone
{
/** \class SurfaceTarget
 * \brief The faired boundary, interfaces and curves of a mesh: where smoothing puts points back (paper 2.7).
 *
 * Steps between slices are faired along the surfaces, and along curves where surfaces meet, by descent on the energy of
 * the umbrella operator: x - 0.4 U(U x), which keeps volume far better than a Laplacian (U x: mean of the neighbours
 * less x). Corners and the inside of flat cuts stay. No point is moved by more than the bound, so that every point of a
 * target surface lies within the bound of the surface it was made from. The target is made once and does not move with
 * the mesh. */
class SurfaceTarget
{
public:
  /** \param distanceBound      mm, not negative; 0: the surfaces as they are.
   * \param fairingIterations  steps. */
  SurfaceTarget(const TetraComplex & complex, double distanceBound, int fairingIterations);

  /** The point of p's own surface (dimension 2) or curve (1) that is nearest to x; x itself for an inner point (3), and
   * p's own place for a corner (0). */
  Vector3
  Project(const TetraComplex & complex, IdType p, const Vector3 & x) const;

  /** Where a surface point is to go whose neighbours have the mean x. On ridges and tips, where the surface bends too
   * sharply for the mean to lie near it, that is the point's own faired place: sliding down would cut them off. */
  Vector3
  Place(const TetraComplex & complex, IdType p, const Vector3 & x) const
  {
    return complex.Dimension(p) < 3 && m_IsRidge[p] ? m_Faired[p] : Project(complex, p, x);
  }

  /** Where fairing alone puts a point of the mesh that the target was made from. */
  const Vector3 &
  Faired(IdType p) const
  {
    return m_Faired[p];
  }

  /** Whether a surface lies within a distance, given squared (mm^2), of x. */
  bool
  IsWithin(int surface, const Vector3 & x, double squaredDistance) const;

  /** The point of a surface nearest to x. */
  Vector3
  Nearest(int surface, const Vector3 & x) const;

private:
  std::vector<Vector3>
  Fair(const TetraComplex & complex, double distanceBound, int iterations) const;
  void
  FindRidges(const TetraComplex & complex);
  void
  BuildTrees(const TetraComplex & complex);

  std::vector<Vector3>      m_Faired;  ///< #p
  std::vector<char>         m_IsRidge; ///< #p
  std::vector<int>          m_Stratum; ///< #p, index of the tree, -1 for none
  std::vector<TriangleTree> m_Trees;
  std::vector<int>          m_TreeOfSurface; ///< index of the tree
};
} // namespace bone

#endif
