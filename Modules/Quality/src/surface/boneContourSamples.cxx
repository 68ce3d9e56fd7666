/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneContourSamples.h"

#include <optional>

namespace bone
{
namespace
{
constexpr double SamplesPerTriangle = 4.0;
/** mm, of a point from its triangle. */
constexpr double Farthest = 1.5;
/** Cosine of the angle between the contour's normal and the triangle's. */
constexpr double LeastSlope = 0.1;

/** A triangle of the surface of a body. */
struct LevelTriangle
{
  TriangleIds ids;
  double      sign; ///< 1 where it looks out of the body
};

std::vector<LevelTriangle>
TrianglesOf(const TetraComplex & complex, int level)
{
  std::vector<LevelTriangle> triangles;
  for (IdType t = 0; t < complex.Size(); ++t)
  {
    for (int i = 0; i < 4 && complex.IsAlive(t); ++i)
    {
      if (!complex.Carries(t, i))
      {
        continue;
      }
      const auto & surface = complex.Surfaces().surfaces[complex.FaceSurfaces(t)[i]];
      if (surface.flat < 0 && surface.outer < level && level <= surface.inner)
      {
        const Id4 & c = complex.Cell(t);
        triangles.push_back(
          { { c[TetraFaces[i][0]], c[TetraFaces[i][1]], c[TetraFaces[i][2]] }, surface.IsBoundary() ? 1.0 : -1.0 });
      }
    }
  }
  return triangles;
}
} // namespace

ContourSamples::ContourSamples(const TetraComplex & complex, const ContourShape & shape, const Execution & execution)
  : m_Execution(execution)
{
  for (int level = 1; level <= shape.GetLevels(); ++level)
  {
    const double wanted = SamplesPerTriangle * static_cast<double>(TrianglesOf(complex, level).size());
    m_Levels.emplace_back();
    if (wanted > 0)
    {
      m_Levels.back() = shape.SampleContours(level, shape.GetContourLength(level) / wanted);
    }
  }
}

std::vector<ContourSamples::Match>
ContourSamples::FindMatches(const TetraComplex & complex) const
{
  const auto &       points = complex.Points();
  std::vector<Match> matches;
  for (std::size_t k = 0; k < m_Levels.size(); ++k)
  {
    const auto                          faces = TrianglesOf(complex, static_cast<int>(k) + 1);
    std::vector<TriangleTree::Triangle> triangles;
    for (const LevelTriangle & face : faces)
    {
      triangles.push_back({ points[face.ids[0]], points[face.ids[1]], points[face.ids[2]] });
    }
    const TriangleTree                tree(std::move(triangles));
    std::vector<std::optional<Match>> found(m_Levels[k].size());
    m_Execution.For(found.size(), [&](std::size_t s) {
      const ContourShape::Sample & sample = m_Levels[k][s];
      const auto                   nearest = tree.FindNearest(sample.place);
      if (nearest.triangle < 0 || nearest.squaredDistance > Farthest * Farthest)
      {
        return;
      }
      const LevelTriangle & face = faces[nearest.triangle];
      const auto &          x = tree.GetTriangle(nearest.triangle);
      const Vector3         normal = (x[1] - x[0]).cross(x[2] - x[0]).normalized();
      const double          slope = face.sign * normal.dot(sample.outward);
      if (slope > LeastSlope)
      {
        found[s] = Match{ &sample, face.ids, nearest.point, normal, sample.weight / (slope * slope) };
      }
    });
    for (const auto & match : found)
    {
      if (match)
      {
        matches.push_back(*match);
      }
    }
  }
  return matches;
}
} // namespace bone
