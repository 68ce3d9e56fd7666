/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSubjectPage.h"

#include "boneChart.h"
#include "boneDensityEvaluation.h"
#include "bonePageData.h"

#include <iomanip>
#include <sstream>

namespace bone
{
namespace
{
std::string
Decimals(double value, int digits)
{
  std::ostringstream os;
  os << std::fixed << std::setprecision(digits) << value;
  return os.str();
}

ChartSeries
Scores(const std::string & name, const Usualness & of)
{
  ChartSeries series;
  series.name = name;
  for (Eigen::Index k = 0; k < of.scores.size(); ++k)
  {
    series.points.push_back({ static_cast<double>(k + 1), of.scores[k] });
  }
  return series;
}
} // namespace

ReportPage
MakeSubjectPage(const std::string &             name,
                const SubjectEvaluation &       evaluation,
                const MeshArrays &              subject,
                const StatisticalModelContent & atlas)
{
  ReportPage page(name, "evaluate");
  page.BeginSection("usual", "How usual it is");
  const std::string unit = DensityUnitName(atlas.mean.quantity);
  PageTable         table{ "", { "", "Shape" }, {} };
  table.rows = { { "Mahalanobis distance from the mean", Decimals(evaluation.shape.distance, 2) },
                 { "bones as far off or further", Decimals(100.0 * evaluation.shape.probability, 1) + " %" },
                 { "distance from the nearest of the modes, mean", Decimals(evaluation.shapeResidual, 2) + " mm" },
                 { "the same of the atlas' own subjects, left out", Decimals(evaluation.shapeTypical, 2) + " mm" } };
  Chart chart;
  chart.x.label = "mode";
  chart.y.label = "coefficient (standard deviations)";
  chart.series.push_back(Scores("shape", evaluation.shape));
  if (evaluation.hasDensity)
  {
    const DensityDifference & residual = evaluation.densityResidual;
    table.header.push_back("Density");
    table.rows[0].push_back(Decimals(evaluation.density.distance, 2));
    table.rows[1].push_back(Decimals(100.0 * evaluation.density.probability, 1) + " %");
    table.rows[2].push_back(Decimals(residual.meanAbsolute, 1) + ' ' + unit);
    table.rows[3].push_back("-");
    chart.series.push_back(Scores("density", evaluation.density));
  }
  page.AddTable(table);
  const std::string what =
    "Coefficients of the atlas' modes; 19 of 20 bones lie within two standard deviations in each";
  page.AddPicture(DrawChart(chart).GetSvg(), what, what);
  page.BeginSection("bone", "Bone");
  page.AddModel(PackModel({ { "subject", &subject }, { "mean of the atlas", &atlas.mean } }, nullptr, {}));
  return page;
}
} // namespace bone
