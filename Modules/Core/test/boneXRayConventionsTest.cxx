/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneXRayConventions.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <random>

namespace XRayConventionsTests
{
using namespace bone;
using View = XRayGeometry::View;

/** A view at random: the source beyond the axis, pixels of either handedness. */
View
RandomView(unsigned int seed, bool parallel = false)
{
  std::mt19937                           random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto              vector = [&]() { return Vector3(uniform(random), uniform(random), uniform(random)); };
  const Eigen::AngleAxisd turn(3 * uniform(random), vector().normalized());
  View                    view;
  view.parallel = parallel;
  view.detectorU = turn * Vector3::UnitX();
  view.detectorV = turn * Vector3(0, seed % 2 == 0 ? 1 : -1, 0);
  view.source = 1000 * (turn * Vector3::UnitZ()) + 50 * vector();
  view.detectorOrigin = -300 * (turn * Vector3::UnitZ()) + 100 * vector();
  view.direction = turn * Vector3(0, 0, -1);
  view.size = { { 40 + static_cast<int>(seed), 30 } };
  view.spacing = { 1.5 + uniform(random), 1.5 + uniform(random) };
  return view;
}

XRayGeometry::Pointer
Geometry(const View & view)
{
  auto geometry = XRayGeometry::New();
  geometry->SetView(view);
  return geometry;
}

const std::vector<Vector3> points = { Vector3(0, 0, 0), Vector3(30, -20, 50), Vector3(-70, 10, -15) };

void
ExpectSameProjection(const View & a, const View & b)
{
  EXPECT_EQ(a.size, b.size);
  for (const Vector3 & point : points)
  {
    const Vector2 p = Geometry(a)->ProjectPoint(point), q = Geometry(b)->ProjectPoint(point);
    EXPECT_NEAR((p - q).norm(), 0, 1e-7) << p.transpose() << " and " << q.transpose();
  }
}

void
ExpectSameView(const View & a, const View & b)
{
  EXPECT_EQ(a.parallel, b.parallel);
  EXPECT_EQ(a.size, b.size);
  EXPECT_TRUE(a.spacing.isApprox(b.spacing, 1e-9));
  EXPECT_TRUE(a.parallel || a.source.isApprox(b.source, 1e-9));
  EXPECT_TRUE(!a.parallel || a.direction.isApprox(b.direction, 1e-9));
  EXPECT_NEAR((a.detectorOrigin - b.detectorOrigin).norm(), 0, 1e-6);
  EXPECT_TRUE(a.detectorU.isApprox(b.detectorU, 1e-9));
  EXPECT_TRUE(a.detectorV.isApprox(b.detectorV, 1e-9));
}

TEST(XRayConventions, APixelsPointProjectsToItAndSoDoAllPointsOfItsRay)
{
  for (unsigned int seed = 0; seed < 8; ++seed)
  {
    const auto    geometry = Geometry(RandomView(seed, seed % 3 == 0));
    const auto &  view = geometry->GetView();
    const Vector3 pixel = geometry->GetPixelPoint(12.25, 7.5);
    const Vector3 start = view.parallel ? Vector3(pixel - 500 * view.direction) : view.source;
    for (double part : { 0.2, 0.7, 1.0, 1.3 })
    {
      EXPECT_NEAR((geometry->ProjectPoint(start + part * (pixel - start)) - Vector2(12.25, 7.5)).norm(), 0, 1e-9);
    }
    EXPECT_EQ(view.parallel, geometry->ProjectPoint(Vector3(start - (pixel - start))).allFinite());
  }
}

TEST(XRayConventions, TheMatrixProjectsPointsAndComesBack)
{
  for (unsigned int seed = 0; seed < 8; ++seed)
  {
    const View view = RandomView(seed, seed % 3 == 0);
    const auto matrix = ToProjectionMatrix(view);
    for (const Vector3 & point : points)
    {
      const Vector3 q = matrix * point.homogeneous();
      EXPECT_GT(q.z(), 0);
      EXPECT_NEAR((q.hnormalized() - Geometry(view)->ProjectPoint(point)).norm(), 0, 1e-9);
    }
    if (view.parallel)
    {
      EXPECT_THROW(FromProjectionMatrix(matrix, view.size, 1), itk::ExceptionObject);
      continue;
    }
    ExpectSameView(FromProjectionMatrix(matrix, view.size, view.spacing.x()), view);
    ExpectSameView(FromProjectionMatrix(0.37 * matrix, view.size, view.spacing.x()), view);
  }
}

TEST(XRayConventions, AMatrixOfIntrinsicsAndPoseIsRead)
{
  Eigen::Matrix3d k;
  k << 2000, 0, 255.5, 0, 1600, 199.5, 0, 0, 1;
  const auto       turn = Eigen::AngleAxisd(0.4, Vector3(1, 2, 3).normalized()).toRotationMatrix();
  ProjectionMatrix pose;
  pose << turn, Vector3(10, -20, 900);
  const auto view = FromProjectionMatrix(k * pose, { { 512, 400 } }, 0.5);
  EXPECT_NEAR((view.detectorOrigin - view.source).dot(turn.row(2)), 1000, 1e-9) << "focal length times spacing";
  EXPECT_NEAR(view.spacing.y(), 0.625, 1e-12);
  k(0, 1) = 30;
  EXPECT_THROW(FromProjectionMatrix(k * pose, { { 512, 400 } }, 0.5), itk::ExceptionObject);
}

TEST(XRayConventions, PlastimatchsPointsLieWherePlastimatchPutsThem)
{
  // The geometry file and the image that plastimatch 1.9.4 made of three small blocks, by
  // drr -i exact -n "0.3 -0.9 0.2" --vup "0.1 0.2 1" --sad 800 --sid 1200 -o "3 -4 5" -r "48 64" -z "120 128" -c "20
  // 30".
  PlastimatchView from;
  from.nrm = { 0.3, -0.9, 0.2 };
  from.vup = { 0.1, 0.2, 1 };
  from.sad = 800;
  from.sid = 1200;
  from.isocenter = { 3, -4, 5 };
  from.dim = { { 48, 64 } };
  from.detectorSize = { 120, 128 };
  from.imageCenter = { 20, 30 };
  const auto       geometry = Geometry(FromPlastimatch(from));
  ProjectionMatrix matrix;                                                    // less the image centre
  matrix << 3.78948317e-01, 1.12878229e-01, -6.04704784e-02, -3.82979641e-01, //
    -4.10606007e-02, -1.21102792e-01, -4.83371638e-01, 2.05562883e+00,        //
    -2.57855327e-04, 7.73565928e-04, -1.71903547e-04, 6.71394014e-01;
  const Vector3 blocks[3] = { { -13.5, -13.5, -8.5 }, { 11, 16.5, 20.5 }, { 0.5, -19, -23.5 } };
  const Vector2 centroids[3] = { { 10.27, 42.56 }, { 26.55, 14.72 }, { 18.67, 53.89 } };
  for (int i = 0; i < 3; ++i)
  {
    const Vector2 here = geometry->ProjectPoint(blocks[i]);
    const Vector2 there = Vector3(matrix * blocks[i].homogeneous()).hnormalized() + from.imageCenter;
    EXPECT_NEAR((here - there).norm(), 0, 1e-5);
    EXPECT_NEAR((here - centroids[i]).norm(), 0, 0.2);
  }
}

TEST(XRayConventions, PlastimatchComesBack)
{
  for (unsigned int seed = 0; seed < 8; ++seed)
  {
    View       view = RandomView(seed);
    const bool mirrored = view.detectorU.cross(view.detectorV).dot(view.detectorOrigin - view.source) < 0;
    if (mirrored)
    {
      EXPECT_THROW(ToPlastimatch(view, 700), itk::ExceptionObject);
      view.detectorV = -view.detectorV;
    }
    const auto there = ToPlastimatch(view, 700);
    ExpectSameView(FromPlastimatch(there), view);
    EXPECT_NEAR((Geometry(view)->ProjectPoint(there.isocenter) - there.imageCenter).norm(), 0, 1e-9);
  }
}

TEST(XRayConventions, RtkComesBack)
{
  for (unsigned int seed = 0; seed < 12; ++seed)
  {
    const View    view = RandomView(seed, seed % 3 == 0);
    RtkProjection projection;
    RtkGrid       grid;
    ToRtk(view, projection, grid);
    const View back = FromRtk(projection, grid);
    ExpectSameProjection(back, view);
    if (!view.parallel)
    {
      ExpectSameView(back, view);
    }
  }
}

TEST(XRayConventions, RtksMatrixGivesMillimetresOnTheDetector)
{
  RtkProjection p;
  p.sourceToIsocenter = 1000;
  p.sourceToDetector = 1536;
  p.gantryAngle = 30;
  p.outOfPlaneAngle = 4;
  p.inPlaneAngle = -7;
  p.sourceOffsetX = 3;
  p.sourceOffsetY = -5;
  p.projectionOffsetX = 12;
  p.projectionOffsetY = -20;
  for (bool parallel : { false, true })
  {
    p.sourceToDetector = parallel ? 0 : p.sourceToDetector;
    RtkGrid grid;
    grid.origin = { -100, -80 };
    grid.spacing = { 0.4, 0.8 };
    grid.rowsDown = parallel;
    const auto geometry = Geometry(FromRtk(p, grid));
    for (const Vector3 & point : points)
    {
      const Vector2 mm = Vector3(RtkMatrix(p) * point.homogeneous()).hnormalized();
      const Vector2 expected = (mm - grid.origin).cwiseQuotient(Vector2(0.4, parallel ? -0.8 : 0.8));
      EXPECT_NEAR((geometry->ProjectPoint(point) - expected).norm(), 0, 1e-9);
    }
  }
}

TEST(XRayConventions, RtksGantryTurnsTheSourceAboutY)
{
  RtkProjection p;
  p.sourceToIsocenter = 1000;
  p.sourceToDetector = 1500;
  const RtkGrid grid;
  EXPECT_TRUE(FromRtk(p, grid).source.isApprox(Vector3(0, 0, 1000), 1e-12));
  p.gantryAngle = 90;
  EXPECT_TRUE(FromRtk(p, grid).source.isApprox(Vector3(1000, 0, 0), 1e-12));
}

TEST(XRayConventions, ACArmAtZeroHasItsDetectorBeforeTheChest)
{
  CArmView arm;
  arm.sourceToIsocenter = 700;
  arm.sourceToDetector = 1000;
  arm.size = { { 401, 201 } };
  arm.spacing = { 0.5, 0.25 };
  const View view = FromCArm(arm);
  EXPECT_FALSE(view.parallel);
  EXPECT_TRUE(view.source.isApprox(Vector3(0, 700, 0), 1e-12)) << "at the back";
  EXPECT_TRUE(view.detectorOrigin.isApprox(Vector3(-100, -300, 25), 1e-12)) << "200 half columns, 100 quarter rows";
  EXPECT_TRUE(view.detectorU.isApprox(Vector3(1, 0, 0), 1e-12)) << "columns to the patient's left";
  EXPECT_TRUE(view.detectorV.isApprox(Vector3(0, 0, -1), 1e-12)) << "rows to the feet";
  const auto geometry = Geometry(view);
  EXPECT_NEAR((geometry->ProjectPoint({ 0, 0, 0 }) - Vector2(200, 100)).norm(), 0, 1e-10);
  // 7 mm at the isocentre are 10 mm at the detector.
  EXPECT_NEAR((geometry->ProjectPoint({ 7, 0, 14 }) - Vector2(220, 20)).norm(), 0, 1e-10);
}

TEST(XRayConventions, ACArmTurnsToTheLeftAndToTheHead)
{
  CArmView arm;
  arm.size = { { 3, 3 } };
  arm.isocenter = { 10, 20, 30 };
  arm.primary = 90;
  const View lateral = FromCArm(arm);
  EXPECT_NEAR((lateral.source - Vector3(-690, 20, 30)).norm(), 0, 1e-9) << "source at the patient's right";
  EXPECT_NEAR((Geometry(lateral)->GetPixelPoint(1, 1) - Vector3(310, 20, 30)).norm(), 0, 1e-9);
  EXPECT_NEAR((lateral.detectorU - Vector3(0, 1, 0)).norm(), 0, 1e-12) << "the face to the viewer's left";
  EXPECT_NEAR((lateral.detectorV - Vector3(0, 0, -1)).norm(), 0, 1e-12);

  arm.primary = 0;
  arm.secondary = 30;
  const double c = std::sqrt(3) / 2;
  const View   cranial = FromCArm(arm);
  EXPECT_NEAR((cranial.source - Vector3(10, 20 + 700 * c, 30 - 350)).norm(), 0, 1e-9) << "source to the feet";
  EXPECT_NEAR((Geometry(cranial)->GetPixelPoint(1, 1) - Vector3(10, 20 - 300 * c, 30 + 150)).norm(), 0, 1e-9);
  EXPECT_NEAR((cranial.detectorU - Vector3(1, 0, 0)).norm(), 0, 1e-12);
  EXPECT_NEAR((cranial.detectorV - Vector3(0, -0.5, -c)).norm(), 0, 1e-12) << "downwards leads to the feet and forward";
}

TEST(XRayConventions, ACArmsPixelsAreOfOneHandednessAndItsCentreIsWhereTheIsocentreIsSeen)
{
  CArmView arm;
  arm.isocenter = { 5, -60, 700 };
  arm.centre = { 100, 350.5 };
  arm.spacing = { 0.3, 0.4 };
  for (const double primary : { -170.0, -90.0, -35.0, 0.0, 20.0, 135.0 })
  {
    for (const double secondary : { -90.0, -25.0, 0.0, 40.0 })
    {
      arm.primary = primary;
      arm.secondary = secondary;
      const View    view = FromCArm(arm);
      const Vector3 beam = (arm.isocenter - view.source).normalized();
      EXPECT_NEAR((view.detectorU.cross(view.detectorV) + beam).norm(), 0, 1e-12) << primary << ' ' << secondary;
      EXPECT_NEAR((Geometry(view)->ProjectPoint(arm.isocenter) - arm.centre).norm(), 0, 1e-9);
      EXPECT_NEAR((arm.isocenter - view.source).norm(), arm.sourceToIsocenter, 1e-9);
      EXPECT_NEAR((Geometry(view)->GetPixelPoint(100, 350.5) - view.source).norm(), arm.sourceToDetector, 1e-9);
    }
  }
}

TEST(XRayConventions, RefusesACArmThatCannotBe)
{
  for (int which = 0; which < 6; ++which)
  {
    CArmView arm;
    arm.primary = which == 0 ? 181 : which == 1 ? std::nan("") : 0;
    arm.secondary = which == 2 ? -91 : 0;
    arm.sourceToIsocenter = which == 3 ? -700 : which == 4 ? 1200 : 700;
    arm.spacing.x() = which == 5 ? 0 : 1;
    EXPECT_THROW(FromCArm(arm), itk::ExceptionObject) << which;
  }
  EXPECT_NO_THROW(FromCArm(CArmView()));
}
} // namespace XRayConventionsTests
