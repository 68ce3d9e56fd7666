/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSurfaceFit.h"

#include "boneContourSamples.h"
#include "boneSurfaceBending.h"

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

/** Springs from triangles to the shape between slices, or where there is none to the first surfaces.
 * \param edge  the mean length of the triangles' edges. */
Springs
SpringsOfTriangles(const TetraComplex &  complex,
                   const SurfaceTarget & target,
                   const ContourShape *  shape,
                   double &              edge)
{
  const auto & x = complex.Points();
  Springs      springs;
  const auto & samples = shape ? OneSample : ThreeSamples;
  const double share = (shape ? WeightBetweenSlices : 1.0) / static_cast<double>(samples.size());
  double       edges = 0.0;
  std::size_t  count = 0;
  for (IdType t = 0; t < complex.Size(); ++t)
  {
    for (int i = 0; i < 4 && complex.IsAlive(t); ++i)
    {
      const int surface = complex.Carries(t, i) ? complex.FaceSurfaces(t)[i] : -1;
      if (surface < 0 || complex.Surfaces().surfaces[surface].flat >= 0)
      {
        continue;
      }
      const Id4 &       c = complex.Cell(t);
      const TriangleIds f = { c[TetraFaces[i][0]], c[TetraFaces[i][1]], c[TetraFaces[i][2]] };
      const Vector3     normal = (x[f[1]] - x[f[0]]).cross(x[f[2]] - x[f[0]]);
      const double      area = normal.norm();
      if (!(area > 0))
      {
        continue;
      }
      // Faces look outward from the cell that carries them, that of the smaller region: into the level at interfaces.
      const bool   boundary = complex.Surfaces().surfaces[surface].IsBoundary();
      const double sign = boundary ? 1.0 : -1.0;
      const int    level = boundary ? 1 : complex.Surfaces().surfaces[surface].inner;
      edges += (x[f[1]] - x[f[0]]).norm();
      ++count;
      for (const Barycentric & sample : samples)
      {
        const Vector3 place = sample[0] * x[f[0]] + sample[1] * x[f[1]] + sample[2] * x[f[2]];
        const auto    toShape = shape ? ToShape(*shape, level, place, normal * (sign / area)) : std::nullopt;
        const double distance = toShape ? *toShape * sign : (target.Nearest(surface, place) - place).dot(normal) / area;
        springs.push_back({ f, sample, share * area / 2.0, place + normal * (distance / area) });
      }
    }
  }
  edge = count > 0 ? edges / static_cast<double>(count) : 0.0;
  return springs;
}

/** Springs from triangles to the points of contours that belong to them. */
void
AddContours(const TetraComplex & complex, const ContourSamples & contours, Springs & springs)
{
  const auto & x = complex.Points();
  for (const ContourSamples::Match & match : contours.FindMatches(complex))
  {
    const TriangleIds & f = match.triangle;
    const double        area = (x[f[1]] - x[f[0]]).cross(x[f[2]] - x[f[0]]).dot(match.normal);
    Barycentric         shares{};
    for (int k = 0; k < 3; ++k)
    {
      const Vector3 &a = x[f[(k + 1) % 3]], &b = x[f[(k + 2) % 3]];
      shares[k] = (a - match.foot).cross(b - match.foot).dot(match.normal) / area;
    }
    springs.push_back({ f, shares, match.weight, match.sample->place });
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
            const SurfaceTarget &        first,
            const ContourShape *         shape,
            const SurfaceFitParameters & parameters)
{
  constexpr int        halvings = 3;
  std::size_t          moves = 0;
  const auto           contours = shape ? std::make_optional<ContourSamples>(complex, *shape) : std::nullopt;
  const SurfaceBending bending(complex, parameters.stiffness);
  for (int step = 0; step < parameters.steps; ++step)
  {
    double  edge = 0.0;
    Springs springs = SpringsOfTriangles(complex, first, shape, edge);
    if (contours)
    {
      AddContours(complex, *contours, springs);
    }
    const auto targets = bending.Solve(complex.Points(), FreePoints(complex, springs), springs);
    for (IdType p = 0; p < static_cast<IdType>(targets.size()); ++p)
    {
      Vector3 move = targets[p] - complex.Points()[p];
      for (int half = 0; half < halvings && move.norm() > ShortestMove * edge; ++half, move /= 2.0)
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
