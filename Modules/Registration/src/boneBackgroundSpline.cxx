/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneBackgroundSpline.h"

#include <cmath>

namespace bone
{
BackgroundSpline::BackgroundSpline(const std::array<int, 2> & size, double length)
{
  for (int axis = 0; axis < 2 && length > 0.0; ++axis)
  {
    for (int i = 0; i < size[axis]; ++i)
    {
      const int    first = static_cast<int>(std::floor(i / length));
      const double t = i / length - first;
      const double s = 1.0 - t;
      m_Supports[axis].push_back({ first,
                                   { { s * s * s / 6.0,
                                       (3.0 * t * t * t - 6.0 * t * t + 4.0) / 6.0,
                                       (3.0 * s * s * s - 6.0 * s * s + 4.0) / 6.0,
                                       t * t * t / 6.0 } } });
    }
    m_Count[axis] = m_Supports[axis].back().first + 4;
  }
}

void
BackgroundSpline::Evaluate(int row, const Eigen::Ref<const Eigen::VectorXd> & coefficients, double * values) const
{
  const Support & rows = m_Supports[1][static_cast<std::size_t>(row)];
  Eigen::VectorXd ofRow = Eigen::VectorXd::Zero(m_Count[0]);
  for (int d = 0; d < 4; ++d)
  {
    ofRow += rows.values[d] * coefficients.segment(static_cast<Eigen::Index>(rows.first + d) * m_Count[0], m_Count[0]);
  }
  for (const Support & columns : m_Supports[0])
  {
    const double * c = ofRow.data() + columns.first;
    const auto &   b = columns.values;
    *values++ = b[0] * c[0] + b[1] * c[1] + b[2] * c[2] + b[3] * c[3];
  }
}

void
BackgroundSpline::AddProducts(int row, const double * values, Eigen::Ref<Eigen::VectorXd> sums) const
{
  const Support &   rows = m_Supports[1][static_cast<std::size_t>(row)];
  const std::size_t n = m_Supports[0].size();
  for (std::size_t c = 0; c < n;)
  {
    const int             first = m_Supports[0][c].first;
    std::array<double, 4> products{};
    for (; c < n && m_Supports[0][c].first == first; ++c)
    {
      for (std::size_t a = 0; a < 4; ++a)
      {
        products[a] += values[c] * m_Supports[0][c].values[a];
      }
    }
    for (int d = 0; d < 4; ++d)
    {
      double * to = &sums[static_cast<Eigen::Index>(rows.first + d) * m_Count[0] + first];
      for (std::size_t a = 0; a < 4; ++a)
      {
        to[a] += rows.values[d] * products[a];
      }
    }
  }
}

void
BackgroundSpline::AddNormalMatrix(int row, const double * weights, Eigen::MatrixXd & sums) const
{
  const Support &   rows = m_Supports[1][static_cast<std::size_t>(row)];
  const std::size_t n = m_Supports[0].size();
  for (std::size_t c = 0; c < n;)
  {
    const int       first = m_Supports[0][c].first;
    Eigen::Matrix4d products = Eigen::Matrix4d::Zero();
    for (; c < n && m_Supports[0][c].first == first; ++c)
    {
      const Eigen::Map<const Eigen::Vector4d> b(m_Supports[0][c].values.data());
      products.noalias() += (weights[c] * b) * b.transpose();
    }
    for (int d = 0; d < 4; ++d)
    {
      for (int e = 0; e <= d; ++e)
      {
        sums.block<4, 4>(static_cast<Eigen::Index>(rows.first + d) * m_Count[0] + first,
                         static_cast<Eigen::Index>(rows.first + e) * m_Count[0] + first) +=
          rows.values[d] * rows.values[e] * products;
      }
    }
  }
}
} // namespace bone
