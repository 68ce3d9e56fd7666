/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneMeshDerivatives.h"

#include "boneRadiographTestMeshes.h"
#include "boneRayFrame.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <numeric>

namespace MeshDerivativesTests
{
using namespace bone;
using View = XRayGeometry::View;

const Execution execution;

MeshArrays
Staircase(int degree, bool mixed)
{
  auto mesh = test::GridMesh({ { 3, 3, 2 } }, Vector3(-20, -15, -10), Vector3(12, 10, 11), 0.2, [](int i, int j, int) {
    return i + j < 4 && (i != 1 || j != 0);
  });
  for (Vector3 & p : mesh.points)
  {
    p += Vector3(0.03 * p.y(), 0.02 * p.z(), 0.04 * p.x()); // no face along the rays
  }
  test::SetRandom(mesh, degree, 3);
  if (!mixed)
  {
    mesh.degree.assign(mesh.tetrahedra.size(), degree);
    std::mt19937                           random(5);
    std::uniform_real_distribution<double> value(0.2, 1.0);
    std::generate(mesh.coefficients.begin(), mesh.coefficients.end(), [&]() { return value(random); });
  }
  return mesh;
}

View
Look(bool parallel, const Vector3 & source = Vector3(-60, -300, -40))
{
  View view;
  view.parallel = parallel;
  view.source = source;
  view.direction = Vector3(0.2, 1, 0.15).normalized();
  view.detectorOrigin = Vector3(-27, 120, 33);
  view.spacing = { 2.1, 1.9 };
  view.size = { { 33, 29 } };
  return view;
}

/** In double precision, by clipping each ray with each tetrahedron. */
std::vector<double>
Reference(const std::vector<Vector3> &     points,
          const MeshArrays &               mesh,
          const View &                     view,
          const MeshRadiographParameters & parameters)
{
  const auto          rays = RayFrame::Displaced(view);
  const std::size_t   stride = BernsteinCount(mesh.maximumDegree);
  std::vector<double> image;
  for (int r = 0; r < view.size[1]; ++r)
  {
    for (int c = 0; c < view.size[0]; ++c)
    {
      const Vector3 direction = rays.Direction(c, r), origin = rays.Origin(c, r);
      double        sum = 0;
      for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
      {
        const Id4 &       v = mesh.tetrahedra[t];
        const Vector3 &   a = points[v[0]], &b = points[v[1]], &d = points[v[2]], &e = points[v[3]];
        const Barycentric start = BarycentricCoordinates(origin, a, b, d, e);
        const Barycentric step = BarycentricCoordinates(origin + direction, a, b, d, e) - start;
        double            first = view.parallel ? -1e6 : 0, last = view.parallel ? 0 : 1;
        for (int i = 0; i < 4; ++i)
        {
          (step[i] > 0 ? first : last) =
            step[i] > 0 ? std::max(first, -start[i] / step[i]) : std::min(last, -start[i] / step[i]);
        }
        if (first < last && mesh.region[t] >= parameters.minimumRegion)
        {
          const double length = (last - first) * direction.norm();
          sum += parameters.offset * length +
                 parameters.scale * BernsteinSegmentIntegral(mesh.degree[t],
                                                             mesh.coefficients.data() + t * stride,
                                                             start + first * step,
                                                             start + last * step,
                                                             length);
        }
      }
      image.push_back(sum);
    }
  }
  return image;
}

/** Random smooth displacements and random changes of density. */
RadiographModes
RandomModes(const MeshArrays & mesh, int count)
{
  std::mt19937                           random(17);
  std::uniform_real_distribution<double> value(-1.0, 1.0);
  RadiographModes                        modes;
  modes.pose = true;
  modes.poseCentre = Vector3(3, -2, 1);
  for (int m = 0; m < count; ++m)
  {
    const Eigen::Matrix3d linear = Eigen::Matrix3d::NullaryExpr([&]() { return 0.05 * value(random); });
    modes.shape.emplace_back();
    for (const Vector3 & p : mesh.points)
    {
      modes.shape.back().emplace_back(linear * p + 0.5 * Vector3(value(random), value(random), value(random)));
    }
    modes.density.emplace_back(mesh.coefficients.size());
    std::generate(modes.density.back().begin(), modes.density.back().end(), [&]() { return value(random); });
  }
  return modes;
}

struct Images
{
  std::vector<float> image;
  std::vector<float> derivatives;
};

std::vector<float *>
Pointers(Images & images)
{
  std::vector<float *> pointers{ images.image.data() };
  for (auto image = images.derivatives.begin(); image != images.derivatives.end(); image += images.image.size())
  {
    pointers.push_back(&*image);
  }
  return pointers;
}

Images
Derive(const MeshArrays &               mesh,
       const View &                     view,
       const RadiographModes &          modes,
       const MeshRadiographParameters & parameters)
{
  const std::size_t pixels = static_cast<std::size_t>(view.size[0]) * view.size[1];
  Images            images{ std::vector<float>(pixels, -1), std::vector<float>(pixels * modes.Count(), -1) };
  ProjectMeshDerivatives(mesh.points, mesh, view, parameters, modes, execution, Pointers(images));
  return images;
}

/** The mesh moved by `step` along mode m. */
MeshArrays
Moved(const MeshArrays & mesh, const RadiographModes & modes, std::size_t m, double step)
{
  MeshArrays moved = mesh;
  if (m < 6)
  {
    const Vector3 axis = Vector3::Unit(m % 3);
    const auto    turn = Eigen::AngleAxisd(step, axis);
    for (Vector3 & p : moved.points)
    {
      p = m < 3 ? Vector3(p + step * axis) : Vector3(modes.poseCentre + turn * (p - modes.poseCentre));
    }
  }
  else if (m < 6 + modes.shape.size())
  {
    for (std::size_t p = 0; p < moved.points.size(); ++p)
    {
      moved.points[p] += step * modes.shape[m - 6][p];
    }
  }
  else
  {
    for (std::size_t c = 0; c < moved.coefficients.size(); ++c)
    {
      moved.coefficients[c] += step * modes.density[m - 6 - modes.shape.size()][c];
    }
  }
  return moved;
}

/** The 99th percentile, over the pixels hit, of the difference to central differences over the largest of these. */
double
DifferenceToCentral(const MeshArrays &               mesh,
                    const View &                     view,
                    const RadiographModes &          modes,
                    const MeshRadiographParameters & parameters,
                    std::size_t                      m,
                    const float *                    derivative)
{
  const double        step = m >= 3 && m < 6 ? 1e-6 : 1e-5;
  const auto          here = Reference(mesh.points, mesh, view, parameters);
  const auto          after = Moved(mesh, modes, m, step), before = Moved(mesh, modes, m, -step);
  const auto          high = Reference(after.points, after, view, parameters);
  const auto          low = Reference(before.points, before, view, parameters);
  std::vector<double> differences;
  double              largest = 0;
  for (std::size_t i = 0; i < here.size(); ++i)
  {
    const double central = (high[i] - low[i]) / (2 * step);
    largest = std::max(largest, std::abs(central));
    if (here[i] != 0)
    {
      differences.push_back(std::abs(central - derivative[i]));
    }
  }
  std::sort(differences.begin(), differences.end());
  EXPECT_GT(differences.size(), 200u);
  return differences[differences.size() * 99 / 100] / largest;
}

void
ExpectCentralDifferences(const MeshArrays & mesh, const View & view, const MeshRadiographParameters & parameters = {})
{
  const auto        modes = RandomModes(mesh, 1);
  const auto        images = Derive(mesh, view, modes, parameters);
  const std::size_t pixels = images.image.size();
  const auto        expected = Reference(mesh.points, mesh, view, parameters);
  const double      largest = *std::max_element(expected.begin(), expected.end());
  for (std::size_t i = 0; i < pixels; ++i)
  {
    ASSERT_NEAR(images.image[i], expected[i], 1e-5 * largest);
  }
  for (std::size_t m = 0; m < modes.Count(); ++m)
  {
    EXPECT_LT(DifferenceToCentral(mesh, view, modes, parameters, m, images.derivatives.data() + m * pixels), 1e-3)
      << "mode " << m;
  }
}

TEST(MeshDerivatives, EqualCentralDifferencesAtAnyDegree)
{
  for (int degree = 0; degree <= MaximumBernsteinDegree; ++degree)
  {
    SCOPED_TRACE(degree);
    ExpectCentralDifferences(Staircase(degree, false), Look(degree % 2 == 1));
  }
}

TEST(MeshDerivatives, EqualCentralDifferencesForAttenuationOfARegionAndMixedDegrees)
{
  MeshRadiographParameters parameters;
  parameters.scale = 2e-2;
  parameters.offset = 0.03;
  parameters.minimumRegion = 2;
  ExpectCentralDifferences(Staircase(4, true), Look(false), parameters);
}

TEST(MeshDerivatives, EqualCentralDifferencesWithTheSourceInsideAndTheDetectorThroughTheMesh)
{
  View view = Look(false, Vector3(-9, -9, 2));
  view.detectorOrigin = Vector3(-27, 9.5, 33);
  ExpectCentralDifferences(Staircase(3, true), view);
  view = Look(true);
  view.detectorOrigin = Vector3(-27, 1.5, 33);
  ExpectCentralDifferences(Staircase(3, true), view);
}

TEST(MeshDerivatives, EachOfManyModesHasItsOwnImage)
{
  // More than two blocks of vectors of each kind: multiples of one mode.
  for (int degree : { 0, 1, 3, 4 })
  {
    const auto      mesh = Staircase(degree, false);
    const View      view = Look(false);
    const auto      one = RandomModes(mesh, 1);
    const int       count = 35;
    RadiographModes modes = one;
    for (int m = 1; m < count; ++m)
    {
      modes.shape.push_back(one.shape[0]);
      modes.density.push_back(one.density[0]);
      std::for_each(modes.shape[m].begin(), modes.shape[m].end(), [&](Vector3 & v) { v *= m + 1; });
      std::for_each(modes.density[m].begin(), modes.density[m].end(), [&](double & c) { c *= m + 1; });
    }
    const auto        images = Derive(mesh, view, modes, {}), single = Derive(mesh, view, one, {});
    const std::size_t pixels = images.image.size();
    EXPECT_EQ(images.image, single.image);
    for (int m = 0; m < count; ++m)
    {
      for (std::size_t kind = 0; kind < 2; ++kind)
      {
        const float * const first = &single.derivatives[(6 + kind) * pixels];
        const float * const of = &images.derivatives[(6 + kind * count + m) * pixels];
        const float         largest = std::abs(
          *std::max_element(first, first + pixels, [](float a, float b) { return std::abs(a) < std::abs(b); }));
        EXPECT_GT(largest, 0);
        for (std::size_t i = 0; i < pixels; ++i)
        {
          ASSERT_NEAR(of[i], (m + 1) * first[i], 1e-5 * (m + 1) * largest) << degree << ' ' << m << ' ' << kind;
        }
      }
    }
  }
}

TEST(MeshDerivatives, WithoutModesThereIsTheImage)
{
  const auto mesh = Staircase(3, true);
  const View view = Look(false);
  const auto images = Derive(mesh, view, {}, {});
  const auto expected = Reference(mesh.points, mesh, view, {});
  for (std::size_t i = 0; i < expected.size(); ++i)
  {
    EXPECT_NEAR(images.image[i], expected[i], 1e-4);
  }
}

TEST(MeshDerivatives, TheAdjointIsTheTranspose)
{
  for (int degree : { 0, 2, 3, 8 })
  {
    const auto mesh = Staircase(degree, true);
    auto       view = Look(false);
    for (bool inside : { false, true })
    {
      view.source = inside ? Vector3(-9, -9, 2) : view.source;
      MeshRadiographParameters parameters;
      parameters.scale = 0.7;
      const auto modes = RandomModes(mesh, 1);
      const auto images = Derive(mesh, view, modes, parameters);

      std::mt19937                           random(23);
      std::uniform_real_distribution<double> value(-1.0, 1.0);
      std::vector<float>                     weights(images.image.size());
      std::generate(weights.begin(), weights.end(), [&]() { return static_cast<float>(value(random)); });
      std::vector<double>  coefficients(mesh.coefficients.size(), 7);
      std::vector<Vector3> positions(mesh.points.size());
      BackprojectToMesh(
        mesh.points, mesh, view, parameters, execution, weights.data(), coefficients.data(), positions.data());

      const auto weigh = [&](const float * image, double & size) {
        double sum = size = 0;
        for (std::size_t i = 0; i < weights.size(); ++i)
        {
          sum += static_cast<double>(weights[i]) * image[i];
          size += std::abs(static_cast<double>(weights[i]) * image[i]);
        }
        return sum;
      };
      double       size;
      const double forward = weigh(images.image.data(), size);
      double       backward = 0;
      for (std::size_t c = 0; c < coefficients.size(); ++c)
      {
        backward += coefficients[c] * mesh.coefficients[c];
      }
      EXPECT_NEAR(forward, backward, 1e-5 * size) << degree << inside;

      for (std::size_t m = 0; m < 7; ++m)
      {
        const auto moved = Moved(mesh, modes, m, 1e-7);
        double     change = 0;
        for (std::size_t p = 0; p < positions.size(); ++p)
        {
          change += positions[p].dot(moved.points[p] - mesh.points[p]) / 1e-7;
        }
        const double expected = weigh(images.derivatives.data() + m * weights.size(), size);
        EXPECT_NEAR(change, expected, 1e-5 * size) << degree << inside << m;
      }
    }
  }
}

TEST(MeshDerivatives, DoNotDependOnTheOrderOfWorkAndLittleOnTheInstructions)
{
  const auto mesh = Staircase(3, true);
  const View view = Look(false);
  const auto modes = RandomModes(mesh, 2);
  const auto images = Derive(mesh, view, modes, {});
  Images     other = images;
  // Within a loop's body loops run on one thread, in order.
  execution.For(2, [&](std::size_t i) {
    if (i == 0)
    {
      ProjectMeshDerivatives(mesh.points, mesh, view, {}, modes, execution, Pointers(other));
    }
  });
  EXPECT_EQ(images.derivatives, other.derivatives);

  MeshRadiographParameters portable;
  portable.portable = true;
  const auto plain = Derive(mesh, view, modes, portable);
  double     largest = 0;
  for (std::size_t i = 0; i < plain.derivatives.size(); ++i)
  {
    largest = std::max(largest, std::abs(static_cast<double>(plain.derivatives[i])));
  }
  std::size_t different = 0;
  for (std::size_t i = 0; i < plain.derivatives.size(); ++i)
  {
    different += std::abs(plain.derivatives[i] - images.derivatives[i]) > 1e-4 * largest ? 1 : 0;
  }
  EXPECT_LT(different, plain.derivatives.size() / 1000) << "at an edge another face may count";
}

TEST(MeshDerivatives, TheAdjointIsTheTransposeForEachOfManyCells)
{
  auto mesh = test::GridMesh({ { 8, 7, 6 } }, Vector3(-20, -15, -10), Vector3(5, 5, 4), 0.2);
  test::SetRandom(mesh, 2, 3);
  View view = Look(false);
  view.spacing *= 0.5;
  view.size = { { 66, 58 } };
  std::vector<float> weights(static_cast<std::size_t>(view.size[0]) * view.size[1]), image(weights.size());
  for (std::size_t i = 0; i < weights.size(); ++i)
  {
    weights[i] = 1.0f + static_cast<float>(i % 7);
  }
  std::vector<double>  coefficients(mesh.coefficients.size());
  std::vector<Vector3> positions(mesh.points.size());
  BackprojectToMesh(mesh.points, mesh, view, {}, execution, weights.data(), coefficients.data(), positions.data());
  const std::size_t stride = BernsteinCount(mesh.maximumDegree);
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); t += 37)
  {
    // The tetrahedron alone.
    MeshArrays alone = mesh;
    alone.region.assign(mesh.tetrahedra.size(), 1);
    alone.region[t] = 2;
    MeshRadiographParameters parameters;
    parameters.minimumRegion = 2;
    ProjectMesh(alone.points, alone, view, parameters, execution, image.data());
    const double forward = std::inner_product(image.begin(), image.end(), weights.begin(), 0.0);
    const double backward = std::inner_product(
      &coefficients[t * stride], &coefficients[t * stride] + stride, &mesh.coefficients[t * stride], 0.0);
    EXPECT_NEAR(backward, forward, 1e-5 * std::abs(forward)) << t;
  }
}

