/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneRayCastRegistration_h
#define boneRayCastRegistration_h

#include "boneImageIO.h"
#include "boneRadiographView.h"
#include "boneRigidPose.h"

#include <vector>

namespace bone
{
/** \brief Rigid 2D/3D registration as ITK has had it since its example IntensityBased2D3DRegistration, for comparison.
 *
 * Radiographs of the CT's intensities above `threshold` by itk::RayCastInterpolateImageFunction, their normalized
 * correlation with X-rays that are reduced to some `pixels`, and itk::PowellOptimizer with that example's step lengths
 * and tolerances, over all views. `ct` must be seen by the X-rays as it lies. */
RigidPose
RegisterByRayCasting(const CTImage *                     ct,
                     const std::vector<RadiographView> & views,
                     const RigidPose &                   start,
                     int                                 pixels,
                     double                              threshold);
} // namespace bone

#endif
