/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef bonePhantomModel_h
#define bonePhantomModel_h

#include "boneTypes.h"

#include <array>
#include <memory>

namespace bone
{
/** \class PhantomModel
 * \brief A bone whose geometry and density are known exactly at every point of physical space (LPS, mm; density in HU).
 *
 * Three nested surfaces are the zero levels of functions phi_0 <= phi_1 <= phi_2, negative inside:
 *  - Periosteal: phi_0 < 0 is bone, elsewhere soft tissue of constant density;
 *  - Endosteal:  phi_1 < 0 is not cortical;
 *  - Cavity:     phi_2 < 0 is the medullary cavity (a model may have none).
 *
 * The ideal density is piecewise smooth: a smooth field of each material, with steps at the surfaces. The functions are
 * Lipschitz continuous with a known bound (so |phi_i| / bound never exceeds the distance to surface i), and close to
 * signed distances near their zero level; the *Distance methods turn them into distances.
 *
 * A model is immutable once made, so that threads and pipelines may share it. */
class PhantomModel
{
public:
  using Pointer = std::shared_ptr<const PhantomModel>;

  enum Surface : int
  {
    Periosteal = 0,
    Endosteal = 1,
    Cavity = 2
  };
  static constexpr int MaximumSurfaces = 3;
  /** Beyond this many standard deviations a Gaussian counts as 0: 7e-6 of the step at a surface. */
  static constexpr double GaussianTail = 4.35;

  using Levels = std::array<double, MaximumSurfaces>;
  using Gradients = std::array<Vector3, MaximumSurfaces>;
  /** Density (HU) of soft tissue, cortical bone, trabecular bone and marrow, indexed by \ref Region. */
  using Materials = std::array<double, 4>;

  /** A straight line that the bone follows; `direction` is a unit vector. */
  struct Axis
  {
    Vector3 point;
    Vector3 direction;
  };

  /** Closed interval in mm. */
  struct Interval
  {
    double lower;
    double upper;
  };

  PhantomModel() = default;
  PhantomModel(const PhantomModel &) = delete;
  PhantomModel &
  operator=(const PhantomModel &) = delete;
  virtual ~PhantomModel() = default;

  /** \name What a model defines
   * \{ */
  /** 2, or 3 where there is a medullary cavity. */
  virtual int
  GetNumberOfSurfaces() const = 0;
  /** phi_0, phi_1, phi_2 at x; a surface that is not there has +infinity. */
  virtual Levels
  EvaluateLevels(const Vector3 & x) const = 0;
  /** The same with gradients. */
  virtual Levels
  EvaluateLevels(const Vector3 & x, Gradients & gradients) const = 0;
  /** Largest norm of the gradient of phi_i. */
  virtual double
  GetLipschitzBound(int surface) const = 0;
  /** The material fields at x, each smoothly extended beyond its own layer; `levels` are those at x. Soft tissue is the
   * same everywhere. */
  virtual Materials
  EvaluateMaterials(const Vector3 & x, const Levels & levels) const = 0;
  /** Interval of x . direction (a unit vector) that the bone lies in; up to about 10 mm wider than the bone on each
   * side. An open end counts up to where it is cut. */
  virtual Interval
  GetExtent(const Vector3 & direction) const = 0;
  /** Long axis; the mean direction of a bone without shaft. Here the z axis. */
  virtual Axis
  GetLongitudinalAxis() const
  {
    return { Vector3::Zero(), Vector3::UnitZ() };
  }
  /** True where the bone goes on beyond the lower (upper) end of its extent along the axis: a cut shaft. */
  virtual bool
  GetOpenStart() const
  {
    return false;
  }
  virtual bool
  GetOpenEnd() const
  {
    return false;
  }
  /** \} */

  /** \name Ground truth that follows from it
   * \{ */
  /** 0 outside, 1 cortical, 2 trabecular, 3 medullary; see \ref Region. */
  int
  Region(const Vector3 & x) const;
  static int
  RegionOf(const Levels & levels);

  /** Ideal, unblurred density in HU. */
  double
  Density(const Vector3 & x) const;

  /** Density after a Gaussian point spread with standard deviations `sigma` (mm) along the columns of `axes`
   * (orthonormal); sigma 0 gives the ideal density. In coordinates in which the point spread is round, each surface's
   * function is averaged over the tangent plane, which is what its curvature amounts to, and taken along the normal as
   * a parabola or, where it bends, in steps; materials are those at x. For deviations well below the radius of
   * curvature.
   */
  double
  BlurredDensity(const Vector3 & x, const Eigen::Matrix3d & axes, const Vector3 & sigma) const;

  /** Closest point of a surface, by projection along the gradient and tangential correction (E. Hartmann,
   * doi:10.1007/s003710050133); x itself where the surface does not exist. Exact to 1e-6 mm where x is nearer to the
   * surface than to its centres of curvature; further away a nearby foot point. */
  virtual Vector3
  ClosestPoint(int surface, const Vector3 & x) const;

  /** Distance to a surface, negative inside; the sign is always exact. +infinity where the surface does not exist. */
  double
  Distance(int surface, const Vector3 & x) const;
  /** Distance to the periosteal surface, negative in the bone. */
  double
  SignedDistance(const Vector3 & x) const
  {
    return this->Distance(Periosteal, x);
  }

  /** Length (mm) of cortical bone along the inward normal at the periosteal point nearest x: up to the endosteal
   * surface, or up to the opposite periosteal surface where a plate has no trabecular layer. */
  double
  CorticalThickness(const Vector3 & x) const;

  /** Corners of the axis-aligned box of the bone. */
  Vector3
  GetLowerCorner() const;
  Vector3
  GetUpperCorner() const;
  /** \} */

private:
  /** Part of the Gaussian (of x + spread * y, y standard normal) inside a surface, whose gradient in y has the
   * direction `normal`. */
  double
  MeasureInside(int surface, const Vector3 & x, double level, const Eigen::Matrix3d & spread, const Vector3 & normal)
    const;
};
} // namespace bone

#endif
