/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneInteriorDeformation.h"

#include "boneSparseCholesky.h"
#include "boneSymmetricEigen.h"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <Eigen/SparseCore>

#include <numeric>
#include <stdexcept>

namespace bone
{
namespace
{
constexpr std::size_t FramePoints = 24; // exterior points that span the frame of an interior one

struct Frame
{
  Vector3         origin{ Vector3::Zero() };
  Eigen::Matrix3d axes;
};

template <typename TGet>
Frame
FindFrame(const std::vector<std::size_t> & ids, const TGet & get)
{
  Frame frame;
  for (const std::size_t i : ids)
  {
    frame.origin += get(i) / static_cast<double>(ids.size());
  }
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const std::size_t i : ids)
  {
    const Vector3 d = get(i) - frame.origin;
    covariance += d * d.transpose();
  }
  frame.axes = EigenOf(covariance).vectors;
  return frame;
}

/** Gradients of the four linear shape functions, and the volume. */
double
ShapeGradients(const std::array<Vector3, 4> & x, std::array<Vector3, 4> & gradient)
{
  const double volume = SignedVolume(x[0], x[1], x[2], x[3]);
  for (int i = 0; i < 4; ++i)
  {
    const auto & f = TetraFaces[i];
    gradient[i] = -(x[f[1]] - x[f[0]]).cross(x[f[2]] - x[f[0]]) / (6.0 * volume);
  }
  return volume;
}
} // namespace

struct InteriorDeformation::Solver
{
  Eigen::SparseMatrix<double> coupling; // interior by exterior
  SparseCholesky              factor;
};

InteriorDeformation::InteriorDeformation(const MeshArrays & mesh, const std::vector<IdType> & exterior)
  : m_Points(mesh.points)
  , m_Exterior(exterior)
  , m_Solver(std::make_unique<Solver>())
{
  if (mesh.tetrahedra.empty())
  {
    throw std::invalid_argument("The standard model has no tetrahedra.");
  }
  std::vector<int> number(mesh.points.size(), 0); // exterior: -1 - index, interior: index
  for (std::size_t i = 0; i < exterior.size(); ++i)
  {
    number[exterior[i]] = -1 - static_cast<int>(i);
  }
  for (std::size_t p = 0; p < mesh.points.size(); ++p)
  {
    if (number[p] == 0)
    {
      number[p] = static_cast<int>(m_Interior.size());
      m_Interior.push_back(static_cast<IdType>(p));
    }
  }
  std::vector<SparseEntry>            inner;
  std::vector<Eigen::Triplet<double>> outer;
  for (const Id4 & t : mesh.tetrahedra)
  {
    std::array<Vector3, 4> gradient;
    const double volume = ShapeGradients({ m_Points[t[0]], m_Points[t[1]], m_Points[t[2]], m_Points[t[3]] }, gradient);
    for (int i = 0; i < 4; ++i)
    {
      for (int j = 0; j < 4 && number[t[i]] >= 0; ++j)
      {
        const double entry = volume * gradient[i].dot(gradient[j]);
        if (number[t[j]] >= 0)
        {
          inner.push_back({ number[t[i]], number[t[j]], entry });
        }
        else
        {
          outer.emplace_back(number[t[i]], -1 - number[t[j]], entry);
        }
      }
    }
  }
  const auto size = static_cast<Eigen::Index>(m_Interior.size());
  m_Solver->coupling.resize(size, static_cast<Eigen::Index>(exterior.size()));
  m_Solver->coupling.setFromTriplets(outer.begin(), outer.end());
  if (size > 0 && !m_Solver->factor.Factorize(size, inner))
  {
    throw std::invalid_argument("The standard model's cells are too flat for a harmonic displacement.");
  }
}

InteriorDeformation::~InteriorDeformation() = default;

std::vector<Vector3>
InteriorDeformation::Deform(InteriorRule                 rule,
                            const AffineMap &            alignment,
                            const std::vector<Vector3> & moved,
                            const Execution &            execution) const
{
  if (moved.size() != m_Exterior.size())
  {
    throw std::invalid_argument("As many exterior points must be given as the standard model has.");
  }
  return rule == InteriorRule::Harmonic ? this->DeformHarmonic(alignment, moved)
                                        : this->DeformByFrames(alignment, moved, execution);
}

std::vector<Vector3>
InteriorDeformation::DeformHarmonic(const AffineMap & alignment, const std::vector<Vector3> & moved) const
{
  std::vector<Vector3> points(m_Points.size());
  Eigen::MatrixX3d     displacement(static_cast<Eigen::Index>(moved.size()), 3);
  for (std::size_t i = 0; i < moved.size(); ++i)
  {
    points[m_Exterior[i]] = moved[i];
    displacement.row(static_cast<Eigen::Index>(i)) = moved[i] - alignment(m_Points[m_Exterior[i]]);
  }
  if (!m_Interior.empty())
  {
    const Eigen::MatrixX3d right = -(m_Solver->coupling * displacement);
    const Eigen::MatrixXd  inner = m_Solver->factor.Solve(right);
    for (std::size_t i = 0; i < m_Interior.size(); ++i)
    {
      points[m_Interior[i]] = alignment(m_Points[m_Interior[i]]) + inner.row(static_cast<Eigen::Index>(i)).transpose();
    }
  }
  return points;
}

std::vector<Vector3>
InteriorDeformation::DeformByFrames(const AffineMap &            alignment,
                                    const std::vector<Vector3> & moved,
                                    const Execution &            execution) const
{
  std::vector<Vector3> points(m_Points.size());
  for (std::size_t i = 0; i < moved.size(); ++i)
  {
    points[m_Exterior[i]] = moved[i];
  }
  execution.For(
    m_Interior.size(),
    [&](std::size_t k) {
      const Vector3            v = m_Points[m_Interior[k]];
      std::vector<std::size_t> ids(m_Exterior.size());
      std::iota(ids.begin(), ids.end(), 0);
      const auto near = [&](std::size_t a, std::size_t b) {
        return (m_Points[m_Exterior[a]] - v).squaredNorm() < (m_Points[m_Exterior[b]] - v).squaredNorm();
      };
      const std::size_t count = std::min(FramePoints, ids.size());
      std::partial_sort(ids.begin(), ids.begin() + static_cast<std::ptrdiff_t>(count), ids.end(), near);
      ids.resize(count);
      const Frame rest = FindFrame(ids, [&](std::size_t i) { return m_Points[m_Exterior[i]]; });
      Frame       now = FindFrame(ids, [&](std::size_t i) { return moved[i]; });
      for (int axis = 0; axis < 3; ++axis)
      {
        if (now.axes.col(axis).dot(alignment.linear * rest.axes.col(axis)) < 0)
        {
          now.axes.col(axis) = -now.axes.col(axis);
        }
      }
      points[m_Interior[k]] = now.origin + now.axes * (rest.axes.transpose() * (v - rest.origin));
    },
    64);
  return points;
}
} // namespace bone
