/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneMeshRadiograph.h"

#include "boneMeshWalk.h"
#include "boneProjectionModel.h"
#include "boneRadiographTestMeshes.h"
#include "boneRayCell.h"
#include "boneRayFrame.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace MeshRadiographTests
{
using namespace bone;
using View = XRayGeometry::View;

std::vector<float>
Project(const MeshArrays & mesh, const View & view, const MeshRadiographParameters & parameters = {})
{
  std::vector<float> image(static_cast<std::size_t>(view.size[0]) * view.size[1], -1.0f);
  ProjectMesh(mesh.points, mesh, view, parameters, Execution(), image.data());
  return image;
}

std::vector<float>
Walk(const MeshArrays & mesh, const View & view, const MeshRadiographParameters & parameters = {})
{
  std::vector<float> image(static_cast<std::size_t>(view.size[0]) * view.size[1], -1.0f);
  WalkMesh(mesh.points, mesh, view, parameters, Execution(), image.data(), nullptr);
  return image;
}

double
Largest(const std::vector<float> & image)
{
  double largest = 0;
  for (float value : image)
  {
    largest = std::max(largest, std::abs(static_cast<double>(value)));
  }
  return largest;
}

/** Largest difference over the largest value; NaN counts as infinite. */
double
Difference(const std::vector<float> & image, const std::vector<float> & reference)
{
  double difference = 0;
  for (std::size_t i = 0; i < image.size(); ++i)
  {
    const double d = std::abs(static_cast<double>(image[i]) - reference[i]);
    difference = d <= difference ? difference : (std::isnan(d) ? std::numeric_limits<double>::infinity() : d);
  }
  return difference / Largest(reference);
}

/** Integrals of a function of (start, end) of the ray's part within the box. */
template <typename TIntegral>
std::vector<float>
BoxImage(const View & view, const Vector3 & lower, const Vector3 & upper, const TIntegral & integral)
{
  std::vector<float> image;
  const auto         geometry = XRayGeometry::New();
  geometry->SetView(view);
  for (int r = 0; r < view.size[1]; ++r)
  {
    for (int c = 0; c < view.size[0]; ++c)
    {
      const Vector3 pixel = geometry->GetPixelPoint(c, r);
      const Vector3 source = view.parallel ? Vector3(pixel - 5000 * view.direction) : view.source;
      const auto    part = test::ClipToBox(source, pixel, lower, upper);
      const Vector3 ray = pixel - source;
      image.push_back(part[0] < part[1]
                        ? static_cast<float>(integral(Vector3(source + part[0] * ray), Vector3(source + part[1] * ray)))
                        : 0.0f);
    }
  }
  return image;
}

double
Chord(const Vector3 & a, const Vector3 & b)
{
  return (b - a).norm();
}

const Vector3 lower(-20, -15, -10), upper(22, 18, 14);

View
Oblique(bool parallel, int pixels = 96)
{
  auto view =
    XRayGeometry::Framing(lower, upper, Vector3(0.4, 1, 0.2).normalized(), Vector3(0.1, 0.2, 1), 400, 600, pixels);
  view.parallel = parallel;
  return view;
}

MeshArrays
Box(const std::array<int, 3> & n, double jitter)
{
  return test::GridMesh(n, lower, (upper - lower).cwiseQuotient(Vector3(n[0], n[1], n[2])), jitter);
}

MeshArrays
Staircase()
{
  return test::GridMesh(
    { { 4, 4, 3 } }, lower, Vector3(10, 8, 8), 0.2, [](int i, int j, int) { return i + j < 5 && (i != 1 || j != 1); });
}

TEST(MeshRadiograph, ABoxOfConstantDensityGivesItsChords)
{
  for (bool parallel : { false, true })
  {
    auto mesh = Box({ { 4, 3, 3 } }, 0.3);
    test::SetConstant(mesh, 2.5);
    const View view = Oblique(parallel);
    const auto expected =
      BoxImage(view, lower, upper, [](const Vector3 & a, const Vector3 & b) { return 2.5 * Chord(a, b); });
    EXPECT_LT(Difference(Project(mesh, view), expected), 2e-6) << parallel;
    EXPECT_LT(Difference(Walk(mesh, view), expected), 1e-6) << parallel;
  }
}

TEST(MeshRadiograph, ABallGivesTheChordsOfItsFacetsCloseToThoseOfTheSphere)
{
  const Vector3 centre(1, 2, 3);
  auto          mesh = test::BallMesh(16, centre, 12);
  test::SetConstant(mesh, 1);
  View       view = XRayGeometry::Framing(Vector3(centre - Vector3::Constant(13)),
                                    Vector3(centre + Vector3::Constant(13)),
                                    Vector3::UnitX(),
                                    Vector3::UnitZ(),
                                    500,
                                    800,
                                    64);
  const auto image = Project(mesh, view);
  const auto geometry = XRayGeometry::New();
  geometry->SetView(view);
  for (int r = 0; r < view.size[1]; ++r)
  {
    for (int c = 0; c < view.size[0]; ++c)
    {
      const Vector3 ray = (geometry->GetPixelPoint(c, r) - view.source).normalized();
      const double  distance = ray.cross(Vector3(centre - view.source)).norm();
      const double  chord = distance < 12 ? 2 * std::sqrt(144 - distance * distance) : 0;
      const double  value = image[r * view.size[0] + c];
      EXPECT_LE(value, chord + 1e-4) << "the mesh lies in the ball";
      if (distance < 10)
      {
        EXPECT_GT(value, 0.97 * chord);
      }
    }
  }
}

TEST(MeshRadiograph, ABallConvergesToTheSphereWithTheSquareOfTheCellsSize)
{
  const Vector3 centre(1, 2, 3);
  View          view = XRayGeometry::Framing(Vector3(centre - Vector3::Constant(13)),
                                    Vector3(centre + Vector3::Constant(13)),
                                    Vector3(0.3, 1, 0.2).normalized(),
                                    Vector3::UnitZ(),
                                    500,
                                    800,
                                    48);
  const auto    geometry = XRayGeometry::New();
  geometry->SetView(view);
  double error[2] = { 0, 0 };
  for (int fine = 0; fine < 2; ++fine)
  {
    auto mesh = test::BallMesh(fine == 0 ? 8 : 16, centre, 12);
    test::SetConstant(mesh, 1);
    const auto image = Project(mesh, view);
    for (int i = 0; i < static_cast<int>(image.size()); ++i)
    {
      const Vector3 ray = (geometry->GetPixelPoint(i % view.size[0], i / view.size[0]) - view.source).normalized();
      const double  distance = ray.cross(Vector3(centre - view.source)).norm();
      error[fine] += distance < 10 ? 2 * std::sqrt(144 - distance * distance) - image[i] : 0;
    }
  }
  EXPECT_NEAR(error[0] / error[1], 4, 0.5);
}

TEST(MeshRadiograph, ABallGivesTheChordsOfItsBoundaryTriangles)
{
  auto mesh = test::BallMesh(8, Vector3(1, 2, 3), 12);
  test::SetConstant(mesh, 1);
  View view = Oblique(false, 40);
  // Signed distances from the source at which a ray meets the surface add up to the chord.
  std::vector<float> expected(static_cast<std::size_t>(view.size[0]) * view.size[1]);
  const RayFrame     rays = RayFrame::Displaced(view);
  const auto         faces = BoundaryFaces(mesh);
  for (std::size_t i = 0; i < expected.size(); ++i)
  {
    const Vector3 direction =
      rays.Direction(static_cast<double>(i % view.size[0]), static_cast<double>(i / view.size[0]));
    double sum = 0;
    for (const auto & face : faces)
    {
      const Vector3 a = mesh.points[face[0]] - view.source, b = mesh.points[face[1]] - view.source;
      const Vector3 c = mesh.points[face[2]] - view.source;
      const double  u = direction.dot(b.cross(c)), v = direction.dot(c.cross(a)), w = direction.dot(a.cross(b));
      if ((u > 0 && v > 0 && w > 0) || (u < 0 && v < 0 && w < 0))
      {
        sum += (u > 0 ? 1 : -1) * a.dot(b.cross(c)) / (u + v + w);
      }
    }
    expected[i] = static_cast<float>(sum * direction.norm());
  }
  EXPECT_LT(Difference(Project(mesh, view), expected), 2e-6);
  EXPECT_LT(Difference(Walk(mesh, view), expected), 2e-6);
}

TEST(MeshRadiograph, SeveralViewsInOneCallAreThoseOfEach)
{
  auto mesh = Staircase();
  test::SetRandom(mesh, 3, 8);
  const std::vector<View>         views = { Oblique(false), Oblique(true, 50), Oblique(false, 33) };
  std::vector<std::vector<float>> images;
  std::vector<float *>            pointers;
  for (const View & view : views)
  {
    images.emplace_back(static_cast<std::size_t>(view.size[0]) * view.size[1]);
  }
  for (auto & image : images)
  {
    pointers.push_back(image.data());
  }
  ProjectMesh(mesh.points, mesh, views, {}, Execution(), pointers);
  for (std::size_t i = 0; i < views.size(); ++i)
  {
    EXPECT_EQ(images[i], Project(mesh, views[i]));
  }
}

TEST(MeshRadiograph, ManyPosesInOneCallAreThoseOfEachOnOneThreadAndOnAll)
{
  auto mesh = Staircase();
  test::SetRandom(mesh, 3, 8);
  const ProjectionModel model(mesh.points, mesh, {}, Execution());
  std::vector<View>     views(64, Oblique(false, 48));
  const std::size_t     pixels = static_cast<std::size_t>(views[0].size[0]) * views[0].size[1];
  const std::size_t     all = pixels * views.size();
  ASSERT_GE(views.size(), Execution().GetNumberOfWorkUnits());
  std::vector<float>   images(all, -1), onOneThread(all, -1), alone(pixels);
  std::vector<float *> pointers, pointersOnOneThread;
  for (std::size_t i = 0; i < views.size(); ++i)
  {
    views[i].source += Vector3(2.0 * static_cast<double>(i % 8), 3.0 * static_cast<double>(i / 8), 0);
    pointers.push_back(&images[i * pixels]);
    pointersOnOneThread.push_back(&onOneThread[i * pixels]);
  }
  ProjectMesh(model, views, Execution(), pointers);
  // Within a loop's body loops run on one thread, in order.
  Execution().For(2, [&](std::size_t i) {
    if (i == 0)
    {
      ProjectMesh(model, views, Execution(), pointersOnOneThread);
    }
  });
  EXPECT_EQ(images, onOneThread);
  for (std::size_t i = 0; i < views.size(); ++i)
  {
    ProjectMesh(model, { views[i] }, Execution(), { alone.data() });
    EXPECT_TRUE(std::equal(alone.begin(), alone.end(), pointers[i])) << i;
  }
}

TEST(MeshRadiograph, AKeptModelGivesTheImagesOfTheMesh)
{
  auto mesh = Staircase();
  test::SetRandom(mesh, MaximumBernsteinDegree, 3);
  for (std::size_t t = 0; t < mesh.degree.size(); ++t)
  {
    mesh.degree[t] = static_cast<decltype(mesh.degree)::value_type>(t % (MaximumBernsteinDegree + 1));
  }
  MeshRadiographParameters parameters;
  parameters.scale = 1.5;
  parameters.offset = -0.25;
  const ProjectionModel model(mesh.points, mesh, parameters, Execution());
  for (const View & view : { Oblique(false), Oblique(true, 50), Oblique(false, 33) })
  {
    std::vector<float> image(static_cast<std::size_t>(view.size[0]) * view.size[1]);
    ProjectMesh(model, { view }, Execution(), { image.data() });
    EXPECT_EQ(image, Project(mesh, view, parameters));
    EXPECT_LT(Difference(image, Walk(mesh, view, parameters)), 1e-5);
  }
}

TEST(MeshRadiograph, DoesNotDependOnTheOrderOfTheCells)
{
  auto mesh = Box({ { 5, 4, 6 } }, 0.3);
  test::SetRandom(mesh, 3, 12);
  const View               view = Oblique(false, 90);
  const auto               image = Project(mesh, view);
  MeshArrays               shuffled = mesh;
  std::vector<std::size_t> order(mesh.tetrahedra.size());
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), std::mt19937(4));
  const std::size_t stride = mesh.coefficients.size() / order.size();
  for (std::size_t t = 0; t < order.size(); ++t)
  {
    shuffled.tetrahedra[t] = mesh.tetrahedra[order[t]];
    shuffled.degree[t] = mesh.degree[order[t]];
    std::copy_n(&mesh.coefficients[order[t] * stride], stride, &shuffled.coefficients[t * stride]);
  }
  EXPECT_LT(Difference(Project(shuffled, view), image), 2e-6);
}

