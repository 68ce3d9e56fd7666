/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneChordDerivative.h"

#include <algorithm>

namespace bone
{
namespace
{
/** Adds sign * rho mu_j / (d mu_face / ds) at one end of a chord. */
void
AddFaceTerm(const Barycentric & mu, double value, int face, double rate, ChordTerms & terms)
{
  for (int j = 0; j < 4; ++j)
  {
    const double term = value * mu[j] / rate;
    for (int i = 1; i < 4; ++i)
    {
      terms.k[4 * (i - 1) + j] += face == i ? term : (face == 0 ? -term : 0.0);
    }
  }
}
} // namespace

ChordDerivative::ChordDerivative(const CellDensity &              density,
                                 const MeshRadiographParameters & parameters,
                                 std::size_t                      t)
  : m_Degree(density.Degree(t))
{
  const double * c = density.Coefficients(t);
  std::transform(c, c + BernsteinCount(m_Degree), m_Coefficients, [&](double value) {
    return parameters.scale * value + parameters.offset;
  });
}

ChordTerms
ChordDerivative::At(const CellChord & chord, const Eigen::Vector4d & rates) const
{
  // Gauss-Legendre, five points: exact to degree 9.
  static constexpr double x[] = {
    -0.90617984593866399, -0.53846931010568309, 0.0, 0.53846931010568309, 0.90617984593866399
  };
  static constexpr double w[] = {
    0.11846344252809454, 0.23931433524968324, 0.28444444444444444, 0.23931433524968324, 0.11846344252809454
  };
  ChordTerms terms;
  for (int g = 0; g < 5; ++g)
  {
    const Barycentric mu = 0.5 * (1 - x[g]) * chord.entry + 0.5 * (1 + x[g]) * chord.exit;
    const double      weight = w[g] * chord.length;
    double            values[ChordTerms::maximumCount];
    BernsteinBasis(m_Degree, mu, values);
    for (int p = 0; p < BernsteinCount(m_Degree); ++p)
    {
      terms.basis[p] += weight * values[p];
    }
    const Eigen::Vector4d gradient = BernsteinBarycentricGradient(m_Degree, m_Coefficients, mu);
    for (int q = 0; q < 12; ++q)
    {
      terms.k[q] -= weight * (gradient[q / 4 + 1] - gradient[0]) * mu[q % 4];
    }
  }
  if (chord.exitFace >= 0)
  {
    const double value = BernsteinValue(m_Degree, m_Coefficients, chord.exit);
    AddFaceTerm(chord.exit, value, chord.exitFace, rates[chord.exitFace], terms);
  }
  if (chord.entryFace >= 0)
  {
    const double value = BernsteinValue(m_Degree, m_Coefficients, chord.entry);
    AddFaceTerm(chord.entry, -value, chord.entryFace, rates[chord.entryFace], terms);
  }
  return terms;
}
} // namespace bone
