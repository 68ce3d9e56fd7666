/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneBernstein_h
#define boneBernstein_h

#include "boneTypes.h"

#include <vector>

namespace bone
{
/** Barycentric coordinates with respect to a tetrahedron's vertices 0..3; they sum to 1. */
using Barycentric = Eigen::Vector4d;

/** Highest polynomial degree that the toolkit supports. */
constexpr int MaximumBernsteinDegree = 8;

/** Number of coefficients of degree n: (n+1)(n+2)(n+3)/6. */
constexpr int
BernsteinCount(int degree)
{
  return (degree + 1) * (degree + 2) * (degree + 3) / 6;
}

/** \defgroup Bernstein Bernstein polynomials on a tetrahedron (paper 3)
 *
 * D(mu) = sum over i+j+k+l = n of c_ijkl n!/(i! j! k! l!) mu0^i mu1^j mu2^k mu3^l.
 *
 * Coefficients are ordered by i descending, then j descending, then k descending, so that degree 1 is (vertex 0, 1, 2,
 * 3). Degrees 0..MaximumBernsteinDegree; another degree throws std::out_of_range. `c` points to
 * BernsteinCount(degree) coefficients.
 * \{ */

/** Exponents (i, j, k, l) of each coefficient, in order. */
const std::vector<std::array<int, 4>> &
BernsteinExponents(int degree);

/** Position of exponents (i, j, k, l), i+j+k+l = degree, in the order. */
int
BernsteinIndex(int degree, int i, int j, int k);

/** All basis values at mu, written to values[0..BernsteinCount(degree)). */
void
BernsteinBasis(int degree, const Barycentric & mu, double * values);

/** Value at mu (outside the tetrahedron the polynomial goes on). Products with the basis: mu need not be normalised
 * for a homogeneous value. */
double
BernsteinValue(int degree, const double * c, const Barycentric & mu);

/** Derivatives with respect to the four barycentric coordinates, taken as independent; the directional derivative along
 * a direction with barycentric increments d (summing to 0) is their dot product. */
Eigen::Vector4d
BernsteinBarycentricGradient(int degree, const double * c, const Barycentric & mu);

/** Gradient in space (density units per mm) in the tetrahedron a, b, c, d (mm, not flat). */
Vector3
BernsteinGradient(int                 degree,
                  const double *      coefficients,
                  const Barycentric & mu,
                  const Vector3 &     a,
                  const Vector3 &     b,
                  const Vector3 &     c,
                  const Vector3 &     d);

/** Integral over a tetrahedron of the given volume: volume times the mean of the coefficients. */
double
BernsteinIntegral(int degree, const double * c, double volume);

/** Integral along the straight segment from mu `entry` to `exit` of the given length (mm): length times the mean of the
 * degree+1 control values of the restriction, which are blossoms. Exact. */
double
BernsteinSegmentIntegral(int                 degree,
                         const double *      c,
                         const Barycentric & entry,
                         const Barycentric & exit,
                         double              length);

/** The degree+1 control values of the polynomial restricted to the segment entry..exit. */
void
BernsteinSegmentControlValues(int                 degree,
                              const double *      c,
                              const Barycentric & entry,
                              const Barycentric & exit,
                              double *            values);

/** Coefficients of the same polynomial at a higher degree. `to >= from`; result has BernsteinCount(to) values. */
void
BernsteinElevate(int from, const double * c, int to, double * elevated);

/** Integral over a tetrahedron of the given volume of the product of two polynomials; with f = g the squared L2 norm.
 */
double
BernsteinInnerProduct(int degreeF, const double * f, int degreeG, const double * g, double volume);

/** Inner products of the two bases' functions on a tetrahedron of volume 1, row-major, BernsteinCount(degreeF) rows. */
const std::vector<double> &
BernsteinGramMatrix(int degreeF, int degreeG);
/** \} */

/** Barycentric coordinates of x in the tetrahedron a, b, c, d (not flat). */
Barycentric
BarycentricCoordinates(const Vector3 & x, const Vector3 & a, const Vector3 & b, const Vector3 & c, const Vector3 & d);
} // namespace bone

#endif
