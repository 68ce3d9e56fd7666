/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneFiniteElementPage.h"

#include "boneChart.h"
#include "bonePageData.h"

#include <algorithm>
#include <iomanip>
#include <sstream>

namespace bone
{
namespace
{
std::string
Figures(double value, int digits = 4)
{
  std::ostringstream text;
  text << std::setprecision(digits) << value;
  return text.str();
}

PageTable
ModelTable(const FiniteElementModel & model)
{
  const auto & law = model.law;
  const auto   range = std::minmax_element(model.modulus.begin(), model.modulus.end());
  return { "",
           {},
           { { "elements",
               std::to_string(model.elements.size()) + " of " + std::to_string(model.NodesEach()) + " nodes" },
             { "nodes", std::to_string(model.nodes.size()) },
             { "law", law.name + ": " + law.DescribeRelation() + ", in MPa of " + DensityQuantityName(law.density) },
             { "law's bone and source", law.bone + "; " + law.source },
             { "law's range", Figures(law.low) + " to " + Figures(law.high) + ' ' + DensityQuantityName(law.density) },
             { "volume outside of it", Figures(100.0 * model.shareOutside, 3) + " %" },
             { "Young's modulus", Figures(*range.first) + " to " + Figures(*range.second) + " MPa" },
             { "materials", std::to_string(model.materials.size()) },
             { "modulus against its material's",
               Figures(100.0 * model.binErrorMean, 3) + " % on average, " + Figures(100.0 * model.binErrorLargest, 3) +
                 " % at the most" },
             { "elements raised to the least modulus", std::to_string(model.softElements) } } };
}

PageTable
SetTable(const std::string & caption, const std::vector<FiniteElementSet> & sets)
{
  PageTable table{ caption, { "Set", "Members" }, {} };
  for (const FiniteElementSet & set : sets)
  {
    if (set.name.rfind("MAT_", 0) != 0)
    {
      table.rows.push_back({ set.name, std::to_string(set.ids.size()) });
    }
  }
  return table;
}
} // namespace

ReportPage
MakeFiniteElementPage(const std::string &           name,
                      const FiniteElementModel &    model,
                      const MeshArrays &            mesh,
                      const std::vector<Landmark> & landmarks)
{
  ReportPage page(name, "export");
  page.BeginSection("elements", "Finite elements");
  page.AddTable(ModelTable(model));
  Histogram moduli;
  moduli.x.label = "Young's modulus (MPa)";
  moduli.y.label = "elements";
  moduli.values = model.modulus;
  const std::string what = "Young's moduli of the elements, before they are put into materials";
  page.AddPicture(DrawHistogram(moduli).GetSvg(), what, what);
  page.AddTable(SetTable("Element sets", model.elementSets));
  page.AddTable(SetTable("Node sets", model.nodeSets));
  page.BeginSection("model", "Density");
  page.AddModel(PackModel({ { name, &mesh } }, nullptr, landmarks));
  return page;
}
} // namespace bone
