/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneTestMeshes_h
#define boneTestMeshes_h

#include "boneBernstein.h"
#include "boneMeshArrays.h"

#include <cstdint>
#include <random>

namespace bone
{
/** A box of two by one by one cubes in twelve tetrahedra, in general position, with every attribute; tetrahedron t has
 * degree degrees[t mod #degrees] and random coefficients. */
inline MeshArrays
DensityBox(const std::vector<int> & degrees)
{
  MeshArrays mesh;
  for (int p = 0; p < 12; ++p)
  {
    const int i = p % 3, j = p / 3 % 2, k = p / 6;
    mesh.points.emplace_back(0.1 + 1.3 * i + 0.2 * j, -7.0 / 3.0 + j + 0.1 * k, 1e3 + k / 3.0);
    mesh.layer.push_back(i == 1 ? 1 : 0);
    mesh.slice.push_back(k);
  }
  // Kuhn's six tetrahedra around the cube's diagonal, bits of a corner: x 1, y 2, z 4.
  constexpr int kuhn[6][4] = { { 0, 1, 3, 7 }, { 0, 3, 2, 7 }, { 0, 2, 6, 7 },
                               { 0, 6, 4, 7 }, { 0, 4, 5, 7 }, { 0, 5, 1, 7 } };
  for (int cube = 0; cube < 2; ++cube)
  {
    for (const auto & corners : kuhn)
    {
      Id4 tetra;
      for (int i = 0; i < 4; ++i)
      {
        tetra[i] = cube + (corners[i] & 1) + 3 * (corners[i] >> 1 & 1) + 6 * (corners[i] >> 2 & 1);
      }
      mesh.tetrahedra.push_back(tetra);
      mesh.region.push_back(1 + cube);
    }
  }
  mesh.neighbors = ComputeFaceNeighbors(mesh.tetrahedra);
  if (degrees.empty())
  {
    return mesh;
  }
  std::mt19937                           random(3);
  std::uniform_real_distribution<double> hounsfield(-200, 1800);
  for (int degree : degrees)
  {
    mesh.maximumDegree = std::max(mesh.maximumDegree, degree);
  }
  const int width = BernsteinCount(mesh.maximumDegree);
  mesh.coefficients.assign(mesh.tetrahedra.size() * width, 0.0);
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
  {
    mesh.degree.push_back(degrees[t % degrees.size()]);
    for (int k = 0; k < BernsteinCount(mesh.degree[t]); ++k)
    {
      mesh.coefficients[t * width + k] = hounsfield(random);
    }
  }
  mesh.quantity = DensityQuantity::HounsfieldUnit;
  return mesh;
}
} // namespace bone

#endif
