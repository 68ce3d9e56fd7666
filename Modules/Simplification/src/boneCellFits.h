/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneCellFits_h
#define boneCellFits_h

#include "boneDensityFitKernel.h"
#include "boneTetraLocator.h"

#include <array>
#include <vector>

namespace bone
{
/** Point k of a sequence that fills a tetrahedron evenly: additive recurrence in a cube by powers of the root of g^4 =
 * g + 1, sorted coordinates. */
Barycentric
EvenlySpread(std::size_t k);

/** \class CellFits
 * \brief The polynomials of cells by the finest level alone, and their error E(t') (paper 4.3).
 *
 * A fit takes the finest level's density at a pattern of points in the cell; a point outside the finest level has that
 * of the nearest place of its boundary. Its error is the root mean square difference at 64 other points, evenly spread.
 * Const use is safe from many threads. */
class CellFits
{
public:
  struct Fit
  {
    double              error{ 0.0 }; ///< root mean square, density units
    int                 degree{ 0 };
    std::vector<double> coefficients;
  };

  /** \param degree         of a cell's polynomial.
   * \param maximumDegree  to which it may be raised where its error is beyond the bound. */
  CellFits(const MeshArrays & finest, int degree, int maximumDegree);

  /** The polynomial of the lowest degree whose error is within the bound, or the one of least error. `hint`: a cell of
   * the finest level near the first corner, -1: not known. */
  Fit
  FitCell(const std::array<Vector3, 4> & corners, double bound, IdType hint) const;

private:
  /** The finest level's density at points of a cell. */
  std::vector<double>
  Values(const std::array<Vector3, 4> & corners, const std::vector<Barycentric> & points, IdType & hint) const;

  MeshArrays                    m_Finest;
  TetraLocator                  m_Locator;
  std::vector<DensityFitKernel> m_Kernels; ///< of the degrees in their order
  std::vector<Barycentric>      m_Checked; ///< where errors are measured
};
} // namespace bone

#endif
