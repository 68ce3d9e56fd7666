/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneQualityMeasures.h"

#include "bonePredicates.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace bone
{
namespace
{
constexpr double Pi = 3.14159265358979323846;

/** Outward normals of the four faces, face i opposite vertex i, their lengths being twice the faces' areas. */
std::array<Vector3, 4>
FaceNormals(const Vector3 & a, const Vector3 & b, const Vector3 & c, const Vector3 & d)
{
  const Vector3 ab = b - a, ac = c - a, ad = d - a;
  const Vector3 n1 = ad.cross(ac), n2 = ab.cross(ad), n3 = ac.cross(ab);
  return { -(n1 + n2 + n3), n1, n2, n3 };
}

/** Cosines of the dihedral angles, in the order of TetraEdges; 1 where a face is degenerate. */
std::array<double, 6>
DihedralCosines(const Vector3 & a, const Vector3 & b, const Vector3 & c, const Vector3 & d)
{
  const std::array<Vector3, 4> n = FaceNormals(a, b, c, d);
  std::array<double, 4>        inverse;
  for (int i = 0; i < 4; ++i)
  {
    const double length = n[i].norm();
    inverse[i] = length > 0 ? 1.0 / length : 0.0;
  }
  std::array<double, 6> cosines;
  for (int e = 0; e < 6; ++e)
  {
    // The faces that meet in edge e are those opposite the vertices of the opposite edge.
    const int    i = TetraEdges[5 - e][0], j = TetraEdges[5 - e][1];
    const double scale = inverse[i] * inverse[j];
    cosines[e] = scale > 0 ? std::clamp(-n[i].dot(n[j]) * scale, -1.0, 1.0) : 1.0;
  }
  return cosines;
}

std::array<double, 2>
RangeOf(QualityMeasure measure)
{
  switch (measure)
  {
    case QualityMeasure::MinimumDihedralAngle:
      return { 0.0, 0.5 * Pi };
    case QualityMeasure::MaximumDihedralAngle:
      return { 0.0, Pi };
    case QualityMeasure::ScaledJacobian:
      return { -1.0, 1.0 };
    case QualityMeasure::RadiusRatio:
    case QualityMeasure::EdgeRatio:
      break;
  }
  return { 0.0, 1.0 };
}
} // namespace

std::array<double, 6>
DihedralAngles(const Vector3 & a, const Vector3 & b, const Vector3 & c, const Vector3 & d)
{
  std::array<double, 6> angles = DihedralCosines(a, b, c, d);
  for (double & angle : angles)
  {
    angle = std::acos(angle);
  }
  return angles;
}

double
LargestDihedralCosine(const Vector3 & a, const Vector3 & b, const Vector3 & c, const Vector3 & d)
{
  // Normals of the faces opposite b, c and d; that opposite a looks along -n0.
  const Vector3 ab = b - a, ac = c - a, ad = d - a;
  const Vector3 n1 = ad.cross(ac), n2 = ab.cross(ad), n3 = ac.cross(ab);
  const Vector3 n0 = n1 + n2 + n3;
  const double  q0 = n0.squaredNorm(), q1 = n1.squaredNorm(), q2 = n2.squaredNorm(), q3 = n3.squaredNorm();
  if (!(q0 > 0 && q1 > 0 && q2 > 0 && q3 > 0))
  {
    return 1.0;
  }
  const double r0 = 1.0 / std::sqrt(q0), r1 = 1.0 / std::sqrt(q1), r2 = 1.0 / std::sqrt(q2), r3 = 1.0 / std::sqrt(q3);
  const double outer = std::max({ n0.dot(n1) * r1, n0.dot(n2) * r2, n0.dot(n3) * r3 }) * r0;
  const double inner = std::max({ -n1.dot(n2) * r1 * r2, -n1.dot(n3) * r1 * r3, -n2.dot(n3) * r2 * r3 });
  return std::clamp(std::max(inner, outer), -1.0, 1.0);
}

double
RadiusRatio(const Vector3 & a, const Vector3 & b, const Vector3 & c, const Vector3 & d)
{
  const double sixVolume = (b - a).cross(c - a).dot(d - a);
  if (!(sixVolume > 0))
  {
    return 0.0;
  }
  double twiceArea = 0.0;
  for (const Vector3 & n : FaceNormals(a, b, c, d))
  {
    twiceArea += n.norm();
  }
  const double u = (b - a).norm() * (c - d).norm();
  const double v = (c - a).norm() * (b - d).norm();
  const double w = (d - a).norm() * (b - c).norm();
  const double product = (u + v + w) * (u + v - w) * (u - v + w) * (-u + v + w);
  if (!(product > 0))
  {
    return 0.0;
  }
  const double inradius = sixVolume / twiceArea;
  const double circumradius = std::sqrt(product) / (4.0 * sixVolume);
  return std::min(1.0, 3.0 * inradius / circumradius);
}

double
ScaledJacobian(const Vector3 & a, const Vector3 & b, const Vector3 & c, const Vector3 & d)
{
  const double ab = (b - a).norm(), ac = (c - a).norm(), ad = (d - a).norm();
  const double bc = (c - b).norm(), bd = (d - b).norm(), cd = (d - c).norm();
  const double largest = std::max({ ab * ac * ad, ab * bc * bd, ac * bc * cd, ad * bd * cd });
  return largest > 0 ? std::sqrt(2.0) * (b - a).cross(c - a).dot(d - a) / largest : 0.0;
}

double
EdgeRatio(const Vector3 & a, const Vector3 & b, const Vector3 & c, const Vector3 & d)
{
  const std::array<const Vector3 *, 4> p = { &a, &b, &c, &d };
  double                               shortest = std::numeric_limits<double>::max(), longest = 0.0;
  for (const auto & edge : TetraEdges)
  {
    const double length = (*p[edge[0]] - *p[edge[1]]).squaredNorm();
    shortest = std::min(shortest, length);
    longest = std::max(longest, length);
  }
  return longest > 0 ? std::sqrt(shortest / longest) : 0.0;
}

double
ComputeQuality(QualityMeasure measure, const Vector3 & a, const Vector3 & b, const Vector3 & c, const Vector3 & d)
{
  switch (measure)
  {
    case QualityMeasure::MinimumDihedralAngle:
      return std::acos(LargestDihedralCosine(a, b, c, d));
    case QualityMeasure::MaximumDihedralAngle:
    {
      const std::array<double, 6> cosines = DihedralCosines(a, b, c, d);
      return std::acos(*std::min_element(cosines.begin(), cosines.end()));
    }
    case QualityMeasure::RadiusRatio:
      return RadiusRatio(a, b, c, d);
    case QualityMeasure::ScaledJacobian:
      return ScaledJacobian(a, b, c, d);
    case QualityMeasure::EdgeRatio:
      return EdgeRatio(a, b, c, d);
  }
  throw std::invalid_argument("ComputeQuality: unknown measure.");
}

std::size_t
CountInverted(const MeshArrays & mesh)
{
  const auto & p = mesh.points;
  return static_cast<std::size_t>(std::count_if(mesh.tetrahedra.begin(), mesh.tetrahedra.end(), [&p](const Id4 & t) {
    return Orient3D(p[t[0]], p[t[1]], p[t[2]], p[t[3]]) <= 0;
  }));
}

QualitySummary
SummarizeQuality(const MeshArrays & mesh, QualityMeasure measure, int region, int bins)
{
  if (bins < 1)
  {
    throw std::invalid_argument("SummarizeQuality: the number of bins must be at least 1.");
  }
  if (region >= 0 && mesh.region.size() != mesh.tetrahedra.size())
  {
    throw std::invalid_argument("SummarizeQuality: the mesh has no regions; ask for region -1 (all).");
  }
  std::vector<double> values;
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
  {
    if (region < 0 || mesh.region[t] == region)
    {
      const Id4 & v = mesh.tetrahedra[t];
      values.push_back(
        ComputeQuality(measure, mesh.points[v[0]], mesh.points[v[1]], mesh.points[v[2]], mesh.points[v[3]]));
    }
  }
  QualitySummary summary;
  summary.lower = RangeOf(measure)[0];
  summary.upper = RangeOf(measure)[1];
  summary.histogram.assign(bins, 0);
  summary.count = values.size();
  if (values.empty())
  {
    return summary;
  }
  std::sort(values.begin(), values.end());
  const auto at = [&values](double fraction) {
    return values[static_cast<std::size_t>(std::lround(fraction * static_cast<double>(values.size() - 1)))];
  };
  summary.minimum = values.front();
  summary.maximum = values.back();
  summary.percentile1 = at(0.01);
  summary.median = at(0.5);
  summary.percentile99 = at(0.99);
  double sum = 0.0;
  for (double value : values)
  {
    sum += value;
    const double position = (value - summary.lower) / (summary.upper - summary.lower) * bins;
    ++summary.histogram[std::clamp(static_cast<int>(position), 0, bins - 1)];
  }
  summary.mean = sum / static_cast<double>(values.size());
  return summary;
}
} // namespace bone
