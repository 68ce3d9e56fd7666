/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneClosedBSpline_h
#define boneClosedBSpline_h

#include "bonePlaneField.h"

namespace bone
{
/** \class ClosedBSpline
 * \brief A closed uniform cubic B-spline curve in the plane; its parameter runs over [0, number of control points). */
class ClosedBSpline
{
public:
  ClosedBSpline() = default;
  /** \pre at least four control points. */
  explicit ClosedBSpline(std::vector<Vector2> controlPoints);

  std::size_t
  GetNumberOfControlPoints() const
  {
    return m_Control.size();
  }
  const std::vector<Vector2> &
  GetControlPoints() const
  {
    return m_Control;
  }

  /** The point (order 0), first (1) or second (2) derivative at a parameter, which may be any real number. */
  Vector2
  Evaluate(double t, int order = 0) const;

  /** Signed curvature (1/mm), positive where the curve turns left. */
  double
  Curvature(double t) const;

private:
  std::vector<Vector2> m_Control;
};

/** A fitted curve and the largest distance (mm) from a point to it. */
struct BSplineFit
{
  ClosedBSpline curve;
  double        deviation{ 0.0 };
};

/** Least-squares fit with the given number of control points (at least 4, at most the number of points) to the points
 * of a closed polygon, parametrised by arc length, the parameters then corrected to the curve's nearest points. L.
 * Piegl, W. Tiller, "The NURBS Book", 9.4. */
BSplineFit
FitClosedBSpline(const Polygon & points, std::size_t numberOfControlPoints);

/** The fit with the fewest control points (to within a fifth) that passes all points within `tolerance` (mm), or one
 * with a control point for every second point where that cannot be had. */
BSplineFit
FitClosedBSplineWithin(const Polygon & points, double tolerance);
} // namespace bone

#endif
