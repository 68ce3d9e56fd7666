/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "bonePointStar.h"

#include "bonePointOptimizer.h"
#include "boneQualityMeasures.h"
#include "boneTetraFlips.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>

namespace bone
{
namespace
{
constexpr int    Stages = 4;
constexpr double FirstStep = 0.2; ///< of the neighbours' mean distance
constexpr double Shrink = 0.45;
constexpr double OffSurface = 0.3; ///< length of steps along the normal, of the others'
/** Steps must gain this much, rad, so that a search ends where little is left. */
constexpr double Gain = 1e-3;
/** The nearest point's direction is the finest surface's normal where it is farther than this share of the neighbours'
 * mean distance; nearer, it would be that of rounding. */
constexpr double TooNear = 0.01;
constexpr double Nothing = -std::numeric_limits<double>::infinity();
} // namespace

PointStar::PointStar(const TetraComplex & complex, const AngleMerit & merit, IdType p)
  : m_Complex(complex)
  , m_Merit(merit)
  , m_Point(p)
  , m_Dimension(complex.Dimension(p))
  , m_Start(complex.Points()[p])
  , m_VolumeGradients(merit.Volumes().Size(), Vector3::Zero())
  , m_Changes(merit.Volumes().Size(), 0.0)
{
  const auto & points = complex.Points();
  for (IdType t : complex.Star(p))
  {
    const Id4 &  c = complex.Cell(t);
    const int    region = complex.Region(t);
    const int    at = complex.LocalIndex(t, p);
    const auto & f = TetraFaces[at];
    m_Worst = std::max(m_Worst, CellCosine(complex, t));
    m_Cells.push_back({ { points[c[0]], points[c[1]], points[c[2]], points[c[3]] }, at, region });
    m_VolumeGradients[merit.Volumes().NumberOf(region)] +=
      (points[c[f[2]]] - points[c[f[0]]]).cross(points[c[f[1]]] - points[c[f[0]]]) / 6.0;
    for (const Vector3 & corner : m_Cells.back().corners)
    {
      m_Reach += (corner - m_Start).norm() / 3.0;
    }
  }
  m_Reach /= static_cast<double>(m_Cells.size());
  if (m_Dimension < 3)
  {
    this->TakeTriangles(complex, p);
  }
}

void
PointStar::TakeTriangles(const TetraComplex & complex, IdType p)
{
  const auto &                           points = complex.Points();
  std::vector<TetraComplex::SurfaceFace> faces;
  complex.SurfaceStar(p, faces);
  for (const auto & face : faces)
  {
    Triangle triangle;
    triangle.corners = { m_Start, points[face.a], points[face.b] };
    triangle.surface = face.surface;
    m_Normal += (points[face.a] - m_Start).cross(points[face.b] - m_Start);
    m_IsFlat = m_IsFlat || complex.Surfaces().surfaces[face.surface].flat >= 0;
    this->SetPlanes(triangle);
    m_Triangles.push_back(triangle);
  }
  m_Normal.normalize();
}

void
PointStar::SetPlanes(Triangle & triangle)
{
  const auto &  c = triangle.corners;
  const Vector3 normal = (c[1] - c[0]).cross(c[2] - c[0]);
  double        squared = 0.0;
  for (int k = 0; k < 3; ++k)
  {
    const Vector3 y = FarCorner * (c[0] + c[1] + c[2]) + (NearCorner - FarCorner) * c[k];
    const Vector3 nearest = m_Merit.Finest().Nearest(triangle.surface, y);
    const Vector3 away = y - nearest;
    triangle.normals[k] = away.norm() > TooNear * m_Reach ? Vector3(away.normalized()) : Vector3(normal.normalized());
    triangle.offsets[k] = triangle.normals[k].dot(nearest);
    squared += away.squaredNorm() / 3.0;
  }
  m_TrianglesAtStart += m_Merit.OfDistance(0.5 * normal.norm() * squared);
}

std::vector<Vector3>
PointStar::Directions() const
{
  std::vector<Vector3> directions;
  if (m_Dimension == 3)
  {
    return SearchDirections();
  }
  if (m_Dimension == 2)
  {
    const Vector3 u = m_Normal.unitOrthogonal(), v = m_Normal.cross(u);
    constexpr int around = 8;
    for (int k = 0; k < around; ++k)
    {
      const double angle = 2 * 3.14159265358979323846 * k / around;
      directions.push_back(std::cos(angle) * u + std::sin(angle) * v);
    }
    if (!m_IsFlat)
    {
      directions.push_back(OffSurface * m_Normal);
      directions.push_back(-OffSurface * m_Normal);
    }
  }
  else if (m_Dimension == 1)
  {
    const auto & curve = m_Complex.Surfaces().curve[m_Point];
    for (IdType q : curve)
    {
      directions.push_back((m_Complex.Points()[q] - m_Start).normalized());
    }
  }
  return directions;
}

PointStar::Move
PointStar::FindMove()
{
  const std::vector<Vector3> directions = this->Directions();
  double                     step = FirstStep * m_Reach, best = this->About(m_Start, Nothing);
  Vector3                    place = m_Start;
  for (int stage = 0; stage < Stages; ++stage, step *= Shrink)
  {
    const Vector3 from = place;
    for (const Vector3 & direction : directions)
    {
      Vector3 x = from + step * direction;
      if (m_Dimension == 1)
      {
        x = m_Merit.Finest().Project(m_Complex, m_Point, x);
      }
      const double merit = this->About(x, best + Gain);
      if (merit > best + Gain)
      {
        best = merit;
        place = x;
      }
    }
  }
  Move move{ place, 0.0, this->VolumeChanges(place) };
  if (place != m_Start)
  {
    move.gain =
      this->OfCells(place, Nothing) - this->OfCells(m_Start, Nothing) + this->OfTriangles(place) - m_TrianglesAtStart;
  }
  return move;
}

const std::vector<double> &
PointStar::VolumeChanges(const Vector3 & x)
{
  for (std::size_t r = 0; r < m_Changes.size(); ++r)
  {
    m_Changes[r] = m_VolumeGradients[r].dot(x - m_Start);
  }
  return m_Changes;
}

double
PointStar::OfCells(const Vector3 & x, double least)
{
  double merit = 0.0, left = AngleMerit::LargestOfCell() * static_cast<double>(m_Cells.size());
  for (Cell & cell : m_Cells)
  {
    auto & c = cell.corners;
    c[cell.at] = x;
    if (!(SignedVolume(c[0], c[1], c[2], c[3]) > 0))
    {
      return Nothing;
    }
    const double cosine = LargestDihedralCosine(c[0], c[1], c[2], c[3]);
    if (cosine > m_Merit.LargestCosine(cell.region, m_Worst))
    {
      return Nothing;
    }
    merit += m_Merit.OfCell(cosine, cell.region);
    left -= AngleMerit::LargestOfCell();
    if (!(merit + left > least))
    {
      return Nothing;
    }
  }
  return merit;
}

double
PointStar::About(const Vector3 & x, double least)
{
  double merit = m_Dimension == 3 ? 0.0 : m_Merit.OfVolumes(this->VolumeChanges(x));
  for (Triangle & triangle : m_Triangles)
  {
    auto & c = triangle.corners;
    c[0] = x;
    const double area = 0.5 * (c[1] - c[0]).cross(c[2] - c[0]).norm();
    double       squared = 0.0;
    for (int k = 0; k < 3; ++k)
    {
      const Vector3 y = FarCorner * (c[0] + c[1] + c[2]) + (NearCorner - FarCorner) * c[k];
      const double  distance = triangle.normals[k].dot(y) - triangle.offsets[k];
      squared += distance * distance / 3.0;
    }
    merit += m_Merit.OfDistance(area * squared);
  }
  return merit + this->OfCells(x, least - merit);
}

double
PointStar::OfTriangles(const Vector3 & x)
{
  double merit = 0.0;
  for (Triangle & triangle : m_Triangles)
  {
    triangle.corners[0] = x;
    merit += m_Merit.OfTriangle(triangle.surface, triangle.corners);
  }
  return merit;
}
} // namespace bone
