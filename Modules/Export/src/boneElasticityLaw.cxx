/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneElasticityLaw.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

namespace bone
{
namespace
{
std::vector<ElasticityLaw>
MakeLaws()
{
  constexpr auto    apparent = DensityQuantity::ApparentGramPerCubicCentimetre;
  constexpr auto    ash = DensityQuantity::AshGramPerCubicCentimetre;
  const std::string morgan = "E. F. Morgan et al., J Biomech 36:897-904, 2003, doi:10.1016/S0021-9290(03)00071-X";
  return {
    { "morgan2003-vertebra", apparent, 0.11, 0.35, { { 0.0, 4730.0, 1.56 } }, "trabecular, vertebra", morgan },
    { "morgan2003-tibia", apparent, 0.09, 0.41, { { 0.0, 15520.0, 1.93 } }, "trabecular, proximal tibia", morgan },
    { "morgan2003-trochanter", apparent, 0.14, 0.28, { { 0.0, 15010.0, 2.18 } }, "trabecular, trochanter", morgan },
    { "morgan2003-neck", apparent, 0.26, 0.75, { { 0.0, 6850.0, 1.49 } }, "trabecular, femoral neck", morgan },
    { "morgan2003-pooled", apparent, 0.09, 0.75, { { 0.0, 8920.0, 1.83 } }, "trabecular, all four sites", morgan },
    { "keller1994",
      ash,
      0.028,
      1.22,
      { { 0.0, 10500.0, 2.29 } },
      "trabecular and cortical, femur and spine",
      "T. S. Keller, J Biomech 27:1159-1168, 1994, doi:10.1016/0021-9290(94)90056-6" },
    { "keyak1998",
      ash,
      0.0,
      1.22,
      { { 0.0, 33900.0, 2.20 }, { 0.27, 5307.0, 1.0, 469.0 }, { 0.60, 10200.0, 2.01 } },
      "trabecular and cortical, femur",
      "J. H. Keyak et al., J Biomech 31:125-133, 1998, doi:10.1016/S0021-9290(97)00123-1" },
    { "carter1977",
      apparent,
      0.07,
      2.0,
      { { 0.0, 3790.0 * std::pow(0.01, 0.06), 3.0 } },
      "trabecular and cortical, strain rate 0.01/s",
      "D. R. Carter and W. C. Hayes, J Bone Joint Surg Am 59:954-962, 1977" },
    { "snyder1991",
      apparent,
      1.748,
      1.952,
      { { 0.0, 21910.0, 1.0, -23500.0 } },
      "cortical, tibia",
      "S. M. Snyder and E. Schneider, J Orthop Res 9:422-431, 1991, doi:10.1002/jor.1100090315" },
  };
}
} // namespace

double
ElasticityLaw::operator()(double value) const
{
  if (!(value > 0.0))
  {
    return 0.0;
  }
  const auto next =
    std::find_if(pieces.begin() + 1, pieces.end(), [value](const Piece & piece) { return piece.from > value; });
  const Piece & piece = *(next - 1);
  return std::max(0.0, piece.offset + piece.factor * std::pow(value, piece.exponent));
}

std::string
ElasticityLaw::DescribeRelation() const
{
  std::ostringstream text;
  for (const Piece & piece : pieces)
  {
    text << (piece.from > 0.0 ? ", from " : "E = ");
    if (piece.from > 0.0)
    {
      text << piece.from << " on ";
    }
    text << piece.factor << " rho";
    if (piece.exponent != 1.0)
    {
      text << '^' << piece.exponent;
    }
    if (piece.offset != 0.0)
    {
      text << (piece.offset > 0.0 ? " + " : " - ");
      text << std::abs(piece.offset);
    }
  }
  return text.str();
}

const std::vector<ElasticityLaw> &
PublishedElasticityLaws()
{
  static const std::vector<ElasticityLaw> laws = MakeLaws();
  return laws;
}

const ElasticityLaw &
FindElasticityLaw(const std::string & name)
{
  const auto & laws = PublishedElasticityLaws();
  const auto   found =
    std::find_if(laws.begin(), laws.end(), [&name](const ElasticityLaw & law) { return law.name == name; });
  if (found == laws.end())
  {
    std::string names;
    for (const ElasticityLaw & law : laws)
    {
      names += (names.empty() ? "" : ", ") + law.name;
    }
    throw std::invalid_argument("There is no elasticity law '" + name + "': take one of " + names + ".");
  }
  return *found;
}
} // namespace bone