TEST(MeshRadiograph, PolynomialsOfAnyDegreeMatchTheirClosedForm)
{
  const std::vector<test::Affine> functions = { { 0.8, Vector3(0.02, -0.01, 0.015) },
                                                { -0.3, Vector3(0.01, 0.02, -0.03) } };
  for (bool parallel : { false, true })
  {
    const View view = Oblique(parallel, 64);
    for (int degree = 0; degree <= MaximumBernsteinDegree; ++degree)
    {
      auto mesh = Box({ { 3, 3, 3 } }, 0.3);
      test::SetPowers(
        mesh, [degree](std::size_t) { return degree; }, functions);
      const auto expected = BoxImage(view, lower, upper, [&](const Vector3 & a, const Vector3 & b) {
        return test::IntegratePower(functions[0], degree, a, b) + test::IntegratePower(functions[1], degree, a, b);
      });
      EXPECT_LT(Difference(Project(mesh, view), expected), 5e-6) << parallel << ' ' << degree;
      EXPECT_LT(Difference(Walk(mesh, view), expected), 1e-6) << parallel << ' ' << degree;
    }
  }
}

TEST(MeshRadiograph, WalkAndProjectionAgreeOnANonConvexMeshOfMixedDegrees)
{
  auto mesh = Staircase();
  test::SetRandom(mesh, MaximumBernsteinDegree, 3);
  for (bool parallel : { false, true })
  {
    const View view = Oblique(parallel, 120);
    EXPECT_LT(Difference(Project(mesh, view), Walk(mesh, view)), 1e-5) << parallel;
  }
}

