/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneProgress_h
#define boneProgress_h

#include <chrono>
#include <string>
#include <vector>

namespace bone
{
/** A stage of a command's work. */
struct ExpectedStage
{
  std::string name;
  double      seconds; ///< about how long one run takes; only ratios count
  int         runs{ 1 };
};

/** \class Progress
 * \brief How far a command is, from 0 to 1, by the stages that it goes through.
 *
 * The share is that of the expected stages' seconds that are done. A stage that runs only once is begun when all stages
 * before it are done, however often they were expected to run. Runs beyond those expected, and stages that were not, do
 * not count. Where nothing is expected, the first stage is the whole work. The share never falls. */
class Progress
{
public:
  using Clock = std::chrono::steady_clock;

  /** What is to come, in order. It fills the command's share from `from` to `to`, as one of several jobs. What runs is
   * given up. */
  void
  Expect(const std::vector<ExpectedStage> & stages, double from = 0.0, double to = 1.0);

  /** A run of a stage begins. Returns the run, for the calls below; runs may nest. */
  int
  Begin(const std::string & name);

  /** A run is done to this share, 0 to 1. */
  void
  Report(int run, double share);

  /** A run is done. Returns its stage's name, empty for one that was given up, and sets how many seconds it took. */
  std::string
  End(int run, double & seconds);

  /** A run failed, or is of no interest any more. */
  void
  GiveUp(int run);

  /** The innermost stage that runs; empty where none does. */
  std::string
  GetStage() const;

  double
  GetShare() const
  {
    return m_Share;
  }

private:
  struct Stage
  {
    ExpectedStage expected;
    double        done; ///< runs, and the share of the present one
    int           ended;
  };
  struct Run
  {
    int               id;
    std::string       name;
    Clock::time_point start;
  };

  Stage *
  Find(const std::string & name);
  std::vector<Run>::iterator
  FindRun(int run);
  void
  Update();

  std::vector<Stage> m_Stages;
  std::vector<Run>   m_Runs;
  double             m_From{ 0.0 };
  double             m_To{ 1.0 };
  double             m_Share{ 0.0 };
  int                m_LastRun{ 0 };
};
} // namespace bone

#endif
