/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneDensityFitKernel.h"

#include <Eigen/QR>

#include <cmath>
#include <stdexcept>
#include <string>

namespace bone
{
namespace
{
/** All (i, j, k, l) of sum `lattice`, of any order, in the order of the coefficients. */
std::vector<std::array<int, 4>>
LatticeExponents(int lattice)
{
  std::vector<std::array<int, 4>> exponents;
  for (int i = lattice; i >= 0; --i)
  {
    for (int j = lattice - i; j >= 0; --j)
    {
      for (int k = lattice - i - j; k >= 0; --k)
      {
        exponents.push_back({ i, j, k, lattice - i - j - k });
      }
    }
  }
  return exponents;
}

std::vector<Barycentric>
LatticePoints(int degree, int lattice)
{
  const double             inset = degree <= 3 ? 1.0 / 2 : 1.0 / 3;
  std::vector<Barycentric> points;
  for (const auto & [i, j, k, l] : LatticeExponents(lattice))
  {
    points.push_back((Barycentric(i, j, k, l).array() + inset) / (lattice + 4 * inset));
  }
  return points;
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

/** Coefficients from values at the points. The rows of the least-squares problem are the basis values at the points
 * and, with Tikhonov's term, the coefficients themselves; its solution R^-1 Q^T applied to the values and to `low`. */
Eigen::MatrixXd
PseudoInverse(int degree, const std::vector<Barycentric> & points, double tikhonov)
{
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const Eigen::Index samples = static_cast<Eigen::Index>(points.size()), count = BernsteinCount(degree);
  const bool         damped = tikhonov > 0 && degree > 1;
  const double       weight = std::sqrt(tikhonov * static_cast<double>(samples) / static_cast<double>(count));
  RowMajor           rows = RowMajor::Zero(damped ? samples + count : samples, count);
  for (Eigen::Index s = 0; s < samples; ++s)
  {
    BernsteinBasis(degree, points[s], rows.row(s).data());
  }
  if (damped)
  {
    rows.bottomRows(count).diagonal().setConstant(weight);
  }
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(rows);
  const Eigen::MatrixXd                       q = qr.householderQ() * Eigen::MatrixXd::Identity(rows.rows(), count);
  Eigen::MatrixXd                             right = q.topRows(samples).transpose();
  if (damped)
  {
    const Eigen::MatrixXd low = ElevationMatrix(degree - 1) * PseudoInverse(degree - 1, points, tikhonov);
    right += weight * q.bottomRows(count).transpose() * low;
  }
  return qr.matrixQR().topRows(count).triangularView<Eigen::Upper>().solve(right);
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

DensityFitKernel::DensityFitKernel(int degree, int lattice, double tikhonov)
  : m_Degree(degree)
  , m_Lattice(lattice)
{
  if (lattice < MinimumLattice(degree))
  {
    throw std::invalid_argument("A fit of degree " + std::to_string(degree) + " needs a sample pattern of order " +
                                std::to_string(MinimumLattice(degree)) + " or more, not " + std::to_string(lattice) +
                                ".");
  }
  if (!(tikhonov >= 0 && std::isfinite(tikhonov)))
  {
    throw std::invalid_argument("The weight of Tikhonov's term must be 0 or more and finite, not " +
                                std::to_string(tikhonov) + ".");
  }
  m_Points = LatticePoints(degree, lattice);
  m_PseudoInverse = PseudoInverse(degree, m_Points, tikhonov);
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