TEST(MeshRadiograph, ARayThatLeavesABoneEntersItAgain)
{
  auto mesh = test::GridMesh({ { 5, 1, 1 } }, lower, Vector3(8, 30, 20), 0, [](int i, int, int) { return i % 2 == 0; });
  test::SetConstant(mesh, 1);
  View view;
  view.source = Vector3(-300, 1, 2);
  view.detectorOrigin = Vector3(300, -1.7, 3.3);
  view.detectorU = Vector3(0, 1, 0);
  view.size = { { 5, 5 } };
  for (float value : Project(mesh, view))
  {
    EXPECT_NEAR(value, 24, 2e-3);
  }
  EXPECT_LT(Difference(Project(mesh, view), Walk(mesh, view)), 1e-6);
}

TEST(MeshRadiograph, RaysThroughFacesEdgesAndVerticesCountOnce)
{
  // Rays run exactly within the planes of faces, along edges and through vertices.
  auto       mesh = test::GridMesh({ { 4, 4, 4 } }, Vector3::Zero(), Vector3::Constant(8));
  const auto box = Vector3::Constant(32);
  test::SetConstant(mesh, 1);
  for (bool parallel : { false, true })
  {
    for (double along : { 0.0, 1.0 })
    {
      View view;
      view.parallel = parallel;
      view.detectorOrigin = Vector3(1, 100, 31);
      view.size = { { 31, 31 } };
      view.source = Vector3(16, -100, 16);
      view.direction = Vector3(0, 1, along).normalized();
      view.source.z() += along * 4;
      view.detectorOrigin.z() += along * 92;
      if (!parallel)
      {
        view.detectorOrigin = Vector3(-24, 100, 56);
        view.spacing = { 4, 4 };
        view.size = { { 21, 21 } };
      }
      const auto expected = BoxImage(view, Vector3::Zero(), box, Chord);
      const auto projected = Project(mesh, view), walked = Walk(mesh, view);
      // A ray within the box's own surface may count or not.
      const auto inner = BoxImage(view, Vector3::Constant(1e-6), Vector3::Constant(32 - 1e-6), Chord);
      for (std::size_t i = 0; i < expected.size(); ++i)
      {
        if (std::abs(expected[i] - inner[i]) < 1e-3)
        {
          EXPECT_NEAR(projected[i], expected[i], 1e-5 * 64) << parallel << along << ' ' << i;
          EXPECT_NEAR(walked[i], expected[i], 1e-5 * 64) << parallel << along << ' ' << i;
        }
      }
    }
  }
}

