/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneLevelDensity_h
#define boneLevelDensity_h

#include "boneCellFits.h"
#include "boneDensityFitKernel.h"
#include "boneDensitySamples.h"
#include "boneExecution.h"
#include "boneTetraLocator.h"

#include <map>
#include <vector>

namespace bone
{
/** \class LevelDensity
 * \brief The density of a new level: cells that did not change keep theirs, the others are fitted to the level before.
 *
 * A point of a changed cell that lies outside the level before has the density of the nearest place of its boundary.
 * Errors are measured at the samples of the finest level. The same result for any number of threads. */
class LevelDensity
{
public:
  /** \param before      the level before, with density.
   * \param parentCell  for each cell of the new level its cell in \a before if it did not change, otherwise -1.
   * \param cellSlot    for each cell of the new level its slot in \a samples.
   * \param sampleCell  for each sample its cell in \a before: where the search begins.
   * All but the execution must live as long as this. */
  LevelDensity(const MeshArrays &          before,
               const std::vector<IdType> & parentCell,
               const std::vector<IdType> & cellSlot,
               const DensitySamples &      samples,
               const std::vector<IdType> & sampleCell,
               const Execution &           execution);

  /** Writes degree, coefficients and quantity of a level; changed cells get the degree asked for. */
  void
  Fit(MeshArrays & level, int degree) const;

  /** \brief Raises the degree of changed cells, those of the largest error first and one step at a time, until the
   * error of the level is no more than \a bound or nothing is left to raise.
   *
   * A cell keeps its lower degree where the higher one does not make it better. Returns the error. */
  double
  Elevate(MeshArrays & level, double bound, int maximumDegree) const;

  /** \brief Fits changed cells to the finest level in place of the level before, with the lowest degree that keeps to
   * the bound on their errors.
   *
   * Returns the largest error of a changed cell. */
  double
  FitWithin(MeshArrays & level, const CellFits & fits, double bound) const;

  /** Root mean square difference of a level's density to the samples of the finest, in density units; as those are few,
   * it may be some percent too low. */
  double
  Error(const MeshArrays & level) const;

  /** The same by integration over the finest level, at 24 points a cell that are spread evenly over the mesh as a
   * whole: within 3 % on 500 cells, less on more. */
  double
  IntegratedError(const MeshArrays & finest, const MeshArrays & level) const;

private:
  struct Errors
  {
    std::vector<double> squares; ///< of each cell, density^2 mm^3
    double              square{ 0.0 };
    double              weight{ 0.0 };
  };

  Errors
  Measure(const MeshArrays & level) const;
  double
  CellSquares(const MeshArrays & level, IdType t, int degree, const double * coefficients) const;
  void
  FitCell(const MeshArrays & level, IdType t, const DensityFitKernel & kernel, double * coefficients) const;
  const DensityFitKernel &
  Kernel(int degree) const;

  const MeshArrays &                      m_Before;
  const std::vector<IdType> &             m_ParentCell;
  const std::vector<IdType> &             m_CellSlot;
  const DensitySamples &                  m_Samples;
  const std::vector<IdType> &             m_SampleCell;
  Execution                               m_Execution;
  TetraLocator                            m_Locator;
  mutable std::map<int, DensityFitKernel> m_Kernels;
};
} // namespace bone

#endif
