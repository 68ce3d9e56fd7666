/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneCorticalFit_h
#define boneCorticalFit_h

#include <limits>
#include <vector>

namespace bone
{
/** A value of the CT and how far below the periosteal surface it lies. */
struct CorticalSample
{
  double depth; ///< mm, negative outside
  double value; ///< HU
};

/** What a fit of the cortex found. Values are those of the array `CorticalStatus`. */
enum class CorticalStatus : int
{
  None = 0,   ///< no layer near the surface that is denser than what lies on either side
  Found = 1,  ///< thickness and density are known
  Solid = 2,  ///< as dense as cortex as far in as there are samples
  Outside = 3 ///< too few samples: the image or the bone ends there
};

/** \brief Three levels of density with two edges, blurred by a Gaussian. */
struct BlurredCortex
{
  double outer{ 0.0 };     ///< mm, depth of the periosteal edge
  double thickness{ 0.0 }; ///< mm, from there to the endosteal edge
  double outside{ 0.0 };   ///< HU
  double cortical{ 0.0 };  ///< HU
  double inside{ 0.0 };    ///< HU
  double blur{ 0.0 };      ///< mm, standard deviation

  /** The density at a depth, HU. */
  double
  operator()(double depth) const;
};

/** How a cortex is fitted; lengths in mm, densities in HU. */
struct CorticalFitRules
{
  double blur{ 0.0 };                                          ///< standard deviation; 0: fitted
  double cortical{ std::numeric_limits<double>::quiet_NaN() }; ///< the cortex's density; NaN: fitted
  double pixel{ 1.0 };                                         ///< the image's largest spacing
  double outsideReach{ 3.0 };                                  ///< samples count from so far outside ...
  double insideReach{ 3.0 };                                   ///< ... to so far below the endosteal edge
  double largestOffset{ 2.0 };                                 ///< of the periosteal edge from the surface
  double minimumContrast{ 100.0 };                             ///< of the cortex above what is on either side
};

struct CorticalFit
{
  CorticalStatus status{ CorticalStatus::Outside };
  BlurredCortex  cortex;          ///< where the status is Found
  double         residual{ 0.0 }; ///< root mean square, HU
};

/** \brief Fits a blurred cortex to samples by least squares (Levenberg-Marquardt).
 *
 * The model is that of G. M. Treece, A. H. Gee, P. M. Mayhew and K. E. S. Poole, doi:10.1016/j.media.2010.01.003: with
 * P the normal distribution's function, edges x0 < x1 and levels y0, y1, y2,
 *
 *   y(x) = y0 + (y1 - y0) P((x - x0) / s) + (y2 - y1) P((x - x1) / s).
 *
 * A cortex thinner than its blur shows only the product of thickness and density: there the density must be given, and
 * best the blur. The fit starts at the edges of the half-maximum rule (\ref FindCorticalEdges) on the samples' means.
 * Samples outside that rise again towards another bone are left out. The order of the samples does not matter but for
 * rounding. */
CorticalFit
FitCortex(std::vector<CorticalSample> samples, const CorticalFitRules & rules);
} // namespace bone

#endif
