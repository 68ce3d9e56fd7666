/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneQualityMeasures_h
#define boneQualityMeasures_h

#include "boneMeshArrays.h"

#include <vector>

namespace bone
{
/** \defgroup Quality Quality of a tetrahedron a, b, c, d
 * P. M. Knupp, doi:10.1137/S1064827500371499; V. N. Parthasarathy et al., doi:10.1016/0168-874X(94)90033-7.
 * \{ */
enum class QualityMeasure : int
{
  MinimumDihedralAngle = 0, ///< rad, 0..acos(1/3) = 70.53 degrees; blind to orientation
  MaximumDihedralAngle = 1, ///< rad, acos(1/3)..pi; the smaller the better; blind to orientation
  RadiusRatio = 2,          ///< 3 r_in / R, 0..1; 0 for a flat or inverted tetrahedron
  ScaledJacobian = 3,       ///< sqrt(2) J / largest product of the three edges at a vertex, -1..1; negative if inverted
  EdgeRatio = 4             ///< shortest edge / longest edge, 0..1
};

/** The six dihedral angles in radians, in the order of TetraEdges. */
std::array<double, 6>
DihedralAngles(const Vector3 & a, const Vector3 & b, const Vector3 & c, const Vector3 & d);

/** Cosine of the smallest dihedral angle: the measure of inner loops, without an inverse cosine. The smaller the
 * better; 1 for a degenerate tetrahedron. */
double
LargestDihedralCosine(const Vector3 & a, const Vector3 & b, const Vector3 & c, const Vector3 & d);

double
RadiusRatio(const Vector3 & a, const Vector3 & b, const Vector3 & c, const Vector3 & d);

double
ScaledJacobian(const Vector3 & a, const Vector3 & b, const Vector3 & c, const Vector3 & d);

double
EdgeRatio(const Vector3 & a, const Vector3 & b, const Vector3 & c, const Vector3 & d);

double
ComputeQuality(QualityMeasure measure, const Vector3 & a, const Vector3 & b, const Vector3 & c, const Vector3 & d);
/** \} */

/** Distribution of one measure over the tetrahedra of a mesh. */
struct QualitySummary
{
  std::size_t count{ 0 };
  double      minimum{ 0.0 };
  double      maximum{ 0.0 };
  double      mean{ 0.0 };
  double      percentile1{ 0.0 };
  double      median{ 0.0 };
  double      percentile99{ 0.0 };

  /** Histogram: equal bins from `lower` to `upper`, the measure's own range; a value at the upper end is in the last.
   */
  double                   lower{ 0.0 };
  double                   upper{ 1.0 };
  std::vector<std::size_t> histogram;
};

/** Number of exactly flat or inverted tetrahedra. Exact. */
std::size_t
CountInverted(const MeshArrays & mesh);

/** \brief Distribution of a measure over all tetrahedra, or over those of one region.
 * \param region  the region looked at, or -1 for all.
 * \param bins    number of histogram bins, at least 1; otherwise std::invalid_argument. */
QualitySummary
SummarizeQuality(const MeshArrays & mesh, QualityMeasure measure, int region = -1, int bins = 36);
} // namespace bone

#endif
