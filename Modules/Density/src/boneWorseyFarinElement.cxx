/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneWorseyFarinElement.h"

#include <algorithm>
#include <cmath>

namespace bone
{
namespace
{
constexpr int PointCount = 9;
constexpr int IncentrePoint = 8;

/** Numbers of the control values: of each three of the nine points that lie in one part, in any order; -1 for others.
 */
struct ControlPlaces
{
  ControlPlaces()
  {
    for (auto & plane : number)
    {
      for (auto & row : plane)
      {
        row.fill(-1);
      }
    }
    const auto & exponents = BernsteinExponents(3);
    const auto   parts = WorseyFarinParts();
    int          count = 0;
    for (std::size_t k = 0; k < parts.size(); ++k)
    {
      for (std::size_t c = 0; c < exponents.size(); ++c)
      {
        std::array<int, 3> p;
        int                filled = 0;
        for (int i = 0; i < 4; ++i)
        {
          for (int repeat = 0; repeat < exponents[c][i]; ++repeat)
          {
            p[filled++] = parts[k][i];
          }
        }
        if (number[p[0]][p[1]][p[2]] < 0)
        {
          std::sort(p.begin(), p.end());
          do
          {
            number[p[0]][p[1]][p[2]] = count;
          } while (std::next_permutation(p.begin(), p.end()));
          ++count;
        }
        table[k][c] = number[p[0]][p[1]][p[2]];
      }
    }
  }

