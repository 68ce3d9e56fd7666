/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneXRayGeometry.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <limits>

namespace XRayGeometryTests
{
using bone::Vector3;
using bone::XRayGeometry;

XRayGeometry::View
Changed(void (*change)(XRayGeometry::View &))
{
  XRayGeometry::View view;
  change(view);
  return view;
}

TEST(XRayGeometry, TheDefaultViewIsUsable)
{
  const auto geometry = XRayGeometry::New();
  EXPECT_NO_THROW(geometry->SetView(XRayGeometry::View()));
}

TEST(XRayGeometry, IsModifiedOnlyByAChange)
{
  const auto geometry = XRayGeometry::New();
  auto       view = geometry->GetView();
  const auto before = geometry->GetMTime();
  geometry->SetView(view);
  EXPECT_EQ(geometry->GetMTime(), before);
  view.source.x() += 1;
  geometry->SetView(view);
  EXPECT_GT(geometry->GetMTime(), before);
  EXPECT_EQ(geometry->GetView().source.x(), view.source.x());
}

TEST(XRayGeometry, PixelPointsFollowTheAxes)
{
  const auto              geometry = XRayGeometry::New();
  auto                    view = geometry->GetView();
  const Eigen::AngleAxisd turn(0.7, Vector3(1, 2, 3).normalized());
  view.detectorOrigin = Vector3(5, 6, 7);
  view.detectorU = turn * Vector3::UnitX();
  view.detectorV = turn * Vector3::UnitY();
  view.spacing = { 0.25, 0.5 };
  geometry->SetView(view);
  EXPECT_TRUE(geometry->GetPixelPoint(0, 0).isApprox(view.detectorOrigin));
  const Vector3 expected = view.detectorOrigin + turn * Vector3(4 * 0.25, 3 * 0.5, 0);
  EXPECT_TRUE(geometry->GetPixelPoint(4, 3).isApprox(expected, 1e-14));
}

TEST(XRayGeometry, RefusesViewsThatCannotBe)
{
  const auto geometry = XRayGeometry::New();
  const auto before = geometry->GetMTime();
  const auto refuses = [&](void (*change)(XRayGeometry::View &)) {
    EXPECT_THROW(geometry->SetView(Changed(change)), itk::ExceptionObject);
  };
  using View = XRayGeometry::View;
  refuses([](View & v) { v.source.y() = std::numeric_limits<double>::quiet_NaN(); });
  refuses([](View & v) { v.detectorOrigin.x() = std::numeric_limits<double>::infinity(); });
  refuses([](View & v) { v.size[0] = 0; });
  refuses([](View & v) { v.size[1] = -4; });
  refuses([](View & v) { v.spacing.x() = 0; });
  refuses([](View & v) { v.spacing.y() = std::numeric_limits<double>::quiet_NaN(); });
  refuses([](View & v) { v.detectorU *= 1.001; });
  refuses([](View & v) { v.detectorV = Vector3(0.1, 0, -1).normalized(); });
  refuses([](View & v) { v.source = Vector3(3, 0, 4); });
  refuses([](View & v) {
    v.parallel = true;
    v.direction = Vector3(0, 2, 0);
  });
  refuses([](View & v) {
    v.parallel = true;
    v.direction = Vector3(0.6, 0, 0.8);
  });
  EXPECT_EQ(geometry->GetMTime(), before);
}

TEST(XRayGeometry, AParallelBeamNeedsNoSource)
{
  const auto geometry = XRayGeometry::New();
  EXPECT_NO_THROW(geometry->SetView(Changed([](XRayGeometry::View & v) {
    v.parallel = true;
    v.source = Vector3::Zero();
  })));
}

TEST(XRayGeometry, FramingShowsTheBoxTightly)
{
  const Vector3 lower(-30, -20, 100), upper(40, 60, 300);
  const Vector3 beam = Vector3(1, 2, 0.5).normalized();
  const auto    view = XRayGeometry::Framing(lower, upper, beam, Vector3::UnitZ(), 800, 1100, 256);
  const auto    geometry = XRayGeometry::New();
  geometry->SetView(view);
  EXPECT_EQ(std::max(view.size[0], view.size[1]), 256);
  EXPECT_EQ(view.spacing.x(), view.spacing.y());
  EXPECT_TRUE(view.detectorU.cross(view.detectorV).isApprox(beam, 1e-12));
  EXPECT_LT(view.detectorV.z(), 0) << "rows run downwards";
  EXPECT_NEAR((0.5 * (lower + upper) - view.source).norm(), 800, 1e-9);

  double low[2] = { 1e9, 1e9 }, high[2] = { -1e9, -1e9 };
  for (int corner = 0; corner < 8; ++corner)
  {
    const Vector3 p(
      corner & 1 ? upper.x() : lower.x(), corner & 2 ? upper.y() : lower.y(), corner & 4 ? upper.z() : lower.z());
    const Vector3 ray = p - view.source;
    const Vector3 hit = view.source + ray * (1100 / ray.dot(beam)) - view.detectorOrigin;
    const double  pixel[2] = { hit.dot(view.detectorU) / view.spacing.x(), hit.dot(view.detectorV) / view.spacing.y() };
    for (int k = 0; k < 2; ++k)
    {
      low[k] = std::min(low[k], pixel[k]);
      high[k] = std::max(high[k], pixel[k]);
    }
  }
  for (int k = 0; k < 2; ++k)
  {
    EXPECT_GE(low[k], -0.5 - 1e-9);
    EXPECT_LE(high[k], view.size[k] - 0.5 + 1e-9);
    EXPECT_LE(view.size[k] - (high[k] - low[k]), 1.0 + 1e-9) << "just large enough";
  }
}

TEST(XRayGeometry, FramingRefusesABoxThatReachesTheSourceOrTheDetector)
{
  const Vector3 lower(-50, -50, -50), upper(50, 50, 50);
  const Vector3 beam = Vector3::UnitY(), up = Vector3::UnitZ();
  EXPECT_THROW(XRayGeometry::Framing(lower, upper, beam, up, 40, 1000, 64), itk::ExceptionObject);
  EXPECT_THROW(XRayGeometry::Framing(lower, upper, beam, up, 980, 1000, 64), itk::ExceptionObject);
  EXPECT_THROW(XRayGeometry::Framing(lower, upper, beam, beam, 500, 1000, 64), itk::ExceptionObject);
  EXPECT_THROW(XRayGeometry::Framing(upper, lower, beam, up, 500, 1000, 64), itk::ExceptionObject);
}

TEST(XRayGeometry, FramingFindsDistancesForABoxOfAnyDepth)
{
  const Vector3 up = Vector3::UnitZ();
  for (const double depth : { 1.0, 399.0, 401.0, 700.0, 5000.0 })
  {
    for (const Vector3 & beam : { Vector3(0, 1, 0), Vector3(-1, 0, 0), Vector3(1, 2, 0.5), Vector3(-1, 1, -1) })
    {
      const Vector3 lower(-0.5 * depth, -0.5 * depth, 10), upper(0.5 * depth, 0.5 * depth, 90);
      const auto    view = XRayGeometry::Framing(lower, upper, beam, up, 64); // a box outside is an error
      const double  toCentre = (0.5 * (lower + upper) - view.source).norm();
      const double  reach = 0.5 * (upper - lower).dot(beam.normalized().cwiseAbs());
      EXPECT_GE(toCentre, 3.99 * reach);
      EXPECT_EQ(std::max(view.size[0], view.size[1]), 64);
      if (reach < 190)
      {
        const Vector3 normal = view.detectorU.cross(view.detectorV);
        EXPECT_NEAR(toCentre, 1000, 1e-9);
        EXPECT_NEAR((view.detectorOrigin - view.source).dot(normal), 1200, 1e-9);
      }
    }
  }
}

TEST(XRayGeometry, GraftCopiesTheView)
{
  const auto from = XRayGeometry::New(), to = XRayGeometry::New();
  auto       view = from->GetView();
  view.size = { { 7, 9 } };
  from->SetView(view);
  to->Graft(from);
  EXPECT_EQ(to->GetView().size[1], 9);
}
} // namespace XRayGeometryTests
