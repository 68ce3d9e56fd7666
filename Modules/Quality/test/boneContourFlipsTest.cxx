/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneContourFlips.h"

#include "boneMeshQualityFilter.h"
#include "boneMeshValidator.h"
#include "boneQualityMeasures.h"
#include "boneQualityTestBodies.h"
#include "boneTetraFlips.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

using namespace bone;

namespace ContourFlipsTests
{
constexpr double Radius = 12.0;

/** A rod of two regions whose slices turn by `twist` rad a mm: with one sense the surface's diagonals are its short
 * ones, with the other its long ones, which run deeper within. */
MeshArrays
TwistedRod(double twist)
{
  MeshArrays mesh = test::StraightRod(Radius);
  for (Vector3 & x : mesh.points)
  {
    const double c = std::cos(twist * x.z()), s = std::sin(twist * x.z());
    x = Vector3(c * x.x() - s * x.y(), s * x.x() + c * x.y(), x.z());
  }
  return mesh;
}

ContourShape
Rod(double inner)
{
  return ContourShape(*test::RodContours(Radius, inner));
}

/** Mean squared distance of contours from the surfaces they belong to, mm^2. */
double
MeanSquare(const TetraComplex & complex, const ContourSamples & contours)
{
  double sum = 0.0, weight = 0.0;
  for (const auto & match : contours.FindMatches(complex))
  {
    sum += match.weight * (match.sample->place - match.foot).squaredNorm();
    weight += match.weight;
  }
  return sum / weight;
}

constexpr double Inner = Radius - Radius / 3.5;

TEST(ContourSamples, BelongToTrianglesOfTheirLevelThatLookTheirWay)
{
  const TetraComplex   complex(TwistedRod(0.0));
  const ContourShape   shape = Rod(Inner);
  const ContourSamples contours(complex, shape);
  int                  counts[2] = {};
  double               area = 0.0;
  for (const auto & match : contours.FindMatches(complex))
  {
    const Vector3 & x = match.sample->place;
    const double    radius = std::hypot(x.x(), x.y());
    const bool      inner = radius < 0.9 * Radius;
    ++counts[inner];
    area += inner ? 0.0 : match.weight;
    // Interfaces look inward from the smaller region, which carries them.
    EXPECT_GT((inner ? -1.0 : 1.0) * match.normal.dot(match.sample->outward), 0.9);
    EXPECT_LT((x - match.foot).norm(), 0.03 * Radius);
    for (IdType p : match.triangle)
    {
      const Vector3 & y = complex.Points()[p];
      EXPECT_NEAR(std::hypot(y.x(), y.y()), inner ? Inner : Radius, 0.05);
    }
  }
  EXPECT_GT(counts[0], 1000);
  EXPECT_GT(counts[1], 1000);
  const double exact = 2.0 * std::acos(-1.0) * Radius * 22.0;
  EXPECT_NEAR(area, exact, 0.05 * exact);
}

TEST(FlipToContours, SurfacesComeCloserAndTheMeshStaysValid)
{
  const ContourShape shape = Rod(Inner);
  std::size_t        done = 0;
  for (const double twist : { -0.12, 0.12 })
  {
    const auto            mesh = TwistedRod(twist);
    TetraComplex          complex(mesh);
    PointMover            mover(complex);
    const ContourSamples  contours(complex, shape);
    ContourFlipParameters parameters;
    parameters.cosineFloor = std::cos(0.1);
    const SurfaceBending limp(complex, 0.0);
    SurfaceEnergy        energy(complex, contours, limp);
    const double         before = MeanSquare(complex, contours);
    const std::size_t    flips = FlipToContours(complex, mover, energy, parameters, Execution());
    const double         after = MeanSquare(complex, contours);
    EXPECT_TRUE(flips > 0 ? after < before : after == before) << before << ' ' << after;
    done += flips;
    std::vector<IdType> pointId, cellSlot;
    const MeshArrays    made = complex.Compact(mesh, pointId, cellSlot);
    EXPECT_TRUE(ValidateMesh(made).IsValid()) << ValidateMesh(made).Summary();
    EXPECT_EQ(made.points, mesh.points);
    for (std::size_t t = 0; flips > 0 && t < made.tetrahedra.size(); ++t)
    {
      const auto & p = made.points;
      const Id4 &  c = made.tetrahedra[t];
      EXPECT_LT(LargestDihedralCosine(p[c[0]], p[c[1]], p[c[2]], p[c[3]]), parameters.cosineFloor + 1e-9);
    }
    // It comes to rest: flips are not flipped back.
    EXPECT_LE(FlipToContours(complex, mover, energy, parameters, Execution()), flips / 2);
  }
  EXPECT_GT(done, 50u);
}

/** Edge by edge, as FlipToContours does where it foresees nothing. */
static std::size_t
FlipOneByOne(TetraComplex &                complex,
             PointMover &                  mover,
             SurfaceEnergy &               energy,
             const ContourFlipParameters & parameters)
{
  std::size_t count = 0;
  for (const auto & [a, b] : energy.Edges())
  {
    const auto corners = energy.Corners(a, b);
    if (!corners)
    {
      continue;
    }
    const auto [c, d] = *corners;
    const std::vector<TriangleIds> before = { { a, b, c }, { a, b, d } }, after = { { a, c, d }, { b, c, d } };
    const auto                     patch = energy.At(before);
    if (patch.samples.size() < 2 || !(energy.Change(patch, after) < -parameters.leastGain * patch.area))
    {
      continue;
    }
    const SurfaceFlip plan = PlanSurfaceFlip(complex, a, b, parameters.cosineFloor);
    const int         f = plan.surface;
    if (plan.outcome == MeshOperation::Done &&
        mover.ReplaceSurface({ { before[0], f }, { before[1], f } }, { { after[0], f }, { after[1], f } }))
    {
      energy.Replace(patch, after);
      complex.ReplaceAcross(plan.removed, plan.created, plan.regions, plan.surface);
      ++count;
    }
  }
  return count;
}

TEST(FlipToContours, WhatIsForeseenOnAllThreadsIsWhatOneEdgeAfterTheOtherFinds)
{
  const ContourShape    shape = Rod(Inner);
  ContourFlipParameters parameters;
  parameters.cosineFloor = std::cos(0.1);
  parameters.leastGain = 0.0;
  for (const double twist : { -0.12, 0.05, 0.12 })
  {
    MeshArrays                             mesh = TwistedRod(twist);
    std::mt19937                           random(1);
    std::uniform_real_distribution<double> shift(-0.4, 0.4);
    for (Vector3 & x : mesh.points)
    {
      x += Vector3(shift(random), shift(random), 0.0);
    }
    ASSERT_TRUE(ValidateMesh(mesh).IsValid());
    TetraComplex complexes[2] = { TetraComplex(mesh), TetraComplex(mesh) };
    std::size_t  flips[2];
    for (int k = 0; k < 2; ++k)
    {
      PointMover           mover(complexes[k]);
      const ContourSamples contours(complexes[k], shape);
      const SurfaceBending bending(complexes[k], 0.05);
      SurfaceEnergy        energy(complexes[k], contours, bending);
      flips[k] = k == 0 ? FlipOneByOne(complexes[k], mover, energy, parameters)
                        : FlipToContours(complexes[k], mover, energy, parameters, Execution());
    }
    EXPECT_GT(flips[0], 10u);
    EXPECT_EQ(flips[0], flips[1]);
    ASSERT_EQ(complexes[0].Size(), complexes[1].Size());
    for (IdType t = 0; t < complexes[0].Size(); ++t)
    {
      EXPECT_EQ(complexes[0].Cell(t), complexes[1].Cell(t));
    }
  }
}

TEST(FlipToContours, NothingIsFlippedForLessThanTheGainAskedFor)
{
  const ContourShape    shape = Rod(Inner);
  TetraComplex          complex(TwistedRod(0.12));
  PointMover            mover(complex);
  ContourFlipParameters parameters;
  parameters.cosineFloor = std::cos(0.1);
  parameters.leastGain = 10.0;
  const ContourSamples contours(complex, shape);
  const SurfaceBending bending(complex, 0.05);
  SurfaceEnergy        energy(complex, contours, bending);
  EXPECT_EQ(FlipToContours(complex, mover, energy, parameters, Execution()), 0u);
}

TEST(FlipToContours, SurfacesTurnLessWhereTheyAreStiff)
{
  const ContourShape shape = Rod(Inner);
  MeshArrays         mesh = TwistedRod(0.12);
  for (std::size_t p = 0; p < mesh.points.size(); ++p)
  {
    Vector3 &    x = mesh.points[p];
    const double radius = std::hypot(x.x(), x.y());
    x.head<2>() *= radius > 0.9 * Radius ? 1.0 + 0.03 * std::sin(static_cast<double>(7 * p)) : 1.0;
  }
  ContourFlipParameters parameters;
  parameters.cosineFloor = std::cos(0.1);
  parameters.leastGain = 0.5; // more than contours give
  for (const bool stiff : { false, true })
  {
    TetraComplex         complex(mesh);
    PointMover           mover(complex);
    const SurfaceBending bending(complex, stiff ? 10.0 : 0.0);
    const ContourSamples contours(complex, shape);
    SurfaceEnergy        energy(complex, contours, bending);
    const double         before = test::MeanTurn(complex);
    const std::size_t    flips = FlipToContours(complex, mover, energy, parameters, Execution());
    EXPECT_EQ(flips > 0, stiff);
    EXPECT_TRUE(!stiff || test::MeanTurn(complex) < 0.95 * before) << test::MeanTurn(complex) / before;
  }
}

TEST(FlipToContours, IsPartOfTheQualityStageWhereContoursAreGiven)
{
  const auto mesh = DensityMesh<double>::New();
  mesh->SetArrays(TwistedRod(0.12));
  for (const bool with : { false, true })
  {
    auto filter = MeshQualityFilter<DensityMesh<double>>::New();
    filter->SetInput(mesh);
    filter->SetRounds(1);
    filter->SetContours(with ? test::RodContours(Radius, Inner).GetPointer() : nullptr);
    filter->Update();
    EXPECT_EQ(filter->GetReport().contourFlips > 0, with);
    const auto validation = ValidateMesh(filter->GetOutput()->GetArrays());
    EXPECT_TRUE(validation.IsValid()) << validation.Summary();
  }
}
} // namespace ContourFlipsTests
