/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneFiniteElementModel.h"

#include "boneBernstein.h"
#include "boneDensityEvaluation.h"
#include "boneTestBodies.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>
#include <set>

namespace FiniteElementModelTests
{
using namespace bone;
using testing::HasSubstr;

/** E = factor rho ^ exponent. */
ElasticityLaw
PowerLaw(double factor, double exponent)
{
  ElasticityLaw law;
  law.name = "power";
  law.low = 0.1;
  law.high = 0.9;
  law.pieces = { { 0.0, factor, exponent, 0.0 } };
  return law;
}

double
Wave(const Vector3 & x)
{
  return 0.5 + 0.02 * x.x() - 0.01 * x.y() + 0.1 * std::sin(0.3 * x.z());
}

MeshArrays
Rod(int degree, const std::function<double(const Vector3 &)> & density)
{
  MeshArrays mesh = test::MakeTube({});
  test::SetDensity(mesh, degree, density);
  mesh.quantity = DensityQuantity::ApparentGramPerCubicCentimetre;
  return mesh;
}

double
VolumeOf(const MeshArrays & mesh, std::size_t t)
{
  const auto x = [&](int i) { return mesh.points[static_cast<std::size_t>(mesh.tetrahedra[t][i])]; };
  return SignedVolume(x(0), x(1), x(2), x(3));
}

const FiniteElementSet &
SetOf(const std::vector<FiniteElementSet> & sets, const std::string & name)
{
  for (const FiniteElementSet & set : sets)
  {
    if (set.name == name)
    {
      return set;
    }
  }
  throw std::out_of_range(name);
}

std::set<std::string>
NamesOf(const std::vector<FiniteElementSet> & sets)
{
  std::set<std::string> names;
  for (const FiniteElementSet & set : sets)
  {
    names.insert(set.name);
  }
  return names;
}

template <typename TCall>
std::string
ErrorOf(TCall && call)
{
  try
  {
    call();
  }
  catch (const std::invalid_argument & error)
  {
    return error.what();
  }
  return "";
}

TEST(FiniteElementModel, NodesOnEdgesLieBetweenTheirCornersAndAreShared)
{
  const MeshArrays                            mesh = Rod(2, Wave);
  const auto                                  model = MakeFiniteElements(mesh, PowerLaw(1000.0, 1.0));
  constexpr std::array<std::array<int, 2>, 6> ends = { { { 0, 1 }, { 1, 2 }, { 2, 0 }, { 0, 3 }, { 1, 3 }, { 2, 3 } } };
  std::set<std::pair<IdType, IdType>>         edges;
  std::set<IdType>                            used;
  for (std::size_t e = 0; e < model.elements.size(); ++e)
  {
    for (std::size_t i = 0; i < 4; ++i)
    {
      ASSERT_EQ(model.elements[e][i], mesh.tetrahedra[e][i]);
    }
    for (std::size_t i = 0; i < 6; ++i)
    {
      const IdType  a = model.elements[e][static_cast<std::size_t>(ends[i][0])];
      const IdType  b = model.elements[e][static_cast<std::size_t>(ends[i][1])];
      const IdType  middle = model.elements[e][4 + i];
      const Vector3 expected =
        0.5 * (mesh.points[static_cast<std::size_t>(a)] + mesh.points[static_cast<std::size_t>(b)]);
      ASSERT_LT((model.nodes[static_cast<std::size_t>(middle)] - expected).norm(), 1e-12);
      edges.insert(std::minmax(a, b));
      used.insert(middle);
    }
  }
  EXPECT_EQ(model.nodes.size(), mesh.points.size() + edges.size());
  EXPECT_EQ(used.size(), edges.size());

  FiniteElementParameters linear;
  linear.order = 1;
  const auto corners = MakeFiniteElements(mesh, PowerLaw(1000.0, 1.0), linear);
  EXPECT_EQ(corners.nodes.size(), mesh.points.size());
  EXPECT_EQ(corners.NodesEach(), 4);
}

TEST(FiniteElementModel, TheModulusIsTheMeanOfTheLawOverTheElement)
{
  // The law of degree 1 on a polynomial of degree 3, and of degree 2 on one of degree 2: both in closed form.
  const MeshArrays cubic = Rod(3, Wave), quadratic = Rod(2, Wave);
  const auto       linear = MakeFiniteElements(cubic, PowerLaw(1000.0, 1.0));
  const auto       square = MakeFiniteElements(quadratic, PowerLaw(1000.0, 2.0));
  for (std::size_t t = 0; t < cubic.tetrahedra.size(); ++t)
  {
    const double * c = cubic.coefficients.data() + t * 20;
    ASSERT_NEAR(linear.modulus[t], 1000.0 * std::accumulate(c, c + 20, 0.0) / 20.0, 1e-9);
    const double * q = quadratic.coefficients.data() + t * 10;
    ASSERT_NEAR(square.modulus[t], 1000.0 * BernsteinInnerProduct(2, q, 2, q, 1.0), 1e-9);
  }
}

TEST(FiniteElementModel, MassIsTheIntegralOfTheApparentDensity)
{
  MeshArrays mesh = Rod(3, Wave);
  const auto massOf = [&mesh](const FiniteElementModel & model) {
    double mass = 0.0;
    for (std::size_t t = 0; t < model.elements.size(); ++t)
    {
      mass += VolumeOf(mesh, t) * model.massDensity[t];
    }
    return mass;
  };
  double expected = 0.0; // g/cm^3 mm^3
  for (const RegionDensity & region : MeasureRegions(mesh))
  {
    expected += region.mass;
  }
  const double mass = massOf(MakeFiniteElements(mesh, PowerLaw(1000.0, 1.0)));
  EXPECT_NEAR(mass, 1e-9 * expected, 1e-12 * expected * 1e-3);

  // The same numbers as ash density are of a heavier bone: apparent = ash / 0.598.
  mesh.quantity = DensityQuantity::AshGramPerCubicCentimetre;
  EXPECT_NEAR(massOf(MakeFiniteElements(mesh, PowerLaw(1000.0, 1.0))) / mass, 1.0 / 0.598, 1e-9);
}

TEST(FiniteElementModel, ALawOfTheOtherDensityGetsItsOwn)
{
  MeshArrays mesh = Rod(0, [](const Vector3 &) { return 0.5; });
  auto       law = PowerLaw(1000.0, 1.0); // apparent
  EXPECT_NEAR(MakeFiniteElements(mesh, law).modulus[0], 500.0, 1e-9);
  law.density = DensityQuantity::AshGramPerCubicCentimetre;
  EXPECT_NEAR(MakeFiniteElements(mesh, law).modulus[0], 500.0 * 0.598, 1e-9);
  mesh.quantity = DensityQuantity::AshGramPerCubicCentimetre;
  EXPECT_NEAR(MakeFiniteElements(mesh, law).modulus[0], 500.0, 1e-9);
  law.density = DensityQuantity::ApparentGramPerCubicCentimetre;
  EXPECT_NEAR(MakeFiniteElements(mesh, law).modulus[0], 500.0 / 0.598, 1e-9);
  // The law's range is of its own density: 0.5 / 0.598 = 0.836.
  law.high = 0.8;
  EXPECT_NEAR(MakeFiniteElements(mesh, law).shareOutside, 1.0, 1e-12);
  law.high = 0.9;
  EXPECT_EQ(MakeFiniteElements(mesh, law).shareOutside, 0.0);
}

TEST(FiniteElementModel, BinsKeepTheIntegralOfTheModulusAndBoundItsError)
{
  const MeshArrays        mesh = Rod(2, [](const Vector3 & x) { return 0.05 + 0.04 * (x.z() + 1.0); });
  FiniteElementParameters parameters;
  double                  before = 1.0;
  for (const int bins : { 5, 20, 200 })
  {
    parameters.bins = bins;
    const auto model = MakeFiniteElements(mesh, PowerLaw(5000.0, 2.0), parameters);
    ASSERT_LE(model.materials.size(), static_cast<std::size_t>(bins));
    const auto   range = std::minmax_element(model.modulus.begin(), model.modulus.end());
    const double ratio = std::pow(*range.second / *range.first, 1.0 / bins);
    double       exact = 0.0, binned = 0.0, error = 0.0, volume = 0.0;
    for (std::size_t t = 0; t < model.elements.size(); ++t)
    {
      const double modulus = model.materials[static_cast<std::size_t>(model.material[t])].modulus;
      exact += VolumeOf(mesh, t) * model.modulus[t];
      binned += VolumeOf(mesh, t) * modulus;
      error += VolumeOf(mesh, t) * std::abs(modulus / model.modulus[t] - 1.0);
      volume += VolumeOf(mesh, t);
      ASSERT_LE(std::abs(modulus / model.modulus[t] - 1.0), ratio - 1.0 + 1e-9);
    }
    EXPECT_NEAR(binned / exact, 1.0, 1e-9);
    EXPECT_NEAR(model.binErrorMean, error / volume, 1e-12);
    EXPECT_LT(model.binErrorMean, before);
    before = model.binErrorMean;
    for (std::size_t m = 1; m < model.materials.size(); ++m)
    {
      EXPECT_LT(model.materials[m - 1].modulus, model.materials[m].modulus);
    }
  }
}

TEST(FiniteElementModel, OneDensityIsOneMaterial)
{
  const auto model = MakeFiniteElements(Rod(1, [](const Vector3 &) { return 0.5; }), PowerLaw(1000.0, 1.0));
  ASSERT_EQ(model.materials.size(), 1u);
  EXPECT_NEAR(model.materials[0].modulus, 500.0, 1e-9);
  EXPECT_NEAR(model.materials[0].massDensity, 0.5e-9, 1e-18);
  EXPECT_EQ(model.softElements, 0);
}

TEST(FiniteElementModel, SoftElementsAreRaisedAndCounted)
{
  const MeshArrays        mesh = Rod(0, [](const Vector3 & x) { return x.z() < 10.0 ? -0.1 : 0.5; });
  FiniteElementParameters parameters;
  parameters.leastModulus = 20.0;
  const auto  model = MakeFiniteElements(mesh, PowerLaw(1000.0, 1.0), parameters);
  std::size_t soft = 0;
  for (std::size_t t = 0; t < model.elements.size(); ++t)
  {
    const bool isSoft = mesh.coefficients[t] < 0.0;
    soft += isSoft ? 1 : 0;
    EXPECT_NEAR(model.modulus[t], isSoft ? 20.0 : 500.0, 1e-9);
    EXPECT_GT(model.massDensity[t], 0.0);
  }
  EXPECT_GT(soft, 0u);
  EXPECT_EQ(static_cast<std::size_t>(model.softElements), soft);
  EXPECT_EQ(*std::min_element(model.nodeModulus.begin(), model.nodeModulus.end()), 20.0);
}

TEST(FiniteElementModel, NodesHaveTheModulusOfALinearDensityThere)
{
  const auto       density = [](const Vector3 & x) { return 0.5 + 0.01 * x.x() + 0.005 * x.z(); };
  const MeshArrays mesh = Rod(1, density);
  const auto       model = MakeFiniteElements(mesh, PowerLaw(1000.0, 1.5));
  for (std::size_t n = 0; n < model.nodes.size(); ++n)
  {
    ASSERT_NEAR(model.nodeModulus[n], 1000.0 * std::pow(density(model.nodes[n]), 1.5), 1e-6);
  }
}

TEST(FiniteElementModel, TheExteriorIsClosedAndLooksOutward)
{
  const MeshArrays mesh = Rod(1, Wave);
  const auto       model = MakeFiniteElements(mesh, PowerLaw(1000.0, 1.0));
  Vector3          area = Vector3::Zero();
  double           volume = 0.0, expected = 0.0;
  for (const FiniteElementFace & face : model.exterior)
  {
    const auto & element = model.elements[static_cast<std::size_t>(face.element)];
    const auto & corners = FiniteElementFaceCorners[static_cast<std::size_t>(face.opposite)];
    const auto   x = [&](std::size_t i) {
      return model.nodes[static_cast<std::size_t>(element[static_cast<std::size_t>(corners[i])])];
    };
    area += 0.5 * (x(1) - x(0)).cross(x(2) - x(0));
    volume += x(0).dot(x(1).cross(x(2))) / 6.0;
  }
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
  {
    expected += VolumeOf(mesh, t);
  }
  EXPECT_LT(area.norm(), 1e-9);
  EXPECT_NEAR(volume, expected, 1e-6);
}

TEST(FiniteElementModel, SetsAreWhatTheirNamesSay)
{
  const MeshArrays mesh = Rod(1, Wave); // three regions, two flat ends along z
  const auto       model = MakeFiniteElements(mesh, PowerLaw(1000.0, 1.0), {}, { { "Head centre-1", mesh.points[5] } });
  auto             names = NamesOf(model.nodeSets);
  EXPECT_EQ(names,
            (std::set<std::string>{ "BOUNDARY",
                                    "INTERFACE_2",
                                    "INTERFACE_3",
                                    "CUT_1",
                                    "CUT_2",
                                    "END_LOW_X",
                                    "END_HIGH_X",
                                    "END_LOW_Y",
                                    "END_HIGH_Y",
                                    "END_LOW_Z",
                                    "END_HIGH_Z",
                                    "LM_Head_centre_1" }));
  EXPECT_EQ(SetOf(model.nodeSets, "LM_Head_centre_1").ids, std::vector<IdType>{ 5 });

  std::array<std::set<IdType>, 4> nodesOf;
  for (std::size_t t = 0; t < model.elements.size(); ++t)
  {
    nodesOf[static_cast<std::size_t>(mesh.region[t])].insert(model.elements[t].begin(), model.elements[t].end());
  }
  for (const int inner : { 2, 3 })
  {
    std::vector<IdType> shared;
    const auto &        a = nodesOf[static_cast<std::size_t>(inner) - 1];
    const auto &        b = nodesOf[static_cast<std::size_t>(inner)];
    std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(shared));
    EXPECT_EQ(SetOf(model.nodeSets, "INTERFACE_" + std::to_string(inner)).ids, shared);
    const auto & region = SetOf(model.elementSets, "REGION_" + std::to_string(inner)).ids;
    EXPECT_EQ(static_cast<long>(region.size()), std::count(mesh.region.begin(), mesh.region.end(), inner));
  }
  double low = 1e9, high = -1e9;
  for (const Vector3 & x : model.nodes)
  {
    low = std::min(low, x.z());
    high = std::max(high, x.z());
  }
  for (const char * cut : { "CUT_1", "CUT_2" })
  {
    const auto & ids = SetOf(model.nodeSets, cut).ids;
    const double plane = model.nodes[static_cast<std::size_t>(ids.front())].z();
    EXPECT_NEAR(std::min(plane - low, high - plane), 0.0, 1e-9);
    const auto inPlane = std::count_if(
      model.nodes.begin(), model.nodes.end(), [plane](const Vector3 & x) { return std::abs(x.z() - plane) < 1e-9; });
    EXPECT_EQ(static_cast<long>(ids.size()), inPlane);
  }
  const auto within = [&](double from, double to) {
    std::vector<IdType> ids;
    for (std::size_t n = 0; n < model.nodes.size(); ++n)
    {
      if (model.nodes[n].z() >= from && model.nodes[n].z() <= to)
      {
        ids.push_back(static_cast<IdType>(n));
      }
    }
    return ids;
  };
  EXPECT_EQ(SetOf(model.nodeSets, "END_HIGH_Z").ids, within(high - 0.03 * (high - low), high));
  EXPECT_EQ(SetOf(model.nodeSets, "END_LOW_Z").ids, within(low, low + 0.03 * (high - low)));
  std::size_t elements = 0;
  for (const FiniteElementSet & set : model.elementSets)
  {
    elements += set.name.rfind("MAT_", 0) == 0 ? set.ids.size() : 0;
  }
  EXPECT_EQ(elements, model.elements.size());
}