  std::array<std::array<std::array<int, PointCount>, PointCount>, PointCount> number;
  WorseyFarinElement::PlaceTable                                              table;
};

const ControlPlaces &
AllPlaces()
{
  static const ControlPlaces places;
  return places;
}

int
Place(int p, int q, int r)
{
  return AllPlaces().number[p][q][r];
}

/** Two unit vectors across a direction and each other. */
std::array<Vector3, 2>
FrameAcross(const Vector3 & direction)
{
  Eigen::Index least;
  direction.cwiseAbs().minCoeff(&least);
  const Vector3 first = direction.cross(Vector3(Vector3::Unit(least))).normalized();
  return { first, direction.cross(first).normalized() };
}

Eigen::Map<const Eigen::MatrixXd>
CubicGram()
{
  return { BernsteinGramMatrix(3, 3).data(), BernsteinCount(3), BernsteinCount(3) };
}
} // namespace

const WorseyFarinElement::PlaceTable &
WorseyFarinElement::Places()
{
  return AllPlaces().table;
}

WorseyFarinElement::WorseyFarinElement(const MeshArrays & split, const Id4 & tetra, std::size_t t, double scale)
{
  const auto parts = WorseyFarinParts();
  for (std::size_t k = 0; k < parts.size(); ++k)
  {
    const Id4 & ids = split.tetrahedra[WorseyFarinCells * t + k];
    for (int i = 0; i < 4; ++i)
    {
      m_Points[parts[k][i]] = split.points[ids[i]];
    }
    m_Volumes[k] = SignedVolume(split.points[ids[0]], split.points[ids[1]], split.points[ids[2]], split.points[ids[3]]);
  }
  for (int i = 0; i < 4; ++i)
  {
    m_Coordinates[i] = Eigen::Vector4d::Unit(i);
    const auto &  face = TetraFaces[i];
    const Vector3 a = m_Points[face[0]], b = m_Points[face[1]], c = m_Points[face[2]], f = m_Points[4 + i];
    const Vector3 normal = (b - a).cross(c - a);
    const double  ofA = (b - f).cross(c - f).dot(normal) / normal.squaredNorm();
    const double  ofB = (c - f).cross(a - f).dot(normal) / normal.squaredNorm();
    m_Coordinates[4 + i].setZero();
    m_Coordinates[4 + i][face[0]] = ofA;
    m_Coordinates[4 + i][face[1]] = ofB;
    m_Coordinates[4 + i][face[2]] = 1 - ofA - ofB;
  }
  m_Coordinates[IncentrePoint] = IncentreCoordinates(split, tetra);
  this->SetVertexRings(scale);
  this->SetEdgeRings(tetra, scale);
  this->SetSplitPoints();
}

/** Control values at a vertex and next to it: value and gradient there. */
void
WorseyFarinElement::SetVertexRings(double scale)
{
  for (int v = 0; v < 4; ++v)
  {
    for (int p = 0; p < PointCount; ++p)
    {
      const int place = Place(v, v, p);
      if (place >= 0)
      {
        m_Controls(place, 4 * v) = 1;
        m_Controls.block<1, 3>(place, 4 * v + 1) = (m_Points[p] - m_Points[v]) / (3 * scale);
      }
    }
  }
}

/** Control values in the middle of the edges' rings: the blossom p(m, m, x) = (p(a, a, x) + 2 p(a, b, x) + p(b, b, x))
 * / 4, m the edge's middle, is the value there and a third of the derivative along x - m. */
void
WorseyFarinElement::SetEdgeRings(const Id4 & tetra, double scale)
{
  for (int e = 0; e < 6; ++e)
  {
    const bool    forward = tetra[TetraEdges[e][0]] < tetra[TetraEdges[e][1]];
    const int     a = TetraEdges[e][forward ? 0 : 1], b = TetraEdges[e][forward ? 1 : 0];
    const Vector3 along = m_Points[b] - m_Points[a], middle = (m_Points[a] + m_Points[b]) / 2;
    const auto    across = FrameAcross(along.normalized());
    const auto    row = [this](int p, int q, int r) -> NodeRow { return m_Controls.row(Place(p, q, r)); };
    // p(m, m, a) and p(m, m, b)
    const NodeRow toA = (row(a, a, a) + 2 * row(a, a, b) + row(a, b, b)) / 4;
    const NodeRow toB = (row(a, a, b) + 2 * row(a, b, b) + row(b, b, b)) / 4;
    for (int p = 4; p < PointCount; ++p)
    {
      if (Place(a, b, p) < 0)
      {
        continue;
      }
      const Vector3 step = m_Points[p] - middle;
      NodeRow       value = (toA + toB) / 2 + step.dot(along) / along.squaredNorm() * (toB - toA);
      for (int n = 0; n < 2; ++n)
      {
        value[16 + 2 * e + n] += step.dot(across[n]) / (3 * scale);
      }
      m_Controls.row(Place(a, b, p)) = 2 * value - (row(a, a, p) + row(b, b, p)) / 2;
    }
  }
}

/** p(point, p, q) from the vertices around. */
WorseyFarinElement::NodeRow
WorseyFarinElement::MeanAt(int point, int p, int q) const
{
  NodeRow mean = NodeRow::Zero();
  for (int v = 0; v < 4; ++v)
  {
    if (m_Coordinates[point][v] != 0)
    {
      mean += m_Coordinates[point][v] * m_Controls.row(Place(v, p, q));
    }
  }
  return mean;
}

/** Control values with two or three arguments in split points. */
void
WorseyFarinElement::SetSplitPoints()
{
  constexpr int w = IncentrePoint;
  const auto    set = [this](int p, int q, int r) { m_Controls.row(Place(p, q, r)) = this->MeanAt(p, q, r); };
  for (int f = 4; f < IncentrePoint; ++f)
  {
    for (const int v : TetraFaces[f - 4])
    {
      set(f, v, f);
      set(f, v, w);
    }
    set(f, f, f);
    set(f, f, w);
  }
  for (int v = 0; v < 4; ++v)
  {
    set(w, v, w);
  }
  for (int f = 4; f < IncentrePoint; ++f)
  {
    set(f, w, w);
  }
  set(w, w, w);
}

WorseyFarinElement::NodeMatrix
WorseyFarinElement::Mass() const
{
  const auto                                        gram = CubicGram();
  Eigen::Matrix<double, ControlCount, ControlCount> controls =
    Eigen::Matrix<double, ControlCount, ControlCount>::Zero();
  for (std::size_t k = 0; k < WorseyFarinCells; ++k)
  {
    for (int c = 0; c < gram.cols(); ++c)
    {
      for (int r = 0; r < gram.rows(); ++r)
      {
        controls(Places()[k][r], Places()[k][c]) += m_Volumes[k] * gram(r, c);
      }
    }
  }
  return m_Controls.transpose() * (controls * m_Controls);
}

WorseyFarinElement::NodeVector
WorseyFarinElement::Moments(const double * coefficients) const
{
  constexpr int count = BernsteinCount(3);
  const auto    gram = CubicGram();
  ControlVector controls = ControlVector::Zero();
  for (std::size_t k = 0; k < WorseyFarinCells; ++k)
  {
    const Eigen::Matrix<double, count, 1> moments =
      m_Volumes[k] * (gram * Eigen::Map<const Eigen::Matrix<double, count, 1>>(coefficients + k * count));
    for (int c = 0; c < count; ++c)
    {
      controls[Places()[k][c]] += moments[c];
    }
  }
  return m_Controls.transpose() * controls;
}
} // namespace bone
