/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef bonePathPlan_h
#define bonePathPlan_h

#include "boneExecution.h"
#include "boneMeasure.h"
#include "bonePathPlanParameters.h"
#include "boneSolid.h"
#include "boneTetraLocator.h"
#include "boneTriangleDistance.h"

namespace bone
{
/** What a path meets in a bone. */
struct PathAssessment
{
  std::vector<double> along;            ///< density at points in the path that lie in bone, ascending, density units
  std::vector<double> around;           ///< the same in the shell around it
  double              boneShare{ 0.0 }; ///< of the path's points, that lie in bone

  /** mm along the axis from `from` to where the margin is reached first. NaN: nowhere. */
  double entry{ 0.0 };
  /** mm between the path and the surface, the least of what its tip has and of places beyond the entry where it has
   * come nearer to the surface again, by 0.5 mm or to within the margin; negative: it breaks through. NaN where there
   * is no entry. */
  double leastClearance{ 0.0 };
  /** mm along the axis from `from` to where the path touches the surface beyond its entry. NaN: nowhere. */
  double breakthrough{ 0.0 };

  /** Whether the path has an entry and leaves at least the margin beyond. */
  bool
  IsSafe(double margin) const
  {
    return leastClearance >= margin;
  }
  /** What a search makes as large as it can: the mean density around the path; 0 where there is none. */
  double
  MeanAround() const;
};

/** A value of an ascending list below which a share (0 to 1) of them lies, linear between them; NaN of none. */
double
Percentile(const std::vector<double> & ascending, double share);

/** \class PathPlanner
 * \brief Assesses paths of screws or stems in a bone: capsules that enter at `from` and end at `to`.
 *
 * Densities are taken at points a millimetre apart along the axis: 24 in the path, 24 in the shell around it, each for
 * the same area. Clearance is the distance of the axis to the bone's surface less the radius, at places 0.25 mm apart,
 * so it may be less by 0.125 mm between them; the entry is the part of the path before the margin is reached for the
 * first time, as no path can enter and keep clear.
 *
 * The mesh must outlive this. Const use is safe from many threads. */
class PathPlanner
{
public:
  /** Throws std::invalid_argument where the mesh holds no density, and itk::ExceptionObject where its boundary is no
   * closed surface. */
  explicit PathPlanner(const MeshArrays & mesh);

  /** Throws std::invalid_argument where the path has no length. */
  PathAssessment
  Assess(const Capsule & path, double margin, double shell) const;

  /** \brief The safe path that has the densest bone around it.
   *
   * Paths within the parameters' bounds about `start`: on a grid of five places of either shift and either angle and
   * three depths, then by halving steps around the best, until a step is below a fiftieth of the bound. The result does
   * not depend on the number of threads. Returns false, and leaves `best` as `start`, where no path of the grid is
   * safe. */
  bool
  Search(const Capsule &            start,
         const PathPlanParameters & parameters,
         Capsule &                  best,
         const Execution &          execution = {}) const;

private:
  void
  AssessClearance(const Capsule & path, double margin, PathAssessment & found) const;
  double
  DensityIn(const Vector3 & x, IdType & hint) const;

  const MeshArrays & m_Mesh;
  TetraLocator       m_Locator;
  TriangleDistance   m_Surface;
};

/** \brief A path's measures, and where `search` is set those of the safe path found instead of it.
 *
 * NAME.from, .to, .radius; .volume, .mass, .meanDensity of the bone in it; .densityAlongMean, .densityAlongPercentiles,
 * .densityAroundMean, .densityAroundPercentiles (5, 25, 50, 75, 95 %), .boneShare, .entry, .leastClearance,
 * .breakthrough, .safe (yes, no), and with a search .search (found, none). Throws as PathPlanner. */
MeasureList
PlanPath(const MeshArrays &         mesh,
         const Capsule &            path,
         bool                       search,
         const PathPlanParameters & parameters = PathPlanParameters(),
         const std::string &        name = "path",
         const Execution &          execution = {});
} // namespace bone

#endif
