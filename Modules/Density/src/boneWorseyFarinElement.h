/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneWorseyFarinElement_h
#define boneWorseyFarinElement_h

#include "boneBernstein.h"
#include "boneMeshArrays.h"
#include "boneWorseyFarinSplit.h"

namespace bone
{
/** The C1 cubic on one tetrahedron that SplitWorseyFarin split.
 *
 * It is known by 28 nodal values: the value and `scale` times the gradient at each vertex (4 vertices of 1 + 3), and
 * `scale` times the two derivatives across each edge at its middle (6 edges of 2, TetraEdges), in a frame that depends
 * on the edge alone. Tetrahedra with the same nodal values on a shared face join C1. The 91 control values follow, ring
 * by ring: a blossom with two arguments fixed is an affine function around the edge between them, so what lies in the
 * split points is the mean of what lies in vertices, weighted by the split points' barycentric coordinates. */
class WorseyFarinElement
{
public:
  static constexpr int NodeCount = 28;
  static constexpr int ControlCount = 91;
  using NodeRow = Eigen::Matrix<double, 1, NodeCount>;
  using NodeMatrix = Eigen::Matrix<double, NodeCount, NodeCount>;
  using NodeVector = Eigen::Matrix<double, NodeCount, 1>;
  using ControlVector = Eigen::Matrix<double, ControlCount, 1>;
  using ControlMatrix = Eigen::Matrix<double, ControlCount, NodeCount>;

  /** Tetrahedron `t` with vertices `tetra`, whose parts are 12 t to 12 t + 11 of `split`. `scale` in mm. */
  WorseyFarinElement(const MeshArrays & split, const Id4 & tetra, std::size_t t, double scale);

  /** The control value of coefficient c of part k: Places()[k][c]. */
  using PlaceTable = std::array<std::array<int, BernsteinCount(3)>, WorseyFarinCells>;
  static const PlaceTable &
  Places();

  /** Control values from nodal values. */
  const ControlMatrix &
  Controls() const
  {
    return m_Controls;
  }

  /** Inner products of the nodal basis functions over the tetrahedron. */
  NodeMatrix
  Mass() const;

  /** Inner products of the nodal basis functions with what the parts hold: 12 rows of 20 coefficients. */
  NodeVector
  Moments(const double * coefficients) const;

private:
  void
  SetVertexRings(double scale);
  void
  SetEdgeRings(const Id4 & tetra, double scale);
  void
  SetSplitPoints();
  NodeRow
  MeanAt(int point, int p, int q) const;

  std::array<Vector3, 9>               m_Points;
  std::array<Eigen::Vector4d, 9>       m_Coordinates; // barycentric, of the nine points in the tetrahedron
  std::array<double, WorseyFarinCells> m_Volumes;     // of the parts
  ControlMatrix                        m_Controls{ ControlMatrix::Zero() };
};
} // namespace bone

#endif
