/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCellFits.h"

#include "boneBernstein.h"

#include <algorithm>
#include <cmath>

namespace bone
{
namespace
{
constexpr std::size_t CheckedPoints = 64;
} // namespace

Barycentric
EvenlySpread(std::size_t k)
{
  constexpr double G = 1.22074408460575947536;
  double           u[3] = { 0.5 + k / G, 0.5 + k / (G * G), 0.5 + k / (G * G * G) };
  for (double & x : u)
  {
    x -= std::floor(x);
  }
  std::sort(u, u + 3);
  return { u[0], u[1] - u[0], u[2] - u[1], 1.0 - u[2] };
}

CellFits::CellFits(const MeshArrays & finest, int degree, int maximumDegree)
  : m_Finest(finest)
  , m_Locator(finest)
{
  for (int n = degree; n == degree || n <= maximumDegree; ++n)
  {
    m_Kernels.emplace_back(n, n + 3);
  }
  for (std::size_t k = 0; k < CheckedPoints; ++k)
  {
    m_Checked.push_back(EvenlySpread(k));
  }
}

std::vector<double>
CellFits::Values(const std::array<Vector3, 4> & corners, const std::vector<Barycentric> & points, IdType & hint) const
{
  const std::size_t   row = BernsteinCount(m_Finest.maximumDegree);
  std::vector<double> values;
  for (const Barycentric & mu : points)
  {
    const CellLocation place =
      m_Locator.FindNearest(mu[0] * corners[0] + mu[1] * corners[1] + mu[2] * corners[2] + mu[3] * corners[3], hint);
    hint = place.cell;
    values.push_back(BernsteinValue(m_Finest.degree[hint], &m_Finest.coefficients[row * hint], place.mu));
  }
  return values;
}

CellFits::Fit
CellFits::FitCell(const std::array<Vector3, 4> & corners, double bound, IdType hint) const
{
  const std::vector<double> wanted = Values(corners, m_Checked, hint);
  Fit                       best;
  for (const DensityFitKernel & kernel : m_Kernels)
  {
    const std::vector<double> values = Values(corners, kernel.SamplePoints(), hint);
    Fit                       fit;
    fit.degree = kernel.GetDegree();
    fit.coefficients.resize(kernel.GetNumberOfCoefficients());
    kernel.Fit(values.data(), fit.coefficients.data());
    double squares = 0.0;
    for (std::size_t k = 0; k < m_Checked.size(); ++k)
    {
      const double error = BernsteinValue(fit.degree, fit.coefficients.data(), m_Checked[k]) - wanted[k];
      squares += error * error;
    }
    fit.error = std::sqrt(squares / static_cast<double>(m_Checked.size()));
    if (best.coefficients.empty() || fit.error < best.error)
    {
      best = std::move(fit);
    }
    if (best.error <= bound)
    {
      break;
    }
  }
  return best;
}
} // namespace bone
