/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSurfaceEnvelope.h"

#include "../../Core/test/boneTestBodies.h"

#include <gtest/gtest.h>

using namespace bone;

namespace SurfaceEnvelopeTests
{
constexpr IdType Tip = 0;
constexpr IdType Foot = 1;
constexpr IdType OnRim = 2;

/** A spike 1 mm wide and 3 mm high, as deep below. */
MeshArrays
Spike()
{
  MeshArrays mesh;
  mesh.points = { { 0, 0, 3 }, { 0, 0, -3 } };
  for (int i = 0; i < 6; ++i)
  {
    const double angle = i * std::acos(-1.0) / 3;
    mesh.points.push_back({ 0.5 * std::cos(angle), 0.5 * std::sin(angle), 0 });
    mesh.tetrahedra.push_back({ Tip, Foot, OnRim + i, OnRim + (i + 1) % 6 });
  }
  test::MakePositive(mesh);
  return mesh;
}

TEST(SurfaceEnvelope, ASpikeMayGoOnlyWhereItsTipIsWithinTheBound)
{
  // What is left is within 0.5 mm of the spike, but the spike's tip 3 mm from what is left.
  const TetraComplex complex(Spike());
  SurfaceEnvelope    envelope(complex);
  EXPECT_FALSE(envelope.Allows(complex, Tip, OnRim, 1.0));
  EXPECT_FALSE(envelope.Allows(complex, Tip, OnRim, 2.9));
  EXPECT_TRUE(envelope.Allows(complex, Tip, OnRim, 3.1));
}
} // namespace SurfaceEnvelopeTests
