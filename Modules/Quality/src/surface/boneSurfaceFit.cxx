/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSurfaceFit.h"

#include "boneContourSamples.h"
#include "boneSurfaceBending.h"
#include "boneTriangleTree.h"

#include <array>
#include <cmath>
#include <optional>

namespace bone
{
namespace
{
/** Moves shorter than this share of the mean surface edge are not made. */
constexpr double ShortestMove = 2e-3;
/** Weight of what lies between slices, where contours are known, next to the contours themselves. */
constexpr double WeightBetweenSlices = 0.1;
/** Weight of a label's outline next to the contours, where its faces look along the slices' normal; and what is left of
 * it where they look within slices, of which contours tell more. */
constexpr double WeightOfOutline = 0.2;
constexpr double WeightWithinSlices = 0.25;

using Barycentric = std::array<double, 3>;

/** Samples of a triangle, of equal weight: three are exact for quadratic distances; next to contours one will do. */
const std::vector<Barycentric> ThreeSamples = { { 2. / 3, 1. / 6, 1. / 6 },
                                                { 1. / 6, 2. / 3, 1. / 6 },
                                                { 1. / 6, 1. / 6, 2. / 3 } };
const std::vector<Barycentric> OneSample = { { 1. / 3, 1. / 3, 1. / 3 } };

/** Distance from x along a unit normal, outward from the level, to the shape; none where the shape is far or its
 * surface lies across the normal: contours that the mesh has left out. */
std::optional<double>
ToShape(const ContourShape & shape, int level, const Vector3 & x, const Vector3 & normal)
{
  constexpr double farthest = 1.5, leastSlope = 0.3;
  const auto       value = shape.Evaluate(level, x);
  const double     slope = value ? value->gradient.dot(normal) : 0.0;
  if (!(slope > leastSlope) || std::abs(value->distance) > farthest * slope)
  {
    return std::nullopt;
  }
  return -value->distance / slope;
}

using Springs = std::vector<SurfaceBending::Spring>;

/** A triangle of a surface that is not cut flat, outward from the cell that carries it. */
struct Face
{
  TriangleIds ids;
  int         surface;
};

std::vector<Face>
FacesOf(const TetraComplex & complex)
{
  std::vector<Face> faces;
  for (IdType t = 0; t < complex.Size(); ++t)
  {
    for (int i = 0; i < 4 && complex.IsAlive(t); ++i)
    {
      const int surface = complex.Carries(t, i) ? complex.FaceSurfaces(t)[i] : -1;
      if (surface >= 0 && complex.Surfaces().surfaces[surface].flat < 0)
      {
        const Id4 & c = complex.Cell(t);
        faces.push_back({ { c[TetraFaces[i][0]], c[TetraFaces[i][1]], c[TetraFaces[i][2]] }, surface });
      }
    }
  }
  return faces;
}

double
MeanEdge(const std::vector<Face> & faces, const std::vector<Vector3> & x)
{
  double sum = 0.0;
  for (const Face & face : faces)
  {
    sum += (x[face.ids[1]] - x[face.ids[0]]).norm();
  }
  return faces.empty() ? 0.0 : sum / static_cast<double>(faces.size());
}

/** Springs from triangles to the shape between slices, or where there is none to the first surfaces. */
Springs
SpringsOfTriangles(const TetraComplex &      complex,
                   const std::vector<Face> & faces,
                   const SurfaceFitTarget &  target,
                   const Execution &         execution)
{
  const auto & x = complex.Points();
  const auto & samples = target.shape ? OneSample : ThreeSamples;
  const auto   count = samples.size();
  const double share = (target.shape ? WeightBetweenSlices : 1.0) / static_cast<double>(count);
  Springs      springs(faces.size() * count);
  execution.For(faces.size(), [&](std::size_t k) {
    const TriangleIds & f = faces[k].ids;
    const Vector3       normal = (x[f[1]] - x[f[0]]).cross(x[f[2]] - x[f[0]]);
    const double        area = normal.norm();
    // Faces look outward from the cell that carries them, that of the smaller region: into the level at interfaces.
    const auto & surface = complex.Surfaces().surfaces[faces[k].surface];
    const double sign = surface.IsBoundary() ? 1.0 : -1.0;
    const int    level = surface.IsBoundary() ? 1 : surface.inner;
    for (std::size_t s = 0; s < count; ++s)
    {
      const Barycentric &      sample = samples[s];
      const Vector3            place = sample[0] * x[f[0]] + sample[1] * x[f[1]] + sample[2] * x[f[2]];
      SurfaceBending::Spring & spring = springs[k * count + s];
      spring = { f, sample, 0.0, place };
      if (area > 0)
      {
        const auto toShape = target.shape ? ToShape(*target.shape, level, place, normal * (sign / area)) : std::nullopt;
        const double distance =
          toShape ? *toShape * sign : (target.first.Nearest(faces[k].surface, place) - place).dot(normal) / area;
        spring.weight = share * area / 2.0;
        spring.target += normal * (distance / area);
      }
    }
  });
  return springs;
}

/** Barycentric coordinates of a place on a triangle. */
Barycentric
SharesAt(const std::vector<Vector3> & x, const TriangleIds & f, const Vector3 & place)
{
  const Vector3 normal = (x[f[1]] - x[f[0]]).cross(x[f[2]] - x[f[0]]);
  Barycentric   shares{};
  for (int k = 0; k < 3; ++k)
  {
    shares[k] = (x[f[(k + 1) % 3]] - place).cross(x[f[(k + 2) % 3]] - place).dot(normal) / normal.squaredNorm();
  }
  return shares;
}

/** Springs from triangles to the points of contours that belong to them. */
void
AddContours(const TetraComplex & complex, const ContourSamples & contours, Springs & springs)
{
  for (const ContourSamples::Match & match : contours.FindMatches(complex))
  {
    const Barycentric shares = SharesAt(complex.Points(), match.triangle, match.foot);
    springs.push_back({ match.triangle, shares, match.weight, match.sample->place });
  }
}

/** Springs from triangles of the boundary to the faces of a label's outline that look the same way.
 * \param normal  of the slices of contours: most is asked of the faces about what lies between them; null: there are
 * none. */
void
AddOutline(const TetraComplex & complex,
           const LabelOutline & outline,
           const Vector3 *      normal,
           const Execution &    execution,
           Springs &            springs)
{
  constexpr double                    farthest = 1.5, leastSlope = 0.3;
  const auto &                        x = complex.Points();
  const auto                          ids = BoundaryFaces(complex);
  std::vector<TriangleTree::Triangle> triangles;
  for (const TriangleIds & f : ids)
  {
    triangles.push_back({ x[f[0]], x[f[1]], x[f[2]] });
  }
  const TriangleTree                                 tree(std::move(triangles));
  std::vector<std::optional<SurfaceBending::Spring>> found(outline.faces.size());
  const auto                                         addFace = [&](std::size_t k, int & nearest) {
    const LabelOutline::Face & face = outline.faces[k];
    const double               along = normal ? normal->dot(face.outward) : 1.0;
    if (tree.FindSquaredDistance(face.centre, nearest) > farthest * farthest || nearest < 0)
    {
      return;
    }
    const TriangleIds & f = ids[nearest];
    const double        slope = (x[f[1]] - x[f[0]]).cross(x[f[2]] - x[f[0]]).normalized().dot(face.outward);
    if (slope > leastSlope)
    {
      const double  weight = WeightWithinSlices + (1.0 - WeightWithinSlices) * along * along;
      const double  total = WeightOfOutline * weight * slope * face.area;
      const Vector3 foot = ClosestPointOnTriangle(face.centre, x[f[0]], x[f[1]], x[f[2]]);
      found[k] = SurfaceBending::Spring{ f, SharesAt(x, f, foot), total, face.centre };
    }
  };
  // Faces that follow each other lie near each other.
  constexpr std::size_t run = 256;
  execution.For((found.size() + run - 1) / run, [&](std::size_t r) {
    int nearest = -1;
    for (std::size_t k = r * run; k < std::min(found.size(), (r + 1) * run); ++k)
    {
      addFace(k, nearest);
    }
  });
  for (const auto & spring : found)
  {
    if (spring)
    {
      springs.push_back(*spring);
    }
  }
}

/** Points within surfaces: those of curves, corners and flat cuts stay. */
std::vector<char>
FreePoints(const TetraComplex & complex, const Springs & springs)
{
  std::vector<char> isFree(complex.Points().size(), 0);
  for (const auto & spring : springs)
  {
    for (IdType p : spring.points)
    {
      isFree[p] = complex.Dimension(p) == 2;
    }
  }
  return isFree;
}
} // namespace

std::size_t
FitSurfaces(TetraComplex &               complex,
            PointMover &                 mover,
            const SurfaceFitTarget &     target,
            const SurfaceFitParameters & parameters,
            const Execution &            execution)
{
  constexpr int        halvings = 3;
  std::size_t          moves = 0;
  const ContourShape * shape = target.shape;
  const auto           contours = shape ? std::make_optional<ContourSamples>(complex, *shape, execution) : std::nullopt;
  const SurfaceBending bending(complex, parameters.stiffness);
  for (int step = 0; step < parameters.steps; ++step)
  {
    const auto   faces = FacesOf(complex);
    const double shortest = ShortestMove * MeanEdge(faces, complex.Points());
    Springs      springs = SpringsOfTriangles(complex, faces, target, execution);
    if (contours)
    {
      AddContours(complex, *contours, springs);
    }
    if (target.outline)
    {
      AddOutline(complex, *target.outline, shape ? &shape->GetNormal() : nullptr, execution, springs);
    }
    const auto targets = bending.Solve(complex.Points(), FreePoints(complex, springs), springs);
    for (IdType p = 0; p < static_cast<IdType>(targets.size()); ++p)
    {
      Vector3 move = targets[p] - complex.Points()[p];
      for (int half = 0; half < halvings && move.norm() > shortest; ++half, move /= 2.0)
      {
        if (mover.TryMove(p, complex.Points()[p] + move, parameters.cosineFloor) == MeshOperation::Done)
        {
          ++moves;
          break;
        }
      }
    }
  }
  return moves;
}
} // namespace bone
