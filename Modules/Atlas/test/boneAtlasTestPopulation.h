/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneAtlasTestPopulation_h
#define boneAtlasTestPopulation_h

#include "bonePointAlignment.h"
#include "boneTestBodies.h"
#include "boneTrainingSet.h"

#include <random>

/** Small populations of layered bodies with known modes of variation. */
namespace bone::test
{
/** A layered tube whose length, girth and bend, and, apart from them, three patterns of density vary at random. */
inline MeshArrays
MakeSubject(unsigned seed, int degree = 2)
{
  TubeShape shape;
  shape.slices = 6;
  shape.around = 8;
  MeshArrays                       mesh = MakeTube(shape);
  std::mt19937                     generator(seed);
  std::normal_distribution<double> normal;
  double                           f[6];
  for (double & x : f)
  {
    x = normal(generator);
  }
  if (degree >= 0)
  {
    SetDensity(mesh, degree, [&f](const Vector3 & x) {
      return 500 + 60 * f[3] + 4 * f[4] * x[2] + 30 * f[5] * std::sin(0.4 * x[0]);
    });
  }
  for (Vector3 & x : mesh.points)
  {
    x[2] *= 1 + 0.08 * f[0];
    x.head<2>() *= 1 + 0.05 * f[1];
    x[0] += 0.01 * f[2] * x[2] * x[2];
    for (int i = 0; i < 3; ++i)
    {
      x[i] += 0.01 * normal(generator);
    }
  }
  return mesh;
}

inline AffineMap
RandomPose(unsigned seed)
{
  std::mt19937                     generator(seed);
  std::normal_distribution<double> normal;
  Eigen::Quaterniond               q(normal(generator), normal(generator), normal(generator), normal(generator));
  AffineMap                        pose;
  pose.linear = q.normalized().toRotationMatrix();
  pose.translation = 50 * Vector3(normal(generator), normal(generator), normal(generator));
  return pose;
}

inline void
Move(const AffineMap & map, std::vector<Vector3> & points)
{
  for (Vector3 & x : points)
  {
    x = map(x);
  }
}

inline MeshTrainingSet<>::Pointer
MakeSet(const std::vector<MeshArrays> & subjects)
{
  auto set = MeshTrainingSet<>::New();
  for (std::size_t i = 0; i < subjects.size(); ++i)
  {
    auto mesh = DensityMesh<double>::New();
    mesh->SetArrays(subjects[i]);
    set->AddSubject("subject " + std::to_string(i), mesh);
  }
  return set;
}

inline std::vector<MeshArrays>
MakePopulation(unsigned count, int degree = 2)
{
  std::vector<MeshArrays> subjects;
  for (unsigned seed = 1; seed <= count; ++seed)
  {
    subjects.push_back(MakeSubject(seed, degree));
  }
  return subjects;
}
} // namespace bone::test

#endif
