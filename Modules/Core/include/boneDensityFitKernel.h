/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneDensityFitKernel_h
#define boneDensityFitKernel_h

#include "boneBernstein.h"

#include <vector>

namespace bone
{
/** \class DensityFitKernel
 * \brief Least-squares fit of a Bernstein polynomial to values at a fixed pattern of points of a tetrahedron (paper 3).
 *
 * The pattern is a lattice in barycentric coordinates: ((i, j, k, l) + 1/2) / (m + 2) for all i+j+k+l = m, that is
 * BernsteinCount(m) points, evenly spread and all strictly inside; each stands for about the same share of the volume.
 * As it is the same in every tetrahedron, so is the matrix of the least-squares problem: its pseudo-inverse is computed
 * once, here, by a QR factorisation, and a fit is a matrix product. A polynomial of the kernel's degree or lower is
 * reproduced to rounding, and the fit does not depend on the order of the vertices.
 *
 * `keep` damps the finest part of the polynomial, where a tetrahedron has too few measured values to carry it: the
 * result is low + keep (fit - low), with `low` the best fit of the degree below, at the same points (1: plain least
 * squares; 0: a fit of the degree below, written at this degree).
 *
 * Const use is safe from many threads. */
class DensityFitKernel
{
public:
  /** Pattern of order `lattice` (m above). Throws std::out_of_range where the degree is outside
   * 0..MaximumBernsteinDegree, std::invalid_argument where the pattern has not more than twice as many points as there
   * are coefficients, or `keep` lies outside [0, 1]. */
  DensityFitKernel(int degree, int lattice, double keep = 1.0);

  /** The smallest pattern with more than twice as many points as coefficients. */
  static int
  MinimumLattice(int degree);

  /** The smallest pattern with at least this many points, not below MinimumLattice(degree) nor above `largest`. */
  static int
  LatticeWithPoints(int degree, double points, int largest);

  int
  GetDegree() const
  {
    return m_Degree;
  }
  int
  GetLattice() const
  {
    return m_Lattice;
  }
  int
  GetNumberOfCoefficients() const
  {
    return BernsteinCount(m_Degree);
  }

  /** Where the values are to be taken, in the order that Fit() wants. */
  const std::vector<Barycentric> &
  SamplePoints() const
  {
    return m_Points;
  }

  /** One fit: as many values as sample points, GetNumberOfCoefficients() coefficients. */
  void
  Fit(const double * values, double * coefficients) const;

  /** Many fits at once, faster: value s of fit f is values[f * #samples + s], coefficient c of fit f goes to
   * coefficients[f * GetNumberOfCoefficients() + c]. */
  void
  FitMany(std::size_t fits, const double * values, double * coefficients) const;

private:
  int                      m_Degree;
  int                      m_Lattice;
  std::vector<Barycentric> m_Points;
  Eigen::MatrixXd          m_PseudoInverse; // coefficients by samples
};
} // namespace bone

#endif
