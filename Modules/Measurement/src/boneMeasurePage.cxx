/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneMeasurePage.h"

#include "bonePageData.h"

#include <iomanip>
#include <sstream>

namespace bone
{
namespace
{
std::string
ValueOf(const Measure & measure)
{
  std::ostringstream text;
  text << std::setprecision(6) << measure.text;
  for (std::size_t i = 0; i < measure.value.size(); ++i)
  {
    text << (i == 0 ? "" : ", ") << measure.value[i];
  }
  if (measure.error > 0.0)
  {
    text << " \u00B1 " << std::setprecision(2) << measure.error;
  }
  return text.str();
}

std::string
PointText(const Vector3 & x)
{
  std::ostringstream text;
  text << std::fixed << std::setprecision(2) << x.x() << ", " << x.y() << ", " << x.z();
  return text.str();
}
} // namespace

ReportPage
MakeMeasurePage(const std::string & name, const MeasureReport & report, const MeshArrays & model)
{
  ReportPage page(name, "measure");
  PageTable  measures{ "", { "Measure", "Value", "Unit", "Definition" }, {} };
  for (const Measure & m : report.list.measures)
  {
    measures.rows.push_back({ m.name, ValueOf(m), m.unit, m.definition });
  }
  page.BeginSection("measures", "Measures");
  page.AddTable(measures);
  if (!report.list.missing.empty())
  {
    PageTable missing{ "Not measured", { "Measure", "Reason" }, {} };
    for (const MissingMeasure & m : report.list.missing)
    {
      missing.rows.push_back({ m.name, m.reason });
    }
    page.AddTable(missing);
  }
  if (!model.tetrahedra.empty())
  {
    page.BeginSection("model", "Model");
    page.AddModel(PackModel({ { name, &model } }, nullptr, report.landmarks));
  }
  if (!report.landmarks.empty())
  {
    PageTable landmarks{ "", { "Landmark", "x, y, z (mm, LPS)" }, {} };
    for (const Landmark & landmark : report.landmarks)
    {
      landmarks.rows.push_back({ landmark.name, PointText(landmark.point) });
    }
    page.BeginSection("landmarks", "Landmarks");
    page.AddTable(landmarks);
  }
  return page;
}
} // namespace bone
