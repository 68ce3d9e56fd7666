/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneStageClock_h
#define boneStageClock_h

#include "boneBuildPipeline.h"

#include <chrono>
#include <memory>

namespace bone
{
/** \class StageClock
 * \brief Counts how often each stage of a pipeline runs, and for how long, by ITK's start and end events. */
class StageClock
{
public:
  explicit StageClock(const std::vector<BuildPipeline::Stage> & stages);

  /** Runs of a stage since the clock was made or reset. */
  int
  GetRuns(const std::string & stage) const;
  /** Seconds spent in each stage, in the pipeline's order. */
  std::vector<std::pair<std::string, double>>
  GetSeconds() const;
  void
  Reset();

private:
  struct Entry
  {
    std::string                           name;
    int                                   runs{ 0 };
    double                                seconds{ 0.0 };
    std::chrono::steady_clock::time_point start;
  };
  std::vector<std::shared_ptr<Entry>> m_Entries;
};
} // namespace bone

#endif
