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

  /** Returns false for a flat tetrahedron. */
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

/** The density coefficients of a mesh, and the integrals of the selected tetrahedra. */
class CellDensity
{
public:
  CellDensity(const MeshCells & cells, const MeshRadiographParameters & parameters)
    : m_Cells(cells)
    , m_Parameters(parameters)
    , m_Stride(BernsteinCount(cells.maximumDegree))
  {}

  bool
  IsSelected(std::size_t t) const
  {
    return m_Cells.region.empty() ||
           (m_Cells.region[t] >= m_Parameters.minimumRegion && m_Cells.region[t] <= m_Parameters.maximumRegion);
  }
  const double *
  Coefficients(std::size_t t) const
  {
    return m_Cells.coefficients.data() + t * m_Stride;
  }
  /** Numbers from the first coefficient of one tetrahedron to that of the next. */
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
  /** Integral over a segment of the ray, whose length is in mm, in density units times mm. */
  double
  Integrate(std::size_t t, const Barycentric & entry, const Barycentric & exit, double length) const
  {
    return m_Parameters.scale * BernsteinSegmentIntegral(Degree(t), Coefficients(t), entry, exit, length) +
           m_Parameters.offset * length;
  }

private:
  const MeshCells &                m_Cells;
  const MeshRadiographParameters & m_Parameters;
  std::size_t                      m_Stride;
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
