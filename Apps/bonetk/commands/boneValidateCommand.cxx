/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCommands.h"
#include "boneDescribe.h"

#include "boneMeshIO.h"
#include "boneMeshValidator.h"

#include <iomanip>
#include <sstream>

namespace bone
{
namespace
{
void
RunValidate(const std::string & path, Session & session)
{
  const MeshArrays     mesh = ReadMeshArrays(path);
  const MeshValidation result = ValidateMesh(mesh);
  std::ostringstream   text;
  for (const MeshCheck & check : result.checks)
  {
    text << std::left << std::setw(28) << check.name << (check.failures == 0 ? "ok" : "FAILED") << '\n';
    for (const std::string & example : check.examples)
    {
      text << "    " << example << '\n';
    }
  }
  text << "components                  " << result.components << '\n'
       << "boundary's Euler number     " << result.boundaryEuler << '\n'
       << DescribeQuality(mesh);
  session.Print(text.str());
  if (!result.IsValid())
  {
    throw std::runtime_error(path + " is invalid: " + result.Summary());
  }
}
} // namespace

void
AddValidateCommand(CLI::App & app, Action & action)
{
  auto   path = std::make_shared<std::string>();
  auto * command =
    app.add_subcommand("validate", "Check topology, orientation and quality of a mesh; exit 1 if invalid");
  command->add_option("mesh", *path, "Mesh (.vtu)")->required();
  command->callback([path, &action] { action = [path](Session & session) { RunValidate(*path, session); }; });
}
} // namespace bone
