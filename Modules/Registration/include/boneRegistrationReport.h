/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneRegistrationReport_h
#define boneRegistrationReport_h

#include "boneDensityMesh.h"
#include "boneImageIO.h"
#include "boneRigidRegistration.h"

#include <nlohmann/json.hpp>

namespace bone
{
/** The result as JSON: `converged`, `quality` ("ok", "suspect", "failed"), `distinctness`, `transform` (4 x 4, rows),
 * `centre` (mm), `covariance` (6 x 6; mm, radians, about the centre, the geometry's axes), `standardDeviations` (mm,
 * degrees), `cost`, `views` (the cost of each) and `searches`. */
nlohmann::json
ReportRegistration(const RigidRegistrationResult & result);

/** A picture of the X-ray with the outline of the model in its pose, and of what is left of the X-ray where the
 * model's radiograph is subtracted, times the factor that leaves least: the bone is gone where pose and density are
 * right. Rows of the picture are those of the detector. */
PictureImage::Pointer
DrawRegistration(const RadiographView & xray, const MeshArrays & model, const RigidPose & pose);
} // namespace bone

#endif
