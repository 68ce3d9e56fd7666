/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCommands.h"
#include "boneOptions.h"
#include "boneParameterOptions.h"

#include "boneAtomicFile.h"
#include "boneBuildEvaluation.h"
#include "boneBuildPlan.h"
#include "boneContourIO.h"
#include "boneGeometryIO.h"
#include "boneHierarchyIO.h"
#include "boneStageClock.h"
#include "boneStagingFolder.h"

#include <chrono>
#include <exception>
#include <filesystem>
#include <regex>
#include <sstream>

namespace bone
{
namespace
{
struct BuildOptions
{
  std::string        ct;
  BoneOptions        bone;
  std::string        output;
  BuildParameters    parameters;
  BuildFiles         files;   ///< of the report that the parameters come from
  std::exception_ptr failure; ///< of reading it
};

/** What the command line names; without a CT what the report names that the parameters come from. */
BuildFiles
FilesOf(const BuildOptions & options)
{
  if (options.ct.empty() && options.files.image.empty())
  {
    throw UsageError("ct is required: an image file, or the folder of a DICOM series");
  }
  if (options.ct.empty())
  {
    return options.files;
  }
  options.bone.Verify();
  return { options.ct, options.bone.labels, options.bone.init, options.bone.structure };
}

BuildInput
ReadInput(const BuildFiles & files, const BuildPlanParameters & plan)
{
  const CTImage::Pointer ct = ReadCT(files.image);
  const BoneInput bone = ReadBone({ files.labels, files.initialContours, files.structure }, plan.label, plan.axis);
  return CropToBone(ct, bone.labels, bone.contours, plan);
}

void
WriteOutputs(const Evaluation &  evaluation,
             const BuildReport & report,
             BuildPipeline &     pipeline,
             StagingFolder &     staging)
{
  const auto in = [&staging](const std::string & name) { return staging.GetPath() + "/" + name; };
  WriteContours(pipeline.GetMedialAxis()->GetOutput(), in("contours.vtp"));
  WriteHierarchy(pipeline.GetCollapse()->GetOutput(), in("model"));
  auto geometry = const_cast<XRayGeometry *>(pipeline.GetRadiograph(0)->GetGeometry());
  WriteGeometry({ geometry }, in("drr_geometry.json"));
  for (std::size_t level = 0; level < pipeline.GetNumberOfLevels(); ++level)
  {
    WriteImage(pipeline.GetRadiograph(level)->GetOutput(), in("drr_L" + std::to_string(level + 1) + ".mha"));
  }
  WriteImage(evaluation.slices, in("slices.png"));
  WriteImage(evaluation.cutPlane, in("cut_plane.png"));
  WriteImage(evaluation.radiographs, in("radiographs.png"));
  WriteFileAtomically(in("report.txt"), ToText(report));
  WriteFileAtomically(in("report.json"), ToJson(report));
  static const std::regex ofALevel("(model|drr)_L[0-9]+\\.(vtu|mha)");
  staging.Commit([](const std::string & name) { return std::regex_match(name, ofALevel); });
}

/** Whether an output's name is that of a folder in the output folder, which is to be found out before the work. */
void
VerifyFolder(const std::string & folder)
{
  std::error_code error;
  for (const auto & entry : std::filesystem::directory_iterator(folder, error))
  {
    static const std::regex output("(contours|model|drr|slices|cut_plane|radiographs|report)[._].*");
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
  const auto resolution = PlanBuild(input, parameters, pipeline, [&](const Resolution & tried, IdType count) {
    std::ostringstream line;
    line << "slices " << tried.sliceStep << " mm, contour points at most " << tried.contourSpacing
         << " mm apart: " << count << " tetrahedra\n";
    session.Print(line.str());
  });
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

void
RunBuild(const BuildOptions & options, Session & session)
{
  if (options.failure)
  {
    std::rethrow_exception(options.failure);
  }
  const BuildPlanParameters & plan = options.parameters.plan;
  BuildReport                 report;
  report.version = BONETK_VERSION;
  report.files = FilesOf(options);
  report.parameters = options.parameters;
  StagingFolder staging(options.output);
  VerifyFolder(options.output);
  Lap              lap;
  const BuildInput input = ReadInput(report.files, plan);
  report.times.emplace_back("reading", lap());

  BuildPipeline pipeline(plan.levels.size() + 1);
  StageClock    clock(pipeline.GetStages());
  for (const auto & [name, filter] : pipeline.GetStages())
  {
    session.Watch(filter, name);
  }
  report.resolution = Plan(input, options.parameters, pipeline, session);
  try
  {
    FinishBuild(plan, nullptr, pipeline);
  }
  catch (const std::invalid_argument & error)
  {
    throw UsageError(std::string("--") + error.what());
  }
  lap();
  for (const auto & entry : clock.GetSeconds())
  {
    report.times.push_back(entry);
  }

  const Evaluation evaluation = Evaluate(pipeline, { input.ct, input.mask });
  report.times.emplace_back("evaluation", lap());
  pipeline.GetParameters(report.parameters);
  const ContourStack * slices = pipeline.GetSlices()->GetOutput();
  report.slices = slices->GetSlices().size();
  report.meanSliceDistance = slices->GetMeanSliceDistance();
  report.tiling = pipeline.GetTiling()->GetReport();
  report.levels = evaluation.levels;
  for (const std::string & doubt : FindDoubts(plan, report.levels))
  {
    session.WarnAlways(doubt);
  }
  report.warnings = session.GetWarnings();
  WriteOutputs(evaluation, report, pipeline, staging);
  session.Print("\n" + ToText(report) + "\nwritten to " + options.output + "\n");
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
  options->bone.AddTo(command);
  command->add_option("-o,--output", options->output, "Folder for models, contours, pictures and report")->required();
  AddParameterOptions(command, options->parameters.plan);
  AddParameterOptions(command, options->parameters.fit, { "degree", "continuous" });
  AddAxisOption(command, options->parameters.plan.axis);
  command->callback([options, &action] { action = [options](Session & session) { RunBuild(*options, session); }; });
}
} // namespace bone
