/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneProgressWatch_h
#define boneProgressWatch_h

#include <gtest/gtest.h>
#include <itkCommand.h>
#include <itkProcessObject.h>

namespace bone
{
namespace test
{
/** Watches a filter's progress. */
struct ProgressWatch
{
  explicit ProgressWatch(itk::ProcessObject * filter)
  {
    filter->AddObserver(itk::ProgressEvent(), [this, filter](const itk::EventObject &) {
      falls = falls || filter->GetProgress() < last;
      last = filter->GetProgress();
      ++steps;
    });
  }
  float last{ 0 };
  bool  falls{ false };
  int   steps{ 0 };
};

/** Stops the filter at its first progress, and expects that it then works as if it had not been stopped. */
inline void
ExpectUsableAfterAbort(itk::ProcessObject * filter)
{
  const auto tag =
    filter->AddObserver(itk::ProgressEvent(), [filter](const itk::EventObject &) { filter->AbortGenerateDataOn(); });
  EXPECT_THROW(filter->Update(), itk::ProcessAborted);
  filter->RemoveObserver(tag);
  EXPECT_NO_THROW(filter->Update());
}
} // namespace test
} // namespace bone

#endif
