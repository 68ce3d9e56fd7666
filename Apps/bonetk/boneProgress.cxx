/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneProgress.h"

#include <algorithm>

namespace bone
{
void
Progress::Expect(const std::vector<ExpectedStage> & stages, double from, double to)
{
  m_Stages.clear();
  m_Runs.clear();
  for (const ExpectedStage & stage : stages)
  {
    m_Stages.push_back({ stage, 0.0, 0 });
  }
  m_From = from;
  m_To = to;
  this->Update();
}

int
Progress::Begin(const std::string & name)
{
  if (m_Stages.empty())
  {
    m_Stages.push_back({ { name, 1.0 }, 0.0, 0 });
  }
  if (const Stage * begun = this->Find(name); begun != nullptr && begun->expected.runs == 1)
  {
    for (Stage * before = m_Stages.data(); before != begun; ++before)
    {
      before->ended = before->expected.runs;
      before->done = before->expected.runs;
    }
  }
  m_Runs.push_back({ ++m_LastRun, name, Clock::now() });
  this->Update();
  return m_LastRun;
}

void
Progress::Report(int run, double share)
{
  const auto found = this->FindRun(run);
  if (Stage * stage = found == m_Runs.end() ? nullptr : this->Find(found->name))
  {
    stage->done = std::max(stage->done, stage->ended + std::clamp(share, 0.0, 1.0));
    this->Update();
  }
}

std::string
Progress::End(int run, double & seconds)
{
  const auto found = this->FindRun(run);
  if (found == m_Runs.end())
  {
    return {};
  }
  seconds = std::chrono::duration<double>(Clock::now() - found->start).count();
  if (Stage * stage = this->Find(found->name))
  {
    stage->done = std::max(stage->done, static_cast<double>(++stage->ended));
  }
  const std::string name = found->name;
  m_Runs.erase(found);
  this->Update();
  return name;
}

void
Progress::GiveUp(int run)
{
  const auto found = this->FindRun(run);
  if (found != m_Runs.end())
  {
    m_Runs.erase(found);
  }
}

std::string
Progress::GetStage() const
{
  return m_Runs.empty() ? std::string() : m_Runs.back().name;
}

Progress::Stage *
Progress::Find(const std::string & name)
{
  const auto found =
    std::find_if(m_Stages.begin(), m_Stages.end(), [&name](const Stage & s) { return s.expected.name == name; });
  return found == m_Stages.end() ? nullptr : &*found;
}

std::vector<Progress::Run>::iterator
Progress::FindRun(int run)
{
  return std::find_if(m_Runs.begin(), m_Runs.end(), [run](const Run & r) { return r.id == run; });
}

void
Progress::Update()
{
  double done = 0.0, all = 0.0;
  for (const Stage & stage : m_Stages)
  {
    done += stage.expected.seconds * std::min(stage.done, static_cast<double>(stage.expected.runs));
    all += stage.expected.seconds * stage.expected.runs;
  }
  m_Share = std::max(m_Share, m_From + (all > 0.0 ? done / all : 0.0) * (m_To - m_From));
}
} // namespace bone
