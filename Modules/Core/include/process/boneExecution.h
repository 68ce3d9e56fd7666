/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneExecution_h
#define boneExecution_h

#include <algorithm>
#include <cstddef>
#include <functional>
#include <future>
#include <memory>

namespace itk
{
class ProcessObject;
}

namespace bone
{
/** \class Execution
 * \brief How a kernel's work is run: its loops in parallel, its progress reported, its abort noticed.
 *
 * A filter makes one execution from itself and hands it to its kernels, which know of no process object. An execution
 * covers an interval of the filter's progress; Part() gives a part of that interval to a step of the work, and parts
 * nest. Progress never goes back, whatever is reported. Where the filter's AbortGenerateData is set, Report() and the
 * loops throw itk::ProcessAborted, loops at the latest when the chunks that are running have ended.
 *
 * Loops run on as many work units as the filter has (SetNumberOfWorkUnits), on the calling thread too; what a body
 * writes must belong to its index alone, and the result then does not depend on the number of threads. The first
 * exception of a body ends the loop and is thrown. A loop within a loop's body runs on the body's own thread. Outside
 * of a filter (the default constructor) there is no progress and no abort, and ITK's default number of work units.
 *
 * Copies are cheap and share what was reported. Report() and loops are called from the thread that runs the filter, or
 * from a loop's body. */
class Execution
{
public:
  Execution();

  /** The work of `filter`, which must outlive this, in its progress from `from` to `to`, 0 to 1. */
  explicit Execution(itk::ProcessObject * filter, double from = 0.0, double to = 1.0);

  /** A part of this work, from the share `from` of it to the share `to`. */
  Execution
  Part(double from, double to) const;

  /** This work without progress: for loops that are a small part of a step. */
  Execution
  Silent() const
  {
    return this->Part(0.0, 0.0);
  }

  /** The work is done to this share, 0 to 1. Throws itk::ProcessAborted where the filter is to stop. */
  void
  Report(double share) const;

  /** Whether the filter is to stop: for bodies that take long. */
  bool
  IsAborted() const;

  /** Throws itk::ProcessAborted where the filter is to stop. */
  void
  ThrowIfAborted() const;

  unsigned int
  GetNumberOfWorkUnits() const;

  /** Calls body(i) for each i in [0, count), in any order and perhaps at once, `chunk` consecutive ones at a time (more
   * for bodies that take less than some microseconds). The loop's progress is that of this execution. */
  template <typename TBody>
  void
  For(std::size_t count, TBody && body, std::size_t chunk = 1) const
  {
    this->Run((count + chunk - 1) / chunk, [count, chunk, &body](std::size_t c) {
      const std::size_t end = std::min(count, (c + 1) * chunk);
      for (std::size_t i = c * chunk; i < end; ++i)
      {
        body(i);
      }
    });
  }

private:
  struct State;

  void
  Run(std::size_t count, const std::function<void(std::size_t)> & body) const;

  std::shared_ptr<State> m_State;
  double                 m_From{ 0.0 };
  double                 m_To{ 0.0 };
};

/** Calls `work` on a thread of its own, beside what follows; with one thread (ITK's default number), when its result is
 * asked for. The future's destructor waits for the thread. */
template <typename TWork>
auto
RunBeside(TWork && work)
{
  const bool alone = Execution().GetNumberOfWorkUnits() < 2;
  return std::async(alone ? std::launch::deferred : std::launch::async, std::forward<TWork>(work));
}
} // namespace bone

#endif
