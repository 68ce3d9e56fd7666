/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneCommands_h
#define boneCommands_h

#include "boneSession.h"

#include <CLI/CLI.hpp>

#include <functional>

namespace bone
{
/** What a command does once its options are parsed. */
using Action = std::function<void(Session &)>;

/** \defgroup Commands The commands of bonetk
 * Each adds a subcommand with its options; parsing it sets `action`.
 * \{ */
void
AddPhantomCommand(CLI::App & app, Action & action);
void
AddCropCommand(CLI::App & app, Action & action);
void
AddContoursCommand(CLI::App & app, Action & action);
void
AddMeshCommand(CLI::App & app, Action & action);
void
AddSmoothCommand(CLI::App & app, Action & action);
void
AddFitCommand(CLI::App & app, Action & action);
void
AddCalibrateCommand(CLI::App & app, Action & action);
void
AddVoxelsCommand(CLI::App & app, Action & action);
void
AddProfileCommand(CLI::App & app, Action & action);
void
AddSimplifyCommand(CLI::App & app, Action & action);
void
AddBuildCommand(CLI::App & app, Action & action);
void
AddDrrCommand(CLI::App & app, Action & action);
void
AddTrainCommand(CLI::App & app, Action & action);
void
AddSampleCommand(CLI::App & app, Action & action);
void
AddRegisterCommand(CLI::App & app, Action & action);
/** To the group `register`. */
void
AddRegisterDeformCommand(CLI::App & group, Action & action);
/** To the group `register`. */
void
AddRegisterSubjectCommand(CLI::App & group, Action & action);
/** To the group `register`. */
void
AddRegisterVolumeCommand(CLI::App & group, Action & action);
void
AddLabelCommand(CLI::App & app, Action & action);
void
AddEvaluateCommand(CLI::App & app, Action & action);
void
AddMeasureCommand(CLI::App & app, Action & action);
void
AddThicknessCommand(CLI::App & app, Action & action);
void
AddPlanCommand(CLI::App & app, Action & action);
void
AddExportCommand(CLI::App & app, Action & action);
void
AddValidateCommand(CLI::App & app, Action & action);
void
AddInfoCommand(CLI::App & app, Action & action);
/** \} */
} // namespace bone

#endif