TEST(FiniteElementModel, TheEndSetsGoByAShareOfTheExtent)
{
  // 40 layers: one within 3 % of either end, beside the end itself.
  test::TubeShape shape;
  shape.slices = 41;
  MeshArrays mesh = test::MakeTube(shape);
  test::SetDensity(mesh, 0, [](const Vector3 &) { return 0.5; });
  mesh.quantity = DensityQuantity::ApparentGramPerCubicCentimetre;
  const auto model = MakeFiniteElements(mesh, PowerLaw(1000.0, 1.0));
  EXPECT_GT(SetOf(model.nodeSets, "END_HIGH_Z").ids.size(), SetOf(model.nodeSets, "CUT_1").ids.size());
}

TEST(FiniteElementModel, TheLargestCutIsTheFirst)
{
  for (const double taper : { -0.01, 0.01 })
  {
    MeshArrays mesh = Rod(0, [](const Vector3 &) { return 0.5; });
    for (Vector3 & x : mesh.points)
    {
      x.head<2>() *= 1.0 + taper * x.z();
    }
    const auto model = MakeFiniteElements(mesh, PowerLaw(1000.0, 1.0));
    const auto heightOf = [&](const char * name) {
      return model.nodes[static_cast<std::size_t>(SetOf(model.nodeSets, name).ids.front())].z();
    };
    EXPECT_EQ(heightOf("CUT_1") > heightOf("CUT_2"), taper > 0.0);
  }
}

