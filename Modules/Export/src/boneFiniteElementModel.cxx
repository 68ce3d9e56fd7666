/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneFiniteElementModel.h"

#include "boneBernstein.h"
#include "boneDensityCalibration.h"
#include "boneFiniteElementSets.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace bone
{
namespace
{
constexpr double TonnesPerGram = 1e-9; // per mm^3, of g/cm^3
constexpr double LeastMassDensity = 1e-12;

/** A place in an element and its share of the volume. */
struct QuadraturePoint
{
  Barycentric place;
  double      weight;
};

/** N. J. Walkington, Quadrature on simplices of arbitrary dimension, 2000: 14 points, degree 5. */
std::vector<QuadraturePoint>
MakeQuadrature()
{
  std::vector<QuadraturePoint> points;
  for (const auto & [a, weight] : { std::pair(0.09273525031089122640, 0.07349304311636194),
                                    std::pair(0.31088591926330060980, 0.11268792571801585) })
  {
    for (int i = 0; i < 4; ++i)
    {
      Barycentric mu = Barycentric::Constant(a);
      mu[i] = 1.0 - 3.0 * a;
      points.push_back({ mu, weight });
    }
  }
  constexpr double a = 0.04550370412564964949;
  for (int i = 0; i < 4; ++i)
  {
    for (int j = i + 1; j < 4; ++j)
    {
      Barycentric mu = Barycentric::Constant(a);
      mu[i] = mu[j] = 0.5 - a;
      points.push_back({ mu, 0.04254602077708147 });
    }
  }
  return points;
}

/** Factors from the mesh's density to the law's, and to apparent density. */
struct DensityFactors
{
  double law{ 1.0 };
  double apparent{ 1.0 };
};

DensityFactors
FindFactors(DensityQuantity mesh, DensityQuantity law)
{
  constexpr auto ash = DensityQuantity::AshGramPerCubicCentimetre;
  constexpr auto apparent = DensityQuantity::ApparentGramPerCubicCentimetre;
  if (mesh != ash && mesh != apparent)
  {
    throw std::invalid_argument("An elasticity law needs ash or apparent density, and the model's density is " +
                                DensityQuantityName(mesh) + ": calibrate it first.");
  }
  const double apparentPerAsh = FindDensityLaw("schileo2008").slope;
  return { mesh == law   ? 1.0
           : mesh == ash ? apparentPerAsh
                         : 1.0 / apparentPerAsh,
           mesh == ash ? apparentPerAsh : 1.0 };
}

/** The polynomial of one tetrahedron. */
struct CellDensity
{
  int            degree;
  const double * coefficients;

  double
  At(const Barycentric & mu) const
  {
    return BernsteinValue(degree, coefficients, mu);
  }
};

CellDensity
DensityOf(const MeshArrays & mesh, std::size_t t)
{
  const auto row = static_cast<std::size_t>(BernsteinCount(mesh.maximumDegree));
  return { mesh.degree[t], mesh.coefficients.data() + t * row };
}

std::vector<double>
Volumes(const MeshArrays & mesh)
{
  std::vector<double> volumes;
  for (const Id4 & t : mesh.tetrahedra)
  {
    const auto x = [&](std::size_t i) { return mesh.points[static_cast<std::size_t>(t[i])]; };
    volumes.push_back(SignedVolume(x(0), x(1), x(2), x(3)));
    if (!(volumes.back() > 0.0))
    {
      throw std::invalid_argument("Tetrahedron " + std::to_string(volumes.size() - 1) +
                                  " is inverted or flat: no solver takes it.");
    }
  }
  return volumes;
}

/** Corners, and with order 2 a node in the middle of each edge, edges in ascending order of their ends. */
void
MakeNodes(const MeshArrays & mesh, FiniteElementModel & model)
{
  model.nodes = mesh.points;
  model.elements.assign(mesh.tetrahedra.size(), {});
  using Edge = std::pair<IdType, IdType>;
  const auto edgeOf = [](const Id4 & t, const std::array<int, 2> & ends) -> Edge {
    return std::minmax(t[static_cast<std::size_t>(ends[0])], t[static_cast<std::size_t>(ends[1])]);
  };
  std::vector<Edge> edges;
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e)
  {
    std::copy(mesh.tetrahedra[e].begin(), mesh.tetrahedra[e].end(), model.elements[e].begin());
    for (const auto & ends : FiniteElementEdges)
    {
      edges.push_back(edgeOf(mesh.tetrahedra[e], ends));
    }
  }
  if (model.order == 1)
  {
    return;
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  for (const auto & [a, b] : edges)
  {
    model.nodes.push_back(0.5 * (mesh.points[static_cast<std::size_t>(a)] + mesh.points[static_cast<std::size_t>(b)]));
  }
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e)
  {
    for (std::size_t i = 0; i < FiniteElementEdges.size(); ++i)
    {
      const auto found =
        std::lower_bound(edges.begin(), edges.end(), edgeOf(mesh.tetrahedra[e], FiniteElementEdges[i]));
      model.elements[e][4 + i] = static_cast<IdType>(mesh.points.size()) + static_cast<IdType>(found - edges.begin());
    }
  }
}

/** Modulus and mass density of each element. */
void
MakeElementModuli(const MeshArrays &          mesh,
                  const std::vector<double> & volumes,
                  const DensityFactors &      factors,
                  FiniteElementModel &        model)
{
  static const std::vector<QuadraturePoint> points = MakeQuadrature();
  const double                              least = model.parameters.leastModulus;
  double                                    outside = 0.0, total = 0.0;
  for (std::size_t e = 0; e < volumes.size(); ++e)
  {
    const CellDensity density = DensityOf(mesh, e);
    double            modulus = 0.0;
    for (const QuadraturePoint & point : points)
    {
      modulus += point.weight * model.law(factors.law * density.At(point.place));
    }
    const double mean = BernsteinIntegral(density.degree, density.coefficients, 1.0);
    const double inLaw = factors.law * mean;
    model.softElements += modulus < least ? 1 : 0;
    model.modulus.push_back(std::max(modulus, least));
    model.massDensity.push_back(std::max(TonnesPerGram * factors.apparent * mean, LeastMassDensity));
    outside += inLaw < model.law.low || inLaw > model.law.high ? volumes[e] : 0.0;
    total += volumes[e];
  }
  model.shareOutside = total > 0.0 ? outside / total : 0.0;
}

void
MakeNodeModuli(const MeshArrays &          mesh,
               const std::vector<double> & volumes,
               const DensityFactors &      factors,
               FiniteElementModel &        model)
{
  std::vector<double> weights(model.nodes.size(), 0.0);
  model.nodeModulus.assign(model.nodes.size(), 0.0);
  for (std::size_t e = 0; e < volumes.size(); ++e)
  {
    const CellDensity density = DensityOf(mesh, e);
    for (std::size_t i = 0; i < static_cast<std::size_t>(model.NodesEach()); ++i)
    {
      Barycentric mu = Barycentric::Zero();
      if (i < 4)
      {
        mu[static_cast<int>(i)] = 1.0;
      }
      else
      {
        mu[FiniteElementEdges[i - 4][0]] = mu[FiniteElementEdges[i - 4][1]] = 0.5;
      }
      const auto node = static_cast<std::size_t>(model.elements[e][i]);
      model.nodeModulus[node] += volumes[e] * model.law(factors.law * density.At(mu));
      weights[node] += volumes[e];
    }
  }
  for (std::size_t n = 0; n < weights.size(); ++n)
  {
    const double mean = weights[n] > 0.0 ? model.nodeModulus[n] / weights[n] : 0.0;
    model.nodeModulus[n] = std::max(mean, model.parameters.leastModulus);
  }
}

/** Bins of moduli; empty ones are left out. */
void
MakeMaterials(const std::vector<double> & volumes, FiniteElementModel & model)
{
  const auto [softest, stiffest] = std::minmax_element(model.modulus.begin(), model.modulus.end());
  const double low = std::log(*softest), width = std::log(*stiffest) - low;
  const int    bins = width > 0.0 ? model.parameters.bins : 1;
  struct Sums
  {
    double volume{ 0.0 }, modulus{ 0.0 }, mass{ 0.0 };
  };
  std::vector<Sums> sums(static_cast<std::size_t>(bins));
  for (std::size_t e = 0; e < volumes.size(); ++e)
  {
    const double place = width > 0.0 ? (std::log(model.modulus[e]) - low) / width : 0.0;
    const int    bin = std::clamp(static_cast<int>(place * bins), 0, bins - 1);
    model.material.push_back(bin);
    Sums & sum = sums[static_cast<std::size_t>(bin)];
    sum.volume += volumes[e];
    sum.modulus += volumes[e] * model.modulus[e];
    sum.mass += volumes[e] * model.massDensity[e];
  }
  std::vector<int> number(sums.size(), -1);
  for (std::size_t bin = 0; bin < sums.size(); ++bin)
  {
    if (sums[bin].volume > 0.0)
    {
      number[bin] = static_cast<int>(model.materials.size());
      model.materials.push_back({ sums[bin].modulus / sums[bin].volume, sums[bin].mass / sums[bin].volume });
    }
  }
  double total = 0.0;
  for (std::size_t e = 0; e < volumes.size(); ++e)
  {
    model.material[e] = number[static_cast<std::size_t>(model.material[e])];
    const double binned = model.materials[static_cast<std::size_t>(model.material[e])].modulus;
    const double error = std::abs(binned / model.modulus[e] - 1.0);
    model.binErrorLargest = std::max(model.binErrorLargest, error);
    model.binErrorMean += volumes[e] * error;
    total += volumes[e];
  }
  model.binErrorMean /= total;
}
} // namespace

