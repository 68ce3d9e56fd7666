/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneExecution.h"

#include <itkMultiThreaderBase.h>
#include <itkProcessObject.h>

#include <atomic>
#include <exception>
#include <mutex>
#include <thread>

namespace bone
{
struct Execution::State
{
  itk::ProcessObject *            filter{ nullptr };
  itk::MultiThreaderBase::Pointer threader;
  std::thread::id                 caller{ std::this_thread::get_id() };
  double                          reported{ 0.0 }; ///< the caller's alone
};

namespace
{
/** Whether this thread is in a loop's body: a pool that waits for itself would wait for ever. */
thread_local bool inLoop = false;

class LoopScope
{
public:
  LoopScope() { inLoop = true; }
  ~LoopScope() { inLoop = false; }
};
} // namespace

Execution::Execution()
  : m_State(std::make_shared<State>())
{
  m_State->threader = itk::MultiThreaderBase::New();
}

Execution::Execution(itk::ProcessObject * filter, double from, double to)
  : m_State(std::make_shared<State>())
  , m_From(from)
  , m_To(to)
{
  m_State->filter = filter;
  m_State->threader = filter->GetMultiThreader();
  m_State->threader->SetNumberOfWorkUnits(filter->GetNumberOfWorkUnits());
  m_State->reported = from;
}

Execution
Execution::Part(double from, double to) const
{
  Execution    part(*this);
  const double length = m_To - m_From;
  part.m_From = m_From + from * length;
  part.m_To = m_From + to * length;
  return part;
}

bool
Execution::IsAborted() const
{
  return m_State->filter != nullptr && m_State->filter->GetAbortGenerateData();
}

void
Execution::ThrowIfAborted() const
{
  if (this->IsAborted())
  {
    throw itk::ProcessAborted(__FILE__, __LINE__);
  }
}

void
Execution::Report(double share) const
{
  constexpr double least = 0.002; // an observer may be slow: a person sees no smaller steps
  State &          state = *m_State;
  const double     progress = m_From + std::clamp(share, 0.0, 1.0) * (m_To - m_From);
  constexpr double end = 1.0 - 1e-9;
  const bool       shows = progress >= state.reported + least || (progress >= end && state.reported < end);
  if (state.filter != nullptr && shows && std::this_thread::get_id() == state.caller)
  {
    state.reported = progress;
    state.filter->UpdateProgress(static_cast<float>(progress));
  }
  this->ThrowIfAborted();
}

unsigned int
Execution::GetNumberOfWorkUnits() const
{
  return std::max(1u, static_cast<unsigned int>(m_State->threader->GetNumberOfWorkUnits()));
}

void
Execution::Run(std::size_t count, const std::function<void(std::size_t)> & body) const
{
  this->ThrowIfAborted();
  const bool               nested = inLoop;
  std::atomic<std::size_t> next{ 0 }, done{ 0 };
  std::atomic<bool>        stop{ false };
  std::exception_ptr       thrown;
  std::mutex               mutex;
  // Each work unit takes the next chunk until there is none: none waits for another's long ones.
  const auto work = [&](itk::SizeValueType) {
    for (std::size_t c = next++; c < count && !stop; c = next++)
    {
      try
      {
        body(c);
        if (nested)
        {
          this->ThrowIfAborted();
        }
        else
        {
          this->Report(static_cast<double>(++done) / static_cast<double>(count));
        }
      }
      catch (...)
      {
        const std::lock_guard<std::mutex> lock(mutex);
        thrown = thrown ? thrown : std::current_exception();
        stop = true;
      }
    }
  };
  const std::size_t units = std::min<std::size_t>(count, this->GetNumberOfWorkUnits());
  if (units <= 1 || nested)
  {
    work(0);
  }
  else
  {
    m_State->threader->ParallelizeArray(
      0,
      units,
      [&work](itk::SizeValueType unit) {
        const LoopScope scope;
        work(unit);
      },
      nullptr);
  }
  if (thrown)
  {
    std::rethrow_exception(thrown);
  }
  if (!nested)
  {
    this->Report(1.0); // the caller may have run none of the last chunks
  }
}
} // namespace bone
