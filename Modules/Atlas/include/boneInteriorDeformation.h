/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneInteriorDeformation_h
#define boneInteriorDeformation_h

#include "bonePointAlignment.h"
#include "boneMeshArrays.h"

#include <memory>

namespace bone
{
/** How interior points follow the exterior surface. */
enum class InteriorRule : int
{
  Harmonic = 0,  ///< what the affine alignment leaves is a displacement that solves Laplace's equation
  EigenFrame = 1 ///< the paper's: same coordinates in the eigenvectors' frame of the nearest exterior points
};

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
  Deform(InteriorRule rule, const AffineMap & alignment, const std::vector<Vector3> & moved) const;

private:
  struct Solver;

  std::vector<Vector3>
  DeformHarmonic(const AffineMap & alignment, const std::vector<Vector3> & moved) const;
  std::vector<Vector3>
  DeformByFrames(const AffineMap & alignment, const std::vector<Vector3> & moved) const;

  std::vector<Vector3>    m_Points;
  std::vector<IdType>     m_Exterior;
  std::vector<IdType>     m_Interior;
  std::unique_ptr<Solver> m_Solver;
};

/** Parameters of \ref UntangleMesh. */
struct UntanglingParameters
{
  double exteriorBound{ 0.5 }; ///< how far an exterior point may move, mm
  int    iterations{ 200 };    ///< passes over the points around bad cells
  double floor{ 0.02 };        ///< volume relative to that of the alignment below which a cell is worked on
};

/** What an untangling did. */
struct UntanglingReport
{
  std::size_t before{ 0 }; ///< flat or inverted cells
  std::size_t after{ 0 };
  std::size_t moved{ 0 };      ///< points
  double      exterior{ 0.0 }; ///< largest move of an exterior point, mm
};

/** \brief Makes inverted tetrahedra positive by moving the points around them, exterior ones by a bounded distance.
 *
 * Minimises the mean-ratio distortion of the cells against those of `rest` under `alignment`, with the volume
 * regularised so that it is finite for inverted cells (J. M. Escobar et al., doi:10.1016/S0045-7825(03)00299-8), point
 * by point by damped Newton steps. Nothing is touched where no cell is flat, inverted or below the floor.
 * Deterministic.
 *
 * `points` are changed; cells and neighbours are those of `rest`. */
UntanglingReport
UntangleMesh(const MeshArrays &           rest,
             const std::vector<IdType> &  exterior,
             const AffineMap &            alignment,
             std::vector<Vector3> &       points,
             const UntanglingParameters & parameters = UntanglingParameters());
} // namespace bone

#endif
