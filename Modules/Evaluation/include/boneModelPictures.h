/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneModelPictures_h
#define boneModelPictures_h

#include "boneCanvas.h"

#include "boneStatisticalModel.h"
#include "boneTriangleSurface.h"

namespace bone
{
/** A surface as light falls on it from the eye, 0..1, NaN beside it: parallel projection along `direction` with `up`
 * upward, the nearer parts before the farther. `pixel`: mm; the middle of the panel is `centre`. */
Panel
ShadeSurface(const TriangleSurface & surface,
             const Vector3 &         centre,
             const Vector3 &         direction,
             const Vector3 &         up,
             double                  pixel,
             int                     columns,
             int                     rows);

/** The paper's Figure 14 a: exterior surfaces at -3, 0 and +3 standard deviations of the first modes of shape, a row a
 * mode. `direction`: of the look; `up`: of the picture, unit vectors at right angles. `letters`: whether the model lies
 * in the patient's axes (LPS), whose letters are then drawn. */
Canvas
DrawShapeModes(const StatisticalModel & model,
               int                      modes,
               const Vector3 &          direction,
               const Vector3 &          up,
               bool                     letters = true);

/** The paper's Figure 14 b: radiographs at -3, 0 and +3 standard deviations of the first mode of shape, and, where
 * there is a density, of its first mode; beside each its difference to the mean's. */
Canvas
DrawRadiographModes(const StatisticalModel & model, const Vector3 & direction, const Vector3 & up, bool letters = true);
} // namespace bone

#endif
