/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef bonePrimitiveFit_h
#define bonePrimitiveFit_h

#include "boneTypes.h"

#include <vector>

namespace bone
{
/** A fitted sphere. */
struct FittedSphere
{
  Vector3 centre{ Vector3::Zero() }; ///< mm
  double  radius{ 0.0 };             ///< mm
  double  deviation{ 0.0 };          ///< mm, root mean square distance of the points, by their final weights
};

/** A fitted line. */
struct FittedLine
{
  Vector3 point{ Vector3::Zero() };      ///< mm, the points' weighted mean
  Vector3 direction{ Vector3::UnitZ() }; ///< of length 1; its sense is the caller's to choose
  double  deviation{ 0.0 };              ///< mm, root mean square distance of the points

  /** Distance of x to the line, mm. */
  double
  Distance(const Vector3 & x) const
  {
    return direction.cross(x - point).norm();
  }
};

/** A fitted plane. */
struct FittedPlane
{
  Vector3 point{ Vector3::Zero() };   ///< mm, the points' weighted mean
  Vector3 normal{ Vector3::UnitZ() }; ///< of length 1; its sense is the caller's to choose
  double  deviation{ 0.0 };           ///< mm, root mean square distance of the points, by their final weights
};

/** \defgroup PrimitiveFit Spheres, lines and planes fitted to weighted points
 *
 * `points` in mm, `weights` (areas, say) not negative, one for each point. Sphere and plane are robust: least squares
 * of the distances, reweighted by Tukey's biweight (4.685 standard deviations, the deviation by the median of the
 * residuals, at least a hundredth of a millimetre), until nothing moves. P. W. Holland and R. E. Welsch,
 * doi:10.1080/03610927708827533. The line is least squares alone.
 *
 * They throw std::invalid_argument where points of weight above 0 are too few or lie so that no such shape, or more
 * than one, fits them.
 * \{ */
FittedSphere
FitSphere(const std::vector<Vector3> & points, const std::vector<double> & weights);
FittedLine
FitLine(const std::vector<Vector3> & points, const std::vector<double> & weights);
FittedPlane
FitPlane(const std::vector<Vector3> & points, const std::vector<double> & weights);
/** \} */
} // namespace bone

#endif
