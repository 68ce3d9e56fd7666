/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneCorticalProfile_h
#define boneCorticalProfile_h

#include <vector>

namespace bone
{
/** \brief Densities (HU) along a line from outside a bone inward, `step` mm apart; `values[lead]` lies on the
 * periosteal contour. */
struct CorticalProfile
{
  std::vector<double> values;
  int                 lead{ 0 };
  double              step{ 1.0 };
};

/** What to find on a \ref CorticalProfile; lengths in mm, densities in HU. */
struct CorticalRules
{
  double pixel{ 1.0 };
  double endostealThreshold{ 0.0 }; ///< 0: half-way from the cortex's maximum to the level inside
  double minimumContrast{ 100.0 };  ///< between the two, else the cortex is as thin as may be
  double solidLevel{ 600.0 };       ///< a profile that stays above has no trabecular bone at its inner end
};

/** Where the cortex begins and ends on a profile, depths in mm below the periosteal contour. */
struct CorticalEdges
{
  enum class Kind
  {
    Found,
    None, ///< no cortex that stands out
    Solid ///< bone as dense as cortex to the profile's end
  };
  Kind   kind{ Kind::None };
  double outer{ 0.0 };
  double inner{ 0.0 };
  double blur{ 0.0 }; ///< standard deviation of the outer edge's blur; 0 where the cortex is too thin to tell
};

/** \brief The cortex ends where the density falls half-way from its maximum to the level just inside, and begins where
 * it rises half-way from the level outside; or both at the threshold, where there is one. */
CorticalEdges
FindCorticalEdges(const CorticalProfile & profile, const CorticalRules & rules);

/** \brief Thickness of a layer that, blurred by a Gaussian of standard deviation `blur`, has the width `width` at half
 * of its maximum.
 *
 * A blurred layer looks the wider the thinner it is: with P the normal distribution's function, half of the maximum
 * P(t / 2s) - P(-t / 2s) is reached at w / 2. Below one standard deviation the width hardly depends on the thickness,
 * and that deviation is returned: an upper bound. */
double
ThicknessOfBlurredLayer(double width, double blur);
} // namespace bone

#endif
