/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCutIntegrals.h"

#include "boneCellPiece.h"
#include "boneDensityEvaluation.h"
#include "boneDensityTestMeshes.h"
#include "boneTestBodies.h"
#include "boneTetraLocator.h"

#include <itkMultiThreaderBase.h>

#include <gtest/gtest.h>

#include <numeric>

namespace CutIntegralsTests
{
using namespace bone;

double
Wave(const Vector3 & x)
{
  return 300.0 + 8.0 * x.x() - 5.0 * x.y() + 3.0 * x.z() + 40.0 * std::sin(0.3 * x.x() + 0.2 * x.z());
}

/** A layered rod with a density of the given degree. */
MeshArrays
WavyTube(int degree)
{
  MeshArrays mesh = test::MakeTube({});
  test::SetDensity(mesh, degree, Wave);
  return mesh;
}

/** A block 24 mm wide about the origin. */
MeshArrays
Block(int degree, const std::function<double(const Vector3 &)> & density)
{
  MeshArrays mesh = test::MakeBlock({ 6, 6, 6 }, Vector3::Constant(-12.0), 4.0, 0.15);
  test::SetDensity(mesh, degree, density);
  return mesh;
}

/** Coefficients of degree 2 of x^2 are the blossom's values, products of coordinates. */
MeshArrays
SquareBlock()
{
  MeshArrays mesh = Block(2, [](const Vector3 &) { return 0.0; });
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
  {
    std::vector<double> x;
    for (const IdType id : mesh.tetrahedra[t])
    {
      x.push_back(mesh.points[id].x());
    }
    for (int i = 0; i < BernsteinCount(2); ++i)
    {
      std::vector<double> factors;
      for (int v = 0; v < 4; ++v)
      {
        factors.insert(factors.end(), BernsteinExponents(2)[i][v], x[v]);
      }
      mesh.coefficients[t * BernsteinCount(2) + i] = factors[0] * factors[1];
    }
  }
  return mesh;
}

TEST(CutIntegrals, SimplexMeansOfTheWholeAndOfHalvesAreThoseOfTheCoefficients)
{
  std::mt19937                           random(3);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (int degree = 0; degree <= MaximumBernsteinDegree; ++degree)
  {
    std::vector<double> c(BernsteinCount(degree));
    std::generate(c.begin(), c.end(), [&] { return uniform(random); });
    const CellPiece whole = WholeCell();
    const double    mean = std::accumulate(c.begin(), c.end(), 0.0) / static_cast<double>(c.size());
    EXPECT_NEAR(SimplexMean(degree, c.data(), whole.data(), 4), mean, 1e-14);
    CellPiece left = whole, right = whole;
    left[0] = right[2] = 0.3 * whole[0] + 0.7 * whole[2];
    EXPECT_NEAR(PieceShare(left), 0.3, 1e-14);
    EXPECT_NEAR(0.3 * SimplexMean(degree, c.data(), left.data(), 4) +
                  0.7 * SimplexMean(degree, c.data(), right.data(), 4),
                mean,
                1e-14);
    // On a segment: the integral that rays use.
    EXPECT_NEAR(SimplexMean(degree, c.data(), left.data(), 2),
                BernsteinSegmentIntegral(degree, c.data(), left[0], left[1], 1.0),
                1e-13);
  }
}

TEST(CutIntegrals, TheShareThatIsKeptIsThatOfThePieces)
{
  std::mt19937                           random(5);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (int trial = 0; trial < 200; ++trial)
  {
    const Eigen::Vector4d  values(uniform(random), uniform(random), uniform(random), trial % 9 ? uniform(random) : 0.0);
    std::vector<CellPiece> kept, rest;
    KeepNotNegative(WholeCell(), values, kept);
    KeepNotNegative(WholeCell(), -values, rest);
    const auto share = [](const std::vector<CellPiece> & pieces) {
      return std::accumulate(
        pieces.begin(), pieces.end(), 0.0, [](double sum, const CellPiece & piece) { return sum + PieceShare(piece); });
    };
    EXPECT_NEAR(share(kept), ShareNotNegative(values), 1e-14);
    EXPECT_NEAR(share(kept) + share(rest), 1.0, 1e-14);
  }
}

TEST(CutIntegrals, AllOfSpaceHoldsTheRegionsAsTheyAre)
{
  const MeshArrays mesh = WavyTube(3);
  const auto       regions = MeasureRegions(mesh);
  const auto       found = IntegrateSolid(mesh, Solid());
  ASSERT_EQ(found.regions.size(), regions.size());
  double mass = 0.0;
  for (std::size_t i = 0; i < regions.size(); ++i)
  {
    EXPECT_EQ(found.regions[i].region, regions[i].region);
    EXPECT_NEAR(found.regions[i].volume, regions[i].volume, 1e-9 * regions[i].volume);
    EXPECT_NEAR(found.regions[i].mass, regions[i].mass, 1e-9 * regions[i].mass);
    EXPECT_NEAR(found.regions[i].mean, regions[i].mean, 1e-9 * regions[i].mean);
    EXPECT_EQ(found.regions[i].volumeError, 0.0);
    mass += regions[i].mass;
  }
  EXPECT_NEAR(found.total.mass, mass, 1e-9 * mass);
}

TEST(CutIntegrals, TheTwoSidesOfAPlaneAddUpToTheWhole)
{
  for (const int degree : { 0, 1, 3, 8 })
  {
    const MeshArrays mesh = WavyTube(degree);
    const auto       whole = IntegrateSolid(mesh, Solid());
    std::mt19937     random(7);
    for (int trial = 0; trial < (degree > 3 ? 2 : 6); ++trial)
    {
      std::normal_distribution<double> normal;
      const Vector3                    direction(normal(random), normal(random), normal(random));
      const Vector3                    point(1.5 * normal(random), 1.5 * normal(random), 11.0 + normal(random));
      const auto                       above = IntegrateSolid(mesh, MakeHalfSpace(point, direction));
      const auto                       below = IntegrateSolid(mesh, MakeHalfSpace(point, -direction));
      EXPECT_GT(above.total.volume, 0.0);
      EXPECT_GT(below.total.volume, 0.0);
      for (std::size_t i = 0; i < whole.regions.size(); ++i)
      {
        EXPECT_NEAR((above.regions[i].volume + below.regions[i].volume) / whole.regions[i].volume, 1.0, 1e-12);
        EXPECT_NEAR((above.regions[i].mass + below.regions[i].mass) / whole.regions[i].mass, 1.0, 1e-12);
      }
    }
  }
}

TEST(CutIntegrals, APlaneThroughVerticesCutsAsOneBesideThem)
{
  const MeshArrays mesh = Block(1, Wave);
  const auto       through = IntegrateSolid(mesh, MakeHalfSpace(Vector3::Zero(), Vector3::UnitX()));
  EXPECT_NEAR(through.total.volume, 24.0 * 24.0 * 12.0, 1e-9);
  const auto face = IntegrateSolid(mesh, MakeHalfSpace(Vector3(12, 0, 0), Vector3::UnitX()));
  EXPECT_NEAR(face.total.volume, 0.0, 1e-9);
  EXPECT_FALSE(std::isnan(face.total.volume));
}

TEST(CutIntegrals, ASquareDensityInABoxOfPlanesHasItsClosedForm)
{
  const MeshArrays mesh = SquareBlock();
  Solid            box;
  for (int axis = 0; axis < 3; ++axis)
  {
    box.halfSpaces.push_back({ Vector3::Unit(axis) * -3.3, Vector3::Unit(axis) });
    box.halfSpaces.push_back({ Vector3::Unit(axis) * 5.1, -Vector3::Unit(axis) });
  }
  const auto   found = IntegrateSolid(mesh, box);
  const double side = 8.4;
  EXPECT_NEAR(found.total.volume, side * side * side, 1e-9);
  const double mass = side * side * (std::pow(5.1, 3) + std::pow(3.3, 3)) / 3.0;
  EXPECT_NEAR(found.total.mass, mass, 1e-10 * mass);
  EXPECT_NEAR(found.total.mean, mass / (side * side * side), 1e-10 * mass);
}

/** The figure must be within its stated error, and the stated error as small as was asked for. */
void
ExpectWithin(const PartDensity & part, double volume, double mass, double relativeError)
{
  EXPECT_LE(std::abs(part.volume - volume), part.volumeError + 1e-9 * volume);
  EXPECT_LE(std::abs(part.mass - mass), part.massError + 1e-9 * std::abs(mass));
  EXPECT_LE(part.volumeError, relativeError * volume);
  EXPECT_LE(part.massError, 1.5 * relativeError * std::abs(mass)); // by the tetrahedra's means
  EXPECT_GT(part.massError, 0.0);
}

TEST(CutIntegrals, RoundSolidsHaveTheirClosedFormsWithinTheStatedError)
{
  const MeshArrays squares = SquareBlock();
  const double     pi = std::acos(-1.0), r = 5.0;
  const double     ball = 4.0 / 3.0 * pi * r * r * r;
  const Vector3    c(1.3, -0.4, 0.7);
  for (const double relativeError : { 0.1, 1e-2, 2e-3 })
  {
    // Mean square of x about the centre of a ball: r^2 / 5; of a cylinder across its axis: r^2 / 4.
    const double square = c.x() * c.x();
    ExpectWithin(IntegrateSolid(squares, bone::MakeBall(c, r), relativeError).total,
                 ball,
                 ball * (square + r * r / 5.0),
                 relativeError);
    const Vector3 along(0, 3.0, 4.0);
    const double  cylinder = pi * r * r * 5.0;
    ExpectWithin(IntegrateSolid(squares, MakeCylinder(c - 0.5 * along, c + 0.5 * along, r), relativeError).total,
                 cylinder,
                 cylinder * (square + r * r / 4.0),
                 relativeError);
    ExpectWithin(IntegrateSolid(squares, MakeCapsule(c - 0.5 * along, c + 0.5 * along, r), relativeError).total,
                 cylinder + ball,
                 cylinder * (square + r * r / 4.0) + ball * (square + r * r / 5.0),
                 relativeError);
    Solid cap = bone::MakeBall(c, r);
    cap.halfSpaces.push_back({ c + Vector3(0, 0, 2.0), Vector3::UnitZ() });
    const double height = r - 2.0;
    EXPECT_NEAR(IntegrateSolid(squares, cap, relativeError).total.volume / (pi * height * height * (r - height / 3.0)),
                1.0,
                relativeError);
  }
}

TEST(CutIntegrals, ABallWithinOneTetrahedronIsFound)
{
  MeshArrays mesh;
  mesh.points = { Vector3(0, 0, 0), Vector3(60, 0, 0), Vector3(0, 60, 0), Vector3(0, 0, 60) };
  mesh.tetrahedra = { { 0, 1, 2, 3 } };
  const auto found = IntegrateSolid(mesh, bone::MakeBall(Vector3(12, 11, 10), 2.0), 1e-3);
  EXPECT_NEAR(found.total.volume, 32.0 / 3.0 * std::acos(-1.0), found.total.volumeError);
  EXPECT_LE(found.total.volumeError, 1e-3 * found.total.volume);
  EXPECT_TRUE(std::isnan(found.total.mass)); // the mesh holds no density
  ASSERT_EQ(found.regions.size(), 1u);
  EXPECT_EQ(found.regions[0].region, 0);
}

TEST(CutIntegrals, ACapsuleThatLeavesTheBodyHoldsWhatCountingFinds)
{
  const MeshArrays    mesh = WavyTube(3);
  const Vector3       from(-16, 2, 6), to(10, -3, 15);
  const auto          found = IntegrateSolid(mesh, MakeCapsule(from, to, 4.0), 2e-3);
  const Capsule       capsule{ from, to, 4.0 };
  const TetraLocator  locator(mesh);
  const double        step = 0.25;
  std::vector<double> volume(4), mass(4);
  IdType              hint = -1;
  for (double z = -2.0; z < 24.0; z += step)
  {
    for (double y = -16.0; y < 16.0; y += step)
    {
      for (double x = -21.0; x < 21.0; x += step)
      {
        const Vector3 at(x + 0.5 * step, y + 0.5 * step, z + 0.5 * step);
        const auto    place = capsule.Distance(at) <= 0.0 ? locator.Find(at, hint) : CellLocation();
        if (place.Found())
        {
          hint = place.cell;
          volume[mesh.region[place.cell]] += step * step * step;
          mass[mesh.region[place.cell]] += step * step * step * DensityAt(mesh, place);
        }
      }
    }
  }
  for (const PartDensity & part : found.regions)
  {
    EXPECT_NEAR(part.volume, volume[part.region], 6e-3 * volume[part.region]) << part.region;
    EXPECT_NEAR(part.mass, mass[part.region], 6e-3 * mass[part.region]) << part.region;
    EXPECT_GT(part.volume, 10.0);
  }
}

TEST(CutIntegrals, DoesNotDependOnPose)
{
  const MeshArrays mesh = WavyTube(2);
  MeshArrays       moved = mesh;
  const auto       turn = Eigen::AngleAxisd(1.1, Vector3(1, 2, 3).normalized());
  const Vector3    shift(100, -50, 30);
  for (Vector3 & p : moved.points)
  {
    p = turn * p + shift;
  }
  const Vector3 a(2, 1, 4), b(-3, 5, 19);
  const auto    at = [&](const Vector3 & x) { return Vector3(turn * x + shift); };
  const auto    plane = IntegrateSolid(mesh, MakeHalfSpace(a, b)).total;
  EXPECT_NEAR(IntegrateSolid(moved, MakeHalfSpace(at(a), turn * b)).total.mass, plane.mass, 1e-9 * plane.mass);
  const auto capsule = IntegrateSolid(mesh, MakeCapsule(a, b, 3.0), 0.01).total;
  EXPECT_NEAR(
    IntegrateSolid(moved, MakeCapsule(at(a), at(b), 3.0), 0.01).total.mass, capsule.mass, 2.0 * capsule.massError);
}

TEST(CutIntegrals, DoesNotDependOnTheNumberOfThreads)
{
  const MeshArrays mesh = WavyTube(2);
  const auto       solid = MakeCylinder(Vector3(0, 0, 4), Vector3(4, 3, 18), 6.0);
  const auto       before = itk::MultiThreaderBase::GetGlobalDefaultNumberOfThreads();
  itk::MultiThreaderBase::SetGlobalDefaultNumberOfThreads(1);
  const auto one = IntegrateSolid(mesh, solid, 0.01);
  itk::MultiThreaderBase::SetGlobalDefaultNumberOfThreads(4);
  const auto four = IntegrateSolid(mesh, solid, 0.01);
  itk::MultiThreaderBase::SetGlobalDefaultNumberOfThreads(before);
  EXPECT_EQ(one.total.mass, four.total.mass);
  EXPECT_EQ(one.total.volumeError, four.total.volumeError);
}

TEST(CutIntegrals, ASolidBesideTheBodyHoldsNothing)
{
  const auto found = IntegrateSolid(WavyTube(1), bone::MakeBall(Vector3(100, 0, 0), 5.0));
  EXPECT_EQ(found.total.volume, 0.0);
  EXPECT_EQ(found.total.mass, 0.0);
  EXPECT_TRUE(std::isnan(found.total.mean));
  EXPECT_EQ(found.regions.size(), 3u);
}

TEST(CutIntegrals, StatesTheErrorThatIsLeftWhereTooManyPiecesWouldBeNeeded)
{
  const MeshArrays mesh = SquareBlock();
  const auto       found = IntegrateSolid(mesh, bone::MakeBall(Vector3::Zero(), 8.0), 1e-9, {}, 5000);
  const double     volume = 4.0 / 3.0 * std::acos(-1.0) * 512.0;
  EXPECT_GT(found.total.volumeError, 1e-9 * volume);
  EXPECT_NEAR(found.total.volume, volume, found.total.volumeError);
}

TEST(CutIntegrals, RefusesWhatIsNoSolid)
{
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(MakeHalfSpace(Vector3::Zero(), Vector3::Zero()), std::invalid_argument);
  EXPECT_THROW(MakeHalfSpace(Vector3(nan, 0, 0), Vector3::UnitX()), std::invalid_argument);
  EXPECT_THROW(bone::MakeBall(Vector3::Zero(), 0.0), std::invalid_argument);
  EXPECT_THROW(bone::MakeBall(Vector3::Zero(), nan), std::invalid_argument);
  EXPECT_THROW(MakeCylinder(Vector3::UnitX(), Vector3::UnitX(), 1.0), std::invalid_argument);
  EXPECT_THROW(IntegrateSolid(WavyTube(1), Solid(), 0.0), std::invalid_argument);
}
} // namespace CutIntegralsTests
