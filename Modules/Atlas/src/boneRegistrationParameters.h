/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneRegistrationParameters_h
#define boneRegistrationParameters_h

#include "boneAtlasRegistrationParameters.h"
#include "boneFacetFit.h"
#include "boneNonRigidICP.h"
#include "boneSurfaceAlignment.h"
#include "boneSurfaceDeformation.h"
#include "boneUntangling.h"

namespace bone
{
/** What a registration is made with: the filter's parameters and what is fixed. */
struct RegistrationParameters : AtlasRegistrationParameters
{
  explicit RegistrationParameters(const AtlasRegistrationParameters & parameters = {})
    : AtlasRegistrationParameters(parameters)
  {
    surfaceAlignment.kind = parameters.alignment;
    untangling.exteriorBound = parameters.exteriorBound;
  }

  SurfaceAlignmentParameters surfaceAlignment;
  AdaptiveFocusParameters    focus;
  NonRigidICPParameters      nonRigid;
  FacetFitParameters         facets;                                   ///< after the deformation
  FacetFitParameters         layers{ { 8, 4, 2, 1, 0, 0 }, 4.0, 5.0 }; ///< of the surfaces between layers
  UntanglingParameters       untangling;
};
} // namespace bone

#endif
