/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneProgress.h"

#include <gtest/gtest.h>

namespace ProgressTests
{
using bone::Progress;

void
Pass(Progress & progress, const std::string & stage)
{
  double seconds;
  EXPECT_EQ(progress.End(progress.Begin(stage), seconds), stage);
}

TEST(Progress, StagesCountByTheirSeconds)
{
  Progress progress;
  progress.Expect({ { "a", 1.0 }, { "b", 3.0 } });
  EXPECT_EQ(progress.GetShare(), 0.0);
  Pass(progress, "a");
  EXPECT_DOUBLE_EQ(progress.GetShare(), 0.25);
  const int b = progress.Begin("b");
  EXPECT_EQ(progress.GetStage(), "b");
  progress.Report(b, 0.5);
  EXPECT_DOUBLE_EQ(progress.GetShare(), 0.625);
  Pass(progress, "c"); // not expected
  EXPECT_DOUBLE_EQ(progress.GetShare(), 0.625);
  double seconds;
  progress.End(b, seconds);
  EXPECT_EQ(progress.GetShare(), 1.0);
  EXPECT_EQ(progress.GetStage(), "");
}

TEST(Progress, AStageThatRunsSeveralTimesGoesOn)
{
  Progress progress;
  progress.Expect({ { "a", 1.0, 4 }, { "b", 4.0 } });
  for (int run = 1; run <= 3; ++run)
  {
    Pass(progress, "a");
    EXPECT_DOUBLE_EQ(progress.GetShare(), run / 8.0);
  }
  const int b = progress.Begin("b"); // so there is no fourth run
  EXPECT_DOUBLE_EQ(progress.GetShare(), 0.5);
  progress.Report(b, 0.25);
  Pass(progress, "a");
  EXPECT_DOUBLE_EQ(progress.GetShare(), 0.625);
}

TEST(Progress, NeverFalls)
{
  Progress  progress;
  const int a = progress.Begin("a"); // the whole work, as nothing is expected
  progress.Report(a, 0.75);
  progress.Report(a, 0.25);
  EXPECT_DOUBLE_EQ(progress.GetShare(), 0.75);
  progress.GiveUp(a);
  EXPECT_EQ(progress.GetStage(), "");
  progress.Report(progress.Begin("a"), 0.1);
  EXPECT_DOUBLE_EQ(progress.GetShare(), 0.75);
  progress.Expect({ { "b", 1.0 } });
  EXPECT_DOUBLE_EQ(progress.GetShare(), 0.75);
}

TEST(Progress, JobsFillTheirPartsAndGiveUpWhatRan)
{
  Progress progress;
  progress.Expect({ { "a", 1.0 } }, 0.2, 0.6);
  EXPECT_DOUBLE_EQ(progress.GetShare(), 0.2);
  const int failed = progress.Begin("a");
  progress.Report(failed, 0.5);
  EXPECT_DOUBLE_EQ(progress.GetShare(), 0.4);
  progress.Expect({ { "a", 1.0 } }, 0.6, 1.0);
  EXPECT_DOUBLE_EQ(progress.GetShare(), 0.6);
  EXPECT_EQ(progress.GetStage(), "");
  double seconds;
  EXPECT_EQ(progress.End(failed, seconds), "");
  progress.Report(failed, 1.0);
  EXPECT_DOUBLE_EQ(progress.GetShare(), 0.6);
}

TEST(Progress, RunsNestAndTellTheirSeconds)
{
  Progress  progress;
  const int outer = progress.Begin("outer"), inner = progress.Begin("inner");
  EXPECT_EQ(progress.GetStage(), "inner");
  double seconds = -1.0;
  EXPECT_EQ(progress.End(inner, seconds), "inner");
  EXPECT_GE(seconds, 0.0);
  EXPECT_LT(seconds, 60.0);
  EXPECT_EQ(progress.GetStage(), "outer");
  EXPECT_EQ(progress.End(outer, seconds), "outer");
}
} // namespace ProgressTests
