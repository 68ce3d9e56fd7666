/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneViewPresets.h"

#include <gtest/gtest.h>

namespace ViewPresetsTests
{
using namespace bone;

const ViewBox    box{ Vector3(-30, 10, 100), Vector3(50, 70, 260) };
const Vector3    middle(10, 40, 180);
constexpr int    pixels = 320;
constexpr double exact = 1e-9;
const ViewPreset allPresets[] = { ViewPreset::AP, ViewPreset::PA, ViewPreset::LeftLateral, ViewPreset::RightLateral };
const Vector3    toDetector[] = { Vector3(0, 1, 0), Vector3(0, -1, 0), Vector3(1, 0, 0), Vector3(-1, 0, 0) };
const Vector3    viewersRight[] = { Vector3(1, 0, 0), Vector3(1, 0, 0), Vector3(0, 1, 0), Vector3(0, -1, 0) };

XRayGeometry::Pointer
Make(const XRayGeometry::View & view)
{
  auto geometry = XRayGeometry::New();
  geometry->SetView(view);
  return geometry;
}

/** All corners of the box are seen, and one lies on each side of the detector's longer side. */
void
ExpectFramed(const XRayGeometry::View & view)
{
  const auto geometry = Make(view);
  Vector2    low(1e9, 1e9), high(-1e9, -1e9);
  for (int corner = 0; corner < 8; ++corner)
  {
    const Vector3 p(corner & 1 ? box.upper.x() : box.lower.x(),
                    corner & 2 ? box.upper.y() : box.lower.y(),
                    corner & 4 ? box.upper.z() : box.lower.z());
    low = low.cwiseMin(geometry->ProjectPoint(p));
    high = high.cwiseMax(geometry->ProjectPoint(p));
  }
  EXPECT_EQ(std::max(view.size[0], view.size[1]), pixels);
  EXPECT_EQ(view.spacing.x(), view.spacing.y());
  for (int k = 0; k < 2; ++k)
  {
    EXPECT_GE(low[k], -0.5 - 1e-6);
    EXPECT_LE(high[k], view.size[k] - 0.5 + 1e-6);
    EXPECT_LE(view.size[k] - (high[k] - low[k]), 1.0 + 1e-6);
  }
}

TEST(ViewPresets, PresetsLookAsTheirNamesSay)
{
  CArmView arm;
  arm.sourceToIsocenter = 800;
  arm.sourceToDetector = 1100;
  arm.primary = 33; // of no use
  for (int k = 0; k < 4; ++k)
  {
    const auto view = FramePreset(allPresets[k], arm, box, pixels);
    ExpectFramed(view);
    EXPECT_LE((view.source - (middle - 800 * toDetector[k])).norm(), exact) << k;
    EXPECT_NEAR((view.detectorOrigin - view.source).dot(toDetector[k]), 1100, exact) << k;
    EXPECT_LE((view.detectorU - viewersRight[k]).norm(), exact) << k;
    EXPECT_LE((view.detectorV - Vector3(0, 0, -1)).norm(), exact) << k;
  }
}

TEST(ViewPresets, ACArmsViewIsThatOfItsAnglesInAnotherFrame)
{
  CArmView arm;
  for (const double primary : { -120.0, 0.0, 30.0 })
  {
    for (const double secondary : { -90.0, -25.0, 0.0, 40.0 })
    {
      arm.primary = primary;
      arm.secondary = secondary;
      arm.isocenter = middle;
      const auto view = FrameCArm(arm, box, pixels), plain = FromCArm(arm);
      ExpectFramed(view);
      EXPECT_LE((view.source - plain.source).norm(), exact);
      EXPECT_LE((view.detectorU - plain.detectorU).norm(), exact);
      EXPECT_LE((view.detectorV - plain.detectorV).norm(), exact);
      EXPECT_NEAR((view.detectorOrigin - plain.detectorOrigin).dot(plain.direction), 0, exact);
      // Both see each point at one place of the detector's plane.
      const Vector3 point(20, 30, 120);
      const Vector2 a = Make(view)->ProjectPoint(point), b = Make(plain)->ProjectPoint(point);
      EXPECT_LE((Make(view)->GetPixelPoint(a.x(), a.y()) - Make(plain)->GetPixelPoint(b.x(), b.y())).norm(), 1e-6);
    }
  }
}

TEST(ViewPresets, RefuseABoxThatIsNotBetweenSourceAndDetector)
{
  CArmView arm;
  arm.sourceToIsocenter = 700;
  arm.sourceToDetector = 720;
  EXPECT_THROW(FramePreset(ViewPreset::AP, arm, box, pixels), itk::ExceptionObject);
  arm.sourceToIsocenter = 25;
  EXPECT_THROW(FramePreset(ViewPreset::AP, arm, box, pixels), itk::ExceptionObject);
  arm.sourceToIsocenter = 1100;
  arm.sourceToDetector = 1000;
  EXPECT_THROW(FrameCArm(arm, box, pixels), itk::ExceptionObject);
}
} // namespace ViewPresetsTests