TEST(MeshRadiograph, TheSourceMayLieInsideTheMesh)
{
  auto mesh = Box({ { 4, 4, 4 } }, 0.3);
  test::SetConstant(mesh, 1);
  View view = Oblique(false);
  for (const Vector3 & source :
       { Vector3(1.3, 2.1, 0.7), mesh.points[62], Vector3(0.5 * (mesh.points[62] + mesh.points[63])) })
  {
    view.source = source;
    const auto expected = BoxImage(view, lower, upper, Chord);
    EXPECT_LT(Difference(Project(mesh, view), expected), 2e-6) << source.transpose();
    EXPECT_LT(Difference(Walk(mesh, view), expected), 2e-6) << source.transpose();
  }
  test::SetRandom(mesh, 5, 11);
  view.source = Vector3(1.3, 2.1, 0.7);
  EXPECT_LT(Difference(Project(mesh, view), Walk(mesh, view)), 1e-5);
}

TEST(MeshRadiograph, WhatLiesBehindTheSourceOrTheDetectorDoesNotCount)
{
  auto mesh = Box({ { 4, 4, 4 } }, 0.3);
  test::SetConstant(mesh, 1);
  for (bool parallel : { false, true })
  {
    View view;
    view.parallel = parallel;
    view.source = Vector3(0, -200, 0);
    view.detectorOrigin = Vector3(-30.7, 3.3, 30.6);
    view.size = { { 63, 63 } };
    const auto through = BoxImage(view, lower, upper, Chord);
    EXPECT_LT(Difference(Project(mesh, view), through), 2e-6) << parallel;
    EXPECT_LT(Difference(Walk(mesh, view), through), 2e-6) << parallel;
    view.detectorOrigin.y() = -40;
    EXPECT_EQ(Largest(Project(mesh, view)), 0) << parallel;
    EXPECT_EQ(Largest(Walk(mesh, view)), 0) << parallel;
    view.detectorOrigin.y() = 200;
    view.source = Vector3(0, 60, 0);
    if (!parallel)
    {
      EXPECT_EQ(Largest(Project(mesh, view)), 0);
      EXPECT_EQ(Largest(Walk(mesh, view)), 0);
    }
  }
}

