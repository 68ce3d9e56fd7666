/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneElasticityLaw_h
#define boneElasticityLaw_h

#include "boneTypes.h"

#include <string>
#include <vector>

namespace bone
{
/** \struct ElasticityLaw
 * \brief A published relation of a bone's Young's modulus to its density: E = offset + factor * density ^ exponent,
 * from piece to piece of the density. */
struct ElasticityLaw
{
  /** The relation from `from` to the next piece. */
  struct Piece
  {
    double from{ 0.0 };     ///< g/cm^3
    double factor{ 0.0 };   ///< MPa
    double exponent{ 1.0 }; ///< of the density in g/cm^3
    double offset{ 0.0 };   ///< MPa
  };

  std::string        name;
  DensityQuantity    density{ DensityQuantity::ApparentGramPerCubicCentimetre }; ///< apparent or ash density
  double             low{ 0.0 }; ///< the densities of the specimens, g/cm^3
  double             high{ 0.0 };
  std::vector<Piece> pieces; ///< ascending; the first begins at 0
  std::string        bone;   ///< what the specimens were
  std::string        source;

  /** MPa at a density in g/cm^3; 0 where the density is not above 0 or the relation falls below 0. */
  double
  operator()(double density) const;

  /** "E = 6850 rho^1.49", in MPa and g/cm^3. */
  std::string
  DescribeRelation() const;
};

/** The published laws, by name:
 * - morgan2003-vertebra, -tibia, -trochanter, -neck, -pooled: trabecular bone on its axis; E. F. Morgan et al., J
 * Biomech 36:897-904, 2003, doi:10.1016/S0021-9290(03)00071-X.
 * - keller1994: trabecular and cortical bone of femur and spine; T. S. Keller, J Biomech 27:1159-1168, 1994,
 *   doi:10.1016/0021-9290(94)90056-6.
 * - keyak1998: trabecular and cortical bone of the femur in three pieces; J. H. Keyak et al., J Biomech 31:125-133,
 * 1998, doi:10.1016/S0021-9290(97)00123-1.
 * - carter1977: trabecular and cortical bone, at a strain rate of 0.01/s; D. R. Carter and W. C. Hayes, J Bone Joint
 * Surg Am 59:954-962, 1977.
 * - snyder1991: cortical bone of the tibia; S. M. Snyder and E. Schneider, J Orthop Res 9:422-431, 1991,
 *   doi:10.1002/jor.1100090315. */
const std::vector<ElasticityLaw> &
PublishedElasticityLaws();

/** The published law of that name; std::invalid_argument, which lists the names, where there is none. */
const ElasticityLaw &
FindElasticityLaw(const std::string & name);
} // namespace bone

#endif
