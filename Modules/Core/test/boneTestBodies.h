/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneTestBodies_h
#define boneTestBodies_h

#include "boneBernstein.h"
#include "boneMeshArrays.h"
#include "bonePredicates.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

/** Layered bodies for tests: simple in topology, irregular in shape. */
namespace bone::test
{
struct TubeShape
{
  int              slices{ 12 };
  int              around{ 16 };
  std::vector<int> rings{ 1, 2, 2 }; ///< rings of cells of each region, from the surface inward
  double           radius{ 12.0 };
  double           spacing{ 2.0 };
  double           bend{ 3.0 };  ///< mm of sideways bow
  double           bumps{ 0.0 }; ///< mm by which slices differ at random, as segmentations do
  double   jitter{ 0.2 };        ///< of the local spacing, on all points but those of flat ends, which keep their plane
  bool     closed{ false };      ///< a ring (torus) in place of a rod
  unsigned seed{ 1 };
};

inline void
MakePositive(MeshArrays & mesh)
{
  for (Id4 & t : mesh.tetrahedra)
  {
    if (Orient3D(mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]], mesh.points[t[3]]) < 0)
    {
      std::swap(t[2], t[3]);
    }
  }
  mesh.neighbors = ComputeFaceNeighbors(mesh.tetrahedra);
}

/** Gives every cell the Bernstein approximant of f; exact where f is linear. */
inline void
SetDensity(MeshArrays & mesh, int degree, const std::function<double(const Vector3 &)> & f)
{
  mesh.maximumDegree = degree;
  mesh.quantity = DensityQuantity::HounsfieldUnit;
  mesh.degree.assign(mesh.tetrahedra.size(), degree);
  mesh.coefficients.clear();
  for (const Id4 & t : mesh.tetrahedra)
  {
    for (int i = degree; i >= 0; --i)
    {
      for (int j = degree - i; j >= 0; --j)
      {
        for (int k = degree - i - j; k >= 0; --k)
        {
          const int     l = degree - i - j - k;
          const Vector3 sum =
            i * mesh.points[t[0]] + j * mesh.points[t[1]] + k * mesh.points[t[2]] + l * mesh.points[t[3]];
          const Vector3 mean = (mesh.points[t[0]] + mesh.points[t[1]] + mesh.points[t[2]] + mesh.points[t[3]]) / 4;
          mesh.coefficients.push_back(f(degree > 0 ? Vector3(sum / degree) : mean));
        }
      }
    }
  }
}

