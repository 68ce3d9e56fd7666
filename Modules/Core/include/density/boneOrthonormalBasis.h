/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneOrthonormalBasis_h
#define boneOrthonormalBasis_h

#include "boneBernstein.h"

namespace bone
{
/** \defgroup OrthonormalBasis Orthonormal polynomials on a tetrahedron
 *
 * The polynomials of Proriol, Koornwinder and Dubiner in barycentric coordinates, scaled so that the mean over the
 * tetrahedron of the product of two of them is 1 where they are the same and 0 elsewhere. They are ordered by degree:
 * those of degree k stand at [BernsteinCount(k - 1), BernsteinCount(k)), so that the first BernsteinCount(k)
 * coefficients are those of the best approximation of degree k in the mean square. The polynomials of one degree depend
 * on the order of the vertices, the space that they span does not. Evaluated by three-term recurrences without division
 * (R. C. Kirby, doi:10.1145/1644001.1644006).
 *
 * Degrees 0..MaximumBernsteinDegree; another degree throws std::out_of_range.
 * \{ */

/** Values of all polynomials up to the degree at mu, written to values[0..BernsteinCount(degree)). */
void
OrthonormalBasis(int degree, const Barycentric & mu, double * values);

/** Bernstein coefficients of each orthonormal polynomial, a column each: BernsteinCount(degree) squared. */
const Eigen::MatrixXd &
OrthonormalToBernstein(int degree);

/** The inverse of OrthonormalToBernstein(). */
const Eigen::MatrixXd &
BernsteinToOrthonormal(int degree);

/** How little of a control polygon a polynomial shows: the mean square over the tetrahedron of a polynomial of exact
 * degree k (orthogonal to all lower ones), divided by the mean square of its Bernstein coefficients of degree n:
 * n! (n+3)! / ((n-k)! (n+k+3)!), an eigenvalue of the Bernstein-Durrmeyer operator. 0 <= k <= n. */
double
BernsteinDamping(int n, int k);

/** Coefficients of the polynomial of degree `to` nearest to a given one in the mean square; where that is of degree
 * `to` in truth, it is the same polynomial. The mean is kept. 0 <= to <= from. */
void
BernsteinReduce(int from, const double * c, int to, double * reduced);
/** \} */
} // namespace bone

#endif
