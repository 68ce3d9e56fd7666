/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneChordDerivative_h
#define boneChordDerivative_h

#include "boneProjectedCells.h"

namespace bone
{
/** K_ij (i = 1..3), see boneRayTerms.hxx, and the integrals of the Bernstein polynomials for one chord. */
struct ChordTerms
{
  static constexpr int maximumCount = BernsteinCount(MaximumBernsteinDegree);

  double k[12]{};
  double basis[maximumCount]{};
};

/** In double precision, for cells that the kernels cannot take. */
class ChordDerivative
{
public:
  ChordDerivative(const CellDensity & density, const MeshRadiographParameters & parameters, std::size_t t);

  ChordTerms
  At(const CellChord & chord, const Eigen::Vector4d & rates) const;

private:
  int    m_Degree;
  double m_Coefficients[ChordTerms::maximumCount];
};

/** Of the barycentric coordinates along a ray. */
inline Eigen::Vector4d
RatesAlong(const AffineBarycentric & mu, const RayFrame & rays, int column, int row)
{
  return mu.gradient * rays.Direction(column, row);
}
} // namespace bone

#endif
