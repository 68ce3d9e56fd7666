/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneDensityFitKernel.h"

#include <Eigen/QR>

#include <stdexcept>
#include <string>

namespace bone
{
namespace
{
std::vector<Barycentric>
LatticePoints(int lattice)
{
  std::vector<Barycentric> points;
  for (int i = lattice; i >= 0; --i)
  {
    for (int j = lattice - i; j >= 0; --j)
    {
      for (int k = lattice - i - j; k >= 0; --k)
      {
        points.push_back((Barycentric(i, j, k, lattice - i - j - k).array() + 0.5) / (lattice + 2));
      }
    }
  }
  return points;
}

/** Coefficients from values at the points: R^-1 Q^T of the points-by-coefficients matrix of basis values. */
Eigen::MatrixXd
PseudoInverse(int degree, const std::vector<Barycentric> & points)
{
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const Eigen::Index rows = static_cast<Eigen::Index>(points.size()), columns = BernsteinCount(degree);
  RowMajor           basis(rows, columns);
  for (Eigen::Index p = 0; p < rows; ++p)
  {
    BernsteinBasis(degree, points[p], basis.row(p).data());
  }
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(basis);
  const Eigen::MatrixXd                       q = qr.householderQ() * Eigen::MatrixXd::Identity(rows, columns);
  return qr.matrixQR().topRows(columns).triangularView<Eigen::Upper>().solve(q.transpose());
}

/** Matrix that elevates coefficients by one degree. */
Eigen::MatrixXd
ElevationMatrix(int from)
{
  Eigen::MatrixXd elevation(BernsteinCount(from + 1), BernsteinCount(from));
  for (Eigen::Index c = 0; c < elevation.cols(); ++c)
  {
    const Eigen::VectorXd unit = Eigen::VectorXd::Unit(elevation.cols(), c);
    BernsteinElevate(from, unit.data(), from + 1, elevation.col(c).data());
  }
  return elevation;
}
} // namespace

int
DensityFitKernel::MinimumLattice(int degree)
{
  const auto needed = 2 * BernsteinExponents(degree).size();
  int        lattice = degree;
  while (static_cast<std::size_t>(BernsteinCount(lattice)) <= needed)
  {
    ++lattice;
  }
  return lattice;
}

int
DensityFitKernel::LatticeWithPoints(int degree, double points, int largest)
{
  int lattice = MinimumLattice(degree);
  while (lattice < largest && BernsteinCount(lattice) < points)
  {
    ++lattice;
  }
  return lattice;
}

DensityFitKernel::DensityFitKernel(int degree, int lattice, double keep)
  : m_Degree(degree)
  , m_Lattice(lattice)
{
  if (lattice < MinimumLattice(degree))
  {
    throw std::invalid_argument("A fit of degree " + std::to_string(degree) + " needs a sample pattern of order " +
                                std::to_string(MinimumLattice(degree)) + " or more, not " + std::to_string(lattice) +
                                ".");
  }
  if (!(keep >= 0 && keep <= 1))
  {
    throw std::invalid_argument("The kept share of the highest degree must lie in [0, 1], not " + std::to_string(keep) +
                                ".");
  }
  m_Points = LatticePoints(lattice);
  m_PseudoInverse = PseudoInverse(degree, m_Points);
  if (keep < 1 && degree > 0)
  {
    m_PseudoInverse =
      keep * m_PseudoInverse + (1 - keep) * ElevationMatrix(degree - 1) * PseudoInverse(degree - 1, m_Points);
  }
}

void
DensityFitKernel::Fit(const double * values, double * coefficients) const
{
  this->FitMany(1, values, coefficients);
}

void
DensityFitKernel::FitMany(std::size_t fits, const double * values, double * coefficients) const
{
  const Eigen::Map<const Eigen::MatrixXd> in(values, m_PseudoInverse.cols(), static_cast<Eigen::Index>(fits));
  Eigen::Map<Eigen::MatrixXd>             out(coefficients, m_PseudoInverse.rows(), static_cast<Eigen::Index>(fits));
  out.noalias() = m_PseudoInverse * in;
}
} // namespace bone
