/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneContourTilingMeshSource.h"

#include "boneEllipseStack.h"
#include "boneMeshValidator.h"
#include "boneRandomStack.h"
#include "boneSlabTopology.h"
#include "boneStackTopology.h"
#include "boneSurfaceAudit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace BranchingTests
{
using bone::BranchingKind;
using bone::Loop;
using bone::MeshArrays;
using Slices = std::vector<std::vector<Loop>>;

struct Tiled
{
  MeshArrays         mesh;
  bone::TilingReport report;
};

Tiled
Tile(const bone::ContourStack & stack, BranchingKind branching)
{
  auto source = bone::ContourTilingMeshSource<>::New();
  source->SetInput(&stack);
  source->SetBranching(branching);
  source->Update();
  return { source->GetOutput()->GetArrays(), source->GetReport() };
}

/** Expects a valid mesh whose layers have the stack's topology. */
void
ExpectAsStack(const Tiled & tiled, const bone::ContourStack & stack, const std::string & name, double pixel = 0.2)
{
  const auto validation = bone::ValidateMesh(tiled.mesh);
  EXPECT_TRUE(validation.IsValid()) << name << ": " << validation.Summary();
  for (int region = 1; region <= 3; ++region)
  {
    EXPECT_EQ(bone::PinchedPoints(tiled.mesh, region), 0) << name << ", region " << region;
    EXPECT_THAT(bone::FindSlabsOfOtherTopology(tiled.mesh, stack, tiled.report.correspondence, region, pixel),
                testing::IsEmpty())
      << name << ", region " << region;
  }
}

/** An oval below, its two halves as far apart as `gap` above; with an inner layer. */
Slices
TwoBranches(double gap, bool layered)
{
  Slices slices(3, { { { 0, 0 }, 20, 9, 0, 1 } });
  slices.insert(slices.end(), 3, { { { -10 - gap, 0 }, 9, 9, 0, 1 }, { { 10 + gap, 0 }, 9, 9, 0, 1 } });
  for (auto & slice : slices)
  {
    const std::vector<Loop> outer = slice;
    for (const Loop & loop : outer)
    {
      if (layered)
      {
        slice.push_back({ loop.centre, loop.rx - 3, loop.ry - 3, 1, 2 });
      }
    }
  }
  return slices;
}

/** A round piece below, `count` round ones about its centre above. */
Slices
Radial(int count)
{
  Slices            slices(3, { { { 0, 0 }, 20, 20, 0, 1 } });
  std::vector<Loop> above;
  for (int i = 0; i < count; ++i)
  {
    const double t = 0.3 + 2 * bone::Pi * i / count, radius = 8.5 * std::sin(bone::Pi / count);
    above.push_back({ { 11 * std::cos(t), 11 * std::sin(t) }, radius, radius, 0, 1 });
  }
  slices.insert(slices.end(), 3, above);
  return slices;
}

Slices
UpsideDown(Slices slices)
{
  std::reverse(slices.begin(), slices.end());
  return slices;
}

TEST(Branching, SplitsOneContourIntoTwo)
{
  const Slices plain = TwoBranches(1.0, false), layered = TwoBranches(1.0, true);
  for (const Slices & slices : { plain, layered, UpsideDown(layered) })
  {
    const auto  stack = bone::MakeStack(slices, 3.0);
    const Tiled tiled = Tile(*stack, BranchingKind::Splitting);
    ExpectAsStack(tiled, *stack, "two branches");
    EXPECT_EQ(tiled.report.branchings, 1);
    EXPECT_EQ(tiled.report.splitBranchings, 1);
    EXPECT_EQ(tiled.report.filledBranchings, 0);
    EXPECT_EQ(tiled.report.filledSlabs, 0);
    for (int region = 1; region <= (slices[0].size() > 1 ? 2 : 1); ++region)
    {
      EXPECT_EQ(bone::TopologyOfMesh(tiled.mesh, region), (bone::BodyTopology{ 1, 0, 0 })) << "region " << region;
    }
  }
}

TEST(Branching, SplitsOneContourIntoSeveral)
{
  for (int count = 3; count <= 5; ++count)
  {
    const auto  stack = bone::MakeStack(Radial(count), 3.0, 36);
    const Tiled tiled = Tile(*stack, BranchingKind::Splitting);
    ExpectAsStack(tiled, *stack, std::to_string(count) + " branches");
    EXPECT_EQ(tiled.report.splitBranchings, count == 3 ? 1 : 0) << count; // what bends too much is filled
    EXPECT_EQ(bone::TopologyOfMesh(tiled.mesh, 1), (bone::BodyTopology{ 1, 0, 0 })) << count;
  }
}

TEST(Branching, ACutRunsThroughTheMiddleOfTheSlice)
{
  // The walls above the cut go down to the one piece's own slice between the two, where bridges leave bone.
  const auto stack = bone::MakeStack(TwoBranches(1.0, false), 3.0);
  const auto between = [&stack](BranchingKind branching) {
    const MeshArrays mesh = Tile(*stack, branching).mesh;
    bool             cut = false;
    for (const auto & face : bone::BoundaryFaces(mesh, 1))
    {
      for (const bone::IdType v : face)
      {
        cut = cut || (mesh.points[v].z() == 6.0 && std::hypot(mesh.points[v].x(), mesh.points[v].y()) < 3.0);
      }
    }
    return cut;
  };
  EXPECT_TRUE(between(BranchingKind::Splitting));
  EXPECT_FALSE(between(BranchingKind::Composite));
  EXPECT_FALSE(between(BranchingKind::Filling));
}

TEST(Branching, ACircleEndsInAFilledSlab)
{
  // Vertices lie on a diagonal of the box around the circle, but for rounding.
  for (const int points : { 40, 48, 56 })
  {
    const bone::Vector2     middle(0, 0);
    const std::vector<Loop> wide{ { middle, 20, 20, 1, 1 }, { middle, 17, 17, 2, 2 } };
    std::vector<Loop>       tips;
    for (const double x : { -12.0, 12.0 })
    {
      tips.push_back({ { x, 0 }, 6, 10, 1, 1 });
      tips.push_back({ { x, 0 }, 4, 8, 2, 2 });
    }
    for (const Slices & slices : { Slices{ tips, wide }, Slices{ wide, tips }, Slices{ wide, tips, wide } })
    {
      const auto stack = bone::MakeStack(slices, 3.0, points);
      ExpectAsStack(Tile(*stack, BranchingKind::Composite), *stack, std::to_string(points) + " points");
    }
  }
}

TEST(Branching, CompositeIsTheDefaultAndTheKindsDiffer)
{
  const auto stack = bone::MakeStack(TwoBranches(3.0, false), 3.0, 36);
  auto       source = bone::ContourTilingMeshSource<>::New();
  source->SetInput(stack);
  source->Update();
  const auto & plain = source->GetOutput()->GetArrays();
  const Tiled  composite = Tile(*stack, BranchingKind::Composite), splitting = Tile(*stack, BranchingKind::Splitting),
              filling = Tile(*stack, BranchingKind::Filling);
  EXPECT_EQ(plain.tetrahedra, composite.mesh.tetrahedra);
  EXPECT_EQ(plain.points, composite.mesh.points);
  EXPECT_NE(composite.mesh.tetrahedra, splitting.mesh.tetrahedra);
  EXPECT_NE(composite.mesh.tetrahedra, filling.mesh.tetrahedra);
  EXPECT_NE(splitting.mesh.tetrahedra, filling.mesh.tetrahedra);
  const auto counts = [](const Tiled & tiled) {
    return std::vector<int>{
      tiled.report.branchings, tiled.report.splitBranchings, tiled.report.filledBranchings, tiled.report.splitFillings
    };
  };
  EXPECT_EQ(counts(composite), (std::vector<int>{ 1, 0, 0, 0 }));
  EXPECT_EQ(counts(splitting), (std::vector<int>{ 1, 1, 0, 0 }));
  EXPECT_EQ(counts(filling), (std::vector<int>{ 1, 0, 1, 0 }));
  for (const Tiled * tiled : { &composite, &splitting, &filling })
  {
    ExpectAsStack(*tiled, *stack, "three kinds");
  }
}

TEST(Branching, WhatIsSplitInAFilledSlabHasAValleyAboveTheCut)
{
  // Five pieces bend too much to be knitted. Split, the bone between them is lower, and no less of it on the slice.
  const auto  stack = bone::MakeStack(Radial(5), 3.0, 36);
  const Tiled splitting = Tile(*stack, BranchingKind::Splitting), filling = Tile(*stack, BranchingKind::Filling);
  ASSERT_EQ(splitting.report.filledBranchings, 1);
  EXPECT_EQ(splitting.report.splitFillings, 1);
  EXPECT_EQ(filling.report.splitFillings, 0);
  const auto between = [](const MeshArrays & mesh) {
    double height = 0.0; // the largest of the boundary about the centre
    for (const auto & face : bone::BoundaryFaces(mesh, 1))
    {
      for (const bone::IdType v : face)
      {
        const bool central = std::hypot(mesh.points[v].x(), mesh.points[v].y()) < 4.0;
        height = central && mesh.points[v].z() < 9.0 ? std::max(height, mesh.points[v].z()) : height;
      }
    }
    return height;
  };
  EXPECT_GT(between(splitting.mesh), 6.0);
  EXPECT_LT(between(splitting.mesh), between(filling.mesh) - 0.3);
  for (const Tiled * tiled : { &splitting, &filling })
  {
    ExpectAsStack(*tiled, *stack, "five");
  }
}

TEST(Branching, SeveralAgainstSeveralAreFilled)
{
  const std::vector<Loop> below = { { { 0, 0 }, 16, 8, 0, 1 }, { { 24, 0 }, 4, 4, 0, 1 } };
  const std::vector<Loop> above = { { { 8, 0 }, 20, 8, 0, 1 }, { { -15, 0 }, 2.5, 2.5, 0, 1 } };
  const auto              stack = bone::MakeStack({ below, below, above, above }, 2.0);
  const Tiled             tiled = Tile(*stack, BranchingKind::Splitting);
  ExpectAsStack(tiled, *stack, "several");
  EXPECT_EQ(tiled.report.splitBranchings, 0);
  EXPECT_EQ(tiled.report.splitFillings, 0);
  EXPECT_EQ(tiled.report.filledBranchings, 1);
}

TEST(Branching, WhatEndsOnItsOwnSliceIsNotKnittedInParts)
{
  // Flat cut or closed by a ridge, the one piece has nothing beyond the cut that would hold the parts together.
  Slices slices = TwoBranches(1.0, true);
  slices.erase(slices.begin(), slices.begin() + 2);
  for (const bool open : { false, true })
  {
    const auto stack = bone::MakeStack(slices, 3.0);
    stack->SetOpenStart(open);
    const Tiled tiled = Tile(*stack, BranchingKind::Splitting);
    ExpectAsStack(tiled, *stack, open ? "open" : "closed");
    EXPECT_EQ(tiled.report.splitBranchings, 0);
    EXPECT_EQ(tiled.report.filledBranchings, 1);
  }
}

TEST(Branching, CutsFromBothSidesOfASliceKeepApart)
{
  // Two pieces, one, two again: along x below and along x or y above.
  for (const bool across : { false, true })
  {
    const std::vector<Loop> below = { { { -11, 0 }, 9, 9, 0, 1 }, { { 11, 0 }, 9, 9, 0, 1 } };
    const std::vector<Loop> above = { { { 0, -11 }, 9, 9, 0, 1 }, { { 0, 11 }, 9, 9, 0, 1 } };
    const std::vector<Loop> one = { { { 0, 0 }, 20, 20, 0, 1 } };
    const auto  stack = bone::MakeStack({ below, below, one, across ? above : below, across ? above : below }, 3.0, 36);
    const Tiled tiled = Tile(*stack, BranchingKind::Splitting);
    ExpectAsStack(tiled, *stack, across ? "across" : "along");
    EXPECT_EQ(tiled.report.branchings, 2);
    EXPECT_GE(tiled.report.splitBranchings, 1);
  }
}

TEST(Branching, RandomBodiesAreValid)
{
  for (unsigned seed : { 9U, 11U })
  {
    const auto  stack = bone::RandomStack(seed).Make();
    const Tiled tiled = Tile(*stack, BranchingKind::Splitting);
    ExpectAsStack(tiled, *stack, "seed " + std::to_string(seed), 0.1);
    EXPECT_GT(tiled.report.branchings, 0) << seed;
  }
}

TEST(Branching, RefusesAValueThatIsNone)
{
  auto source = bone::ContourTilingMeshSource<>::New();
  source->SetInput(bone::MakeStack(TwoBranches(1.0, false), 3.0));
  source->SetBranching(static_cast<BranchingKind>(7));
  EXPECT_THROW(source->Update(), itk::ExceptionObject);
}
} // namespace BranchingTests
