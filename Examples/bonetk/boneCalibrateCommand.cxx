/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCommands.h"
#include "boneOptions.h"

#include "boneDensityCalibration.h"
#include "boneMeshIO.h"
#include "boneReferenceRegion.h"

#include <nlohmann/json.hpp>

#include <fstream>
#include <iomanip>
#include <sstream>

namespace bone
{
namespace
{
using Json = nlohmann::json;

struct Options
{
  std::string         mesh;
  std::vector<double> line;
  std::string         to;
  std::string         references;
  std::string         ct;
  std::string         labels;
  std::string         law;
  std::string         output;
};

Vector3
Point(const Json & json)
{
  const auto values = json.get<std::array<double, 3>>();
  return { values[0], values[1], values[2] };
}

/** Images that references are measured in; read when first needed. */
struct Images
{
  const Options &     options;
  CTImage::Pointer    ct;
  LabelImage::Pointer labels;

  const CTImage &
  CT()
  {
    if (options.ct.empty())
    {
      throw UsageError("--ct is required: a reference is to be measured");
    }
    ct = ct.IsNull() ? ReadCT(options.ct) : ct;
    return *ct;
  }

  const LabelImage &
  Labels()
  {
    if (options.labels.empty())
    {
      throw UsageError("--labels is required: a reference is named by its label");
    }
    labels = labels.IsNull() ? ReadLabels(options.labels) : labels;
    return *labels;
  }
};

ReferenceStatistics
MeasureLabel(const CTImage & ct, const LabelImage & labels, int label)
{
  const std::size_t count = ct.GetBufferedRegion().GetNumberOfPixels();
  if (labels.GetBufferedRegion() != ct.GetBufferedRegion())
  {
    throw std::runtime_error("The label map's grid is not the CT's.");
  }
  ReferenceStatistics statistics;
  for (std::size_t v = 0; v < count; ++v)
  {
    if (labels.GetBufferPointer()[v] == label)
    {
      ++statistics.voxels;
      statistics.mean += ct.GetBufferPointer()[v];
    }
  }
  statistics.mean /= statistics.voxels > 0 ? static_cast<double>(statistics.voxels) : 1.0;
  return statistics;
}

CalibrationReference
ReadReference(const Json & json, Images & images)
{
  CalibrationReference reference;
  reference.name = json.at("name").get<std::string>();
  reference.density = json.at("density").get<double>();
  if (json.contains("value"))
  {
    reference.value = json.at("value").get<double>();
    return reference;
  }
  const ReferenceStatistics statistics =
    json.contains("label")
      ? MeasureLabel(images.CT(), images.Labels(), json.at("label").get<int>())
      : MeasureReference(images.CT(),
                         { Point(json.at("from")), Point(json.at("to")), json.at("radius").get<double>() });
  if (statistics.voxels == 0)
  {
    throw std::runtime_error("Reference '" + reference.name + "' holds no voxel of the CT.");
  }
  reference.value = statistics.mean;
  return reference;
}

Calibration
CalibrateFromFile(const Options & options, DensityQuantity to)
{
  Images                            images{ options, nullptr, nullptr };
  std::vector<CalibrationReference> references;
  try
  {
    std::ifstream file(options.references);
    if (!file)
    {
      throw std::runtime_error("cannot be read");
    }
    const Json json = Json::parse(file);
    for (const Json & item : json.at("references"))
    {
      references.push_back(ReadReference(item, images));
    }
  }
  catch (const UsageError &)
  {
    throw;
  }
  catch (const std::exception & error)
  {
    throw std::runtime_error(options.references + ": " + error.what());
  }
  return CalibrateDensity(references, to);
}

std::string
DescribeLaw(const DensityLaw & law)
{
  std::ostringstream text;
  text << std::setprecision(6) << DensityQuantityName(law.to) << " = " << law.intercept << " + " << law.slope << " * "
       << DensityQuantityName(law.from) << (law.source.empty() ? "" : "; " + law.source) << '\n';
  return text.str();
}

void
Apply(MeshArrays & mesh, const DensityLaw & law, Session & session)
{
  const double outside = ConvertDensity(mesh, law);
  session.Print(DescribeLaw(law));
  if (outside > 0.01)
  {
    std::ostringstream text;
    text << std::setprecision(3) << 100 * outside << " % of the volume lies outside the range " << law.low << " to "
         << law.high << ' ' << DensityQuantityName(law.from) << " of the law.";
    session.Warn(text.str());
  }
}

void
Run(const Options & options, Session & session)
{
  VerifyExtension(options.output, { ".vtu" });
  if (options.line.empty() && options.references.empty() && options.law.empty())
  {
    throw UsageError("--line, --references or --law is required");
  }
  MeshArrays mesh = ReadMeshArrays(options.mesh);
  if (!options.line.empty() || !options.references.empty())
  {
    if (options.to.empty())
    {
      throw UsageError("--to is required: it says what the line leads to");
    }
    const DensityQuantity to = ParseDensityQuantity(options.to);
    DensityLaw            law;
    if (options.references.empty())
    {
      law.to = to;
      law.intercept = options.line[0];
      law.slope = options.line[1];
      law.low = -std::numeric_limits<double>::infinity();
      law.high = -law.low;
    }
    else
    {
      const Calibration calibration = CalibrateFromFile(options, to);
      law = calibration.law;
      std::ostringstream text;
      text << std::setprecision(4) << "references: " << calibration.residuals.size() << ", root mean square residual "
           << calibration.rms << ' ' << DensityQuantityName(to) << ", correlation " << calibration.correlation << '\n';
      session.Print(text.str());
    }
    Apply(mesh, law, session);
  }
  if (!options.law.empty())
  {
    Apply(mesh, FindDensityLaw(options.law), session);
  }
  auto output = DensityMesh<double>::New();
  output->SetArrays(std::move(mesh));
  WriteDensityMesh(output.GetPointer(), options.output);
}
} // namespace

void
AddCalibrateCommand(CLI::App & app, Action & action)
{
  auto   options = std::make_shared<Options>();
  auto * command = app.add_subcommand("calibrate", "Turn Hounsfield units into mineral, ash or apparent density");
  command->add_option("mesh", options->mesh, "Density mesh (.vtu)")->required();
  auto * line =
    command->add_option("--line", options->line, "Intercept and slope: density = intercept + slope * HU")->expected(2);
  command
    ->add_option("--references",
                 options->references,
                 "Phantom rods or tissues of known density (.json), through which a line is fitted")
    ->excludes(line);
  command
    ->add_option(
      "--to", options->to, "What the line or the references give: k2hpo4, ha (mg/cm3), ash, apparent (g/cm3)")
    ->check(CLI::IsMember({ "k2hpo4", "ha", "ash", "apparent" }).description(""));
  command->add_option("--ct", options->ct, "CT that rods and tissues are measured in");
  command->add_option("--labels", options->labels, "Label map on the CT's grid for references named by a label");
  command
    ->add_option(
      "--law",
      options->law,
      "Published law, applied last: les1994 (k2hpo4 to ash), keyak2005 (ha to ash), schileo2008 (ash to apparent)")
    ->check(CLI::IsMember({ "les1994", "keyak2005", "schileo2008" }).description(""));
  command->add_option("-o,--output", options->output, "Mesh to write (.vtu)")->required();
  command->callback([options, &action] { action = [options](Session & session) { Run(*options, session); }; });
}
} // namespace bone
