/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCommands.h"
#include "boneOptions.h"
#include "boneRegisteredSubjects.h"

#include <filesystem>

namespace bone
{
namespace
{
struct RegisterSubjectOptions
{
  std::string                standard;
  SubjectFiles               subject;
  SubjectRegistrationOptions registration;
  std::string                output;
};

void
RunRegisterSubject(const RegisterSubjectOptions & options, Session & session)
{
  VerifyOutputs({ { options.output, { ".vtu" } } });
  SubjectFiles subject = options.subject;
  subject.name = std::filesystem::path(options.output).stem().string();
  PopulationRegistration population(ReadStandard(options.standard), options.registration.degree);
  population.GetFilter()->SetParameters(options.registration.parameters);
  session.Expect({ { "registration", 10.0 }, { "writing", 1.0 } });
  session.Watch(population.GetFilter(), "registration");
  const MeshArrays mesh = BringSubject(population, subject);
  const auto       stage = session.BeginStage("writing");
  WriteMeshArrays(mesh, options.output);
  session.Print(DescribeRegistration(subject, population));
}
} // namespace

void
AddRegisterSubjectCommand(CLI::App & group, Action & action)
{
  auto   options = std::make_shared<RegisterSubjectOptions>();
  auto * command = group.add_subcommand("subject",
                                        "A standard model carried to one subject, with the subject's density: what "
                                        "`train` does for each of its list, one at "
                                        "a time; `train --from` takes the folder of the results");
  command->add_option("standard", options->standard, "Standard model: a mesh (.vtu), or an atlas (.h5) for its mean")
    ->required();
  command
    ->add_option("shape", options->subject.shape, "The subject: a mesh (.vtu) or a closed surface (.ply, .vtp, .stl)")
    ->required();
  command->add_option("--ct",
                      options->subject.ct,
                      "CT that the density is fitted to; default: the density of the subject's mesh, if any");
  options->registration.AddTo(command);
  command->add_option("-o,--output", options->output, "Mesh to write (.vtu), on the standard model's topology")
    ->required();
  command->callback(
    [options, &action] { action = [options](Session & session) { RunRegisterSubject(*options, session); }; });
}
} // namespace bone
