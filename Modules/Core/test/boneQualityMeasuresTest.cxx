/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneQualityMeasures.h"

#include "boneTestBodies.h"

#include <gtest/gtest.h>

#include <numeric>

using namespace bone;

namespace QualityMeasuresTests
{
const Vector3 A(1, 1, 1), B(-1, 1, -1), C(1, -1, -1), D(-1, -1, 1);

/** The regular tetrahedron, positively oriented. */
std::array<Vector3, 4>
Regular()
{
  return SignedVolume(A, B, C, D) > 0 ? std::array<Vector3, 4>{ A, B, C, D } : std::array<Vector3, 4>{ A, C, B, D };
}

TEST(QualityMeasures, RegularTetrahedronIsPerfect)
{
  const auto   t = Regular();
  const double angle = std::acos(1.0 / 3.0);
  for (double a : DihedralAngles(t[0], t[1], t[2], t[3]))
  {
    EXPECT_NEAR(a, angle, 1e-12);
  }
  EXPECT_NEAR(RadiusRatio(t[0], t[1], t[2], t[3]), 1.0, 1e-12);
  EXPECT_NEAR(ScaledJacobian(t[0], t[1], t[2], t[3]), 1.0, 1e-12);
  EXPECT_NEAR(EdgeRatio(t[0], t[1], t[2], t[3]), 1.0, 1e-12);
  EXPECT_NEAR(LargestDihedralCosine(t[0], t[1], t[2], t[3]), 1.0 / 3.0, 1e-12);
}

TEST(QualityMeasures, CornerOfACubeHasKnownValues)
{
  const Vector3 o(0, 0, 0), x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  const auto    angles = DihedralAngles(o, x, y, z);
  for (int e = 0; e < 3; ++e)
  {
    EXPECT_NEAR(angles[e], std::acos(0.0), 1e-12) << "edge " << e << " lies on an axis";
    EXPECT_NEAR(angles[5 - e], std::acos(1.0 / std::sqrt(3.0)), 1e-12);
  }
  const double inradius = 1.0 / (3.0 + std::sqrt(3.0)), circumradius = std::sqrt(3.0) / 2.0;
  EXPECT_NEAR(RadiusRatio(o, x, y, z), 3 * inradius / circumradius, 1e-12);
  EXPECT_NEAR(EdgeRatio(o, x, y, z), std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(ScaledJacobian(o, x, y, z), std::sqrt(2.0) / 2.0, 1e-12);
}

TEST(QualityMeasures, AreInvariantUnderRigidMotionScaleAndEvenRenumbering)
{
  const auto            mesh = test::MakeBall(2, { 2 }, 10, 0.2, 3);
  const Eigen::Matrix3d rotation = Eigen::AngleAxisd(0.7, Vector3(1, 2, 3).normalized()).toRotationMatrix();
  const Vector3         shift(10, -20, 30);
  for (const Id4 & t : mesh.tetrahedra)
  {
    std::array<Vector3, 4> p;
    for (int i = 0; i < 4; ++i)
    {
      p[i] = mesh.points[t[i]];
    }
    for (int m = 0; m < 5; ++m)
    {
      const auto   measure = static_cast<QualityMeasure>(m);
      const double value = ComputeQuality(measure, p[0], p[1], p[2], p[3]);
      EXPECT_NEAR(ComputeQuality(measure, p[1], p[2], p[0], p[3]), value, 1e-9);
      const auto move = [&](const Vector3 & x) { return Vector3(2.5 * (rotation * x) + shift); };
      EXPECT_NEAR(ComputeQuality(measure, move(p[0]), move(p[1]), move(p[2]), move(p[3])), value, 1e-9);
    }
  }
}

TEST(QualityMeasures, InvertedAndFlatTetrahedraAreSeen)
{
  const auto t = Regular();
  EXPECT_EQ(RadiusRatio(t[1], t[0], t[2], t[3]), 0.0);
  EXPECT_NEAR(ScaledJacobian(t[1], t[0], t[2], t[3]), -1.0, 1e-12);
  const Vector3 flat = (t[0] + t[1] + t[2]) / 3;
  EXPECT_NEAR(LargestDihedralCosine(t[0], t[1], t[2], flat), 1.0, 1e-12);
  EXPECT_EQ(LargestDihedralCosine(t[0], t[0], t[0], t[0]), 1.0);
  EXPECT_EQ(EdgeRatio(t[0], t[0], t[0], t[0]), 0.0);
}

TEST(QualityMeasures, SummaryCountsEveryTetrahedronOnce)
{
  const auto  mesh = test::MakeBall(3, { 1, 2 }, 10, 0.15, 5);
  std::size_t inRegions = 0;
  for (int m = 0; m < 5; ++m)
  {
    const auto all = SummarizeQuality(mesh, static_cast<QualityMeasure>(m), -1, 17);
    EXPECT_EQ(all.count, mesh.tetrahedra.size());
    EXPECT_EQ(std::accumulate(all.histogram.begin(), all.histogram.end(), std::size_t{ 0 }), all.count);
    EXPECT_LE(all.minimum, all.percentile1);
    EXPECT_LE(all.percentile1, all.median);
    EXPECT_LE(all.median, all.percentile99);
    EXPECT_LE(all.percentile99, all.maximum);
    EXPECT_GE(all.mean, all.minimum);
    EXPECT_LE(all.mean, all.maximum);
  }
  for (int region = 1; region <= 2; ++region)
  {
    inRegions += SummarizeQuality(mesh, QualityMeasure::RadiusRatio, region).count;
  }
  EXPECT_EQ(inRegions, mesh.tetrahedra.size());
  EXPECT_EQ(SummarizeQuality(mesh, QualityMeasure::RadiusRatio, 9).count, 0u);
  EXPECT_THROW(SummarizeQuality(mesh, QualityMeasure::RadiusRatio, -1, 0), std::invalid_argument);
}

TEST(QualityMeasures, CountsInvertedCellsExactly)
{
  auto mesh = test::MakeBall(2, { 2 }, 10, 0.1, 5);
  EXPECT_EQ(CountInverted(mesh), 0u);
  std::swap(mesh.tetrahedra[3][0], mesh.tetrahedra[3][1]);
  std::swap(mesh.tetrahedra[7][2], mesh.tetrahedra[7][3]);
  EXPECT_EQ(CountInverted(mesh), 2u);
}
} // namespace QualityMeasuresTests
