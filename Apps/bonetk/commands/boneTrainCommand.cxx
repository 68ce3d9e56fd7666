/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneBuildRequest.h"
#include "boneCommands.h"
#include "boneDescribe.h"
#include "boneOptions.h"
#include "boneParameterOptions.h"
#include "boneResultPage.h"
#include "bonePopulation.h"
#include "boneRegisteredSubjects.h"

#include "boneAtlasReport.h"
#include "boneAtomicFile.h"
#include "boneFileName.h"
#include "boneIOError.h"
#include "boneModelIO.h"
#include "boneOutputTransaction.h"
#include "boneStagingFolder.h"
#include "boneStatisticalModelEstimator.h"

#include <filesystem>
#include <iomanip>
#include <optional>
#include <sstream>

namespace bone
{
namespace
{
struct TrainOptions
{
  std::string                list;
  std::string                standard;
  bool                       similarity{ false };
  SubjectRegistrationOptions registration;
  StatisticalModelParameters model;
  std::string                registered;
  std::string                from;
  std::string                atlas;
  std::string                evaluation;
  PageOption                 page;
  std::string                output;
};

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
  AddParameters("registration", options.registration.parameters, parameters);
  ReportPage page = MakeAtlasPage(model, report, std::filesystem::path(options.output).filename().string());
  WritePage(page, options.page.NameOf(options.output), session, std::move(parameters), {});
}

/** The file of the model that subjects are brought onto: a mesh, or the atlas that they are added to. */
std::string
StandardOf(const TrainOptions & options, const std::vector<SubjectFiles> & subjects)
{
  if (!options.standard.empty())
  {
    return options.standard;
  }
  if (!options.atlas.empty())
  {
    return options.atlas;
  }
  if (!HasExtension(subjects.front().shape, ".vtu"))
  {
    throw UsageError("the standard model " + subjects.front().shape + " must be a mesh (.vtu): put one first in " +
                     options.list + ", or give --standard");
  }
  return subjects.front().shape;
}

/** What a subject's registration is made of. */
nlohmann::json
RequestFor(const TrainOptions & options, const std::string & standard, const SubjectFiles & subject)
{
  std::vector<ParameterValue> parameters;
  AddParameters("registration", options.registration.parameters, parameters);
  nlohmann::json asked{ { "degree", options.registration.degree } };
  for (const ParameterValue & parameter : parameters)
  {
    asked[parameter.name] = parameter.value;
  }
  return DescribeRequest({ { "standard", standard }, { "shape", subject.shape }, { "ct", subject.ct } },
                         std::move(asked));
}

/** Registers the list's subjects, each to a file of the folder, so that only one is in memory at a time. A folder that
 * is to be kept gets them one by one, and those that it has already are not made again. */
FileTrainingSet::Pointer
RegisterSubjects(const TrainOptions & options, const std::string & folder, Session & session)
{
  const std::vector<SubjectFiles> subjects = ReadSubjectList(options.list, options.atlas.empty() ? 2 : 1);
  const std::string               standard = StandardOf(options, subjects);
  PopulationRegistration          population(ReadStandard(standard), options.registration.degree);
  VerifySubjects(subjects);
  population.GetFilter()->SetParameters(options.registration.parameters);
  session.Expect(
    { { "registration", 10.0, static_cast<int>(subjects.size()) }, { "training", 2.0 }, { "writing", 1.0 } });
  session.Watch(population.GetFilter(), "registration");
  const bool kept = !options.registered.empty();
  if (kept)
  {
    session.kept.push_back(options.registered); // its record, and subjects of earlier runs
  }
  RegistrationRecord record(folder);
  auto               set = FileTrainingSet::New();
  for (const SubjectFiles & subject : subjects)
  {
    const std::string    name = RegisteredName(set->GetNumberOfSubjects(), subject), path = folder + '/' + name;
    const nlohmann::json request = kept ? RequestFor(options, standard, subject) : nlohmann::json();
    set->AddSubject(subject.name, path);
    if (record.Holds(name, request))
    {
      session.Print(subject.name + " is registered: the same inputs, parameters and program as before\n");
      continue;
    }
    WriteMeshArrays(BringSubject(population, subject), path);
    if (kept)
    {
      OutputTransaction::CommitTaken();
      record.Note(name, request);
    }
    session.Print(DescribeRegistration(subject, population));
  }
  return set;
}

/** Tells of outliers, and of modes that explain less than was asked for. */
void
WarnOfModel(const TrainOptions & options, const StatisticalModelEstimator<> & estimator, Session & session)
{
  for (const SubjectDeviation & subject : estimator.GetSubjectDeviations())
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
  const auto & content = estimator.GetOutput()->GetContent();
  const auto   warn = [&](const PrincipalModes & modes, const char * what) {
    const double explained = modes.totalVariance > 0 ? modes.variances.sum() / modes.totalVariance : 1.0;
    if (options.model.maximumModes == 0 && explained < options.model.varianceProportion - 1e-6)
    {
      std::ostringstream os;
      os << "the modes of " << what << " explain " << std::setprecision(3) << 100 * explained
         << " % of the variance, not " << 100 * options.model.varianceProportion << " %: "
         << (options.atlas.empty() ? "more of them need more --memory, or a larger --modes"
                                     : "what the atlas left out of its subjects is lost; train it anew with a larger "
                                       "--variance to keep more");
      session.Warn(os.str());
    }
  };
  warn(content.shape, "shape");
  if (estimator.GetOutput()->HasDensity())
  {
    warn(content.density, "density");
  }
}

void
VerifyTrainOptions(const TrainOptions & options)
{
  if (options.list.empty() == options.from.empty())
  {
    throw UsageError("give either a list of subjects, or a folder of registered ones with --from");
  }
  if (!options.from.empty() && (!options.standard.empty() || !options.registered.empty()))
  {
    throw UsageError("--from takes subjects that are registered: it does not go with --standard or --registered");
  }
  VerifyOutputs({ { options.output, { ".h5" } },
                  { options.evaluation, { ".json" } },
                  { options.page.NameOf(options.output), {} } });
}

void
RunTrain(const TrainOptions & options, Session & session)
{
  VerifyTrainOptions(options);
  const StatisticalModel::Pointer atlas = options.atlas.empty() ? nullptr : ReadStatisticalModel(options.atlas);
  std::optional<StagingFolder>    staging; // of what is not kept
  FileTrainingSet::Pointer        set;
  if (!options.from.empty())
  {
    set = ListRegistered(options.from);
    session.Expect({ { "training", 2.0 }, { "writing", 1.0 } });
  }
  else if (options.registered.empty())
  {
    staging.emplace(options.output + ".registered");
    set = RegisterSubjects(options, staging->GetPath(), session);
  }
  else
  {
    std::error_code error;
    std::filesystem::create_directory(options.registered, error);
    if (!std::filesystem::is_directory(options.registered))
    {
      RefuseToWrite(options.registered, "cannot make the folder", error.value());
    }
    set = RegisterSubjects(options, options.registered, session);
  }

  auto estimator = StatisticalModelEstimator<>::New();
  estimator->SetInput(set);
  estimator->SetAtlas(atlas);
  estimator->SetParameters(options.model);
  if (options.similarity)
  {
    estimator->SetAlignment(AlignmentKind::Similarity);
  }
  session.Watch(estimator, "training");
  estimator->Update();
  WarnOfModel(options, *estimator, session);
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
  session.Print('\n' + DescribeModel(*estimator->GetOutput()));
}
} // namespace

