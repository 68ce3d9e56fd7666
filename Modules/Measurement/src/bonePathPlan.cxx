/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "bonePathPlan.h"

#include "boneDensityEvaluation.h"
#include "boneMeasureReport.h"
#include "boneTriangleSurface.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

namespace bone
{
namespace
{
constexpr double AxialStep = 1.0;      // mm, between points of the density
constexpr double ClearanceStep = 0.25; // mm
constexpr double ClearanceFall = 0.5;  // mm, by which a path comes nearer to the surface again
constexpr int    PathRings = 3;
constexpr int    AroundPath = 8;
constexpr int    ShellRings = 2;
constexpr int    AroundShell = 12;
constexpr double NoPlace = std::numeric_limits<double>::quiet_NaN();

/** Shift across, turn across, depth: of a path about the start of a search, each from -1 to 1 of its bound. */
using PathPose = std::array<double, 5>;

TriangleSurface
PathSurface(const MeshArrays & mesh)
{
  std::vector<IdType> ids;
  return ExteriorSurface(mesh, ids);
}

double
MeanOf(const std::vector<double> & values)
{
  return values.empty() ? NoPlace
                        : std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

Capsule
PathAt(const Capsule & start, const PathPlanParameters & parameters, const PathPose & pose)
{
  const double  length = (start.to - start.from).norm();
  const Vector3 axis = (start.to - start.from) / length, u = axis.unitOrthogonal(), v = axis.cross(u);
  const auto    turn =
    Eigen::AngleAxisd(pose[2] * parameters.searchAngle, u) * Eigen::AngleAxisd(pose[3] * parameters.searchAngle, v);
  Capsule path = start;
  path.from = start.from + parameters.searchShift * (pose[0] * u + pose[1] * v);
  path.to = path.from + std::max(length + pose[4] * parameters.searchDepth, AxialStep) * (turn * axis);
  return path;
}
} // namespace

double
PathAssessment::MeanAround() const
{
  return around.empty() ? 0.0 : MeanOf(around);
}

double
Percentile(const std::vector<double> & ascending, double share)
{
  if (ascending.empty())
  {
    return NoPlace;
  }
  const double      at = share * static_cast<double>(ascending.size() - 1);
  const std::size_t below = std::min(static_cast<std::size_t>(at), ascending.size() - 1);
  const std::size_t above = std::min(below + 1, ascending.size() - 1);
  return ascending[below] + (at - static_cast<double>(below)) * (ascending[above] - ascending[below]);
}

PathPlanner::PathPlanner(const MeshArrays & mesh)
  : m_Mesh(mesh)
  , m_Locator(mesh)
  , m_Surface(PathSurface(mesh).points, PathSurface(mesh).triangles)
{
  if (!mesh.HasDensity())
  {
    throw std::invalid_argument("The model holds no density: fit one to a CT.");
  }
}

/** NaN outside the bone. */
double
PathPlanner::DensityIn(const Vector3 & x, IdType & hint) const
{
  const CellLocation place = m_Locator.Find(x, hint);
  if (!place.Found())
  {
    return NoPlace;
  }
  hint = place.cell;
  return DensityAt(m_Mesh, place);
}

PathAssessment
PathPlanner::Assess(const Capsule & path, double margin, double shell) const
{
  const double length = (path.to - path.from).norm();
  if (!(length > 0.0))
  {
    throw std::invalid_argument("A path's ends must not be one point.");
  }
  const Vector3  axis = (path.to - path.from) / length, u = axis.unitOrthogonal(), v = axis.cross(u);
  PathAssessment found;
  // Densities: rings of points, each for the same area.
  IdType      hint = -1;
  std::size_t inPath = 0;
  const auto  ring = [&](const Vector3 & centre, double radius, int count, std::vector<double> & values) {
    for (int i = 0; i < count; ++i)
    {
      const double angle = 2.0 * M_PI * i / count;
      const double value = this->DensityIn(centre + radius * (std::cos(angle) * u + std::sin(angle) * v), hint);
      if (!std::isnan(value))
      {
        values.push_back(value);
      }
    }
  };
  const int    places = std::max(1, static_cast<int>(std::lround(length / AxialStep)));
  const double inner = path.radius * path.radius, outer = std::pow(path.radius + shell, 2);
  for (int i = 0; i < places; ++i)
  {
    const Vector3 centre = path.from + (i + 0.5) / places * length * axis;
    for (int k = 0; k < PathRings; ++k)
    {
      ring(centre, std::sqrt(inner * (k + 0.5) / PathRings), AroundPath, found.along);
      inPath += AroundPath;
    }
    for (int k = 0; k < ShellRings; ++k)
    {
      ring(centre, std::sqrt(inner + (outer - inner) * (k + 0.5) / ShellRings), AroundShell, found.around);
    }
  }
  std::sort(found.along.begin(), found.along.end());
  std::sort(found.around.begin(), found.around.end());
  found.boneShare = static_cast<double>(found.along.size()) / static_cast<double>(inPath);
  this->AssessClearance(path, margin, found);
  return found;
}

void
PathPlanner::AssessClearance(const Capsule & path, double margin, PathAssessment & found) const
{
  found.entry = found.leastClearance = found.breakthrough = NoPlace;
  const double length = (path.to - path.from).norm();
  const int    steps = static_cast<int>(std::ceil(length / ClearanceStep));
  double       largest = 0.0, least = 0.0, clearance = 0.0;
  for (int i = 0; i <= steps; ++i)
  {
    const double share = static_cast<double>(i) / steps;
    clearance = -m_Surface.FindNearest(path.from + share * (path.to - path.from)).distance - path.radius;
    if (std::isnan(found.entry) && clearance >= margin)
    {
      found.entry = share * length;
      found.leastClearance = std::numeric_limits<double>::infinity();
      largest = least = clearance;
    }
    if (!std::isnan(found.entry))
    {
      least = std::min(least, clearance);
      largest = std::max(largest, clearance);
      if (clearance < largest - ClearanceFall)
      {
        found.leastClearance = std::min(found.leastClearance, clearance);
      }
      if (std::isnan(found.breakthrough) && clearance < 0.0)
      {
        found.breakthrough = share * length;
      }
    }
  }
  if (!std::isnan(found.entry))
  {
    // Within the margin no place is passed over.
    found.leastClearance = least < margin ? least : std::min(found.leastClearance, clearance);
  }
}

bool
PathPlanner::Search(const Capsule &            start,
                    const PathPlanParameters & parameters,
                    Capsule &                  best,
                    const Execution &          execution) const
{
  best = start;
  double     bestDensity = -std::numeric_limits<double>::infinity();
  PathPose   bestPose{};
  const auto tryAll = [&](const std::vector<PathPose> & poses) {
    std::vector<double> density(poses.size(), -std::numeric_limits<double>::infinity());
    execution.For(poses.size(), [&](std::size_t i) {
      const auto found = this->Assess(PathAt(start, parameters, poses[i]), parameters.margin, parameters.shell);
      if (found.IsSafe(parameters.margin))
      {
        density[i] = found.MeanAround();
      }
    });
    bool better = false;
    for (std::size_t i = 0; i < poses.size(); ++i)
    {
      if (density[i] > bestDensity)
      {
        bestDensity = density[i];
        bestPose = poses[i];
        better = true;
      }
    }
    return better;
  };
  std::vector<PathPose> grid{ PathPose{} };
  for (std::size_t axis = 0; axis < 5; ++axis)
  {
    std::vector<PathPose> finer;
    for (const PathPose & pose : grid)
    {
      for (double x = -1.0; x <= 1.0; x += axis < 4 ? 0.5 : 1.0)
      {
        finer.push_back(pose);
        finer.back()[axis] = x;
      }
    }
    grid.swap(finer);
  }
  if (!tryAll(grid))
  {
    return false;
  }
  for (double step = 0.25; step >= 0.02;)
  {
    std::vector<PathPose> around;
    for (std::size_t axis = 0; axis < 5; ++axis)
    {
      for (const double side : { -step, step })
      {
        around.push_back(bestPose);
        around.back()[axis] = std::clamp(bestPose[axis] + side, -1.0, 1.0);
      }
    }
    if (!tryAll(around))
    {
      step *= 0.5;
    }
  }
  best = PathAt(start, parameters, bestPose);
  return true;
}

MeasureList
PlanPath(const MeshArrays &         mesh,
         const Capsule &            path,
         bool                       search,
         const PathPlanParameters & parameters,
         const std::string &        name,
         const Execution &          execution)
{
  const PathPlanner planner(mesh);
  Capsule           chosen = path;
  const bool        found = search && planner.Search(path, parameters, chosen, execution);
  const auto        assessed = planner.Assess(chosen, parameters.margin, parameters.shell);
  MeasureList       list =
    MeasurePart(mesh,
                { name, "the path, with its round ends", MakeCapsule(chosen.from, chosen.to, chosen.radius) },
                MeasureParameters());
  const std::string density = DensityQuantityName(mesh.quantity);
  const auto        add =
    [&](const char * what, std::vector<double> value, const std::string & unit, const char * definition) {
      if (std::any_of(value.begin(), value.end(), [](double x) { return std::isnan(x); }))
      {
        list.missing.push_back({ name + "." + what, "the path has no such place" });
      }
      else
      {
        list.measures.push_back({ name + "." + what, std::move(value), unit, definition });
      }
    };
  const auto coordinates = [](const Vector3 & x) { return std::vector<double>{ x.x(), x.y(), x.z() }; };
  const auto percentiles = [](const std::vector<double> & values) {
    std::vector<double> result;
    for (const double share : { 0.05, 0.25, 0.5, 0.75, 0.95 })
    {
      result.push_back(Percentile(values, share));
    }
    return result;
  };
  if (search)
  {
    list.measures.push_back(
      { name + ".search",
        {},
        "",
        "Whether a safe path was found within the bounds of the search; none: the path is that given",
        found ? "found" : "none" });
  }
  add("from", coordinates(chosen.from), "mm", "Where the path's axis begins, in the model's space (LPS)");
  add("to", coordinates(chosen.to), "mm", "Where it ends");
  add("radius", { chosen.radius }, "mm", "Radius of the path");
  add("densityAlongMean", { MeanOf(assessed.along) }, density, "Mean density at points in the path that lie in bone");
  add("densityAlongPercentiles", percentiles(assessed.along), density, "5, 25, 50, 75 and 95 % of them");
  add("densityAroundMean", { MeanOf(assessed.around) }, density, "Mean density at points in the shell around the path");
  add("densityAroundPercentiles", percentiles(assessed.around), density, "5, 25, 50, 75 and 95 % of them");
  add("boneShare", { assessed.boneShare }, "", "Share of the path's points that lie in bone");
  add("entry",
      { assessed.entry },
      "mm",
      "Along the axis, from its begin to where the path first leaves the margin to the surface");
  add("leastClearance",
      { assessed.leastClearance },
      "mm",
      "Least distance of the path to the bone's surface at its tip and where it comes nearer to the surface again "
      "beyond its "
      "entry; negative: it breaks through");
  add("breakthrough",
      { assessed.breakthrough },
      "mm",
      "Along the axis, from its begin to where the path first touches the surface beyond the entry");
  list.measures.push_back({ name + ".safe",
                            {},
                            "",
                            "Whether the path leaves at least the margin to the surface beyond its entry",
                            assessed.IsSafe(parameters.margin) ? "yes" : "no" });
  return list;
}
} // namespace bone
