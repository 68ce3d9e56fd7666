/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneVolumeDensity_h
#define boneVolumeDensity_h

#include "boneVolumeRegistration.h"

namespace bone
{
/** The tetrahedra that do not lie wholly between the outermost voxel centres of a CT. */
std::vector<bool>
CellsBeyond(const MeshArrays & mesh, const VolumeView & ct);

/** \brief Makes `fitted`, the result's mesh with a density fitted to the CT, that of the result.
 *
 * Tetrahedra beyond the CT keep the density of the atlas' mean. Sets the regions' mean densities and masses, whose
 * deviations are those of the volume: where a surface moves out, what it takes in has a density half-way between the
 * region's and `softTissue`. Sets the result's densityScores: the most probable coefficients of the atlas' modes of
 * density, by the tetrahedra that the CT shows. Throws std::invalid_argument where the fit has another degree than the
 * atlas. */
void
TakeVolumeDensity(const StatisticalModelContent & atlas,
                  const VolumeView &              ct,
                  const AtlasVolumeParameters &   parameters,
                  const MeshArrays &              fitted,
                  VolumeRegistrationResult &      result);
} // namespace bone

#endif
