/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneAtlasInputs_h
#define boneAtlasInputs_h

#include "boneAtlasVolumeRegistration.h"
#include "boneImageIO.h"
#include "boneSession.h"

#include <string>

namespace bone
{
using CTRegistration = AtlasVolumeRegistration<CTImage, DensityMesh<double>, LabelImage>;

/** Throws IOError where the atlas has no density. */
StatisticalModel::Pointer
ReadAtlasWithDensity(const std::string & path);

/** Finds the bone of an atlas' file in a CT. The session is told where it is in doubt. Throws itk::ExceptionObject
 * where it is not found. */
CTRegistration::Pointer
FindInCT(const std::string & atlas, const CTImage * ct, const AtlasVolumeParameters & parameters, Session & session);

/** "found, 96 % of the surface on edges (all of it in the CT), ..." */
std::string
DescribeFound(const VolumeRegistrationResult & result);
} // namespace bone

#endif
