/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneBuildCost_h
#define boneBuildCost_h

#include "boneBuildParameters.h"

namespace bone
{
/** What is known of a build before it reads the CT's voxels. */
struct BuildSize
{
  double              voxels{ 0.0 }; ///< of the CT
  std::vector<double> bones; ///< voxels of each bone's box with its margin; those of the CT where they are not known
  unsigned int        threads{ 1 };
};

/** What a build takes, about. */
struct BuildCost
{
  double seconds{ 0.0 };
  double megabytes{ 0.0 }; ///< of 1e6 bytes, at the peak
};

/** \brief What a build of this size and with these parameters takes, about.
 *
 * Linear in the numbers of voxels and tetrahedra, memory the larger of two such, with constants that were fitted to
 * builds of analytic phantoms and clinical bones; the guide says how far it is off. Other machines are faster or
 * slower. */
BuildCost
EstimateCost(const BuildSize & size, const BuildParameters & parameters);
} // namespace bone

#endif
