/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneInvertedCellRepair.h"

#include "bonePredicates.h"
#include "boneSurfaceTarget.h"

#include <algorithm>
#include <limits>

namespace bone
{
namespace
{
constexpr int MaximumPasses = 50;

std::vector<IdType>
BadCells(const TetraComplex & complex)
{
  std::vector<IdType> bad;
  const auto &        p = complex.Points();
  for (IdType t = 0; t < complex.Size(); ++t)
  {
    const Id4 & c = complex.Cell(t);
    if (complex.IsAlive(t) && Orient3D(p[c[0]], p[c[1]], p[c[2]], p[c[3]]) <= 0)
    {
      bad.push_back(t);
    }
  }
  return bad;
}

class PointUntangler
{
public:
  explicit PointUntangler(TetraComplex & complex)
    : m_Complex(complex)
    , m_Target(complex, 0.0, 0)
  {}

  bool
  MayMove(IdType p) const
  {
    if (m_Complex.Dimension(p) == 3)
    {
      return true;
    }
    std::vector<TetraComplex::SurfaceFace> faces;
    m_Complex.SurfaceStar(p, faces);
    return m_Complex.Dimension(p) == 2 && !m_Complex.Surfaces().surfaces[faces.front().surface].IsBoundary();
  }

  /** Whether the smallest volume around the point has grown. */
  bool
  Improve(IdType p)
  {
    constexpr int    stages = 12;
    constexpr double shrink = 0.5, gain = 1e-3;
    const Vector3    start = m_Complex.Points()[p];
    double           step = 0.0;
    for (IdType q : m_Complex.PointNeighbors(p))
    {
      step = std::max(step, 0.5 * (m_Complex.Points()[q] - start).norm());
    }
    const double before = LeastVolume(p);
    const double scale = step * step * step;
    double       best = before;
    for (int stage = 0; stage < stages; step *= shrink, ++stage)
    {
      for (bool moved = true; moved;)
      {
        moved = false;
        const Vector3 centre = m_Complex.Points()[p];
        Vector3       place = centre;
        for (int d = 0; d < 6; ++d)
        {
          Vector3 x = centre;
          x[d / 2] += d % 2 == 0 ? step : -step;
          m_Complex.TryPoint(p, m_Target.Project(m_Complex, p, x));
          const double volume = LeastVolume(p);
          if (volume > best + gain * gain * scale)
          {
            best = volume;
            place = m_Complex.Points()[p];
            moved = true;
          }
        }
        m_Complex.MovePoint(p, place);
      }
    }
    return best > before;
  }

private:
  double
  LeastVolume(IdType p) const
  {
    const auto & x = m_Complex.Points();
    double       least = std::numeric_limits<double>::max();
    for (IdType t : m_Complex.Star(p))
    {
      const Id4 & c = m_Complex.Cell(t);
      least = std::min(least, SignedVolume(x[c[0]], x[c[1]], x[c[2]], x[c[3]]));
    }
    return least;
  }

  TetraComplex & m_Complex;
  SurfaceTarget  m_Target;
};
} // namespace

std::size_t
RepairInvertedCells(TetraComplex & complex)
{
  std::vector<IdType> bad = BadCells(complex);
  PointUntangler      untangler(complex);
  for (int pass = 0; pass < MaximumPasses && !bad.empty(); ++pass)
  {
    bool moved = false;
    for (IdType t : bad)
    {
      for (IdType p : complex.Cell(t))
      {
        moved = (untangler.MayMove(p) && untangler.Improve(p)) || moved;
      }
    }
    bad = BadCells(complex);
    if (!moved)
    {
      break;
    }
  }
  return bad.size();
}
} // namespace bone
