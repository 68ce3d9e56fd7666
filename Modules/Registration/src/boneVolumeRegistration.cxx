/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneVolumeRegistration.h"

#include "boneBoundaryFit.h"
#include "boneInteriorDeformation.h"
#include "boneReflection.h"
#include "boneUntangling.h"
#include "boneVolumeSearch.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

namespace bone
{
namespace
{
/** What fits best in a CT. */
struct FoundBone
{
  VolumeState     state;
  BoundarySupport support; ///< before it settled
  double          correlation{ 0.0 };
  Eigen::MatrixXd hessian;

  double
  Score() const
  {
    return support.supported * std::sqrt(support.visible);
  }
};

DeformableModel
MakeModel(const StatisticalModelContent & atlas, const AtlasVolumeParameters & p)
{
  if (!atlas.mean.HasDensity())
  {
    throw std::invalid_argument(
      "The atlas has no density, which the bone is searched for by: train it with models that "
      "have one.");
  }
  constexpr double               lengths = 24.0; // of smooth displacements in the bone's extent
  DeformableRadiographParameters ofModel;
  ofModel.shapeModes = p.shapeModes;
  ofModel.smoothModes = p.smoothModes;
  ofModel.smoothLength = p.smoothLength > 0.0 ? p.smoothLength : ExtentOf(atlas.mean.points) / lengths;
  return DeformableModel(atlas, ofModel);
}

/** The CT in the mirror. */
VolumeView
Reflect(const VolumeView & ct)
{
  VoxelGrid grid = ct.grid;
  grid.axes.row(0) *= -1.0;
  grid.origin[0] *= -1.0;
  return { grid, ct.values };
}

FoundBone
FitCandidate(const VolumeCandidate & candidate,
             const DeformableModel & model,
             BoundaryFit &           fit,
             const Execution &       execution)
{
  FoundBone          found;
  const Eigen::Index all = model.shapeModes + model.smoothModes;
  found.state = { candidate.pose, Eigen::VectorXd::Zero(all) };
  found.state.coefficients.head(candidate.coefficients.size()) = candidate.coefficients;
  found.correlation = candidate.correlation;
  for (const double range : { 16.0, 16.0, 12.0, 12.0, 10.0, 8.0, 6.0, 5.0 })
  {
    fit.Step(found.state, range, model.shapeModes, execution);
  }
  for (const double range : { 5.0, 4.0, 4.0, 3.0, 3.0, 3.0, 2.5, 2.5, 2.0, 2.0, 2.0, 2.0 })
  {
    fit.Step(found.state, range, all, execution);
  }
  found.support = fit.Judge(fit.Points(found.state), execution);
  found.hessian = fit.GetHessian();
  return found;
}

/** Nothing where no part of the CT looks like the bone. */
std::optional<FoundBone>
FindBone(const DeformableModel &       model,
         const VolumeView &            ct,
         const AtlasVolumeParameters & p,
         const Execution &             execution)
{
  const std::vector<VolumeCandidate> candidates = SearchVolume(model, ct, p, execution.Part(0.0, 0.6));
  BoundaryFit                        fit(model, ct, p.boneThreshold);
  std::optional<FoundBone>           best;
  for (std::size_t i = 0; i < candidates.size(); ++i)
  {
    FoundBone found = FitCandidate(candidates[i], model, fit, execution);
    if (!best || found.Score() > best->Score())
    {
      best = std::move(found);
    }
    execution.Report(0.6 + 0.4 * (i + 1.0) / static_cast<double>(candidates.size()));
  }
  return best;
}

/** Standard deviation of each point along the axes of the space that the pose leads into, mm. */
std::vector<Vector3>
DeviationsOfPoints(const VolumeRegistrationResult & result, const DeformableModel & model, const Execution & execution)
{
  const Eigen::MatrixXd   lower = result.covariance.llt().matrixL();
  const Eigen::VectorXd & b = result.coefficients;
  std::vector<Vector3>    deviations(model.mean.points.size());
  execution.Silent().For(
    deviations.size(),
    [&](std::size_t p) {
      Vector3         x = model.mean.points[p];
      Eigen::MatrixXd jacobian(3, lower.rows());
      for (Eigen::Index k = 0; k < b.size(); ++k)
      {
        const Vector3 & mode = model.displacements[static_cast<std::size_t>(k)][p];
        jacobian.col(RigidPose::Steps + k) = mode;
        x += b[k] * mode;
      }
      for (int k = 0; k < 3; ++k)
      {
        jacobian.col(k) = Vector3::Unit(k);
        jacobian.col(3 + k) = Vector3::Unit(k).cross(x - result.pose.centre);
      }
      // Along the surface the edges tell little, and the smooth modes' rest is as it was.
      deviations[p] =
        ((result.pose.rotation * jacobian * lower).rowwise().squaredNorm().array() + model.residualVariance).sqrt();
    },
    16);
  return deviations;
}

/** The mesh whose surface has settled on the edges; sets what the result says of it. Where that inverts tetrahedra that
 * cannot be repaired, the surface goes less far. */
void
Settle(const FoundBone &          found,
       const DeformableModel &    model,
       const BoundaryFit &        fit,
       VolumeRegistrationResult & result,
       const Execution &          execution)
{
  MeshArrays rest = model.mean;
  if (rest.neighbors.empty())
  {
    rest.neighbors = ComputeFaceNeighbors(rest.tetrahedra);
  }
  std::vector<Vector3> points = model.MovePoints(found.state.coefficients);
  for (Vector3 & x : points)
  {
    x = found.state.pose.Apply(x);
  }
  const std::vector<Vector3> before = fit.Points(found.state);
  std::vector<Vector3>       surface = before;
  for (const double range : { 3.0, 2.0, 2.0, 1.5, 1.5 })
  {
    surface = fit.Settle(surface, range, execution);
  }
  std::vector<Vector3> moved;
  for (std::size_t i = 0; i < surface.size(); ++i)
  {
    moved.push_back(rest.points[static_cast<std::size_t>(fit.Exterior()[i])] + surface[i] - before[i]);
  }
  const std::vector<Vector3> followed =
    InteriorDeformation(rest, fit.Exterior()).Deform(InteriorRule::Harmonic, AffineMap(), moved, execution);
  const AffineMap alignment{ found.state.pose.rotation, found.state.pose.Apply(Vector3::Zero()) };
  result.mesh = rest;
  for (const double share : { 1.0, 0.75, 0.5, 0.25, 0.0 })
  {
    for (std::size_t p = 0; p < followed.size(); ++p)
    {
      result.mesh.points[p] = points[p] + share * (followed[p] - rest.points[p]);
    }
    const UntanglingReport report = UntangleMesh(rest, fit.Exterior(), alignment, result.mesh.points, {}, execution);
    result.repaired = report.before - report.after;
    result.inverted = report.after;
    result.settledShare = share;
    if (result.inverted == 0)
    {
      break;
    }
  }
  for (std::size_t i = 0; i < surface.size(); ++i)
  {
    const Vector3 offset = result.settledShare * (surface[i] - before[i]);
    surface[i] = before[i] + offset;
    result.settled += offset.norm() / static_cast<double>(surface.size());
  }
  result.settledSupport = fit.Judge(surface, execution, &result.unsupported);
}

/** Of the faces that bound a region (-1: the mesh), mm^2. */
double
AreaOf(const MeshArrays & mesh, int region)
{
  constexpr int faces[4][3] = { { 1, 2, 3 }, { 0, 3, 2 }, { 0, 1, 3 }, { 0, 2, 1 } };
  const auto    regionOf = [&mesh](IdType t) {
    return mesh.region.empty() ? 0 : mesh.region[static_cast<std::size_t>(t)];
  };
  double area = 0.0;
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
  {
    for (std::size_t f = 0; f < 4; ++f)
    {
      const IdType other = mesh.neighbors[t][f];
      const bool   mine = region < 0 || regionOf(static_cast<IdType>(t)) == region;
      if (mine && (other < 0 || (region >= 0 && regionOf(other) != region)))
      {
        const auto at = [&](int k) { return mesh.points[static_cast<std::size_t>(mesh.tetrahedra[t][faces[f][k]])]; };
        area += 0.5 * (at(1) - at(0)).cross(at(2) - at(0)).norm();
      }
    }
  }
  return area;
}

/** Volumes of the mesh, and how sure they are: by the covariance, and by a surface that lies outside as a whole. */
void
MeasureRegions(const DeformableModel & model, const AtlasVolumeParameters & p, VolumeRegistrationResult & result)
{
  const Eigen::Index count = result.coefficients.size();
  Eigen::VectorXd    coefficients = Eigen::VectorXd::Zero(model.GetNumberOfCoefficients());
  coefficients.head(count) = result.coefficients;
  const auto            slopes = model.RegionSlopes(coefficients);
  const Eigen::MatrixXd covariance = result.covariance.bottomRightCorner(count, count);
  const MeshArrays &    mesh = result.mesh;
  const Eigen::MatrixXd table = MeasureCells(mesh, mesh.points, std::vector<double>(mesh.tetrahedra.size(), 0.0));
  for (Eigen::Index row = 0; row < table.rows(); ++row)
  {
    RegionEstimate estimate;
    estimate.region = row + 1 < table.rows() ? static_cast<int>(row) : -1;
    estimate.volume = table(row, 0);
    if (estimate.volume > 0.0)
    {
      Eigen::VectorXd slope(count);
      for (Eigen::Index k = 0; k < count; ++k)
      {
        slope[k] = slopes[static_cast<std::size_t>(k)](row, 0);
      }
      const double asAWhole = p.surfaceDeviation * AreaOf(mesh, estimate.region);
      estimate.volumeDeviation = std::sqrt(slope.dot(covariance * slope) + asAWhole * asAWhole);
      result.regions.push_back(estimate);
    }
  }
}

/** From the mirror back into the CT's space: the result of the atlas in the mirror. */
void
ReflectResult(VolumeRegistrationResult & result)
{
  const Eigen::Matrix3d mirror = Vector3(-1.0, 1.0, 1.0).asDiagonal();
  result.mesh = ReflectMesh(std::move(result.mesh));
  for (UnsupportedPatch & patch : result.unsupported)
  {
    patch.centre = mirror * patch.centre;
  }
  result.pose = { mirror * result.pose.rotation * mirror,
                  mirror * result.pose.translation,
                  mirror * result.pose.centre };
  // Rotation vectors are axial.
  Eigen::VectorXd signs = Eigen::VectorXd::Ones(result.covariance.rows());
  signs[0] = signs[4] = signs[5] = -1.0;
  result.covariance = signs.asDiagonal() * result.covariance * signs.asDiagonal();
}

RegistrationQuality
JudgeSupport(const BoundarySupport & support)
{
  constexpr double ok = 0.75, suspect = 0.62;
  return support.supported >= ok        ? RegistrationQuality::Ok
         : support.supported >= suspect ? RegistrationQuality::Suspect
                                        : RegistrationQuality::Failed;
}
} // namespace

VolumeRegistrationResult
RegisterVolume(const StatisticalModelContent & atlas,
               const VolumeView &              ct,
               const AtlasVolumeParameters &   p,
               const Execution &               execution)
{
  const DeformableModel    model = MakeModel(atlas, p);
  const VolumeView         reflected = Reflect(ct);
  std::optional<FoundBone> best;
  VolumeRegistrationResult result;
  if (p.mirror != MirrorMode::Always)
  {
    best = FindBone(model, ct, p, execution.Part(0.05, 0.45));
  }
  if (p.mirror != MirrorMode::Never)
  {
    auto other = FindBone(model, reflected, p, execution.Part(0.45, 0.85));
    if (other && (!best || other->Score() > best->Score()))
    {
      best = std::move(other);
      result.mirrored = true;
    }
  }
  if (!best)
  {
    throw std::invalid_argument("Nothing in the CT looks like the atlas' bone: is it in HU, and does it show at least "
                                "LeastShare of the bone?");
  }
  result.pose = best->state.pose;
  result.coefficients = best->state.coefficients;
  result.shapeModes = model.shapeModes;
  result.smoothModes = model.smoothModes;
  result.support = best->support;
  result.correlation = best->correlation;
  const VolumeView & seen = result.mirrored ? reflected : ct;
  Settle(*best, model, BoundaryFit(model, seen, p.boneThreshold), result, execution.Part(0.85, 0.95));
  result.covariance = best->hessian.ldlt().solve(Eigen::MatrixXd::Identity(best->hessian.rows(), best->hessian.cols()));
  result.pointDeviations = DeviationsOfPoints(result, model, execution);
  result.quality = JudgeSupport(best->support);
  MeasureRegions(model, p, result);
  if (result.mirrored)
  {
    ReflectResult(result);
  }
  execution.Report(1.0);
  return result;
}
} // namespace bone