TEST(MeshDerivatives, TheAdjointDoesNotDependOnTheOrderOfWorkNorOnAKeptModelAndLittleOnTheInstructions)
{
  // From cells of many pixels, in rows longer than a vector, to cells between the pixels.
  for (int pixels : { 7, 40, 300 })
  {
    SCOPED_TRACE(pixels);
    auto mesh = Staircase(3, true);
    std::fill(mesh.degree.begin() + mesh.degree.size() / 2, mesh.degree.end(), 3);
    View view = Look(false);
    view.spacing *= 33.0 / pixels;
    view.size = { { pixels, pixels } };
    std::vector<float> weights(static_cast<std::size_t>(pixels) * pixels);
    for (std::size_t i = 0; i < weights.size(); ++i)
    {
      weights[i] = static_cast<float>(i % 5) - 1.0f;
    }
    struct Gradients
    {
      std::vector<double>  coefficients;
      std::vector<Vector3> positions;
    };
    const auto make = [&](bool kept, bool portable) {
      MeshRadiographParameters parameters;
      parameters.portable = portable;
      Gradients             gradients{ std::vector<double>(mesh.coefficients.size(), 7),
                           std::vector<Vector3>(mesh.points.size(), Vector3(7, 7, 7)) };
      const ProjectionModel model(mesh.points, mesh, parameters, execution, kept);
      BackprojectToMesh(
        model, view, execution, weights.data(), gradients.coefficients.data(), gradients.positions.data());
      return gradients;
    };
    const Gradients expected = make(true, false), plain = make(true, true);
    Gradients       other = make(false, false);
    EXPECT_EQ(other.coefficients, expected.coefficients);
    EXPECT_EQ(other.positions, expected.positions);
    // Within a loop's body loops run on one thread, in order.
    execution.For(2, [&](std::size_t i) { i == 0 ? void(other = make(true, false)) : void(); });
    EXPECT_EQ(other.coefficients, expected.coefficients);
    EXPECT_EQ(other.positions, expected.positions);
    double largest = 0, farthest = 0;
    for (double c : expected.coefficients)
    {
      largest = std::max(largest, std::abs(c));
    }
    for (const Vector3 & x : expected.positions)
    {
      farthest = std::max(farthest, x.norm());
    }
    EXPECT_GT(largest, 0);
    EXPECT_GT(farthest, 0);
    for (std::size_t c = 0; c < plain.coefficients.size(); ++c)
    {
      ASSERT_NEAR(plain.coefficients[c], expected.coefficients[c], 1e-5 * largest) << c;
    }
    for (std::size_t v = 0; v < plain.positions.size(); ++v)
    {
      ASSERT_LT((plain.positions[v] - expected.positions[v]).norm(), 1e-4 * farthest) << v;
    }
  }
}
} // namespace MeshDerivativesTests
