/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneRadiographTestMeshes_h
#define boneRadiographTestMeshes_h

#include "boneBernstein.h"
#include "boneMeshArrays.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <random>

namespace bone
{
namespace test
{
/** Cubes of a grid of n[0] x n[1] x n[2], each cut into six tetrahedra, where `keep(i, j, k)`; region i % 3 + 1. Grid
 * vertex (i, j, k) lies at lower + (i, j, k) * step, and interior vertices are moved by up to `jitter` steps. */
inline MeshArrays
GridMesh(
  const std::array<int, 3> &                 n,
  const Vector3 &                            lower,
  const Vector3 &                            step,
  double                                     jitter = 0.0,
  const std::function<bool(int, int, int)> & keep = [](int, int, int) { return true; })
{
  constexpr int orders[6][3] = { { 0, 1, 2 }, { 1, 2, 0 }, { 2, 0, 1 }, { 0, 2, 1 }, { 2, 1, 0 }, { 1, 0, 2 } };

  std::mt19937                           random(7);
  std::uniform_real_distribution<double> move(-jitter, jitter);
  MeshArrays                             mesh;
  for (int k = 0; k <= n[2]; ++k)
  {
    for (int j = 0; j <= n[1]; ++j)
    {
      for (int i = 0; i <= n[0]; ++i)
      {
        const bool inside = i > 0 && j > 0 && k > 0 && i < n[0] && j < n[1] && k < n[2];
        Vector3    q(i, j, k);
        q += inside ? Vector3(move(random), move(random), move(random)) : Vector3(Vector3::Zero());
        mesh.points.emplace_back(lower + q.cwiseProduct(step));
      }
    }
  }
  const auto id = [&](const std::array<int, 3> & p) {
    return static_cast<IdType>((p[2] * (n[1] + 1) + p[1]) * (n[0] + 1) + p[0]);
  };
  for (int k = 0; k < n[2]; ++k)
  {
    for (int j = 0; j < n[1]; ++j)
    {
      for (int i = 0; i < n[0]; ++i)
      {
        for (int o = 0; keep(i, j, k) && o < 6; ++o)
        {
          std::array<int, 3> p{ { i, j, k } };
          Id4                tetrahedron{};
          tetrahedron[0] = id(p);
          for (int corner = 0; corner < 3; ++corner)
          {
            ++p[orders[o][corner]];
            tetrahedron[corner + 1] = id(p);
          }
          if (o >= 3)
          {
            std::swap(tetrahedron[2], tetrahedron[3]);
          }
          mesh.tetrahedra.push_back(tetrahedron);
          mesh.region.push_back(i % 3 + 1);
        }
      }
    }
  }
  RemoveUnusedPoints(mesh);
  mesh.neighbors = ComputeFaceNeighbors(mesh.tetrahedra);
  return mesh;
}

/** A ball of the given radius about the centre: a grid of n^3 cubes on [-1, 1]^3 moved so that cubes become shells. */
inline MeshArrays
BallMesh(int n, const Vector3 & centre, double radius)
{
  MeshArrays mesh = GridMesh({ { n, n, n } }, Vector3::Constant(-1), Vector3::Constant(2.0 / n));
  for (Vector3 & p : mesh.points)
  {
    const double norm = p.norm();
    p = centre + (norm > 0 ? radius * p.lpNorm<Eigen::Infinity>() / norm : 0.0) * p;
  }
  return mesh;
}

/** An affine function of space. */
struct Affine
{
  double  constant;
  Vector3 gradient;
  double
  At(const Vector3 & x) const
  {
    return constant + gradient.dot(x);
  }
};

/** Gives tetrahedron t the density "sum of the degree(t)-th powers of the functions", exactly. */
inline void
SetPowers(MeshArrays & mesh, const std::function<int(std::size_t)> & degree, const std::vector<Affine> & functions)
{
  mesh.degree.clear();
  mesh.maximumDegree = 0;
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
  {
    mesh.degree.push_back(degree(t));
    mesh.maximumDegree = std::max(mesh.maximumDegree, degree(t));
  }
  const std::size_t stride = BernsteinCount(mesh.maximumDegree);
  mesh.coefficients.assign(stride * mesh.tetrahedra.size(), 0.0);
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
  {
    const int n = mesh.degree[t];
    double *  c = mesh.coefficients.data() + t * stride;
    for (const Affine & function : functions)
    {
      int p = 0;
      for (int i = n; i >= 0; --i)
      {
        for (int j = n - i; j >= 0; --j)
        {
          for (int k = n - i - j; k >= 0; --k, ++p)
          {
            const int exponents[4] = { i, j, k, n - i - j - k };
            double    product = 1;
            for (int v = 0; v < 4; ++v)
            {
              product *= std::pow(function.At(mesh.points[mesh.tetrahedra[t][v]]), exponents[v]);
            }
            c[p] += product;
          }
        }
      }
    }
  }
}

/** Gives every tetrahedron the constant density. */
inline void
SetConstant(MeshArrays & mesh, double value)
{
  SetPowers(mesh, [](std::size_t) { return 0; }, { Affine{ value, Vector3::Zero() } });
  std::fill(mesh.coefficients.begin(), mesh.coefficients.end(), value);
}

/** Random coefficients in [0, 1] of degree 0..maximum, in turn. */
inline void
SetRandom(MeshArrays & mesh, int maximum, unsigned int seed)
{
  std::mt19937                           random(seed);
  std::uniform_real_distribution<double> value(0.0, 1.0);
  SetPowers(mesh, [maximum](std::size_t t) { return static_cast<int>(t % (maximum + 1)); }, {});
  const std::size_t stride = BernsteinCount(mesh.maximumDegree);
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
  {
    std::generate_n(
      mesh.coefficients.begin() + t * stride, BernsteinCount(mesh.degree[t]), [&]() { return value(random); });
  }
}

/** Part [first, last] of the segment from a to b (0 at a, 1 at b) within a box; first > last where it misses. */
inline std::array<double, 2>
ClipToBox(const Vector3 & a, const Vector3 & b, const Vector3 & lower, const Vector3 & upper)
{
  double first = 0, last = 1;
  for (int k = 0; k < 3; ++k)
  {
    const double d = b[k] - a[k];
    if (d == 0)
    {
      last = a[k] < lower[k] || a[k] > upper[k] ? -1 : last;
      continue;
    }
    const double u = (lower[k] - a[k]) / d, v = (upper[k] - a[k]) / d;
    first = std::max(first, std::min(u, v));
    last = std::min(last, std::max(u, v));
  }
  return { { first, last } };
}

/** Integral of the n-th power of an affine function over the segment from a to b. */
inline double
IntegratePower(const Affine & function, int n, const Vector3 & a, const Vector3 & b)
{
  const double p = function.At(a), q = function.At(b);
  double       sum = 0;
  for (int i = 0; i <= n; ++i)
  {
    sum += std::pow(p, i) * std::pow(q, n - i);
  }
  return (b - a).norm() * sum / (n + 1);
}
} // namespace test
} // namespace bone

#endif