void
AddTrainCommand(CLI::App & app, Action & action)
{
  auto   options = std::make_shared<TrainOptions>();
  auto * command =
    app.add_subcommand("train", "Train a statistical model of shape and density from a list of subjects");
  command->add_option(
    "list",
    options->list,
    "Text file with a subject a line: mesh (.vtu) or closed surface (.ply, .vtp, .stl), and after a comma its "
    "CT, if its density is to be fitted. Subjects on another topology than the standard model's are registered");
  command->add_option("--from",
                      options->from,
                      "Folder of registered subjects, in place of a list: of --registered, or `register subject`");
  command->add_option("--add",
                      options->atlas,
                      "Atlas (.h5) that the subjects are added to, without its own subjects: they are aligned to its "
                      "mean, which is the standard model too, and its product of densities stays");
  command->add_option("--standard", options->standard, "Standard model (.vtu); default: the list's first subject");
  command->add_flag("--similarity", options->similarity, "Take size out of the shapes");
  AddParameterOptions(command,
                      options->model,
                      { "varianceProportion",
                        "maximumModes",
                        "combined",
                        "coefficientProduct",
                        "withinCellWeight",
                        "outlierThreshold",
                        "rejectOutliers",
                        "memory" });
  options->registration.AddTo(command);
  command->add_option(
    "--evaluation",
    options->evaluation,
    "Compactness, generalisation by leave-one-out and specificity, and how far each subject is from the "
    "mean, to write (.json)");
  options->page.AddTo(command);
  command->add_option("--registered",
                      options->registered,
                      "Folder to keep the registered subjects in, each as soon as it is done: a run that was ended "
                      "goes on from there; default: none");
  command->add_option("-o,--output", options->output, "Statistical model to write (.h5)")->required();
  command->callback([options, &action] { action = [options](Session & session) { RunTrain(*options, session); }; });
}
} // namespace bone
