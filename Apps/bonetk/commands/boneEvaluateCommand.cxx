/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCommands.h"
#include "boneOptions.h"
#include "boneParameterOptions.h"
#include "boneResultPage.h"

#include "boneAtlasReport.h"
#include "boneAtomicFile.h"
#include "boneIOError.h"
#include "boneModelIO.h"
#include "bonePopulation.h"
#include "boneSubjectPage.h"

#include <filesystem>
#include <iomanip>
#include <sstream>

namespace bone
{
namespace
{
struct EvaluateOptions
{
  std::string                 model;
  std::string                 atlas;
  std::string                 ct;
  AtlasRegistrationParameters registration;
  std::string                 output;
  PageOption                  page;
};

std::string
Describe(const char * what, const Usualness & of)
{
  constexpr Eigen::Index most = 6;
  std::ostringstream     text;
  text << what << std::fixed << std::setprecision(2);
  for (Eigen::Index k = 0; k < std::min(most, of.scores.size()); ++k)
  {
    text << ' ' << of.scores[k];
  }
  text << (of.scores.size() > most ? " ..." : "") << " standard deviations; " << std::setprecision(1)
       << 100.0 * of.probability << " % of bones are as far from the mean or further";
  return text.str();
}

void
RunEvaluate(const EvaluateOptions & options, Session & session)
{
  VerifyOutputs({ { options.output, { ".json" } }, { options.page.NameOf(options.output), {} } });
  const auto   atlas = ReadStatisticalModel(options.atlas);
  const auto & content = atlas->GetContent();
  auto         standard = DensityMesh<double>::New();
  standard->SetArrays(content.mean);
  PopulationRegistration population(standard, std::max(content.mean.maximumDegree, 0));
  population.GetFilter()->SetParameters(options.registration);
  session.Watch(population.GetFilter(), "registration");
  MeshArrays subject;
  try
  {
    subject = population.Bring(SubjectFiles{ "subject", options.model, options.ct });
  }
  catch (const IOError &)
  {
    throw;
  }
  catch (const itk::ExceptionObject & error)
  {
    throw IOError(options.model, ErrorLine(error));
  }
  const SubjectEvaluation result = EvaluateSubject(content, subject);
  nlohmann::json          report =
    ReportSubject(result, population.WasRegistered() ? &population.GetFilter()->GetReport() : nullptr);
  report["model"] = options.model;
  report["atlas"] = options.atlas;
  std::ostringstream text;
  text << Describe("shape", result.shape) << '\n'
       << std::fixed << std::setprecision(2) << "  " << result.shapeResidual
       << " mm from the nearest shape of the modes (the atlas' own subjects, left out: " << result.shapeTypical
       << " mm)\n";
  if (result.hasDensity)
  {
    text << Describe("density", result.density) << '\n'
         << "  " << std::setprecision(0) << result.densityResidual.meanAbsolute
         << " HU (mean) from the nearest density of the modes\n";
  }
  WriteFileAtomically(options.output, report.dump(1) + "\n");
  session.Print(text.str());
  if (result.shapeTypical > 0.0 && result.shapeResidual > 3.0 * result.shapeTypical)
  {
    session.WarnAlways(options.model + ": the shape is no bone of this atlas, or wrongly registered: it is three times "
                                       "as far from the modes as the atlas' own subjects");
  }
  if (options.page.IsOn())
  {
    const std::string name = std::filesystem::path(options.model).filename().string();
    ReportPage        page = MakeSubjectPage(name, result, subject, content);
    WritePage(page, options.page.NameOf(options.output), session, {}, {});
  }
}
} // namespace

void
AddEvaluateCommand(CLI::App & app, Action & action)
{
  auto   options = std::make_shared<EvaluateOptions>();
  auto * command =
    app.add_subcommand("evaluate", "A subject against an atlas: coefficients, residual, and how unusual it is");
  command->add_option("model", options->model, "Mesh (.vtu) or closed surface (.ply, .vtp, .stl) of the subject")
    ->required();
  command->add_option("atlas", options->atlas, "Statistical model (.h5)")->required();
  command->add_option("--ct", options->ct, "The subject's CT, for the density of a surface; default: the mesh's own");
  AddParameterOptions(command, options->registration, { "mirror" });
  options->page.AddTo(command);
  command->add_option("-o,--output", options->output, "Evaluation to write (.json)")->required();
  command->callback([options, &action] { action = [options](Session & session) { RunEvaluate(*options, session); }; });
}
} // namespace bone
