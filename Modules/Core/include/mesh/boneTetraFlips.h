/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneTetraFlips_h
#define boneTetraFlips_h

#include "boneExecution.h"
#include "boneParameters.h"
#include "boneTetraComplex.h"

#include <functional>

namespace bone
{
/** What a flip did. */
struct FlipResult
{
  MeshOperation       outcome{ MeshOperation::Quality };
  std::vector<IdType> removed; ///< slots of the cells that were replaced
  std::vector<IdType> created; ///< slots of the new cells (removed slots are reused)
};

/** Whether cells may come. */
using FlipGuard = std::function<bool(const std::vector<Id4> & created)>;

/** Longest ring of cells around an edge that RemoveEdge looks at. */
constexpr int MaximumEdgeRing = 9;

/** \brief 2-3 flip: the two cells at face i of cell t become three around the edge that joins their apices.
 *
 * Refused where the face belongs to an interface or the boundary, where a new cell would not be positive (exact), and
 * where the smallest dihedral angle of the touched cells would not rise by more than the factor `1 + gain` (of its
 * cosine's distance to 1), and where the guard, if there is one, does not let the new cells come (Density). The mesh is
 * unchanged unless `outcome` is Done. */
FlipResult
RemoveFace(TetraComplex & complex, IdType t, int i, const FlipGuard & guard = {});

/** \brief Edge removal: the n cells around edge (a, b) become 2 (n - 2); n = 3 is the 3-2 flip, n = 4 the 4-4 flip.
 *
 * The ring is triangulated so that the worst new cell is as good as can be (dynamic programming: Klincsek 1980; J. R.
 * Shewchuk, "Two discrete optimization algorithms for the topological improvement of tetrahedral meshes", 2002).
 * Refused as RemoveFace, for an edge on an interface or the boundary, and for rings over MaximumEdgeRing. */
FlipResult
RemoveEdge(TetraComplex & complex, IdType a, IdType b);

/** A flip of a surface edge that could be made: see \ref PlanSurfaceFlip. */
struct SurfaceFlip
{
  MeshOperation         outcome{ MeshOperation::Surface };
  std::array<IdType, 2> edge{};    ///< a, b: the edge that goes
  std::array<IdType, 2> corners{}; ///< c, d: the ends of the surface edge that comes
  int                   surface{ -1 };
  std::vector<IdType>   removed;
  std::vector<Id4>      created;
  std::vector<int>      regions; ///< of the new cells
};

/** \brief Flip of an edge (a, b) of the boundary or an interface: the surface's triangles (a, b, c) and (a, b, d)
 * become (a, c, d) and (b, c, d), and the cells on each side of the surface are those of the best triangulation of
 * their ring.
 *
 * A side of one cell has no new cells: it goes over to the other side, or is peeled off the body. `outcome` is Done
 * where all new cells are positive (exact) and the worst of them is better than the worst old one, or than the angle of
 * the cosine `enough` (-1: none is); Surface where the
 * edge is part of a curve, or a side of one cell is part of another surface; Topology where c and d are joined already.
 * Whether the surface stays near its place and off itself is not looked at. Made by TetraComplex::ReplaceAcross. */
SurfaceFlip
PlanSurfaceFlip(const TetraComplex & complex, IdType a, IdType b, double enough = -1.0);

/** Cosine of the smallest dihedral angle of a living cell: the larger the worse. */
double
CellCosine(const TetraComplex & complex, IdType t);

/** What flips may do to the number of cells. */
enum class FlipCellCount : int
{
  Any,
  NotMore,
  Same
};

// clang-format off
#define BONE_TETRA_SWAP_PARAMETERS(value, flag) \
  value(double, targetAngle, TargetAngle, 0.35, ParameterRange::Above(0.0, 1.23), "rad", "target-angle", \
    "Cells whose smallest dihedral angle is below are swapped") \
  value(int, maximumPasses, MaximumPasses, 6, ParameterRange::AtLeast(0), "", "passes", \
    "Passes over those cells; a pass without a flip ends it")
// clang-format on

/** Parameters of TetraSwapFilter. */
BONE_PARAMETER_STRUCT(TetraSwapParameters, BONE_TETRA_SWAP_PARAMETERS);

/** Parameters of \ref ImproveByFlips. */
struct FlipParameters : TetraSwapParameters
{
  FlipCellCount cellCount{ FlipCellCount::Any };
  IdType        minimumCells{ 0 }; ///< no flip makes fewer cells than this
  FlipGuard     guard{};           ///< none: all flips are allowed
};

struct FlipReport
{
  std::size_t done{ 0 };
  std::size_t refused[MeshOperationCount]{};
};

/** Called after each flip that was done. */
using FlipObserver = std::function<void(const FlipResult &)>;

/** \class FlipMemory
 * \brief When flips were refused, by the clock of one complex: a flip is tried again once a cell that it would touch
 * has changed. */
class FlipMemory
{
public:
  /** Makes room for all slots of cells. */
  void
  Reserve(const TetraComplex & complex);
  bool
  IsEdgeRefused(const TetraComplex & complex, IdType t, int edge) const;
  bool
  IsFaceRefused(const TetraComplex & complex, IdType t, int face) const;
  bool
  IsCellRefused(const TetraComplex & complex, IdType t) const;
  void
  RefuseEdge(const TetraComplex & complex, IdType t, IdType a, IdType b);
  /** Of both cells at the face. */
  void
  RefuseFace(const TetraComplex & complex, IdType t, int face);
  /** All flips that remove an edge or a face of the cell. */
  void
  RefuseCell(const TetraComplex & complex, IdType t);

private:
  struct Times
  {
    std::array<std::uint32_t, 6> edges{};
    std::array<std::uint32_t, 4> faces{};
    std::uint32_t                cell{ 0 };
  };

  static int
  EdgeOf(const TetraComplex & complex, IdType t, IdType a, IdType b);

  std::vector<Times> m_Cells;
};

/** Flips at cells below the target angle, the worst first, until a pass changes nothing. Every flip strictly raises the
 * smallest angle of the cells it touches.
 * \param memory  of earlier calls with the same complex and kind of flips, if they are to be remembered. */
FlipReport
ImproveByFlips(TetraComplex &         complex,
               const FlipParameters & parameters,
               const FlipObserver &   observer = {},
               FlipMemory *           memory = nullptr,
               const Execution &      execution = {});
} // namespace bone

#endif
