/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSurfacePhantom.h"

#include "../../Core/test/boneTestSurfaces.h"
#include "bonePhantomImageSource.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <random>

using namespace bone;
using test::Box;
using test::Shape;

namespace SurfacePhantomTests
{
/** An icosahedron, split `levels` times, with its points on the sphere. */
Shape
Icosphere(double radius, int levels)
{
  const double g = 0.5 * (1.0 + std::sqrt(5.0));
  Shape        s;
  s.points = { { -1, g, 0 },  { 1, g, 0 },  { -1, -g, 0 }, { 1, -g, 0 }, { 0, -1, g },  { 0, 1, g },
               { 0, -1, -g }, { 0, 1, -g }, { g, 0, -1 },  { g, 0, 1 },  { -g, 0, -1 }, { -g, 0, 1 } };
  s.triangles = { { { 0, 11, 5 } }, { { 0, 5, 1 } },  { { 0, 1, 7 } },   { { 0, 7, 10 } }, { { 0, 10, 11 } },
                  { { 1, 5, 9 } },  { { 5, 11, 4 } }, { { 11, 10, 2 } }, { { 10, 7, 6 } }, { { 7, 1, 8 } },
                  { { 3, 9, 4 } },  { { 3, 4, 2 } },  { { 3, 2, 6 } },   { { 3, 6, 8 } },  { { 3, 8, 9 } },
                  { { 4, 9, 5 } },  { { 2, 4, 11 } }, { { 6, 2, 10 } },  { { 8, 6, 7 } },  { { 9, 8, 1 } } };
  for (int level = 0; level < levels; ++level)
  {
    std::map<std::pair<IdType, IdType>, IdType> middles;
    const auto                                  middle = [&](IdType a, IdType b) {
      const auto found = middles.emplace(std::minmax(a, b), static_cast<IdType>(s.points.size()));
      if (found.second)
      {
        s.points.push_back(0.5 * (s.points[a] + s.points[b]));
      }
      return found.first->second;
    };
    std::vector<TriangleDistance::Triangle> finer;
    for (const auto & t : s.triangles)
    {
      const IdType a = middle(t[0], t[1]), b = middle(t[1], t[2]), c = middle(t[2], t[0]);
      finer.insert(finer.end(), { { { t[0], a, c } }, { { a, t[1], b } }, { { c, b, t[2] } }, { { a, b, c } } });
    }
    s.triangles = finer;
    for (Vector3 & p : s.points)
    {
      p *= std::sqrt(3.0) / p.norm();
    }
  }
  for (Vector3 & p : s.points)
  {
    p *= radius / p.norm();
  }
  return s;
}

/** Thickness the same everywhere, no cavity. */
SurfacePhantomParameters
Shell(double thickness)
{
  SurfacePhantomParameters p;
  p.shaftCortex = p.endCortex = thickness;
  p.medullaryCavity = false;
  return p;
}

std::string
ErrorOf(const Shape & s, const SurfacePhantomParameters & p = SurfacePhantomParameters())
{
  try
  {
    const SurfacePhantom bone(s.points, s.triangles, p);
  }
  catch (const itk::ExceptionObject & error)
  {
    return error.GetDescription();
  }
  return "";
}

TEST(SurfacePhantom, RefusesWhatIsNoClosedSurface)
{
  using testing::HasSubstr;
  const Shape box = Box({ 10, 20, 30 });

  Shape bad = box;
  bad.triangles.pop_back();
  EXPECT_THAT(ErrorOf(bad), HasSubstr("not closed and oriented: 3 edges"));
  bad = box;
  std::swap(bad.triangles[0][0], bad.triangles[0][1]);
  EXPECT_THAT(ErrorOf(bad), HasSubstr("not closed and oriented"));
  bad = box;
  bad.points[3][1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(ErrorOf(bad), HasSubstr("Point 3"));
  bad = box;
  bad.triangles[5][2] = 8;
  EXPECT_THAT(ErrorOf(bad), HasSubstr("Triangle 5"));
  bad = box;
  bad.triangles[2] = { { 4, 5, 5 } };
  EXPECT_THAT(ErrorOf(bad), HasSubstr("no area"));
  EXPECT_THAT(ErrorOf(Shape()), HasSubstr("at least four"));

  SurfacePhantomParameters p;
  p.endCortex = 0.0;
  EXPECT_THAT(ErrorOf(box, p), HasSubstr("thickness must be positive"));
  p = SurfacePhantomParameters();
  p.cavityEnd = 0.1;
  EXPECT_THAT(ErrorOf(box, p), HasSubstr("start before"));
}

TEST(SurfacePhantom, ABallHasTheDistanceAndThicknessOfABall)
{
  const Shape                            ball = Icosphere(20.0, 4);
  const SurfacePhantom                   bone(ball.points, ball.triangles, Shell(3.0));
  std::mt19937                           random(4);
  std::uniform_real_distribution<double> unit(-24.0, 24.0);
  constexpr double                       sag = 0.05; // of a triangle below the sphere, mm
  for (int n = 0; n < 1000; ++n)
  {
    const double  a = unit(random), b = unit(random), c = unit(random);
    const Vector3 x(a, b, c);
    EXPECT_NEAR(bone.SignedDistance(x), x.norm() - 20.0, sag);
    if (std::abs(x.norm() - 20.0) < 4.0)
    {
      EXPECT_NEAR(bone.CorticalThickness(x), 3.0, sag);
      EXPECT_NEAR(bone.Distance(PhantomModel::Endosteal, x), x.norm() - 17.0, sag);
    }
  }
  EXPECT_EQ(bone.Region(Vector3::Zero()), Region::Trabecular);
  EXPECT_EQ(bone.GetNumberOfSurfaces(), 2);
}

TEST(SurfacePhantom, VolumesOfLabelsAndOfTheThresholdedImageAreThoseOfTheBall)
{
  const Shape              ball = Icosphere(20.0, 4);
  SurfacePhantomParameters p = Shell(3.0);
  p.shaftDensity = p.endDensity = 1240.0;
  p.trabecularDensity = 1240.0;
  p.trabecularEndDensity = p.trabecularRimDensity = 0.0;
  auto source = PhantomImageSource<itk::Image<float, 3>>::New();
  source->SetModel(std::make_shared<const SurfacePhantom>(ball.points, ball.triangles, p));
  source->Update();
  std::size_t labelled = 0, cortical = 0, bright = 0;
  const auto  count = source->GetOutput()->GetBufferedRegion().GetNumberOfPixels();
  for (std::size_t n = 0; n < count; ++n)
  {
    labelled += source->GetLabelOutput()->GetBufferPointer()[n] != 0 ? 1 : 0;
    cortical += source->GetLabelOutput()->GetBufferPointer()[n] == 1 ? 1 : 0;
    bright += source->GetOutput()->GetBufferPointer()[n] > 640.0 ? 1 : 0;
  }
  const double volume = 4.0 / 3.0 * M_PI * 8000.0;
  EXPECT_NEAR(static_cast<double>(labelled) / volume, 1.0, 0.01);
  EXPECT_NEAR(static_cast<double>(bright) / static_cast<double>(labelled), 1.0, 0.005);
  EXPECT_NEAR(static_cast<double>(cortical) / volume, 1.0 - std::pow(17.0 / 20.0, 3), 0.01);
}

TEST(SurfacePhantom, BlurKeepsTheMassOfTheBall)
{
  const Shape              ball = Icosphere(10.0, 2);
  SurfacePhantomParameters p = Shell(3.0);
  p.shaftDensity = p.endDensity = 1240.0;
  p.trabecularDensity = 240.0;
  p.trabecularEndDensity = p.trabecularRimDensity = 0.0;
  const auto   model = std::make_shared<const SurfacePhantom>(ball.points, ball.triangles, p);
  const double outer = model->GetSurface().GetVolume();
  const double face = -model->SignedDistance(Vector3::Zero()); // the polyhedron's faces are nearly this far out
  const double inner = outer * std::pow((face - 3.0) / face, 3);
  const double mass = 1200.0 * (outer - inner) + 200.0 * inner;

  using SourceType = PhantomImageSource<itk::Image<float, 3>>;
  for (const double width : { 1.2, 2.5 })
  {
    auto                    source = SourceType::New();
    SourceType::SpacingType spacing;
    SourceType::SpacingType spread;
    spacing[0] = spacing[1] = 0.9 * width;
    spacing[2] = width;
    spread.Fill(1.4 * width);
    source->SetModel(model);
    source->SetSpacing(spacing);
    source->SetPointSpread(spread);
    source->SetMargin(2.0 * width);
    source->Update();
    double sum = 0.0;
    for (std::size_t n = 0; n < source->GetOutput()->GetBufferedRegion().GetNumberOfPixels(); ++n)
    {
      sum += source->GetOutput()->GetBufferPointer()[n] - 40.0;
    }
    EXPECT_NEAR(sum * spacing[0] * spacing[1] * spacing[2] / mass, 1.0, 0.005) << width;
  }
}

TEST(SurfacePhantom, TheCortexChangesFromEndToShaftOverTheTransition)
{
  const Shape              box = Box({ 10, 10, 50 });
  SurfacePhantomParameters p;
  p.shaftStart = 0.2;
  p.shaftEnd = 0.9;
  p.transition = 0.1;
  p.endDensity = 500;
  p.shaftDensity = 1500;
  const SurfacePhantom bone(box.points, box.triangles, p);
  const auto           densityAt = [&](double fraction) {
    const auto    axis = bone.GetLongitudinalAxis();
    const Vector3 x = axis.point + fraction * bone.GetLength() * axis.direction;
    return bone.EvaluateMaterials(x, bone.EvaluateLevels(x))[1];
  };
  for (const double end : { 0.02, 0.2, 0.9, 0.98 })
  {
    EXPECT_NEAR(densityAt(end), 500, 1e-6) << end;
  }
  for (const double middle : { 0.25, 0.85 })
  {
    EXPECT_NEAR(densityAt(middle), 1000, 1e-6) << middle;
  }
  for (const double shaft : { 0.3, 0.5, 0.8 })
  {
    EXPECT_NEAR(densityAt(shaft), 1500, 1e-6) << shaft;
  }
}

TEST(SurfacePhantom, LongBoneHasNestedLayersAndACavityInItsShaft)
{
  Shape bar = Icosphere(1.0, 4);
  for (Vector3 & point : bar.points)
  {
    point = Vector3(150.0 * point.x(), 16.0 * point.y(), 20.0 * point.z());
  }
  const SurfacePhantom bone(bar.points, bar.triangles);
  EXPECT_NEAR(std::abs(bone.GetLongitudinalAxis().direction.x()), 1.0, 1e-3);
  EXPECT_NEAR(bone.GetLength(), 300.0, 1.0);
  EXPECT_EQ(bone.Region(Vector3::Zero()), Region::Medullary);
  EXPECT_EQ(bone.Region({ 110, 0, 0 }), Region::Trabecular);
  EXPECT_EQ(bone.Region({ -110, 0, 0 }), Region::Trabecular);
  EXPECT_NEAR(bone.CorticalThickness({ 0, 17, 0 }), 5.0, 0.05);
  EXPECT_EQ(bone.Region({ 151, 0, 0 }), Region::Outside);

  std::mt19937                           random(4);
  std::uniform_real_distribution<double> unit(-1.1, 1.1);
  for (int n = 0; n < 3000; ++n)
  {
    const double            a = unit(random), b = unit(random), c = unit(random);
    const Vector3           x(150.0 * a, 20.0 * b, 20.0 * c);
    PhantomModel::Gradients gradients;
    const auto              levels = bone.EvaluateLevels(x, gradients);
    EXPECT_LT(levels[0], levels[1]);
    EXPECT_LT(levels[1], levels[2]);
    for (int s = 0; s < 3; ++s)
    {
      EXPECT_LE(gradients[s].norm(), bone.GetLipschitzBound(s) * (1.0 + 1e-9));
    }
  }
}
} // namespace SurfacePhantomTests
