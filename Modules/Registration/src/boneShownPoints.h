/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneShownPoints_h
#define boneShownPoints_h

#include "boneRadiographView.h"
#include "boneRigidPose.h"

#include <vector>

namespace bone
{
/** Which of the points every view shows at a pose, or would if they were moved by so many mm; all of them where that is
 * none. X-rays of a part of a long bone tell where that part is: what is far from it is no centre to turn it about. */
std::vector<std::size_t>
ShownPoints(const std::vector<Vector3> &        points,
            const RigidPose &                   pose,
            const std::vector<RadiographView> & views,
            double                              beyond);

/** The mean of those of the vectors. */
Vector3
MeanOf(const std::vector<Vector3> & vectors, const std::vector<std::size_t> & which);
} // namespace bone

#endif
