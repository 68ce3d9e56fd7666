/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneRegistrationReport.h"

#include "boneRegistrationTestBody.h"

#include <gtest/gtest.h>

#include <cmath>

namespace RegistrationReportTests
{
using namespace bone;

/** Share of two pictures' pixels that differ; 1 where their sizes do. */
double
Difference(const Canvas & a, const Canvas & b)
{
  const auto        x = a.GetImage(), y = b.GetImage();
  const auto        size = x->GetLargestPossibleRegion().GetSize();
  const std::size_t count = size[0] * size[1];
  if (size != y->GetLargestPossibleRegion().GetSize())
  {
    return 1.0;
  }
  std::size_t differing = 0;
  for (std::size_t k = 0; k < count; ++k)
  {
    differing += std::abs(x->GetBufferPointer()[k][0] - y->GetBufferPointer()[k][0]) > 30 ? 1 : 0;
  }
  return static_cast<double>(differing) / static_cast<double>(count);
}

TEST(DrawRegistration, LettersAreThePatientsAndNotTheViews)
{
  const MeshArrays     mesh = test::Body(6);
  const RigidPose      pose = test::PoseOf(3.0, -2.0, 1.0, 0.0, 0.0, 1.2);
  const RadiographView xray = test::XRayOf(mesh, test::ViewOf({ 0, 1, 0 }), pose);
  const Canvas         posed = DrawRegistration(xray, mesh, pose);
  // The same body, moved itself.
  MeshArrays moved = mesh;
  for (Vector3 & p : moved.points)
  {
    p = pose.Apply(p);
  }
  EXPECT_LT(Difference(DrawRegistration(xray, moved, RigidPose(), pose.rotation), posed), 1e-4);
  // Its letters alone are others where it is taken for a patient in the views' axes.
  const double letters = Difference(DrawRegistration(xray, moved, RigidPose()), posed);
  EXPECT_GT(letters, 2e-4);
  EXPECT_LT(letters, 0.02);
}

TEST(DrawRegistration, TheOutlineIsThatOfTheModelsPose)
{
  const MeshArrays     mesh = test::Body(6);
  const RadiographView xray = test::XRayOf(mesh, test::ViewOf({ 0, 1, 0 }), RigidPose());
  const Color          color = ContourStyles()[static_cast<std::size_t>(ContourKind::Periosteal)].color;
  /** Mean column and row of the outline's pixels on the first panel. */
  const auto middle = [&](const RigidPose & pose) {
    const auto image = DrawRegistration(xray, mesh, pose).GetImage();
    Vector2    sum = Vector2::Zero();
    int        count = 0;
    for (long r = 0; r < 500; ++r) // above the legend
    {
      for (long c = 0; c < 500; ++c)
      {
        const auto pixel = image->GetPixel({ { c, r } });
        if (pixel[0] == color[0] && pixel[1] == color[1] && pixel[2] == color[2])
        {
          sum += Vector2(c, r);
          ++count;
        }
      }
    }
    EXPECT_GT(count, 500);
    return Vector2(sum / count);
  };
  // Five canvas pixels for one of the detector's, on which 16 mm are 1000 / 700 times as far.
  const double  canvas = 16.0 * 1000.0 / 700.0 / 1.6 * 5.0;
  const Vector2 shift = middle(test::PoseOf(16.0, 0.0, 8.0, 0.0, 0.0, 0.0)) - middle(RigidPose());
  EXPECT_NEAR(shift.x(), -canvas, 4.0);
  EXPECT_NEAR(shift.y(), 0.5 * canvas, 4.0);
}
} // namespace RegistrationReportTests