/** A bent rod with flat ends, or a ring; valid for jitter up to about 0.25. */
inline MeshArrays
MakeTube(const TubeShape & shape)
{
  std::mt19937                           random(shape.seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const auto                             next = [&]() { return uniform(random); };
  int                                    total = 0;
  for (int r : shape.rings)
  {
    total += r;
  }
  const int    n = shape.around, perSlice = 1 + n * total;
  const double pi = std::acos(-1.0), dr = shape.radius / (total + 0.5);
  const double bigRadius = shape.closed ? shape.slices * shape.spacing / (2 * pi) : 0.0;
  MeshArrays   mesh;
  for (int s = 0; s < shape.slices; ++s)
  {
    const double bump = shape.bumps * next();
    const bool   end = !shape.closed && (s == 0 || s == shape.slices - 1);
    const auto   place = [&](double x, double y, double z) {
      const double along = (s + z) / shape.slices;
      if (shape.closed)
      {
        const double a = 2 * pi * along;
        return Vector3((bigRadius + x) * std::cos(a), (bigRadius + x) * std::sin(a), y);
      }
      return Vector3(x + shape.bend * std::sin(pi * along), y, (s + z) * shape.spacing);
    };
    const double jz = end ? 0.0 : shape.jitter;
    mesh.points.push_back(place(shape.jitter * dr * next(), shape.jitter * dr * next(), jz * next()));
    mesh.layer.push_back(static_cast<int>(shape.rings.size()));
    for (int k = 0; k < total; ++k)
    {
      // Ring 0 is the outermost; layers count the regions outside it.
      int layer = 0;
      for (int done = 0, i = 0; i < static_cast<int>(shape.rings.size()); ++i)
      {
        done += shape.rings[i];
        layer += k >= done;
      }
      for (int i = 0; i < n; ++i)
      {
        const double radius = shape.radius - dr * (k + 0.4 * shape.jitter * next()) + bump * (1.0 - double(k) / total);
        const double angle = 2 * pi * (i + 0.4 * shape.jitter * next()) / n;
        mesh.points.push_back(place(radius * std::cos(angle), radius * std::sin(angle), 0.4 * jz * next()));
        mesh.layer.push_back(layer);
      }
    }
    mesh.slice.insert(mesh.slice.end(), perSlice, s);
  }

  struct Triangle
  {
    std::array<IdType, 3> v;
    int                   region;
  };
  std::vector<Triangle> triangles;
  const auto            ring = [&](int k, int i) { return static_cast<IdType>(1 + n * k + i % n); };
  for (int k = 0; k < total; ++k)
  {
    int region = 1;
    for (int done = shape.rings[0]; k >= done; ++region)
    {
      done += shape.rings[region];
    }
    for (int i = 0; i < n; ++i)
    {
      if (k == total - 1)
      {
        triangles.push_back({ { 0, ring(k, i), ring(k, i + 1) }, region });
      }
      else
      {
        triangles.push_back({ { ring(k, i), ring(k, i + 1), ring(k + 1, i) }, region });
        triangles.push_back({ { ring(k, i + 1), ring(k + 1, i + 1), ring(k + 1, i) }, region });
      }
    }
  }
  const int slabs = shape.closed ? shape.slices : shape.slices - 1;
  for (int s = 0; s < slabs; ++s)
  {
    const IdType lower = s * perSlice, upper = (s + 1) % shape.slices * perSlice;
    for (Triangle t : triangles)
    {
      std::sort(t.v.begin(), t.v.end());
      const auto [a, b, c] = t.v;
      mesh.tetrahedra.push_back({ lower + a, lower + b, lower + c, upper + c });
      mesh.tetrahedra.push_back({ lower + a, lower + b, upper + b, upper + c });
      mesh.tetrahedra.push_back({ lower + a, upper + a, upper + b, upper + c });
      mesh.region.insert(mesh.region.end(), 3, t.region);
    }
  }
  MakePositive(mesh);
  return mesh;
}

/** A ball of concentric layers, 2n cells across, without flat ends; regions by shell, the outermost first. */
inline MeshArrays
MakeBall(int n, const std::vector<int> & shells, double radius, double jitter, unsigned seed)
{
  std::mt19937                           random(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const int                              m = 2 * n + 1;
  MeshArrays                             mesh;
  for (int k = 0; k < m; ++k)
  {
    for (int j = 0; j < m; ++j)
    {
      for (int i = 0; i < m; ++i)
      {
        const Vector3 x = Vector3(i - n, j - n, k - n) / n;
        const double  largest = x.cwiseAbs().maxCoeff();
        Vector3       p = largest > 0 ? Vector3(x * (largest / x.norm()) * radius) : Vector3(Vector3::Zero());
        const Vector3 shift = jitter * radius / n * Vector3(uniform(random), uniform(random), uniform(random));
        p += largest < 1 ? shift : Vector3(0.3 * shift.dot(p) / p.squaredNorm() * p);
        mesh.points.push_back(p);
        int layer = 0;
        for (int done = 0, r = 0; r < static_cast<int>(shells.size()); ++r)
        {
          done += shells[r];
          layer += std::lround((1 - largest) * n) >= done;
        }
        mesh.layer.push_back(layer);
      }
    }
  }
  const auto id = [m](int i, int j, int k) { return static_cast<IdType>((k * m + j) * m + i); };
  const std::array<std::array<int, 3>, 6> orders = {
    { { 0, 1, 2 }, { 1, 2, 0 }, { 2, 0, 1 }, { 0, 2, 1 }, { 1, 0, 2 }, { 2, 1, 0 } }
  };
  for (int k = 0; k + 1 < m; ++k)
  {
    for (int j = 0; j + 1 < m; ++j)
    {
      for (int i = 0; i + 1 < m; ++i)
      {
        const int shell = std::min({ i, j, k, m - 2 - i, m - 2 - j, m - 2 - k });
        int       region = 1;
        for (int done = shells[0]; shell >= done && region < static_cast<int>(shells.size()); ++region)
        {
          done += shells[region];
        }
        // Diagonals point away from the middle in every octant, so that the layers' surfaces are alike.
        const std::array<int, 3> at = { i, j, k };
        for (const auto & order : orders)
        {
          std::array<int, 3> corner;
          std::array<int, 3> step;
          for (int a = 0; a < 3; ++a)
          {
            step[a] = at[a] >= n ? 1 : -1;
            corner[a] = at[a] >= n ? at[a] : at[a] + 1;
          }
          Id4 t;
          t[0] = id(corner[0], corner[1], corner[2]);
          for (int a = 0; a < 3; ++a)
          {
            corner[order[a]] += step[order[a]];
            t[a + 1] = id(corner[0], corner[1], corner[2]);
          }
          mesh.tetrahedra.push_back(t);
          mesh.region.push_back(region);
        }
      }
    }
  }
  MakePositive(mesh);
  return mesh;
}

/** Volume of the cells of a region, mm^3. */
inline double
RegionVolume(const MeshArrays & mesh, int region)
{
  double sum = 0.0;
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
  {
    const Id4 & v = mesh.tetrahedra[t];
    sum += mesh.region[t] == region
             ? SignedVolume(mesh.points[v[0]], mesh.points[v[1]], mesh.points[v[2]], mesh.points[v[3]])
             : 0.0;
  }
  return sum;
}
} // namespace bone::test

#endif
