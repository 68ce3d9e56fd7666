/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneModelPictures.h"

#include <gtest/gtest.h>

namespace ModelPicturesTests
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
  constexpr double side = 420, margin = 12, beside = 2 * margin + 22 + 20; // above and below: title, scale bar, margins
  for (const double across : { 18.0, 40.0 })
  {
    const Canvas canvas = DrawShapeModes(*Model(across), 1, { 0, 1, 0 }, { 0, 0, 1 });
    const double largest = std::max(across, 20.0);
    EXPECT_NEAR(canvas.GetWidth(), 3.0 * (side * across / largest + 20 + margin) + margin, 6) << across;
    EXPECT_NEAR(canvas.GetHeight(), side * 20.0 / largest + beside, 3) << across;
  }
}

TEST(DrawShapeModes, LettersAreLeftOutWhereTheModelHasNoPatientsAxes)
{
  const auto white = [](bool letters) {
    const auto image = DrawShapeModes(*Model(40.0), 1, { 0, 1, 0 }, { 0, 0, 1 }, letters).GetImage();
    int        count = 0;
    for (long c = 12; c < 452; ++c)
    {
      // Along the middle of the first panel, whose background is dark.
      count += image->GetPixel({ { c, 12 + 22 + 105 } })[0] > 200 ? 1 : 0;
    }
    return count;
  };
  EXPECT_GT(white(true), white(false));
}
} // namespace ModelPicturesTests
