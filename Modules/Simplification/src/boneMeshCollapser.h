/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneMeshCollapser_h
#define boneMeshCollapser_h

#include "boneAngleImprovement.h"
#include "boneCellFits.h"
#include "boneDensitySamples.h"
#include "boneExecution.h"
#include "boneRegionVolumes.h"
#include "boneSurfaceEnvelope.h"
#include "boneSurfaceGrid.h"
#include "boneSurfaceSamples.h"
#include "boneTetraCollapseParameters.h"
#include "boneTetraComplex.h"
#include "boneTetraFlips.h"

#include <limits>
#include <memory>
#include <optional>
#include <queue>
#include <vector>

namespace bone
{
/** \class MeshCollapser
 * \brief Half-edge collapses v -> w from a priority queue (paper 4).
 *
 * The queue holds points. A point's cost is that of its best target w; it is computed when the point comes to the head
 * of the queue and something around it has changed (lazily), and the point goes back where the cost has grown.
 * A collapse is refused, by reason, where v would leave its surface or curve, where the link condition fails, where a
 * changed tetrahedron would not be positive (exact), where a dihedral angle would fall both below the floor and below
 * what it was, where the boundary would pass through itself, and beyond the bounds on volume and on distance
 * (\ref SurfaceEnvelope).
 *
 * Cost of v -> w = densityWeight R(v) / range^2 + surfaceWeight S(v, w) + volumeWeight sum of ((E + dV)^2 - E^2) / V
 * + 0.01 V (1 - angle / 25 degrees)^2 + 0.001 |v - w|^3, and with ImproveAngles 0.3 V (1 - angle / wanted)^2 where an
 * angle is below that wanted, and V (length / (4 e) - 1)^2 where an edge is longer than 4 e, e that of
 * equilateral tetrahedra in the mesh's number, as cells that are long along a shaft are too stiff in bending: R from
 * \ref DensitySamples::RemovalCost, S from \ref SurfaceSamples::CollapseCost, E and dV the volume error so far and the
 * change of each region of volume V. */
class MeshCollapser
{
public:
  MeshCollapser(const MeshArrays & mesh, const TetraCollapseParameters & parameters, const Execution & execution);

  /** Collapses until no more than \a target cells or nothing allowed is left. Returns the number of collapses. A
   * collapser whose run, or flips, were aborted must not be used any more. */
  std::size_t
  Run(IdType target, const Execution & execution);

  /** Flips at cells below the angle (rad), which make no fewer cells than \a minimumCells. Returns their number. */
  std::size_t
  Flip(double angle, FlipCellCount cellCount, IdType minimumCells, const Execution & execution);

  /** Gives cells the angles wanted (\ref AngleImprovement), and neither makes more cells than there are nor fewer than
   * `target`. \pre There is no bound on distances. */
  void
  ImproveAngles(IdType target, const Execution & execution);

  /** Dihedral angles that collapses leave from now on where they are not smaller already; first those of the
   * parameters.
   */
  void
  SetFloors(const AngleFloors & floors);
  AngleFloors
  WantedAngles() const;
  /** The floors of the parameters. */
  AngleFloors
  LeastAngles() const;

  /** Bound on the distance of boundary and interfaces to those of the finest level, both ways, mm; default infinity.
   * Must not descend. \pre The parameters hold bounds on it. */
  void
  SetMaximumDistance(double distance);

  /** Bound on the density error of each new cell (\ref CellFits), density units; default infinity. Must not descend.
   * \pre The parameters hold bounds on it. */
  void
  SetMaximumCellError(double error);

  /** The fits of cells by the finest level; null where no bound on their errors is held by the parameters. */
  const CellFits *
  Fits() const
  {
    return m_Fits.get();
  }

  const TetraComplex &
  Complex() const
  {
    return m_Complex;
  }
  const DensitySamples &
  Densities() const
  {
    return m_Densities;
  }
  /** Where nothing was left to collapse: Density where the bound on cells refuses any, else the bound that refuses most
   * candidates, Distance or Volume; Done where none refuses any. */
  MeshOperation
  StoppedBy() const
  {
    return m_StoppedBy;
  }
  /** Refused candidates by \ref MeshOperation. */
  const std::array<std::size_t, MeshOperationCount> &
  Refused() const
  {
    return m_Refused;
  }
  /** 1 for each slot that was written since the last call of ClearChanged. */
  const std::vector<char> &
  Changed() const
  {
    return m_Changed;
  }
  void
  ClearChanged();

private:
  struct Entry
  {
    double cost;
    IdType v;

