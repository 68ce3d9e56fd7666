/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneContinuousDensity.h"

#include "boneSharedSystem.h"
#include "boneWorseyFarinElement.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace bone
{
namespace
{
using Element = WorseyFarinElement;

/** Numbers the nodal values of the elements: those of a vertex or an edge are shared within a region. */
SharedCoefficients
ShareNodes(const MeshArrays & mesh)
{
  // Degree 2 has one coefficient a vertex and one an edge.
  const SharedCoefficients places = ShareCoefficients(mesh, 2);
  const auto &             exponents = BernsteinExponents(2);
  const std::size_t        cells = mesh.tetrahedra.size();
  std::vector<std::size_t> first(places.size + 1, 0);
  for (std::size_t i = 0; i < places.size; ++i)
  {
    const auto & e = exponents[places.uses[places.start[i]] % exponents.size()];
    first[i + 1] = first[i] + (*std::max_element(e.begin(), e.end()) == 2 ? 4 : 2);
  }
  SharedCoefficients nodes;
  nodes.size = first.back();
  nodes.global.resize(cells * Element::NodeCount);
  for (std::size_t t = 0; t < cells; ++t)
  {
    std::uint32_t * node = &nodes.global[t * Element::NodeCount];
    const auto      number = [&](int v, int w, int count) {
      std::array<int, 4> e{};
      ++e[v];
      ++e[w];
      const std::size_t place = places.global[t * exponents.size() + BernsteinIndex(2, e[0], e[1], e[2])];
      for (int i = 0; i < count; ++i)
      {
        *node++ = static_cast<std::uint32_t>(first[place] + i);
      }
    };
    for (int v = 0; v < 4; ++v)
    {
      number(v, v, 4);
    }
    for (const auto & edge : TetraEdges)
    {
      number(edge[0], edge[1], 2);
    }
  }
  nodes.ListUses();
  return nodes;
}

/** The assembled mass matrix of the elements and its preconditioner. */
class ElementSystem : public SharedSystem
{
public:
  ElementSystem(const MeshArrays &         mesh,
                const MeshArrays &         split,
                const SharedCoefficients & nodes,
                const Execution &          execution)
    : SharedSystem(mesh, nodes, Element::NodeCount, execution)
    , m_Split(split)
    , m_Tetrahedra(mesh.tetrahedra)
    , m_Mass(m_Cells)
    , m_Inverse(m_Cells)
  {
    for (const double volume : m_Volume)
    {
      m_Scale += volume / static_cast<double>(m_Cells);
    }
    m_Scale = std::cbrt(m_Scale);
    m_Execution.For(
      m_Cells,
      [this](std::size_t t) {
        m_Mass[t] = this->MakeElement(t).Mass();
        m_Inverse[t] = m_Mass[t].llt().solve(Element::NodeMatrix::Identity());
      },
      BlockSize);
  }

  Element
  MakeElement(std::size_t t) const
  {
    return { m_Split, m_Tetrahedra[t], t, m_Scale };
  }

  Vector
  RightSide()
  {
    m_Execution.For(
      m_Cells,
      [this](std::size_t t) {
        this->Local(t) = this->MakeElement(t).Moments(&m_Split.coefficients[t * WorseyFarinCells * BernsteinCount(3)]);
      },
      BlockSize);
    return this->Assemble();
  }

  /** The mean of what the elements are nearest to on their own, after RightSide(). */
  Vector
  FirstGuess()
  {
    m_Execution.For(
      m_Cells, [this](std::size_t t) { this->Local(t) = (m_Inverse[t] * this->Local(t)).eval(); }, BlockSize);
    return this->MeanOf(m_Local.data());
  }

  Vector
  Apply(const Vector & x) override
  {
    m_Execution.For(
      m_Cells, [&](std::size_t t) { this->Local(t).noalias() = m_Mass[t] * this->Gather(t, x); }, BlockSize);
    return this->Assemble();
  }

  Vector
  Precondition(const Vector & r) override
  {
    const Vector weighted = r.cwiseProduct(Eigen::Map<const Vector>(m_Weight.data(), r.size()));
    m_Execution.For(
      m_Cells,
      [&](std::size_t t) {
        this->Local(t).noalias() = m_Volume[t] * m_Volume[t] * (m_Inverse[t] * this->Gather(t, weighted));
      },
      BlockSize);
    return this->Assemble().cwiseProduct(Eigen::Map<const Vector>(m_Weight.data(), r.size()));
  }

  Element::NodeVector
  Gather(std::size_t t, const Vector & x) const
  {
    Element::NodeVector nodes;
    for (int n = 0; n < Element::NodeCount; ++n)
    {
      nodes[n] = x[m_Shared.global[t * Element::NodeCount + n]];
    }
    return nodes;
  }

private:
  Eigen::Map<Element::NodeVector>
  Local(std::size_t t)
  {
    return Eigen::Map<Element::NodeVector>(&m_Local[t * Element::NodeCount]);
  }

  const MeshArrays &               m_Split;
  const std::vector<Id4> &         m_Tetrahedra;
  double                           m_Scale{ 0.0 };
  std::vector<Element::NodeMatrix> m_Mass;
  std::vector<Element::NodeMatrix> m_Inverse;
};
} // namespace

ContinuousDensityReport
MakeGradientContinuous(const MeshArrays & mesh,
                       MeshArrays &       split,
                       const Execution &  execution,
                       double             tolerance,
                       int                maximumIterations)
{
  if (split.tetrahedra.size() != WorseyFarinCells * mesh.tetrahedra.size() || split.maximumDegree != 3 ||
      std::any_of(split.degree.begin(), split.degree.end(), [](int d) { return d != 3; }))
  {
    throw std::invalid_argument("A density with a continuous gradient needs degree 3 in all parts of a split mesh.");
  }
  const SharedCoefficients nodes = ShareNodes(mesh);
  ElementSystem            system(mesh, split, nodes, execution.Silent());
  const auto               right = system.RightSide();
  auto                     x = system.FirstGuess();
  const auto               report = system.Solve(right, x, tolerance, maximumIterations, execution);
  const auto &             places = Element::Places();
  execution.Silent().For(mesh.tetrahedra.size(), [&](std::size_t t) {
    const Element::ControlVector controls = system.MakeElement(t).Controls() * system.Gather(t, x);
    double *                     c = &split.coefficients[t * WorseyFarinCells * BernsteinCount(3)];
    for (const auto & part : places)
    {
      for (const int place : part)
      {
        *c++ = controls[place];
      }
    }
  });
  return report;
}
} // namespace bone