TEST(MeshRadiograph, IsLinearInTheDensity)
{
  auto f = Staircase(), g = f, sum = f;
  test::SetRandom(f, 6, 1);
  test::SetRandom(g, 6, 2);
  test::SetRandom(sum, 6, 2);
  for (std::size_t i = 0; i < f.coefficients.size(); ++i)
  {
    sum.coefficients[i] = 2 * f.coefficients[i] - 0.5 * g.coefficients[i];
  }
  const View view = Oblique(false);
  const auto a = Project(f, view), b = Project(g, view), expected = Project(sum, view);
  auto       combined = a;
  for (std::size_t i = 0; i < a.size(); ++i)
  {
    combined[i] = 2 * a[i] - 0.5f * b[i];
  }
  EXPECT_LT(Difference(combined, expected), 1e-5);

  MeshRadiographParameters parameters;
  parameters.scale = 3;
  parameters.offset = 0.25;
  auto ones = f, scaled = f;
  test::SetConstant(ones, 0.25);
  const auto chords = Project(ones, view), affine = Project(f, view, parameters);
  combined = a;
  for (std::size_t i = 0; i < a.size(); ++i)
  {
    combined[i] = 3 * a[i] + chords[i];
  }
  EXPECT_LT(Difference(affine, combined), 1e-5);
  EXPECT_LT(Difference(Walk(f, view, parameters), combined), 1e-5);
}

