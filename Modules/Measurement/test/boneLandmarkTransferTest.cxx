/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneLandmarkTransfer.h"

#include "boneTestBodies.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace LandmarkTransferTests
{
using namespace bone;

const std::vector<Landmark> &
Places()
{
  static const std::vector<Landmark> landmarks = { { "inside", Vector3(2.2, 1.4, 8.1) },
                                                   { "beside", Vector3(25.0, 3.0, 11.0) },
                                                   { "beyond", Vector3(1.0, -2.0, -6.0) } };
  return landmarks;
}

TEST(LandmarkTransfer, OntoTheStandardItselfIsTheNearestPointOfTheModel)
{
  const MeshArrays mesh = test::MakeTube({});
  const auto       found = PlaceLandmarks(mesh, LocateLandmarks(mesh, Places()));
  ASSERT_EQ(found.size(), 3u);
  EXPECT_NEAR((found[0].point - Places()[0].point).norm(), 0.0, 1e-12);
  EXPECT_NEAR((found[2].point - Vector3(1.0, -2.0, 0.0)).norm(), 0.0, 1e-12); // the end is flat at z = 0
  const auto places = LocateLandmarks(mesh, Places());
  EXPECT_EQ(places[0].place.distance, 0.0);
  EXPECT_NEAR(places[1].place.distance, (found[1].point - Places()[1].point).norm(), 1e-12);
  EXPECT_NEAR(places[2].place.distance, 6.0, 1e-12);
  EXPECT_EQ(found[1].name, "beside");
}

TEST(LandmarkTransfer, WithinTheMeshMovesByAnAffineMapOfIt)
{
  const MeshArrays standard = test::MakeTube({});
  MeshArrays       subject = standard;
  Eigen::Matrix3d  map;
  map << 1.2, 0.1, 0.0, -0.2, 0.9, 0.3, 0.1, 0.0, 1.1;
  const Vector3 shift(5, -70, 3);
  for (Vector3 & p : subject.points)
  {
    p = map * p + shift;
  }
  // Inside, and half a millimetre beyond the flat end, which is as good as on it.
  const auto carried = CarryLandmarks(standard, { Places()[0], { "end", Vector3(1.0, -2.0, -0.5) } }, subject);
  EXPECT_NEAR((carried[0].point - (map * Places()[0].point + shift)).norm(), 0.0, 1e-11);
  EXPECT_NEAR((carried[1].point - (map * Vector3(1.0, -2.0, 0.0) + shift)).norm(), 0.0, 1e-11);
}

TEST(LandmarkTransfer, OutsideTheMeshMovesByASimilarityOfIt)
{
  const MeshArrays standard = test::MakeTube({});
  MeshArrays       subject = standard;
  const auto       turn = Eigen::AngleAxisd(0.7, Vector3(1, 2, -1).normalized());
  const auto       moved = [&turn](const Vector3 & x) { return Vector3(1.15 * (turn * x) + Vector3(5, -70, 3)); };
  for (Vector3 & p : subject.points)
  {
    p = moved(p);
  }
  const auto carried = CarryLandmarks(standard, Places(), subject);
  for (std::size_t i = 0; i < carried.size(); ++i)
  {
    EXPECT_NEAR((carried[i].point - moved(Places()[i].point)).norm(), 0.0, 1e-9) << carried[i].name;
  }
  // A motion of what is far from the landmark does not reach it.
  subject = standard;
  for (Vector3 & p : subject.points)
  {
    p.z() += p.z() > 14.0 ? 10.0 : 0.0;
  }
  EXPECT_NEAR((CarryLandmarks(standard, { Places()[2] }, subject)[0].point - Places()[2].point).norm(), 0.0, 1e-9);
}

TEST(LandmarkTransfer, RefusesAnotherTopologyAndALandmarkOfAnotherSpace)
{
  const MeshArrays standard = test::MakeTube({});
  MeshArrays       subject = standard;
  std::swap(subject.tetrahedra[7][0], subject.tetrahedra[7][1]);
  EXPECT_THROW(CarryLandmarks(standard, Places(), subject), std::invalid_argument);
  subject.tetrahedra = standard.tetrahedra;
  EXPECT_NO_THROW(CarryLandmarks(standard, Places(), subject));
  subject.tetrahedra.pop_back();
  EXPECT_THROW(CarryLandmarks(standard, Places(), subject), std::invalid_argument);
  try
  {
    CarryLandmarks(standard, { { "far", Vector3(500, 0, 0) } }, standard);
    FAIL();
  }
  catch (const std::invalid_argument & error)
  {
    EXPECT_THAT(error.what(), testing::HasSubstr("'far' lies 4"));
  }
  EXPECT_THROW(LocateLandmarks(MeshArrays(), Places()), std::invalid_argument);
  EXPECT_THROW(PlaceLandmarks(MeshArrays(), LocateLandmarks(standard, Places())), std::invalid_argument);
}
} // namespace LandmarkTransferTests
