/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSharpEdges.h"

#include "boneMeshQualityFilter.h"
#include "boneMeshValidator.h"
#include "boneQualityTestBodies.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

using namespace bone;

namespace SharpEdgesTests
{
constexpr double Radius = 12.0;
constexpr double Inner = Radius - Radius / 3.5;
constexpr double Floor = 0.05; ///< rad, of dihedral angles afterwards

/** A rod of two regions; of its outside points one in `every` is pushed in: pits that contours know not. */
MeshArrays
PittedRod(unsigned int every, unsigned int seed, double depth = 2.5)
{
  MeshArrays   mesh = test::StraightRod(Radius);
  std::mt19937 random(seed);
  for (Vector3 & x : mesh.points)
  {
    const double radius = std::hypot(x.x(), x.y());
    if (radius > 0.9 * Radius && x.z() > 1.0 && x.z() < 21.0 && random() % every == 0)
    {
      x.head<2>() *= 1.0 - depth / radius;
    }
  }
  return mesh;
}

/** Largest turn of the edges that contours belong to, rad. */
double
LargestTurn(const SurfaceEnergy & energy)
{
  double largest = 0.0;
  for (const auto & [a, b] : energy.Edges())
  {
    largest = std::max(largest, energy.Deviation(a, b));
  }
  return largest;
}

TEST(SurfaceEnergy, ChangesAreDifferencesOfTheWhole)
{
  // What Change says is what distances and bending of all surfaces together change by.
  const ContourShape shape(*test::RodContours(Radius, Inner));
  for (unsigned int seed = 1; seed <= 3; ++seed)
  {
    TetraComplex         complex(PittedRod(6, seed, 1.0)); // all contours near enough to count
    PointMover           mover(complex);
    MeshRepair           repair(complex, mover, 10.0);
    const ContourSamples contours(complex, shape);
    const SurfaceBending bending(complex, 0.1);
    SurfaceEnergy        energy(complex, contours, bending);
    const auto           whole = [&]() {
      const auto & x = complex.Points();
      double       sum = 0.0;
      for (const auto & [a, b] : SurfaceEnergy(complex, contours, bending).Edges())
      {
        const auto corners = energy.Corners(a, b);
        sum += corners ? bending.Energy(x[a], x[b], x[(*corners)[0]], x[(*corners)[1]]) : 0.0;
      }
      for (const auto & match : contours.FindMatches(complex))
      {
        sum += match.sample->weight * (match.sample->place - match.foot).squaredNorm();
      }
      return sum;
    };
    const double      before = whole();
    double            change = 0.0;
    std::size_t       collapses = 0;
    const auto        edges = energy.Edges();
    std::vector<char> touched(complex.Points().size(), 0);
    for (const auto & [v, w] : edges)
    {
      std::vector<TetraComplex::SurfaceFace> faces;
      std::vector<TriangleIds>               removed, added;
      std::vector<IdType>                    cells;
      complex.SurfaceStar(v, faces);
      bool near = complex.Dimension(v) != 2 || touched[v];
      for (const auto & face : faces)
      {
        near = near || touched[face.a] || touched[face.b];
        removed.push_back({ v, face.a, face.b });
        if (face.a != w && face.b != w)
        {
          added.push_back({ w, face.a, face.b });
        }
      }
      if (near)
      {
        continue;
      }
      const auto   patch = energy.At(removed);
      const double less = energy.Change(patch, added);
      if (!patch.samples.empty() && less < 0 && repair.TryCollapse(v, w, 1.0, cells))
      {
        energy.Replace(patch, added);
        change += less;
        ++collapses;
        for (const auto & face : faces)
        {
          touched[face.a] = touched[face.b] = 1;
        }
      }
    }
    EXPECT_GT(collapses, 0u) << seed;
    // Points of contours that find a triangle still nearer than those that came make it a little less.
    EXPECT_NEAR(whole() - before, change, 0.1 * std::abs(change)) << seed;
    EXPECT_EQ(energy.At({}).energy, 0.0);
  }
}

TEST(CollapseSharpEdges, TakesOutPitsThatContoursKnowNot)
{
  const ContourShape shape(*test::RodContours(Radius, Inner));
  for (unsigned int seed = 1; seed <= 5; ++seed)
  {
    const MeshArrays     mesh = PittedRod(12, seed);
    TetraComplex         complex(mesh);
    PointMover           mover(complex);
    MeshRepair           repair(complex, mover, 10.0);
    const ContourSamples contours(complex, shape);
    const SurfaceBending bending(complex, 0.1);
    SurfaceEnergy        energy(complex, contours, bending);
    SharpEdgeParameters  parameters;
    parameters.cosineFloor = std::cos(Floor);
    const double      sharp = LargestTurn(energy), turn = test::MeanTurn(complex);
    const std::size_t count = CollapseSharpEdges(complex, mover, repair, energy, parameters);
    EXPECT_GT(sharp, parameters.angle) << seed;
    EXPECT_GT(count, 0u) << seed;
    EXPECT_LT(test::MeanTurn(complex), 0.8 * turn) << seed;
    std::vector<IdType> pointId, cellSlot;
    const auto          validation = ValidateMesh(complex.Compact(mesh, pointId, cellSlot));
    EXPECT_TRUE(validation.IsValid()) << seed << ' ' << validation.Summary();
  }
}

TEST(CollapseSharpEdges, LeavesWhatContoursAskForAndWhatIsNotSharp)
{
  const ContourShape shape(*test::RodContours(Radius, Inner));
  for (const bool sharp : { false, true })
  {
    // A smooth rod; and a pitted one, no edge of which turns by as much as is asked.
    TetraComplex         complex(sharp ? PittedRod(12, 1) : PittedRod(1u << 31, 1));
    PointMover           mover(complex);
    MeshRepair           repair(complex, mover, 10.0);
    const ContourSamples contours(complex, shape);
    const SurfaceBending bending(complex, 0.1);
    SurfaceEnergy        energy(complex, contours, bending);
    SharpEdgeParameters  parameters;
    parameters.angle = sharp ? 3.14 : 0.7;
    EXPECT_EQ(CollapseSharpEdges(complex, mover, repair, energy, parameters), 0u);
  }
}

TEST(CollapseSharpEdges, IsPartOfTheQualityStageWhereContoursAreGiven)
{
  const auto mesh = DensityMesh<double>::New();
  mesh->SetArrays(PittedRod(12, 2));
  for (const bool with : { false, true })
  {
    auto filter = MeshQualityFilter<DensityMesh<double>>::New();
    filter->SetInput(mesh);
    filter->SetRounds(0);
    filter->SetIterations(0);
    filter->SetContours(with ? test::RodContours(Radius, Inner).GetPointer() : nullptr);
    filter->Update();
    EXPECT_EQ(filter->GetReport().sharpEdges > 0, with);
    const auto validation = ValidateMesh(filter->GetOutput()->GetArrays());
    EXPECT_TRUE(validation.IsValid()) << validation.Summary();
  }
}
} // namespace SharpEdgesTests
