/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneCellPiece_h
#define boneCellPiece_h

#include "boneBernstein.h"

#include <vector>

namespace bone
{
/** A tetrahedron within a tetrahedron of the mesh: barycentric coordinates of its corners in that. */
using CellPiece = std::array<Barycentric, 4>;

/** The whole tetrahedron. */
CellPiece
WholeCell();

/** Volume of the piece over that of the tetrahedron. */
double
PieceShare(const CellPiece & piece);

/** The share of a tetrahedron's volume where a function that is linear on it, given at its corners, is not negative. */
double
ShareNotNegative(const Eigen::Vector4d & values);

/** Appends the part of a piece where a function that is linear on it, given at its corners, is not negative: up to
 * three pieces. */
void
KeepNotNegative(const CellPiece & piece, const Eigen::Vector4d & values, std::vector<CellPiece> & kept);

/** The corners of the polygon in which a function that is linear on a piece, given at its corners, is zero: none, three
 * or four, in order around it. A corner where the function is 0 counts as positive, so that a face shared by two
 * pieces is found in one of them. */
std::vector<Barycentric>
ZeroPolygon(const CellPiece & piece, const Eigen::Vector4d & values);

/** Mean over a simplex with these corners (2: a segment, 3: a triangle, 4: a tetrahedron) of a Bernstein polynomial
 * with BernsteinCount(degree) coefficients: the mean of its coefficients there, which are its blossoms. Exact. */
double
SimplexMean(int degree, const double * coefficients, const Barycentric * corners, int numberOfCorners);
} // namespace bone

#endif
