/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCorticalThickness.h"

#include "boneSurfaceBand.h"
#include "boneSurfaceComplex.h"
#include "boneSurfaceGrid.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <stdexcept>

namespace bone
{
namespace
{
constexpr double      FullWidth = 2.3548200450309493; // standard deviations: full width at half maximum
constexpr double      ThickCortex = 5.0;              // standard deviations: density and blur can be told apart
constexpr std::size_t LeastThick = 20;                // points with thick cortex that an estimate needs
constexpr double      CorticalShare = 0.75; // of the 90 percentile of thick layers' densities: less is no cortex
constexpr double      OutsideReach = 3.0;   // mm
constexpr double      LeastBlur = 0.1;      // largest spacings
constexpr double      OutlierSpreads = 3.0; // spreads of the neighbours from their median
constexpr double      LeastSpread = 0.15;   // mm: less is none
const double          NotANumber = std::numeric_limits<double>::quiet_NaN();

double
Median(std::vector<double> values)
{
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

using Neighbours = std::vector<std::vector<IdType>>;

Neighbours
FindNeighbours(const TriangleSurface & surface)
{
  Neighbours neighbours(surface.points.size());
  for (const auto & triangle : surface.triangles)
  {
    for (int i = 0; i < 3; ++i)
    {
      neighbours[static_cast<std::size_t>(triangle[i])].push_back(triangle[(i + 1) % 3]);
    }
  }
  return neighbours;
}

/** Whether each triangle of the exterior surface is part of a flat cut, in the order of ExteriorSurface. */
std::vector<bool>
FindCuts(const MeshArrays & mesh)
{
  const SurfaceComplex            complex = FindSurfaces(mesh);
  std::set<std::array<IdType, 3>> flat;
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
  {
    for (int i = 0; i < 4; ++i)
    {
      const IdType surface = complex.faceSurface[t][i];
      if (surface >= 0 && complex.surfaces[static_cast<std::size_t>(surface)].flat >= 0)
      {
        const Id4 & c = mesh.tetrahedra[t];
        flat.insert(Ascending({ c[TetraFaces[i][0]], c[TetraFaces[i][1]], c[TetraFaces[i][2]] }));
      }
    }
  }
  std::vector<bool> cut;
  for (const auto & face : BoundaryFaces(mesh))
  {
    cut.push_back(flat.count(Ascending(face)) > 0);
  }
  return cut;
}

/** The fits at all points of a surface, and what they tell of the image. */
class ThicknessMapper
{
public:
  ThicknessMapper(const MeshArrays &                  mesh,
                  const CTVoxels &                    ct,
                  const CorticalThicknessParameters & parameters,
                  const Execution &                   execution)
    : m_Parameters(parameters)
    , m_Execution(execution)
  {
    const Vector3 spacing = ct.grid.axes.colwise().norm();
    int           across = 2;
    spacing.maxCoeff(&across);
    across = spacing[across] > spacing[2] * (1.0 + 1e-6) ? across : 2;
    m_Spacing = spacing[across];
    m_OtherSpacing = (spacing.sum() - m_Spacing) / 2.0;
    m_Map.surface = ExteriorSurface(mesh, m_Map.pointId);
    m_Map.blur.axis = ct.grid.axes.col(across).normalized();
    m_Normals = PointNormals(m_Map.surface);
    const double      radius = std::max(parameters.radius, 1.5 * m_Spacing);
    const SurfaceBand band(
      m_Map.surface, FindCuts(mesh), ct, OutsideReach, parameters.depth, radius, execution.Part(0.0, 0.5));
    m_Samples.resize(m_Map.surface.points.size());
    execution.Silent().For(
      m_Samples.size(),
      [&](std::size_t p) { m_Samples[p] = band.Collect(m_Map.surface.points[p], -m_Normals[p]); },
      64);
  }

  CorticalThicknessMap
  Run()
  {
    const auto free = this->FitAll(0.5, [](std::size_t, CorticalFitRules &) {});
    const auto thick = this->FindThick(free);
    m_Map.thickPoints = thick.size();
    this->EstimateBlur(free, thick);
    std::vector<char> dense(free.size(), 0);
    for (const std::size_t p : thick)
    {
      dense[p] = 1;
    }
    const bool given = m_Parameters.corticalDensity > 0.0;
    m_Map.corticalDensity = given ? m_Parameters.corticalDensity : this->MedianDensity(free, thick);
    const auto fits = this->FitAll(0.75, [&](std::size_t p, CorticalFitRules & rules) {
      rules.blur = m_Map.blur.Along(m_Normals[p]);
      if (dense[p] == 0 || !IsThick(free[p], rules.blur))
      {
        rules.cortical = m_Map.corticalDensity;
      }
    });
    this->Take(fits);
    this->Smooth();
    return std::move(m_Map);
  }

private:
  template <typename TSetRules>
  std::vector<CorticalFit>
  FitAll(double from, TSetRules && setRules) const
  {
    std::vector<CorticalFit> fits(m_Samples.size());
    m_Execution.Part(from, from + 0.25)
      .For(
        fits.size(),
        [&](std::size_t p) {
          CorticalFitRules rules;
          rules.pixel = m_Spacing;
          rules.outsideReach = OutsideReach;
          setRules(p, rules);
          fits[p] = FitCortex(m_Samples[p], rules);
        },
        16);
    return fits;
  }

  static bool
  IsThick(const CorticalFit & fit, double blur)
  {
    return fit.status == CorticalStatus::Found && fit.cortex.thickness > ThickCortex * std::max(blur, fit.cortex.blur);
  }

  /** Points with thick cortex; not those whose layer is much less dense than the densest: it is trabecular bone. */
  std::vector<std::size_t>
  FindThick(const std::vector<CorticalFit> & fits) const
  {
    std::vector<std::size_t> thick;
    std::vector<double>      densities;
    for (std::size_t p = 0; p < fits.size(); ++p)
    {
      if (IsThick(fits[p], LeastBlur * m_Spacing))
      {
        thick.push_back(p);
        densities.push_back(fits[p].cortex.cortical);
      }
    }
    std::sort(densities.begin(), densities.end());
    const double least = densities.empty() ? 0.0 : CorticalShare * densities[(densities.size() - 1) * 9 / 10];
    thick.erase(
      std::remove_if(thick.begin(), thick.end(), [&](std::size_t p) { return fits[p].cortex.cortical < least; }),
      thick.end());
    return thick;
  }

  void
  RequireThick(std::size_t count, const char * what, const char * option) const
  {
    if (count < LeastThick)
    {
      throw std::invalid_argument(std::string("The cortex is thick enough to estimate ") + what + " at " +
                                  std::to_string(count) + " of the surface's points, of " + std::to_string(LeastThick) +
                                  " that are needed: give " + option + '.');
    }
  }

  double
  MedianDensity(const std::vector<CorticalFit> & fits, const std::vector<std::size_t> & thick) const
  {
    std::vector<double> densities;
    this->RequireThick(thick.size(), "its density", "CorticalDensity");
    for (const std::size_t p : thick)
    {
      densities.push_back(fits[p].cortex.cortical);
    }
    return Median(densities);
  }

  void
  EstimateBlur(const std::vector<CorticalFit> & fits, const std::vector<std::size_t> & thick)
  {
    if (m_Parameters.pointSpread > 0.0)
    {
      m_Map.blur.inPlane = m_Map.blur.across = m_Parameters.pointSpread / FullWidth;
      return;
    }
    this->RequireThick(thick.size(), "the blur", "PointSpread");
    std::vector<double> flat, steep; // variances in the slices' plane and across
    for (const std::size_t p : thick)
    {
      const double c = std::pow(m_Normals[p].dot(m_Map.blur.axis), 2);
      const double variance = std::pow(fits[p].cortex.blur, 2);
      if (c < 0.25)
      {
        flat.push_back(variance);
      }
      else if (c > 0.75)
      {
        steep.push_back(variance);
      }
    }
    const double        sampling = (m_Spacing * m_Spacing - m_OtherSpacing * m_OtherSpacing) / 12.0;
    const bool          hasFlat = flat.size() >= LeastThick, hasSteep = steep.size() >= LeastThick;
    std::vector<double> all;
    for (const std::size_t p : thick)
    {
      all.push_back(std::pow(fits[p].cortex.blur, 2));
    }
    const double a = hasFlat ? Median(flat) : hasSteep ? std::max(Median(steep) - sampling, 0.0) : Median(all);
    const double b = hasSteep ? Median(steep) : a + sampling;
    const double least = std::pow(LeastBlur * m_Spacing, 2);
    m_Map.blur.inPlane = std::sqrt(std::max(a, least));
    m_Map.blur.across = std::sqrt(std::max(b, least));
  }

  void
  Take(const std::vector<CorticalFit> & fits)
  {
    for (const CorticalFit & fit : fits)
    {
      const bool found = fit.status == CorticalStatus::Found;
      m_Map.status.push_back(fit.status);
      m_Map.thickness.push_back(found ? fit.cortex.thickness : NotANumber);
      m_Map.fitted.push_back(m_Map.thickness.back());
      m_Map.density.push_back(found ? fit.cortex.cortical : NotANumber);
    }
  }

  void
  Smooth()
  {
    if (m_Parameters.smoothingSteps == 0)
    {
      return;
    }
    const Neighbours neighbours = FindNeighbours(m_Map.surface);
    this->ReplaceOutliers(neighbours, m_Map.thickness);
    for (int step = 0; step < m_Parameters.smoothingSteps; ++step)
    {
      const std::vector<double> before = m_Map.thickness;
      for (std::size_t p = 0; p < before.size(); ++p)
      {
        const std::vector<double> around = ValuesAt(before, neighbours[p]);
        if (std::isfinite(before[p]) && !around.empty())
        {
          m_Map.thickness[p] = 0.5 * before[p] + 0.5 * std::accumulate(around.begin(), around.end(), 0.0) /
                                                   static_cast<double>(around.size());
        }
      }
    }
  }

  static std::vector<double>
  ValuesAt(const std::vector<double> & values, const std::vector<IdType> & points)
  {
    std::vector<double> found;
    for (const IdType p : points)
    {
      if (std::isfinite(values[static_cast<std::size_t>(p)]))
      {
        found.push_back(values[static_cast<std::size_t>(p)]);
      }
    }
    return found;
  }

  void
  ReplaceOutliers(const Neighbours & neighbours, std::vector<double> & values)
  {
    const std::vector<double> before = values;
    for (std::size_t p = 0; p < before.size(); ++p)
    {
      const std::vector<double> around = ValuesAt(before, neighbours[p]);
      if (!std::isfinite(before[p]) || around.size() < 3)
      {
        continue;
      }
      const double        median = Median(around);
      std::vector<double> spreads;
      for (const double value : around)
      {
        spreads.push_back(std::abs(value - median));
      }
      if (std::abs(before[p] - median) > OutlierSpreads * std::max(1.4826 * Median(spreads), LeastSpread))
      {
        values[p] = median;
        ++m_Map.outliers;
      }
    }
  }

  const CorticalThicknessParameters &      m_Parameters;
  Execution                                m_Execution;
  CorticalThicknessMap                     m_Map;
  std::vector<Vector3>                     m_Normals;
  std::vector<std::vector<CorticalSample>> m_Samples; ///< of each point
  double                                   m_Spacing{ 1.0 };
  double                                   m_OtherSpacing{ 1.0 };
};

/** A third of the area of the triangles at each point. */
std::vector<double>
PointAreas(const TriangleSurface & surface)
{
  std::vector<double> areas(surface.points.size(), 0.0);
  for (const auto & t : surface.triangles)
  {
    const auto & p = surface.points;
    const double area = (p[t[1]] - p[t[0]]).cross(p[t[2]] - p[t[0]]).norm() / 6.0;
    for (const IdType point : t)
    {
      areas[static_cast<std::size_t>(point)] += area;
    }
  }
  return areas;
}

/** The least value that `share` of the weight lies at or below. `ascending`: values with their weights. */
double
Percentile(const std::vector<std::pair<double, double>> & ascending, double weight, double share)
{
  double sum = 0.0;
  for (const auto & [value, part] : ascending)
  {
    sum += part;
    if (sum >= share * weight)
    {
      return value;
    }
  }
  return ascending.back().first;
}
} // namespace

double
CTBlur::Along(const Vector3 & direction) const
{
  const double c = std::pow(direction.dot(axis), 2);
  return std::sqrt((1.0 - c) * inPlane * inPlane + c * across * across);
}

CorticalThicknessMap
MapCorticalThickness(const MeshArrays &                  mesh,
                     const CTVoxels &                    ct,
                     const CorticalThicknessParameters & parameters,
                     const Execution &                   execution)
{
  CorticalThicknessMap map = ThicknessMapper(mesh, ct, parameters, execution).Run();
  execution.Report(1.0);
  return map;
}

nlohmann::json
ReportThickness(const CorticalThicknessMap & map)
{
  const auto                             areas = PointAreas(map.surface);
  std::array<double, 4>                  byStatus{};
  std::vector<std::pair<double, double>> values;
  double                                 area = 0.0, sum = 0.0;
  for (std::size_t p = 0; p < areas.size(); ++p)
  {
    area += areas[p];
    byStatus[static_cast<std::size_t>(map.status[p])] += areas[p];
    if (map.status[p] == CorticalStatus::Found)
    {
      values.emplace_back(map.thickness[p], areas[p]);
      sum += map.thickness[p] * areas[p];
    }
  }
  std::sort(values.begin(), values.end());
  nlohmann::json report;
  report["points"] = areas.size();
  if (!values.empty())
  {
    const double found = byStatus[static_cast<std::size_t>(CorticalStatus::Found)];
    report["thickness"] = { { "unit", "mm" },
                            { "mean", sum / found },
                            { "median", Percentile(values, found, 0.5) },
                            { "percentile5", Percentile(values, found, 0.05) },
                            { "percentile95", Percentile(values, found, 0.95) } };
  }
  report["shareOfArea"] = { { "none", byStatus[0] / area },
                            { "found", byStatus[1] / area },
                            { "solid", byStatus[2] / area },
                            { "outside", byStatus[3] / area } };
  report["corticalDensity"] = map.corticalDensity;
  report["pointSpread"] = { { "unit", "mm" },
                            { "inPlane", FullWidth * map.blur.inPlane },
                            { "across", FullWidth * map.blur.across } };
  report["thickPoints"] = map.thickPoints;
  report["outliers"] = map.outliers;
  return report;
}
} // namespace bone
