/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneRayCell_h
#define boneRayCell_h

#include "boneBernstein.h"
#include "boneMeshRadiograph.h"
#include "boneRayFrame.h"

namespace bone
{
/** The barycentric coordinates of a tetrahedron as affine functions of space. */
struct AffineBarycentric
{
  Eigen::Vector4d             constant;
  Eigen::Matrix<double, 4, 3> gradient;

  /** False for a flat tetrahedron. */
  bool
  Set(const Vector3 & a, const Vector3 & b, const Vector3 & c, const Vector3 & d);

  Barycentric
  At(const Vector3 & x) const
  {
    return constant + gradient * x;
  }
};

/** The faces' planes of a tetrahedron along the rays. */
using CellLines = std::array<RayFrame::DepthLine, 4>;
CellLines
RestrictToRays(const RayFrame & frame, const AffineBarycentric & mu);

/** Density coefficients and what is to be integrated of them. */
class CellDensity
{
public:
  CellDensity(const MeshArrays & cells, const MeshRadiographOptions & options)
    : m_Cells(cells)
    , m_Options(options)
    , m_Stride(BernsteinCount(cells.maximumDegree))
  {}

  bool
  IsSelected(std::size_t t) const
  {
    return m_Cells.region.empty() ||
           (m_Cells.region[t] >= m_Options.minimumRegion && m_Cells.region[t] <= m_Options.maximumRegion);
  }
  const double *
  Coefficients(std::size_t t) const
  {
    return m_Cells.coefficients.data() + t * m_Stride;
  }
  /** From one tetrahedron's coefficients to the next. */
  std::size_t
  Stride() const
  {
    return m_Stride;
  }
  int
  Degree(std::size_t t) const
  {
    return m_Cells.degree[t];
  }
  /** Integral over a segment of the ray, both ends by their depth, in density units times mm. */
  double
  Integrate(std::size_t t, const Barycentric & entry, const Barycentric & exit, double length) const
  {
    return m_Options.scale * BernsteinSegmentIntegral(Degree(t), Coefficients(t), entry, exit, length) +
           m_Options.offset * length;
  }

private:
  const MeshArrays &            m_Cells;
  const MeshRadiographOptions & m_Options;
  std::size_t                   m_Stride;
};

/** A run of columns of one row, narrowed by conditions that are affine in the column. */
struct ColumnRun
{
  double first;
  double last;

  /** Keeps the columns c where constant + c * perColumn >= 0. */
  void
  Keep(double constant, double perColumn);
};
} // namespace bone

#endif
