/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneResultPage_h
#define boneResultPage_h

#include "boneSession.h"

#include "boneReportPage.h"

#include <CLI/CLI.hpp>

namespace bone
{
/** \class PageOption
 * \brief The page that a command writes beside its result, and the option that leaves it out. */
class PageOption
{
public:
  /** Adds --no-page. */
  void
  AddTo(CLI::App * command);

  bool
  IsOn() const
  {
    return !m_Off;
  }

  /** Name of the page of a result: NAME.html of NAME.json, NAME.mrk.json or NAME. Empty where there is to be none. */
  std::string
  NameOf(const std::string & output) const;

private:
  bool m_Off{ false };
};

/** Adds warnings and provenance: how the command was called, its inputs with their checksums, parameters, machine and
 * times; writes the page. */
void
WritePage(ReportPage &                                        page,
          const std::string &                                 path,
          const Session &                                     session,
          std::vector<ParameterValue>                         parameters,
          const std::vector<std::pair<std::string, double>> & seconds);
} // namespace bone

#endif
