/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneRegistrationPage.h"

#include "boneJpeg.h"
#include "bonePageData.h"

#include <iomanip>
#include <sstream>

namespace bone
{
namespace
{
/** Numbers to four figures, words as they are; lists with spaces between. */
std::string
WordsOf(const nlohmann::json & value)
{
  if (value.is_string())
  {
    return value.get<std::string>();
  }
  if (value.is_boolean())
  {
    return value.get<bool>() ? "yes" : "no";
  }
  std::ostringstream text;
  text << std::setprecision(4);
  if (value.is_array())
  {
    for (const nlohmann::json & element : value)
    {
      text << (text.tellp() > 0 ? " " : "") << WordsOf(element);
    }
  }
  else if (value.is_number_integer())
  {
    text << value.get<std::int64_t>();
  }
  else if (value.is_number())
  {
    text << value.get<double>();
  }
  return text.str();
}

/** Adds a row where the report has the member. */
void
AddRow(const nlohmann::json & report, const char * pointer, const std::string & name, PageTable & table)
{
  const nlohmann::json::json_pointer member(pointer);
  if (report.contains(member))
  {
    table.rows.push_back({ name, WordsOf(report.at(member)) });
  }
}

PageTable
ResultTable(const nlohmann::json & report)
{
  PageTable table;
  AddRow(report, "/quality", "quality", table);
  AddRow(report, "/converged", "converged", table);
  AddRow(report, "/mirrored", "atlas mirrored", table);
  AddRow(report, "/cost", "cost", table);
  AddRow(report, "/distinctness", "distinctness", table);
  AddRow(report, "/leastDistinctness", "least distinctness", table);
  AddRow(report, "/searches", "searches", table);
  AddRow(report, "/beyondSearch", "at the end of what was searched", table);
  AddRow(report, "/ambiguous", "another tilt fits about as well", table);
  AddRow(report, "/centre", "centre of the pose, x y z (mm)", table);
  AddRow(
    report, "/standardDeviations", "standard deviations of x y z (mm) and of the turns about them (degrees)", table);
  AddRow(report, "/pointDeviation/mean", "standard deviation of a point, mean (mm)", table);
  AddRow(report, "/pointDeviation/largest", "standard deviation of a point, largest (mm)", table);
  AddRow(report, "/settledSupport/visible", "share of the surface that the CT shows", table);
  AddRow(report, "/settledSupport/supported", "share of that on an edge of the CT", table);
  AddRow(report, "/settledSupport/residualMm", "median distance to edges (mm)", table);
  for (const char * quantity : { "volumeMm3", "meanDensity", "massHuMm3" })
  {
    const std::string at = std::string("/posterior/") + quantity;
    AddRow(report, (at + "/mean").c_str(), quantity, table);
    AddRow(report, (at + "/standardDeviation").c_str(), std::string(quantity) + ", standard deviation", table);
  }
  AddRow(report, "/shape", "shape (standard deviations)", table);
  AddRow(report, "/density", "density (standard deviations)", table);
  return table;
}
} // namespace

ReportPage
MakeRegistrationPage(const std::string &         name,
                     const std::string &         command,
                     const nlohmann::json &      report,
                     const std::vector<Canvas> & views,
                     const MeshArrays &          bone)
{
  ReportPage page(name, command);
  page.BeginSection("result", "Result");
  page.AddTable(ResultTable(report));
  if (!views.empty())
  {
    page.BeginSection("views", "X-rays");
    for (std::size_t v = 0; v < views.size(); ++v)
    {
      const std::string title = "View " + std::to_string(v + 1);
      page.AddPicture(ToJpeg(views[v].GetImage()),
                      title +
                        ": X-ray with the outline of the bone, and what is left where its radiograph is subtracted",
                      title + ". Left: the X-ray with the outline of the bone where it was found; right: what is left "
                              "where the bone's radiograph is subtracted");
    }
  }
  page.BeginSection("bone", "Bone");
  page.AddModel(PackModel({ { "bone", &bone } }, nullptr, {}));
  return page;
}
} // namespace bone