TEST(MeshRadiograph, RegionsAddUpToTheWhole)
{
  auto mesh = Staircase();
  test::SetRandom(mesh, 4, 5);
  const View view = Oblique(false);
  for (const auto & method : { Project, Walk })
  {
    std::vector<float> sum(static_cast<std::size_t>(view.size[0]) * view.size[1], 0.0f);
    for (int region = 1; region <= 3; ++region)
    {
      MeshRadiographParameters parameters;
      parameters.minimumRegion = parameters.maximumRegion = region;
      const auto part = method(mesh, view, parameters);
      EXPECT_GT(Largest(part), 0);
      std::transform(part.begin(), part.end(), sum.begin(), sum.begin(), std::plus<float>());
    }
    EXPECT_LT(Difference(sum, method(mesh, view, {})), 1e-5);
  }
}

TEST(MeshRadiograph, DoesNotDependOnTheOrderOfWork)
{
  auto mesh = Staircase();
  test::SetRandom(mesh, 4, 5);
  const View         view = Oblique(false, 150);
  const auto         projected = Project(mesh, view), walked = Walk(mesh, view);
  std::vector<float> alone(projected.size()), walkedAlone(projected.size());
  // Within a loop's body loops run on one thread, in order.
  Execution().For(2, [&](std::size_t i) {
    if (i == 0)
    {
      ProjectMesh(mesh.points, mesh, view, {}, Execution(), alone.data());
    }
    else
    {
      WalkMesh(mesh.points, mesh, view, {}, Execution(), walkedAlone.data(), nullptr);
    }
  });
  EXPECT_EQ(alone, projected);
  EXPECT_EQ(walkedAlone, walked);
}

TEST(ColumnRun, StaysEmptyWhateverIsKept)
{
  for (const bool first : { true, false })
  {
    ColumnRun run{ 0.0, 19.0 };
    run.Keep(first ? -1.0 : -100.0, first ? 0.0 : 1.0); // no column, or those from 100 on
    run.Keep(first ? -100.0 : -1.0, first ? 1.0 : 0.0);
    EXPECT_LT(run.last, 0.0);
  }
}

TEST(MeshRadiograph, ADetectorBesideTheParallelBeamOfTheMeshSeesNothing)
{
  auto mesh = Box({ { 4, 4, 4 } }, 0.0);
  test::SetConstant(mesh, 1);
  View view;
  view.parallel = true;
  view.direction = Vector3(0, -1, 0);
  view.detectorU = Vector3::UnitX();
  view.detectorV = Vector3::UnitZ();
  view.size = { { 20, 50 } };
  view.spacing = { 6, 6 };
  view.detectorOrigin = Vector3(-44, 195, 87); // the mesh lies beyond it
  EXPECT_EQ(Largest(Project(mesh, view)), 0);
  EXPECT_EQ(Largest(Walk(mesh, view)), 0);
  view.detectorOrigin = Vector3(-444, -195, -87); // and here to its right
  EXPECT_EQ(Largest(Project(mesh, view)), 0);
  EXPECT_EQ(Largest(Walk(mesh, view)), 0);
}

