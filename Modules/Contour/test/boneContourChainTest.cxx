/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneContourResampleFilter.h"
#include "boneMedialAxisFilter.h"
#include "boneSnakeContourFilter.h"

#include "boneContourTestTools.h"

#include <gtest/gtest.h>

namespace bone
{
namespace ContourChainTests
{
using Snake = SnakeContourFilter<TestCT>;

// A bowed, oval tube.
double
Tube(double x, double y, double z)
{
  return TubeDensity(x - 0.05 * z, 1.3 * y + 0.02 * z, 11.0, 8.0, 250.0);
}

struct Chain
{
  Snake::Pointer                 snake = Snake::New();
  ContourResampleFilter::Pointer resample = ContourResampleFilter::New();
  MedialAxisFilter::Pointer      axes = MedialAxisFilter::New();

  const ContourStack &
  Run()
  {
    resample->SetInput(snake->GetOutput());
    axes->SetInput(resample->GetOutput());
    axes->Update();
    return *axes->GetOutput();
  }
};

struct Motion
{
  Eigen::Matrix3d rotation{ Eigen::Matrix3d::Identity() };
  Vector3         shift{ Vector3::Zero() };

  // The same voxels elsewhere.
  template <typename TImage>
  void
  Apply(TImage * image) const
  {
    typename TImage::DirectionType direction;
    typename TImage::PointType     origin;
    const auto                     before = image->GetOrigin();
    const Vector3                  moved = rotation * Vector3(before[0], before[1], before[2]) + shift;
    for (unsigned int r = 0; r < 3; ++r)
    {
      origin[r] = moved[r];
      for (unsigned int c = 0; c < 3; ++c)
      {
        direction[r][c] = rotation(r, c);
      }
    }
    image->SetOrigin(origin);
    image->SetDirection(direction);
  }
};

Chain
FromLabel(const Motion & motion)
{
  Chain      chain;
  const auto ct = MakeImage<TestCT>({}, Tube);
  const auto labels = MakeImage<TestLabels>(
    {}, [](double x, double y, double z) { return std::hypot(x - 0.05 * z, 1.3 * y + 0.02 * z) < 11.0 ? 1 : 0; });
  motion.Apply(ct.GetPointer());
  motion.Apply(labels.GetPointer());
  chain.snake->SetInput(ct);
  chain.snake->SetLabelImage(labels);
  chain.snake->RefineLabelOutlineOn();
  return chain;
}

Chain
FromOneContour(const Motion & motion)
{
  Chain      chain;
  const auto ct = MakeImage<TestCT>({}, Tube);
  motion.Apply(ct.GetPointer());
  auto         start = ContourStack::New();
  ContourSlice slice;
  Contour      contour;
  start->SetFrame(motion.rotation.col(0), motion.rotation.col(1));
  for (const Vector2 & q : Ellipse(11.5, 9.0, 60, { 1.0, 0.0 }))
  {
    contour.points.push_back(motion.rotation * Vector3(q.x(), q.y(), 11.0) + motion.shift);
  }
  slice.origin = contour.points[0];
  slice.contours = { contour };
  start->SetSlices({ slice });
  chain.snake->SetInput(ct);
  chain.snake->SetInitialContours(start);
  return chain;
}

void
ExpectMoved(const ContourStack & a, const ContourStack & b, const Motion & motion)
{
  ASSERT_EQ(a.GetSlices().size(), b.GetSlices().size());
  for (std::size_t k = 0; k < a.GetSlices().size(); ++k)
  {
    const auto & before = a.GetSlices()[k].contours;
    const auto & after = b.GetSlices()[k].contours;
    ASSERT_EQ(before.size(), after.size());
    ASSERT_GE(before.size(), 3u); // periosteal, endosteal, axis
    for (std::size_t c = 0; c < before.size(); ++c)
    {
      ASSERT_EQ(before[c].points.size(), after[c].points.size());
      for (std::size_t i = 0; i < before[c].points.size(); ++i)
      {
        const Vector3 expected = motion.rotation * before[c].points[i] + motion.shift;
        ASSERT_LT((expected - after[c].points[i]).norm(), 1e-3) << "slice " << k << " contour " << c;
      }
    }
  }
}

Motion
FarAndOblique()
{
  return { Eigen::AngleAxisd(2.1, Vector3(1, -2, 0.5).normalized()).toRotationMatrix(), { 420.0, -310.0, 1250.0 } };
}

TEST(ContourChain, FromALabelMovesWithARigidMotion)
{
  Chain still = FromLabel({});
  Chain moved = FromLabel(FarAndOblique());
  ExpectMoved(still.Run(), moved.Run(), FarAndOblique());
}

TEST(ContourChain, FromOneContourMovesWithARigidMotion)
{
  Chain still = FromOneContour({});
  Chain moved = FromOneContour(FarAndOblique());
  ExpectMoved(still.Run(), moved.Run(), FarAndOblique());
}
} // namespace ContourChainTests
} // namespace bone
