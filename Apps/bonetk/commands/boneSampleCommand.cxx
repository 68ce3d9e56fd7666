/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCommands.h"
#include "boneOptions.h"
#include "boneParameterOptions.h"

#include "boneUntangling.h"
#include "boneMeshIO.h"
#include "boneModelIO.h"
#include "boneQualityMeasures.h"
#include "boneTriangleSurface.h"

#include <cmath>
#include <sstream>

namespace bone
{
namespace
{
struct SampleOptions
{
  std::string              input;
  std::vector<std::string> shape;
  std::vector<std::string> density;
  std::vector<std::string> combined;
  std::uint64_t            seed{ 0 };
  bool                     random{ false };
  double                   limit{ 3.0 };
  std::string              output;
};

/** Coefficients from "k=sigma", k counted from 1. */
Eigen::VectorXd
Coefficients(const std::vector<std::string> & settings, Eigen::Index modes, const std::string & option, double limit)
{
  Eigen::VectorXd coefficients = Eigen::VectorXd::Zero(modes);
  for (const std::string & setting : settings)
  {
    const auto equals = setting.find('=');
    long       mode = 0;
    double     value = std::nan("");
    if (equals == std::string::npos || !ParseNumber(setting.substr(0, equals), mode) ||
        !ParseNumber(setting.substr(equals + 1), value) || !std::isfinite(value) || mode < 1)
    {
      throw UsageError(option + " " + setting + " must be MODE=STANDARD_DEVIATIONS, such as 1=-2.5");
    }
    if (mode > modes)
    {
      throw UsageError(option + " " + setting + ": the model has " + std::to_string(modes) + " such modes");
    }
    if (std::abs(value) > limit)
    {
      std::ostringstream message;
      message << option << ' ' << setting << " is more than " << limit
              << " standard deviations from the mean, which hardly a member of the population is; --limit takes more";
      throw UsageError(message.str());
    }
    if (coefficients[mode - 1] != 0.0)
    {
      throw UsageError(option + " gives mode " + std::to_string(mode) + " twice");
    }
    coefficients[mode - 1] = value;
  }
  return coefficients;
}

/** Draws what the model has, within the paper's box. */
void
Draw(const SampleOptions & options, const StatisticalModel & model, Eigen::VectorXd & shape, Eigen::VectorXd & density)
{
  const auto & content = model.GetContent();
  if (model.IsCombined())
  {
    const auto b = SampleCoefficients(content.combined.variances.size(), options.seed);
    model.SplitCombined(ClampToBox(b, options.limit), shape, density);
    return;
  }
  const Eigen::Index    ks = content.shape.GetNumberOfModes(), kd = content.density.GetNumberOfModes();
  const Eigen::VectorXd both = ClampToBox(SampleCoefficients(ks + kd, options.seed), options.limit);
  shape = both.head(ks);
  density = both.tail(kd);
}

void
RunSample(const SampleOptions & options, Session & session)
{
  VerifyOutputs({ { options.output, { ".vtu" } } });
  const auto      model = ReadStatisticalModel(options.input);
  const auto &    content = model->GetContent();
  Eigen::VectorXd shape = Coefficients(options.shape, content.shape.GetNumberOfModes(), "--shape", options.limit);
  Eigen::VectorXd density =
    Coefficients(options.density, content.density.GetNumberOfModes(), "--density", options.limit);
  if (!options.combined.empty())
  {
    model->SplitCombined(
      Coefficients(options.combined, content.combined.variances.size(), "--combined", options.limit), shape, density);
  }
  if (options.random)
  {
    Draw(options, *model, shape, density);
  }
  MeshArrays          mesh = model->Synthesize(shape, density);
  std::vector<IdType> exterior;
  ExteriorSurface(content.mean, exterior);
  const auto report = UntangleMesh(content.mean, exterior, AffineMap(), mesh.points);
  if (report.before > 0)
  {
    const std::string inverted = "the shape inverts " + std::to_string(report.before) + " tetrahedra";
    if (report.after > 0)
    {
      throw std::runtime_error(inverted + ", of which " + std::to_string(report.after) +
                               " cannot be repaired: it is too far from the mean. Take smaller coefficients");
    }
    session.Warn(inverted + "; they were repaired");
  }
  WriteMeshArrays(mesh, options.output);
}
} // namespace

void
AddSampleCommand(CLI::App & app, Action & action)
{
  auto   options = std::make_shared<SampleOptions>();
  auto * command = app.add_subcommand("sample", "Make a model from the mean and modes of a statistical model");
  command->add_option("model", options->input, "Statistical model (.h5)")->required();
  auto * shape =
    command->add_option("--shape", options->shape, "Shape modes in standard deviations, such as 1=2 3=-1.5")
      ->type_name("MODE=SD ...");
  auto * density = command->add_option("--density", options->density, "Density modes in standard deviations")
                     ->type_name("MODE=SD ...");
  auto * combined = command->add_option("--combined", options->combined, "Combined modes in standard deviations")
                      ->type_name("MODE=SD ...")
                      ->excludes(shape)
                      ->excludes(density);
  auto * seed = command->add_option("--random", options->seed, "Draw a random member of the population with this seed")
                  ->excludes(shape)
                  ->excludes(density)
                  ->excludes(combined);
  command
    ->add_option("--limit",
                 options->limit,
                 "How many standard deviations from the mean a coefficient may be, given or random; default 3")
    ->check(Positive());
  command->add_option("-o,--output", options->output, "Mesh to write (.vtu)")->required();
  command->callback([options, seed, &action] {
    options->random = seed->count() > 0;
    action = [options](Session & session) { RunSample(*options, session); };
  });
}
} // namespace bone
