/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCellPiece.h"

#include <Eigen/LU>

#include <algorithm>

namespace bone
{
namespace
{
constexpr int MostPieceCoefficients = BernsteinCount(MaximumBernsteinDegree);

/** Where the function is 0 between corner p, where it is not negative, and corner n, where it is. */
Barycentric
ZeroBetween(const CellPiece & piece, const Eigen::Vector4d & values, int p, int n)
{
  const double t = values[p] / (values[p] - values[n]);
  return (1.0 - t) * piece[p] + t * piece[n];
}

/** Corners where the function is not negative, then the others. Returns the number of the former. */
int
SortCorners(const Eigen::Vector4d & values, std::array<int, 4> & order)
{
  int positive = 0, last = 4;
  for (int i = 0; i < 4; ++i)
  {
    order[values[i] >= 0.0 ? positive++ : --last] = i;
  }
  return positive;
}

/** The blossom with one argument fixed to mu: coefficients of degree - 1. */
void
FixBlossomArgument(int degree, const double * c, const Barycentric & mu, double * reduced)
{
  const auto & exponents = BernsteinExponents(degree - 1);
  for (std::size_t p = 0; p < exponents.size(); ++p)
  {
    const auto & e = exponents[p];
    reduced[p] = mu[0] * c[BernsteinIndex(degree, e[0] + 1, e[1], e[2])] +
                 mu[1] * c[BernsteinIndex(degree, e[0], e[1] + 1, e[2])] +
                 mu[2] * c[BernsteinIndex(degree, e[0], e[1], e[2] + 1)] +
                 mu[3] * c[BernsteinIndex(degree, e[0], e[1], e[2])];
  }
}

/** Sum of the blossom over all multisets of `degree` corners from number `first` on. */
double
BlossomSum(int degree, const double * c, const Barycentric * corners, int first, int end)
{
  if (degree == 0)
  {
    return c[0];
  }
  double sum = 0.0;
  double reduced[MostPieceCoefficients];
  for (int corner = first; corner < end; ++corner)
  {
    FixBlossomArgument(degree, c, corners[corner], reduced);
    sum += BlossomSum(degree - 1, reduced, corners, corner, end);
  }
  return sum;
}
} // namespace

CellPiece
WholeCell()
{
  return { Barycentric::Unit(0), Barycentric::Unit(1), Barycentric::Unit(2), Barycentric::Unit(3) };
}

double
PieceShare(const CellPiece & piece)
{
  Eigen::Matrix4d corners;
  corners << piece[0], piece[1], piece[2], piece[3];
  return std::abs(corners.determinant());
}

double
ShareNotNegative(const Eigen::Vector4d & values)
{
  std::array<int, 4> order;
  const int          positive = SortCorners(values, order);
  // The share of the edge from corner a to corner b that lies on a's side of the zero.
  const auto part = [&](int a, int b) { return values[order[a]] / (values[order[a]] - values[order[b]]); };
  switch (positive)
  {
    case 0:
      return 0.0;
    case 1:
      return part(0, 1) * part(0, 2) * part(0, 3);
    case 2:
    {
      // The three tetrahedra of KeepNotNegative.
      const double a = part(0, 2), b = part(0, 3), c = part(1, 2), d = part(1, 3);
      return a * b + b * (1.0 - a) * c + (1.0 - b) * c * d;
    }
    case 3:
      return 1.0 - part(3, 0) * part(3, 1) * part(3, 2);
    default:
      return 1.0;
  }
}

void
KeepNotNegative(const CellPiece & piece, const Eigen::Vector4d & values, std::vector<CellPiece> & kept)
{
  std::array<int, 4> order;
  const int          positive = SortCorners(values, order);
  const auto         corner = [&](int i) { return piece[order[i]]; };
  const auto         zero = [&](int p, int n) { return ZeroBetween(piece, values, order[p], order[n]); };
  // A prism from triangle a to triangle b, of which corner i is joined to corner i.
  const auto prism = [&kept](const std::array<Barycentric, 3> & a, const std::array<Barycentric, 3> & b) {
    kept.push_back({ a[0], a[1], a[2], b[0] });
    kept.push_back({ a[1], a[2], b[0], b[1] });
    kept.push_back({ a[2], b[0], b[1], b[2] });
  };
  switch (positive)
  {
    case 0:
      break;
    case 1:
      kept.push_back({ corner(0), zero(0, 1), zero(0, 2), zero(0, 3) });
      break;
    case 2:
      prism({ corner(0), zero(0, 2), zero(0, 3) }, { corner(1), zero(1, 2), zero(1, 3) });
      break;
    case 3:
      prism({ corner(0), corner(1), corner(2) }, { zero(0, 3), zero(1, 3), zero(2, 3) });
      break;
    default:
      kept.push_back(piece);
  }
}

std::vector<Barycentric>
ZeroPolygon(const CellPiece & piece, const Eigen::Vector4d & values)
{
  std::array<int, 4> order;
  const int          positive = SortCorners(values, order);
  const auto         zero = [&](int p, int n) { return ZeroBetween(piece, values, order[p], order[n]); };
  switch (positive)
  {
    case 1:
      return { zero(0, 1), zero(0, 2), zero(0, 3) };
    case 2:
      return { zero(0, 2), zero(0, 3), zero(1, 3), zero(1, 2) };
    case 3:
      return { zero(0, 3), zero(1, 3), zero(2, 3) };
    default:
      return {};
  }
}

double
SimplexMean(int degree, const double * coefficients, const Barycentric * corners, int numberOfCorners)
{
  if (numberOfCorners == 4 && std::equal(corners, corners + 4, WholeCell().begin()))
  {
    return BernsteinIntegral(degree, coefficients, 1.0);
  }
  // As many multisets of `degree` corners as coefficients: (degree + corners - 1) over (corners - 1).
  double count = 1.0;
  for (int i = 1; i < numberOfCorners; ++i)
  {
    count *= static_cast<double>(degree + i) / i;
  }
  return BlossomSum(degree, coefficients, corners, 0, numberOfCorners) / count;
}
} // namespace bone