TEST(MeshRadiograph, WalkAndProjectionAgreeFromAnywhere)
{
  auto mesh = Staircase();
  test::SetRandom(mesh, 4, 21);
  std::mt19937                           random(13);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto vector = [&]() { return Vector3(uniform(random), uniform(random), uniform(random)); };
  for (int k = 0; k < 60; ++k)
  {
    // Sources near, within and far from the mesh; detectors beyond, across and before it, at any angle.
    const Vector3            centre(0, 0, 2), beam = vector().normalized();
    const Eigen::Quaterniond tilt(Eigen::AngleAxisd(0.5 * uniform(random), vector().normalized()));
    View                     view;
    view.parallel = k % 3 == 0;
    view.source = centre - (k % 2 == 0 ? 60 : 15) * (1.2 + uniform(random)) * beam;
    view.direction = beam;
    view.detectorU = tilt * beam.unitOrthogonal();
    view.detectorV = tilt * beam.cross(beam.unitOrthogonal());
    view.size = { { 37, 41 } };
    view.spacing = { 2.1, 1.7 };
    view.detectorOrigin = centre + (k % 5 == 0 ? 5 : 50) * beam - 38 * view.detectorU - 35 * view.detectorV;
    const auto   projected = Project(mesh, view), walked = Walk(mesh, view);
    const double largest = std::max(Largest(walked), 1.0);
    for (std::size_t i = 0; i < walked.size(); ++i)
    {
      ASSERT_NEAR(projected[i], walked[i], 1e-5 * largest) << "view " << k << ", pixel " << i;
    }
  }
}

TEST(MeshRadiograph, CellsOfAnySizeOnTheDetectorKeepTheirAccuracy)
{
  // From a few pixels a cell to more columns than strips are made for; bands of rows that cells reach across.
  auto mesh = Box({ { 1, 1, 1 } }, 0);
  for (int degree : { 1, 2, 3, 6 })
  {
    test::SetRandom(mesh, degree, 17);
    for (int pixels : { 7, 11, 20, 45, 170 })
    {
      const View view = Oblique(degree == 2, pixels);
      EXPECT_LT(Difference(Project(mesh, view), Walk(mesh, view)), 1e-5) << degree << ' ' << pixels;
    }
  }
}

TEST(MeshRadiograph, CellsAtAnyDistanceFromTheSourceKeepTheirAccuracy)
{
  // Rays through a cell diverge by its depth over its distance: from what tells in the integral to what is left out.
  auto mesh = Box({ { 1, 1, 1 } }, 0);
  for (unsigned int seed = 1; seed <= 10; ++seed)
  {
    test::SetRandom(mesh, 3, seed);
    for (double distance : { 100, 400, 1600, 2800, 3600, 6000 })
    {
      View view = XRayGeometry::Framing(
        lower, upper, Vector3(0.4, 1, 0.2).normalized(), Vector3(0.1, 0.2, 1), distance, distance + 100, 15);
      const ProjectionModel model(mesh.points, mesh, {}, Execution());
      std::vector<float>    image(static_cast<std::size_t>(view.size[0]) * view.size[1]);
      ProjectMesh(model, { view }, Execution(), { image.data() });
      EXPECT_LT(Difference(image, Walk(mesh, view)), 3e-6) << distance << ' ' << seed;
    }
  }
}

