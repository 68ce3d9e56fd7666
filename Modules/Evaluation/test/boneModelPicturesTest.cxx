/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneModelPictures.h"

#include <gtest/gtest.h>

namespace
{
using namespace bone;

/** A tetrahedron, `across` mm wide along x and 20 mm high along z, whose mode moves a point by next to nothing. */
StatisticalModel::Pointer
Model(double across)
{
  StatisticalModelContent content;
  content.mean.points = { { 0, 0, 0 }, { across, 0, 0 }, { 0, 5, 0 }, { 0, 0, 20 } };
  content.mean.tetrahedra = { { { 0, 1, 2, 3 } } };
  content.mean.neighbors = ComputeFaceNeighbors(content.mean.tetrahedra);
  content.shape.mean = StackPoints(content.mean.points);
  content.shape.modes = Eigen::MatrixXd::Identity(12, 1);
  content.shape.variances = Eigen::VectorXd::Constant(1, 1e-6);
  auto model = StatisticalModel::New();
  model->SetContent(content);
  return model;
}

TEST(DrawShapeModes, PanelsHaveTheProportionsOfTheBone)
{
  constexpr int head = 30; // for the mode's name
  constexpr int side = 420, least = 220;
  for (const double across : { 18.0, 40.0 })
  {
    const auto   size = DrawShapeModes(*Model(across), 1, { 0, 1, 0 }, { 0, 0, 1 })->GetBufferedRegion().GetSize();
    const double largest = std::max(across, 20.0);
    EXPECT_NEAR(static_cast<double>(size[0]) / 3.0, std::max<double>(least, side * across / largest + 20), 3) << across;
    EXPECT_NEAR(static_cast<double>(size[1]), side * 20.0 / largest + head, 3) << across;
  }
}
} // namespace
