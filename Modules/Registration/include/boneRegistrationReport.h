/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneRegistrationReport_h
#define boneRegistrationReport_h

#include "boneCanvas.h"
#include "boneDeformableRegistration.h"
#include "boneDensityMesh.h"
#include "boneRigidRegistration.h"
#include "boneVolumeRegistration.h"

#include <nlohmann/json.hpp>

namespace bone
{
/** The result as JSON: `converged`, `quality` ("ok", "suspect", "failed"), `distinctness`, `transform` (4 x 4, rows),
 * `centre` (mm), `covariance` (6 x 6; mm, radians, about the centre, the geometry's axes), `standardDeviations` (mm,
 * degrees), `cost`, `views` (the cost of each), `leastDistinctness`, `searches`, `beyondSearch` and `ambiguous`. */
nlohmann::json
ReportRegistration(const RigidRegistrationResult & result);

/** Where views are, from where they are said to be (ViewCorrection): a list of `transform` (4 x 4, rows: the motion
 * that bodies seem to have made), `centre`, `covariance` and `standardDeviations` as above. */
nlohmann::json
ReportViewCorrections(const std::vector<ViewCorrection> & views);

/** The same of a deformable registration, `covariance` and `standardDeviations` being the pose's alone; without
 * `leastDistinctness` and `searches`, and with `shape`, `smooth` and `density` (coefficients in standard deviations),
 * `pointDeviation` (`mean` and `largest` standard deviation of a point's position, mm), `precision` (by which the cost
 * counts against the prior) and `posterior`: `volumeMm3`, `meanDensity` (HU) and `massHuMm3` of the whole bone, each
 * with `mean` and `standardDeviation`, and a list `regions` with the same of each `region`. */
nlohmann::json
ReportRegistration(const DeformableRegistrationResult & result);

/** The same of a registration to a CT, without `distinctness`, `cost` and `views`; with `mirrored` (whether the atlas
 * was reflected at x = 0 first), `support` (shares `visible` of the surface's points that the CT shows and `supported`
 * of these on an edge, median distance `residualMm`) before the surface settled, `settledSupport` after, `settledMm`
 * (mean motion), `settledShare` (of the way to the edges that it went), `repaired` (inverted tetrahedra made positive)
 * and `unsupported`: parts of the surface without an edge, each with `centre`, `extentMm` and `share`. */
nlohmann::json
ReportRegistration(const VolumeRegistrationResult & result);

/** The covariance of a deformable registration's pose as RigidRegistrationResult has it: of translation (mm) and
 * rotation vector (radians) about the centre, along the geometry's axes. */
Eigen::Matrix<double, 6, 6>
PoseCovariance(const DeformableRegistrationResult & result);

/** A picture of the X-ray with the outline of the model in its pose, and of what is left of the X-ray where the
 * model's radiograph is subtracted, times the factor that leaves least: the bone is gone where pose and density are
 * right. Rows of the picture are those of the detector. The letters at its sides are the patient's directions, whose
 * unit vectors (to the left, to the back, to the head) are the columns of `patientAxes` in the model's space. */
Canvas
DrawRegistration(const RadiographView &  xray,
                 const MeshArrays &      model,
                 const RigidPose &       pose,
                 const Eigen::Matrix3d & patientAxes = Eigen::Matrix3d::Identity());
} // namespace bone

#endif
