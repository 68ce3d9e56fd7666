/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "bonePhantomModel.h"

#include "boneFemurPhantom.h"
#include "boneHemipelvisPhantom.h"
#include "boneMakePhantom.h"
#include "boneSurfacePhantom.h"

#include <itkMacro.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

using namespace bone;

namespace PhantomModelTests
{
/** Uniform points in the model's box, a little enlarged. */
class BoxPoints
{
public:
  BoxPoints(const PhantomModel & model, unsigned int seed, double grow = 10.0)
    : m_Random(seed)
    , m_Lower(model.GetLowerCorner() - Vector3::Constant(grow))
    , m_Size(model.GetUpperCorner() + Vector3::Constant(grow) - m_Lower)
  {}
  Vector3
  Next()
  {
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    const double                           a = unit(m_Random), b = unit(m_Random), c = unit(m_Random);
    return m_Lower + m_Size.cwiseProduct(Vector3(a, b, c));
  }
  Vector3
  NextDirection()
  {
    std::normal_distribution<double> normal;
    const double                     a = normal(m_Random), b = normal(m_Random), c = normal(m_Random);
    return Vector3(a, b, c).normalized();
  }

private:
  std::mt19937 m_Random;
  Vector3      m_Lower;
  Vector3      m_Size;
};

std::vector<PhantomModel::Pointer>
Bones(std::uint64_t seeds = 3)
{
  std::vector<PhantomModel::Pointer> bones;
  for (const std::string & name : PhantomNames())
  {
    for (std::uint64_t seed = 0; seed < seeds; ++seed)
    {
      bones.push_back(MakePhantom(name, seed));
    }
  }
  return bones;
}

TEST(PhantomModel, LayersAreNested)
{
  for (const auto & bone : Bones())
  {
    BoxPoints points(*bone, 1);
    for (int n = 0; n < 5000; ++n)
    {
      const auto levels = bone->EvaluateLevels(points.Next());
      EXPECT_LT(levels[0], levels[1]);
      EXPECT_LT(levels[1], levels[2]);
    }
  }
}

TEST(PhantomModel, LevelsKeepTheirLipschitzBound)
{
  for (const auto & bone : Bones())
  {
    BoxPoints points(*bone, 2, 60.0);
    for (int n = 0; n < 5000; ++n)
    {
      const Vector3 a = points.Next();
      const Vector3 b = n % 2 == 0 ? points.Next() : Vector3(a + 0.1 * points.NextDirection());
      const auto    atA = bone->EvaluateLevels(a);
      const auto    atB = bone->EvaluateLevels(b);
      for (int s = 0; s < bone->GetNumberOfSurfaces(); ++s)
      {
        EXPECT_LE(std::abs(atA[s] - atB[s]), bone->GetLipschitzBound(s) * (a - b).norm() * (1.0 + 1e-9)) << s;
      }
    }
  }
}

TEST(PhantomModel, GradientsAgreeWithDifferences)
{
  constexpr double h = 1e-5;
  for (const auto & bone : Bones(2))
  {
    BoxPoints points(*bone, 3);
    for (int n = 0; n < 1000; ++n)
    {
      const Vector3           x = points.Next();
      PhantomModel::Gradients gradients;
      const auto              levels = bone->EvaluateLevels(x, gradients);
      const auto              plain = bone->EvaluateLevels(x);
      for (int s = 0; s < bone->GetNumberOfSurfaces(); ++s)
      {
        EXPECT_NEAR(levels[s], plain[s], 1e-9);
        for (int a = 0; a < 3; ++a)
        {
          const Vector3 step = h * Vector3::Unit(a);
          const double  difference = (bone->EvaluateLevels(x + step)[s] - bone->EvaluateLevels(x - step)[s]) / (2 * h);
          EXPECT_NEAR(gradients[s][a], difference, 1e-3);
        }
      }
    }
  }
}

TEST(PhantomModel, ClosestPointLiesOnTheSurfaceWithTheOffsetAlongItsNormal)
{
  for (const auto & bone : Bones(2))
  {
    BoxPoints points(*bone, 4);
    int       near = 0;
    for (int n = 0; n < 20000 && near < 200; ++n)
    {
      const Vector3 x = points.Next();
      if (std::abs(bone->EvaluateLevels(x)[0]) > 1.0)
      {
        continue;
      }
      ++near;
      PhantomModel::Gradients gradients;
      const Vector3           foot = bone->ClosestPoint(PhantomModel::Periosteal, x);
      EXPECT_NEAR(bone->EvaluateLevels(foot, gradients)[0], 0.0, 1e-7);
      const Vector3 normal = gradients[0].normalized();
      EXPECT_NEAR((x - foot - (x - foot).dot(normal) * normal).norm(), 0.0, 0.01) << x.transpose();
      EXPECT_EQ(bone->SignedDistance(x) < 0.0, bone->Region(x) != Region::Outside);
    }
    EXPECT_EQ(near, 200);
  }
}

TEST(PhantomModel, ExtentHoldsTheBoneClosely)
{
  for (const auto & bone : Bones(3))
  {
    BoxPoints            points(*bone, 5, 3.0);
    std::vector<Vector3> inside;
    for (int n = 0; n < 60000; ++n)
    {
      const Vector3 x = points.Next();
      if (bone->Region(x) != Region::Outside && !(bone->GetOpenStart() && x.z() < bone->GetLowerCorner().z() + 3.0))
      {
        inside.push_back(x);
      }
    }
    ASSERT_GT(inside.size(), 1000U);
    for (int n = 0; n < 20; ++n)
    {
      const Vector3 direction = points.NextDirection();
      const auto    extent = bone->GetExtent(direction);
      double        lower = std::numeric_limits<double>::max();
      double        upper = std::numeric_limits<double>::lowest();
      for (const Vector3 & x : inside)
      {
        lower = std::min(lower, x.dot(direction));
        upper = std::max(upper, x.dot(direction));
      }
      EXPECT_LE(extent.lower, lower);
      EXPECT_GE(extent.upper, upper);
      EXPECT_NEAR(extent.lower, lower, 10.0);
      EXPECT_NEAR(extent.upper, upper, 10.0);
    }
  }
}

TEST(PhantomModel, SubjectsDifferAndRepeat)
{
  for (const std::string & name : PhantomNames())
  {
    const auto mean = MakePhantom(name);
    const auto one = MakePhantom(name, 1);
    const auto again = MakePhantom(name, 1);
    const auto other = MakePhantom(name, 2);
    BoxPoints  points(*mean, 6);
    double     difference = 0.0;
    for (int n = 0; n < 200; ++n)
    {
      const Vector3 x = points.Next();
      EXPECT_EQ(one->EvaluateLevels(x), again->EvaluateLevels(x));
      EXPECT_EQ(one->Density(x), again->Density(x));
      difference = std::max(difference, std::abs(one->EvaluateLevels(x)[0] - other->EvaluateLevels(x)[0]));
    }
    EXPECT_GT(difference, 0.3);
    EXPECT_LT(difference, 25.0);
  }
  EXPECT_EQ(FemurParameters::ForSubject(0).headRadius, FemurParameters().headRadius);
  const auto surface = SurfacePhantomParameters::ForSubject(4);
  EXPECT_EQ(SurfacePhantomParameters::ForSubject(0).shaftCortex, SurfacePhantomParameters().shaftCortex);
  EXPECT_NE(surface.shaftCortex, SurfacePhantomParameters().shaftCortex);
  EXPECT_NE(surface.trabecularDensity, SurfacePhantomParameters().trabecularDensity);
  EXPECT_EQ(surface.endDensity, SurfacePhantomParameters::ForSubject(4).endDensity);
}

TEST(PhantomModel, DensitiesLieInTheirRanges)
{
  for (const auto & bone : Bones())
  {
    BoxPoints points(*bone, 7);
    for (int n = 0; n < 5000; ++n)
    {
      const Vector3 x = points.Next();
      const double  density = bone->Density(x);
      switch (bone->Region(x))
      {
        case Region::Outside:
          EXPECT_EQ(density, 40.0);
          break;
        case Region::Cortical:
          EXPECT_GT(density, 1150.0);
          EXPECT_LT(density, 1750.0);
          break;
        case Region::Trabecular:
          EXPECT_GT(density, 90.0);
          EXPECT_LT(density, 760.0);
          break;
        default:
          EXPECT_NEAR(density, -50.0, 16.0);
      }
    }
  }
}

TEST(PhantomModel, MakePhantomNamesWhatItKnows)
{
  try
  {
    MakePhantom("skull");
    FAIL();
  }
  catch (const itk::ExceptionObject & error)
  {
    EXPECT_THAT(error.GetDescription(), testing::AllOf(testing::HasSubstr("skull"), testing::HasSubstr("femur, hemi")));
  }
}

TEST(FemurPhantom, HeadIsASphere)
{
  for (std::uint64_t seed = 0; seed < 4; ++seed)
  {
    const FemurPhantom femur(seed);
    const double       radius = femur.GetParameters().headRadius;
    BoxPoints          points(femur, 8);
    for (int n = 0; n < 200; ++n)
    {
      const Vector3 direction = points.NextDirection();
      if (direction.dot(femur.GetHeadCentre().normalized()) > 0.3)
      {
        for (const double offset : { -3.0, -1.0, 0.0, 2.0, 6.0 })
        {
          const Vector3 x = femur.GetHeadCentre() + (radius + offset) * direction;
          EXPECT_NEAR(femur.SignedDistance(x), offset, 1e-6);
        }
      }
    }
  }
}

TEST(FemurPhantom, CortexHasTheThicknessAskedFor)
{
  for (std::uint64_t seed = 0; seed < 4; ++seed)
  {
    const FemurPhantom femur(seed);
    const auto &       p = femur.GetParameters();
    const Vector3      crown = femur.GetHeadCentre() + p.headRadius * femur.GetHeadCentre().normalized();
    EXPECT_NEAR(femur.CorticalThickness(crown), p.headCortex, 1e-3);
    const Vector3 lateral = femur.GetShaftCentre(-150.0) + p.shaftRadius * Vector3(-1, 0, 0);
    EXPECT_NEAR(femur.CorticalThickness(lateral), p.shaftCortex, 0.02);
    EXPECT_EQ(femur.Region(lateral + Vector3(0.5 * p.shaftCortex, 0, 0)), Region::Cortical);
    EXPECT_EQ(femur.Region(lateral + Vector3(p.shaftCortex + 0.5 * p.trabecularDepth, 0, 0)), Region::Trabecular);
    EXPECT_EQ(femur.Region(femur.GetShaftCentre(-150.0)), Region::Medullary);
    EXPECT_EQ(femur.Region(femur.GetHeadCentre()), Region::Trabecular);
  }
}

TEST(FemurPhantom, LayersKeepTheirLeastThickness)
{
  for (std::uint64_t seed = 0; seed < 3; ++seed)
  {
    const FemurPhantom femur(seed);
    BoxPoints          points(femur, 9, 0.0);
    for (int n = 0; n < 3000; ++n)
    {
      const Vector3 x = points.Next();
      const auto    levels = femur.EvaluateLevels(x);
      if (std::abs(levels[0]) < 2.0)
      {
        EXPECT_GE(femur.CorticalThickness(x), 0.97 * femur.GetParameters().headCortex);
      }
      if (std::abs(levels[2]) < 1.0)
      {
        const Vector3 cavity = femur.ClosestPoint(PhantomModel::Cavity, x);
        EXPECT_LE(femur.Distance(PhantomModel::Endosteal, cavity), -0.7 * femur.GetParameters().trabecularDepth);
      }
    }
  }
}

TEST(FemurPhantom, GoesOnBelowTheCut)
{
  const FemurPhantom femur;
  EXPECT_TRUE(femur.GetOpenStart());
  EXPECT_FALSE(femur.GetOpenEnd());
  EXPECT_NEAR(femur.GetLowerCorner().z(), -femur.GetParameters().length, 1e-9);
  EXPECT_EQ(femur.Region(femur.GetShaftCentre(-220.0)), Region::Medullary);
}

TEST(FemurPhantom, RefusesParametersThatMakeNoBone)
{
  FemurParameters p;
  p.headRadius = 10.0;
  EXPECT_THROW(FemurPhantom{ p }, itk::ExceptionObject);
  p = FemurParameters();
  p.shaftCortex = 12.0;
  EXPECT_THROW(FemurPhantom{ p }, itk::ExceptionObject);
  p = FemurParameters();
  p.neckLength = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(FemurPhantom{ p }, itk::ExceptionObject);
  p = FemurParameters();
  p.neckShaftAngle = 30.0;
  EXPECT_THROW(FemurPhantom{ p }, itk::ExceptionObject);
}

TEST(HemipelvisPhantom, WingIsAPlateWithoutTrabecularBone)
{
  for (std::uint64_t seed = 0; seed < 4; ++seed)
  {
    const HemipelvisPhantom hip(seed);
    const Vector3 &         centre = hip.GetWingCentre();
    EXPECT_EQ(hip.Region(centre), Region::Cortical);
    EXPECT_NEAR(hip.CorticalThickness(centre), hip.GetParameters().wingThickness, 0.02);
  }
}

TEST(HemipelvisPhantom, AcetabulumIsASphericalBowl)
{
  for (std::uint64_t seed = 0; seed < 4; ++seed)
  {
    const HemipelvisPhantom hip(seed);
    const double            radius = hip.GetParameters().cupRadius;
    BoxPoints               points(hip, 10);
    EXPECT_EQ(hip.Region(Vector3::Zero()), Region::Outside);
    for (int n = 0; n < 200; ++n)
    {
      const Vector3 direction = points.NextDirection();
      if (direction.dot(hip.GetOpening()) < -0.4)
      {
        EXPECT_NEAR(hip.SignedDistance((radius - 2.0) * direction), 2.0, 1e-3);
        EXPECT_EQ(hip.Region((radius + 1.0) * direction), Region::Cortical);
        EXPECT_GE(hip.CorticalThickness(radius * direction), 0.97 * hip.GetParameters().cortex);
      }
    }
  }
}

TEST(HemipelvisPhantom, RefusesParametersThatMakeNoBone)
{
  HemipelvisParameters p;
  p.wingThickness = 20.0;
  EXPECT_THROW(HemipelvisPhantom{ p }, itk::ExceptionObject);
  p = HemipelvisParameters();
  p.cupRadius = -1.0;
  EXPECT_THROW(HemipelvisPhantom{ p }, itk::ExceptionObject);
}
} // namespace PhantomModelTests
