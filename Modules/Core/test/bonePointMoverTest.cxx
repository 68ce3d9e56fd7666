/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "bonePointMover.h"

#include "boneTestBodies.h"
#include "boneTetraFlips.h"

#include <gtest/gtest.h>

#include <random>

using namespace bone;

namespace PointMoverTests
{
/** Whether all cells around p are positive. */
bool
IsPositive(const TetraComplex & complex, IdType p)
{
  const auto & x = complex.Points();
  const auto & star = complex.Star(p);
  return std::all_of(star.begin(), star.end(), [&](IdType t) {
    const Id4 & c = complex.Cell(t);
    return SignedVolume(x[c[0]], x[c[1]], x[c[2]], x[c[3]]) > 0;
  });
}

TEST(PointMover, AnglesBelowTheFloorMayOnlyGrow)
{
  TetraComplex                           complex(test::MakeBall(4, { 1, 2 }, 12, 0.15, 3));
  PointMover                             mover(complex);
  std::mt19937                           random(5);
  std::uniform_real_distribution<double> uniform(-0.8, 0.8);
  const double                           floor = std::cos(0.4);
  std::array<int, 3>                     seen{};
  for (int i = 0; i < 4000; ++i)
  {
    const IdType p = static_cast<IdType>(random() % complex.Points().size());
    if (complex.Dimension(p) < 3)
    {
      continue;
    }
    const Vector3 before = complex.Points()[p];
    const Vector3 x = before + Vector3(uniform(random), uniform(random), uniform(random));
    const double  former = mover.WorstCosine(p);
    complex.TryPoint(p, x);
    const bool   positive = IsPositive(complex, p);
    const double worst = mover.WorstCosine(p);
    complex.TryPoint(p, before);
    const auto expected = !positive                         ? MeshOperation::Orientation
                          : worst > std::max(former, floor) ? MeshOperation::Quality
                                                            : MeshOperation::Done;
    EXPECT_EQ(mover.TryMove(p, x, floor), expected);
    EXPECT_EQ(complex.Points()[p], expected == MeshOperation::Done ? x : before);
    ++seen[expected == MeshOperation::Done ? 0 : worst > former ? 1 : 2];
    EXPECT_EQ(mover.TryMove(p, before, 1.0) == MeshOperation::Done, true) << "a floor of 0 degrees refuses nothing";
  }
  EXPECT_GT(seen[0], 100);
  EXPECT_GT(seen[1], 100);
}
} // namespace PointMoverTests
