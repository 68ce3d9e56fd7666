/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneStageClock.h"

namespace bone
{
StageClock::StageClock(const std::vector<BuildPipeline::Stage> & stages)
{
  for (const auto & [name, filter] : stages)
  {
    auto entry = std::make_shared<Entry>();
    entry->name = name;
    m_Entries.push_back(entry);
    filter->AddObserver(itk::StartEvent(), [entry](const itk::EventObject &) {
      ++entry->runs;
      entry->start = std::chrono::steady_clock::now();
    });
    filter->AddObserver(itk::EndEvent(), [entry](const itk::EventObject &) {
      entry->seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - entry->start).count();
    });
  }
}

int
StageClock::GetRuns(const std::string & stage) const
{
  for (const auto & entry : m_Entries)
  {
    if (entry->name == stage)
    {
      return entry->runs;
    }
  }
  return 0;
}

std::vector<std::pair<std::string, double>>
StageClock::GetSeconds() const
{
  std::vector<std::pair<std::string, double>> seconds;
  for (const auto & entry : m_Entries)
  {
    seconds.emplace_back(entry->name, entry->seconds);
  }
  return seconds;
}

void
StageClock::Reset()
{
  for (const auto & entry : m_Entries)
  {
    entry->runs = 0;
    entry->seconds = 0.0;
  }
}
} // namespace bone
