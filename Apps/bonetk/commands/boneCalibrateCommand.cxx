/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCommands.h"
#include "boneInputOptions.h"
#include "boneOptions.h"
#include "boneParameterOptions.h"

#include "boneDensityCalibrationFilter.h"
#include "boneImageIO.h"
#include "boneJson.h"
#include "boneMeshIO.h"

#include <iomanip>
#include <sstream>

namespace bone
{
namespace
{
struct CalibrateOptions
{
  std::string                  mesh;
  DensityCalibrationParameters parameters;
  std::string                  references;
  std::string                  ct;
  std::string                  series;
  std::string                  labels;
  std::vector<std::string>     laws;
  std::string                  output;
};

DensityReference
ReadReference(const nlohmann::json & json)
{
  DensityReference reference;
  reference.name = TextMember(json, "name");
  reference.density = NumberMember(json, "density");
  if (json.contains("value"))
  {
    reference.measure = NumberMember(json, "value");
  }
  else if (json.contains("label"))
  {
    reference.measure = static_cast<int>(WholeMember(json, "label", -32768, 32767));
  }
  else
  {
    reference.measure = ReferenceRegion{ Vector3(NumbersMember(json, "from", 3)),
                                         Vector3(NumbersMember(json, "to", 3)),
                                         NumberMember(json, "radius") };
  }
  return reference;
}

std::vector<DensityReference>
ReadReferences(const std::string & path)
{
  const nlohmann::json document = ReadJsonFile(path);
  if (!document.is_object() || !document.contains("references") || !document["references"].is_array() ||
      document["references"].empty())
  {
    throw IOError(path, "must hold a list of one reference or more, 'references'");
  }
  std::vector<DensityReference> references;
  try
  {
    for (const nlohmann::json & item : document["references"])
    {
      references.push_back(ReadReference(item));
    }
  }
  catch (const itk::ExceptionObject & error)
  {
    throw IOError(path, "reference " + std::to_string(references.size() + 1) + ": " + ErrorLine(error));
  }
  return references;
}

/** Gives the filter the references and the images that these are measured in. */
void
UseReferences(const CalibrateOptions &            options,
              DensityQuantity                     to,
              DensityCalibrationFilter<CTImage> & filter,
              Session &                           session)
{
  const auto references = ReadReferences(options.references);
  for (const DensityReference & reference : references)
  {
    if (!std::holds_alternative<double>(reference.measure) && options.ct.empty())
    {
      throw UsageError("--ct is required: a reference is to be measured");
    }
    if (std::holds_alternative<int>(reference.measure) && options.labels.empty())
    {
      throw UsageError("--labels is required: a reference is named by its label");
    }
  }
  filter.SetReferences(references, to);
  if (options.ct.empty())
  {
    return;
  }
  const CTImage::Pointer ct = ReadChosenCT(options.ct, options.series, session);
  filter.SetImage(ct);
  if (!options.labels.empty())
  {
    filter.SetLabels(ReadLabelsOnGrid(options.labels, ct, session));
  }
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
Report(const DensityCalibrationFilter<CTImage> & filter, Session & session)
{
  if (const auto & calibration = filter.GetCalibration())
  {
    std::ostringstream text;
    text << std::setprecision(4) << "references: " << calibration->residuals.size() << ", root mean square residual "
         << calibration->rms << ' ' << DensityQuantityName(calibration->law.to) << ", correlation "
         << calibration->correlation << '\n';
    session.Print(text.str());
  }
  for (const auto & [law, outside] : filter.GetSteps())
  {
    session.Print(DescribeLaw(law));
    if (outside > 0.01)
    {
      std::ostringstream text;
      text << std::setprecision(3) << 100 * outside << " % of the volume lies outside the range " << law.low << " to "
           << law.high << ' ' << DensityQuantityName(law.from) << " of the law.";
      session.Warn(text.str());
    }
  }
}

void
RunCalibrate(const CalibrateOptions & options, Session & session)
{
  VerifyOutputs({ { options.output, { ".vtu" } } });
  const auto & [line, to] = options.parameters;
  if (line.empty() && options.references.empty() && options.laws.empty())
  {
    throw UsageError("--line, --references or --law is required");
  }
  if (to <= DensityQuantity::HounsfieldUnit && !(line.empty() && options.references.empty()))
  {
    throw UsageError("--to is required, k2hpo4, ha, ash or apparent: it says what the line leads to");
  }
  auto filter = DensityCalibrationFilter<CTImage>::New();
  filter->SetInput(ReadDensityMesh(options.mesh));
  if (!line.empty())
  {
    filter->SetLine(line[0], line[1], to);
  }
  else if (!options.references.empty())
  {
    UseReferences(options, to, *filter, session);
  }
  filter->SetLaws(options.laws);
  filter->Update();
  Report(*filter, session);
  WriteDensityMesh(filter->GetOutput(), options.output);
}
} // namespace

void
AddCalibrateCommand(CLI::App & app, Action & action)
{
  auto   options = std::make_shared<CalibrateOptions>();
  auto * command = app.add_subcommand("calibrate", "Turn Hounsfield units into mineral, ash or apparent density");
  command->add_option("mesh", options->mesh, "Density mesh (.vtu)")->required();
  AddParameterOptions(command, options->parameters);
  auto * line = command->get_option("--line")->expected(2);
  command
    ->add_option("--references",
                 options->references,
                 "Phantom rods or tissues of known density (.json), through which a line is fitted")
    ->excludes(line);
  command->add_option("--ct", options->ct, "CT that rods and tissues are measured in");
  AddSeriesOption(command, options->series);
  command->add_option("--labels", options->labels, "Label map for references named by a label");
  command
    ->add_option("--law",
                 options->laws,
                 "Published laws, applied last, in order: les1994 (k2hpo4 to ash), keyak2005 (ha to ash), schileo2008 "
                 "(ash to apparent)")
    ->check(CLI::IsMember({ "les1994", "keyak2005", "schileo2008" }).description(""))
    ->type_name("les1994|keyak2005|schileo2008");
  command->add_option("-o,--output", options->output, "Mesh to write (.vtu)")->required();
  command->callback([options, &action] { action = [options](Session & session) { RunCalibrate(*options, session); }; });
}
} // namespace bone
