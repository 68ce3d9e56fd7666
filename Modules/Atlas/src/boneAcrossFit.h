/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneAcrossFit_h
#define boneAcrossFit_h

#include "boneTypes.h"

#include <Eigen/Cholesky>

#include <array>

namespace bone
{
/** \class AcrossFit
 * \brief The affine displacement B d + c that fits displacements u best in the metric n n^T + slide I: fully across a
 * surface of normal n, and with the share `slide` along it. */
class AcrossFit
{
public:
  /** What one displacement adds, but for where it is. */
  struct Term
  {
    std::array<double, 6> metric; // xx, yy, zz, xy, xz, yz
    Vector3               force;
  };

  static Term
  MakeTerm(const Vector3 & normal, const Vector3 & displacement, double slide, double weight)
  {
    const Vector3 & n = normal;
    Term            term;
    term.metric = { { weight * (n[0] * n[0] + slide),
                      weight * (n[1] * n[1] + slide),
                      weight * (n[2] * n[2] + slide),
                      weight * n[0] * n[1],
                      weight * n[0] * n[2],
                      weight * n[1] * n[2] } };
    term.force = weight * (n.dot(displacement) * n + slide * displacement);
    return term;
  }

  /** `d`: place of the displacement. */
  void
  Add(const Vector3 & d, const Term & term, double factor)
  {
    const double c[4] = { d[0], d[1], d[2], 1.0 };
    double       metric[6];
    for (int k = 0; k < 6; ++k)
    {
      metric[k] = factor * term.metric[k];
    }
    const double trace = metric[0] + metric[1] + metric[2];
    m_Weight += trace;
    m_Spread += trace * d.squaredNorm();
    for (int a = 0, block = 0; a < 4; ++a)
    {
      for (int k = 0; k < 3; ++k)
      {
        m_Right[a][k] += factor * c[a] * term.force[k];
      }
      for (int b = a; b < 4; ++b, ++block)
      {
        const double both = c[a] * c[b];
        for (int k = 0; k < 6; ++k)
        {
          m_Blocks[block][k] += both * metric[k];
        }
      }
    }
  }

  /** `ridge`: pull of B to 0, relative to the spread. False where nothing was added. */
  bool
  Solve(double ridge, Eigen::Matrix3d & b, Vector3 & c) const
  {
    if (!(m_Weight > 0 && m_Spread > 0))
    {
      return false;
    }
    Eigen::Matrix<double, 12, 12> matrix;
    Eigen::Matrix<double, 12, 1>  right;
    for (int i = 0, block = 0; i < 4; ++i)
    {
      right.segment<3>(3 * i) = Eigen::Map<const Vector3>(m_Right[i]);
      for (int j = i; j < 4; ++j, ++block)
      {
        const double *  m = m_Blocks[block];
        Eigen::Matrix3d part;
        part << m[0], m[3], m[4], m[3], m[1], m[5], m[4], m[5], m[2];
        matrix.block<3, 3>(3 * i, 3 * j) = part;
        matrix.block<3, 3>(3 * j, 3 * i) = part;
      }
    }
    matrix.diagonal().head<9>().array() += ridge * m_Spread;
    matrix.diagonal().tail<3>().array() += 1e-9 * m_Weight;
    const Eigen::Matrix<double, 12, 1> solution = matrix.ldlt().solve(right);
    for (int i = 0; i < 3; ++i)
    {
      b.col(i) = solution.segment<3>(3 * i);
    }
    c = solution.tail<3>();
    return true;
  }

private:
  double m_Blocks[10][6] = {};
  double m_Right[4][3] = {};
  double m_Spread{ 0.0 };
  double m_Weight{ 0.0 };
};
} // namespace bone

#endif
