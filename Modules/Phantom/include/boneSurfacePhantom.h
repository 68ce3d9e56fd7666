/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneSurfacePhantom_h
#define boneSurfacePhantom_h

#include "bonePhantomModel.h"
#include "boneTriangleDistance.h"

#include <cstdint>

namespace bone
{
/** Depths (mm), places along the bone (fractions of its length) and densities (HU) of a \ref SurfacePhantom; the
 * defaults suit a long bone of adult size such as a femur. */
struct SurfacePhantomParameters
{
  double shaftCortex{ 5.0 };            ///< depth of the endosteum in the shaft
  double endCortex{ 1.3 };              ///< depth of the endosteum at both ends
  double shaftStart{ 0.12 };            ///< the cortex thickens from here ...
  double shaftEnd{ 0.88 };              ///< ... and thins until here,
  double transition{ 0.22 };            ///< over this fraction of the length
  bool   medullaryCavity{ true };       ///<
  double cavityStart{ 0.26 };           ///<
  double cavityEnd{ 0.74 };             ///<
  double trabecularDepth{ 2.2 };        ///< least depth of trabecular bone around the cavity
  double softTissueDensity{ 40.0 };     ///<
  double shaftDensity{ 1620.0 };        ///< cortical bone of the shaft
  double endDensity{ 1280.0 };          ///< cortical bone of the ends
  double trabecularDensity{ 140.0 };    ///< trabecular bone, deep in the shaft
  double trabecularEndDensity{ 200.0 }; ///< additional, at the ends
  double trabecularRimDensity{ 120.0 }; ///< additional, just under the periosteum
  double marrowDensity{ -50.0 };        ///<

  /** The subject of a seed: independent draws of cortical depths and densities within ranges, nearer to the mean more
   * often. Seed 0 is the mean. The same everywhere. */
  static SurfacePhantomParameters
  ForSubject(std::uint64_t seed);
};

/** \class SurfacePhantom
 * \brief The CT of a bone whose shape is a given closed triangle surface, with a simulated interior.
 *
 * f(x), in 0..1, is the place along the principal axis of the surface (of largest extent, area-weighted) between the
 * ends of the bone; s(x) rises smoothly from 0 to 1 over `transition` from `shaftStart` on and falls to 0 at `shaftEnd`
 * (product of two quintic steps); d(x) is the exact depth below the surface. Then:
 *  - endosteum at the depth t = endCortex + (shaftCortex - endCortex) s;
 *  - cavity where d > t + trabecularDepth between the fractions cavityStart and cavityEnd, its edge rounded by 10 mm;
 *  - cortical density endDensity + (shaftDensity - endDensity) s;
 *  - trabecular density trabecularDensity + trabecularEndDensity (1 - s) + trabecularRimDensity exp(-d^2 / (2 4^2));
 *  - marrow constant.
 * Where the bone is thinner than 2 t it is cortical throughout. The bone is closed at both ends. */
class SurfacePhantom : public PhantomModel
{
public:
  /** Points (mm, LPS) and triangles of a closed surface. Throws itk::ExceptionObject where the surface is none (see
   * TriangleDistance), or a depth, fraction or transition is out of range. */
  SurfacePhantom(const std::vector<Vector3> &                    points,
                 const std::vector<TriangleDistance::Triangle> & triangles,
                 const SurfacePhantomParameters &                parameters = SurfacePhantomParameters());

  int
  GetNumberOfSurfaces() const override
  {
    return m_P.medullaryCavity ? 3 : 2;
  }
  Levels
  EvaluateLevels(const Vector3 & x) const override;
  Levels
  EvaluateLevels(const Vector3 & x, Gradients & gradients) const override;
  double
  GetLipschitzBound(int surface) const override;
  Materials
  EvaluateMaterials(const Vector3 & x, const Levels & levels) const override;
  Interval
  GetExtent(const Vector3 & direction) const override;
  /** Through the bone's lower end; the direction's largest component is positive. */
  Axis
  GetLongitudinalAxis() const override
  {
    return m_Axis;
  }
  Vector3
  ClosestPoint(int surface, const Vector3 & x) const override;

  const SurfacePhantomParameters &
  GetParameters() const
  {
    return m_P;
  }
  const TriangleDistance &
  GetSurface() const
  {
    return m_Surface;
  }
  /** Extent along the axis, mm. */
  double
  GetLength() const
  {
    return m_Length;
  }

private:
  void
  Verify() const;
  void
  FindAxis();
  /** s at x and its derivative along the axis. */
  std::pair<double, double>
  Shaft(const Vector3 & x) const;

  SurfacePhantomParameters m_P;
  TriangleDistance         m_Surface;
  Axis                     m_Axis{ Vector3::Zero(), Vector3::UnitZ() };
  double                   m_Length{ 1.0 };
};
} // namespace bone

#endif