TEST(FiniteElementModel, SaysWhatShareOfTheVolumeLiesOutsideTheLawsRange)
{
  const MeshArrays mesh = Rod(0, [](const Vector3 & x) { return x.z() < 8.0 ? 0.05 : x.z() > 14.0 ? 0.95 : 0.5; });
  const auto       model = MakeFiniteElements(mesh, PowerLaw(1000.0, 1.0)); // for 0.1 to 0.9
  double           outside = 0.0, volume = 0.0;
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
  {
    outside += mesh.coefficients[t] != 0.5 ? VolumeOf(mesh, t) : 0.0;
    volume += VolumeOf(mesh, t);
  }
  EXPECT_GT(outside, 0.3 * volume);
  EXPECT_LT(outside, 0.9 * volume);
  EXPECT_NEAR(model.shareOutside, outside / volume, 1e-12);
}

TEST(FiniteElementModel, RefusesWhatGivesNoModelAndSaysWhy)
{
  MeshArrays mesh = Rod(1, Wave);
  const auto law = PowerLaw(1000.0, 1.0);
  const auto make = [&](const std::vector<Landmark> & landmarks = {}) {
    return ErrorOf([&] { MakeFiniteElements(mesh, law, {}, landmarks); });
  };
  EXPECT_EQ(make(), "");
  EXPECT_THAT(make({ { "a b", mesh.points[0] }, { "a-b", mesh.points[1] } }), HasSubstr("LM_a_b"));
  EXPECT_THAT(make({ { "Head", mesh.points[0] }, { "head", mesh.points[1] } }), HasSubstr("LM_head"));
  EXPECT_THAT(make({ { "far", Vector3(0, 0, 1e4) } }), HasSubstr("landmark far"));
  mesh.quantity = DensityQuantity::HounsfieldUnit;
  EXPECT_THAT(make(), HasSubstr("is HU: calibrate"));
  mesh.quantity = DensityQuantity::AshGramPerCubicCentimetre;
  std::swap(mesh.tetrahedra[7][0], mesh.tetrahedra[7][1]);
  EXPECT_THAT(make(), HasSubstr("Tetrahedron 7 is inverted"));
  mesh.maximumDegree = -1;
  EXPECT_THAT(make(), HasSubstr("no density"));
  FiniteElementParameters parameters;
  parameters.poissonRatio = 0.5;
  mesh = Rod(1, Wave);
  EXPECT_THAT(ErrorOf([&] { MakeFiniteElements(mesh, law, parameters); }), HasSubstr("PoissonRatio"));
}
} // namespace FiniteElementModelTests
