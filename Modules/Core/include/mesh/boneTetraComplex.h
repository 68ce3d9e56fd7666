/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneTetraComplex_h
#define boneTetraComplex_h

#include "boneSurfaceComplex.h"

#include <cstdint>
#include <vector>

namespace bone
{
/** Why a local operation on a mesh was made or refused. */
enum class MeshOperation : int
{
  Done = 0,
  Surface,     ///< would cross an interface, leave the boundary, or cut off a rim
  Topology,    ///< the link condition fails: the complex or one of its surfaces would change its topology
  Orientation, ///< a tetrahedron would become flat or inverted (exact)
  Quality,     ///< the worst touched tetrahedron would not get better, or falls below the quality asked for
  Overlap,     ///< the boundary would pass through itself
  Density,     ///< beyond the bound on the density error
  Distance,    ///< beyond the bound on the distance of boundary and interfaces
  Volume       ///< beyond the bound on the change of a region's volume
};
constexpr int MeshOperationCount = 9;

/** One or two words for reports ("topology", ...). */
const char *
MeshOperationName(MeshOperation operation);

/** \class TetraComplex
 * \brief A tetrahedral mesh whose cells may be replaced: what flips and collapses work on.
 *
 * Cells keep their face neighbours, the surface of each face, and each point knows the cells around it. Removed cells
 * stay as dead slots until they are reused or Compact() is called. All orders are determined by the input alone. Not to
 * be used by several threads at once. */
class TetraComplex
{
public:
  /** Takes points, tetrahedra, regions and neighbours (computed where absent). */
  explicit TetraComplex(const MeshArrays & mesh);

  const std::vector<Vector3> &
  Points() const
  {
    return m_Points;
  }
  /** Moves a point: all cells around it have changed then. */
  void
  MovePoint(IdType p, const Vector3 & x)
  {
    m_Points[p] = x;
    NoteChange(m_Star[p]);
  }
  /** Puts a point somewhere for a trial, of which the mesh takes no note; MovePoint or another trial must end it. */
  void
  TryPoint(IdType p, const Vector3 & x)
  {
    m_Points[p] = x;
  }
  /** Changes so far, by which the next can be told from those before: counts from 1. */
  std::uint32_t
  Clock() const
  {
    return m_Clock;
  }
  /** Whether a cell at the point has come, gone or changed its shape after the clock stood at `time`. */
  bool
  HasChanged(IdType p, std::uint32_t time) const
  {
    return m_Changed[p] > time;
  }
  IdType
  Size() const
  {
    return static_cast<IdType>(m_Cells.size());
  }
  IdType
  AliveCells() const
  {
    return m_AliveCount;
  }
  bool
  IsAlive(IdType t) const
  {
    return m_Cells[t][0] >= 0;
  }
  const Id4 &
  Cell(IdType t) const
  {
    return m_Cells[t];
  }
  const Id4 &
  Neighbors(IdType t) const
  {
    return m_Neighbors[t];
  }
  /** Surface of each face of a cell, -1 for none. */
  const Id4 &
  FaceSurfaces(IdType t) const
  {
    return m_Surfaces.faceSurface[t];
  }
  int
  Region(IdType t) const
  {
    return m_Region[t];
  }
  const SurfaceComplex &
  Surfaces() const
  {
    return m_Surfaces;
  }
  int
  Dimension(IdType p) const
  {
    return m_Surfaces.dimension[p];
  }
  /** Living cells around a point. Ascending where the point was not yet touched by an operation. */
  const std::vector<IdType> &
  Star(IdType p) const
  {
    return m_Star[p];
  }
  /** Position of point p in cell t, which has it. */
  int
  LocalIndex(IdType t, IdType p) const
  {
    const Id4 & c = m_Cells[t];
    return c[0] == p ? 0 : c[1] == p ? 1 : c[2] == p ? 2 : 3;
  }
  bool
  Has(IdType t, IdType p) const
  {
    const Id4 & c = m_Cells[t];
    return c[0] == p || c[1] == p || c[2] == p || c[3] == p;
  }

  /** Living cells that have both points, in the order of a's star. */
  std::vector<IdType>
  EdgeStar(IdType a, IdType b) const;

  /** Points joined to p by an edge, in order of discovery. */
  std::vector<IdType>
  PointNeighbors(IdType p) const;

