/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCommands.h"
#include "boneDescribe.h"
#include "boneOptions.h"
#include "boneParameterOptions.h"
#include "boneResultPage.h"
#include "bonePopulation.h"

#include "boneAtlasReport.h"
#include "boneAtomicFile.h"
#include "boneFileName.h"
#include "boneIOError.h"
#include "boneModelIO.h"
#include "boneStagingFolder.h"
#include "boneStatisticalModelEstimator.h"

#include <filesystem>
#include <iomanip>
#include <sstream>

namespace bone
{
namespace
{
struct TrainOptions
{
  std::string                 list;
  std::string                 standard;
  int                         degree{ 2 };
  bool                        similarity{ false };
  AtlasRegistrationParameters registration;
  StatisticalModelParameters  model;
  std::string                 registered;
  std::string                 evaluation;
  PageOption                  page;
  std::string                 output;
};

std::string
RegistrationLine(const SubjectFiles &           subject,
                 const PopulationRegistration & population,
                 const RegistrationReport &     report)
{
  std::ostringstream os;
  os << std::left << std::setw(28) << subject.name << std::setprecision(3);
  if (!population.WasRegistered())
  {
    os << "on the standard model's topology";
  }
  else
  {
    os << report.surfaceDistance << " mm to the subject, " << report.subjectDistance << " mm back"
       << (report.mirrored ? ", mirrored" : "");
    if (report.untangling.before > 0)
    {
      os << ", " << report.untangling.before << " inverted tetrahedra repaired";
    }
  }
  os << '\n';
  return os.str();
}

/** Leave-one-out evaluation where it was asked for, or where it takes but seconds. */
AtlasReport
EvaluateTraining(const TrainOptions &                options,
                 const TrainingSet &                 set,
                 const StatisticalModelEstimator<> & estimator,
                 Session &                           session)
{
  constexpr std::size_t few = 40;
  AtlasReport           report;
  report.subjects = estimator.GetSubjectDeviations();
  const std::size_t count = set.GetNumberOfSubjects();
  if (!options.evaluation.empty() || (options.page.IsOn() && count >= 3 && count <= few))
  {
    const auto stage = session.BeginStage("evaluation");
    EvaluateAtlas(set, *estimator.GetOutput(), report);
  }
  return report;
}

void
WriteTrainingPage(const TrainOptions &     options,
                  const StatisticalModel & model,
                  const AtlasReport &      report,
                  const Session &          session)
{
  std::vector<ParameterValue> parameters;
  AddParameters("training", options.model, parameters);
  AddParameters("registration", options.registration, parameters);
  ReportPage page = MakeAtlasPage(model, report, std::filesystem::path(options.output).filename().string());
  WritePage(page, options.page.NameOf(options.output), session, std::move(parameters), {});
}

void
RunTrain(const TrainOptions & options, Session & session)
{
  VerifyOutputs({ { options.output, { ".h5" } },
                  { options.evaluation, { ".json" } },
                  { options.page.NameOf(options.output), {} } });
  const std::vector<SubjectFiles> subjects = ReadSubjectList(options.list);
  const std::string               standard = options.standard.empty() ? subjects.front().shape : options.standard;
  if (!HasExtension(standard, ".vtu"))
  {
    throw UsageError("the standard model " + standard + " must be a mesh (.vtu): put one first in " + options.list +
                     ", or give --standard");
  }
  PopulationRegistration population(ReadDensityMesh(standard), options.degree);
  VerifySubjects(subjects);
  population.GetFilter()->SetParameters(options.registration);
  session.Expect(
    { { "registration", 10.0, static_cast<int>(subjects.size()) }, { "training", 2.0 }, { "writing", 1.0 } });
  session.Watch(population.GetFilter(), "registration");

  // Registered subjects go to files, so that only one is in memory at a time.
  StagingFolder folder(options.registered.empty() ? options.output + ".registered" : options.registered);
  auto          set = FileTrainingSet::New();
  for (const SubjectFiles & subject : subjects)
  {
    MeshArrays mesh;
    try
    {
      mesh = population.Bring(subject);
    }
    catch (const IOError &)
    {
      throw;
    }
    catch (const itk::ExceptionObject & error)
    {
      throw IOError(subject.shape, ErrorLine(error));
    }
    std::ostringstream name;
    name << folder.GetPath() << '/' << std::setw(4) << std::setfill('0') << set->GetNumberOfSubjects() + 1 << '_'
         << subject.name << ".vtu";
    WriteMeshArrays(mesh, name.str());
    set->AddSubject(subject.name, name.str());
    session.Print(RegistrationLine(subject, population, population.GetFilter()->GetReport()));
  }

  auto estimator = StatisticalModelEstimator<>::New();
  estimator->SetInput(set);
  estimator->SetParameters(options.model);
  if (options.similarity)
  {
    estimator->SetAlignment(AlignmentKind::Similarity);
  }
  session.Watch(estimator, "training");
  estimator->Update();
  for (const SubjectDeviation & subject : estimator->GetSubjectDeviations())
  {
    if (subject.outlier)
    {
      std::ostringstream os;
      os << subject.name << " is an outlier: " << subject.shape << " mm and " << subject.density
         << " density units from the mean (scores " << subject.shapeScore << ", " << subject.densityScore << ')'
         << (subject.used ? "" : "; left out");
      session.Warn(os.str());
    }
  }
  const AtlasReport report = EvaluateTraining(options, *set, *estimator, session);
  const auto        writing = session.BeginStage("writing");
  WriteStatisticalModel(estimator->GetOutput(), options.output);
  if (!options.evaluation.empty())
  {
    WriteFileAtomically(options.evaluation, ReportAtlas(report).dump(1) + '\n');
  }
  if (options.page.IsOn())
  {
    WriteTrainingPage(options, *estimator->GetOutput(), report, session);
  }
  if (!options.registered.empty())
  {
    folder.Commit();
  }
  session.Print('\n' + DescribeModel(*estimator->GetOutput()));
}
} // namespace

void
AddTrainCommand(CLI::App & app, Action & action)
{
  auto   options = std::make_shared<TrainOptions>();
  auto * command =
    app.add_subcommand("train", "Train a statistical model of shape and density from a list of subjects");
  command
    ->add_option(
      "list",
      options->list,
      "Text file with a subject a line: mesh (.vtu) or closed surface (.ply, .vtp, .stl), and after a comma its "
      "CT, if its density is to be fitted. Subjects on another topology than the standard model's are registered")
    ->required();
  command->add_option("--standard", options->standard, "Standard model (.vtu); default: the list's first subject");
  command->add_option("--degree", options->degree, "Degree of densities that are fitted, 0 to 8; default 2")
    ->check(CLI::Range(0, MaximumBernsteinDegree).description(""));
  command->add_flag("--similarity", options->similarity, "Take size out of the shapes");
  AddParameterOptions(command,
                      options->model,
                      { "varianceProportion",
                        "maximumModes",
                        "combined",
                        "coefficientProduct",
                        "withinCellWeight",
                        "outlierThreshold",
                        "rejectOutliers" });
  AddParameterOptions(command, options->registration, { "mirror", "method", "interior", "exteriorBound" });
  command->add_option(
    "--evaluation",
    options->evaluation,
    "Compactness, generalisation by leave-one-out and specificity, and how far each subject is from the "
    "mean, to write (.json)");
  options->page.AddTo(command);
  command->add_option("--registered", options->registered, "Folder to keep the registered subjects in; default: none");
  command->add_option("-o,--output", options->output, "Statistical model to write (.h5)")->required();
  command->callback([options, &action] { action = [options](Session & session) { RunTrain(*options, session); }; });
}
} // namespace bone
