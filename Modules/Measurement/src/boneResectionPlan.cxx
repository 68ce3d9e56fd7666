/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneResectionPlan.h"

#include "boneCellPiece.h"
#include "boneMeasureReport.h"

#include <Eigen/Eigenvalues>

#include <stdexcept>

namespace bone
{
namespace
{
/** Gauss-Legendre on 0..1, exact to degree 11. */
constexpr std::array<double, 6> GaussPlaces = { 0.033765242898423986, 0.16939530676686774, 0.38069040695840155,
                                                0.61930959304159845,  0.83060469323313226, 0.96623475710157601 };
constexpr std::array<double, 6> GaussWeights = { 0.085662246189585173, 0.18038078652406930, 0.23395696728634552,
                                                 0.23395696728634552,  0.18038078652406930, 0.085662246189585173 };

/** Integrals of 1, x, y, x^2, x y and y^2 over a section. */
struct PlaneSums
{
  double          area{ 0.0 };
  Vector2         first{ Vector2::Zero() };
  Eigen::Matrix2d second{ Eigen::Matrix2d::Zero() };

  void
  Add(double weight, const Vector2 & x)
  {
    area += weight;
    first += weight * x;
    second += weight * x * x.transpose();
  }
};

/** Moments about the centroid, in space. */
SectionMoments
CentralMoments(const PlaneSums & sums, const Vector3 & origin, const Vector3 & u, const Vector3 & v)
{
  SectionMoments moments;
  moments.area = sums.area;
  if (sums.area == 0.0)
  {
    return moments;
  }
  const Vector2                                        c = sums.first / sums.area;
  const Eigen::Matrix2d                                central = sums.second - sums.area * c * c.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(central);
  // The moment about an axis is that of the distances across it.
  moments.centroid = origin + c.x() * u + c.y() * v;
  moments.largest = solver.eigenvalues()[1];
  moments.smallest = solver.eigenvalues()[0];
  const Vector2 axis = solver.eigenvectors().col(0);
  moments.largestAxis = axis.x() * u + axis.y() * v;
  return moments;
}
} // namespace

SectionProperties
MeasureSection(const MeshArrays & mesh, const HalfSpace & plane)
{
  const Vector3 u = plane.normal.unitOrthogonal(), v = plane.normal.cross(u);
  PlaneSums     shape, density;
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
  {
    std::array<Vector3, 4> x;
    Eigen::Vector4d        height;
    for (int i = 0; i < 4; ++i)
    {
      x[i] = mesh.points[mesh.tetrahedra[t][i]] - plane.point;
      height[i] = plane.normal.dot(x[i]);
    }
    const auto polygon = ZeroPolygon(WholeCell(), height);
    for (std::size_t corner = 2; corner < polygon.size(); ++corner)
    {
      const std::array<Barycentric, 3> mu = { polygon[0], polygon[corner - 1], polygon[corner] };
      std::array<Vector2, 3>           p;
      for (int i = 0; i < 3; ++i)
      {
        const Vector3 at = mu[i][0] * x[0] + mu[i][1] * x[1] + mu[i][2] * x[2] + mu[i][3] * x[3];
        p[i] = { u.dot(at), v.dot(at) };
      }
      const Vector2 a = p[1] - p[0], b = p[2] - p[0];
      const double  twice = std::abs(a.x() * b.y() - a.y() * b.x());
      for (std::size_t i = 0; i < GaussPlaces.size(); ++i)
      {
        for (std::size_t j = 0; j < GaussPlaces.size(); ++j)
        {
          const double  s = GaussPlaces[i], r = (1.0 - s) * GaussPlaces[j];
          const double  weight = twice * GaussWeights[i] * GaussWeights[j] * (1.0 - s);
          const Vector2 at = p[0] + s * a + r * b;
          shape.Add(weight, at);
          if (mesh.HasDensity())
          {
            const Barycentric place = (1.0 - s - r) * mu[0] + s * mu[1] + r * mu[2];
            density.Add(weight * BernsteinValue(mesh.degree[t],
                                                mesh.coefficients.data() + t * BernsteinCount(mesh.maximumDegree),
                                                place),
                        at);
          }
        }
      }
    }
  }
  if (!(shape.area > 0.0))
  {
    throw std::invalid_argument("The plane does not cut the model.");
  }
  return { CentralMoments(shape, plane.point, u, v), CentralMoments(density, plane.point, u, v) };
}

MeasureList
PlanResection(const MeshArrays & mesh, const Vector3 & point, const Vector3 & normal, const std::string & name)
{
  const Solid             removed = MakeHalfSpace(point, normal), kept = MakeHalfSpace(point, -normal);
  const SectionProperties section = MeasureSection(mesh, removed.halfSpaces.front());
  MeasureList             list =
    MeasurePart(mesh, { name + ".removed", "what the resection removes", removed }, MeasureParameters());
  list.Append(MeasurePart(mesh, { name + ".kept", "what the resection leaves", kept }, MeasureParameters()));
  const std::string prefix = name + ".section.";
  const auto        add =
    [&](const char * what, std::vector<double> value, const std::string & unit, const char * definition) {
      list.measures.push_back({ prefix + what, std::move(value), unit, definition });
    };
  const auto coordinates = [](const Vector3 & x) { return std::vector<double>{ x.x(), x.y(), x.z() }; };
  add("area", { section.shape.area }, "mm^2", "Area of the bone's section with the plane");
  add("centroid", coordinates(section.shape.centroid), "mm", "Centroid of that area, in the model's space (LPS)");
  add("largestSecondMoment",
      { section.shape.largest },
      "mm^4",
      "Largest second moment of the section about an axis through its centroid in the plane");
  add("smallestSecondMoment", { section.shape.smallest }, "mm^4", "The smallest one, about the axis across");
  add("largestAxis",
      coordinates(section.shape.largestAxis),
      "",
      "Unit vector along the axis of the largest second moment");
  if (!mesh.HasDensity())
  {
    list.missing.push_back({ prefix + "densityWeightedArea", "the model holds no density: fit one to a CT" });
    return list;
  }
  const std::string unit = DensityQuantityName(mesh.quantity);
  add("densityWeightedArea", { section.density.area }, unit + " mm^2", "Integral of the density over the section");
  add("densityWeightedLargestSecondMoment",
      { section.density.largest },
      unit + " mm^4",
      "Largest second moment of the section weighted with the density, about an axis through its weighted centroid");
  add("densityWeightedSmallestSecondMoment", { section.density.smallest }, unit + " mm^4", "The smallest one");
  return list;
}
} // namespace bone
