/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneExecution.h"

#include <itkCommand.h>
#include <itkMultiThreaderBase.h>
#include <itkProcessObject.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <thread>
#include <vector>

namespace ExecutionTests
{
/** A process object that keeps the progress it reported. */
class Recorder : public itk::ProcessObject
{
public:
  using Self = Recorder;
  using Pointer = itk::SmartPointer<Self>;
  itkNewMacro(Self);

  std::vector<float> reported;

protected:
  Recorder()
  {
    auto command = itk::CStyleCommand::New();
    command->SetClientData(this);
    command->SetCallback([](itk::Object *, const itk::EventObject &, void * self) {
      static_cast<Recorder *>(self)->reported.push_back(static_cast<Recorder *>(self)->GetProgress());
    });
    this->AddObserver(itk::ProgressEvent(), command);
  }
};

TEST(Execution, CallsTheBodyOnceForEachIndex)
{
  for (const std::size_t chunk : { 1u, 64u, 256u })
  {
    for (const std::size_t count : { 0u, 1u, 255u, 256u, 257u, 5000u })
    {
      std::vector<int> calls(count, 0);
      bone::Execution().For(
        count, [&](std::size_t i) { ++calls[i]; }, chunk);
      EXPECT_EQ(calls, std::vector<int>(count, 1));
    }
  }
}

TEST(Execution, LoopsReportTheirPartOfTheFiltersProgress)
{
  auto filter = Recorder::New();
  filter->SetNumberOfWorkUnits(1); // with more, the caller may run no chunk before the end
  const bone::Execution all(filter);
  all.Part(0.0, 0.5).For(100, [](std::size_t) {});
  EXPECT_FLOAT_EQ(filter->GetProgress(), 0.5F);
  all.Part(0.5, 1.0).Part(0.0, 0.5).For(100, [](std::size_t) {});
  EXPECT_FLOAT_EQ(filter->GetProgress(), 0.75F);
  EXPECT_GE(filter->reported.size(), 3u);
}

TEST(Execution, TheEndIsReportedHoweverNearTheLastStepWas)
{
  auto                  filter = Recorder::New();
  const bone::Execution all(filter);
  all.Part(0.0, 0.9).Report(1.0);
  all.Part(0.9, 1.0).Report(0.99);
  EXPECT_FLOAT_EQ(filter->GetProgress(), 0.999F);
  all.Part(0.9, 1.0).Report(1.0);
  EXPECT_FLOAT_EQ(filter->GetProgress(), 1.0F);
  const std::size_t count = filter->reported.size();
  all.Report(1.0);
  EXPECT_EQ(filter->reported.size(), count); // once
}

TEST(Execution, ProgressNeverGoesBack)
{
  auto                  filter = Recorder::New();
  const bone::Execution all(filter);
  for (const double share : { 0.1, 0.6, 0.3, 0.7, 0.0, 2.0, 0.5 })
  {
    all.Report(share);
  }
  EXPECT_THAT(filter->reported, testing::ElementsAre(0.1F, 0.6F, 0.7F, 1.0F));
}

TEST(Execution, SilentLoopsReportNothing)
{
  auto filter = Recorder::New();
  bone::Execution(filter).Silent().For(1000, [](std::size_t) {});
  EXPECT_TRUE(filter->reported.empty());
}

TEST(Execution, AbortEndsALoop)
{
  auto             filter = Recorder::New();
  std::atomic<int> calls{ 0 };
  EXPECT_THROW(bone::Execution(filter).For(100000,
                                           [&](std::size_t) {
                                             ++calls;
                                             filter->AbortGenerateDataOn();
                                           }),
               itk::ProcessAborted);
  EXPECT_LT(calls, 1000);
}

TEST(Execution, TheExceptionOfABodyIsThrown)
{
  EXPECT_THROW(bone::Execution().For(1000,
                                     [](std::size_t i) {
                                       if (i == 500)
                                       {
                                         throw std::invalid_argument("500");
                                       }
                                     }),
               std::invalid_argument);
}

TEST(Execution, LoopsWithinLoopsEnd)
{
  std::atomic<int>      calls{ 0 };
  const bone::Execution execution;
  execution.For(100, [&](std::size_t) { execution.For(100, [&](std::size_t) { ++calls; }); });
  EXPECT_EQ(calls, 10000);
}

TEST(Execution, RunsOnAsManyWorkUnitsAsTheFilter)
{
  auto filter = Recorder::New();
  filter->SetNumberOfWorkUnits(1);
  const bone::Execution execution(filter);
  EXPECT_EQ(execution.GetNumberOfWorkUnits(), 1u);
  const auto caller = std::this_thread::get_id();
  bool       elsewhere = false;
  execution.For(1000, [&](std::size_t) { elsewhere = elsewhere || std::this_thread::get_id() != caller; });
  EXPECT_FALSE(elsewhere);
}

TEST(RunBeside, TakesAThreadOfItsOwnUnlessThereIsOne)
{
  const auto caller = std::this_thread::get_id();
  const auto threads = itk::MultiThreaderBase::GetGlobalDefaultNumberOfThreads();
  itk::MultiThreaderBase::SetGlobalDefaultNumberOfThreads(2);
  EXPECT_NE(bone::RunBeside([] { return std::this_thread::get_id(); }).get(), caller);
  itk::MultiThreaderBase::SetGlobalDefaultNumberOfThreads(1);
  EXPECT_EQ(bone::RunBeside([] { return std::this_thread::get_id(); }).get(), caller);
  itk::MultiThreaderBase::SetGlobalDefaultNumberOfThreads(threads);
  auto failing = bone::RunBeside([] { throw std::runtime_error("no"); });
  EXPECT_THROW(failing.get(), std::runtime_error);
}
} // namespace ExecutionTests
