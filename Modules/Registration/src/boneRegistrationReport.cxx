/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneRegistrationReport.h"

#include "boneFigure.h"
#include "boneMeshRadiograph.h"
#include "boneXRayPicture.h"

#include <algorithm>
#include <cmath>

namespace bone
{
namespace
{
template <typename TMatrix>
nlohmann::json
RowsOf(const TMatrix & matrix)
{
  nlohmann::json rows = nlohmann::json::array();
  for (Eigen::Index r = 0; r < matrix.rows(); ++r)
  {
    std::vector<double> row;
    for (Eigen::Index c = 0; c < matrix.cols(); ++c)
    {
      row.push_back(matrix(r, c));
    }
    rows.push_back(row);
  }
  return rows;
}

/** What black and white are: all but 1 % of the values at either end. */
Window
WindowOf(std::vector<float> values)
{
  values.erase(std::remove_if(values.begin(), values.end(), [](float v) { return !std::isfinite(v); }), values.end());
  if (values.empty())
  {
    return {};
  }
  std::sort(values.begin(), values.end());
  const auto at = [&](double share) { return values[static_cast<std::size_t>(share * (values.size() - 1.0))]; };
  return { at(0.01), std::max(at(0.99), at(0.01) + 1e-6f) };
}

/** Lines between pixels that see the model and neighbours that do not. */
void
DrawOutline(Canvas &                   canvas,
            const Rectangle &          place,
            const XRayGeometry::View & view,
            const std::vector<float> & chords,
            const Color &              color)
{
  const auto sees = [&](int c, int r) {
    return c >= 0 && r >= 0 && c < view.size[0] && r < view.size[1] &&
           chords[static_cast<std::size_t>(r) * view.size[0] + c] > 0.0f;
  };
  const auto corner = [&](int c, int r) {
    return Vector2(place.x + c * place.width / view.size[0], place.y + r * place.height / view.size[1]);
  };
  for (int r = 0; r <= view.size[1]; ++r)
  {
    for (int c = 0; c <= view.size[0]; ++c)
    {
      if (sees(c, r) != sees(c - 1, r))
      {
        canvas.DrawLine(corner(c, r), corner(c, r + 1), color);
      }
      if (sees(c, r) != sees(c, r - 1))
      {
        canvas.DrawLine(corner(c, r), corner(c + 1, r), color);
      }
    }
  }
}

/** A rigid motion and how sure it is. */
nlohmann::json
ReportMotion(const RigidPose & pose, const Eigen::Matrix<double, 6, 6> & covariance)
{
  Eigen::Matrix4d transform = Eigen::Matrix4d::Identity();
  transform.topLeftCorner<3, 3>() = pose.rotation;
  transform.topRightCorner<3, 1>() = pose.Apply(Vector3::Zero());
  std::vector<double> deviations;
  for (int k = 0; k < 6; ++k)
  {
    deviations.push_back(std::sqrt(std::max(0.0, covariance(k, k))) * (k < 3 ? 1.0 : 180.0 / std::acos(-1.0)));
  }
  return { { "transform", RowsOf(transform) },
           { "centre", { pose.centre.x(), pose.centre.y(), pose.centre.z() } },
           { "covariance", RowsOf(covariance) },
           { "standardDeviations", deviations } };
}

/** Of translation and rotation vector about the centre, along the axes of the space that the pose leads into. */
template <typename TResult>
Eigen::Matrix<double, 6, 6>
TurnCovariance(const TResult & result)
{
  Eigen::Matrix<double, 6, 6> turn = Eigen::Matrix<double, 6, 6>::Zero();
  turn.topLeftCorner<3, 3>() = result.pose.rotation;
  turn.bottomRightCorner<3, 3>() = result.pose.rotation;
  return turn * result.covariance.topLeftCorner(6, 6) * turn.transpose();
}

/** What the results of all registrations have. */
template <typename TResult>
nlohmann::json
ReportPose(const TResult & result, const Eigen::Matrix<double, 6, 6> & covariance)
{
  nlohmann::json report = ReportMotion(result.pose, covariance);
  report["converged"] = result.converged;
  report["quality"] = ParameterText(result.quality);
  report["distinctness"] = result.distinctness;
  report["cost"] = result.cost;
  report["views"] = result.costs;
  return report;
}

nlohmann::json
ReportDeviations(const std::vector<Vector3> & ofPoints)
{
  double sum = 0.0, largest = 0.0;
  for (const Vector3 & deviation : ofPoints)
  {
    sum += deviation.norm();
    largest = std::max(largest, deviation.norm());
  }
  return { { "mean", sum / static_cast<double>(std::max<std::size_t>(1, ofPoints.size())) }, { "largest", largest } };
}

/** Volume, mean density and mass, each with its deviation, of the whole and of the regions. */
nlohmann::json
ReportRegions(const std::vector<RegionEstimate> & regions)
{
  const auto estimate = [](double mean, double deviation) {
    return nlohmann::json{ { "mean", mean }, { "standardDeviation", deviation } };
  };
  nlohmann::json posterior;
  posterior["regions"] = nlohmann::json::array();
  for (const RegionEstimate & region : regions)
  {
    nlohmann::json entry{ { "volumeMm3", estimate(region.volume, region.volumeDeviation) },
                          { "meanDensity", estimate(region.density, region.densityDeviation) },
                          { "massHuMm3", estimate(region.mass, region.massDeviation) } };
    if (region.region < 0)
    {
      posterior.update(entry);
    }
    else
    {
      entry["region"] = region.region;
      posterior["regions"].push_back(entry);
    }
  }
  return posterior;
}

/** A view seen in other axes: those columns of `axes`. */
XRayGeometry::View
InAxes(XRayGeometry::View view, const Eigen::Matrix3d & axes)
{
  for (Vector3 * v : { &view.source, &view.direction, &view.detectorOrigin, &view.detectorU, &view.detectorV })
  {
    *v = axes.transpose() * *v;
  }
  return view;
}

/** The factor by which a radiograph leaves least of an X-ray, about the means where the model is seen. */
double
BestGain(const RadiographView & xray, const std::vector<float> & drr, const std::vector<float> & chords)
{
  double sums[5] = {};
  for (std::size_t i = 0; i < drr.size(); ++i)
  {
    if (chords[i] > 0.0f && std::isfinite(xray.values[i]) && (xray.weights.empty() || xray.weights[i] > 0.0f))
    {
      const double x = xray.values[i];
      const double g = drr[i];
      const double terms[5] = { 1.0, x, g, x * g, g * g };
      std::transform(terms, terms + 5, sums, sums, [](double term, double sum) { return sum + term; });
    }
  }
  const double spread = sums[4] - sums[2] * sums[2] / std::max(1.0, sums[0]);
  return spread > 0.0 ? (sums[3] - sums[1] * sums[2] / std::max(1.0, sums[0])) / spread : 0.0;
}

/** How large an image is shown: whole pixels up to about 512 a side, smaller than its pixels above 1024. */
double
ZoomOf(const XRayGeometry::View & view)
{
  constexpr int width = 512, most = 1024;
  const int     longer = std::max(view.size[0], view.size[1]);
  return longer > most ? static_cast<double>(most) / longer : std::max(1, width / longer);
}
} // namespace

nlohmann::json
ReportRegistration(const RigidRegistrationResult & result)
{
  nlohmann::json report = ReportPose(result, result.covariance);
  report["leastDistinctness"] = result.leastDistinctness;
  report["searches"] = result.searches;
  report["beyondSearch"] = result.beyondSearch;
  report["ambiguous"] = result.ambiguous;
  return report;
}

Eigen::Matrix<double, 6, 6>
PoseCovariance(const DeformableRegistrationResult & result)
{
  return TurnCovariance(result);
}

nlohmann::json
ReportViewCorrections(const std::vector<ViewCorrection> & views)
{
  nlohmann::json list = nlohmann::json::array();
  for (const ViewCorrection & view : views)
  {
    list.push_back(ReportMotion(view.motion, view.covariance));
  }
  return list;
}

nlohmann::json
ReportRegistration(const DeformableRegistrationResult & result)
{
  nlohmann::json report = ReportPose(result, PoseCovariance(result));
  const auto     part = [&result](Eigen::Index first, Eigen::Index count) {
    const double * begin = result.coefficients.data() + first;
    return std::vector<double>(begin, begin + count);
  };
  report["shape"] = part(0, result.shapeModes);
  report["smooth"] = part(result.shapeModes, result.smoothModes);
  report["density"] = part(result.shapeModes + result.smoothModes, result.densityModes);
  report["pointDeviation"] = ReportDeviations(result.pointDeviations);
  report["posterior"] = ReportRegions(result.regions);
  report["precision"] = result.precision;
  return report;
}

nlohmann::json
ReportRegistration(const VolumeRegistrationResult & result)
{
  nlohmann::json report = ReportMotion(result.pose, TurnCovariance(result));
  const auto     list = [](const Eigen::VectorXd & values) {
    return std::vector<double>(values.data(), values.data() + values.size());
  };
  const auto support = [](const BoundarySupport & of) {
    return nlohmann::json{ { "visible", of.visible }, { "supported", of.supported }, { "residualMm", of.residual } };
  };
  report["converged"] = result.quality != RegistrationQuality::Failed;
  report["quality"] = ParameterText(result.quality);
  report["mirrored"] = result.mirrored;
  report["support"] = support(result.support);
  report["settledSupport"] = support(result.settledSupport);
  report["settledMm"] = result.settled;
  report["settledShare"] = result.settledShare;
  report["repaired"] = result.repaired;
  report["shape"] = list(result.coefficients.head(result.shapeModes));
  report["smooth"] = list(result.coefficients.tail(result.smoothModes));
  report["density"] = list(result.densityScores);
  report["pointDeviation"] = ReportDeviations(result.pointDeviations);
  report["unsupported"] = nlohmann::json::array();
  for (const UnsupportedPatch & patch : result.unsupported)
  {
    report["unsupported"].push_back({ { "centre", { patch.centre.x(), patch.centre.y(), patch.centre.z() } },
                                      { "extentMm", patch.extent },
                                      { "share", patch.share } });
  }
  report["posterior"] = ReportRegions(result.regions);
  return report;
}

Canvas
DrawRegistration(const RadiographView &  xray,
                 const MeshArrays &      model,
                 const RigidPose &       pose,
                 const Eigen::Matrix3d & patientAxes)
{
  const auto &       view = xray.view;
  const auto         inModel = pose.ToModelSpace(view);
  std::vector<float> drr(xray.GetNumberOfPixels());
  std::vector<float> chords(xray.GetNumberOfPixels());
  ProjectMesh(model.points, model, inModel, {}, Execution(), drr.data());
  MeshRadiographParameters ones;
  ones.scale = 0.0;
  ones.offset = 1.0;
  ProjectMesh(model.points, model, inModel, ones, Execution(), chords.data());
  const double gain = BestGain(xray, drr, chords);
  auto         rest = xray.values;
  for (std::size_t i = 0; i < rest.size(); ++i)
  {
    rest[i] -= static_cast<float>(gain * drr[i]);
  }

  Vector3 centre = Vector3::Zero();
  for (const Vector3 & p : model.points)
  {
    centre += p / static_cast<double>(model.points.size());
  }
  const auto       patient = InAxes(inModel, patientAxes);
  const Color      outline = ContourStyles()[static_cast<std::size_t>(ContourKind::Periosteal)].color;
  const PanelStyle style{ "X-ray",
                          LettersOf(patient),
                          PixelSizeAt(inModel, centre),
                          "at the bone",
                          WindowOf(xray.values),
                          ColorMap::Grey,
                          false,
                          "",
                          ZoomOf(view) };
  PanelCell image{ { view.size[0], view.size[1], xray.values }, style, [&](Canvas & canvas, const Rectangle & place) {
                    DrawOutline(canvas, place, view, chords, outline);
                  } };
  PanelCell left{ { view.size[0], view.size[1], rest }, style, {} };
  left.style.title = "X-ray less the model's radiograph";
  Figure figure;
  figure.sections.push_back({ DescribeView(patient), { { std::move(image), std::move(left) } } });
  figure.legend.push_back({ "outline of the model where it was found", outline });
  return DrawFigure(figure);
}
} // namespace bone
