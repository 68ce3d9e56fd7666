/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSession.h"

namespace bone
{
std::string
Session::GetPrinted() const
{
  const std::lock_guard<std::mutex> lock(m_ErrorMutex);
  return m_Printed;
}

std::string
Session::GetMessages() const
{
  const std::lock_guard<std::mutex> lock(m_ErrorMutex);
  return m_Messages;
}

std::vector<std::string>
Session::GetAllWarnings() const
{
  const std::lock_guard<std::timed_mutex> lock(m_Mutex);
  return m_AllWarnings;
}

std::string
Session::GetFailure() const
{
  const std::lock_guard<std::timed_mutex> lock(m_Mutex);
  return m_Failure;
}

Session::Position
Session::GetPosition() const
{
  const std::lock_guard<std::timed_mutex> lock(m_Mutex);
  const std::string                       stage = m_Progress.GetStage();
  return { (stage.empty() || m_Subject.empty() ? "" : m_Subject + ": ") + stage, m_Progress.GetShare() };
}

void
Session::RequestStop()
{
  m_StopRequested = true;
  const std::lock_guard<std::timed_mutex> lock(m_Mutex);
  for (const auto & [run, filter] : m_Running)
  {
    filter->SetAbortGenerateData(true);
  }
}

void
Session::ThrowIfStopped() const
{
  if (m_StopRequested)
  {
    throw itk::ProcessAborted(__FILE__, __LINE__);
  }
}
} // namespace bone