int
FiniteElementEdgeNode(int cornerA, int cornerB)
{
  const auto found = std::find_if(FiniteElementEdges.begin(), FiniteElementEdges.end(), [&](const auto & ends) {
    return std::minmax(ends[0], ends[1]) == std::minmax(cornerA, cornerB);
  });
  return 4 + static_cast<int>(found - FiniteElementEdges.begin());
}

std::vector<IdType>
FiniteElementFaceNodes(const FiniteElementModel & model, const FiniteElementFace & face)
{
  const auto &        element = model.elements[static_cast<std::size_t>(face.element)];
  const auto &        corners = FiniteElementFaceCorners[static_cast<std::size_t>(face.opposite)];
  std::vector<IdType> nodes;
  for (const int corner : corners)
  {
    nodes.push_back(element[static_cast<std::size_t>(corner)]);
  }
  for (std::size_t i = 0; model.order == 2 && i < 3; ++i)
  {
    nodes.push_back(element[static_cast<std::size_t>(FiniteElementEdgeNode(corners[i], corners[(i + 1) % 3]))]);
  }
  return nodes;
}

FiniteElementModel
MakeFiniteElements(const MeshArrays &              mesh,
                   const ElasticityLaw &           law,
                   const FiniteElementParameters & parameters,
                   const std::vector<Landmark> &   landmarks)
{
  parameters.Verify();
  if (!mesh.HasDensity() || mesh.tetrahedra.empty())
  {
    throw std::invalid_argument("The mesh holds no density, which the moduli come from.");
  }
  const DensityFactors factors = FindFactors(mesh.quantity, law.density);
  FiniteElementModel   model;
  model.order = parameters.order;
  model.law = law;
  model.parameters = parameters;
  model.region = mesh.region.empty() ? std::vector<int>(mesh.tetrahedra.size(), 1) : mesh.region;
  const std::vector<double> volumes = Volumes(mesh);
  MakeNodes(mesh, model);
  MakeElementModuli(mesh, volumes, factors, model);
  MakeNodeModuli(mesh, volumes, factors, model);
  MakeMaterials(volumes, model);
  AddFiniteElementSets(mesh, landmarks, model);
  return model;
}
} // namespace bone
