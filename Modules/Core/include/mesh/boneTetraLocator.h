/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneTetraLocator_h
#define boneTetraLocator_h

#include "boneBernstein.h"
#include "boneMeshArrays.h"
#include "boneTriangleTree.h"

#include <vector>

namespace bone
{
/** A point's place in a mesh. */
struct CellLocation
{
  IdType      cell{ -1 };                ///< -1: in no tetrahedron
  Barycentric mu{ Barycentric::Zero() }; ///< coordinates in that tetrahedron
  double      distance{ 0.0 };           ///< mm from the point asked for to the place given

  bool
  Found() const
  {
    return cell >= 0;
  }
};

/** \class TetraLocator
 * \brief Finds the tetrahedron that a point lies in.
 *
 * A uniform grid lists the tetrahedra of every box, so that a search from nowhere looks at a handful; given a
 * tetrahedron nearby it walks from neighbour to neighbour first. Containment is decided by exact predicates where
 * rounding could matter: every point of the closed body is found, and a point on a shared face, edge or vertex always
 * belongs to the tetrahedron of lowest id among those that share it, whatever the hint (in a valid mesh, whose
 * tetrahedra overlap nowhere). Flat and inverted tetrahedra contain nothing.
 *
 * Building is O(#t); it copies what it needs of the mesh. Const use is safe from many threads. */
class TetraLocator
{
public:
  /** Uses points, tetrahedra and neighbours (computed where absent). Throws std::invalid_argument where a point is not
   * finite. */
  explicit TetraLocator(const MeshArrays & mesh);

  /** The tetrahedron that contains x. `hint`: a tetrahedron to start from, -1 for none; it changes the speed only. */
  CellLocation
  Find(const Vector3 & x, IdType hint = -1) const;

  /** As Find(), and for a point outside the body the nearest place on its boundary, with its distance. Nothing is found
   * in a mesh without tetrahedra only. */
  CellLocation
  FindNearest(const Vector3 & x, IdType hint = -1) const;

  const MeshArrays &
  GetMesh() const
  {
    return m_Mesh;
  }

private:
  /** What a quick test needs: mu_1..3 = inverse (x - point 0). */
  struct Cell
  {
    Eigen::Matrix3d inverse;
    Vector3         lower;
    Vector3         upper;
    double          tolerance; // bound on mu's rounding error inside the box; infinite: contains nothing
  };

  void
  BuildCells();
  void
  BuildGrid();
  void
  BuildBoundary();
  template <typename TVisitor>
  void
  VisitBoxes(IdType t, const TVisitor & visit) const;
  Barycentric
  Coordinates(IdType t, const Vector3 & x) const;
  bool
  Contains(IdType t, const Vector3 & x, Barycentric & mu) const;
  bool
  WalkTo(const Vector3 & x, IdType start, CellLocation & location) const;
  int
  GridIndex(int axis, double x) const;

  MeshArrays          m_Mesh; // points, tetrahedra and neighbours only
  std::vector<Cell>   m_Cells;
  Vector3             m_Lower{ Vector3::Zero() };
  Vector3             m_Upper{ Vector3::Zero() };
  Vector3             m_BoxesPerMm{ Vector3::Zero() };
  std::array<int, 3>  m_Size{ { 0, 0, 0 } };
  std::vector<IdType> m_Start; // of each box's tetrahedra in m_List
  std::vector<IdType> m_List;  // ids, ascending within a box

  std::vector<std::pair<IdType, int>> m_BoundaryFace; // tetrahedron and side of each triangle of the tree
  TriangleTree                        m_Boundary;
};
} // namespace bone

#endif
