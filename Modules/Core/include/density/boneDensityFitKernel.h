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
 * The pattern is a lattice in barycentric coordinates: ((i, j, k, l) + s) / (m + 4 s) for all i+j+k+l = m, that is
 * BernsteinCount(m) points, evenly spread and all strictly inside; s is 1/2 up to degree 3, where each point then
 * stands for the same share of the volume, and 1/3 above, as polynomials of high degree swing beyond the outermost
 * points. As the pattern is the same in every tetrahedron, so is the matrix of the least-squares problem: its
 * pseudo-inverse is computed once, here, by a QR factorisation, and a fit is a matrix product. A polynomial of the
 * kernel's degree or lower is reproduced to rounding, and the fit does not depend on the order of the vertices.
 *
 * `tikhonov` > 0 holds control values near the data where the values say little about them, as in tetrahedra of few
 * voxels: the fit then minimises the mean of (p(mu) - value)^2 over the points plus `tikhonov` times the mean of
 * (c - low)^2 over the coefficients, `low` being the same kind of fit of the degree below, elevated. Degree 1 is the
 * plain fit, so that linear fields stay exact. On CT, 1e-4 cuts the overshoot of control values at degree 8 to a fifth
 * and costs next to nothing at degree 5 or below.
 *
 * Const use is safe from many threads. */
class DensityFitKernel
{
public:
  /** Pattern of order `lattice` (m above). Throws std::out_of_range where the degree is outside
   * 0..MaximumBernsteinDegree, std::invalid_argument where the pattern has not more than twice as many points as there
   * are coefficients, or `tikhonov` is negative or not finite. */
  DensityFitKernel(int degree, int lattice, double tikhonov = 0.0);

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
