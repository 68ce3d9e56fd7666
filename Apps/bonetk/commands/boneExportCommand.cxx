/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCommands.h"
#include "boneMeasureOptions.h"
#include "boneOptions.h"
#include "boneParameterOptions.h"
#include "boneResultPage.h"

#include "boneCurvedBoundary.h"
#include "boneDensityCalibration.h"
#include "boneFileName.h"
#include "boneFiniteElementIO.h"
#include "boneFiniteElementPage.h"
#include "boneHierarchyIO.h"
#include "boneMeshIO.h"

#include <filesystem>
#include <iomanip>
#include <sstream>

namespace bone
{
namespace
{
struct ExportOptions
{
  std::string             model;
  int                     level{ 1 };
  std::string             format;
  std::string             law;
  std::vector<double>     line;
  std::string             landmarks;
  std::string             surface;
  FiniteElementParameters parameters;
  std::string             output;
  PageOption              page;
};

MeshArrays
ReadLevel(const ExportOptions & options)
{
  if (HasExtension(options.model, ".vtu"))
  {
    if (options.level != 1)
    {
      throw UsageError("--level needs a hierarchy (.hierarchy.json): a mesh has one level");
    }
    return ReadDensityMesh(options.model)->GetArrays();
  }
  const auto   hierarchy = ReadHierarchy(options.model);
  const auto & levels = hierarchy->GetLevels();
  if (static_cast<std::size_t>(options.level) > levels.size())
  {
    throw UsageError("--level: " + options.model + " has " + std::to_string(levels.size()) + " levels");
  }
  return levels[static_cast<std::size_t>(options.level) - 1].mesh->GetArrays();
}

std::string
DescribeLaw(const ElasticityLaw & law)
{
  std::ostringstream text;
  text << law.name << ": " << law.DescribeRelation() << ", in MPa of " << DensityQuantityName(law.density) << ", for "
       << law.low << " to " << law.high << "; " << law.bone << "; " << law.source << '\n';
  return text.str();
}

/** Ash or apparent density, by the line of --line where it was given. */
void
CalibrateModel(const ExportOptions & options, const ElasticityLaw & law, MeshArrays & model)
{
  if (!options.line.empty())
  {
    DensityLaw line;
    line.to = law.density;
    line.intercept = options.line[0];
    line.slope = options.line[1];
    ConvertDensity(model, line);
  }
  else if (model.HasDensity() && model.quantity != DensityQuantity::AshGramPerCubicCentimetre &&
           model.quantity != DensityQuantity::ApparentGramPerCubicCentimetre)
  {
    throw UsageError(options.model + " holds " + DensityQuantityName(model.quantity) + ", and the law needs " +
                     DensityQuantityName(law.density) + ": use bonetk calibrate first, or --line INTERCEPT SLOPE");
  }
}

/** The nodes on the edges of the boundary onto the surface of a file, or of another model. */
void
CurveModel(const ExportOptions & options, FiniteElementModel & model, Session & session)
{
  std::vector<IdType>   ids;
  const TriangleSurface surface = HasExtension(options.surface, ".vtu")
                                    ? ExteriorSurface(ReadMeshArrays(options.surface), ids)
                                    : ReadTriangleSurface(options.surface);
  const CurvedBoundary  curved = CurveBoundary(TriangleDistance(surface.points, surface.triangles), model);
  std::ostringstream    text;
  text << std::setprecision(3) << curved.curved << " nodes of the boundary lie on " << options.surface << ", moved by "
       << curved.largestMove << " mm at the most; " << curved.refused << " stay on straight edges for their elements\n";
  session.Print(text.str());
}

void
Report(const FiniteElementModel & model, Session & session)
{
  std::ostringstream text;
  text << std::setprecision(3) << DescribeLaw(model.law) << model.elements.size() << " elements of "
       << model.NodesEach() << " nodes, " << model.nodes.size() << " nodes; Young's modulus "
       << *std::min_element(model.modulus.begin(), model.modulus.end()) << " to "
       << *std::max_element(model.modulus.begin(), model.modulus.end()) << " MPa\n";
  if (model.parameters.modulusField == ModulusField::Bins)
  {
    text << model.materials.size() << " materials; a modulus differs from its bin's by " << 100.0 * model.binErrorMean
         << " % on average, " << 100.0 * model.binErrorLargest << " % at the most\n";
  }
  text << model.softElements << " elements below " << model.parameters.leastModulus << " MPa were raised to it\n";
  for (const auto * sets : { &model.elementSets, &model.nodeSets })
  {
    text << (sets == &model.elementSets ? "element sets:" : "node sets:");
    for (const FiniteElementSet & set : *sets)
    {
      if (set.name.rfind("MAT_", 0) != 0)
      {
        text << ' ' << set.name << " (" << set.ids.size() << ')';
      }
    }
    text << '\n';
  }
  session.Print(text.str());
  if (model.shareOutside > 0.01)
  {
    std::ostringstream warning;
    warning << std::setprecision(3) << 100.0 * model.shareOutside << " % of the volume has a density outside "
            << model.law.low << " to " << model.law.high << ' ' << DensityQuantityName(model.law.density)
            << ", the range of " << model.law.name;
    session.Warn(warning.str());
  }
  if (model.order == 1)
  {
    session.Warn("elements of four nodes are too stiff, the more so the coarser the level: see the guide");
  }
}

void
RunExport(const ExportOptions & options, Session & session)
{
  if (options.law == "list")
  {
    for (const ElasticityLaw & law : PublishedElasticityLaws())
    {
      session.Print(DescribeLaw(law));
    }
    return;
  }
  if (options.model.empty() || options.output.empty() || options.format.empty())
  {
    throw UsageError("a model, --format and --output are required");
  }
  const auto          format = ParseChoice<FiniteElementFormat>(options.format);
  const auto          field = options.parameters.modulusField;
  const ElasticityLaw law = FindElasticityLaw(options.law);
  if (!options.surface.empty() && options.parameters.order == 1)
  {
    throw UsageError("--surface needs --order 2: elements of four nodes have straight edges");
  }
  VerifyOutputs(
    { { options.output, { FiniteElementExtension(format) } }, { options.page.NameOf(options.output), {} } });
  if (!HoldsModulusField(format, field))
  {
    throw UsageError("--modulus: a file for " + options.format + " holds moduli by bins, or by " +
                     (format == FiniteElementFormat::FEBio ? "cells" : "nodes"));
  }
  MeshArrays mesh = ReadLevel(options);
  CalibrateModel(options, law, mesh);
  const auto         landmarks = options.landmarks.empty() ? std::vector<Landmark>() : ReadLandmarks(options.landmarks);
  FiniteElementModel model = MakeFiniteElements(mesh, law, options.parameters, landmarks);
  Report(model, session);
  if (!options.surface.empty())
  {
    CurveModel(options, model, session);
  }
  WriteFiniteElements(model, format, options.output);
  if (options.page.IsOn())
  {
    std::vector<ParameterValue> parameters;
    AddParameters("export", options.parameters, parameters);
    const std::string name = std::filesystem::path(options.output).filename().string();
    ReportPage        page = MakeFiniteElementPage(name, model, mesh, landmarks);
    WritePage(page, options.page.NameOf(options.output), session, std::move(parameters), {});
  }
}
} // namespace

void
AddExportCommand(CLI::App & app, Action & action)
{
  auto   options = std::make_shared<ExportOptions>();
  auto * command = app.add_subcommand("export", "A finite-element mesh with materials and sets, for a solver");
  command->add_option("model", options->model, "Model with a density (.vtu, .hierarchy.json)");
  command->add_option("--level", options->level, "Level of a hierarchy, 1 the finest; default 1")
    ->check(CLI::Range(1, 1000).description(""));
  command->add_option("--format", options->format, "abaqus, calculix (.inp), febio (.feb), gmsh (.msh) or vtk (.vtu)")
    ->check(CLI::IsMember({ "abaqus", "calculix", "febio", "gmsh", "vtk" }).description(""))
    ->type_name(JoinChoices<FiniteElementFormat>());
  std::vector<std::string> names{ "list" };
  for (const ElasticityLaw & law : PublishedElasticityLaws())
  {
    names.push_back(law.name);
  }
  command->add_option("--law", options->law, "Young's modulus by density; list prints the laws with source and range")
    ->required()
    ->check(CLI::IsMember(names).description(""));
  command
    ->add_option("--line",
                 options->line,
                 "Intercept and slope of the law's density (g/cm^3) by HU, for a model that is not calibrated")
    ->expected(2);
  command->add_option(
    "--landmarks", options->landmarks, "Landmarks (.mrk.json), each a node set LM_NAME of the next node");
  command->add_option(
    "--surface",
    options->surface,
    "Closed surface (.stl, .ply, .vtp), or finer model (.vtu), that the nodes on the edges of the boundary "
    "are moved onto");
  AddParameterOptions(command, options->parameters);
  command->add_option("-o,--output", options->output, "File to write");
  options->page.AddTo(command);
  command->callback([options, &action] { action = [options](Session & session) { RunExport(*options, session); }; });
}
} // namespace bone
