/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneAtlasInputs.h"
#include "boneBuildInformation.h"
#include "boneBuildRequest.h"
#include "boneCommands.h"
#include "boneInputOptions.h"
#include "boneOptions.h"
#include "boneParameterOptions.h"
#include "boneResultPage.h"

#include "boneAtomicFile.h"
#include "boneBuildPage.h"
#include "boneBuildPlan.h"
#include "boneContourIO.h"
#include "boneExecution.h"
#include "boneGeometryIO.h"
#include "boneHierarchyIO.h"
#include "boneIOError.h"
#include "boneLabelCrop.h"
#include "boneMemory.h"
#include "boneMeshIO.h"
#include "boneOutputTransaction.h"
#include "boneRegistrationReport.h"
#include "boneStageClock.h"
#include "boneStagingFolder.h"

#include <algorithm>
#include <chrono>
#include <cctype>
#include <cstring>
#include <exception>
#include <filesystem>
#include <iomanip>
#include <regex>
#include <sstream>

namespace bone
{
namespace
{
/** The atlas that finds the bone. */
struct AtlasOptions
{
  std::string           file;
  AtlasVolumeParameters parameters;
};

struct BuildOptions
{
  std::string        ct;
  std::string        series;
  BoneOptions        bone;
  AtlasOptions       atlas; ///< in place of a label map
  std::string        output;
  BuildParameters    parameters;
  BuildFiles         files;   ///< of the report that the parameters come from
  std::exception_ptr failure; ///< of reading it
  PageOption         page;
  bool               force{ false };
};

/** What the command line names; without a CT, what the report names that the parameters come from. */
BuildOptions
Complete(BuildOptions options)
{
  if (options.failure)
  {
    std::rethrow_exception(options.failure);
  }
  const BuildFiles & former = options.files;
  if (options.ct.empty() && former.image.empty())
  {
    throw UsageError("ct is required: an image file, or the folder of a DICOM series");
  }
  std::vector<std::string> & wanted = options.bone.labels.wanted;
  if (options.ct.empty())
  {
    options.ct = former.image;
    options.series = former.series;
    options.bone = { { former.labels, wanted, former.labelNames }, former.initialContours, former.structure };
    options.atlas.file = former.atlas;
  }
  if (options.atlas.file.empty() && wanted.empty() && (!former.labelName.empty() || options.parameters.plan.label != 0))
  {
    wanted = { former.labelName.empty() ? std::to_string(options.parameters.plan.label) : former.labelName };
  }
  if (options.atlas.file.empty())
  {
    options.bone.Verify();
  }
  else if (!options.bone.labels.file.empty() || !options.bone.init.empty() || !wanted.empty())
  {
    throw UsageError("--atlas finds the bone by itself: leave --labels, --label and --init out");
  }
  const std::string conflict = FindConflict(options.parameters.fit);
  if (!conflict.empty())
  {
    throw UsageError(conflict);
  }
  return options;
}

void
WriteBuildPage(const Evaluation &  evaluation,
               const BuildReport & report,
               BuildPipeline &     pipeline,
               const std::string & path,
               const Session &     session)
{
  std::vector<ParameterValue> parameters;
  BuildParameters::Visit(report.parameters, [&parameters](const std::string & stage, const auto & of) {
    AddParameters(stage, of, parameters);
  });
  ReportPage page = MakeBuildPage(report, evaluation, pipeline);
  WritePage(page, path, session, std::move(parameters), report.times);
}

/** What is asked for; null where a repetition could not be known. */
nlohmann::json
RequestOf(const BuildOptions & options)
{
  const BoneOptions &         bone = options.bone;
  nlohmann::json              asked{ { "series", options.series },
                        { "label", bone.labels.wanted },
                        { "structure", bone.structure },
                        { "page", options.page.IsOn() },
                        { "parameters", nlohmann::json::parse(ToJson(options.parameters)) } };
  std::vector<ParameterValue> atlas;
  AddParameters("atlas", options.atlas.parameters, atlas);
  for (const ParameterValue & parameter : atlas)
  {
    asked["atlas"][parameter.name] = parameter.value;
  }
  return DescribeRequest({ { "image", options.ct },
                           { "labels", bone.labels.file },
                           { "labelNames", bone.labels.names },
                           { "initialContours", bone.init },
                           { "atlas", options.atlas.file } },
                         std::move(asked));
}

std::vector<std::pair<std::string, std::uintmax_t>>
FilesIn(const std::string & folder)
{
  std::vector<std::pair<std::string, std::uintmax_t>> files;
  for (const auto & entry : std::filesystem::directory_iterator(folder))
  {
    files.emplace_back(entry.path().filename().string(), entry.file_size());
  }
  std::sort(files.begin(), files.end());
  return files;
}

/** Models, radiographs and pictures into a folder. */
void
WriteResults(const Evaluation &  evaluation,
             const BuildReport & report,
             BuildPipeline &     pipeline,
             const std::string & folder)
{
  const auto in = [&folder](const std::string & name) { return folder + "/" + name; };
  WriteContours(pipeline.GetContours(), in("contours.vtp"));
  WriteHierarchy(pipeline.GetHierarchy(), in("model"), report.parameters.storage);
  auto geometry = const_cast<XRayGeometry *>(pipeline.GetRadiograph(0)->GetGeometry());
  WriteGeometry({ geometry }, in("drr_geometry.json"));
  for (std::size_t level = 0; level < pipeline.GetNumberOfLevels(); ++level)
  {
    WriteImage(pipeline.GetRadiograph(level)->GetOutput(), in("drr_L" + std::to_string(level + 1) + ".mha"));
    if (const auto spline = pipeline.GetSpline(level))
    {
      WriteDensityMesh(
        spline.GetPointer(), in("spline_L" + std::to_string(level + 1) + ".vtu"), report.parameters.storage);
    }
  }
  WriteFileAtomically(in("slices.png"), evaluation.slices.png);
  WriteFileAtomically(in("cut_plane.png"), evaluation.cutPlane.png);
  WriteFileAtomically(in("radiographs.png"), evaluation.radiographs.png);
}

/** All files beside the report are there. */
void
WriteReports(BuildReport & report, StagingFolder & staging)
{
  const auto in = [&staging](const std::string & name) { return staging.GetPath() + "/" + name; };
  WriteFileAtomically(in("report.txt"), ToText(report));
  report.outputs = FilesIn(staging.GetPath());
  WriteFileAtomically(in("report.json"), ToJson(report));
  static const std::regex optional("(model|spline|drr)_L[0-9]+\\.(vtu|mha)|report\\.html");
  staging.Commit([](const std::string & name) { return std::regex_match(name, optional); });
}

/** Whether an output's name is that of a folder in the output folder, which is to be found out before the work. */
void
VerifyFolder(const std::string & folder)
{
  std::error_code error;
  for (const auto & entry : std::filesystem::directory_iterator(folder, error))
  {
    static const std::regex output("(contours|model|spline|drr|slices|cut_plane|radiographs|report)[._].*");
    if (entry.is_directory(error) && std::regex_match(entry.path().filename().string(), output))
    {
      throw UsageError(entry.path().string() +
                       " is a folder where a file may be written: rename it, or give another -o");
    }
  }
}

/** Finds the resolution, telling of each trial; the quality stage is then up to date. */
Resolution
Plan(const BuildInput & input, const BuildParameters & parameters, BuildPipeline & pipeline, Session & session)
{
  const auto doubt = [&] {
    for (const std::string & line : pipeline.GetSnake()->GetReport().doubts)
    {
      session.WarnAlways(line);
    }
  };
  Resolution resolution;
  try
  {
    resolution = PlanBuild(input, parameters, pipeline, [&](const Resolution & tried, IdType count) {
      std::ostringstream line;
      line << "slices " << tried.sliceStep << " mm, contour points at most " << tried.contourSpacing
           << " mm apart: about " << count << " tetrahedra\n";
      session.Print(line.str());
    });
  }
  catch (...)
  {
    doubt(); // it may be why
    throw;
  }
  doubt();
  for (const std::string & warning : pipeline.GetWarnings())
  {
    session.Warn(warning);
  }
  return resolution;
}

/** Seconds since it was last asked. */
class Lap
{
public:
  double
  operator()()
  {
    const auto   now = std::chrono::steady_clock::now();
    const double seconds = std::chrono::duration<double>(now - m_Before).count();
    m_Before = now;
    return seconds;
  }

private:
  std::chrono::steady_clock::time_point m_Before{ std::chrono::steady_clock::now() };
};

/** What is built of one bone, and where. */
struct BuildJob
{
  BoneInput                input;
  std::string              folder;
  double                   secondsOfReading{ 0.0 };
  std::string              registration; ///< of the atlas, as JSON; empty without one
  double                   from{ 0.0 };  ///< its work begins at this share of the command's
  double                   to{ 1.0 };
  std::string              request; ///< as JSON; empty where a repetition could not be known
  std::vector<std::string> bones;   ///< folders of several that are built together
};

/** Of the command's progress: reading the CT, or finding the bone in it by an atlas. */
constexpr double shareOfReading = 0.03, shareOfAtlas = 0.6;

/** The stages of a build, with the seconds of a bone of 30,000 tetrahedra. */
void
ExpectStages(const BuildJob & job, const BuildPlanParameters & plan, Session & session)
{
  const int                  trials = plan.contourSpacing > 0.0 ? 1 : 4;
  std::vector<ExpectedStage> stages{ { "contours", 2.0, job.input.bone.labels ? 1 : 2 },
                                     { "slices", 0.3, trials },
                                     { "resample", 0.1, trials },
                                     { "medial axis", 0.05, trials },
                                     { "tiling", 1.2, trials },
                                     { "quality", 5.0 },
                                     { "fit", 0.4 },
                                     { "collapse", 3.0 },
                                     { "evaluation", 1.0 },
                                     { "writing", 1.0 } };
  session.Expect(stages, job.from, job.to);
}

BuildReport
BuildBone(const BuildOptions & options, const CTImage * ct, const BuildJob & job, Session & session)
{
  const LabelledBone & bone = job.input.bone;
  const LabelOptions & labels = options.bone.labels;
  BuildParameters      parameters = options.parameters;
  parameters.plan.label = bone.label;
  if (!job.registration.empty())
  {
    DrawOutlineToEdges(*ct, parameters.contours);
  }
  const BuildPlanParameters & plan = parameters.plan;
  BuildReport                 report;
  report.version = GetBuildInformation().version;
  report.files = { options.ct,        options.series,         labels.file,       labels.names, bone.name,
                   options.bone.init, options.bone.structure, options.atlas.file };
  report.request = job.request;
  report.bones = job.bones;
  report.registration = job.registration;
  StagingFolder staging(job.folder);
  VerifyFolder(job.folder);
  Lap              reading;
  const BuildInput input = CropToBone(ct, bone, job.input.contours, plan);
  report.times.emplace_back("reading", job.secondsOfReading + reading());

  ExpectStages(job, plan, session);
  BuildPipeline pipeline(plan.levels.size() + 1);
  StageClock    clock(pipeline.GetStages());
  for (const auto & [name, filter] : pipeline.GetStages())
  {
    session.Watch(filter, name);
  }
  report.resolution = Plan(input, parameters, pipeline, session);
  BuildEvaluator evaluator({ input.ct, input.labels, ct }, options.page.IsOn(), pipeline);
  try
  {
    FinishBuild(plan, nullptr, pipeline);
  }
  catch (const std::invalid_argument & error)
  {
    throw UsageError(std::string("--") + error.what());
  }
  for (const auto & entry : clock.GetSeconds())
  {
    report.times.push_back(entry);
  }

  Lap              lap;
  const Evaluation evaluation = [&] {
    const auto stage = session.BeginStage("evaluation");
    return evaluator.Finish();
  }();
  report.times.emplace_back("evaluation", lap());
  pipeline.GetParameters(parameters);
  report.parameters = parameters;
  const ContourStack * slices = pipeline.GetSlices()->GetOutput();
  report.slices = slices->GetSlices().size();
  report.meanSliceDistance = slices->GetMeanSliceDistance();
  report.brighterShare = pipeline.GetSnake()->GetReport().brighterShare;
  report.tiling = pipeline.GetTiling()->GetReport();
  report.levels = evaluation.levels;
  report.doubts = pipeline.GetSnake()->GetReport().doubts;
  for (const std::string & doubt : FindDoubts(plan, report.levels))
  {
    session.WarnAlways(doubt);
  }
  report.warnings = session.GetWarnings();
  {
    const auto stage = session.BeginStage("writing");
    ReturnFreedMemory(); // files and page are made at once
    auto page = RunBeside([&] {
      if (options.page.IsOn())
      {
        WriteBuildPage(evaluation, report, pipeline, staging.GetPath() + "/report.html", session);
      }
    });
    WriteResults(evaluation, report, pipeline, staging.GetPath());
    page.get();
    WriteReports(report, staging);
  }
  session.Print("\n" + ToText(report) + "\nwritten to " + job.folder + "\n");
  return report;
}

/** The name of a bone's folder: its own where it is fit to be one, else its label's. */
std::string
FolderName(const LabelledBone & bone)
{
  std::string name = bone.name.empty() ? "label_" + std::to_string(bone.label) : bone.name;
  std::replace_if(
    name.begin(),
    name.end(),
    [](unsigned char c) { return c < 128 && std::isalnum(c) == 0 && std::strchr("_-.", c) == nullptr; },
    '_');
  return name.front() == '.' ? "_" + name : name;
}

std::vector<BuildJob>
JobsOf(std::vector<BoneInput> bones, const std::string & folder, double seconds, const std::string & request)
{
  std::vector<std::string> names;
  for (const BoneInput & input : bones)
  {
    names.push_back(FolderName(input.bone));
    if (std::find(names.begin(), names.end() - 1, names.back()) != names.end() - 1)
    {
      throw UsageError("--label: " + names.back() + " is the folder of two bones; build one of them by itself");
    }
  }
  if (bones.size() == 1)
  {
    return { { std::move(bones.front()), folder, seconds, "", shareOfReading, 1.0, request, {} } };
  }
  const double          part = (1.0 - shareOfReading) / static_cast<double>(bones.size());
  std::vector<BuildJob> jobs;
  for (std::size_t i = 0; i < bones.size(); ++i)
  {
    const double from = shareOfReading + static_cast<double>(i) * part;
    jobs.push_back({ std::move(bones[i]), folder + "/" + names[i], seconds, "", from, from + part, request, names });
  }
  return jobs;
}

/** A line for each bone that was built. */
void
PrintTable(const std::vector<BuildReport> & reports, Session & session)
{
  std::ostringstream table;
  table << std::left << std::setw(28) << "\nbone" << std::right << std::setw(12) << "tetrahedra" << std::setw(16)
        << "volume (cm^3)" << std::setw(8) << "Dice" << std::setw(10) << "valid\n"
        << std::fixed;
  for (const BuildReport & report : reports)
  {
    const LevelReport & level = report.levels.front();
    const std::string   label = std::to_string(report.parameters.plan.label);
    table << std::left << std::setw(27) << (report.files.labelName.empty() ? label : report.files.labelName)
          << std::right << std::setw(12) << level.tetrahedra << std::setw(16) << std::setprecision(1)
          << 1e-3 * level.volume << std::setw(8) << std::setprecision(3) << level.dice.value_or(0.0) << std::setw(9)
          << (level.valid ? "yes" : "NO") << '\n';
  }
  session.Print(table.str());
}

/** Several bones: each that is done is kept, whatever comes of the others. */
void
BuildBones(const BuildOptions & options, const CTImage * ct, const std::vector<BuildJob> & jobs, Session & session)
{
  std::error_code error;
  std::filesystem::create_directory(options.output, error); // where it cannot be made the first bone says so
  const std::size_t        common = session.GetWarnings().size();
  std::vector<BuildReport> reports;
  std::string              failed;
  bool                     machine = false;
  std::size_t              failures = 0;
  for (const BuildJob & job : jobs)
  {
    session.subject = std::filesystem::path(job.folder).filename().string();
    try
    {
      if (options.force || job.request.empty() || !IsBuilt(job.folder, nlohmann::json::parse(job.request), session))
      {
        reports.push_back(BuildBone(options, ct, job, session));
        OutputTransaction::CommitTaken();
      }
    }
    catch (const UsageError &)
    {
      throw;
    }
    catch (const MachineError &)
    {
      throw; // as the next one's would not be written either
    }
    catch (const std::exception & problem)
    {
      session.Fail(problem);
      machine = machine || IsOfTheMachine(problem);
      failed += (failures++ == 0 ? "" : ", ") + session.subject;
    }
    session.ForgetWarnings(common);
  }
  session.subject.clear();
  if (!reports.empty())
  {
    PrintTable(reports, session);
  }
  if (failures > 0)
  {
    std::filesystem::remove(options.output, error); // where it is empty
    const std::string message =
      std::to_string(failures) + " of " + std::to_string(jobs.size()) + " bones could not be built: " + failed;
    if (machine)
    {
      throw MachineError(options.ct, message);
    }
    throw IOError(options.ct, message);
  }
}

/** The bone that the atlas finds, as a label map of its own. */
BuildJob
FindByAtlas(const BuildOptions & options, const CTImage * ct, const std::string & request, Session & session)
{
  const auto          found = FindInCT(options.atlas.file, ct, options.atlas.parameters, session);
  LabelImage::Pointer labels = MaskOfLabel(found->GetLabelImage(), 0);
  BuildJob            job{ { { labels, 1, "" }, nullptr }, options.output, 0.0, "", shareOfAtlas, 1.0, request, {} };
  job.registration = ReportRegistration(found->GetResult()).dump();
  return job;
}

void
RunBuild(const BuildOptions & given, Session & session)
{
  const BuildOptions options = Complete(given);
  for (const std::string & file :
       given.ct.empty() ? std::vector<std::string>{ options.ct, options.bone.labels.file } : std::vector<std::string>())
  {
    session.inputs.push_back(file); // which the report names
  }
  { // Found out before the work.
    const StagingFolder probe(options.output);
    VerifyFolder(options.output);
  }
  const nlohmann::json asked = RequestOf(options);
  if (!options.force && (IsBuilt(options.output, asked, session) || AreBuilt(options.output, asked, session)))
  {
    return;
  }
  const std::string request = asked.is_null() ? "" : asked.dump();
  const bool        atlas = !options.atlas.file.empty();
  session.Expect(
    { { "reading", 1.0 }, { "register", atlas ? 30.0 : 0.0 } }, 0.0, atlas ? shareOfAtlas : shareOfReading);
  auto reading = std::make_unique<Session::Stage>(session, "reading");
  Lap  lap;
  // Contours alone, and an atlas, need all of the CT.
  const bool            byRegion = !options.bone.labels.file.empty();
  VolumeSource::Pointer source;
  CTImage::Pointer      ct;
  if (byRegion)
  {
    source = OpenChosenCT(options.ct, options.series, session);
    ct = source->GetOutput();
  }
  else
  {
    ct = ReadChosenCT(options.ct, options.series, session);
  }
  if (atlas)
  {
    reading.reset();
    BuildJob job = FindByAtlas(options, ct, request, session);
    job.secondsOfReading = lap();
    BuildBone(options, ct, job, session);
    return;
  }
  auto bones = ReadBones(options.bone, options.parameters.plan.axis, ct, session, byRegion);
  reading.reset();
  const auto jobs = JobsOf(std::move(bones), options.output, lap(), request);
  if (jobs.size() == 1)
  {
    BuildBone(options, ct, jobs.front(), session);
  }
  else
  {
    BuildBones(options, ct, jobs, session);
  }
}
} // namespace

void
AddBuildCommand(CLI::App & app, Action & action)
{
  auto   options = std::make_shared<BuildOptions>();
  auto * command =
    app.add_subcommand("build", "The whole job: from a CT to a hierarchy of density models, with a report");
  // First, as options that follow override what it reads.
  command
    ->add_option_function<std::string>(
      "--parameters",
      [options](const std::string & path) {
        try
        {
          ReadBuildParameters(path, options->parameters, options->files);
        }
        catch (const std::exception &)
        {
          options->failure = std::current_exception();
        }
      },
      "Parameters of all stages, from the report.json of a build; other options override them. Without a CT the "
      "report's "
      "own build is repeated")
    ->type_name("FILE");
  command->add_option("ct", options->ct, "CT: an image file, or the folder of a DICOM series");
  AddSeriesOption(command, options->series);
  options->bone.AddTo(command, true);
  command->add_option("--atlas",
                      options->atlas.file,
                      "Statistical model with density (.h5) that finds the bone, in place of a label map or contours");
  AddParameterOptions(command, options->atlas.parameters, { "mirror" });
  command
    ->add_option("-o,--output",
                 options->output,
                 "Folder for models, contours, pictures and report; with several bones that of their folders")
    ->required();
  AddParameterOptions(command, options->parameters.plan);
  AddParameterOptions(
    command, options->parameters.fit, { "degree", "continuous", "continuousGradient", "maximumError" });
  AddParameterOptions(command, options->parameters.collapse, { "improveAngles" });
  command->get_option("--max-error")
    ->excludes(command->get_option("--continuous"))
    ->excludes(command->get_option("--continuous-gradient"));
  AddStorageOptions(command, options->parameters.storage);
  options->page.AddTo(command);
  command->add_flag(
    "--force",
    options->force,
    "Build again what is there from the same inputs, parameters and program; default: it is left as it is");
  AddAxisOption(command, options->parameters.plan.axis);
  command->callback([options, &action] { action = [options](Session & session) { RunBuild(*options, session); }; });
}
} // namespace bone
