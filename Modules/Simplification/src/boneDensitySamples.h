/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneDensitySamples_h
#define boneDensitySamples_h

#include "boneExecution.h"
#include "boneTetraComplex.h"

#include <vector>

namespace bone
{
/** \class DensitySamples
 * \brief The density of the finest level as a cloud of weighted samples, each known to the cell that it lies in.
 *
 * Ten samples a cell of the finest level, evenly spread, each standing for the same share of the cell's volume.
 * While cells change, samples go to the cells that cover them, so that the error of any later mesh is always measured
 * against the finest level and does not add up unseen (paper 4.3). */
class DensitySamples
{
public:
  static constexpr int SamplesPerCell = 10;

  struct Sample
  {
    Vector3 x;
    double  value;
    double  weight; ///< mm^3; the weights of a cell sum to its volume
  };

  /** No samples where the mesh has no density. */
  explicit DensitySamples(const MeshArrays & mesh, const Execution & execution = Execution());

  bool
  IsEmpty() const
  {
    return m_Samples.empty();
  }
  /** The range from the 1st to the 99th percentile of the values; 1 where that is 0. */
  double
  Range() const
  {
    return m_Range;
  }
  const std::vector<Sample> &
  All() const
  {
    return m_Samples;
  }
  const std::vector<int> &
  InCell(IdType t) const
  {
    return m_InCell[t];
  }

  /** \brief Bound on how much the integral of the squared density error grows when v is removed, in density^2 mm^3.
   *
   * In each region around v, one polynomial of degree 2 at most is fitted to all samples there. Cells that v leaves
   * behind may each have their own, so that their error is no more; what the cells of now have is taken off. */
  double
  RemovalCost(const TetraComplex & complex, IdType v) const;

  /** Takes the samples out of cells that are about to be replaced. */
  std::vector<int>
  TakeFrom(const std::vector<IdType> & cells);

  /** Gives samples to those of the cells that cover them, or come nearest to that. */
  void
  GiveTo(const TetraComplex & complex, const std::vector<int> & samples, const std::vector<IdType> & cells);

  /** Gives all samples to the cells that cover them, or come nearest to that. */
  void
  Distribute(const TetraComplex & complex, const Execution & execution);

private:
  void
  MeasureCell(IdType t);
  double
  FitResidual(const std::vector<int> & samples) const;

  std::vector<Sample>           m_Samples;
  std::vector<std::vector<int>> m_InCell;
  std::vector<double>           m_CellError;
  double                        m_Range{ 1.0 };
  int                           m_FitDegree{ 2 };
};
} // namespace bone

#endif