    bool
    operator<(const Entry & other) const // the queue gives the largest
    {
      return cost != other.cost ? cost > other.cost : v > other.v;
    }
  };
  using Counts = std::array<std::size_t, MeshOperationCount>;
  struct Candidate
  {
    double cost{ 0.0 };
    IdType w{ -1 };
    Counts refused{}; ///< targets by \ref MeshOperation
  };
  /** Largest cosines of dihedral angles that cells may have. */
  struct Limits
  {
    double cortical;
    double other;
  };
  enum class State : std::uint8_t
  {
    Queued,
    Parked, ///< nothing allowed; looked at again when something around it has changed and the queue is empty
    Gone
  };

  Candidate
  FindBest(IdType v) const;
  void
  SetBest(IdType v, const Candidate & best);
  /** \param volumes  change of each region. */
  MeshOperation
  Rate(IdType v, IdType w, double densityCost, const Limits & limits, std::vector<double> & volumes, double & cost)
    const;
  /** Of tetrahedra that fill the mesh in the number there is, mm. */
  double
  EquilateralEdge() const;
  Limits
  LimitsAround(IdType v) const;
  MeshOperation
  CheckExactly(IdType v, IdType w) const;
  MeshOperation
  CheckVolume(IdType v, const std::vector<double> & volumes, double & cost) const;
  bool
  BoundaryCrosses(IdType v, IdType w) const;
  void
  Commit(IdType v, IdType w);
  void
  UpdateGrid(IdType v, bool insert);
  bool
  KeepsCellErrors(IdType v, IdType w);
  bool
  IsWithinCellError(const Id4 & cell, IdType near) const;
  void
  RateAll(const Execution & execution);
  void
  Refresh(IdType minimumCells, const Execution & execution);
  bool
  Requeue();
  void
  NoteWhyParked(const Execution & execution);
  void
  FillGrid();
  void
  RequeueAll();

  TetraComplex                            m_Complex;
  std::shared_ptr<const AngleImprovement> m_Improvement; ///< none: angles are not improved
  AngleFloors                             m_Floors;
  DensitySamples                          m_Densities;
  SurfaceSamples                          m_SurfaceSamples;
  TetraCollapseParameters                 m_Parameters;
  double                                  m_FirstEdge; ///< of the finest boundary, mean, mm
  SurfaceGrid                             m_Grid;
  RegionVolumes                           m_Volumes;      ///< of the finest level
  std::vector<double>                     m_VolumeErrors; ///< change of each since then, mm^3
  std::priority_queue<Entry>              m_Queue;
  std::vector<State>                      m_State;
  std::vector<char>                       m_Dirty;
  std::vector<IdType>                     m_Target;
  std::vector<double>                     m_Cost;
  std::vector<std::size_t>                m_Epoch; ///< number of collapses when the cost was computed
  std::size_t                             m_Collapses{ 0 };
  IdType                                  m_RefreshAt{ 0 };   ///< number of cells
  bool                                    m_Stale{ false };   ///< parked points may be allowed by now
  bool                                    m_IsRated{ false }; ///< all points have been, once
  std::vector<char>                       m_Changed;
  std::optional<SurfaceEnvelope>          m_Envelope;
  double                                  m_MaximumDistance{ std::numeric_limits<double>::infinity() };
  std::shared_ptr<const CellFits>         m_Fits;
  double                                  m_MaximumCellError{ std::numeric_limits<double>::infinity() };
  std::vector<IdType>                     m_RefusedTarget; ///< of each point, by the bound on cells; -1: none
  std::vector<std::uint32_t>              m_RefusedAt;     ///< by the complex' clock
  MeshOperation                           m_StoppedBy{ MeshOperation::Done };
  Counts                                  m_Refused{};
};
} // namespace bone

#endif
