/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneMeshArrays_h
#define boneMeshArrays_h

#include "boneTypes.h"

#include <vector>

namespace bone
{
/** \struct MeshCells
 * \brief A layered tetrahedral density mesh without the positions of its points, as plain arrays.
 *
 * Index p runs over points, t over tetrahedra. Arrays of attributes are either empty or of full length. */
struct MeshCells
{
  std::vector<Id4> tetrahedra; ///< #t, positive orientation: (b-a) x (c-a) . (d-a) > 0
  std::vector<Id4> neighbors;  ///< #t, neighbour i lies across the face opposite vertex i, -1 at the boundary
  std::vector<int> layer;      ///< #p, 0 on the exterior contour, counting inward
  std::vector<int> slice;      ///< #p, index of the slice the point was tiled on
  std::vector<int> region;     ///< #t, see \ref Region
  std::vector<int> degree;     ///< #t, degree of each tetrahedron's Bernstein polynomial; empty: no density

  /** Bernstein coefficients, #t rows of BernsteinCount(maximumDegree), row-major; a tetrahedron of lower degree uses
   * the first BernsteinCount(degree) of its row, the rest are 0. Order: see \ref Bernstein. */
  std::vector<double> coefficients;
  int                 maximumDegree{ -1 }; ///< -1: the mesh holds no density
  DensityQuantity     quantity{ DensityQuantity::Unknown };

  bool
  HasDensity() const
  {
    return maximumDegree >= 0;
  }
};

/** \struct MeshArrays
 * \brief A layered tetrahedral density mesh as plain arrays: what kernels work on.
 *
 * \ref DensityMesh is the same content as an itk::DataObject. */
struct MeshArrays : MeshCells
{
  std::vector<Vector3> points; ///< #p, mm
};

/** Face neighbours from the tetrahedra alone. A face met by more than two tetrahedra is left as -1 on all of them (the
 * validator names such faces). O(#t log #t), deterministic. */
std::vector<Id4>
ComputeFaceNeighbors(const std::vector<Id4> & tetrahedra);

/** Removes points that no tetrahedron uses and renumbers; order is kept. Returns for each new point its old id. */
std::vector<IdType>
RemoveUnusedPoints(MeshArrays & mesh);

/** Signed volume in mm^3. */
inline double
SignedVolume(const Vector3 & a, const Vector3 & b, const Vector3 & c, const Vector3 & d)
{
  return (b - a).cross(c - a).dot(d - a) / 6.0;
}

/** Boundary faces of the tetrahedra whose region is at least minimumRegion (0: all), oriented outward. Needs
 * neighbors; region too where minimumRegion > 0. */
std::vector<std::array<IdType, 3>>
BoundaryFaces(const MeshArrays & mesh, int minimumRegion = 0);
} // namespace bone

#endif
