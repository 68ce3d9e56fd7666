/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneContinuousDensity.h"

#include "boneSharedSystem.h"
#include "boneWorseyFarinElement.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

namespace bone
{
namespace
{
using Element = WorseyFarinElement;

/** The nodal values of one vertex or edge in an element. */
struct NodeBlock
{
  int first;
  int size;
};

/** The vertex or edge of each coefficient of degree 2, which has one for each. */
std::vector<NodeBlock>
NodeBlocks()
{
  std::vector<NodeBlock> blocks;
  for (const auto & e : BernsteinExponents(2))
  {
    const auto in = [&e](const std::array<int, 2> & edge) { return e[edge[0]] == 1 && e[edge[1]] == 1; };
    const auto edge = std::find_if(TetraEdges.begin(), TetraEdges.end(), in) - TetraEdges.begin();
    const auto vertex = std::find(e.begin(), e.end(), 2) - e.begin();
    blocks.push_back(vertex < 4 ? NodeBlock{ static_cast<int>(4 * vertex), 4 }
                                : NodeBlock{ static_cast<int>(16 + 2 * edge), 2 });
  }
  return blocks;
}

/** Which nodal values elements share: those of a vertex or an edge, within a region. */
struct SharedNodes
{
  explicit SharedNodes(const MeshArrays & mesh)
    : blocks(NodeBlocks())
    , places(ShareCoefficients(mesh, 2))
    , first(places.size + 1, 0)
  {
    const std::size_t count = blocks.size();
    for (std::size_t i = 0; i < places.size; ++i)
    {
      first[i + 1] = first[i] + blocks[places.uses[places.start[i]] % count].size;
    }
    values.size = first.back();
    values.global.resize(mesh.tetrahedra.size() * Element::NodeCount);
    for (std::size_t use = 0; use < places.global.size(); ++use)
    {
      const NodeBlock & block = blocks[use % count];
      for (int n = 0; n < block.size; ++n)
      {
        values.global[use / count * Element::NodeCount + block.first + n] =
          static_cast<std::uint32_t>(first[places.global[use]] + n);
      }
    }
    values.ListUses();
  }

  std::vector<NodeBlock>   blocks;
  SharedCoefficients       places; // vertices and edges
  std::vector<std::size_t> first;  // of each of them, in values
  SharedCoefficients       values;
};

/** The assembled mass matrix of the elements; its diagonal blocks of vertices and edges precondition it. */
class ElementSystem : public SharedSystem
{
public:
  ElementSystem(const MeshArrays &  mesh,
                const MeshArrays &  split,
                const SharedNodes & nodes,
                const Execution &   execution)
    : SharedSystem(mesh, nodes.values, Element::NodeCount, execution)
    , m_Split(split)
    , m_Tetrahedra(mesh.tetrahedra)
    , m_Nodes(nodes)
    , m_Mass(m_Cells)
    , m_Inverses(nodes.places.size)
  {
    m_Scale = std::cbrt(std::accumulate(m_Volume.begin(), m_Volume.end(), 0.0) / static_cast<double>(m_Cells));
    this->ForCells([this](std::size_t t) { m_Mass[t] = this->MakeElement(t).Mass(); });
    m_Execution.For(
      m_Inverses.size(), [this](std::size_t i) { this->InvertBlock(i); }, BlockSize);
  }

  Element
  MakeElement(std::size_t t) const
  {
    return { m_Split, m_Tetrahedra[t], t, m_Scale };
  }

  Vector
  RightSide()
  {
    this->ForCells([this](std::size_t t) {
      this->Local(t) = this->MakeElement(t).Moments(&m_Split.coefficients[t * WorseyFarinCells * BernsteinCount(3)]);
    });
    return this->Assemble();
  }

  /** After RightSide(): the mean of what the elements are nearest to on their own, which is the answer where that is
   * such a spline. */
  Vector
  FirstGuess()
  {
    this->ForCells([this](std::size_t t) { this->Local(t) = m_Mass[t].llt().solve(this->Local(t)).eval(); });
    return this->MeanOf(m_Local.data());
  }

  Vector
  Apply(const Vector & x) override
  {
    this->ForCells([&](std::size_t t) { this->Local(t).noalias() = m_Mass[t] * this->NodesOf(t, x); });
    return this->Assemble();
  }

  Vector
  Precondition(const Vector & r) override
  {
    Vector z(r.size());
    m_Execution.For(
      m_Inverses.size(),
      [&](std::size_t i) {
        const std::size_t first = m_Nodes.first[i], size = m_Nodes.first[i + 1] - first;
        z.segment(first, size).noalias() = m_Inverses[i].topLeftCorner(size, size) * r.segment(first, size);
      },
      ChunkSize);
    return z;
  }

  Element::NodeVector
  NodesOf(std::size_t t, const Vector & x) const
  {
    Element::NodeVector nodes;
    for (int n = 0; n < Element::NodeCount; ++n)
    {
      nodes[n] = x[m_Shared.global[t * Element::NodeCount + n]];
    }
    return nodes;
  }

private:
  template <typename TBody>
  void
  ForCells(const TBody & body) const
  {
    m_Execution.For(m_Cells, body, BlockSize);
  }

  Eigen::Map<Element::NodeVector>
  Local(std::size_t t)
  {
    return Eigen::Map<Element::NodeVector>(&m_Local[t * Element::NodeCount]);
  }

  void
  InvertBlock(std::size_t i)
  {
    const std::size_t size = m_Nodes.first[i + 1] - m_Nodes.first[i], count = m_Nodes.blocks.size();
    Eigen::Matrix4d   sum = Eigen::Matrix4d::Identity();
    sum.topLeftCorner(size, size).setZero();
    m_Nodes.places.ForUses(i, [&](std::size_t use) {
      const int first = m_Nodes.blocks[use % count].first;
      sum.topLeftCorner(size, size) += m_Mass[use / count].block(first, first, size, size);
    });
    m_Inverses[i] = sum.inverse();
  }

  const MeshArrays &               m_Split;
  const std::vector<Id4> &         m_Tetrahedra;
  const SharedNodes &              m_Nodes;
  double                           m_Scale{ 0.0 };
  std::vector<Element::NodeMatrix> m_Mass;
  std::vector<Eigen::Matrix4d>     m_Inverses; // an edge's is the upper left corner
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
  const SharedNodes nodes(mesh);
  ElementSystem     system(mesh, split, nodes, execution.Silent());
  const auto        right = system.RightSide();
  auto              x = system.FirstGuess();
  const auto        report = system.Solve(right, x, tolerance, maximumIterations, execution);
  const auto &      places = Element::Places();
  execution.Silent().For(mesh.tetrahedra.size(), [&](std::size_t t) {
    const Element::ControlVector controls = system.MakeElement(t).Controls() * system.NodesOf(t, x);
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
