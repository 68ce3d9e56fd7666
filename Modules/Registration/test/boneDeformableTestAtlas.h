/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneDeformableTestAtlas_h
#define boneDeformableTestAtlas_h

#include "boneRegistrationTestBody.h"
#include "boneStatisticalModel.h"

namespace bone
{
namespace test
{
/** The body without the flat tetrahedra along the edges of the cube that it is made of. */
inline MeshArrays
SolidBody(int cells)
{
  const MeshArrays body = Body(cells);
  MeshArrays       solid = body;
  solid.tetrahedra.clear();
  solid.degree.clear();
  solid.coefficients.clear();
  const auto at = [&body](IdType p) { return body.points[static_cast<std::size_t>(p)]; };
  for (std::size_t t = 0; t < body.tetrahedra.size(); ++t)
  {
    const Id4 & cell = body.tetrahedra[t];
    if (SignedVolume(at(cell[0]), at(cell[1]), at(cell[2]), at(cell[3])) > 0.1)
    {
      const auto row = body.coefficients.begin() + static_cast<std::ptrdiff_t>(4 * t);
      solid.tetrahedra.push_back(cell);
      solid.degree.push_back(1);
      solid.coefficients.insert(solid.coefficients.end(), row, row + 4);
    }
  }
  solid.region.clear();
  RemoveUnusedPoints(solid);
  solid.neighbors = ComputeFaceNeighbors(solid.tetrahedra);
  return solid;
}

/** Modes whose standard deviations are the columns, each made orthogonal to those before it. */
inline PrincipalModes
ModesOf(const Eigen::VectorXd & mean, Eigen::MatrixXd scaled)
{
  PrincipalModes modes;
  modes.mean = mean;
  modes.variances.resize(scaled.cols());
  for (Eigen::Index k = 0; k < scaled.cols(); ++k)
  {
    for (Eigen::Index j = 0; j < k; ++j)
    {
      scaled.col(k) -= scaled.col(j).dot(scaled.col(k)) / scaled.col(j).squaredNorm() * scaled.col(j);
    }
    modes.variances[k] = scaled.col(k).squaredNorm();
  }
  modes.modes = scaled.colwise().normalized();
  modes.totalVariance = modes.variances.sum();
  return modes;
}

/** A mean, by a standard deviation of its modes 8 % wider along x, 6 % longer along z, and denser by 300 HU
 * in the middle; five subjects. The first mode moves all of it `aside` mm along y, too. */
inline StatisticalModelContent
AtlasOf(MeshArrays body, double aside = 0.0)
{
  StatisticalModelContent atlas;
  atlas.mean = std::move(body);
  const Eigen::VectorXd mean = StackPoints(atlas.mean.points);
  Eigen::MatrixXd       shape = Eigen::MatrixXd::Zero(mean.size(), 2);
  for (Eigen::Index i = 0; i < mean.size(); i += 3)
  {
    shape(i, 0) = 0.08 * (mean[i] - 10.0);
    shape(i + 1, 0) = aside;
    shape(i + 2, 1) = 0.06 * (mean[i + 2] - 30.0);
  }
  atlas.shape = ModesOf(mean, shape);
  const Eigen::Map<const Eigen::VectorXd> density(atlas.mean.coefficients.data(),
                                                  static_cast<Eigen::Index>(atlas.mean.coefficients.size()));
  // A factor of all densities would not show: PatchGradientCorrelation has one for each patch.
  Eigen::VectorXd core(density.size());
  for (Eigen::Index i = 0; i < core.size(); ++i)
  {
    const IdType p = atlas.mean.tetrahedra[static_cast<std::size_t>(i / 4)][static_cast<std::size_t>(i % 4)];
    core[i] =
      300.0 * std::exp(-(atlas.mean.points[static_cast<std::size_t>(p)] - Vector3(10, 20, 30)).squaredNorm() / 128);
  }
  atlas.density = ModesOf(density, core);
  atlas.subjects = { "a", "b", "c", "d", "e" };
  atlas.shapeScores.resize(5, 2);
  atlas.shapeScores << -1.2, 0.5, -0.6, -1.3, 0.0, 0.9, 0.7, 0.6, 1.1, -0.7;
  atlas.densityScores.resize(5, 1);
  atlas.densityScores << 0.3, -1.4, 1.1, -0.5, 0.5;
  return atlas;
}

inline StatisticalModelContent
Atlas(int cells = 8)
{
  return AtlasOf(SolidBody(cells));
}
} // namespace test
} // namespace bone

#endif
