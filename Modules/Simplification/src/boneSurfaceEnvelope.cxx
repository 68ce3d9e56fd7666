/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSurfaceEnvelope.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace bone
{
namespace
{
using Triangle = TriangleTree::Triangle;

TriangleIds
KeyOf(IdType a, IdType b, IdType c)
{
  TriangleIds key = { a, b, c };
  std::sort(key.begin(), key.end());
  return key;
}

std::array<Triangle, 4>
Quarters(const Triangle & t)
{
  const Vector3 ab = 0.5 * (t[0] + t[1]), bc = 0.5 * (t[1] + t[2]), ca = 0.5 * (t[2] + t[0]);
  return { { { t[0], ab, ca }, { ab, t[1], bc }, { ca, bc, t[2] }, { ab, bc, ca } } };
}

Vector3
Centroid(const Triangle & t)
{
  return (t[0] + t[1] + t[2]) / 3.0;
}

double
Radius(const Triangle & t)
{
  const Vector3 centre = Centroid(t);
  return std::sqrt(
    std::max({ (t[0] - centre).squaredNorm(), (t[1] - centre).squaredNorm(), (t[2] - centre).squaredNorm() }));
}

/** Largest squared distance of a triangle's points to another triangle: convex, so at a corner. */
double
LargestSquaredDistance(const Triangle & from, const Triangle & to)
{
  double largest = 0.0;
  for (const Vector3 & x : from)
  {
    largest = std::max(largest, (ClosestPointOnTriangle(x, to[0], to[1], to[2]) - x).squaredNorm());
  }
  return largest;
}
} // namespace

SurfaceEnvelope::SurfaceEnvelope(const TetraComplex & complex)
{
  std::vector<Target> finest(complex.Surfaces().surfaces.size());
  const auto &        p = complex.Points();
  for (IdType t = 0; t < complex.Size(); ++t)
  {
    for (int i = 0; i < 4; ++i)
    {
      if (complex.IsAlive(t) && complex.Carries(t, i))
      {
        const Id4 &    c = complex.Cell(t);
        const auto &   f = TetraFaces[i];
        const int      surface = complex.FaceSurfaces(t)[i];
        const Triangle corners = { p[c[f[0]]], p[c[f[1]]], p[c[f[2]]] };
        finest[surface].triangles.push_back(corners);
        m_Pieces[KeyOf(c[f[0]], c[f[1]], c[f[2]])].push_back({ corners, surface, 0 });
      }
    }
  }
  for (Target & target : finest)
  {
    target.tree = TriangleTree(target.triangles);
  }
  m_Finest = std::make_shared<const std::vector<Target>>(std::move(finest));
}

SurfaceEnvelope::Change
SurfaceEnvelope::ChangeOf(const TetraComplex & complex, IdType v, IdType w) const
{
  Change                                 change;
  std::vector<TetraComplex::SurfaceFace> faces;
  const auto &                           p = complex.Points();
  complex.SurfaceStar(v, faces);
  for (const auto & face : faces)
  {
    change.removed.push_back(KeyOf(v, face.a, face.b));
    if (face.a != w && face.b != w)
    {
      change.created.push_back({ KeyOf(w, face.a, face.b), face.surface, { p[w], p[face.a], p[face.b] } });
    }
  }
  complex.SurfaceStar(w, faces);
  for (const auto & face : faces)
  {
    if (face.a != v && face.b != v)
    {
      change.kept.push_back({ KeyOf(w, face.a, face.b), face.surface, { p[w], p[face.a], p[face.b] } });
    }
  }
  return change;
}

bool
SurfaceEnvelope::IsNearFinest(const Target & target, const Triangle & corners, double distance, int depth) const
{
  const auto   nearest = target.tree.FindNearest(Centroid(corners));
  const double away = std::sqrt(nearest.squaredDistance);
  if (away > distance)
  {
    return false;
  }
  if (away + Radius(corners) <= distance ||
      LargestSquaredDistance(corners, target.triangles[nearest.triangle]) <= distance * distance)
  {
    return true;
  }
  if (depth == MaximumDepth)
  {
    return false;
  }
  const auto quarters = Quarters(corners);
  return std::all_of(quarters.begin(), quarters.end(), [&](const Triangle & quarter) {
    return IsNearFinest(target, quarter, distance, depth + 1);
  });
}

bool
SurfaceEnvelope::Place(const Piece &                                piece,
                       const std::vector<Face> &                    faces,
                       double                                       squared,
                       std::vector<std::pair<TriangleIds, Piece>> & placed) const
{
  double       least = std::numeric_limits<double>::max();
  const Face * best = nullptr;
  double       centre = least;
  for (const Face & face : faces)
  {
    if (face.surface == piece.surface)
    {
      const Vector3 x = Centroid(piece.corners);
      const auto &  c = face.corners;
      const double  here = (ClosestPointOnTriangle(x, c[0], c[1], c[2]) - x).squaredNorm();
      centre = std::min(centre, here);
      const double largest = here < least ? LargestSquaredDistance(piece.corners, c) : least;
      if (largest < least)
      {
        least = largest;
        best = &face;
      }
    }
  }
  if (best == nullptr)
  {
    return false;
  }
  if (least <= squared)
  {
    placed.emplace_back(best->key, piece);
    return true;
  }
  if (centre > squared || piece.depth == MaximumDepth)
  {
    return false;
  }
  for (const Triangle & quarter : Quarters(piece.corners))
  {
    if (!Place({ quarter, piece.surface, piece.depth + 1 }, faces, squared, placed))
    {
      return false;
    }
  }
  return true;
}

bool
SurfaceEnvelope::Allows(const TetraComplex & complex, IdType v, IdType w, double distance) const
{
  Change change = ChangeOf(complex, v, w);
  for (const Face & face : change.created)
  {
    if (!IsNearFinest((*m_Finest)[face.surface], face.corners, distance, 0))
    {
      return false;
    }
  }
  change.created.insert(change.created.end(), change.kept.begin(), change.kept.end());
  std::vector<std::pair<TriangleIds, Piece>> placed;
  for (const TriangleIds & key : change.removed)
  {
    const auto at = m_Pieces.find(key);
    for (std::size_t k = 0; at != m_Pieces.end() && k < at->second.size(); ++k)
    {
      if (!Place(at->second[k], change.created, distance * distance, placed))
      {
        return false;
      }
    }
  }
  return true;
}

void
SurfaceEnvelope::Commit(const TetraComplex & complex, IdType v, IdType w, double distance)
{
  Change change = ChangeOf(complex, v, w);
  change.created.insert(change.created.end(), change.kept.begin(), change.kept.end());
  std::vector<std::pair<TriangleIds, Piece>> placed;
  for (const TriangleIds & key : change.removed)
  {
    const auto at = m_Pieces.find(key);
    if (at != m_Pieces.end())
    {
      for (const Piece & piece : at->second)
      {
        Place(piece, change.created, distance * distance, placed);
      }
      m_Pieces.erase(at);
    }
  }
  for (auto & [key, piece] : placed)
  {
    m_Pieces[key].push_back(std::move(piece));
  }
}

namespace
{
/** Raises `largest` to the distance of a point of the triangle to the target, unless none is more than the tolerance
 * above it. */
void
RaiseLargest(const Triangle &              corners,
             const std::vector<Triangle> & target,
             const TriangleTree &          tree,
             double                        tolerance,
             double &                      largest)
{
  const auto   nearest = tree.FindNearest(Centroid(corners));
  const double away = std::sqrt(nearest.squaredDistance), limit = largest + tolerance;
  if (away + Radius(corners) <= limit || LargestSquaredDistance(corners, target[nearest.triangle]) <= limit * limit)
  {
    return;
  }
  largest = std::max(largest, away);
  for (const Triangle & quarter : Quarters(corners))
  {
    RaiseLargest(quarter, target, tree, tolerance, largest);
  }
}

std::vector<Triangle>
TrianglesOf(const MeshArrays & mesh, int region)
{
  std::vector<Triangle> triangles;
  for (const auto & f : BoundaryFaces(mesh, region))
  {
    triangles.push_back({ mesh.points[f[0]], mesh.points[f[1]], mesh.points[f[2]] });
  }
  return triangles;
}
} // namespace

double
LargestSurfaceDistance(const MeshArrays & first,
                       const MeshArrays & second,
                       double             tolerance,
                       const Execution &  execution)
{
  double        largest = 0.0;
  std::set<int> regions(first.region.begin(), first.region.end());
  if (regions.empty())
  {
    regions.insert(0);
  }
  for (int region : regions)
  {
    const auto         a = TrianglesOf(first, region), b = TrianglesOf(second, region);
    const TriangleTree treeA(a), treeB(b);
    for (const Triangle & t : a)
    {
      execution.ThrowIfAborted();
      RaiseLargest(t, b, treeB, tolerance, largest);
    }
    for (const Triangle & t : b)
    {
      execution.ThrowIfAborted();
      RaiseLargest(t, a, treeA, tolerance, largest);
    }
  }
  return largest;
}
} // namespace bone