  /** Points joined to p by an edge of a surface face, and each surface face around p once as (p, a, b), outward from
   * the cell that carries it: the cell at the boundary, that of the smaller region at an interface. */
  struct SurfaceFace
  {
    IdType a;
    IdType b;
    int    surface;
    IdType cell;
  };
  void
  SurfaceStar(IdType p, std::vector<SurfaceFace> & faces) const;

  /** Whether the cell carries its face i: counts a surface face once. */
  bool
  Carries(IdType t, int i) const
  {
    const int s = m_Surfaces.faceSurface[t][i];
    return s >= 0 && (m_Neighbors[t][i] < 0 || m_Region[t] == m_Surfaces.surfaces[s].outer);
  }

  /** Replaces cells of one region by others that fill the same space: same outer faces, no new points. `removed` holds
   * living cells; the new cells' ids are returned, the slots of removed cells first. */
  std::vector<IdType>
  Replace(const std::vector<IdType> & removed, const std::vector<Id4> & created);

  /** \brief Replaces the cells around a surface edge, so that the surface turns to its other diagonal.
   *
   * As Replace(), but cells of two regions: `regions` are those of the new cells, and new faces between regions, or
   * between a region and outside, become faces of `surface`. */
  std::vector<IdType>
  ReplaceAcross(const std::vector<IdType> & removed,
                const std::vector<Id4> &    created,
                const std::vector<int> &    regions,
                int                         surface);

  /** \brief Puts a new point at x on an edge within a region: each cell around the edge becomes two.
   *
   * \pre No surface face has the edge. Returns the new point, which has dimension 3; geometry is not looked at. */
  IdType
  SplitEdge(IdType a, IdType b, const Vector3 & x);

  /** \brief Whether the half-edge collapse v -> w keeps the topology of the body, its surfaces and its curves.
   *
   * Link condition for the complex with its strata, outside being one more region: T. K. Dey, H. Edelsbrunner, S. Guha,
   * D. V. Nekhayev, "Topology preserving edge contraction", Publ. Inst. Math. 66 (1999). Returns Done, Surface (v may
   * not leave its stratum) or Topology. Geometry is not looked at. */
  MeshOperation
  CanCollapse(IdType v, IdType w) const;

  /** Collapses v onto w. \pre CanCollapse(v, w) == Done. Returns the changed cells, which now have w. */
  std::vector<IdType>
  Collapse(IdType v, IdType w);

  /** Tetrahedra, regions and neighbours of the living cells in order of their slots, and the points that they use.
   * Attributes of points and cells are taken from `source`, the mesh this was made of; densities are not. A point that
   * was added within region r has layer r, as a medial axis there, and the slice of an end of the edge it was put on.
   * The old id of each point is returned in `pointId`, and of each cell its slot in `cellSlot`. */
  MeshArrays
  Compact(const MeshArrays & source, std::vector<IdType> & pointId, std::vector<IdType> & cellSlot) const;

private:
  /** A face around a set of cells that is replaced. */
  struct OuterFace
  {
    std::array<IdType, 3> key; ///< ascending
    IdType                neighbor;
    int                   surface;
    bool                  inner; ///< between two new cells
    bool                  used;
  };

  bool
  LinksMeetInEdgeLink(IdType v, IdType w) const;
  std::vector<IdType>
  AllocateSlots(const std::vector<IdType> & removed, std::size_t count);
  void
  LinkFaces(const std::vector<IdType> & cells, std::vector<OuterFace> & outer, int surface);
  std::vector<OuterFace>
  TakeOut(const std::vector<IdType> & removed);
  void
  EraseFromStar(IdType p, IdType t);
  void
  NoteChange(const std::vector<IdType> & cells);
  void
  SetNeighbor(IdType t, IdType oldNeighbor, IdType newNeighbor, int surface);

  std::vector<Vector3>             m_Points;
  std::vector<Id4>                 m_Cells;
  std::vector<Id4>                 m_Neighbors;
  std::vector<int>                 m_Region;
  SurfaceComplex                   m_Surfaces;
  std::vector<std::vector<IdType>> m_Star;
  std::vector<IdType>              m_Parent; ///< of each added point, an end of the edge it was put on
  IdType                           m_AliveCount{ 0 };
  std::uint32_t                    m_Clock{ 1 };
  std::vector<std::uint32_t>       m_Changed; ///< of points: the clock when a cell there last changed
};

/** Mean length of the boundary's edges, mm; 1 where there are none. */
double
MeanBoundaryEdge(const TetraComplex & complex);

/** Triangles of the boundary, outward. */
std::vector<std::array<IdType, 3>>
BoundaryFaces(const TetraComplex & complex);
} // namespace bone

#endif
