/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneVolumeTestBody_h
#define boneVolumeTestBody_h

#include "boneDeformableTestAtlas.h"

#include "boneReflection.h"
#include "boneRigidPose.h"
#include "boneVoxelVolume.h"

#include <Eigen/Geometry>

#include <random>

namespace bone
{
namespace test
{
/** A bent, tapered bar with a cortex of 1100 HU about 300 HU, which looks the same from no two sides. */
inline MeshArrays
BentBar()
{
  constexpr int n[3] = { 8, 8, 16 };
  constexpr int kuhn[6][4] = { { 0, 1, 3, 7 }, { 0, 5, 1, 7 }, { 0, 3, 2, 7 },
                               { 0, 2, 6, 7 }, { 0, 4, 5, 7 }, { 0, 6, 4, 7 } };
  MeshArrays    mesh;
  const auto    id = [&](int i, int j, int k) { return static_cast<IdType>((k * (n[1] + 1) + j) * (n[0] + 1) + i); };
  for (int k = 0; k <= n[2]; ++k)
  {
    for (int j = 0; j <= n[1]; ++j)
    {
      for (int i = 0; i <= n[0]; ++i)
      {
        const double u = 2.0 * i / n[0] - 1.0, v = 2.0 * j / n[1] - 1.0, w = 1.0 * k / n[2];
        mesh.points.emplace_back(
          (16.0 - 6.0 * w) * u + 14.0 * w * w, (12.0 - 3.0 * w) * v + 3.0 * u * w, 80.0 * w + 4.0 * v * (1.0 - w));
      }
    }
  }
  mesh.maximumDegree = 1;
  mesh.quantity = DensityQuantity::HounsfieldUnit;
  for (int k = 0; k < n[2]; ++k)
  {
    for (int j = 0; j < n[1]; ++j)
    {
      for (int i = 0; i < n[0]; ++i)
      {
        const bool cortex = i == 0 || j == 0 || k == 0 || i + 1 == n[0] || j + 1 == n[1] || k + 1 == n[2];
        for (const auto & four : kuhn)
        {
          Id4 cell;
          for (std::size_t c = 0; c < 4; ++c)
          {
            cell[c] = id(i + (four[c] & 1), j + (four[c] >> 1 & 1), k + (four[c] >> 2));
            mesh.coefficients.push_back(cortex ? 1100.0 : 300.0 - 2.0 * k);
          }
          mesh.tetrahedra.push_back(cell);
          mesh.degree.push_back(1);
          mesh.region.push_back(cortex ? 1 : 2);
        }
      }
    }
  }
  mesh.neighbors = ComputeFaceNeighbors(mesh.tetrahedra);
  return mesh;
}

/** The bar, a standard deviation of its modes 4 % larger, or 3 mm further bent; five subjects. */
inline StatisticalModelContent
BarAtlas()
{
  StatisticalModelContent atlas;
  atlas.mean = BentBar();
  const Eigen::VectorXd mean = StackPoints(atlas.mean.points);
  Eigen::MatrixXd       shape = Eigen::MatrixXd::Zero(mean.size(), 2);
  for (Eigen::Index i = 0; i < mean.size(); i += 3)
  {
    shape.block<3, 1>(i, 0) = 0.04 * (mean.segment<3>(i) - Vector3(5, 0, 40));
    shape(i + 1, 1) = 3.0 * mean[i + 2] * mean[i + 2] / 6400.0;
  }
  atlas.shape = ModesOf(mean, shape);
  const Eigen::Map<const Eigen::VectorXd> density(atlas.mean.coefficients.data(),
                                                  static_cast<Eigen::Index>(atlas.mean.coefficients.size()));
  atlas.density = ModesOf(density, 0.1 * density);
  atlas.subjects = { "a", "b", "c", "d", "e" };
  atlas.shapeScores.resize(5, 2);
  atlas.shapeScores << -1.2, 0.5, -0.6, -1.3, 0.0, 0.9, 0.7, 0.6, 1.1, -0.7;
  atlas.densityScores.resize(5, 1);
  atlas.densityScores << 0.3, -1.4, 1.1, -0.5, 0.5;
  return atlas;
}

/** A body, moved, in soft tissue of 40 HU with grain of 10 HU, on voxels of 1.5 mm with `margin` mm about it. */
inline VoxelVolume
Scan(MeshArrays body, const RigidPose & pose, double margin = 25.0)
{
  for (Vector3 & x : body.points)
  {
    x = pose.Apply(x);
  }
  VoxelVolume fine = RasterizeMesh(body, 0.5, margin, 40.0, Execution());
  VoxelVolume ct = AverageBlocks(
    fine.View(), 1.5, [](double v) { return v; }, Execution());
  std::mt19937_64                 random(5);
  std::normal_distribution<float> grain(0.0F, 10.0F);
  for (float & value : ct.values)
  {
    value += grain(random);
  }
  return ct;
}

/** Far from where the atlas is, and turned by 140 degrees. */
inline RigidPose
SomePose()
{
  RigidPose pose;
  pose.rotation = Eigen::AngleAxisd(2.44, Vector3(1, -2, 0.5).normalized()).toRotationMatrix();
  pose.translation = Vector3(120, -300, 75);
  return pose;
}
} // namespace test
} // namespace bone

#endif
