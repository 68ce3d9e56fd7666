/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneAtlasReport.h"

#include "boneChart.h"
#include "boneDensityEvaluation.h"
#include "boneModelPictures.h"
#include "boneJpeg.h"
#include "bonePageData.h"

#include <iomanip>
#include <sstream>

namespace bone
{
namespace
{
/** Numbers of modes that are evaluated: all of the first few, then fewer. */
const std::vector<int> EvaluatedModes{ 0, 1, 2, 3, 4, 5, 6, 8, 10, 12, 15, 20, 25, 30, 40, 50 };

std::string
Digits(double value, int digits)
{
  std::ostringstream os;
  os << std::fixed << std::setprecision(digits) << value;
  return os.str();
}

nlohmann::json
ToJson(const MeanWithError & value)
{
  return { { "mean", value.mean }, { "standardError", value.standardError } };
}

PageTable
SubjectTable(const AtlasReport & report, const std::string & unit)
{
  PageTable table{ "Subjects: root mean square distance to the mean, and modified z-score of it among all",
                   { "Subject", "Shape (mm)", "Score", "Density (" + unit + ")", "Score", "" },
                   {} };
  for (const SubjectDeviation & s : report.subjects)
  {
    table.rows.push_back({ s.name,
                           Digits(s.shape, 2),
                           Digits(s.shapeScore, 1),
                           Digits(s.density, 1),
                           Digits(s.densityScore, 1),
                           s.outlier ? (s.used ? "outlier" : "outlier, left out") : "" });
  }
  return table;
}

/** How a quantity of each number of modes goes. */
template <typename TQuality, typename TValue>
ChartSeries
Curve(const std::vector<TQuality> & qualities, const std::string & name, const TValue & value)
{
  ChartSeries series;
  series.name = name;
  for (const TQuality & quality : qualities)
  {
    series.points.push_back({ static_cast<double>(quality.modes), value(quality) });
  }
  return series;
}

void
AddCurves(const AtlasReport & report, const std::string & unit, ReportPage & page)
{
  const auto compactness = [](const auto & quality) { return 100.0 * quality.compactness; };
  const auto draw = [&page](const std::vector<ChartSeries> & series, const std::string & y, const std::string & what) {
    Chart chart;
    chart.x.label = "modes";
    chart.y.label = y;
    chart.y.lower = 0.0;
    chart.series = series;
    page.AddPicture(DrawChart(chart).GetSvg(), what, what);
  };
  std::vector<ChartSeries> compact{ Curve(report.shape, "shape", compactness) };
  if (!report.density.empty())
  {
    compact.push_back(Curve(report.density, "density", compactness));
  }
  draw(compact, "variance explained (%)", "Compactness: the share of the variance that the first modes explain");
  draw({ Curve(report.shape, "generalisation", [](const ModelQuality & q) { return q.generalisation.mean; }),
         Curve(report.shape, "specificity", [](const ModelQuality & q) { return q.specificity.mean; }) },
       "mean distance of points (mm)",
       "Shape: error of a subject left out (generalisation), and distance of a random bone of the model to the nearest "
       "subject (specificity)");
  if (!report.density.empty())
  {
    draw({ Curve(report.density, "generalisation", [](const DensityQuality & q) { return q.meanAbsolute.mean; }) },
         "mean absolute error (" + unit + ")",
         "Density: error of a subject left out");
  }
}
} // namespace

void
EvaluateAtlas(const TrainingSet & set, const StatisticalModel & model, AtlasReport & report)
{
  EvaluationParameters parameters;
  parameters.modes = EvaluatedModes;
  parameters.alignment = model.GetContent().similarity ? AlignmentKind::Similarity : AlignmentKind::Rigid;
  const std::size_t                 count = set.GetNumberOfSubjects();
  std::vector<std::vector<Vector3>> shapes;
  for (std::size_t i = 0; i < count; ++i)
  {
    shapes.push_back(set.GetSubject(i).points);
  }
  report.shape = EvaluateShapes(std::move(shapes), parameters);
  report.density.clear();
  if (model.HasDensity())
  {
    report.density = EvaluateDensities(
      model.GetContent().mean,
      count,
      [&set, count](const std::function<void(const std::vector<double> &)> & visit) {
        for (std::size_t i = 0; i < count; ++i)
        {
          visit(set.GetSubject(i).coefficients);
        }
      },
      parameters);
  }
}

namespace
{
nlohmann::json
ReportUsualness(const Usualness & of)
{
  return { { "scores", std::vector<double>(of.scores.data(), of.scores.data() + of.scores.size()) },
           { "mahalanobisDistance", of.distance },
           { "probability", of.probability } };
}
} // namespace

nlohmann::json
ReportSubject(const SubjectEvaluation & subject, const RegistrationReport * registration)
{
  nlohmann::json report{ { "registered", registration != nullptr } };
  if (registration != nullptr)
  {
    report["surfaceDistanceMm"] = registration->surfaceDistance;
    report["mirrored"] = registration->mirrored;
  }
  report["shape"] = ReportUsualness(subject.shape);
  report["shape"]["residualMm"] = subject.shapeResidual;
  report["shape"]["typicalResidualMm"] = subject.shapeTypical;
  if (subject.hasDensity)
  {
    report["density"] = ReportUsualness(subject.density);
    report["density"]["residualMeanAbsolute"] = subject.densityResidual.meanAbsolute;
    report["density"]["residualBias"] = subject.densityResidual.bias;
  }
  return report;
}

nlohmann::json
ReportAtlas(const AtlasReport & report)
{
  nlohmann::json json;
  json["subjects"] = nlohmann::json::array();
  for (const SubjectDeviation & s : report.subjects)
  {
    json["subjects"].push_back({ { "name", s.name },
                                 { "shapeMm", s.shape },
                                 { "shapeScore", s.shapeScore },
                                 { "density", s.density },
                                 { "densityScore", s.densityScore },
                                 { "outlier", s.outlier },
                                 { "used", s.used } });
  }
  for (const ModelQuality & q : report.shape)
  {
    json["shape"].push_back({ { "modes", q.modes },
                              { "compactness", q.compactness },
                              { "generalisationMm", ToJson(q.generalisation) },
                              { "specificityMm", ToJson(q.specificity) } });
  }
  for (const DensityQuality & q : report.density)
  {
    json["density"].push_back({ { "modes", q.modes },
                                { "compactness", q.compactness },
                                { "bias", ToJson(q.bias) },
                                { "meanAbsolute", ToJson(q.meanAbsolute) },
                                { "rootMeanSquare", ToJson(q.rootMeanSquare) } });
  }
  return json;
}

ReportPage
MakeAtlasPage(const StatisticalModel & model, const AtlasReport & report, const std::string & name)
{
  constexpr std::size_t modes = 8;
  constexpr int         pixels = 160; // of the radiograph that the page computes
  const auto &          content = model.GetContent();
  const std::string     unit = DensityUnitName(content.mean.quantity);
  const Vector3         beam = Vector3::UnitY(), up = Vector3::UnitZ(); // anteroposterior
  ReportPage            page(name, "train");
  page.BeginSection("atlas-model", "Atlas");
  page.AddText(
    std::to_string(content.subjects.size()) + " subjects, " + std::to_string(content.mean.points.size()) + " points, " +
    std::to_string(content.mean.tetrahedra.size()) + " tetrahedra, " +
    std::to_string(content.shape.GetNumberOfModes()) + " modes of shape" +
    (model.HasDensity() ? " and " + std::to_string(content.density.GetNumberOfModes()) + " of density" : "") + ".");
  Vector3 lower = content.mean.points.front(), upper = lower;
  for (const Vector3 & x : content.mean.points)
  {
    lower = lower.cwiseMin(x);
    upper = upper.cwiseMax(x);
  }
  const Vector3 margin = 0.1 * (upper - lower); // for the modes
  page.AddAtlas(PackAtlas(model, modes, XRayGeometry::Framing(lower - margin, upper + margin, beam, up, pixels)));
  const bool hasShape = content.shape.GetNumberOfModes() > 0, hasDensity = content.density.GetNumberOfModes() > 0;
  page.BeginSection("modes", "Modes");
  if (!hasShape && !hasDensity)
  {
    page.AddText("There are none: the subjects are alike.");
  }
  if (hasShape)
  {
    page.AddPicture(ToJpeg(DrawShapeModes(model, 3, beam, up).GetImage()),
                    "Surfaces at -3, 0 and +3 standard deviations of the first modes of shape",
                    "The first modes of shape at -3, 0 and +3 standard deviations, from in front");
  }
  if (model.HasDensity() && (hasShape || hasDensity))
  {
    page.AddPicture(ToJpeg(DrawRadiographModes(model, beam, up).GetImage()),
                    "Radiographs at -3, 0 and +3 standard deviations of the first modes of shape and density",
                    "Radiographs of the first mode of shape and of density, and their differences to the mean's");
  }
  if (!report.shape.empty())
  {
    page.BeginSection("evaluation", "How good the model is");
    AddCurves(report, unit, page);
  }
  page.BeginSection("subjects", "Subjects");
  page.AddTable(SubjectTable(report, unit));
  return page;
}
} // namespace bone
