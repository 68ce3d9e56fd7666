/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneRayFrame_h
#define boneRayFrame_h

#include "boneXRayGeometry.h"

namespace bone
{
/** \class RayFrame
 * \brief The rays of a view: x(s) = Origin(c, r) + s Direction(c, r), both affine in the pixel (c, r).
 *
 * Point source: s runs from 0 at the source to 1 at the pixel, and a step of 1 is as long as the ray. Parallel beam: s
 * is in mm, 0 at the pixel, negative before it, and runs from -infinity. The depth t used for comparing planes is 1/s
 * with a point source and -s in a parallel beam: a plane's depth along the rays is then an affine function of the
 * pixel, and t falls along the ray to DetectorDepth() at the pixel. */
class RayFrame
{
public:
  /** The rays through the pixels' centres. */
  explicit RayFrame(const XRayGeometry::View & view);

  /** The same rays displaced by about 1e-8 of a pixel, so that meshes aligned with the detector have no ray within a
   * face or an edge: each ray then passes from cell to cell without gap or overlap. */
  static RayFrame
  Displaced(const XRayGeometry::View & view);

  bool
  IsParallel() const
  {
    return m_Parallel;
  }
  int
  Columns() const
  {
    return m_Columns;
  }
  int
  Rows() const
  {
    return m_Rows;
  }
  Vector3
  Origin(double column, double row) const
  {
    return m_Parallel ? Vector3(m_Origin + column * m_StepU + row * m_StepV) : m_Origin;
  }
  Vector3
  Direction(double column, double row) const
  {
    return m_Parallel ? m_Direction : Vector3(m_Direction + column * m_StepU + row * m_StepV);
  }
  /** Length in mm of a step of 1 in s. */
  double
  StepLength(double column, double row) const
  {
    return m_Parallel ? 1.0 : Direction(column, row).norm();
  }
  /** Of a row's pixels [firstColumn, endColumn), in single precision. */
  void
  StepLengths(int row, int firstColumn, int endColumn, float * lengths) const;
  double
  DetectorDepth() const
  {
    return m_Parallel ? 0.0 : 1.0;
  }
  /** From depth t to s. */
  double
  Parameter(double depth) const
  {
    return m_Parallel ? -depth : 1.0 / depth;
  }

  /** A point as (column, row, s). Column and row of a point at or behind the source's plane (s <= 0) mean nothing. */
  Vector3
  Project(const Vector3 & point) const;

  /** From a displacement in space to (s, column s, row s), in a parallel beam to (s, column, row). */
  const Eigen::Matrix3d &
  ToPixel() const
  {
    return m_ToPixel;
  }

  /** mu(s) = a + g . x(s) for an affine function of space, as f . t + (f0 + c fc + r fr), whose sign is that of mu
   * where s is within the ray (it is mu times t with a point source). */
  struct DepthLine
  {
    double depth;    ///< factor of t
    double constant; ///< at column 0, row 0
    double column;   ///< per column
    double row;      ///< per row
    double
    At(double c, double r) const
    {
      return constant + c * column + r * row;
    }
  };
  DepthLine
  Restrict(double a, const Vector3 & g) const;

private:
  RayFrame() = default;

  bool    m_Parallel{ false };
  int     m_Columns{ 0 };
  int     m_Rows{ 0 };
  Vector3 m_Origin;    ///< the source; parallel: centre of pixel (0, 0)
  Vector3 m_Direction; ///< from the source to pixel (0, 0); parallel: the beam
  Vector3 m_StepU;     ///< mm per column
  Vector3 m_StepV;     ///< mm per row

  Eigen::Matrix3d m_ToPixel;
};
} // namespace bone

#endif