TEST(MeshRadiograph, CellsFarWiderThanTheDetectorKeepTheirAccuracy)
{
  // Up to half a million pixels: powers of their number do not fit single precision.
  auto mesh = Box({ { 1, 1, 1 } }, 0);
  for (int degree : { 3, 8 })
  {
    test::SetPowers(
      mesh,
      [degree](std::size_t) { return degree; },
      { test::Affine{ 0.6, Vector3(0.02, 0.01, -0.015) }, test::Affine{ 0.3, Vector3(-0.01, 0.02, 0.02) } });
    for (double share : { 0.1, 1e-3, 1e-4 })
    {
      View          view = Oblique(false, 24);
      const Vector2 half = 0.5 * (1.0 - share) * Vector2(view.size[0] - 1, view.size[1] - 1).cwiseProduct(view.spacing);
      view.detectorOrigin += half.x() * view.detectorU + half.y() * view.detectorV;
      view.spacing *= share;
      EXPECT_LT(Difference(Project(mesh, view), Walk(mesh, view)), 1e-5) << degree << ' ' << share;
    }
  }
}

TEST(MeshRadiograph, CellsOfOneRowAndManyColumnsOrTheReverseKeepTheirAccuracy)
{
  auto mesh = Box({ { 2, 2, 2 } }, 0);
  test::SetRandom(mesh, 2, 11);
  for (auto & degree : mesh.degree)
  {
    degree = 2;
  }
  for (bool portable : { false, true })
  {
    MeshRadiographParameters parameters;
    parameters.portable = portable;
    for (int columns : { 500, 700, 2, 3 })
    {
      View      view = Oblique(false, 64);
      const int rows = columns > 3 ? 2 : 600;
      view.spacing = { view.spacing.x() * view.size[0] / columns, view.spacing.y() * view.size[1] / rows };
      view.size = { { columns, rows } };
      EXPECT_LT(Difference(Project(mesh, view, parameters), Walk(mesh, view)), 1e-5) << columns << ' ' << portable;
    }
  }
}

TEST(MeshRadiograph, TheProcessorsNewerInstructionsChangeRoundingOnly)
{
  auto mesh = Staircase();
  test::SetRandom(mesh, MaximumBernsteinDegree, 9);
  MeshRadiographParameters portable;
  portable.portable = true;
  for (bool parallel : { false, true })
  {
    const View view = Oblique(parallel);
    EXPECT_LT(Difference(Project(mesh, view, portable), Project(mesh, view)), 5e-6) << parallel;
  }
}

TEST(MeshRadiograph, SliversSeenEdgeOnKeepTheirAccuracy)
{
  // Flattened along the beam's normal: faces are seen nearly edge-on, cells are a thousand times longer than thick.
  std::mt19937 random(5);
  auto         mesh = Box({ { 4, 4, 4 } }, 0.3);
  for (Vector3 & p : mesh.points)
  {
    p.x() = 1e-3 * p.x() + 0.07 * p.y();
  }
  test::SetRandom(mesh, 3, 5);
  View view;
  view.source = Vector3(0, -300, 0);
  view.detectorOrigin = Vector3(-8, 300, 30);
  view.spacing = { 0.2, 2 };
  view.size = { { 80, 40 } };
  EXPECT_LT(Difference(Project(mesh, view), Walk(mesh, view)), 1e-5);
}

TEST(MeshRadiograph, CountsTheCellsPassed)
{
  auto mesh = test::GridMesh({ { 6, 1, 1 } }, Vector3::Zero(), Vector3(2, 40, 40));
  test::SetConstant(mesh, 1);
  View view;
  view.parallel = true;
  view.direction = Vector3(1, 0, 0);
  view.detectorOrigin = Vector3(50, 1, 39);
  view.detectorU = Vector3(0, 1, 0);
  view.size = { { 60, 30 } };
  std::vector<float>        image(1800);
  std::vector<std::int32_t> passed(1800);
  WalkMesh(mesh.points, mesh, view, {}, Execution(), image.data(), passed.data());
  for (int i = 0; i < 1800; ++i)
  {
    EXPECT_EQ(passed[i], i % 60 < 39 ? 18 : 0) << "three tetrahedra of a Kuhn cube lie on each of its straight rays";
  }
}
} // namespace MeshRadiographTests
